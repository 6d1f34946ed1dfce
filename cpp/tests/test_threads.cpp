#include <doctest/doctest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "stickslip/batch/batch.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/user_effects.hpp"

using namespace stickslip;

// The preset `tsan` looks for races here; the comparison alone would find few of them.

namespace {

constexpr std::size_t kThreads = 8;

/// Plain, tilted, on a slope, out of plane pulses, in the whole plane, with an effect of the user's
/// own, with arrays, and one that fails.
std::vector<Scenario> eight_kinds() {
    std::vector<Scenario> kinds(kThreads);
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        Scenario& s = kinds[i];
        s.drive.base = 0.5e-3;
        s.drive.pulses = 5;
        s.drive.frequency = 60.0 + 10.0 * static_cast<double>(i);
    }
    kinds[1].initial.theta = 0.2;
    set_parameter(kinds[2], "effects.surface_tilt.angle", 0.02);
    kinds[3].drive.mode = DriveMode::opp;
    kinds[4].drive.heading = 0.3;
    set_parameter(kinds[5], "effects.shared.strength", 1e-9);
    kinds[6].record = {RecordKind::uniform, 2e3};
    kinds[7].solver.max_steps = 500;
    return kinds;
}

std::vector<std::uint64_t> bits(const RunResult& run) {
    std::vector<std::uint64_t> result = {static_cast<std::uint64_t>(run.status)};
    for (const double value : {run.summary.mean_velocity, run.summary.simulated_time,
                               run.final_body.x, run.final_body.angle, run.final_body.vx}) {
        result.push_back(std::bit_cast<std::uint64_t>(value));
    }
    for (const double x : run.recording.x) result.push_back(std::bit_cast<std::uint64_t>(x));
    return result;
}

}  // namespace

TEST_CASE("threads: runs and batches side by side have the bits that they have alone") {
    register_user_effect({"shared",
                          "a force along x",
                          "a test",
                          {{"strength", "N", -1e-6, 1e-6, 0.0, "its strength"}},
                          [](const double*, const double* parameters, double* wrench) {
                              wrench[0] = parameters[0];
                              wrench[1] = wrench[2] = 0.0;
                          }});
    const std::vector<Scenario> kinds = eight_kinds();
    // First all at once, so that tables which are made at their first use are made by many.
    std::vector<RunResult> beside(kThreads);
    std::vector<std::vector<RunResult>> batches(kThreads);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kThreads; ++i) {
        threads.emplace_back([&, i] {
            beside[i] = simulate(kinds[i]);
            RunControl control;
            batches[i] = simulate_batch(kinds, 2, control, [] {});
        });
    }
    for (std::thread& each : threads) each.join();
    for (std::size_t i = 0; i < kThreads; ++i) {
        CAPTURE(i);
        const std::vector<std::uint64_t> alone = bits(simulate(kinds[i]));
        CHECK(bits(beside[i]) == alone);
        for (const std::vector<RunResult>& batch : batches) CHECK(bits(batch[i]) == alone);
        CHECK(beside[i].status == (i == 7 ? Status::too_many_steps : Status::ok));
    }
    unregister_user_effect("shared");
}

TEST_CASE("threads: effects are registered, looked up and removed by many at once") {
    std::vector<std::thread> threads;
    std::vector<std::size_t> seen(kThreads, 0);
    for (std::size_t i = 0; i < kThreads; ++i) {
        threads.emplace_back([&seen, i] {
            const std::string name = "own_" + std::to_string(i);
            const auto nothing = [](const double*, const double*, double*) {};
            for (int round = 0; round < 50; ++round) {
                register_user_effect({name, "", "", {{"a", "-", -1.0, 1.0, 0.0, ""}}, nothing});
                seen[i] += find_user_key("effects." + name + ".a").has_value() ? 1 : 0;
                unregister_user_effect(name);
            }
        });
    }
    for (std::thread& each : threads) each.join();
    CHECK(seen == std::vector<std::size_t>(kThreads, 50));
    CHECK(user_effects().empty());
}
