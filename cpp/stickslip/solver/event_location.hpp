#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "stickslip/numbers/pack.hpp"
#include "stickslip/numbers/roots.hpp"

/// Events inside a step. Each event function is watched on its own: a minimum over several would
/// hide the dip of one behind another of a different scale.
namespace stickslip {

/// An event function that fell through zero, at the fraction `s` of the step, on its far side.
struct EventHit {
    int index = -1;
    double s = 1.0;

    explicit operator bool() const { return index >= 0; }
};

/// Event functions at a step's two ends and at stages between, for the search for dips.
template <std::size_t M, class Real = double>
struct EventSamples {
    static constexpr double kEarly = 0.161;  // two of Tsit5's stages
    static constexpr double kLate = 0.9;

    std::array<Real, M> start, end;
    std::array<Real, M> early, late;  ///< at the fractions kEarly and kLate
    std::array<Real, M> lowest;       ///< least value over all stages

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(start, end, early, late, lowest);
    }

    [[gnu::always_inline]] Real start_slope(std::size_t i) const {
        constexpr auto w = slope_weights(0.0, 0.0, kEarly, kLate);
        return fma(Real(w[2]), late[i], fma(Real(w[1]), early[i], w[0] * start[i]));
    }
    [[gnu::always_inline]] Real end_slope(std::size_t i) const {
        constexpr auto w = slope_weights(1.0, kEarly, kLate, 1.0);
        return fma(Real(w[2]), end[i], fma(Real(w[1]), late[i], w[0] * early[i]));
    }

    /// Where the tangents at the ends, of these two slopes, have the same value.
    [[gnu::always_inline]] Real tangents_meet(std::size_t i, Real falling, Real rising) const {
        const Real meet = (end[i] - start[i] - rising) / (falling - rising);
        return lesser(greater(meet, Real(0.0)), Real(1.0));
    }

    /// Positive at both ends: could function i be negative between? Falling at the start and rising
    /// at the end, the two tangents meet at a lower bound where the function is convex; they are
    /// made steeper by a part for what the stages miss.
    [[gnu::always_inline]] MaskOf<Real> may_dip(std::size_t i) const {
        const Real slope = start_slope(i);
        // The stages are not the solution, and the slope at the end may have the wrong sign.
        const auto drops = (slope < 0.0) & (start[i] + slope < 0.0);
        const Real falling = 1.25 * slope;
        const Real rising = 1.25 * end_slope(i);
        const auto turns = (falling < 0.0) & (rising > 0.0);
        if (!any(turns)) return (lowest[i] < 0.0) | drops;
        const Real meet = tangents_meet(i, falling, rising);
        const auto below =
            (fma(falling, meet, start[i]) < 0.0) | (fnma(rising, 1.0 - meet, end[i]) < 0.0);
        return (lowest[i] < 0.0) | drops | (turns & below);
    }

    /// Zero or positive throughout, and positive at some stages and the end: function i, which was
    /// born at zero, has risen.
    [[gnu::always_inline]] MaskOf<Real> rises(std::size_t i) const {
        return (lowest[i] >= 0.0) & (early[i] > 0.0) & (late[i] > 0.0) & (end[i] > 0.0) &
               !may_dip(i);
    }

private:
    // Weights of the values at x0, x1, x2 in the slope at x of the parabola through them.
    static constexpr std::array<double, 3> slope_weights(double x, double x0, double x1,
                                                         double x2) {
        return {(2.0 * x - x1 - x2) / ((x0 - x1) * (x0 - x2)),
                (2.0 * x - x0 - x2) / ((x1 - x0) * (x1 - x2)),
                (2.0 * x - x0 - x1) / ((x2 - x0) * (x2 - x1))};
    }
};

/// Finds the first event of a step among M event functions. `value(i, s)` is event function i on
/// the dense output.
template <std::size_t M>
class EventFinder {
public:
    static constexpr double kEarly = EventSamples<M>::kEarly, kLate = EventSamples<M>::kLate;

    /// armed: whether each event function has been positive in this phase, brought up to date. A
    /// function that is zero at the phase's birth (a slip that has just begun) can fire only after
    /// it has risen; one that does not rise fires at once, at s = 0, or, where the last events
    /// brought the time no further (`stalled`), at the end of the step. An armed one that is not
    /// positive as the step begins (forces may jump between two segments) fires at once too.
    template <class Armed, class Value>
    static EventHit find(const EventSamples<M>& g, Armed& armed, bool stalled, Value&& value) {
        EventHit hit;
        for (std::size_t i = 0; i < M; ++i) {
            const int index = static_cast<int>(i);
            Bracket bracket{0.0, 1.0, g.start[i], g.end[i]};
            if (armed[i]) {
                if (g.start[i] <= 0.0) return {index, 0.0};
                if (g.end[i] <= 0.0) {
                    narrow(g, i, value, hit.s, bracket);
                } else if (!g.may_dip(i) || !find_dip(g, i, value, bracket)) {
                    continue;
                }
            } else if (g.rises(i)) {
                continue;
            } else if (!risen(g, i, value, bracket)) {
                if (!stalled) return {index, 0.0};
                if (!hit) hit = {index, 1.0};
                continue;
            }
            if (bracket.low >= hit.s) continue;
            const std::optional<double> s =
                find_root(bracket, [&](double x) { return value(i, x); });
            if (s && (!hit || *s < hit.s)) hit = {index, *s};
        }
        if (!hit) {
            for (std::size_t i = 0; i < M; ++i) armed[i] = armed[i] || g.end[i] > 0.0;
        }
        return hit;
    }

private:
    // Not positive at the end: where may a root before `s` be? Where the stages do not simply fall,
    // looks on the way, so that of several roots the first is found.
    template <class Value>
    [[gnu::noinline]] static void narrow(const EventSamples<M>& g, std::size_t i, Value&& value,
                                         double s, Bracket& bracket) {
        if (s < 1.0) {
            bracket.high = s;
            bracket.at_high = value(i, s);
        }
        const bool falls = g.start[i] > g.early[i] && g.early[i] > g.late[i] &&
                           g.late[i] > g.end[i] && g.start_slope(i) < 0.0;
        if (falls) return;
        for (const double at : {1.0 / 3.0, 2.0 / 3.0}) {
            if (at >= bracket.high) break;
            const double there = value(i, at);
            (there > 0.0 ? bracket.low : bracket.high) = at;
            (there > 0.0 ? bracket.at_low : bracket.at_high) = there;
        }
    }

    // Born at zero or below: false if it falls from there. Where it rises and falls
    // again, the bracket holds its root; where it does not, the bracket holds none.
    template <class Value>
    [[gnu::noinline]] static bool risen(const EventSamples<M>& g, std::size_t i, Value&& value,
                                        Bracket& bracket) {
        bracket.at_low = 0.0;
        for (const double at : {1.0 / 3.0, 2.0 / 3.0, 1.0}) {
            const double there = at == 1.0 ? g.end[i] : value(i, at);
            const bool has_risen = bracket.low > 0.0;
            if (there > 0.0) {
                bracket.low = at;
                bracket.at_low = there;
            } else if (!has_risen && (there == 0.0 || there > g.start[i])) {
                continue;  // below by more than rounding, it may be on its way up
            } else {
                bracket.high = at;
                bracket.at_high = there;
                return has_risen || rises_briefly(i, value, bracket);
            }
        }
        return true;
    }

    template <class Value>
    [[gnu::noinline]] static bool rises_briefly(std::size_t i, Value&& value, Bracket& bracket) {
        constexpr int kHalvings = 24;
        double s = bracket.high;
        for (int k = 0; k < kHalvings; ++k) {
            s *= 0.5;
            const double there = value(i, s);
            (there > 0.0 ? bracket.low : bracket.high) = s;
            (there > 0.0 ? bracket.at_low : bracket.at_high) = there;
            if (there > 0.0) return true;
        }
        return false;
    }

    // A look or two settles most alarms. Where only a stage was negative (stages are not near the
    // solution), the dense output well above the lower end at both looks; where the slopes gave the
    // alarm, a parabola through a look at the tangents' meeting that stays well above zero.
    template <class Value>
    [[gnu::noinline]] static bool clearly_above(const EventSamples<M>& g, std::size_t i,
                                                Value&& value) {
        const double falling = g.start_slope(i), rising = g.end_slope(i);
        if (!(falling < 0.0 && rising > 0.0)) {
            const double floor = 0.5 * std::min(g.start[i], g.end[i]);
            return g.early[i] > floor && g.late[i] > 0.0 && value(i, 0.6) > floor &&
                   value(i, 0.95) > floor;
        }
        const double s = std::clamp(g.tangents_meet(i, falling, rising), 0.02, 0.98);
        const double middle = value(i, s);
        // g = start + b s + c s^2 through the three.
        const double c = ((g.end[i] - g.start[i]) - (middle - g.start[i]) / s) / (1.0 - s);
        const double b = (middle - g.start[i]) / s - c * s;
        if (!(c > 0.0)) return middle > 0.0;
        return g.start[i] - b * b / (4.0 * c) > 0.5 * middle;
    }

    // Looks for a value that is not positive on the dense output, by samples and then by closing in
    // on the least.
    template <class Value>
    [[gnu::noinline]] static bool find_dip(const EventSamples<M>& g, std::size_t i, Value&& value,
                                           Bracket& bracket) {
        if (clearly_above(g, i, value)) return false;
        constexpr std::size_t kSamples = 8;
        const auto at = [](std::size_t j) { return static_cast<double>(j) / kSamples; };
        std::array<double, kSamples + 1> sample;
        sample[0] = g.start[i];
        sample[kSamples] = g.end[i];
        std::size_t least = g.start[i] < g.end[i] ? 0 : kSamples;
        for (std::size_t j = 1; j < kSamples; ++j) {
            sample[j] = value(i, at(j));
            if (sample[j] <= 0.0) {
                bracket = {at(j - 1), at(j), sample[j - 1], sample[j]};
                return true;
            }
            if (sample[j] < sample[least]) least = j;
        }
        const std::size_t before = least == 0 ? 0 : least - 1;
        const std::size_t after = least == kSamples ? kSamples : least + 1;
        return close_in(i, value, {at(before), at(after), sample[before], sample[after]}, bracket);
    }

    // Golden section, until a value is not positive or the curvature leaves no room for one.
    template <class Value>
    [[gnu::noinline]] static bool close_in(std::size_t i, Value&& value, Bracket around,
                                           Bracket& bracket) {
        constexpr double kGolden = 0.3819660112501051;
        constexpr int kMost = 40;
        double a = around.low, b = around.high, at_a = around.at_low, at_b = around.at_high;
        double c = a + kGolden * (b - a), d = b - kGolden * (b - a);
        double at_c = value(i, c), at_d = value(i, d);
        for (int iteration = 0; iteration < kMost; ++iteration) {
            if (at_c <= 0.0 || at_d <= 0.0) {
                const bool first = at_c <= 0.0;
                bracket = {around.low, first ? c : d, around.at_low, first ? at_c : at_d};
                return true;
            }
            const double left = ((at_d - at_c) / (d - c) - (at_c - at_a) / (c - a)) / (d - a);
            const double right = ((at_b - at_d) / (b - d) - (at_d - at_c) / (d - c)) / (b - c);
            const double sag = 0.5 * std::max(left, right) * (b - a) * (b - a);
            if (std::min(at_c, at_d) > sag) return false;
            if (at_c < at_d) {
                b = d, at_b = at_d, d = c, at_d = at_c;
                c = a + kGolden * (b - a), at_c = value(i, c);
            } else {
                a = c, at_a = at_c, c = d, at_c = at_d;
                d = b - kGolden * (b - a), at_d = value(i, d);
            }
        }
        return false;
    }
};

/// Where in a step one function falls through zero, from a start above it. `value(s)` is evaluated
/// on the dense output.
EventHit find_fall(auto&& value) {
    using Finder = EventFinder<1>;
    const auto at = [&](std::size_t, double s) { return value(s); };
    EventSamples<1> samples;
    samples.start = {value(0.0)};
    samples.early = {value(Finder::kEarly)};
    samples.late = {value(Finder::kLate)};
    samples.end = {value(1.0)};
    samples.lowest = {std::min({samples.start[0], samples.early[0], samples.late[0]})};
    std::array<bool, 1> armed = {true};
    return Finder::find(samples, armed, false, at);
}

}  // namespace stickslip
