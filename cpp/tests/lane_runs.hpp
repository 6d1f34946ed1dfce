#pragma once

#include <vector>

#include "stickslip/batch/batch.hpp"

namespace stickslip::test {

/// The results of all scenarios, `count` at a time in lanes on this thread.
inline std::vector<RunResult> simulate_in_lanes(const LaneKernels& kernels, std::size_t count,
                                                const std::vector<Scenario>& scenarios) {
    std::vector<RunResult> results(scenarios.size());
    std::size_t next = 0;
    RunControl control;
    LaneStore lanes;
    play_in_lanes(
        kernels, count,
        [&]() -> Lane* {
            if (next == scenarios.size()) return nullptr;
            const std::size_t index = next++;
            return lanes.make(index, scenarios[index], control);
        },
        [&](Lane& lane) {
            results[lane.index] = lane.run.take_result();
            lanes.erase(lane);
        },
        control);
    return results;
}

}  // namespace stickslip::test
