#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stickslip/run/simulation.hpp"

namespace stickslip {

/// Runs `work()` on each of `threads` threads (at least one, this one not among them) and calls
/// `poll` on this thread about every 50 ms until all are done. An exception of `work` or of `poll`
/// makes the others stop (control.stop) and is thrown again here. Where there are no threads
/// (WebAssembly), this one calls `work` and then `poll` once.
void run_workers(int threads, RunControl& control, const std::function<void()>& work,
                 const std::function<void()>& poll);

/// Simulates the tasks 0 ... count-1 on `threads` threads, in lanes. `scenario(index)` makes a
/// task's scenario, or none for one that is refused; `done(index, result)` takes its result. Both
/// are called on any of the threads, once for each task that was begun; which thread that is has no
/// influence on a result. `poll` and exceptions as above.
void simulate_tasks(std::size_t count, int threads, RunControl& control,
                    const std::function<std::optional<Scenario>(std::size_t)>& scenario,
                    const std::function<void(std::size_t, RunResult&&)>& done,
                    const std::function<void()>& poll,
                    std::optional<StopCondition> stop = std::nullopt);

/// How many runs a thread plays at a time, of `count` in all.
std::size_t lanes_a_thread(std::size_t count, int threads);

/// Simulates all scenarios; results in their order, bit-identical for any number of threads. Throws
/// std::invalid_argument before any run if a scenario makes no sense.
std::vector<RunResult> simulate_batch(const std::vector<Scenario>& scenarios, int threads,
                                      RunControl& control, const std::function<void()>& poll,
                                      std::optional<StopCondition> stop = std::nullopt);

}  // namespace stickslip
