#pragma once

#include "stickslip/body/contact_place.hpp"
#include "stickslip/body/inner_mass.hpp"
#include "stickslip/body/laws.hpp"
#include "stickslip/body/model.hpp"
#include "stickslip/body/rectangle.hpp"
#include "stickslip/body/user_effect.hpp"

/// The robot and what acts on it.
///
/// - rectangle, contact_place: its corners and faces; a contact beside the corner
/// - laws: how friction, adhesion and drag depend on the motion
/// - inner_mass: a mass on a spring within the body
/// - user_effect: a force and torque of the user's own
/// - model: all constants of the motion in one place
namespace stickslip {}
