#pragma once

#include "stickslip/readings/probe.hpp"
#include "stickslip/readings/static_tilt.hpp"

/// Readings that a diagnosis computes from the model without a run.
///
/// - static_tilt: the angle at which the robot leans at rest
/// - probe: the field of the coils at some places
namespace stickslip {}
