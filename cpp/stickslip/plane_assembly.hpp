#pragma once

#include "stickslip/drive.hpp"
#include "stickslip/plane_dynamics.hpp"
#include "stickslip/scenario.hpp"

/// Whether the robot of a scenario moves in the whole plane of the surface, and which way.
namespace stickslip {

/// Throws std::invalid_argument for what has no meaning in the whole plane.
void check_plane(const Scenario& scenario);

/// Where the drive sends the robot.
SurfaceDirection drive_direction(const Scenario& scenario);

/// Whether the robot moves in the whole plane of the surface, and not along x alone: something
/// turns it, or pushes it across.
bool turns(const Scenario& scenario);

/// Whether held voltages turn a robot, or push it across.
bool turns(const PerCoil& voltages);
/// The scenario of a run that goes on from `state` in the whole plane.
Scenario in_whole_plane(const Scenario& scenario, const SimulationState& state);

/// Where the robot of a run in the whole plane faces at the start, as long as the field is too weak
/// to say: where a pulsed drive sends it, or as its initial state says.
Heading start_heading(const Scenario& scenario);

}  // namespace stickslip
