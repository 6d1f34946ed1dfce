#include <doctest/doctest.h>

#include <cmath>
#include <utility>

#include "plane_scenarios.hpp"
#include "stickslip/run/simulation.hpp"

using namespace stickslip;
using stickslip::test::alone;
using stickslip::test::along_and_across;
using stickslip::test::walking;

// Beside the axis a slip that reverses passes zero, and static friction has to be asked all the
// same. With pairs of coils nothing pushes across, so that any heading has the planar velocity.
// From one plane to the whole the steps differ, whose error at rtol 1e-6 is some 1e-4.
TEST_CASE("plane: a slip that reverses sticks as in one plane, whatever the heading") {
    for (const DriveMode mode : {DriveMode::ipp, DriveMode::opp}) {
        for (const auto& [rtol, tolerance] :
             {std::pair(1e-6, 2e-4), std::pair(1e-8, 2e-6), std::pair(1e-10, 1e-6)}) {
            Scenario scenario = walking();
            scenario.drive.mode = mode;
            scenario.drive.coils = DriveCoils::pairs;
            scenario.solver.rtol = rtol;
            scenario.whole_plane = false;
            const double planar = simulate(scenario).summary.mean_velocity;
            scenario.whole_plane = true;
            for (const double heading : {0.0, 1e-9, 1e-6, 1e-4, 5e-4, 1e-2}) {
                CAPTURE(rtol);
                CAPTURE(heading);
                scenario.drive.heading = heading;
                const Slip found = along_and_across(simulate(scenario).summary, heading);
                CHECK(found.along == doctest::Approx(planar).epsilon(tolerance));
            }
        }
    }
}

// A single coil beside the axis pushes across, which lets the slip pass zero at a speed that goes
// with the heading. What that changes goes with it too: 1.1 times the heading for friction that is
// the same at rest, where nothing is captured, and for the paper's friction as well.
TEST_CASE("plane: a push across changes the velocity no more than it pushes") {
    for (const double at_rest : {0.145, 0.2}) {
        Scenario scenario = walking();
        scenario.drive.mode = DriveMode::opp;
        scenario.contact.static_friction = at_rest;
        const double straight = simulate(scenario).summary.mean_velocity;
        for (const double heading : {-5e-4, 1e-6, 1e-4, 5e-4}) {
            scenario.drive.heading = heading;
            const Slip found = along_and_across(simulate(scenario).summary, heading);
            CHECK(std::abs(found.along / straight - 1.0) < 2.0 * std::abs(heading) + 2e-6);
        }
    }
}

// Thrown up a slope of tan 0.17, below the static coefficient of 0.2, a block comes to rest after
// v^2 / 2 a, wherever downhill is. What the capture takes of the way is below 1e-9 of it, the turn
// downhill of 1e-3 rad some 1e-6.
TEST_CASE("plane: a block that slides up a slope rests where its slip ends") {
    const double slope = std::atan(0.17), speed = 0.05;
    for (const double azimuth : {0.0, 1e-9, 1e-6, 1e-3, -1e-3}) {
        Scenario scenario = alone(0.3);
        scenario.contact.adhesion = 0.0;
        scenario.effects.surface_tilt_angle = slope;
        scenario.effects.surface_tilt_azimuth = azimuth;
        scenario.initial.vx = -speed;
        const RunResult result = simulate(scenario);
        const double brake =
            scenario.gravity *
            (std::sin(slope) + scenario.contact.kinetic_friction * std::cos(slope));
        CHECK(result.final_state.contact == ContactWord::face_stick);
        CHECK(result.final_state.x ==
              doctest::Approx(-speed * speed / (2.0 * brake)).epsilon(2e-6));
    }
}

// Of the two that touch, friction is that of the place where the body touches, not of its corner.
TEST_CASE("plane: patches of friction act where a rounded body touches") {
    Scenario scenario = walking();
    scenario.effects.friction_patches_amplitude = 0.6;
    scenario.effects.friction_patches_period = 2e-5;
    scenario.effects.free_contact_place.span = 1.5;
    scenario.effects.free_contact_place.knots = {-0.2, 0.1, 0.0, 0.15, -0.1};
    const double turning = simulate(scenario).summary.mean_velocity;
    scenario.whole_plane = false;
    CHECK(turning == doctest::Approx(simulate(scenario).summary.mean_velocity).epsilon(2e-6));
}

// Near the angle at which sliding has no solution an impulse stops the slip, once: the robot then
// turns as in one plane.
TEST_CASE("plane: a slide without a solution is stopped by one impulse") {
    Scenario scenario = walking();
    scenario.drive.edge = Edge::rise;
    scenario.drive.mode = DriveMode::opp;
    scenario.drive.frequency = 161.0;
    scenario.drive.base = 0.4e-3;
    scenario.drive.peak = 3.7e-3;
    scenario.drive.hold = 3.2e-3;
    scenario.contact.static_friction = 2.45;
    scenario.contact.kinetic_friction = 0.39;
    scenario.effects.stribeck_friction_velocity = 23.9e-3;
    const RunResult turning = simulate(scenario);
    scenario.whole_plane = false;
    const RunResult planar = simulate(scenario);
    const auto jams = [](const RunResult& run) {
        return run.summary.events[static_cast<std::size_t>(EventKind::painleve)];
    };
    CHECK(jams(planar) > 0);
    CHECK(jams(turning) == jams(planar));
    CHECK(turning.summary.mean_velocity ==
          doctest::Approx(planar.summary.mean_velocity).epsilon(1e-3));
    CHECK(turning.summary.theta_max == doctest::Approx(planar.summary.theta_max).epsilon(1e-3));
}
