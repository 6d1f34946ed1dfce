#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stickslip/batch/lane_numbers.hpp"
#include "stickslip/run/run.hpp"
#include "stickslip/run/simulation.hpp"

namespace stickslip {

/// The widest that this processor has and that the environment variable STICKSLIP_LANES, a means of
/// measurement that is read once, allows: 4 or 8; at 1 every run goes alone.
const LaneKernels& lane_kernels();
/// All kernels for this processor, narrowest first; may be none. All give the same bits.
const std::vector<LaneKernels>& all_lane_kernels();

/// A run among others, and its place in their batch.
struct Lane {
    Lane(std::size_t place, const Scenario& scenario, RunControl& control,
         std::optional<StopCondition> stop = std::nullopt)
        : index(place), run(scenario, &control, stop) {}

    std::size_t index;
    Run run;
};

/// Plays the runs that `next` gives, until it gives none, up to `count` of them at a time on this
/// thread: runs that are in phases of the same kind make their steps as a pack. What is rare,
/// events, contacts and steps that need a closer look, is done run by run. Each has the bits that
/// it has alone. `done` is called with a run that has nothing more to play or was interrupted.
void play_in_lanes(const LaneKernels& kernels, std::size_t count,
                   const std::function<Lane*()>& next, const std::function<void(Lane&)>& done,
                   const RunControl& control);

}  // namespace stickslip
