#include "stickslip/batch/simulator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "stickslip/batch/rollout.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

static_assert(!std::is_copy_constructible_v<Simulator> && !std::is_copy_assignable_v<Simulator>);
static_assert(!std::is_move_constructible_v<Run>);
static_assert(!std::is_copy_assignable_v<Run>);

namespace {

constexpr std::size_t kSteps = 60;
constexpr double kStep = 1.0 / 1024;  // s

std::vector<PerCoil> random_voltages(Random& random) {
    std::vector<PerCoil> rows(kSteps);
    for (PerCoil& row : rows) {
        row = {random.between(-20.0, 20.0), 0.0, 0.0, 0.0, random.between(-15.0, 5.0)};
        if (random.integer(0, 4) == 0) row = {};
    }
    return rows;
}

// Robots that stick, slip, roll, bounce and fly, with and without what is not plain.
Scenario random_scenario(Random& random) {
    Scenario s;
    s.drive.direction = random.coin() ? Direction::plus_x : Direction::minus_x;
    s.robot.mass *= random.between(0.3, 2.0);
    s.robot.magnetization *= random.between(0.5, 4.0);
    s.contact.static_friction = random.between(0.05, 1.5);
    s.contact.kinetic_friction = s.contact.static_friction * random.between(0.5, 1.0);
    s.contact.adhesion = random.coin() ? 0.0 : random.between(0.0, 0.6e-6);
    s.contact.restitution = random.coin() ? 0.0 : random.between(0.0, 0.8);
    s.initial.theta = random.coin() ? 0.0 : random.between(-7.0, 7.0);
    if (random.integer(0, 4) == 0) s.effects.eddy_lag_time = 3e-4;
    if (random.integer(0, 4) == 0) set_parameter(s, "effects.adhesion_ageing.rate", 0.2);
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
    const Model model = make_model(s, frame_of(s));
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
    const Model model = make_model(s, frame_of(s));
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

TEST_CASE("rollout: the bits of one simulator each, for any number of threads") {
    Random random(4);
    constexpr std::size_t kRuns = 40;
    std::vector<Scenario> scenarios;
    std::vector<double> voltages;
    std::vector<std::vector<PerCoil>> rows;
    for (std::size_t run = 0; run < kRuns; ++run) {
        rows.push_back(random_voltages(random));
        scenarios.push_back(random_scenario(random));
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
                if (together.run(run).status() != Status::ok) continue;
                for (std::size_t c = 0; c < columns.size(); ++c) {
                    CHECK(out[(run * kSteps + step) * columns.size() + c] ==
                          row_of(together.run(run).state())[columns[c]]);
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
            CHECK(together.run(run).status() == alone.status());
            if (alone.status() == Status::ok) {
                check_bits(state_of(row_of(together.run(run).state()).data()), alone.state());
            }
        }
    }
}
