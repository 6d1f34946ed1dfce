#include <doctest/doctest.h>

#include "stickslip/batch/batch.hpp"

using namespace stickslip;

TEST_CASE("lanes: a stop ends them all") {
    Scenario endless;
    endless.drive.base = 0.5e-3;
    endless.drive.pulses = 100'000'000;
    RunControl control;
    int taken = 0, ended = 0;
    LaneStore lanes;
    play_in_lanes(
        step_kernels(), 8,
        [&] {
            if (++taken == 8) control.stop = true;
            return lanes.make(0, endless, control);
        },
        [&](Lane& lane) {
            CHECK(lane.run.status() == Status::interrupted);
            ++ended;
            lanes.erase(lane);
        },
        control);
    CHECK(taken == 8);
    CHECK(ended == 8);
}
