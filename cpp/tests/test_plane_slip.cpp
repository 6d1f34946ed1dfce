#include <doctest/doctest.h>

#include <cmath>

#include "plane_scenarios.hpp"
#include "stickslip/run/simulation.hpp"

using namespace stickslip;
using stickslip::test::alone;
using stickslip::test::along_and_across;
using stickslip::test::walking;

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
