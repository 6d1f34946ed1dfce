#pragma once

#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/expansion.hpp"
#include "stickslip/field/field_map.hpp"
#include "stickslip/field/field_shape.hpp"
#include "stickslip/field/heading.hpp"
#include "stickslip/field/square_coil.hpp"
#include "stickslip/field/turning_points.hpp"

/// From currents to the field.
///
/// - square_coil: the field of four straight wires, Eqs. (2)-(7), with its derivatives
/// - coil_set, field_map: the field of all coils, by the formula or as it was measured
/// - expansion: its series about a place near the robot, in the plane of motion or in space, over a
///   segment of voltage
/// - field_shape: what multiplies it in the course of a run
/// - heading: where a robot on the surface faces
/// - turning_points: where currents and |B| turn within a segment
namespace stickslip {}
