#pragma once

#include <string>
#include <vector>

#include "stickslip/body/model.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

/// The angle theta (rad) at which the robot rests in a uniform field bx, bz (T, the robot's own
/// frame): Eqs. (11) and (12) without motion. From lying flat it turns to where the forces first
/// hold it, which is where a field that is raised slowly from zero leaves it: flat while the field
/// does not lift an end against weight and adhesion, else balanced on the corner it pivots on, or
/// on the next face. The pivot is taken as pinned. NaN where nothing holds it within a full turn.
double static_tilt(const Model& model, double bx, double bz);

/// Static tilts (rad). `values` holds a row for each point, a
/// column for each numeric key, as in `sweep`; `fields` holds Bx and Bz (T, world) of the coils at
/// the robot, to which `ambient_field` is added. One row of readings a point, one after another;
/// NaN in a row whose values make no scenario. Throws std::invalid_argument for an unknown key or a
/// size that does not fit.
std::vector<double> static_tilts(const Scenario& base, const std::vector<std::string>& keys,
                                 const std::vector<double>& values,
                                 const std::vector<double>& fields);

}  // namespace stickslip
