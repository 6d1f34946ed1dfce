#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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
template <std::size_t M>
struct EventSamples {
    std::array<double, M> start, end;
    std::array<double, M> early, late;  ///< at the fractions kEarly and kLate
    std::array<double, M> lowest;       ///< least value over all stages
};

/// Finds the first event of a step among M event functions. `value(i, s)` is event function i on
/// the dense output.
template <std::size_t M>
class EventFinder {
public:
    static constexpr double kEarly = 0.161;  // stages of Tsit5 nearest to the ends
    static constexpr double kLate = 0.9;
    // Of a step; on the dense output, whose own error is far larger.
    static constexpr double kResolution = 1e-12;

    /// armed: whether each event function has been positive in this phase, brought up to date. A
    /// function that is zero at the phase's birth (a slip that has just begun) can fire only after
    /// it has risen.
    template <class Armed, class Value>
    static EventHit find(const EventSamples<M>& g, Armed& armed, Value&& value) {
        EventHit hit;
        for (std::size_t i = 0; i < M; ++i) {
            Bracket bracket{0.0, 1.0, g.start[i], g.end[i]};
            if (armed[i]) {
                if (g.end[i] < 0.0) {
                    if (!narrow(g, i, value, hit.s, bracket)) continue;
                } else if (!may_dip(g, i) || !find_dip(g, i, value, bracket)) {
                    continue;
                }
            } else if (g.end[i] < 0.0) {
                // Born at zero and below it now: it may have risen in between.
                if (!rises(i, value, bracket)) return {static_cast<int>(i), 0.0};
            } else {
                continue;
            }
            if (bracket.low >= hit.s) continue;
            const double s = locate(i, bracket, value);
            if (!hit || s < hit.s) hit = {static_cast<int>(i), s};
        }
        if (!hit) {
            for (std::size_t i = 0; i < M; ++i) armed[i] = armed[i] || g.end[i] > 0.0;
        }
        return hit;
    }

    /// Positive at `low`, zero or negative at `high`.
    struct Bracket {
        double low, high, at_low, at_high;
    };

    /// Root of function i in the bracket, to kResolution: its far side. The method is that of
    /// Chandrupatla, Advances in Engineering Software 28 (1997) 145-149.
    template <class Value>
    static double locate(std::size_t i, const Bracket& bracket, Value&& value) {
        double x1 = bracket.high, f1 = bracket.at_high, x2 = bracket.low, f2 = bracket.at_low;
        double part = f1 / (f1 - f2);
        while (true) {
            const double x = x1 + part * (x2 - x1);
            const double f = value(i, x);
            double x3 = x1, f3 = f1;
            if ((f > 0.0) != (f1 > 0.0)) {
                x3 = x2, f3 = f2;
                x2 = x1, f2 = f1;
            }
            x1 = x, f1 = f;
            const double least = kResolution / std::abs(x2 - x1);
            if (f1 == 0.0) return x1;
            if (least > 0.5) return f1 > 0.0 ? x2 : x1;
            part = 0.5;
            const double xi = (x1 - x2) / (x3 - x2), phi = (f1 - f2) / (f3 - f2);
            if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
                part = f1 / (f2 - f1) * f3 / (f2 - f3) +
                       (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2);
            }
            part = std::clamp(part, least, 1.0 - least);
        }
    }

private:
    // Positive at both ends: could it be negative between? Falling at the start and rising at the
    // end, the two tangents meet at a lower bound where the function is convex; the stages' slopes,
    // taken over a part of the step, are made steeper by half to stand for the tangents.
    static bool may_dip(const EventSamples<M>& g, std::size_t i) {
        if (g.lowest[i] < 0.0) return true;
        const double falling = 1.5 * (g.early[i] - g.start[i]) / kEarly;
        const double rising = 1.5 * (g.end[i] - g.late[i]) / (1.0 - kLate);
        if (!(falling < 0.0 && rising > 0.0)) return false;
        const double meet = tangents_meet(g, i, falling, rising);
        return g.start[i] + falling * meet < 0.0 || g.end[i] - rising * (1.0 - meet) < 0.0;
    }

    static double tangents_meet(const EventSamples<M>& g, std::size_t i, double falling,
                                double rising) {
        return std::clamp((g.end[i] - g.start[i] - rising) / (falling - rising), 0.0, 1.0);
    }

    // Negative at the end: is there a root before `s`? Where an early stage was negative too, the
    // first root lies before it.
    template <class Value>
    static bool narrow(const EventSamples<M>& g, std::size_t i, Value&& value, double s,
                       Bracket& bracket) {
        if (s < 1.0) {
            bracket.high = s;
            bracket.at_high = value(i, s);
        }
        if (g.early[i] < 0.0 && kEarly < bracket.high) {
            const double at_early = value(i, kEarly);
            if (at_early < 0.0) {
                bracket.high = kEarly;
                bracket.at_high = at_early;
            }
        }
        return bracket.at_high < 0.0;
    }

    // Looks for a negative value on the dense output, by samples and then by closing in on the
    // least.
    template <class Value>
    static bool find_dip(const EventSamples<M>& g, std::size_t i, Value&& value, Bracket& bracket) {
        if (clearly_above(g, i, value)) return false;
        std::array<double, kSamples + 1> sample;
        sample[0] = g.start[i];
        sample[kSamples] = g.end[i];
        std::size_t least = g.start[i] < g.end[i] ? 0 : kSamples;
        for (std::size_t j = 1; j < kSamples; ++j) {
            sample[j] = value(i, at(j));
            if (sample[j] < 0.0) {
                bracket = {at(j - 1), at(j), sample[j - 1], sample[j]};
                return true;
            }
            if (sample[j] < sample[least]) least = j;
        }
        if (least == 0 || least == kSamples) return false;
        constexpr double kGolden = 0.3819660112501051;
        double a = at(least - 1), b = at(least + 1);
        double c = a + kGolden * (b - a), d = b - kGolden * (b - a);
        double at_c = value(i, c), at_d = value(i, d);
        for (int iteration = 0; iteration < 20; ++iteration) {
            if (at_c < 0.0 || at_d < 0.0) {
                bracket = {at(least - 1), at_c < 0.0 ? c : d, sample[least - 1],
                           at_c < 0.0 ? at_c : at_d};
                return true;
            }
            // The rest of the interval cannot hold a zero that matters once the two inner points
            // agree far more closely than they are above zero.
            if (std::abs(at_c - at_d) < 1e-3 * std::min(at_c, at_d)) return false;
            if (at_c < at_d) {
                b = d, d = c, at_d = at_c;
                c = a + kGolden * (b - a), at_c = value(i, c);
            } else {
                a = c, c = d, at_c = at_d;
                d = b - kGolden * (b - a), at_d = value(i, d);
            }
        }
        return false;
    }

    static constexpr std::size_t kSamples = 8;
    static double at(std::size_t sample) {
        return static_cast<double>(sample) / static_cast<double>(kSamples);
    }

    // A look or two settles most alarms. Where only a stage was negative (stages are not near the
    // solution), the dense output well above the lower end at both looks; where the slopes gave the
    // alarm, a parabola through a look at the tangents' meeting that stays well above zero.
    template <class Value>
    static bool clearly_above(const EventSamples<M>& g, std::size_t i, Value&& value) {
        const double falling = (g.early[i] - g.start[i]) / kEarly;
        const double rising = (g.end[i] - g.late[i]) / (1.0 - kLate);
        if (!(falling < 0.0 && rising > 0.0)) {
            const double floor = 0.5 * std::min(g.start[i], g.end[i]);
            return g.early[i] > floor && g.late[i] > 0.0 && value(i, 0.6) > floor &&
                   value(i, 0.95) > floor;
        }
        const double s = std::clamp(tangents_meet(g, i, falling, rising), 0.1, 0.9);
        const double middle = value(i, s);
        // g = start + b s + c s^2 through the three.
        const double c = ((g.end[i] - g.start[i]) - (middle - g.start[i]) / s) / (1.0 - s);
        const double b = (middle - g.start[i]) / s - c * s;
        if (!(c > 0.0)) return middle > 0.0;
        return g.start[i] - b * b / (4.0 * c) > 0.5 * middle;
    }

    template <class Value>
    static bool rises(std::size_t i, Value&& value, Bracket& bracket) {
        for (const double s : {0.5, 0.25, 0.75, 0.125, 0.0625, 0.015625, 0.001}) {
            const double at_s = value(i, s);
            if (at_s > 0.0) {
                bracket.low = s;
                bracket.at_low = at_s;
                return true;
            }
        }
        return false;
    }
};

}  // namespace stickslip
