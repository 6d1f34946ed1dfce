#include "stickslip/batch/simulator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "stickslip/batch/rollout.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/solver/tsit5.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

static_assert(!std::is_copy_constructible_v<Simulator> && !std::is_copy_assignable_v<Simulator>);
static_assert(!std::is_move_constructible_v<Run>);
static_assert(!std::is_copy_assignable_v<Run>);

namespace {

constexpr std::size_t kSteps = 60;
constexpr double kStep = 1.0 / 1024;  // s; a power of two, so that a program's times are exact

std::vector<PerCoil> random_voltages(Random& random) {
    std::vector<PerCoil> rows(kSteps);
    for (PerCoil& row : rows) {
        row = {random.between(-20.0, 20.0), 0.0, 0.0, 0.0, random.between(-15.0, 5.0)};
        if (random.integer(0, 4) == 0) row = {};
    }
    return rows;
}

// The same steps as a program, held or linear.
VoltageProgram program_of(const std::vector<PerCoil>& rows, bool linear) {
    VoltageBlock block;
    PerCoil before = {};
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double start = static_cast<double>(k) * kStep;
        if (!linear || k == 0) block.points.push_back({start, linear ? before : rows[k]});
        block.points.push_back({start + kStep, rows[k]});
        before = rows[k];
    }
    return VoltageProgram({block});
}

// Robots that stick, slip, roll, bounce and fly, with and without what is not plain.
Scenario random_scenario(Random& random, const std::vector<PerCoil>& rows, bool linear) {
    Scenario s;
    s.drive.mode = DriveMode::program;
    s.drive.direction = random.coin() ? Direction::plus_x : Direction::minus_x;
    s.program = program_of(rows, linear);
    s.robot.mass *= random.between(0.3, 2.0);
    s.robot.magnetization *= random.between(0.5, 4.0);
    s.contact.static_friction = random.between(0.05, 1.5);
    s.contact.kinetic_friction = s.contact.static_friction * random.between(0.5, 1.0);
    s.contact.adhesion = random.coin() ? 0.0 : random.between(0.0, 0.6e-6);
    s.contact.restitution = random.coin() ? 0.0 : random.between(0.0, 0.8);
    s.initial.theta = random.coin() ? 0.0 : random.between(-7.0, 7.0);
    if (random.integer(0, 4) == 0) s.effects.eddy_lag_time = 3e-4;
    if (random.integer(0, 4) == 0) s.effects.adhesion_ageing_rate = 0.2;
    if (random.integer(0, 4) == 0) s.effects.amplifier_limit_voltage = 9.0;
    if (random.integer(0, 4) == 0) s.effects.mutual_inductance_coupling = 0.1;
    if (random.integer(0, 4) == 0) {
        s.effects.surface_tilt_angle = random.between(-0.6, 0.6);
        s.contact.static_friction = s.contact.kinetic_friction = 0.1;
    }
    if (random.integer(0, 6) == 0) s.effects.ambient_field_bx = 5e-5;
    return s;
}

void check_bits(const SimulationState& a, const SimulationState& b) {
    const StateRow left = row_of(a), right = row_of(b);
    for (std::size_t k = 0; k < left.size(); ++k) {
        CAPTURE(kStateColumns[k].name);
        CHECK(std::bit_cast<std::uint64_t>(left[k]) == std::bit_cast<std::uint64_t>(right[k]));
    }
}

}  // namespace

TEST_CASE("simulator: steps have the bits of a program with the same breakpoints") {
    Random random(1);
    int modes = 0;
    for (int k = 0; k < 80; ++k) {
        CAPTURE(k);
        const bool linear = random.coin();
        const std::vector<PerCoil> rows = random_voltages(random);
        const Scenario scenario = random_scenario(random, rows, linear);
        const RunResult whole = simulate(scenario);
        if (whole.status != Status::ok) continue;
        Simulator simulator(scenario);
        for (const PerCoil& row : rows) {
            simulator.step(row, kStep, linear);
            modes |= 1 << static_cast<int>(simulator.state().contact);
        }
        REQUIRE(simulator.status() == Status::ok);
        CHECK(simulator.time() == kStep * static_cast<double>(kSteps));
        check_bits(simulator.state(), whole.final_state);
    }
    // All modes of a contact were met, but not `from_motion`.
    CHECK(modes == 0b11111110);
}

TEST_CASE("simulator: a restored snapshot goes on with the same bits, in another one too") {
    Random random(2);
    for (int k = 0; k < 60; ++k) {
        CAPTURE(k);
        const std::vector<PerCoil> rows = random_voltages(random);
        const Scenario scenario = random_scenario(random, rows, false);
        Simulator first(scenario);
        std::vector<SimulationState> states;
        std::vector<std::string> snapshots;
        for (const PerCoil& row : rows) {
            snapshots.push_back(first.snapshot().to_bytes());
            first.step(row, kStep, false);
            if (first.status() != Status::ok) break;
            states.push_back(first.state());
        }
        Simulator other(scenario);
        for (int trial = 0; trial < 6 && !states.empty(); ++trial) {
            const auto from =
                static_cast<std::size_t>(random.integer(0, static_cast<int>(states.size()) - 1));
            other.restore(RunSnapshot::from_bytes(snapshots[from]));
            CHECK(other.time() == kStep * static_cast<double>(from));
            for (std::size_t step = from; step < states.size() && step < from + 5; ++step) {
                other.step(rows[step], kStep, false);
                check_bits(other.state(), states[step]);
            }
        }
    }
}

TEST_CASE("simulator: a restored snapshot goes on with the same bits after a step that failed") {
    Scenario scenario;
    scenario.whole_plane = true;
    scenario.effects.sample_hold_period = 1e-4;  // so that the failed step leaves segments
    const PerCoil allowed = {20.0, 0.0, 0.01, 0.0, -10.0}, refused = {-20.0, 0.0, 0.01, 0.0, -10.0};
    Simulator whole(scenario), failing(scenario);
    whole.step(allowed, 5e-3, false);
    failing.step(allowed, 5e-3, false);
    const RunSnapshot before = failing.snapshot();
    failing.step(refused, 50e-3, false);
    REQUIRE(failing.status() == Status::heading_lost);
    failing.restore(before);
    for (int step = 0; step < 3; ++step) {
        whole.step(allowed, 5e-3, false);
        failing.step(allowed, 5e-3, false);
        REQUIRE(failing.status() == Status::ok);
        CHECK(failing.time() == whole.time());
        check_bits(failing.state(), whole.state());
    }
}

TEST_CASE("simulator: the limit on steps of the integrator is one for each step") {
    Scenario scenario;
    scenario.solver.max_steps = 500;
    Simulator simulator(scenario);
    for (int step = 0; step < 1000; ++step) simulator.step({}, 1e-3, false);
    CHECK(simulator.status() == Status::ok);
}

TEST_CASE("simulator: a coil that the drive does not use may be stepped") {
    const Scenario scenario;  // xp and clamp
    Simulator simulator(scenario);
    simulator.step({0.0, 0.0, 0.0, 0.0, -10.0}, 0.05, false);
    const RunSnapshot before = simulator.snapshot();
    simulator.step({0.0, -20.0, 0.0, 0.0, -10.0}, 0.05, false);
    const SimulationState reached = simulator.state();
    // 50 ms are seven time constants of 7 ms; the current is that of the voltage.
    CHECK(reached.current[1] == doctest::Approx(-2.0).epsilon(2e-3));
    CHECK(reached.theta != 0.0);
    simulator.restore(before);
    simulator.step({0.0, -20.0, 0.0, 0.0, -10.0}, 0.05, false);
    check_bits(simulator.state(), reached);
}

TEST_CASE("initial state: what is not given is at rest on the lowest corner") {
    Scenario s;
    s.initial.theta = 0.3;
    const Model model = make_model(s);
    const Start start = initial_state(s, model);
    CHECK(start.state.mode == ContactMode{Touch::corner, 0});
    CHECK(start.state.body.z == model.shape.pose(0, std::cos(0.3), std::sin(0.3)).height);
    s.initial.z = start.state.body.z + 1e-6;
    CHECK(initial_state(s, model).state.mode.touch == Touch::none);
    s.initial.z = start.state.body.z - 1e-9;
    CHECK_THROWS_AS(check(s), std::invalid_argument);
}

TEST_CASE("initial state: the motion says what touches") {
    Scenario s;
    const Model model = make_model(s);
    const double base = model.shape.half_base(0), height = model.shape.half_rise(0);
    const auto start = [&](double vx, double vz, double omega) {
        s.initial.vx = vx;
        s.initial.vz = vz;
        s.initial.omega = omega;
        return initial_state(s, model);
    };
    CHECK(start(0.0, 0.0, 0.0).state.mode == ContactMode{Touch::face, 0});
    CHECK(start(0.01, 0.0, 0.0).state.mode == ContactMode{Touch::face, 1});
    CHECK(start(0.0, 1e-3, 0.0).state.mode.touch == Touch::none);
    CHECK(start(0.0, -1e-3, 0.0).touches_down);
    // Turning nose-down about the front corner, which stays; turning the other way about the rear.
    CHECK(start(2.0 * height, 2.0 * base, 2.0).state.mode == ContactMode{Touch::corner, 0});
    const Start rear = start(-2.0 * height, 2.0 * base, -2.0);
    CHECK(rear.state.mode == ContactMode{Touch::corner, 0});
    CHECK(rear.state.body.quadrant == -1);
    CHECK(rear.state.body.angle == kQuarterTurn);
}

TEST_CASE("initial state: a contact that the motion denies is refused") {
    Scenario s;
    s.initial.theta = 0.3;
    s.initial.contact = ContactWord::corner_stick;
    check(s);
    s.initial.vx = 1e-3;
    CHECK_THROWS_AS(check(s), std::invalid_argument);
    s.initial.contact = ContactWord::corner_slip_forward;
    check(s);
    s.initial.contact = ContactWord::corner_slip_backward;
    CHECK_THROWS_AS(check(s), std::invalid_argument);
    s.initial.contact = ContactWord::face_stick;
    CHECK_THROWS_AS(check(s), std::invalid_argument);
    s.initial = {};
    s.initial.z = 1e-3;
    s.initial.contact = ContactWord::face_stick;
    CHECK_THROWS_AS(check(s), std::invalid_argument);
}

TEST_CASE("initial state: a run that is cut and begun again is the same within the tolerance") {
    Random random(3);
    int compared = 0;
    for (int k = 0; k < 40; ++k) {
        CAPTURE(k);
        const std::vector<PerCoil> rows = random_voltages(random);
        Scenario scenario = random_scenario(random, rows, false);
        // Rebounds and rolling on make the last digits grow.
        scenario.contact.restitution = 0.0;
        scenario.robot.magnetization = 2e5;
        scenario.drag.linear = 5e-5;
        Simulator whole(scenario);
        const std::size_t cut = 30;
        for (std::size_t step = 0; step < cut; ++step) whole.step(rows[step], kStep, false);
        Scenario rest = scenario;
        rest.initial = whole.state();
        Simulator again(rest);
        for (std::size_t step = cut; step < kSteps; ++step) {
            whole.step(rows[step], kStep, false);
            again.step(rows[step], kStep, false);
        }
        const SimulationState a = whole.state(), b = again.state();
        // Ten times rtol of a step over the some ten steps of each of 30 ms, in body radii.
        const double radius = make_model(scenario).shape.radius();
        CHECK(std::abs(a.x - b.x) < 10.0 * scenario.solver.rtol * 300.0 * radius);
        CHECK(std::abs(a.theta - b.theta) < 10.0 * scenario.solver.rtol * 300.0);
        ++compared;
    }
    CHECK(compared == 40);
}

TEST_CASE("stop condition: voltages that come after the end do not count") {
    Scenario s;  // whose voltages rise over 50 ms
    const double whole = simulate(s).summary.voltage_max;
    const StopCondition tips = {StopCondition::Quantity::theta, true, 0.01};
    s.drive.base = s.drive.peak = 2e-3;
    const RunResult run = simulate(s, nullptr, tips);
    REQUIRE(run.stopped);
    REQUIRE(run.summary.simulated_time < 0.05);
    const VoltageProgram program = make_program(s);
    const double risen = run.summary.simulated_time / 0.05;
    double last = 0.0;
    for (const double volts : program.largest_voltage()) last = std::max(last, std::abs(volts));
    CHECK(run.summary.voltage_max == doctest::Approx(risen * last).epsilon(1e-12));
    CHECK(run.summary.voltage_max < whole);
}

TEST_CASE("stop condition: the run ends where it is met") {
    Scenario s;
    s.drive.base = 0.5e-3;
    s.record = {RecordKind::uniform, 1e4};
    const auto until = [](StopCondition::Quantity quantity, double value) {
        return StopCondition{quantity, true, value};
    };
    const RunResult whole = simulate(s);
    const double goal = 0.5 * whole.final_state.x;
    const RunResult run = simulate(s, nullptr, until(StopCondition::Quantity::x, goal));
    CHECK(run.status == Status::ok);
    CHECK(run.stopped);
    // The root is located to 1e-12 of a step of at most some ms, at some 10 mm/s.
    CHECK(run.final_state.x == doctest::Approx(goal).epsilon(1e-9));
    CHECK(run.summary.simulated_time < whole.summary.simulated_time);
    CHECK(run.recording.t.back() <= run.summary.simulated_time);
    // Up to there the record is that of the whole run.
    for (std::size_t i = 0; i < run.recording.x.size(); ++i) {
        REQUIRE(run.recording.x[i] == whole.recording.x[i]);
    }
    const RunResult timed = simulate(s, nullptr, until(StopCondition::Quantity::time, 0.1234));
    CHECK(timed.stopped);
    CHECK(timed.summary.simulated_time == doctest::Approx(0.1234).epsilon(1e-12));
    // A face that lands lies still from then on.
    Scenario tilted;
    tilted.initial.theta = 0.2;
    const StopCondition flat = {StopCondition::Quantity::theta, false, 0.0};
    const RunResult fallen = simulate(tilted, nullptr, flat);
    CHECK(fallen.stopped);
    CHECK(std::abs(fallen.final_state.theta) < 1e-12);  // the landing, or its root
    CHECK(fallen.summary.simulated_time < 0.05);        // before the first pulse
    const RunResult at_once = simulate(s, nullptr, until(StopCondition::Quantity::x, -1.0));
    CHECK(at_once.stopped);
    CHECK(at_once.summary.simulated_time == 0.0);
    CHECK_FALSE(simulate(s, nullptr, until(StopCondition::Quantity::x, 1.0)).stopped);
}

TEST_CASE("rollout: the bits of one simulator each, for any number of threads") {
    Random random(4);
    constexpr std::size_t kRuns = 40;
    std::vector<Scenario> scenarios;
    std::vector<double> voltages;
    std::vector<std::vector<PerCoil>> rows;
    for (std::size_t run = 0; run < kRuns; ++run) {
        rows.push_back(random_voltages(random));
        scenarios.push_back(random_scenario(random, rows.back(), false));
        for (const PerCoil& row : rows.back()) {
            voltages.insert(voltages.end(), row.begin(), row.end());
        }
    }
    const std::vector<std::size_t> columns = {0, 2, 16};
    const ControlRows input = {voltages.data(), kSteps, kSteps * kCoilCount, kStep, false};
    for (const int threads : {1, 3}) {
        std::vector<double> out(kRuns * kSteps * columns.size(), -1.0);
        RunControl control;
        const std::vector<Status> status = rollout(
            kRuns, [&](std::size_t run) { return scenarios[run]; }, input, {out.data(), columns},
            threads, control, [] {});
        SimulatorBatch together(scenarios);
        std::vector<double> step_voltages(kRuns * kCoilCount);
        for (std::size_t step = 0; step < kSteps; ++step) {
            for (std::size_t run = 0; run < kRuns; ++run) {
                std::copy_n(rows[run][step].begin(), kCoilCount,
                            step_voltages.begin() + static_cast<long>(run * kCoilCount));
            }
            together.step(step_voltages.data(), kStep, false, threads, [] {});
            for (std::size_t run = 0; run < kRuns; ++run) {
                if (together.status(run) != Status::ok) continue;
                for (std::size_t c = 0; c < columns.size(); ++c) {
                    CHECK(out[(run * kSteps + step) * columns.size() + c] ==
                          together.state(run)[columns[c]]);
                }
            }
        }
        for (std::size_t run = 0; run < kRuns; ++run) {
            CAPTURE(run);
            Simulator alone(scenarios[run]);
            for (const PerCoil& row : rows[run]) {
                if (alone.status() == Status::ok) alone.step(row, kStep, false);
            }
            CHECK(status[run] == alone.status());
            CHECK(together.status(run) == alone.status());
            if (alone.status() == Status::ok) {
                check_bits(state_of(together.state(run).data()), alone.state());
            }
        }
    }
}
