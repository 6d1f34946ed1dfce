#pragma once

#include <vector>

#include "stickslip/scenario/parameters.hpp"

/// The named extensions `coil_xp` .. `coil_clamp`: one coil's own values in place of those of all.
namespace stickslip {

/// The table with the rows of these extensions after its own.
std::vector<Parameter> with_own_coils(std::vector<Parameter> rows);
std::vector<EffectDescription> with_own_coils(std::vector<EffectDescription> rows);

/// Each coil of the world's frame, with its own values where it has some.
PerCoilOf<CoilParameters> world_coils(const Scenario& scenario);

/// The same in the frame of the robot, which may be turned.
PerCoilOf<CoilParameters> robot_coils(const Scenario& scenario);

/// What makes the field: the windings of such coils, or the scenario's map.
CoilSet world_coil_set(const Scenario& scenario);
CoilSet robot_coil_set(const Scenario& scenario);

/// Throws std::invalid_argument for an own value that is neither 0 nor one that all coils may have,
/// and beside a map for the geometry of a coil, which would have no effect.
void check_own_coils(const Scenario& scenario);

}  // namespace stickslip
