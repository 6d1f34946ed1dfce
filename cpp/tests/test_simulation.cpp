#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "stickslip/run/simulation.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

Scenario pulsed(DriveMode mode, double frequency, double base, double hold, Edge edge, Clamp clamp,
                std::int64_t pulses = 20) {
    Scenario scenario;
    Drive& drive = scenario.drive;
    drive.mode = mode;
    drive.frequency = frequency;
    drive.base = base;
    drive.hold = hold;
    drive.edge = edge;
    drive.clamp = clamp;
    drive.pulses = pulses;
    return scenario;
}

// Mean velocities (m/s) that two other programs found, one event-driven and one time-stepping,
// which agree within 0.05 %: 50 ms of ramp, 20 pulses to 2.5 mT.
struct CheckNumber {
    Scenario scenario;
    double velocity;
};

std::array<CheckNumber, 4> check_numbers() {
    using enum DriveMode;
    return {{{pulsed(ipp, 100.0, 0.5e-3, 1.0e-3, Edge::rise, Clamp::down), 1.9128e-3},
             {pulsed(ipp, 30.0, 0.5e-3, 1.0e-3, Edge::fall, Clamp::up), 0.5986e-3},
             {pulsed(opp, 30.0, 0.5e-3, 2.5e-3, Edge::fall, Clamp::down), 0.7186e-3},
             {pulsed(opp, 100.0, 0.0, 2.5e-3, Edge::rise, Clamp::up), 3.0680e-3}}};
}

// The program of a drive, of which the signs can then be changed.
Scenario as_program(const Scenario& scenario) {
    Scenario result = scenario;
    result.program = make_program(scenario);
    result.drive = {.mode = DriveMode::program, .direction = scenario.drive.direction};
    return result;
}

// A slope without friction, drag or field.
Scenario slope(double angle, double duration) {
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const PerCoil off = {};
    scenario.program = VoltageProgram({{{{0.0, off}, {duration, off}}, 1}});
    scenario.contact.static_friction = scenario.contact.kinetic_friction = 0.0;
    scenario.drag.linear = 0.0;
    scenario.effects.surface_tilt_angle = angle;
    return scenario;
}

}  // namespace

TEST_CASE("simulation: the four check numbers within 0.1 %") {
    for (const CheckNumber& check : check_numbers()) {
        const RunResult result = simulate(check.scenario);
        CHECK(result.status == Status::ok);
        CHECK(result.summary.mean_velocity == doctest::Approx(check.velocity).epsilon(1e-3));
    }
}

TEST_CASE("simulation: both integrators agree within 0.02 %") {
#ifdef STICKSLIP_WITH_ARKODE
    for (const CheckNumber& check : check_numbers()) {
        Scenario other = check.scenario;
        other.solver.method = Method::arkode;
        const RunResult a = simulate(check.scenario), b = simulate(other);
        CHECK(b.status == Status::ok);
        CHECK(b.summary.mean_velocity == doctest::Approx(a.summary.mean_velocity).epsilon(2e-4));
        CHECK(a.summary.events == b.summary.events);
    }
#else
    Scenario scenario;
    scenario.solver.method = Method::arkode;
    CHECK(simulate(scenario).status == Status::no_arkode);
#endif
}

TEST_CASE("simulation: the result converges with the tolerance") {
    for (const CheckNumber& check : check_numbers()) {
        Scenario fine = check.scenario;
        fine.solver.rtol = 1e-10;
        const double exact = simulate(fine).summary.mean_velocity;
        // A local error of 1e-7 a step over some 1e3 steps, in units of the robot's radius of 135
        // um over 1 mm of way. It adds up in a random way, if that.
        CHECK(simulate(check.scenario).summary.mean_velocity ==
              doctest::Approx(exact).epsilon(1e-4));
    }
}

TEST_CASE("simulation: a visit of 0.1 ms to the friction limit inside a step is not missed") {
    Scenario scenario = pulsed(DriveMode::opp, 100.0, 0.0, 1e-3, Edge::fall, Clamp::down, 8);
    scenario.contact.static_friction = 1.8;
    scenario.contact.kinetic_friction = 1.305;
    for (const double tolerance : {1e-6, 1e-7, 1e-9}) {
        scenario.solver.rtol = tolerance;
        // 0.8516 mm/s where it is missed; four digits are known.
        CHECK(simulate(scenario).summary.mean_velocity == doctest::Approx(0.7571e-3).epsilon(5e-4));
    }
}

TEST_CASE("simulation: static equal to kinetic friction is the limit of nearly equal ones") {
    for (CheckNumber& check : check_numbers()) {
        ContactParameters& contact = check.scenario.contact;
        contact.kinetic_friction = contact.static_friction;
        const RunResult equal = simulate(check.scenario);
        contact.kinetic_friction = contact.static_friction * (1.0 - 1e-9);
        const RunResult nearly = simulate(check.scenario);
        CHECK(equal.status == Status::ok);
        // The velocity's derivative by the coefficient's logarithm is at most about ten of it.
        CHECK(equal.summary.mean_velocity ==
              doctest::Approx(nearly.summary.mean_velocity).epsilon(1e-7));
        CHECK(equal.summary.events == nearly.summary.events);
    }
}

TEST_CASE("simulation: friction through 4/3, where sliding may have no solution") {
    for (const double mu : {1.32, 1.34, 1.5, 2.0, 3.0}) {
        for (CheckNumber& check : check_numbers()) {
            CAPTURE(mu);
            check.scenario.contact.static_friction = mu;
            check.scenario.contact.kinetic_friction = 0.97 * mu;
            const RunResult result = simulate(check.scenario);
            check.scenario.solver.rtol = 1e-10;
            const RunResult exact = simulate(check.scenario);
            CHECK(result.status == Status::ok);
            CHECK(exact.status == Status::ok);
            // As above, but for speeds of nearly nothing: in all 1e-4 of 1 mm/s at least.
            CHECK(std::abs(result.summary.mean_velocity - exact.summary.mean_velocity) <
                  1e-4 * std::max(1e-3, std::abs(exact.summary.mean_velocity)));
        }
    }
}

TEST_CASE("simulation: a steady field moves nothing") {
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const PerCoil off = {}, on = {20.0, 0.0, 0.0, 0.0, -10.0};
    scenario.program = VoltageProgram({{{{0.0, off}, {0.05, on}}, 1}, {{{0.0, on}, {2.0, on}}, 1}});
    scenario.record = {RecordKind::uniform, 10.0};
    const RunResult result = simulate(scenario);
    CHECK(result.status == Status::ok);
    const std::vector<double>& contact_x = result.recording.contact_x;
    REQUIRE(contact_x.size() > 10);
    // Once up, the corner stays where it is to the last bit.
    for (std::size_t i = 2; i < contact_x.size(); ++i) CHECK(contact_x[i] == contact_x[1]);
}

TEST_CASE("simulation: the moment and the in-plane fields reversed reverse the motion") {
    // A moment turned in the body by half a turn, and the coils of each pair exchanged with their
    // currents reversed: the mirror image in the robot's own frame, on the opposite corner.
    for (const CheckNumber& check : check_numbers()) {
        const Scenario original = as_program(check.scenario);
        Scenario mirrored = original;
        mirrored.program = turned(original.program);
        mirrored.effects.misalignment_angle = std::numbers::pi;
        const RunResult a = simulate(original), b = simulate(mirrored);
        // Cos pi is -1, sin pi 1e-16, and roundings differ: they pass through contact events of
        // which each can amplify them some ten times, far below the error of a step.
        CHECK(b.final_body.x == doctest::Approx(-a.final_body.x).epsilon(1e-8));
        CHECK(b.final_body.theta() == doctest::Approx(-a.final_body.theta()).epsilon(1e-8));
        CHECK(b.final_body.quadrant == -1 - a.final_body.quadrant);
        CHECK(a.summary.events == b.summary.events);
    }
}

TEST_CASE("simulation: driven towards -x it does the same to the last bit") {
    for (const CheckNumber& check : check_numbers()) {
        Scenario back = check.scenario;
        back.drive.direction = Direction::minus_x;
        const RunResult a = simulate(check.scenario), b = simulate(back);
        CHECK(b.summary.mean_velocity == -a.summary.mean_velocity);
        CHECK(b.summary.slip_up == -a.summary.slip_up);
        CHECK(b.summary.theta_max == a.summary.theta_max);
        CHECK(a.summary.events == b.summary.events);
        // Also when the world's voltages are given as a program.
        Scenario program = as_program(check.scenario);
        program.program = turned(program.program);
        program.drive.direction = Direction::minus_x;
        CHECK(simulate(program).final_body.x == a.final_body.x);
    }
}

TEST_CASE("simulation: a slope without friction, against the closed form") {
    const double angle = 0.1, duration = 0.05;
    const RunResult result = simulate(slope(angle, duration));
    CHECK(result.status == Status::ok);
    const double acceleration = 9.81 * std::sin(angle);
    // A polynomial of second degree: exact but for rounding, in a few steps.
    CHECK(result.final_body.x ==
          doctest::Approx(0.5 * acceleration * duration * duration).epsilon(1e-12));
    CHECK(result.final_body.vx == doctest::Approx(acceleration * duration).epsilon(1e-12));
    CHECK(result.summary.mean_velocity ==
          doctest::Approx(0.5 * acceleration * duration).epsilon(1e-12));
    Scenario uphill = slope(-angle, duration);
    CHECK(simulate(uphill).final_body.x == -result.final_body.x);
}

TEST_CASE("status: a robot that slides down to the coils has left the workspace") {
    Scenario scenario = slope(0.5, 5.0);
    scenario.solver.max_step = 1e-3;
    const double limit = 0.9 * 0.099, acceleration = 9.81 * std::sin(0.5);
    // Where no coil drives there is none in the way.
    CHECK(simulate(scenario).final_body.x > limit);
    const PerCoil slight = {0.0, 0.0, 0.0, 0.0, 1e-12};
    scenario.program = VoltageProgram({{{{0.0, slight}, {5.0, slight}}, 1}});
    const RunResult result = simulate(scenario);
    CHECK(result.status == Status::left_workspace);
    const double expected = std::sqrt(2.0 * limit / acceleration);
    CHECK(result.summary.simulated_time >= expected);
    CHECK(result.summary.simulated_time <= expected + 1e-3);
    CHECK(result.final_body.x >= limit);
    CHECK(std::isnan(result.summary.mean_velocity));
    CHECK(message(result).find("reached the coils") != std::string::npos);
}

TEST_CASE("status: a run that is told to stop is interrupted") {
    RunControl control;
    const RunResult whole = simulate(slope(0.1, 1.0), &control);
    CHECK(whole.summary.simulated_time == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(control.simulated_time == doctest::Approx(1.0).epsilon(1e-12));
    Scenario rests;
    rests.drive.peak = rests.drive.hold = 1e-6;  // moves nothing
    rests.drive.pulses = 1000;
    for (const Scenario& scenario : {slope(0.1, 1.0), rests}) {
        RunControl stopped;
        stopped.stop = true;
        const RunResult result = simulate(scenario, &stopped);
        CHECK(result.status == Status::interrupted);
        CHECK(result.summary.simulated_time < 1.0);
        CHECK(stopped.simulated_time == 0.0);
    }
    CHECK(row_of(Status::interrupted).name == "interrupted");
}

TEST_CASE("simulation: a recording does not change the motion, and ends of it agree") {
    Scenario scenario = check_numbers()[0].scenario;
    const RunResult bare = simulate(scenario);
    scenario.record = {RecordKind::uniform, 2000.0};
    const RunResult uniform = simulate(scenario);
    scenario.record = {RecordKind::events, 0.0};
    const RunResult events = simulate(scenario);
    CHECK(uniform.final_body.x == bare.final_body.x);
    // To ask for the reaction at an event may move the centre of the field's expansion, which is
    // good to 1e-12.
    CHECK(events.final_body.x == doctest::Approx(bare.final_body.x).epsilon(1e-10));
    CHECK(uniform.recording.t.size() == 501);  // 0.25 s, both ends
    std::int64_t total = 0;
    for (const std::int64_t n : bare.summary.events) total += n;
    CHECK(static_cast<std::int64_t>(events.recording.event.size()) == total);
    CHECK(bare.recording.t.empty());
}

TEST_CASE("simulation: coils without delay") {
    // The current follows a jump of the voltage within 1e-13 s, and steps begin as short as that.
    for (const double inductance : {1e-13, 1e-12, 1e-11}) {
        CAPTURE(inductance);
        Scenario scenario;
        scenario.drive.base = 0.5e-3;
        scenario.drive.pulses = 20;
        for (CoilParameters& coil : scenario.coils) coil.inductance = inductance;
        const RunResult result = simulate(scenario);
        CHECK(result.status == Status::ok);
        CHECK(result.steps.accepted < 100000);
    }
}

TEST_CASE("simulation: a corner that touches neither sinks nor creeps") {
    Scenario scenario = check_numbers()[3].scenario;
    scenario.record = {RecordKind::uniform, 20000.0};
    const Recording recording = simulate(scenario).recording;
    const Model model = make_model(scenario);
    std::size_t sticking = 0;
    for (std::size_t i = 0; i < recording.t.size(); ++i) {
        // Height of the lowest of the four corners.
        const double theta = recording.theta[i];
        const double lowest =
            recording.z[i] - 125e-6 * std::abs(std::sin(theta)) - 50e-6 * std::abs(std::cos(theta));
        // Roundings of 135 um; in flight a step's error too.
        CHECK(lowest > (recording.contact[i] == 0 ? -1e-10 : -1e-18));
        if (recording.contact[i] != 0) CHECK(lowest < 1e-18);
        if (recording.contact[i] != 1 || i == 0 || recording.contact[i - 1] != 1) continue;
        ++sticking;
        CHECK(std::abs(recording.friction_force[i]) <=
              0.2 * recording.normal_force[i] + 1e-9 * model.adhesion.strength);
    }
    CHECK(sticking > 100);
}
