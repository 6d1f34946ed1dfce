#pragma once

#include "stickslip/contact/contact.hpp"

namespace stickslip {

/// Which corner of a face meets the surface newly in an impact. The other one, if any, touched
/// before.
enum class Arrival { ahead, behind, both };

/// The inner mass as it meets a stop.
struct Strike {
    double x = 0.0, z = 0.0;   ///< unit vector along which it strikes the body
    double speed = 0.0;        ///< m/s, in the body, before
    double restitution = 0.0;  ///< Newton's
};

/// Robot and contact just after an impact.
struct ImpactResult {
    BodyState body;
    Touch touch = Touch::none;
    double slip_velocity = 0.0;  ///< m/s, exactly zero where the contact sticks
    double slip_across = 0.0;    ///< m/s, the same across the plane of motion
};

/// Impact of the quadrant's lowest corner out of flight: Newton restitution with impulsive Coulomb
/// friction (kinetic coefficient), which reverses a part of the slip where the tangential
/// restitution says so. Where that would raise the kinetic energy, both restitutions are reduced to
/// the largest part for which it does not. time: s, since the run began, which a friction that ages
/// asks for. An impact has no slip velocity and an infinite normal force, so that of the free
/// shapes of friction `speed` does not act and `load` has its last knot. With a velocity across the
/// plane of motion (`before.vy`) friction is a vector against the slip after the impact. cosine: of
/// the angle from the x axis of `before` to the plane of motion, which a friction that differs from
/// place to place asks for.
ImpactResult corner_impact(const Model& model, const Pose& pose, const BodyState& before,
                           double time = 0.0, double cosine = 1.0);

/// Impact of a face at angle 0 of `before.quadrant`, both corners solved together as one
/// complementarity problem: the arriving corner has the kinetic coefficient and the restitution
/// (both reduced as above by one factor), the one that already touched has the static coefficient
/// where it stuck (`old_slips` false), else the kinetic.
ImpactResult face_impact(const Model& model, const BodyState& before, Arrival arrival,
                         bool old_slips, double time = 0.0);

/// Impact of the inner mass on its stop, whose impulse passes through the centre of mass, and at
/// the same instant of what touches on the surface, without restitution: with the static
/// coefficient where it stuck (`slips` false), else the kinetic. Adhesion gives no impulse. The
/// restitution of the strike is reduced as above, and then is what it was.
ImpactResult stop_impact(const Model& model, const Pose& pose, const BodyState& before, Touch touch,
                         bool slips, Strike& strike, double time = 0.0);

}  // namespace stickslip
