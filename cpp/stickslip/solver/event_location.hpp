#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <tuple>

#include "stickslip/numbers/function_ref.hpp"
#include "stickslip/numbers/pack.hpp"

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

    /// Fraction of the step at which the tangents at the ends, of these two slopes, meet.
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

    /// Samples of function i alone.
    EventSamples<1, Real> only(std::size_t i) const {
        return {{start[i]}, {end[i]}, {early[i]}, {late[i]}, {lowest[i]}};
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

/// Where in a step, before the fraction `until`, one event function falls through zero: `g` is of
/// that function, `value(s)` it on the dense output. See find_event.
std::optional<double> first_fall(const EventSamples<1>& g, bool armed, bool stalled, double until,
                                 FunctionRef<double(double)> value);

/// The first event of a step among M event functions. `value(i, s)` is event function i on the
/// dense output. armed: whether each event function has been positive in this phase, brought up to
/// date. A function that is zero at the phase's birth (a slip that has just begun) can fire only
/// after it has risen; one that does not rise fires at once, at s = 0, or, where the last events
/// brought the time no further (`stalled`), at the end of the step. An armed one that is not
/// positive as the step begins (forces may jump between two segments) fires at once too.
template <std::size_t M>
EventHit find_event(const EventSamples<M>& g, auto& armed, bool stalled,
                    FunctionRef<double(std::size_t, double)> value) {
    EventHit hit;
    for (std::size_t i = 0; i < M; ++i) {
        const bool is_quiet =
            armed[i] ? g.start[i] > 0.0 && g.end[i] > 0.0 && !g.may_dip(i) : g.rises(i);
        if (is_quiet) continue;
        const std::optional<double> s = first_fall(g.only(i), armed[i], stalled, hit.s,
                                                   [&](double at) { return value(i, at); });
        if (!s) continue;
        if (!hit || *s < hit.s) hit = {static_cast<int>(i), *s};
        if (*s == 0.0) return hit;
    }
    if (!hit) {
        for (std::size_t i = 0; i < M; ++i) armed[i] = armed[i] || g.end[i] > 0.0;
    }
    return hit;
}

/// Where in a step one function falls through zero, from a start above it. `value(s)` is evaluated
/// on the dense output.
EventHit find_fall(FunctionRef<double(double)> value);

}  // namespace stickslip
