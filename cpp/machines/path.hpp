#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

/// Steps in time of models of machines and heaters, from event to event. From one knot to the next
/// an input is held, or a line. Where the motion is linear between events its steps are exact, by
/// exponentials of matrices; else they are as short as their errors ask for.
namespace machines {

/// A coefficient of a machine by its name.
template <class Terms>
struct Named {
    const char* name;
    double Terms::*value;
};

/// Inputs now, and their slopes, per s.
template <std::size_t N>
struct Lines {
    std::array<double, N> value = {}, slope = {};

    std::array<double, N> at(double time) const {
        std::array<double, N> result = value;
        for (std::size_t i = 0; i < N; ++i) result[i] += slope[i] * time;
        return result;
    }
    Lines after(double time) const { return {at(time), slope}; }
};

/// Inputs of a record: what acts before the first knot, and from each knot on, held or with `lines`
/// changing evenly up to the next one; each of them by its own time later.
template <std::size_t N>
struct Signals {
    std::span<const double> knots;  ///< s
    const double* values;           ///< of all inputs, before the first knot and from each on
    std::array<double, N> late;     ///< s
    bool lines = false;
    double step = 1.0;  ///< s, the usual one between two readings
};

/// The median step of times, s; 1 for a single one.
inline double usual_step(std::span<const double> times) {
    std::vector<double> gaps;
    for (std::size_t k = 1; k < times.size(); ++k) gaps.push_back(times[k] - times[k - 1]);
    if (gaps.empty()) return 1.0;
    const auto half = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), half, gaps.end());
    return gaps.size() % 2 > 0 ? *half : 0.5 * (*half + *std::max_element(gaps.begin(), half));
}

/// The path of one system, which has
///
///     kStates, kInputs, kPhases   numbers of them
///     State, Input, Mode          arrays of so many doubles, doubles and signs
///     linear                      whether the derivative is linear in state and inputs while the
///                                 phases last
///     fastest                     the largest rate of change, 1/s, of the terms that bound it
///     fastest_at(z, u, mode)      that of all terms near a state, at least; of no linear system
///     rate(z, u, mode)            derivative of the state
///     margins(z, u, mode)         what is below zero where a phase has ended
///     falls(z, u, slope, mode)    how fast those of them fall that may turn in a step
///     begun(z, u)                 state and phases at the first reading
///     driven(z, u, mode)          the same where the input has changed
///     after(z, u, mode, hit)      the same where the margin `hit` has become zero
template <class System>
class Path {
public:
    using State = typename System::State;
    using Input = typename System::Input;
    using Mode = typename System::Mode;
    using Point = std::pair<State, Mode>;
    using Inputs = Lines<System::kInputs>;

    /// step: s, the usual one between two readings. steps: how many may be taken.
    Path(const System& system, double step, double steps)
        : system_(system), alike_(kAlike * step), left_(steps) {}

    /// Whether the motion was followed as far as it was asked for.
    bool is_followed() const { return left_ >= 0.0; }

    /// State and mode after `gap` s, over which the inputs change linearly.
    Point advanced(Point from, Inputs u, double gap) {
        Point now = system_.driven(from.first, u.value, from.second);
        const double turns = system_.linear ? 0.0 : gap * system_.fastest;
        const double parts = std::ceil(std::clamp(turns / kFine, 1.0, std::max(kEven, turns)));
        if (!(parts <= left_)) {
            left_ = -1.0;
            return now;
        }
        for (double part = 0.0; part < parts; ++part) {
            now = step(now, u, gap / parts);
            u = u.after(gap / parts);
        }
        return now;
    }

private:
    static constexpr std::size_t kStates = System::kStates, kInputs = System::kInputs;
    static constexpr std::size_t kHeld = kStates + 1 + kInputs, kWhole = kHeld + kInputs;
    using Rows = std::array<std::array<double, kWhole>, kStates>;

    // Longest step of the method in units of the shortest time constant. Chosen: an oscillation is
    // followed with an error of 3e-10 of its phase a step.
    static constexpr double kFine = 0.1;
    // Parts of the time between two switches that are cut evenly so. Chosen: where more are needed,
    // what turns so fast mostly rests, and errors tell where it does not.
    static constexpr double kEven = 16.0;
    // Largest difference of the results of orders 4 and 5, of the state and its change, for which a
    // step is not halved, and how often it is at most. Chosen: of a usual step, whose own error is
    // a hundredth of it.
    static constexpr double kSharp = 1e-7;
    static constexpr int kHalvings = 20;
    static constexpr double kAlike = 1e-9;           // of a usual step: lengths that are the same
    static constexpr int kEvents = 24, kTries = 60;  // of a step, and of one event; never met
    static constexpr double kExact = 1e-11;  // of its value after the step, the margin at an event

    static double least(const auto& margins) {
        return *std::min_element(margins.begin(), margins.end());
    }

    // Product of square matrices that are `one` and `rise` below: a number times one, and what an
    // input takes of its rise.
    static Rows product(const Rows& a, const Rows& b, double one, double rise) {
        Rows result = {};
        for (std::size_t i = 0; i < kStates; ++i) {
            for (std::size_t k = 0; k < kStates; ++k) {
                for (std::size_t j = 0; j < kWhole; ++j) result[i][j] += a[i][k] * b[k][j];
            }
            for (std::size_t j = kStates; j < kWhole; ++j) {
                result[i][j] += one * a[i][j];
                if (j >= kHeld) result[i][j] += rise * a[i][j - kInputs];
            }
        }
        return result;
    }

    // Exponential of a square matrix whose rows are 0 below but for a half of each rise, by a
    // series of the halved matrix that is squared again. With a half its norm is mostly that of the
    // rest.
    static Rows exponential_of(Rows part) {
        constexpr int kMost = 20;  // terms; with a norm up to a half, 14 do
        double largest = 1e-300, rise = 0.5;
        for (const auto& row : part) {
            double sum = 0.0;
            for (const double each : row) sum += std::abs(each);
            largest = std::max(largest, sum);
        }
        const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(largest / 0.5))));
        rise = std::ldexp(rise, -halvings);
        Rows result = {};
        for (std::size_t i = 0; i < kStates; ++i) {
            for (double& each : part[i]) each = std::ldexp(each, -halvings);
            result[i][i] = 1.0;
        }
        Rows term = part;
        for (int k = 2; k <= kMost; ++k) {
            double size = 0.0;
            for (std::size_t i = 0; i < kStates; ++i) {
                for (std::size_t j = 0; j < kWhole; ++j) {
                    result[i][j] += term[i][j];
                    size = std::max(size, std::abs(term[i][j]));
                }
            }
            if (size < 1e-18) break;
            term = product(term, part, 0.0, rise);
            for (auto& row : term) {
                for (double& each : row) each /= k;
            }
        }
        for (int k = 0; k < halvings; ++k, rise *= 2.0) result = product(result, result, 1.0, rise);
        return result;
    }

    // Transition matrix from state, one, inputs and twice their rises to the state after h s.
    Rows rows(const Mode& mode, double h) const {
        Rows generator = {};
        const auto of = [&](std::size_t unit) {
            State z = {};
            Input u = {};
            if (unit < kStates) z[unit] = 1.0;
            if (unit > kStates && unit < kHeld) u[unit - kStates - 1] = 1.0;
            return system_.rate(z, u, mode);
        };
        const State none = of(kWhole);
        for (std::size_t column = 0; column < kHeld; ++column) {
            const State made = of(column);
            for (std::size_t i = 0; i < kStates; ++i) {
                const double own = column == kStates ? none[i] : made[i] - none[i];
                generator[i][column] = own * h;
            }
        }
        return exponential_of(generator);
    }

    const Rows& whole_rows(const Mode& mode, double h) {
        for (const Known& each : known_) {
            if (each.mode == mode && std::abs(h - each.step) < alike_) return each.rows;
        }
        if (known_.size() == kMostKnown) known_.clear();
        return known_.emplace_back(Known{mode, h, rows(mode, h)}).rows;
    }

    static State by(const Rows& rows, const State& z, const Inputs& u, double h) {
        State result;
        for (std::size_t i = 0; i < kStates; ++i) {
            double sum = rows[i][kStates];
            for (std::size_t j = 0; j < kStates; ++j) sum += rows[i][j] * z[j];
            for (std::size_t j = 0; j < kInputs; ++j) {
                sum += rows[i][kStates + 1 + j] * u.value[j];
                sum += rows[i][kHeld + j] * (2.0 * h * u.slope[j]);
            }
            result[i] = sum;
        }
        return result;
    }

    // A part of a step without an event.
    State part(const State& z, const Inputs& u, const Mode& mode, double h) const {
        if (system_.linear && h * system_.fastest > kFine) return by(rows(mode, h), z, u, h);
        return runge_kutta(z, u, mode, h);
    }

    // The method of Dormand and Prince of order 5, J. Comput. Appl. Math. 6 (1980) 19. `sharp`
    // becomes false where a long step of order 4 ends elsewhere.
    State runge_kutta(const State& z, const Inputs& u, const Mode& mode, double h,
                      bool* sharp = nullptr) const {
        constexpr std::array<std::array<double, 5>, 5> kA = {{
            {1.0 / 5.0},
            {3.0 / 40.0, 9.0 / 40.0},
            {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
            {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
            {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
        }};
        constexpr std::array<double, 6> kC = {0.0,       1.0 / 5.0, 3.0 / 10.0,
                                              4.0 / 5.0, 8.0 / 9.0, 1.0};
        constexpr std::array<double, 6> kB = {
            35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0};
        std::array<State, 6> k;
        k[0] = system_.rate(z, u.value, mode);
        const auto moved = [&](const auto& weights, std::size_t count) {
            State y = z;
            for (std::size_t stage = 0; stage < count; ++stage) {
                for (std::size_t i = 0; i < kStates; ++i) y[i] += h * weights[stage] * k[stage][i];
            }
            return y;
        };
        for (std::size_t stage = 1; stage < k.size(); ++stage) {
            k[stage] = system_.rate(moved(kA[stage - 1], stage), u.at(kC[stage] * h), mode);
        }
        const State end = moved(kB, k.size());
        const Input last_u = u.at(h);
        if (sharp != nullptr && !(h * std::max(system_.fastest_at(z, u.value, mode),
                                               system_.fastest_at(end, last_u, mode)) <=
                                  kFine)) {
            constexpr std::array<double, 6> kOff = {71.0 / 57600.0,      0.0,
                                                    -71.0 / 16695.0,     71.0 / 1920.0,
                                                    -17253.0 / 339200.0, 22.0 / 525.0};
            const State last = system_.rate(end, last_u, mode);
            for (std::size_t i = 0; i < kStates; ++i) {
                double off = -last[i] / 40.0, change = 0.0;
                for (std::size_t stage = 0; stage < k.size(); ++stage) {
                    off += kOff[stage] * k[stage][i];
                    change = std::max(change, std::abs(k[stage][i]));
                }
                const double size = std::abs(z[i]) + h * change;
                if (!(h * std::abs(off) <= kSharp * size)) *sharp = false;
            }
        }
        return end;
    }

    // A step through all events on the way; its halves where it is too long.
    Point step(Point now, Inputs u, double h, int halvings = 0, int event = 0) {
        bool sharp = true;
        bool* asked = halvings == kHalvings ? nullptr : &sharp;
        State end = system_.linear ? by(whole_rows(now.second, h), now.first, u, h)
                                   : runge_kutta(now.first, u, now.second, h, asked);
        if (!system_.linear && --left_ < 0.0) return now;
        if (!sharp) {
            now = step(now, u, 0.5 * h, halvings + 1, event);
            return step(now, u.after(0.5 * h), 0.5 * h, halvings + 1, event);
        }
        const auto margin = [&](const State& z, const Input& acts) {
            return least(system_.margins(z, acts, now.second));
        };
        for (; event < kEvents; ++event) {
            double within = h, below = margin(end, u.at(h)), low = 0.0;
            if (!(below < 0.0)) {
                // The function that ends a phase may turn within the step, after its zero.
                const auto rises = system_.falls(end, u.at(h), u.slope, now.second);
                bool ends = false;
                for (std::size_t k = 0; k < rises.size(); ++k) {
                    const auto fall = [&](const State& z, const Input& acts) {
                        return system_.falls(z, acts, u.slope, now.second)[k];
                    };
                    if (!(rises[k] < 0.0) || !(fall(now.first, u.value) > 0.0)) continue;
                    const auto [time, lowest] = find_zero(now, u, h, rises[k], fall);
                    const double least_margin = margin(lowest, u.at(time));
                    if (!(least_margin < -kExact * below) || time > within) continue;
                    ends = true;
                    within = time;
                    low = least_margin;
                }
                if (!ends) break;
                below = low;
            }
            const auto [time, met] = find_zero(now, u, within, below, margin);
            u = u.after(time);
            const auto margins = system_.margins(met, u.value, now.second);
            const auto hit = std::min_element(margins.begin(), margins.end()) - margins.begin();
            now = system_.after(met, u.value, now.second, static_cast<std::size_t>(hit));
            h -= time;
            if (h <= 0.0) return now;
            if (!system_.linear) return step(now, u, h, halvings, event + 1);
            end = part(now.first, u, now.second, h);
        }
        return {end, now.second};
    }

    // When a value that is `below` zero after h s was zero, s, and where, by false position
    // (Illinois).
    std::pair<double, State> find_zero(const Point& from, const Inputs& u, double h, double below,
                                       const auto& value_at) const {
        const auto& [z, mode] = from;
        double low = 0.0, high = h, time = 0.0, above = value_at(z, u.value);
        const double small = -kExact * below;
        State met = z;
        int last = -1;
        for (int k = 0; k < kTries; ++k) {
            time = 0.5 * (low + high);
            // An event that has just been left has a margin of nearly zero: only halves lead away.
            if (k % 3 != 2 && above > small) time = low + (high - low) * above / (above - below);
            met = part(z, u, mode, time);
            const double value = value_at(met, u.at(time));
            if (std::abs(value) <= small) break;
            const int inside = value > 0.0;
            if (inside) {
                low = time;
                above = value;
                if (last == 1) below *= 0.5;
            } else {
                high = time;
                below = value;
                if (last == 0) above *= 0.5;
            }
            last = inside;
        }
        return {time, met};
    }

    // Transition matrices of whole steps, most of which have one length.
    struct Known {
        Mode mode;
        double step;
        Rows rows;
    };
    static constexpr std::size_t kMostKnown = 32;

    const System& system_;
    double alike_, left_;
    std::vector<Known> known_;
};

/// States at readings: calls `write(reading, state)`, with NaN where they are not known.
///
/// times: s, of the readings. Way: what moves it in place of a Path.
template <class Way = void, class System>
void follow(const System& system, const typename System::State& start,
            std::span<const double> times, const Signals<System::kInputs>& signals, auto&& write) {
    // Most steps of a record and of each of its readings. Chosen: a motion that needs more is none
    // that its readings follow, and would hold up all others.
    constexpr double kMost = 1e5, kMostOfEach = 40.0;
    if (times.empty()) return;
    const std::size_t count = times.size();
    std::conditional_t<std::is_void_v<Way>, Path<System>, Way> path(
        system, signals.step, kMost + kMostOfEach * static_cast<double>(count));
    // The next knot of each input, and the line up to it, from its beginning.
    constexpr std::size_t kInputs = System::kInputs;
    const std::size_t knots = signals.knots.size();
    std::array<std::size_t, kInputs> next = {};
    std::array<double, kInputs> begun = {}, first = {}, due;
    Lines<kInputs> u;
    const auto value = [&](std::size_t i, std::size_t ahead = 0) {
        return signals.values[(next[i] + ahead) * kInputs + i];
    };
    const auto next_due = [&](std::size_t i) {
        return next[i] < knots ? signals.knots[next[i]] + signals.late[i]
                               : std::numeric_limits<double>::infinity();
    };
    for (std::size_t i = 0; i < kInputs; ++i) {
        first[i] = value(i);
        due[i] = next_due(i);
    }
    const auto to = [&](double time) {
        for (std::size_t i = 0; i < kInputs; ++i) {
            while (due[i] <= time) {
                begun[i] = due[i];
                ++next[i];
                first[i] = value(i);
                due[i] = next_due(i);
                const double left = due[i] - begun[i];
                const bool changes = signals.lines && next[i] < knots && left > 0.0;
                u.slope[i] = changes ? (value(i, 1) - first[i]) / left : 0.0;
            }
            u.value[i] = first[i] + u.slope[i] * (time - begun[i]);
        }
    };
    to(times[0]);
    typename System::State unknown;
    unknown.fill(std::numeric_limits<double>::quiet_NaN());
    const auto is_known = [](const auto& state) {
        return std::all_of(state.begin(), state.end(), [](double x) { return std::isfinite(x); });
    };
    auto now = system.begun(start, u.value);
    bool known = is_known(now.first);
    write(0, known ? now.first : unknown);
    for (std::size_t k = 1; k < count; ++k) {
        for (double time = times[k - 1]; known && time < times[k];) {
            to(time);
            double until = times[k];
            for (const double each : due) until = std::min(until, each);
            now = path.advanced(now, u, until - time);
            time = until;
        }
        known = known && path.is_followed() && is_known(now.first);
        write(k, known ? now.first : unknown);
    }
}

}  // namespace machines
