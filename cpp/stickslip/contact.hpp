#pragma once

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/contact/dynamics.hpp"
#include "stickslip/contact/face_phases.hpp"
#include "stickslip/contact/frame.hpp"
#include "stickslip/contact/heading_watch.hpp"
#include "stickslip/contact/impact.hpp"
#include "stickslip/contact/phase_of.hpp"
#include "stickslip/contact/phases.hpp"
#include "stickslip/contact/plane_dynamics.hpp"
#include "stickslip/contact/turning_frame.hpp"

/// Mechanics of the contact: sticking, slipping, flight, impact.
///
/// - dynamics: force and torque on the body; plane_dynamics: the same along a heading, and across
/// - frame, turning_frame: the plane of motion, fixed or turning with the field
/// - contact: reactions, and the mode that the forces allow, in a frame
/// - phases, face_phases: the motion between two events, in a frame; phase_of: that of a state
/// - impact: touch-down; contact_transitions: what an event makes of the state
/// - heading_watch: whether the heading is known
namespace stickslip {}
