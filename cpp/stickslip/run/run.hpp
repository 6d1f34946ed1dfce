#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "stickslip/run/measurement.hpp"
#include "stickslip/run/player.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/tsit5.hpp"
#ifdef STICKSLIP_WITH_ARKODE
#include "stickslip/solver/arkode.hpp"
#endif

namespace stickslip {

/// One run, from its scenario's initial state to the end of its drive, or step by step. A Player
/// moves the robot, a Recorder and a Measurement look at each step.
class Run {
public:
    /// Ends early where `stop` says. Throws std::invalid_argument for a method that is not in this
    /// build.
    explicit Run(const Scenario& scenario, RunControl* control = nullptr,
                 std::optional<StopCondition> stop = std::nullopt);

    /// Plays to the end; the result is then to be taken.
    void go();
    RunResult take_result();
    /// How it ended and what to do about it; see stickslip::message.
    std::string message() const;
    /// Gives the record's sink what there is.
    void hand_over_record() { recorder_.take(); }

    /// See Player. After its last step such a run can be given more.
    void play_steps(std::function<void()> on_step) { player_.play_steps(std::move(on_step)); }
    ControlSteps& steps() { return player_.steps(); }
    const ControlSteps& steps() const { return player_.steps(); }
    /// Counts anew what solver.max_steps limits.
    void reset_counts();
    RunSnapshot snapshot() const;
    void restore(const RunSnapshot& snapshot);
    Status status() const { return result_.status; }
    /// Time (s) that the run has reached, or at which it failed.
    double time() const { return result_.summary.simulated_time; }
    const Player& player() const { return player_; }

    // For lanes, which integrate the phases of several runs together.

    /// Plays up to the next phase that has to be integrated; false if the run is over.
    bool next_phase();
    /// Integrates that phase up to its end, or that of the segment of voltage.
    void play_phase();
    Player& player() { return player_; }
    Tsit5& tsit5() { return tsit5_; }
    double next_look() const { return measurement_.next_look(); }
    /// What is called for each step of a phase, see StepLoop::advance.
    template <class Phase>
    auto observer(Phase& phase);
    /// Goes on from where a phase has ended, after so many steps of the run.
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end, std::int64_t steps_taken);
    /// Ends the run where it is.
    void give_up(Status status) {
        result_.status = status;
        end_here();
    }
    /// Whether packs can have it: no effect but smooth ones, and nothing to look for within the
    /// steps.
    bool fits_packs() const {
        return is_tsit5() && !player_.in_whole_plane() && player_.model().is_smooth() &&
               player_.circuit().exponentials() <= kMostPackedExponentials &&
               !recorder_.on_grid() && !stop_;
    }
    /// Whether its phases have no named effect.
    bool is_plain() const {
        return player_.dynamics().is_plain() && player_.circuit().exponentials() == 1;
    }

private:
    bool is_tsit5() const {
#ifdef STICKSLIP_WITH_ARKODE
        return !arkode_;
#else
        return true;
#endif
    }
    bool next_segment();
    // Of a run that ends within a segment.
    void end_here();
    void begin();
    void finish();
    bool goes_on() const {
        return result_.status == Status::ok && !result_.stopped;
    }
    bool is_interrupted() const {
        return control_ && control_->stop.load(std::memory_order_relaxed);
    }
    void handle(Event event);
    void after_event();
    void sample_until(double limit, double from, auto&& snapshot_at);
    void record(double t, double tau, const Snapshot& snapshot);
    double distance(double t, const BodyState& body) const {
        return stop_->distance(t, player_.sign(), body);
    }
    double find_stop(auto& phase, const auto& step, double s) const;
    void fail(const WrenchNotFinite& failure);

    Player player_;
    Measurement measurement_;
    Recorder recorder_;
    Tsit5 tsit5_;
#ifdef STICKSLIP_WITH_ARKODE
    std::optional<Arkode> arkode_;  // where solver.method asks for it
#endif
    RunControl* control_;
    const std::optional<StopCondition> stop_;
    RunResult result_;
    std::int64_t segments_played_ = 0;
};

// Samples of the uniform grid in (…, limit] s of absolute time; `snapshot_at(t)` in absolute time.
void Run::sample_until(double limit, double from, auto&& snapshot_at) {
    for (double t = recorder_.next_time(); t <= limit && !is_interrupted();
         t = recorder_.next_time()) {
        const double tau = std::max(t, from) - player_.segment().start;
        record(t, tau, snapshot_at(tau));
    }
}

template <class Phase>
auto Run::observer(Phase& phase) {
    return [this, &phase](const auto& step, double s) {
        const auto body_at = [&](double tau) {
            const double part = (tau - step.start) / step.width;
            return phase.body(tau, part == 0.0 ? step.first : step.dense(part));
        };
        double stop = kGoesOn;
        const double met = stop_ ? find_stop(phase, step, s) : kGoesOn;
        if (met <= s) s = stop = met;
        if constexpr (Phase::kTurns) {
            PlaneDynamics& plane = player_.plane();
            const auto facing = [&](double tau) { return plane.facing(phase.field_at(tau)); };
            const HeadingEnd end = plane.watch().follow(player_.absolute(0.0), step.start,
                                                        step.start + s * step.width, facing);
            if (end.status != Status::ok) {
                result_.heading_end = end;
                s = stop = (end.tau - step.start) / step.width;
            }
        }
        result_.stopped = met <= s && result_.heading_end.status == Status::ok;
        const double last = step.start + s * step.width;
        if (last >= measurement_.next_look()) {
            measurement_.look_at_field(step.start, last, body_at);
        }
        const double limit = player_.absolute(last);
        if (recorder_.next_time() <= limit) {
            sample_until(limit, player_.absolute(step.start), [&](double at) {
                return phase.snapshot(at, step.dense((at - step.start) / step.width));
            });
        }
        return stop;
    };
}

/// The fraction, up to s, of a step at which the condition is met, or kGoesOn.
double Run::find_stop(auto& phase, const auto& step, double s) const {
    if (stop_->quantity == StopCondition::Quantity::time) return kGoesOn;
    const EventHit hit = find_fall([&](double part) {
        const double at = part * s;
        const double tau = step.start + at * step.width;
        return distance(player_.absolute(tau),
                        phase.body(tau, at == 0.0 ? step.first : step.dense(at)));
    });
    return hit ? hit.s * s : kGoesOn;
}

template <class Phase>
void Run::end_phase(Phase& phase, const PhaseEnd<Phase>& end, std::int64_t steps_taken) {
    const double duration = end.tau - player_.tau();
    measurement_.phase(phase, end, duration);
    player_.end_phase(phase, end);
    result_.summary.simulated_time = player_.time();
    if (control_) control_->add_time(duration);
    result_.status = end.status;
    if (result_.heading_end.status != Status::ok) {
        result_.status = result_.heading_end.status;
        return;
    }
    // Near the point where sliding loses its solution the reaction grows faster than any step can
    // follow: the limit is the impulse that stops the slip.
    if constexpr (requires { phase.nearly_jams(end.tau, end.y); }) {
        if (end.status == Status::step_underflow && phase.nearly_jams(end.tau, end.y)) {
            result_.status = Status::ok;
            handle(Event::sliding_jams);
            return;
        }
    }
    if (end.status == Status::ok && end.event != Event::none) handle(end.event);
    // A phase that ends in its first step does not look at the budget.
    const bool spent = steps_taken > player_.options().most_steps;
    if (result_.status == Status::ok && spent) result_.status = Status::too_many_steps;
}

}  // namespace stickslip
