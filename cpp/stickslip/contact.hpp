#pragma once

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/contact/dynamics.hpp"
#include "stickslip/contact/face_slide.hpp"
#include "stickslip/contact/heading_watch.hpp"
#include "stickslip/contact/hybrid_state.hpp"
#include "stickslip/contact/impact.hpp"
#include "stickslip/contact/phases.hpp"
#include "stickslip/contact/plane_contact.hpp"
#include "stickslip/contact/plane_dynamics.hpp"
#include "stickslip/contact/rest.hpp"

/// What a contact does: sticks, slips, flies, meets the surface.
///
/// - dynamics: force and torque on the body; plane_dynamics: the same along a heading
/// - contact, plane_contact: reactions, and the mode that the forces allow; hybrid_state: what goes
///   on from phase to phase
/// - phases, face_slide, rest: the motion between two events; plane_*: in the whole plane
/// - impact: touch-down; contact_transitions: what an event makes of the state
/// - heading_watch: whether the heading is known
namespace stickslip {}
