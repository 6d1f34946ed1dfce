#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "stickslip/batch/lanes.hpp"

namespace stickslip {

/// Runs `work()` on each of `threads` threads (at least one, this one not among them) and calls
/// `poll` on this thread about every 50 ms until all are done. An exception of `work` or of `poll`
/// makes the others stop (control.stop) and is thrown again here. Where there are no threads
/// (WebAssembly), this one calls `work` and then `poll` once.
void run_workers(int threads, RunControl& control, const std::function<void()>& work,
                 const std::function<void()>& poll);

/// The runs of a batch while they are played. Any thread makes and erases its own.
class LaneStore {
public:
    Lane* make(std::size_t index, const Scenario& scenario, RunControl& control,
               std::optional<StopCondition> stop = std::nullopt);
    void erase(const Lane& lane);

private:
    std::mutex mutex_;
    std::map<const Lane*, std::unique_ptr<Lane>> lanes_;
};

/// Plays the runs 0 ... count-1 on `threads` threads, as many at a time as are quickest.
/// `lane(index)` gives a run, or none where there is nothing to play; `done(lane)` takes one that
/// is over. Both are called on any of the threads, which has no influence on a result. `poll` and
/// exceptions as above; without `poll` one thread is this one: starting another would take longer
/// than a step.
void play_all(std::size_t count, int threads, RunControl& control,
              const std::function<Lane*(std::size_t)>& lane, const std::function<void(Lane&)>& done,
              const std::function<void()>* poll);

/// Simulates the tasks 0 ... count-1. `scenario(index)` makes a task's scenario, or none for one
/// that is refused; `done(index, result)` takes its result. Both as in `play_all`.
void simulate_tasks(std::size_t count, int threads, RunControl& control,
                    const std::function<std::optional<Scenario>(std::size_t)>& scenario,
                    const std::function<void(std::size_t, RunResult&&)>& done,
                    const std::function<void()>& poll,
                    std::optional<StopCondition> stop = std::nullopt);

/// Simulates all scenarios; results in their order, bit-identical for any number of threads. Throws
/// std::invalid_argument before any run if a scenario makes no sense.
std::vector<RunResult> simulate_batch(const std::vector<Scenario>& scenarios, int threads,
                                      RunControl& control, const std::function<void()>& poll,
                                      std::optional<StopCondition> stop = std::nullopt);

/// Result of one point of a sweep.
struct SweepPoint {
    Status status = Status::ok;
    bool refused = false;  ///< the point's values make no scenario; `message` says why
    Summary summary;
    std::string message;  ///< empty where the status is ok
};

/// Simulates `base` at many points of its keys. `values` holds a row for each point, a column for
/// each key; a key that takes words has the index of the word in its column. Summaries only, in the
/// order of the rows, bit-identical for any number of threads. A point that is refused is a point,
/// not an error. Throws std::invalid_argument for an unknown key or a size that does not fit.
std::vector<SweepPoint> sweep(const Scenario& base, const std::vector<std::string>& keys,
                              const std::vector<double>& values, int threads, RunControl& control,
                              const std::function<void()>& poll);

}  // namespace stickslip
