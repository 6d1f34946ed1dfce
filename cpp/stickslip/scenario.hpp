#pragma once

#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/free_shapes.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/record_columns.hpp"
#include "stickslip/scenario/scenario.hpp"
#include "stickslip/scenario/scenario_rows.hpp"
#include "stickslip/scenario/state.hpp"
#include "stickslip/scenario/user_effects.hpp"
#include "stickslip/scenario/whole_plane.hpp"

/// All that a run is told; data only.
///
/// - scenario, state: the values
/// - record_columns: what a recording has
/// - parameters, free_shapes, coils: every key with its unit, range and meaning
/// - whole_plane: whether the robot leaves the plane of motion, which voltages keep it there, and
/// which
///   way it faces
/// - user_effects: the registry of the user's own effects
/// - scenario_rows: many scenarios that differ in a few keys
namespace stickslip {}
