#pragma once

#include "stickslip/contact/contact.hpp"
#include "stickslip/scenario/state.hpp"

namespace stickslip {

struct Scenario;

/// Where a run begins, in the robot's own frame.
struct Start {
    HybridState state;
    double contact_age = 0.0;   ///< s
    bool touches_down = false;  ///< a corner on the surface approaches it: an impact comes first
};

/// The start of a run from `scenario.initial`. Throws std::invalid_argument, with key, value and
/// what is allowed, for a state that cannot be: below the surface, a contact that does not touch, a
/// corner that sticks and moves.
Start initial_state(const Scenario& scenario, const Model& model);

/// A state of a run as others see it, without its currents.
SimulationState world_state(const HybridState& state, double contact_age, double frame_sign,
                            bool in_whole_plane);

}  // namespace stickslip
