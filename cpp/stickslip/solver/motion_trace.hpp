#pragma once

#include "stickslip/numbers/pack.hpp"

namespace stickslip {

/// The cubic that has given values and slopes at both ends of a step, over the fraction s of it.
/// Slopes are by s.
template <class Real>
class CubicHermite {
public:
    [[gnu::always_inline]] CubicHermite(Real value0, Real slope0, Real value1, Real slope1)
        : c0_(value0), c1_(slope0) {
        const Real d = value1 - value0;
        c2_ = 3.0 * d - 2.0 * slope0 - slope1;
        c3_ = slope0 + slope1 - 2.0 * d;
    }
    [[gnu::always_inline]] Real at(Real s) const {
        return fma(s, fma(s, fma(s, c3_, c2_), c1_), c0_);
    }
    /// Zero of the slope, which has different signs at the two ends.
    [[gnu::always_inline]] Real turning_point() const {
        const Real size = root(c2_ * c2_ - 3.0 * c1_ * c3_);
        return c1_ / (select(c1_ > 0.0, size, -size) - c2_);
    }

private:
    Real c0_, c1_, c2_, c3_;
};

/// Extremes of the motion in a phase, for the summary: numbers alone, as in Tsit5Progress.
template <class Real>
struct MotionTrace {
    Real lowest, highest;  ///< rad, angles within the quadrant
    // m, of a contact's slip along x or, of a robot that turns, along its front as the phase began:
    // at the last turning point, or at the start.
    Real slip_x;
    Real rising = 0, falling = 0;  ///< m, slip up to there while the angle rose and fell

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(lowest, highest, slip_x, rising, falling);
    }

    /// A step of `width` s between two states.
    template <class Phase, class State>
    [[gnu::always_inline]] void step(const Phase& phase, Real width, const State& first,
                                     const State& last) {
        const Real before = phase.omega(first), after = phase.omega(last);
        see(phase.angle(last));
        const auto turns = before * after < 0.0;
        if (!any(turns)) return;
        const CubicHermite<Real> angle(phase.angle(first), before * width, phase.angle(last),
                                       after * width);
        const Real s = angle.turning_point();
        see(select(turns, angle.at(s), phase.angle(last)));
        if constexpr (Phase::kSlips) {
            const CubicHermite<Real> x(phase.slip_place(first), phase.slip_speed(first) * width,
                                       phase.slip_place(last), phase.slip_speed(last) * width);
            const Real turning_x = x.at(s);
            const Real slipped = turning_x - slip_x;
            const auto rises = before > 0.0;
            rising = select(turns & rises, rising + slipped, rising);
            falling = select(turns & !rises, falling + slipped, falling);
            slip_x = select(turns, turning_x, slip_x);
        }
    }

private:
    [[gnu::always_inline]] void see(Real angle) {
        lowest = lesser(lowest, angle);
        highest = greater(highest, angle);
    }
};

}  // namespace stickslip
