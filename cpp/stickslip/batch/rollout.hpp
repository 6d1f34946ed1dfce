#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "stickslip/batch/batch.hpp"
#include "stickslip/batch/lanes.hpp"
#include "stickslip/batch/simulator.hpp"

namespace stickslip {

/// Voltages of the steps of one or many runs: rows of five (V, world's frame), each for `duration`
/// s, held or linear from those of the row before.
struct ControlRows {
    const double* voltages = nullptr;
    std::size_t steps = 0;
    std::size_t run_stride = 0;  ///< numbers from one run's first row to the next one's; 0: shared
    double duration = 0.0;
    bool linear = false;
};

/// Destination of states: the values of some columns of `kStateColumns`.
struct StateOutput {
    double* values = nullptr;  ///< runs x steps x columns
    std::vector<std::size_t> columns;
};

/// Plays `count` runs from their scenarios' initial states through the same number of steps each,
/// and writes the state at the end of each step; what a failed run does not reach stays as it was.
/// A run fails (`Status::not_finite`) where `scenario` gives none, as its start is not finite, or
/// at the first voltage that is not. A run is in the whole plane if one of its rows turns its
/// robot. Statuses in the order of the runs, bit-identical results for any number of threads.
std::vector<Status> rollout(std::size_t count,
                            const std::function<std::optional<Scenario>(std::size_t)>& scenario,
                            const ControlRows& rows, const StateOutput& output, int threads,
                            RunControl& control, const std::function<void()>& poll);

/// Many runs that are stepped together.
class SimulatorBatch {
public:
    /// Throws std::invalid_argument, with the run's place, for a scenario that makes no sense or
    /// that asks for another integrator than tsit5.
    explicit SimulatorBatch(const std::vector<Scenario>& scenarios);

    std::size_t size() const { return runs_.size(); }
    /// One step of all runs, whose rows are those of `voltages` (size() x 5). A run that has failed
    /// stays where it is, whatever its row is; one whose row is not finite fails before the step.
    /// Throws std::invalid_argument, and moves none, for a row that turns a robot whose scenario
    /// keeps it in one plane.
    /// `poll` is called about every 50 ms of a step that takes long. Where it, or an effect of the
    /// user, throws, runs that have not come to the step's end are `Status::interrupted`, and all
    /// can be begun anew.
    void step(const double* voltages, double duration, bool linear, int threads,
              const std::function<void()>& poll);
    /// Begins one run anew.
    void reset(std::size_t run, const Scenario& scenario);

    const Simulator& run(std::size_t index) const { return *runs_[index]; }
    void restore(std::size_t run, const RunSnapshot& snapshot) { runs_[run]->restore(snapshot); }

private:
    std::unique_ptr<Simulator> make(std::size_t run, const Scenario& scenario);
    void check_steps(const double* voltages) const;
    bool is_short(double duration) const;

    RunControl control_;
    std::vector<std::unique_ptr<Simulator>> runs_;
    std::vector<unsigned char> played_;  // whether each run is at the end of the step
    // Wall time of the last step, s per simulated second of a run; infinite before the first.
    double cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace stickslip
