#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "stickslip/batch/rollout.hpp"
#include "stickslip/batch/simulator.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/simulation.hpp"
#include "support.hpp"

using namespace stickslip;

TEST_CASE("heading: a field that comes back from another side loses the heading") {
    Scenario scenario;
    scenario.drive.base = 0.5e-3;
    scenario.drive.pulses = 8;
    scenario.drive.heading = 10.0 * std::numbers::pi / 180.0;
    scenario.whole_plane = true;
    scenario.drive.base = -1e-3;
    CHECK(simulate(scenario).status == Status::heading_lost);
    // One that only fades does not.
    scenario.drive.base = 0.0;
    CHECK(simulate(scenario).status != Status::heading_lost);
}

namespace {

// One way, none, and then another way (rad) for `last` s, in one straight segment.
Scenario coming_back(double way, double last) {
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const auto held = [](double angle, double volts, double clamp) {
        return PerCoil{std::max(volts * std::cos(angle), 0.0),
                       std::min(volts * std::cos(angle), 0.0), volts * std::sin(angle), 0.0, clamp};
    };
    scenario.program = VoltageProgram({{{{0.0, held(0.3, 26.0, -10.0)},
                                         {0.05, held(0.3, 26.0, -10.0)},
                                         {0.05, held(0.3, 0.0, -10.0)},
                                         {0.15, held(0.3, 0.0, -10.0)},
                                         {0.15, held(way, 26.0, -10.0)},
                                         {0.15 + last, held(way, 26.0, -10.0)}},
                                        1}});
    scenario.record.kind = RecordKind::uniform;
    scenario.record.rate = 1e3;
    return scenario;
}

}  // namespace

TEST_CASE("heading: a run ends at the instant when its heading is lost, also within a segment") {
    const RunResult brief = simulate(coming_back(2.5, 0.01));
    REQUIRE(brief.status == Status::heading_lost);
    CHECK(brief.summary.simulated_time > 0.15);
    CHECK(brief.summary.simulated_time < 0.151);
    CHECK(brief.final_state.heading == doctest::Approx(0.3).epsilon(0.1));
    for (const double last : {1.0, 20.0}) {
        const RunResult lost = simulate(coming_back(2.5, last));
        CHECK(lost.status == Status::heading_lost);
        CHECK(lost.summary.simulated_time ==
              doctest::Approx(brief.summary.simulated_time).epsilon(1e-7));
        CHECK(lost.recording.t.back() == brief.recording.t.back());
    }
    // From the same side it is known on.
    CHECK(simulate(coming_back(0.3, 1.0)).status == Status::ok);
}

TEST_CASE("heading: a run ends at the instant when the field turns too fast") {
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const PerCoil ahead = {26.0, 0.0, 0.0, 0.0, -10.0}, back = {0.0, -26.0, 1.5, 0.0, -10.0};
    scenario.program =
        VoltageProgram({{{{0.0, ahead}, {0.05, ahead}, {0.05, back}, {2.0, back}}, 1}});
    const RunResult run = simulate(scenario);
    REQUIRE(run.status == Status::turns_too_fast);
    CHECK(run.summary.simulated_time > 0.05);
    CHECK(run.summary.simulated_time < 0.06);
    CHECK(run.heading_end.rate > run.heading_end.limit);
    // 0.2 of the frequency of yaw, between that in the weakest field and that in 2.5 mT.
    CHECK(run.heading_end.limit > 100.0);
    CHECK(run.heading_end.limit < 1000.0);
    CHECK(message(run).find("rad/s") != std::string::npos);
}

// The sum of an ambient field and one that is switched on turns as fast as its current rises.
TEST_CASE("heading: a robot stands up to a field that outgrows an ambient one, whatever its side") {
    for (const double side : {0.5, 1.5, 2.5, -1.0}) {
        for (const double volts : {5.0, 26.0}) {
            const double ambient = volts > 10.0 ? 5e-5 : 2e-5;
            Scenario scenario;
            scenario.effects.ambient_field_bx = ambient * std::cos(side);
            scenario.effects.ambient_field_by = ambient * std::sin(side);
            Simulator robot(scenario);
            robot.step({volts, 0.0, 0.0, 0.0, -10.0}, 0.05, false);
            REQUIRE(robot.status() == Status::ok);
            CHECK(std::abs(robot.state().heading) < 0.1);
            // Once it stands, a field that goes over to the other side ends what is known.
            robot.step({0.0, -volts, 0.02 * volts, 0.0, -10.0}, 0.05, false);
            CHECK(robot.status() != Status::ok);
            CHECK(robot.time() > 0.05);
            CHECK(robot.time() < 0.065);
        }
    }
}

TEST_CASE("heading: a field that goes round from its first instant turns too fast") {
    for (const bool grows : {false, true}) {
        Scenario scenario;
        std::vector<VoltagePoint> points;
        for (int k = 0; k <= 400; ++k) {
            const double time = 5e-5 * k, angle = 2.0 * std::numbers::pi * 400.0 * time;
            const double volts = grows ? 26.0 * std::exp(0.15 * (angle - 50.0)) : 26.0;
            points.push_back(
                {time, {volts * std::cos(angle), 0.0, volts * std::sin(angle), 0.0, 0.0}});
        }
        scenario.drive.mode = DriveMode::program;
        scenario.program = VoltageProgram({{points, 1}});
        CHECK(simulate(scenario).status == Status::turns_too_fast);
        // One that holds the robot is followed from the start.
        scenario.effects.ambient_field_bx = 1e-4;
        CHECK(simulate(scenario).status == Status::turns_too_fast);
    }
}

TEST_CASE("a robot that begins beyond the coils is told so") {
    Scenario scenario;
    scenario.initial.x = 0.2;
    const RunResult run = simulate(scenario);
    CHECK(run.status == Status::left_workspace);
    CHECK(message(run).find("begin nearer") != std::string::npos);
}

// The field turns by a quarter and fades, all in one segment.
TEST_CASE("heading: the heading that stays is the one at which the field became weak") {
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const PerCoil ahead = {10.0, 0.0, 0.0, 0.0, 0.0}, aside = {0.0, 0.0, 10.0, 0.0, 0.0};
    scenario.program =
        VoltageProgram({{{{0.0, ahead}, {0.05, ahead}, {0.1, aside}, {0.15, {}}, {0.2, {}}}, 1}});
    const RunResult run = simulate(scenario);
    REQUIRE(run.status == Status::ok);
    CHECK(run.final_state.heading == doctest::Approx(0.5 * std::numbers::pi).epsilon(1e-3));
}

namespace {

struct Held {
    double duration;  // s
    PerCoil voltages;
};

// The same voltages in a simulator, in a rollout and as a program.
struct Played {
    Status simulator = Status::ok, rollout = Status::ok, program = Status::ok;
    double failed = 0.0;  // s, where the simulator did
    StateRow of_simulator = {}, of_rollout = {};
};
Played play(const std::vector<Held>& parts) {
    constexpr double kStep = 1e-3;
    Played result;
    std::vector<double> rows;
    VoltageBlock block;
    double time = 0.0;
    for (const Held& part : parts) {
        block.points.push_back({time, part.voltages});
        time += part.duration;
        block.points.push_back({time, part.voltages});
        for (int k = 0; k < static_cast<int>(std::lround(part.duration / kStep)); ++k) {
            rows.insert(rows.end(), part.voltages.begin(), part.voltages.end());
        }
    }
    Scenario scenario;
    scenario.whole_plane = true;
    const std::size_t steps = rows.size() / kCoilCount;
    Simulator simulator(scenario);
    for (std::size_t k = 0; k < steps && simulator.status() == Status::ok; ++k) {
        PerCoil row;
        std::copy_n(&rows[k * kCoilCount], kCoilCount, row.begin());
        simulator.step(row, kStep, false);
    }
    result.simulator = simulator.status();
    result.failed = simulator.time();
    result.of_simulator = row_of(simulator.state());
    StateOutput output;
    std::vector<double> states(steps * kStateColumns.size());
    output.values = states.data();
    for (std::size_t k = 0; k < kStateColumns.size(); ++k) output.columns.push_back(k);
    ControlRows all;
    all.voltages = rows.data();
    all.steps = steps;
    all.duration = kStep;
    RunControl control;
    result.rollout = rollout(
        1, [&](std::size_t) { return scenario; }, all, output, 1, control, [] {})[0];
    std::copy_n(&states[(steps - 1) * kStateColumns.size()], kStateColumns.size(),
                result.of_rollout.begin());
    Scenario program = scenario;
    program.drive.mode = DriveMode::program;
    program.program = VoltageProgram({block});
    result.program = simulate(program).status;
    return result;
}

}  // namespace

TEST_CASE("heading: a simulator, a rollout and a program lose a heading alike") {
    const PerCoil ahead = {26.0, 0.0, 0.0, 0.0, -10.0}, aside = {0.0, 0.0, 26.0, 0.0, -10.0};
    const PerCoil back = {-26.0, 0.0, 0.0, 0.0, -10.0}, none = {0.0, 0.0, 0.0, 0.0, -10.0};
    const PerCoil slightly = {26.0, 0.0, 3.0, 0.0, -10.0};
    const std::vector<std::vector<Held>> lost = {
        {{0.05, ahead}, {0.1, none}, {0.05, aside}},
        {{0.05, ahead}, {0.1, back}, {0.05, aside}},
        {{0.05, ahead}, {0.05, back}, {0.05, ahead}, {0.05, aside}},
    };
    for (const auto& parts : lost) {
        const Played played = play(parts);
        CHECK(played.simulator == Status::heading_lost);
        CHECK(played.rollout == Status::heading_lost);
        CHECK(played.program == Status::heading_lost);
        CHECK(played.failed <= 0.2);
    }
    const std::vector<std::vector<Held>> kept = {
        {{0.05, ahead}, {0.02, slightly}},
        {{0.05, none}, {0.02, aside}},
        {{0.05, ahead}, {0.05, none}, {0.05, ahead}, {0.02, slightly}},
    };
    for (const auto& parts : kept) {
        const Played played = play(parts);
        CHECK(played.simulator == Status::ok);
        CHECK(played.rollout == Status::ok);
        CHECK(played.program == Status::ok);
        for (std::size_t k = 0; k < played.of_simulator.size(); ++k) {
            CHECK(played.of_simulator[k] == played.of_rollout[k]);
        }
    }
}
