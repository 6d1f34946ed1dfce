#pragma once

#include "stickslip/models/heat.hpp"
#include "stickslip/models/motion.hpp"
#include "stickslip/models/path.hpp"

/// Ready-made models of a diagnosis, of machines that are no robots; only bindings use them.
///
/// - motion: one mass with friction that sticks, or a motor and its load
/// - heat: one or two heat stores
/// - path: their steps in time, from event to event
namespace stickslip {}
