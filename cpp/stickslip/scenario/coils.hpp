#pragma once

#include <string_view>
#include <vector>

#include "stickslip/body/robot_frame.hpp"
#include "stickslip/scenario/parameters.hpp"

/// The coils of a scenario: keys of all five, such as `coil.turns`, and of each, such as
/// `coil.xp.turns`.
namespace stickslip {

/// The rows of the keys of all coils, then of each.
std::vector<Parameter> coil_rows();

/// Whether a key is of a single coil: one of all coils set after it would undo it.
bool is_of_one_coil(std::string_view key);

/// The coils in the frame of the robot, which may be turned.
PerCoilOf<CoilParameters> robot_coils(const Scenario& scenario, const RobotFrame& frame);

/// Sources of the field: the windings of the scenario's coils, or its map.
CoilSet world_coil_set(const Scenario& scenario);
CoilSet robot_coil_set(const Scenario& scenario, const RobotFrame& frame);

/// Throws std::invalid_argument beside a map for the geometry of a coil, which would have no
/// effect.
void check_coils(const Scenario& scenario);

}  // namespace stickslip
