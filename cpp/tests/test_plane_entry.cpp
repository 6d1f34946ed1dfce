#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

#include "stickslip/batch/simulator.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/simulation.hpp"

// How a run comes into the whole plane: by its scenario, by a step, from a snapshot or a state.

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

void check_same(const SimulationState& one, const SimulationState& other) {
    CHECK(row_of(one) == row_of(other));
}

}  // namespace

TEST_CASE("plane: before a program has a field along the surface, its direction says the heading") {
    Scenario scenario = program_of({0.0, 0.0, 0.0, 0.0, -10.0}, 0.1);
    scenario.drive.direction = Direction::minus_x;
    const SimulationState planar = simulate(scenario).final_state;
    scenario.initial.y = 1e-12;
    REQUIRE(turns(scenario));
    const SimulationState turning = simulate(scenario).final_state;
    CHECK(planar.x < -1e-5);
    CHECK(turning.x == doctest::Approx(planar.x).epsilon(1e-6));
    CHECK(turning.theta == doctest::Approx(planar.theta).epsilon(1e-6));
    CHECK(planar.heading == std::numbers::pi);
    CHECK(turning.heading == doctest::Approx(std::numbers::pi).epsilon(1e-6));
}

TEST_CASE("plane: the heading of a drive is not that of a program") {
    Scenario scenario = program_of({25.0, 0.0, 0.0, 0.0, -10.0}, 0.05);
    const SimulationState expected = simulate(scenario).final_state;
    scenario.drive.heading = 3.0;
    check_same(simulate(scenario).final_state, expected);
}

TEST_CASE("plane: coils of y that are unlike turn a stepped robot by voltages that cancel") {
    constexpr PerCoil kCancelling = {10.0, 0.0, 25.0, -25.0, -10.0};
    Scenario scenario;
    const auto stepped = [&] {
        Simulator simulator(scenario);
        for (int n = 0; n < 20; ++n) simulator.step(kCancelling, kStep, false);
        return simulator.snapshot().in_whole_plane ? simulator.state().heading : 0.0;
    };
    CHECK(stepped() == 0.0);
    scenario.coils[2].distance = 1e-3;
    const double heading = stepped();
    CHECK(heading != 0.0);
    const RunResult at_once = [&] {
        Scenario whole = program_of(kCancelling, 20 * kStep);
        whole.coils = scenario.coils;
        return simulate(whole);
    }();
    CHECK(heading == doctest::Approx(at_once.final_state.heading).epsilon(1e-6));
    // So do currents that are there as the run begins.
    scenario.initial.current = {0.0, 0.0, 1.0, -1.0, 0.0};
    CHECK(turns(scenario));
}

TEST_CASE("plane: a snapshot in one plane goes on as such where only the initial state turns") {
    constexpr PerCoil kAhead = {25.0, 0.0, 0.0, 0.0, -10.0}, kFading = {0.0, 0.0, 0.0, 0.0, -10.0};
    Scenario scenario;
    Simulator one(scenario);
    for (int n = 0; n < 10; ++n) one.step(kAhead, kStep, false);
    scenario.initial.y = 1e-9;
    Simulator other(scenario);
    other.restore(one.snapshot());
    for (Simulator* each : {&one, &other}) each->step(kFading, 0.5 * kStep, false);
    check_same(other.state(), one.state());
    // What turns it besides is another scenario.
    scenario.whole_plane = true;
    CHECK_THROWS_AS(Simulator(scenario).restore(one.snapshot()), std::invalid_argument);
}

TEST_CASE("plane: a snapshot keeps the tolerance of the run that came into the plane") {
    // Currents far above those of the scenario's drive.
    constexpr PerCoil kStrong = {60.0, 0.0, 0.0, 0.0, -60.0},
                      kTurned = {60.0, 0.0, 4.0, 0.0, -60.0};
    const Scenario scenario;
    Simulator one(scenario);
    for (int n = 0; n < 5; ++n) one.step(kStrong, kStep, false);
    one.step(kTurned, kStep, false);
    Simulator other(scenario);
    other.restore(one.snapshot());
    for (Simulator* each : {&one, &other}) each->step(kTurned, 5e-3, false);
    REQUIRE(one.status() == Status::ok);
    check_same(other.state(), one.state());
}

TEST_CASE("plane: a step that would turn a robot with an effect of one's own is refused") {
    const auto force = [](const double*, const double* parameters, double* wrench) {
        wrench[0] = parameters[0];
    };
    const UserEffectHandle push = std::make_shared<const UserEffect>(
        UserEffect{"push", "", "", {{"force", "N", -1.0, 1.0, 0.0, ""}}, force});
    Scenario scenario;
    scenario.user_effects = {{push, {5e-8}}};
    Simulator simulator(scenario), untouched(scenario);
    constexpr PerCoil kAhead = {20.0, 0.0, 0.0, 0.0, -10.0}, kAside = {20.0, 0.0, 10.0, 0.0, -10.0};
    const auto go = [&] {
        for (Simulator* each : {&simulator, &untouched}) each->step(kAhead, kStep, false);
        check_same(simulator.state(), untouched.state());
    };
    go();
    const std::string expected = [&] {
        Scenario whole = scenario;
        whole.whole_plane = true;
        try {
            check(whole);
        } catch (const std::invalid_argument& refusal) {
            return std::string(refusal.what());
        }
        return std::string();
    }();
    REQUIRE_FALSE(expected.empty());
    CHECK_THROWS_WITH_AS(simulator.step(kAside, kStep, false), expected.c_str(),
                         std::invalid_argument);
    CHECK(simulator.time() == untouched.time());
    go();
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
