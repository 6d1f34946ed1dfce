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

    /// armed: whether each event function has been positive in this phase, brought up to date. A
    /// function that is zero at the phase's birth (a slip that has just begun) can fire only after
    /// it has risen.
    template <class Armed, class Value>
    static EventHit find(const EventSamples<M>& g, Armed& armed, Value&& value) {
        EventHit hit;
        for (std::size_t i = 0; i < M; ++i) {
            double low = 0.0, high = -1.0;  // a bracket where high > 0
            if (armed[i]) {
                if (g.end[i] < 0.0) {
                    high = 1.0;
                } else if (may_dip(g, i)) {
                    search_dip(g, i, value, low, high);
                }
            } else if (g.end[i] < 0.0) {
                // Born at zero and below it now: it may have risen in between.
                if (!rises(i, value, low)) return {static_cast<int>(i), 0.0};
                high = 1.0;
            }
            if (high <= 0.0 || low >= hit.s) continue;
            const double s = locate(i, low, high, value);
            if (!hit || s < hit.s) hit = {static_cast<int>(i), s};
        }
        if (!hit) {
            for (std::size_t i = 0; i < M; ++i) armed[i] = armed[i] || g.end[i] > 0.0;
        }
        return hit;
    }

    /// Root of function i in [low, high], positive at `low` and not at `high`: the far side.
    template <class Value>
    static double locate(std::size_t i, double low, double high, Value&& value) {
        double at_low = value(i, low), at_high = value(i, high);
        if (!(at_low > 0.0)) return low;
        // Regula falsi with the Anderson-Bjorck weights, guarded by bisection.
        double width = high - low;
        for (int iteration = 0; iteration < 100 && high - low > 1e-14; ++iteration) {
            double s = high - at_high * (high - low) / (at_high - at_low);
            if (iteration % 3 == 2 && high - low > 0.25 * width) s = 0.5 * (low + high);
            if (iteration % 3 == 2) width = high - low;
            s = std::clamp(s, low + 0.25e-14, high - 0.25e-14);
            const double at_s = value(i, s);
            if (at_s > 0.0) {
                const double ratio = 1.0 - at_s / at_low;
                at_high *= ratio > 0.0 ? ratio : 0.5;
                low = s;
                at_low = at_s;
            } else {
                const double ratio = at_high < 0.0 ? 1.0 - at_s / at_high : 0.5;
                at_low *= ratio > 0.0 ? ratio : 0.5;
                high = s;
                at_high = at_s;
                if (at_s == 0.0) break;
            }
        }
        return high;
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
        const double meet =
            std::clamp((g.end[i] - g.start[i] - rising) / (falling - rising), 0.0, 1.0);
        return g.start[i] + falling * meet < 0.0 || g.end[i] - rising * (1.0 - meet) < 0.0;
    }

    // Looks for a negative value on the dense output, by samples and then by closing in on the
    // least.
    template <class Value>
    static void search_dip(const EventSamples<M>& g, std::size_t i, Value&& value, double& low,
                           double& high) {
        constexpr int kSamples = 8;
        std::array<double, kSamples + 1> sample;
        sample[0] = g.start[i];
        sample[kSamples] = g.end[i];
        std::size_t least = g.start[i] < g.end[i] ? 0 : kSamples;
        for (std::size_t j = 1; j < kSamples; ++j) {
            const double s = static_cast<double>(j) / kSamples;
            sample[j] = value(i, s);
            if (sample[j] < 0.0) {
                low = static_cast<double>(j - 1) / kSamples;
                high = s;
                return;
            }
            if (sample[j] < sample[least]) least = j;
        }
        if (least == 0 || least == kSamples) return;
        constexpr double kGolden = 0.3819660112501051;
        const double floor = static_cast<double>(least - 1) / kSamples;
        double a = floor, b = static_cast<double>(least + 1) / kSamples;
        double c = a + kGolden * (b - a), d = b - kGolden * (b - a);
        double at_c = value(i, c), at_d = value(i, d);
        for (int iteration = 0; iteration < 20; ++iteration) {
            if (at_c < 0.0 || at_d < 0.0) {
                low = floor;
                high = at_c < 0.0 ? c : d;
                return;
            }
            // The rest of the interval cannot hold a zero that matters once the two inner points
            // agree far more closely than they are above zero.
            if (std::abs(at_c - at_d) < 1e-3 * std::min(at_c, at_d)) return;
            if (at_c < at_d) {
                b = d, d = c, at_d = at_c;
                c = a + kGolden * (b - a), at_c = value(i, c);
            } else {
                a = c, c = d, at_c = at_d;
                d = b - kGolden * (b - a), at_d = value(i, d);
            }
        }
    }

    template <class Value>
    static bool rises(std::size_t i, Value&& value, double& low) {
        for (const double s : {0.5, 0.25, 0.75, 0.125, 0.0625, 0.015625, 0.001}) {
            if (value(i, s) > 0.0) {
                low = s;
                return true;
            }
        }
        return false;
    }
};

}  // namespace stickslip
