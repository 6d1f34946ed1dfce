#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "stickslip/batch/simulator.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/simulation.hpp"

// How a run comes into the whole plane: by its scenario or by its state.

using namespace stickslip;

namespace {

constexpr double kStep = 2e-3;  // s
constexpr std::size_t kReversals = static_cast<std::size_t>(EventKind::reversal);

Scenario program_of(const PerCoil& held, double duration) {
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    scenario.program = VoltageProgram({{{{0.0, held}, {duration, held}}, 1}});
    return scenario;
}

}  // namespace

TEST_CASE("plane: before a program has a field along the surface, its direction says the heading") {
    Scenario scenario = program_of({0.0, 0.0, 0.0, 0.0, -10.0}, 0.1);
    scenario.drive.direction = Direction::minus_x;
    const SimulationState planar = simulate(scenario).final_state;
    scenario.initial.y = 1e-12;
    REQUIRE(frame_of(scenario).whole_plane);
    const SimulationState turning = simulate(scenario).final_state;
    CHECK(planar.x < -1e-5);
    CHECK(turning.x == doctest::Approx(planar.x).epsilon(1e-6));
    CHECK(turning.theta == doctest::Approx(planar.theta).epsilon(1e-6));
    CHECK(planar.heading == std::numbers::pi);
    CHECK(turning.heading == doctest::Approx(std::numbers::pi).epsilon(1e-6));
}

TEST_CASE("plane: coils of y that are unlike turn a stepped robot by voltages that cancel") {
    constexpr PerCoil kCancelling = {10.0, 0.0, 25.0, -25.0, -10.0};
    const auto stepped = [&](const Scenario& scenario) {
        Simulator simulator(scenario);
        for (int n = 0; n < 20; ++n) simulator.step(kCancelling, kStep, false);
        return simulator.state().heading;
    };
    Scenario scenario;
    CHECK(stepped(scenario) == 0.0);
    scenario.coils[2].distance = 1e-3;
    CHECK_THROWS_AS(stepped(scenario), std::invalid_argument);
    scenario.whole_plane = true;
    const double heading = stepped(scenario);
    CHECK(heading != 0.0);
    const RunResult at_once = [&] {
        Scenario whole = program_of(kCancelling, 20 * kStep);
        whole.coils = scenario.coils;
        return simulate(whole);
    }();
    CHECK(heading == doctest::Approx(at_once.final_state.heading).epsilon(1e-6));
    // So do currents that are there as the run begins.
    scenario.whole_plane = false;
    scenario.initial.current = {0.0, 0.0, 1.0, -1.0, 0.0};
    CHECK(frame_of(scenario).whole_plane);
}

TEST_CASE("plane: a run takes no snapshot of the other kind of run") {
    Scenario scenario;
    Simulator planar(scenario);
    scenario.whole_plane = true;
    Simulator turning(scenario);
    CHECK_THROWS_AS(planar.restore(turning.snapshot()), std::invalid_argument);
    CHECK_THROWS_AS(turning.restore(planar.snapshot()), std::invalid_argument);
}

TEST_CASE("plane: the contact of a state slips forward or backward along the heading") {
    Scenario scenario = program_of({}, 1e-4);
    scenario.whole_plane = true;
    scenario.robot.magnetization = 0.0;
    for (const double heading : {0.0, 0.5 * std::numbers::pi, 2.5}) {
        for (const double along : {0.02, -0.02}) {
            CAPTURE(heading);
            CAPTURE(along);
            const Slip velocity = {along, 0.01};
            const Heading ahead = Heading::of_angle(heading);
            scenario.initial = {};
            scenario.initial.heading = heading;
            scenario.initial.vx = ahead.x(velocity);
            scenario.initial.vy = ahead.y(velocity);
            const RunResult first = simulate(scenario);
            CHECK(first.final_state.contact ==
                  (along > 0.0 ? ContactWord::face_slip_forward : ContactWord::face_slip_backward));
            CHECK(first.summary.events[kReversals] == 0);
            // It begins a run that goes on with that slip.
            scenario.initial = first.final_state;
            const RunResult second = simulate(scenario);
            CHECK(second.final_state.contact == first.final_state.contact);
            CHECK(second.summary.events[kReversals] == 0);
        }
    }
}
