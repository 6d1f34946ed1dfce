#pragma once

#include <vector>

#include "stickslip/body/laws.hpp"
#include "stickslip/body/robot_frame.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/scenario.hpp"

/// The named effects that are laws of friction, adhesion and drag. A row of named_laws.cpp is all
/// that one needs in the core.
namespace stickslip {

/// The tables with the rows of these effects after their own.
std::vector<Parameter> with_named_laws(std::vector<Parameter> rows);
std::vector<EffectDescription> with_named_laws(std::vector<EffectDescription> rows);

/// All laws of a scenario that are not absent, those of its named effects and its own, in the
/// robot's frame.
std::vector<Law> all_laws(const Scenario& scenario, const RobotFrame& frame);

}  // namespace stickslip
