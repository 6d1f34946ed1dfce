#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "stickslip/lane_numbers.hpp"
#include "stickslip/simulation.hpp"

namespace stickslip {

/// A scenario of a batch, and its place there.
struct LaneTask {
    std::size_t index = 0;
    Scenario scenario;
};

/// Simulates tasks until `next` gives none, up to `count` of them at a time on this thread: runs
/// that are in phases of the same kind make their steps as a pack. What is rare, events, contacts
/// and steps that need a closer look, is done run by run. Each result, which goes to `done`, has
/// the bits that `simulate` gives it.
void simulate_in_lanes(const LaneKernels& kernels, std::size_t count,
                       const std::function<std::optional<LaneTask>()>& next,
                       const std::function<void(std::size_t, RunResult&&)>& done,
                       RunControl& control);

}  // namespace stickslip
