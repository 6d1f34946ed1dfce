#pragma once

#include "stickslip/numbers/pack.hpp"

namespace stickslip {

/// The polynomial of fifth degree that has given values, slopes and curvatures at both ends of a
/// step, over the fraction s of it. Slopes and curvatures are by s.
template <class Real>
class QuinticHermite {
public:
    [[gnu::always_inline]] QuinticHermite(Real value0, Real slope0, Real curvature0, Real value1,
                                          Real slope1, Real curvature1)
        : c0_(value0), c1_(slope0), c2_(0.5 * curvature0) {
        const Real d = value1 - value0;
        c3_ = 10.0 * d - 6.0 * slope0 - 4.0 * slope1 - 1.5 * curvature0 + 0.5 * curvature1;
        c4_ = 8.0 * slope0 + 7.0 * slope1 - 15.0 * d + 1.5 * curvature0 - curvature1;
        c5_ = 6.0 * d - 3.0 * slope0 - 3.0 * slope1 - 0.5 * curvature0 + 0.5 * curvature1;
    }
    [[gnu::always_inline]] Real at(Real s) const {
        return c0_ + s * (c1_ + s * (c2_ + s * (c3_ + s * (c4_ + s * c5_))));
    }
    /// Where the slope, which has different signs at the two ends, is zero. Over a step it is
    /// nearly straight: three of Newton's steps leave nothing that the value there would show.
    [[gnu::always_inline]] Real turning_point(Real slope0, Real slope1) const {
        Real s = slope0 / (slope0 - slope1);
        for (int i = 0; i < 3; ++i) {
            const Real slope =
                c1_ + s * (2.0 * c2_ + s * (3.0 * c3_ + s * (4.0 * c4_ + s * (5.0 * c5_))));
            const Real curvature =
                2.0 * c2_ + s * (6.0 * c3_ + s * (12.0 * c4_ + s * (20.0 * c5_)));
            // In this order what is no number becomes an end.
            s = lesser(Real(1.0), greater(Real(0.0), s - slope / curvature));
        }
        return s;
    }

private:
    Real c0_, c1_, c2_, c3_, c4_, c5_;
};

/// Of a contact's slip what the summary counts: along x or, of a robot that turns, along its front
/// as the phase began.
template <class Phase>
[[gnu::always_inline]] inline auto slip_place(const Phase& phase, const auto& y) {
    if constexpr (Phase::kTurns) {
        return phase.place_along(y);
    } else {
        return phase.contact_x(y);
    }
}
template <class Phase>
[[gnu::always_inline]] inline auto slip_speed(const Phase& phase, const auto& y) {
    if constexpr (Phase::kTurns) {
        return phase.slip_along(y);
    } else {
        return phase.slip_velocity(y);
    }
}

/// What the summary wants of the motion in a phase: numbers alone, as in Tsit5Progress.
template <class Real>
struct MotionTrace {
    Real lowest, highest;          ///< rad, angles within the quadrant
    Real slip_x;                   ///< m, `slip_place` at the last turning point, or at the start
    Real rising = 0, falling = 0;  ///< m, slip up to there while the angle rose and fell

    /// A step of `width` s between two states with their rates.
    template <class Phase, class State>
    [[gnu::always_inline]] void step(const Phase& phase, Real width, const State& first,
                                     const State& first_rates, const State& last,
                                     const State& last_rates) {
        const Real before = phase.omega(first), after = phase.omega(last);
        see(phase.angle(last));
        const auto turns = before * after < 0.0;
        if (!any(turns)) return;
        const QuinticHermite<Real> angle(
            phase.angle(first), before * width, phase.omega(first_rates) * width * width,
            phase.angle(last), after * width, phase.omega(last_rates) * width * width);
        const Real s = angle.turning_point(before, after);
        see(select(turns, angle.at(s), phase.angle(last)));
        if constexpr (Phase::kSlips) {
            const QuinticHermite<Real> x(
                slip_place(phase, first), slip_speed(phase, first) * width,
                phase.slip_acceleration(first, first_rates) * width * width,
                slip_place(phase, last), slip_speed(phase, last) * width,
                phase.slip_acceleration(last, last_rates) * width * width);
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
