#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <vector>

#include "stickslip/batch/batch.hpp"
#include "stickslip/batch/simulator.hpp"

using namespace stickslip;

static_assert(!std::is_copy_constructible_v<Simulator> && !std::is_copy_assignable_v<Simulator>);
static_assert(!std::is_move_constructible_v<Run>);
static_assert(!std::is_copy_assignable_v<Run>);

namespace {

const auto kNoPoll = [] {};

void wait_until(const std::atomic<bool>& flag) {
    while (!flag) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

TEST_CASE("batch: a scenario that makes no sense is refused before any runs") {
    std::vector<Scenario> scenarios(2);
    scenarios.back().contact.kinetic_friction = 0.5;  // more than the static one
    RunControl control;
    CHECK_THROWS_AS(simulate_batch(scenarios, 2, control, kNoPoll), std::invalid_argument);
    CHECK(control.simulated_time == 0.0);
}

TEST_CASE("batch: each task once, whatever the number of threads") {
    const auto kNeverDone = [](std::size_t, RunResult&&) { FAIL("no task was simulated"); };
    for (const int threads : {-1, 0, 1, 3, 100}) {
        RunControl control;
        std::vector<std::atomic<int>> asked(50);
        const auto refuse = [&](std::size_t i) -> std::optional<Scenario> {
            ++asked[i];
            return std::nullopt;
        };
        simulate_tasks(asked.size(), threads, control, refuse, kNeverDone, kNoPoll);
        for (const std::atomic<int>& n : asked) CHECK(n == 1);
        CHECK_NOTHROW(simulate_tasks(0, threads, control, refuse, kNeverDone, kNoPoll));
    }
}

TEST_CASE("batch: an exception of poll stops the workers and is thrown again") {
    RunControl control;
    const auto poll = [] { throw std::runtime_error("interrupted from the keyboard"); };
    CHECK_THROWS_WITH_AS(run_workers(
                             2, control, [&] { wait_until(control.stop); }, poll),
                         "interrupted from the keyboard", std::runtime_error);
    CHECK(control.stop);
}

TEST_CASE("batch: an exception of poll ends simulations that would take long") {
    Scenario scenario;
    scenario.drive.base = 0.5e-3;
    scenario.drive.pulses = 100'000'000;
    RunControl control;
    const auto poll = [] { throw std::runtime_error("stop"); };
    CHECK_THROWS_WITH_AS(simulate_batch({scenario, scenario}, 2, control, poll), "stop",
                         std::runtime_error);
}

TEST_CASE("batch: an exception of a worker stops the others and is thrown again") {
    RunControl control;
    std::atomic<int> started = 0;
    const auto work = [&] {
        if (++started == 2) throw std::domain_error("the second");
        wait_until(control.stop);
    };
    CHECK_THROWS_WITH_AS(run_workers(3, control, work, kNoPoll), "the second", std::domain_error);
    CHECK(control.stop);
}

TEST_CASE("batch: no task begins after a stop") {
    RunControl control;
    std::atomic<int> asked = 0;
    const auto scenario = [&](std::size_t) -> std::optional<Scenario> {
        if (++asked == 2) throw std::domain_error("the second");
        wait_until(control.stop);
        return Scenario{};
    };
    CHECK_THROWS_WITH_AS(simulate_tasks(
                             10, 2, control, scenario, [](std::size_t, RunResult&&) {}, kNoPoll),
                         "the second", std::domain_error);
    CHECK(asked == 2);
}

TEST_CASE("batch: polls while it waits, on the calling thread") {
    RunControl control;
    std::atomic<bool> polled = false;
    std::thread::id caller;
    const auto poll = [&] {
        caller = std::this_thread::get_id();
        polled = true;
    };
    run_workers(
        1, control, [&] { wait_until(polled); }, poll);
    CHECK(caller == std::this_thread::get_id());
}

TEST_CASE("lanes: a stop ends them all") {
    Scenario endless;
    endless.drive.base = 0.5e-3;
    endless.drive.pulses = 100'000'000;
    RunControl control;
    int taken = 0, ended = 0;
    LaneStore lanes;
    play_in_lanes(
        step_kernels(), 8,
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
