#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "machines/path.hpp"

namespace machines {

/// Heat stores: a body, and beside it perhaps its heater and a wall. Inputs: power (W) and the
/// temperature around (K). See Path.
struct HeatTerms {
    double capacity = 1.0;                ///< J/K
    double loss = 0.0, growth = 0.0;      ///< W/K, and its growth, W/K^2
    double heater = 0.0, coupling = 0.0;  ///< J/K, W/K; no heater of its own at 0
    double wall = 0.0, to_wall = 0.0;     ///< J/K, W/K; no wall at 0
};

inline constexpr std::array<Named<HeatTerms>, 7> kHeatTerms = {{
    {"capacity", &HeatTerms::capacity},
    {"loss", &HeatTerms::loss},
    {"loss_growth", &HeatTerms::growth},
    {"heater_capacity", &HeatTerms::heater},
    {"coupling", &HeatTerms::coupling},
    {"wall_capacity", &HeatTerms::wall},
    {"wall_coupling", &HeatTerms::to_wall},
}};

/// The path of heat stores. Modes of the linear part are exact, however fast they are; what the
/// loss grows by is a polynomial in time over a step, through its values at five points:
/// collocation of an exponential integrator (Hochbruck and Ostermann, Acta Numerica 19, 209, 2010).
class HeatStores {
public:
    static constexpr std::size_t kStates = 3, kInputs = 2;  // those that are not there are not used
    using State = std::array<double, kStates>;
    using Input = std::array<double, kInputs>;
    using Point = std::pair<State, std::array<int, 0>>;

    explicit HeatStores(const HeatTerms& terms) : heater_(terms.heater > 0.0), c(terms) {
        // Rates of energies' roots are symmetric; Jacobi's rotations turn them into those of modes.
        std::array<State, kStates> a = {{{-c.loss / c.capacity}}};
        energy_[0] = c.capacity;
        const auto beside = [&](double capacity, double coupling) {
            if (!(capacity > 0.0)) return;
            a[0][0] -= coupling / c.capacity;
            a[count_][count_] = -coupling / capacity;
            a[0][count_] = a[count_][0] = coupling / std::sqrt(c.capacity * capacity);
            energy_[count_++] = capacity;
        };
        beside(c.heater, c.coupling);
        beside(c.wall, c.to_wall);
        for (std::size_t i = 0; i < count_; ++i) modes_[i][i] = 1.0 / std::sqrt(energy_[i]);
        for (std::size_t turn = 0; turn < kTurns; ++turn) {
            const std::size_t p = turn % kStates, q = (turn + 1) % kStates;
            if (a[p][q] == 0.0) continue;
            const double angle = 0.5 * std::atan(2.0 * a[p][q] / (a[q][q] - a[p][p]));
            const auto turned = [x = std::cos(angle), y = std::sin(angle)](double& s, double& t) {
                t = y * std::exchange(s, x * s - y * t) + x * t;
            };
            for (State& row : a) turned(row[p], row[q]);
            for (std::size_t k = 0; k < kStates; ++k) turned(a[p][k], a[q][k]);
            for (State& row : modes_) turned(row[p], row[q]);
        }
        for (std::size_t m = 0; m < count_; ++m) rates_[m] = a[m][m];
    }
    HeatStores(const HeatStores& other, double, double steps) : HeatStores(other) { left_ = steps; }

    bool is_followed() const { return left_ >= 0.0; }
    Point begun(const State& z, const Input&) const { return {z, {}}; }
    Point advanced(const Point& from, const Lines<kInputs>& u, double gap) {
        return {step(from.first, u, gap, 0), {}};
    }

private:
    static constexpr std::size_t kPoints = 5, kMostKnown = 32;
    using Points = std::array<double, kPoints>;
    static constexpr Points kPlaces = {0.0, 0.25, 0.5, 0.75, 1.0};
    // Three times the factors of each power in the polynomials that are 1 at one of these places.
    static constexpr std::array<Points, kPoints> kPowers = {{
        {3.0, 0.0, 0.0, 0.0, 0.0},
        {-25.0, 48.0, -36.0, 16.0, -3.0},
        {70.0, -208.0, 228.0, -112.0, 22.0},
        {-80.0, 288.0, -384.0, 224.0, -48.0},
        {32.0, -128.0, 192.0, -128.0, 32.0},
    }};
    // Turns of three stores' modes, after which the rest is below rounding; rounds of substitution
    // in a step; and halvings of a step.
    static constexpr std::size_t kTurns = 24, kRounds = 12, kHalvings = 20;
    // Changes of a flow's heat in the last round, and of its last power, over the stored heat, from
    // which a step is halved; tolerance of equal lengths. Chosen: ends hold to 1e-9.
    static constexpr double kSettled = 1e-12, kBent = 2e-8, kAlike = 1e-9;

    // Weights for steps of one length.
    struct Weights {
        double step = 0.0;  // s
        // Of a mode at each point, and of a flow into it there: its value, s, and slope, s^2.
        std::array<Points, kStates> left = {}, held = {}, rising = {};
        std::array<Points, kStates> at_end = {};   // of flows at the points, at the end, s
        std::array<Points, kPoints> of_body = {};  // into the body, K/W
    };

    static double dot(const Points& a, const Points& b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    }

    // Integrals of exp(x (1 - s)) s^k over s from 0 to 1.
    static Points integrals(double x) {
        Points found = {};
        for (std::size_t k = 0; k < kPoints; ++k) {
            double n = static_cast<double>(k), term = 1.0 / (n + 1.0);
            if (std::abs(x) > kPoints) {
                found[k] = k > 0 ? (n * found[k - 1] - 1.0) / x : std::expm1(x) / x;
            } else {
                for (; std::abs(term) > 1e-18; term *= x / (++n + 1.0)) found[k] += term;
            }
        }
        return found;
    }

    const Weights& weights_of(double h) {
        for (const Weights& each : known_) {
            if (std::abs(each.step - h) < kAlike * h) return each;
        }
        if (known_.size() == kMostKnown) known_.clear();
        Weights& w = known_.emplace_back();
        w.step = h;
        for (std::size_t m = 0; m < count_; ++m) {
            for (std::size_t i = 0; i < kPoints; ++i) {
                double power = kPlaces[i] * h;
                const Points found = integrals(rates_[m] * power);
                w.left[m][i] = std::exp(rates_[m] * power);
                for (std::size_t k = 0; k < kPoints; ++k, power *= kPlaces[i]) {
                    for (std::size_t j = 0; j < kPoints; ++j) {
                        const double part = power * found[k] * kPowers[k][j] / 3.0;
                        w.held[m][i] += part;
                        w.rising[m][i] += part * kPlaces[j] * h;
                        w.of_body[i][j] += modes_[0][m] * modes_[0][m] * part;
                        if (i == kPoints - 1) w.at_end[m][j] += part;
                    }
                }
            }
        }
        return w;
    }

    // After h s.
    State step(const State& z, const Lines<kInputs>& u, double h, std::size_t halvings) {
        const Weights& w = weights_of(h);
        State begun = {}, value = {}, slope = {}, end = {};
        for (std::size_t m = 0; m < count_; ++m) {
            for (std::size_t i = 0; i < count_; ++i) begun[m] += modes_[i][m] * energy_[i] * z[i];
            const double around = modes_[0][m] * c.loss, heated = modes_[heater_][m];
            value[m] = around * u.value[1] + heated * u.value[0];
            slope[m] = around * u.slope[1] + heated * u.slope[0];
        }
        const auto without = [&](std::size_t m, std::size_t i) {  // a mode where no loss grows
            return w.left[m][i] * begun[m] + w.held[m][i] * value[m] + w.rising[m][i] * slope[m];
        };
        Points more = {};
        if (c.growth != 0.0) {
            Points rest = {}, around, at;
            for (std::size_t i = 0; i < kPoints; ++i) {
                for (std::size_t m = 0; m < count_; ++m) rest[i] += modes_[0][m] * without(m, i);
                around[i] = u.value[1] + u.slope[1] * kPlaces[i] * h;
            }
            const auto grown = [&](double body, std::size_t i) {
                return -c.growth * std::abs(body - around[i]) * (body - around[i]);
            };
            more.fill(grown(z[0], 0));
            bool settled = false;
            for (std::size_t round = 0; round < kRounds && !settled; ++round) {
                // All points at once, as no sum then waits for another.
                for (std::size_t i = 1; i < kPoints; ++i) at[i] = rest[i] + dot(w.of_body[i], more);
                settled = true;
                for (std::size_t i = 1; i < kPoints; ++i) {
                    const double now = grown(at[i], i);
                    const double change = std::abs(std::exchange(more[i], now) - now);
                    // What is left is smaller by what the flow grows by in a step.
                    const double left = 2.0 * h * std::abs(c.growth * (at[i] - around[i]));
                    settled = settled && h * change * std::min(left / c.capacity, 1.0) <=
                                             kSettled * c.capacity * std::abs(at[i]);
                }
            }
            const double bend = h * std::abs(dot(kPowers.back(), more)) / (3.0 * c.capacity);
            const bool sharp = settled && bend <= kBent * (std::abs(z[0]) + std::abs(rest[4]));
            if (!std::isfinite(z[0]) || --left_ < 0.0) return z;
            if (!sharp && halvings < kHalvings) {
                const State half = step(z, u, 0.5 * h, halvings + 1);
                return step(half, u.after(0.5 * h), 0.5 * h, halvings + 1);
            }
            if (!settled) left_ = -1.0;
        }
        for (std::size_t m = 0; m < count_; ++m) {
            const double own = without(m, kPoints - 1) + modes_[0][m] * dot(w.at_end[m], more);
            for (std::size_t i = 0; i < count_; ++i) end[i] += modes_[i][m] * own;
        }
        return end;
    }

    std::size_t count_ = 1, heater_;  // of stores, and which of them the power heats
    HeatTerms c;
    double left_ = 0.0;                      // steps
    State rates_ = {}, energy_ = {};         // 1/s, J/K
    std::array<State, kStates> modes_ = {};  // of each store
    std::vector<Weights> known_;
};

/// The temperature of the body.
struct Heat {
    using Terms = HeatTerms;
    static constexpr const auto& kTerms = kHeatTerms;
    static constexpr std::size_t kStates = 1, kInputs = 2, kStarts = 1;

    static void write(const Terms& c, const double* start, std::span<const double> t,
                      const Signals<kInputs>& acting, double* out) {
        const auto body = [&](std::size_t n, const auto& z) { out[n] = z[0]; };
        follow<HeatStores>(HeatStores(c), {*start, *start, *start}, t, acting, body);
    }
};

}  // namespace machines
