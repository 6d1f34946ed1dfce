#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "fitted_map.hpp"
#include "lane_runs.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

namespace {

// Runs of all kinds: steps that are rejected, bounces, slides, tumbling, long rests, and some that
// lanes hand to the single integrator.
Scenario random_scenario(Random& random, int number) {
    Scenario s;
    s.drive.mode = random.coin() ? DriveMode::ipp : DriveMode::opp;
    s.drive.clamp = random.coin() ? Clamp::down : Clamp::up;
    s.drive.edge = random.coin() ? Edge::rise : Edge::fall;
    s.drive.direction = random.coin() ? Direction::plus_x : Direction::minus_x;
    s.drive.frequency = random.between(3.0, 250.0);
    s.drive.base = random.between(0.0, 1e-3);
    s.drive.peak = s.drive.base + random.between(0.5e-3, 5e-3);
    s.drive.hold = random.between(0.3e-3, 3e-3);
    s.drive.pulses = random.integer(4, 8);
    s.contact.static_friction = random.between(0.05, 1.5);
    s.contact.kinetic_friction = s.contact.static_friction * random.between(0.5, 1.0);
    s.contact.adhesion = random.coin() ? 0.0 : random.between(0.0, 0.5e-6);
    s.contact.restitution = random.coin() ? 0.0 : random.between(0.0, 0.8);
    s.drag.linear = random.between(1e-7, 3e-5);
    s.solver.rtol = random.coin() ? 1e-6 : 1e-8;
    if (number % 5 == 0) s.record = {RecordKind::events, 0.0};
    if (number % 7 == 1) s.record = {RecordKind::uniform, 2e3};
    // Named effects, alone and together, of which packs have all but the last two.
    Effects& e = s.effects;
    if (number % 7 == 3) e.angle_adhesion_strength = 0.5;
    if (number % 11 == 5) e.mutual_inductance_coupling = 0.1;
    if (number % 3 == 1) {
        const auto some = [&] { return random.integer(0, 3) == 0; };
        if (some()) e.gradient_scale_fraction = random.between(-0.3, 0.3);
        if (some()) e.angle_drag_strength = random.between(-0.9, 2.0);
        if (some()) e.quadratic_drag_coefficient = random.between(0.0, 1e-2);
        if (some()) e.adhesion_ageing_rate = random.between(0.0, 1.0);
        if (some()) e.stribeck_friction_velocity = random.between(1e-4, 1e-2);
        if (some()) e.viscous_friction_coefficient = random.between(0.0, 10.0);
        if (some()) e.friction_anisotropy_fraction = random.between(-0.3, 0.3);
        if (some()) {
            e.friction_patches_amplitude = random.between(-0.3, 0.3);
            e.friction_patches_period = random.between(1e-5, 1e-3);
        }
        if (some()) e.eddy_lag_time = random.between(1e-5, 1e-3);
        if (some()) e.coil_heating_coefficient = random.between(0.0, 0.3);
    }
    if (number % 17 == 9) e.free_drag_speed.knots = {0.1, 0.2, 0.3, 0.2, 0.1};
    if (number % 13 == 2) s.solver.max_steps = 500;
    // A map that some leave, and one that none does.
    static const auto small_map =
        test::fitted_map(CoilSet(), {{-0.0003, -0.001, -0.001}, {0.0003, 0.001, 0.001}}, 4);
    if (number % 8 == 2) s.map = small_map;
    if (number % 8 == 6) s.map = test::paper_map();
    return s;
}

void check_bits(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        CHECK(std::bit_cast<std::uint64_t>(a[i]) == std::bit_cast<std::uint64_t>(b[i]));
    }
}

std::vector<double> numbers(const RunResult& run) {
    const Summary& s = run.summary;
    const BodyState& body = run.final_body;
    std::vector<double> all = {
        s.mean_velocity,  s.theta_min,  s.theta_max,         s.slip_up,
        s.slip_down,      s.slip_flat,  s.airborne_fraction, s.simulated_time,
        body.x,           body.z,       body.angle,          body.vx,
        body.vz,          body.omega,   s.field_max,         s.field_min,
        s.current_max,    s.power_mean, s.pull_ratio,        s.field_change,
        s.velocity_growth};
    for (const auto count : {run.steps.accepted, run.steps.rejected, run.steps.evaluations}) {
        all.push_back(static_cast<double>(count));
    }
    for (const auto count : s.events) all.push_back(static_cast<double>(count));
    return all;
}

}  // namespace

TEST_CASE("lanes: every run has the bits that it has alone, in packs of any width and number") {
    constexpr std::size_t kRuns = 150;
    Random random(7);
    std::vector<Scenario> scenarios;
    std::vector<RunResult> alone;
    int ok = 0;
    for (std::size_t i = 0; i < kRuns; ++i) {
        scenarios.push_back(random_scenario(random, static_cast<int>(i)));
        alone.push_back(simulate(scenarios.back()));
        ok += alone.back().status == Status::ok;
    }
    CHECK(ok > 115);
    for (const LaneKernels& kernels : all_lane_kernels()) {
        for (const std::size_t count : {1u, 3u, 40u}) {
            const std::vector<RunResult> results =
                test::simulate_in_lanes(kernels, count, scenarios);
            for (std::size_t i = 0; i < kRuns; ++i) {
                CAPTURE(kernels.size);
                CAPTURE(i);
                CHECK(results[i].status == alone[i].status);
                CHECK(message(results[i]) == message(alone[i]));
                check_bits(numbers(results[i]), numbers(alone[i]));
                check_bits(results[i].recording.x, alone[i].recording.x);
                check_bits(results[i].recording.normal_force, alone[i].recording.normal_force);
            }
        }
    }
}

TEST_CASE("lanes: a stop ends them all") {
    Scenario endless;
    endless.drive.base = 0.5e-3;
    endless.drive.pulses = 100'000'000;
    RunControl control;
    int taken = 0, ended = 0;
    LaneStore lanes;
    play_in_lanes(
        lane_kernels(), 8,
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
