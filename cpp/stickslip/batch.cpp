#include "stickslip/batch.hpp"
#include "stickslip/assembly.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace stickslip {

void run_tasks(std::size_t count, int threads, RunControl& control,
               const std::function<void(std::size_t)>& task, const std::function<void()>& poll) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::condition_variable finished;
    std::exception_ptr failure;
    const auto workers = static_cast<int>(
        std::min<std::size_t>(count, static_cast<std::size_t>(std::max(threads, 1))));
    int running = workers;

    const auto work = [&] {
        try {
            for (std::size_t index = next++; index < count && !control.stop; index = next++) {
                task(index);
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
            control.stop = true;
        }
        const std::lock_guard lock(mutex);
        if (--running == 0) finished.notify_one();
    };

    std::vector<std::jthread> pool;
    pool.reserve(static_cast<std::size_t>(workers));
    try {
        for (int i = 0; i < workers; ++i) pool.emplace_back(work);
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

std::vector<RunResult> simulate_batch(const std::vector<Scenario>& scenarios, int threads,
                                      RunControl& control, const std::function<void()>& poll) {
    for (const Scenario& scenario : scenarios) check(scenario);
    std::vector<RunResult> results(scenarios.size());
    run_tasks(
        scenarios.size(), threads, control,
        [&](std::size_t index) { results[index] = simulate(scenarios[index], &control); }, poll);
    return results;
}

}  // namespace stickslip
