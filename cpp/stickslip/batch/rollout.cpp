#include "stickslip/batch/rollout.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/batch/simulator.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {
namespace {

Scenario without_record(Scenario scenario) {
    scenario.record = {};
    return scenario;
}

void require_tsit5(const Scenario& scenario) {
    if (scenario.solver.method != Method::tsit5) {
        throw std::invalid_argument(
            "solver.method = \"arkode\": allowed is \"tsit5\" where many runs are stepped "
            "together");
    }
}

// Calls, and names the run of several in the message of a refusal.
auto of_run(std::size_t run, auto&& call) {
    try {
        return call();
    } catch (const std::invalid_argument& refusal) {
        throw std::invalid_argument("run " + std::to_string(run) + ": " + refusal.what());
    }
}

PerCoil per_coil(const double* row) {
    PerCoil result;
    std::copy_n(row, result.size(), result.begin());
    return result;
}

bool is_finite(const double* row) {
    return std::all_of(row, row + kCoilCount, [](double volts) { return std::isfinite(volts); });
}

/// The number of steps of a run up to the first whose voltages are not finite.
std::size_t finite_steps(const ControlRows& rows, std::size_t run) {
    const double* row = rows.voltages + run * rows.run_stride;
    for (std::size_t k = 0; k < rows.steps; ++k, row += kCoilCount) {
        if (!is_finite(row)) return k;
    }
    return rows.steps;
}

/// Whether one of the first `steps` of a run turns its robot.
bool any_turns(const Scenario& scenario, const ControlRows& rows, std::size_t run,
               std::size_t steps) {
    const double* row = rows.voltages + run * rows.run_stride;
    for (std::size_t k = 0; k < steps; ++k, row += kCoilCount) {
        if (in_whole_plane(scenario, per_coil(row))) return true;
    }
    return false;
}

/// The states of a run at the end of its steps go to `output`.
void write_states(Lane& lane, const ControlRows& rows, const StateOutput& output) {
    const bool with_currents =
        std::any_of(output.columns.begin(), output.columns.end(), is_current);
    const std::size_t begin = lane.index * rows.steps * output.columns.size();
    lane.run.play_steps([&output, &lane, with_currents, to = output.values + begin]() mutable {
        const StateRow state =
            row_of(with_currents ? lane.run.player().world() : lane.run.player().motion());
        for (const std::size_t column : output.columns) *to++ = state[column];
    });
}

}  // namespace

std::vector<Status> rollout(std::size_t count,
                            const std::function<std::optional<Scenario>(std::size_t)>& scenario,
                            const ControlRows& rows, const StateOutput& output, int threads,
                            RunControl& control, const std::function<void()>& poll) {
    std::vector<Status> result(count, Status::interrupted);
    LaneStore lanes;
    std::vector<std::size_t> finite(count);
    const auto begin = [&](std::size_t index) -> Lane* {
        const std::optional<Scenario> given = scenario(index);
        if (!given) {
            result[index] = Status::not_finite;
            return nullptr;
        }
        Scenario own = without_record(*given);
        require_tsit5(own);
        finite[index] = finite_steps(rows, index);
        own.whole_plane = own.whole_plane || any_turns(own, rows, index, finite[index]);
        check(own);
        Lane* const lane = lanes.make(index, own, control);
        write_states(*lane, rows, output);
        lane->run.steps().give(rows.voltages + index * rows.run_stride, finite[index],
                               rows.duration, rows.linear);
        return lane;
    };
    const auto done = [&](Lane& lane) {
        Status& status = result[lane.index];
        status = lane.run.status();
        if (status == Status::ok && finite[lane.index] < rows.steps) status = Status::not_finite;
        lanes.erase(lane);
    };
    play_all(count, threads, control, begin, done, &poll);
    return result;
}

SimulatorBatch::SimulatorBatch(const std::vector<Scenario>& scenarios) {
    runs_.reserve(scenarios.size());
    for (std::size_t run = 0; run < scenarios.size(); ++run) {
        runs_.push_back(make(run, scenarios[run]));
    }
}

std::unique_ptr<Simulator> SimulatorBatch::make(std::size_t run, const Scenario& scenario) {
    return of_run(run, [&] {
        require_tsit5(scenario);
        return std::make_unique<Simulator>(scenario, run, &control_);
    });
}

void SimulatorBatch::reset(std::size_t run, const Scenario& scenario) {
    runs_[run] = make(run, scenario);
}

// Before any run moves.
void SimulatorBatch::check_steps(const double* voltages) const {
    for (std::size_t run = 0; run < runs_.size(); ++run) {
        const double* row = voltages + run * kCoilCount;
        if (runs_[run]->status() != Status::ok || !is_finite(row)) continue;
        of_run(run, [&] { runs_[run]->check_step(per_coil(row)); });
    }
}

void SimulatorBatch::step(const double* voltages, double duration, bool linear, int threads,
                          const std::function<void()>& poll) {
    check_steps(voltages);
    for (std::size_t run = 0; run < runs_.size(); ++run) {
        Simulator& own = *runs_[run];
        if (own.status() != Status::ok) continue;
        const double* row = voltages + run * kCoilCount;
        if (is_finite(row)) {
            own.begin_step(row, duration, linear);
        } else {
            own.give_up(Status::not_finite);
        }
    }
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    played_.assign(runs_.size(), 0);
    const auto lane = [this](std::size_t run) { return &runs_[run]->lane(); };
    const auto done = [this](Lane& each) {
        played_[each.index] = 1;
        runs_[each.index]->end_step();
    };
    try {
        play_all(runs_.size(), threads, control_, lane, done, is_short(duration) ? nullptr : &poll);
    } catch (...) {
        for (std::size_t run = 0; run < runs_.size(); ++run) {
            Simulator& own = *runs_[run];
            if (!played_[run] && own.status() == Status::ok) own.give_up(Status::interrupted);
        }
        control_.stop = false;
        throw;
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    cost_ = seconds / (duration * static_cast<double>(runs_.size()));
}

// Whether a step as the last one is over before anybody misses a poll.
bool SimulatorBatch::is_short(double duration) const {
    constexpr double kLong = 0.05;  // s
    return cost_ * duration * static_cast<double>(runs_.size()) < kLong;
}

}  // namespace stickslip
