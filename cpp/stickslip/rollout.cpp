#include "stickslip/rollout.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/assembly.hpp"

namespace stickslip {
namespace {

/// Plays lanes on threads, as many at a time as are quickest. Without `poll` one thread is this
/// one: starting another would take longer than a step.
void play_all(std::size_t count, int threads, RunControl& control,
              const std::function<Lane*(std::size_t)>& lane, const std::function<void(Lane&)>& done,
              const std::function<void()>* poll) {
    const int workers =
        static_cast<int>(std::min(count, static_cast<std::size_t>(std::max(threads, 1))));
    const std::size_t lanes = lanes_a_thread(count, workers);
    std::atomic<std::size_t> taken = 0;
    const auto next = [&]() -> Lane* {
        const std::size_t index = taken++;
        return index < count ? lane(index) : nullptr;
    };
    const auto work = [&] { play_in_lanes(lane_kernels(), lanes, next, done, control); };
    if (poll == nullptr && workers == 1) {
        work();
    } else {
        run_workers(
            workers, control, work, poll ? *poll : [] {});
    }
}

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

}  // namespace

std::vector<Status> rollout(std::size_t count, const std::function<Scenario(std::size_t)>& scenario,
                            const ControlRows& rows, const StateOutput& output, int threads,
                            RunControl& control, const std::function<void()>& poll) {
    std::vector<Status> result(count, Status::interrupted);
    if (count == 0) return result;
    std::mutex mutex;
    std::map<const Lane*, std::unique_ptr<Lane>> lanes;
    const std::size_t columns = output.columns.size();
    const bool with_currents =
        std::any_of(output.columns.begin(), output.columns.end(), is_current);
    const auto begin = [&](std::size_t index) -> Lane* {
        Scenario own = without_record(scenario(index));
        const double* voltages = rows.voltages + index * rows.run_stride;
        for (std::size_t k = 0; k < rows.steps; ++k, voltages += kCoilCount) {
            PerCoil row;
            std::copy_n(voltages, row.size(), row.begin());
            own.whole_plane = own.whole_plane || turns(row);
        }
        require_tsit5(own);
        check(own);
        auto lane = std::make_unique<Lane>(index, own, control);
        Lane* const key = lane.get();
        double* to = output.values + index * rows.steps * columns;
        key->loop.play_steps([&output, with_currents, key, to]() mutable {
            const StateRow state = row_of(with_currents ? key->loop.state() : key->loop.motion());
            for (const std::size_t column : output.columns) *to++ = state[column];
        });
        key->loop.steps().give(rows.voltages + index * rows.run_stride, rows.steps, rows.duration,
                               rows.linear);
        const std::lock_guard lock(mutex);
        lanes.emplace(key, std::move(lane));
        return key;
    };
    const auto done = [&](Lane& lane) {
        result[lane.index] = lane.loop.status();
        const std::lock_guard lock(mutex);
        lanes.erase(&lane);
    };
    play_all(count, threads, control, begin, done, &poll);
    return result;
}

SimulatorBatch::SimulatorBatch(const std::vector<Scenario>& scenarios) : scenarios_(scenarios) {
    lanes_.reserve(scenarios.size());
    for (std::size_t run = 0; run < scenarios.size(); ++run) {
        lanes_.push_back(make_lane(run, scenarios[run]));
    }
}

std::unique_ptr<Lane> SimulatorBatch::make_lane(std::size_t run, const Scenario& scenario) {
    try {
        require_tsit5(scenario);
        check(scenario);
    } catch (const std::invalid_argument& refusal) {
        throw std::invalid_argument("run " + std::to_string(run) + ": " + refusal.what());
    }
    auto lane = std::make_unique<Lane>(run, without_record(scenario), control_);
    lane->loop.play_steps([] {});
    return lane;
}

void SimulatorBatch::reset(std::size_t run, const Scenario& scenario) {
    lanes_[run] = make_lane(run, scenario);
    scenarios_[run] = scenario;
}

// A run that a step turns goes on in the whole plane.
void SimulatorBatch::enter_plane(std::size_t run) {
    const Lane::Loop& before = lanes_[run]->loop;
    const ControlSteps::Memory steps = before.steps().world_memory();
    lanes_[run] = make_lane(run, in_whole_plane(scenarios_[run], before.state()));
    lanes_[run]->loop.steps().restore(steps);
}

void SimulatorBatch::step(const double* voltages, double duration, bool linear, int threads) {
    for (std::size_t run = 0; run < lanes_.size(); ++run) {
        if (lanes_[run]->loop.status() != Status::ok) continue;
        const double* row = voltages + run * kCoilCount;
        PerCoil asked;
        std::copy_n(row, asked.size(), asked.begin());
        if (!lanes_[run]->loop.in_whole_plane() && turns(asked)) enter_plane(run);
        Lane::Loop& loop = lanes_[run]->loop;
        loop.reset_counts();
        loop.steps().give(row, 1, duration, linear);
    }
    play_all(
        lanes_.size(), threads, control_, [&](std::size_t run) { return lanes_[run].get(); },
        [](Lane&) {}, nullptr);
}

}  // namespace stickslip
