#pragma once

#include "stickslip/body/robot_frame.hpp"
#include "stickslip/drive/sawtooth.hpp"
#include "stickslip/field/heading.hpp"
#include "stickslip/scenario/scenario.hpp"

/// Whether the robot of a scenario moves in the whole plane of the surface, and which way.
namespace stickslip {

RobotFrame frame_of(const Scenario& scenario);

/// Throws std::invalid_argument for what has no meaning in the whole plane.
void check_plane(const Scenario& scenario, const RobotFrame& frame);

/// Direction in which the drive sends the robot. A program, whose voltages do that themselves, has
/// only the direction that the robot faces before.
SurfaceDirection drive_direction(const Scenario& scenario);

/// Whether held voltages, or currents, turn the scenario's robot, or push it across.
bool in_whole_plane(const Scenario& scenario, const PerCoil& of_coils);

/// Throws std::invalid_argument for voltages (V) that would turn a robot whose stepped run stays in
/// one plane.
void check_planar_step(const Scenario& scenario, const PerCoil& voltages);

/// Where the robot of a run in the whole plane faces at the start, as long as the field is too weak
/// to say: as its initial state says, or else where the drive sends it.
Heading start_heading(const Scenario& scenario);

}  // namespace stickslip
