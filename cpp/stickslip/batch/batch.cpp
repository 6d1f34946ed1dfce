#include "stickslip/batch/batch.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/scenario_rows.hpp"

namespace stickslip {
void run_workers(int threads, RunControl& control, const std::function<void()>& work,
                 const std::function<void()>& poll) {
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
    constexpr bool kHasThreads = false;
#else
    constexpr bool kHasThreads = true;
#endif
    if (!kHasThreads) {
        work();
        poll();
        return;
    }
    std::mutex mutex;
    std::condition_variable finished;
    std::exception_ptr failure;
    int running = threads;

    const auto guarded = [&] {
        try {
            work();
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
            control.stop = true;
        }
        const std::lock_guard lock(mutex);
        if (--running == 0) finished.notify_one();
    };

    // libc++ has no std::jthread before LLVM 20.
    std::vector<std::thread> pool;
    const auto join = [](std::vector<std::thread>* all) {
        for (std::thread& each : *all) each.join();
    };
    const std::unique_ptr<std::vector<std::thread>, decltype(join)> joined(&pool, join);
    try {
        for (int i = 0; i < threads; ++i) pool.emplace_back(guarded);
    } catch (...) {  // no more threads: those that run are joined as the pool is left
        control.stop = true;
        throw;
    }

    constexpr auto kPollInterval = std::chrono::milliseconds(50);
    std::unique_lock lock(mutex);
    while (!finished.wait_for(lock, kPollInterval, [&] { return running == 0; })) {
        lock.unlock();
        try {
            poll();
        } catch (...) {
            control.stop = true;
            lock.lock();
            finished.wait(lock, [&] { return running == 0; });
            throw;
        }
        lock.lock();
    }
    if (failure) std::rethrow_exception(failure);
}

Lane* LaneStore::make(std::size_t index, const Scenario& scenario, RunControl& control,
                      std::optional<StopCondition> stop) {
    auto lane = std::make_unique<Lane>(index, scenario, &control, stop);
    Lane* const key = lane.get();
    const std::lock_guard lock(mutex_);
    lanes_.emplace(key, std::move(lane));
    return key;
}

void LaneStore::erase(const Lane& lane) {
    const std::lock_guard lock(mutex_);
    lanes_.erase(&lane);
}

void play_all(std::size_t count, int threads, RunControl& control,
              const std::function<Lane*(std::size_t)>& lane, const std::function<void(Lane&)>& done,
              const std::function<void()>* poll) {
    if (count == 0) return;
    const int workers =
        static_cast<int>(std::min(count, static_cast<std::size_t>(std::max(threads, 1))));
    const StepKernels& kernels = step_kernels();
    // Four packs of runs keep the packs of all kinds of phases full, and fit into the cache. No
    // thread takes so many at once that another has nothing to do.
    constexpr std::size_t kLanesAPlace = 4;
    const std::size_t lanes =
        std::clamp<std::size_t>(count / static_cast<std::size_t>(workers), 1,
                                kLanesAPlace * static_cast<std::size_t>(kernels.size));
    std::atomic<std::size_t> taken = 0;
    const auto next = [&]() -> Lane* {
        for (std::size_t index = taken++; index < count; index = taken++) {
            if (Lane* found = lane(index)) return found;
        }
        return nullptr;
    };
    const auto work = [&] { play_in_lanes(kernels, lanes, next, done, control); };
    if (poll == nullptr && workers == 1) {
        work();
    } else {
        run_workers(
            workers, control, work, poll ? *poll : [] {});
    }
}

void simulate_tasks(std::size_t count, int threads, RunControl& control,
                    const std::function<std::optional<Scenario>(std::size_t)>& scenario,
                    const std::function<void(std::size_t, RunResult&&)>& done,
                    const std::function<void()>& poll, std::optional<StopCondition> stop) {
    LaneStore lanes;
    const auto lane = [&](std::size_t index) -> Lane* {
        const std::optional<Scenario> found = scenario(index);
        if (!found) return nullptr;
        if (!has_method(found->solver.method)) {
            done(index, simulate(*found, &control, stop));
            return nullptr;
        }
        return lanes.make(index, *found, control, stop);
    };
    const auto ended = [&](Lane& each) {
        done(each.index, each.run.take_result());
        lanes.erase(each);
    };
    play_all(count, threads, control, lane, ended, &poll);
}

std::vector<RunResult> simulate_batch(const std::vector<Scenario>& scenarios, int threads,
                                      RunControl& control, const std::function<void()>& poll,
                                      std::optional<StopCondition> stop) {
    for (const Scenario& scenario : scenarios) check(scenario);
    std::vector<RunResult> results(scenarios.size());
    for (RunResult& each : results) each.status = Status::interrupted;  // until it has ended
    simulate_tasks(
        scenarios.size(), threads, control,
        [&](std::size_t index) { return std::optional(scenarios[index]); },
        [&](std::size_t index, RunResult&& result) { results[index] = std::move(result); }, poll,
        stop);
    return results;
}

std::vector<SweepPoint> sweep(const Scenario& base, const std::vector<std::string>& keys,
                              const std::vector<double>& values, int threads, RunControl& control,
                              const std::function<void()>& poll) {
    const ScenarioRows rows(base, keys, values);
    std::vector<SweepPoint> points(rows.size());
    const auto scenario_of = [&](std::size_t index) -> std::optional<Scenario> {
        try {
            Scenario scenario = rows[index];
            scenario.record = {.pull_share = scenario.record.pull_share};
            check(scenario);
            return scenario;
        } catch (const std::logic_error& refusal) {
            points[index].refused = true;
            points[index].message = refusal.what();
            return std::nullopt;
        }
    };
    const auto done = [&](std::size_t index, RunResult&& result) {
        SweepPoint& point = points[index];
        point.status = result.status;
        point.summary = result.summary;
        if (result.status != Status::ok) point.message = message(result);
    };
    simulate_tasks(points.size(), threads, control, scenario_of, done, poll);
    return points;
}

}  // namespace stickslip
