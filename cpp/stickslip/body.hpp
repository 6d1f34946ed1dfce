#pragma once

#include "stickslip/body/adhesion.hpp"
#include "stickslip/body/contact_place.hpp"
#include "stickslip/body/friction.hpp"
#include "stickslip/body/model.hpp"
#include "stickslip/body/rectangle.hpp"
#include "stickslip/body/smooth_effects.hpp"
#include "stickslip/body/user_effect.hpp"

/// The robot and what acts on it.
///
/// - rectangle, contact_place: its corners and faces; a contact beside the corner
/// - friction, adhesion, smooth_effects: the laws of the contact, with their extensions
/// - user_effect: a force and torque of the user's own
/// - model: all constants of the motion in one place
namespace stickslip {}
