#pragma once

#include <vector>

#include "stickslip/body/laws.hpp"
#include "stickslip/body/robot_frame.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

/// All laws of a scenario that are not absent, those of its named effects and its own, in the
/// robot's frame.
std::vector<Law> all_laws(const Scenario& scenario, const RobotFrame& frame);

}  // namespace stickslip
