#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "stickslip/contact/heading_watch.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/run/status.hpp"
#include "stickslip/run/stop_condition.hpp"
#include "stickslip/run/summary.hpp"
#include "stickslip/scenario/state.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

enum class Method;

struct RunResult {
    Status status = Status::ok;
    Summary summary;
    StepCounts steps;
    double counted_from = 0.0;  ///< s, where the count of steps begins
    Recording recording;
    BodyState final_body;         ///< robot's own frame
    SimulationState final_state;  ///< where the run ended
    bool stopped = false;         ///< where its stop condition was met
    std::string effect;           ///< of the user, that gave what is not finite and ended the run
    double swing_rate = 0.0;      ///< rad/s, of the free swing, for the message
    Decay decay;                  ///< the fastest, for the message
    HeadingEnd heading_end;       ///< why the heading ended, for the message
    std::int64_t most_steps = 0;  ///< solver.max_steps, for the message
    std::shared_ptr<const FieldMap> map;  ///< of the scenario, for the message
};

/// Sentence that says why a run ended and what to do about it.
std::string message(const RunResult& result);

/// Data that a simulation shares with the thread that waits for it.
struct RunControl {
    std::atomic<bool> stop = false;
    std::atomic<double> simulated_time = 0.0;  ///< s, done so far by all runs together
    /// Summaries say nothing of coils and field, which is a tenth of the work.
    bool motion_only = false;

    /// Adds the time of a run, s. libc++ has no fetch_add of a double before 18.
    void add_time(double duration) {
        double sum = simulated_time;
        while (!simulated_time.compare_exchange_weak(sum, sum + duration)) continue;
    }
};

/// Whether a method is in this build.
bool has_method(Method method);

/// Simulates one scenario from its initial state to the end of its drive, or to where `stop` is
/// met. Throws std::invalid_argument for a scenario that makes no sense (see `check`); everything
/// that happens later is a status.
RunResult simulate(const Scenario& scenario, RunControl* control = nullptr,
                   std::optional<StopCondition> stop = std::nullopt);

}  // namespace stickslip
