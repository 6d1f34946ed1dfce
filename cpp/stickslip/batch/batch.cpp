#include "stickslip/batch/batch.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "stickslip/batch/lanes.hpp"
#include "stickslip/run/assembly.hpp"

namespace stickslip {
namespace {

/// Threads that are joined where they go out of scope; libc++ has no std::jthread before LLVM 20.
class Pool {
public:
    Pool() = default;
    Pool(const Pool&) = delete;
    Pool& operator=(const Pool&) = delete;
    ~Pool() {
        for (std::thread& each : threads_) each.join();
    }
    void start(const std::function<void()>& work) { threads_.emplace_back(work); }

private:
    std::vector<std::thread> threads_;
};

}  // namespace

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

    Pool pool;
    try {
        for (int i = 0; i < threads; ++i) pool.start(guarded);
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

std::size_t lanes_a_thread(std::size_t count, int threads) {
    // Four packs of runs keep the packs of all kinds of phases full, and fit into the cache.
    constexpr std::size_t kLanesAPlace = 4;
    // No thread takes so many at once that another has nothing to do.
    return std::clamp<std::size_t>(count / static_cast<std::size_t>(threads), 1,
                                   kLanesAPlace * static_cast<std::size_t>(lane_kernels().size));
}

void simulate_tasks(std::size_t count, int threads, RunControl& control,
                    const std::function<std::optional<Scenario>(std::size_t)>& scenario,
                    const std::function<void(std::size_t, RunResult&&)>& done,
                    const std::function<void()>& poll, std::optional<StopCondition> stop) {
    const LaneKernels& kernels = lane_kernels();
    if (count == 0) return;
    const int workers =
        static_cast<int>(std::min(count, static_cast<std::size_t>(std::max(threads, 1))));
    const std::size_t lanes = lanes_a_thread(count, workers);
    std::atomic<std::size_t> taken = 0;
    const auto next = [&]() -> std::optional<LaneTask> {
        for (std::size_t index = taken++; index < count; index = taken++) {
            if (auto found = scenario(index)) return LaneTask{index, std::move(*found), stop};
        }
        return std::nullopt;
    };
    run_workers(
        workers, control, [&] { simulate_in_lanes(kernels, lanes, next, done, control); }, poll);
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

}  // namespace stickslip
