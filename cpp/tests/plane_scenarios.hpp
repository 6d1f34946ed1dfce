#pragma once

#include "stickslip/field/heading.hpp"
#include "stickslip/run/summary.hpp"
#include "stickslip/scenario/scenario.hpp"

/// Scenarios that the tests of the whole plane share.
namespace stickslip::test {

inline Scenario walking(double heading = 0.0) {
    Scenario scenario;
    scenario.drive.base = 0.5e-3;
    scenario.drive.pulses = 8;
    scenario.drive.heading = heading;
    scenario.whole_plane = true;
    return scenario;
}

// A robot on its face without field or drag, that is left alone for a time (s).
inline Scenario alone(double duration) {
    Scenario scenario;
    scenario.whole_plane = true;
    scenario.drive.mode = DriveMode::program;
    const PerCoil off = {};
    scenario.program = VoltageProgram({{{{0.0, off}, {duration, off}}, 1}});
    scenario.drag = {0.0, 0.0};
    scenario.robot.magnetization = 0.0;
    return scenario;
}

inline Slip along_and_across(const Summary& summary, double heading) {
    return Heading::of_angle(heading).seen(summary.mean_velocity, summary.mean_velocity_y);
}

}  // namespace stickslip::test
