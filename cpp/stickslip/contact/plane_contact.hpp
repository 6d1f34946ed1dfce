#pragma once

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/plane_dynamics.hpp"

namespace stickslip {

/// Outcome of asking which mode is consistent with the forces in the whole plane. A contact that
/// slips has a velocity, of the least size where it has only begun to.
struct PlaneResolution {
    Resolution upright;
    Slip slip;  ///< m/s
};

/// As `resolve_contact`, with friction as a vector: a contact at rest, or slower than the capture
/// speed, sticks within the cone of the static coefficient; one that breaks loose from rest slips
/// the way in which it is accelerated. `body` has the world's place and the heading's velocities
/// (vx along, vy across). `is_loose`: an event has just broken the contact loose.
PlaneResolution resolve_plane_contact(PlaneDynamics& plane, double tau, const BodyState& body,
                                      Touch touch, const Slip& slip, bool is_loose);

}  // namespace stickslip
