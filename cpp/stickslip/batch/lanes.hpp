#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "stickslip/run/run.hpp"
#include "stickslip/run/simulation.hpp"

namespace stickslip {

/// A run among others, and its place in their batch.
struct Lane {
    Lane(std::size_t place, const Scenario& scenario, RunControl* control,
         std::optional<StopCondition> stop = std::nullopt)
        : index(place), run(scenario, control, stop) {}

    std::size_t index;
    Run run;
};

/// Plays the runs that `next` gives, until it gives none, up to `count` of them at a time on this
/// thread: runs that are in phases of the same kind make their steps as a pack. What is rare,
/// events, contacts and steps that need a closer look, is done run by run. Each has the bits that
/// it has alone. `done` is called with a run that has nothing more to play or was interrupted.
void play_in_lanes(const StepKernels& kernels, std::size_t count,
                   const std::function<Lane*()>& next, const std::function<void(Lane&)>& done,
                   const RunControl& control);

}  // namespace stickslip
