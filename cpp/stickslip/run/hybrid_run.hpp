#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/contact/hybrid_state.hpp"
#include "stickslip/drive/stretch_source.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/drive_observer.hpp"
#include "stickslip/run/initial_state.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/run/run_snapshot.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/progress_watch.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// A run apart from its integrator: the stretches of voltage, rests, events, and what is recorded
/// and measured of them. Between these lie the phases, which a HybridLoop integrates.
class HybridRun {
public:
    // Members point to members.
    HybridRun(const HybridRun&) = delete;
    HybridRun& operator=(const HybridRun&) = delete;

    // The parts of a run that is stepped.

    /// Plays the steps of `steps()` from now on, and not the drive of the scenario, which says only
    /// how strong the fields are. `on_step` is called at the end of each step.
    void play_steps(std::function<void()> on_step) {
        source_.play_steps({hold_period_, amplifier_limit_, sign_ < 0.0}, std::move(on_step));
    }
    ControlSteps& steps() { return source_.steps(); }
    const ControlSteps& steps() const { return source_.steps(); }
    bool in_whole_plane() const { return plane_.has_value(); }
    /// Between two steps, or where one has failed; without the scenario's fingerprint and message.
    RunSnapshot snapshot() const;
    void restore(const RunSnapshot& snapshot);
    Status status() const { return result_.status; }
    /// Up to which it was played, s, or failed.
    double time() const { return result_.summary.simulated_time; }
    /// At the end of the last stretch.
    SimulationState state() const;
    /// The same without currents.
    SimulationState motion() const {
        return world_state(state_, dynamics_.contact_age() + tau_, sign_, in_whole_plane());
    }

    // For lanes, which integrate the phases of several runs together.

    /// Plays up to the next phase that has to be integrated; false if the run is over.
    bool next_phase();
    /// Calls `use` with that phase.
    void with_phase(auto&& use) {
        if (plane_) {
            with_plane_phase(*plane_, state_, [&](auto phase) {
                phase.set_front(state_.body.heading);
                use(phase);
            });
        } else {
            stickslip::with_phase(dynamics_, state_, use);
        }
    }
    /// What is called for each step of a phase, see StepLoop::advance.
    template <class Phase>
    auto observer(Phase& phase);
    /// Ends the run where it is.
    void give_up(Status status) {
        result_.status = status;
        if (source_.is_stepped()) stay_there();
    }
    /// Whether packs can have it: no effect but smooth ones, and nothing to look for within the
    /// steps.
    bool fits_packs() const {
        return !plane_ && model_.is_smooth() &&
               circuit_.exponentials() <= kMostPackedExponentials && !recorder_.on_grid() && !stop_;
    }
    /// Whether its phases have no named effect.
    bool is_plain() const { return dynamics_.is_plain() && circuit_.exponentials() == 1; }
    PhaseMemory& memory() { return memory_; }
    Dynamics& dynamics() { return dynamics_; }
    const BodyState& body() const { return state_.body; }
    int slip() const { return state_.mode.slip; }
    double tau() const { return tau_; }
    /// From when on the field has to be looked at within steps, s in the stretch.
    double next_look() const { return next_look_; }
    /// s, up to where the stretch is played.
    double tau_end() const {
        return plane_ ? std::min(segment_.duration, plane_->watch().end().tau) : segment_.duration;
    }

protected:
    HybridRun(const Scenario& scenario, RunControl* control, std::optional<StopCondition> stop);

    const StepperOptions& options() const { return options_; }
    void reset_counts() { segment_count_ = 0; }
    RunResult take_result(const StepCounts& counts);

    /// Goes on from where a phase has ended. accepted: steps of the integrator so far.
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end, std::int64_t accepted);
    void fail(const WrenchNotFinite& failure);
    /// Gives the record's sink what there is.
    void hand_over_record() { recorder_.take(); }

private:
    bool next_segment();
    // Where a step has failed: the currents are from now on those of that instant.
    void stay_there();
    void drive_further_coils();
    void end_stretch();
    void watch_heading();
    void observe_stretch(const CurrentSegment& played);
    PerCoilOf<CoilField> field_of_coils() const;
    void write_pull_and_change();
    void observe_to(double tau);
    void plan_looks();
    void end_look();
    void look_at_field(double from, double to, auto&& body_at);
    /// At the robot's place, `tau` seconds into the stretch, T.
    std::array<double, 3> field(double tau, const BodyState& body) const;
    double squared_field(double tau, const BodyState& body) const {
        const std::array<double, 3> b = field(tau, body);
        return b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    }
    Snapshot snapshot(double tau) const {
        return plane_ ? stickslip::snapshot(*plane_, state_, tau)
                      : stickslip::snapshot(dynamics_, state_, tau);
    }
    void watch_window(double time);
    void close_window(double time);
    std::vector<double> marks() const;
    void begin();
    void begin_segment(const VoltageSegment& voltages);
    void finish();
    void run_rest();
    template <class Rest>
    void run_rest(const Rest& rest, bool outside);
    bool goes_on() const { return result_.status == Status::ok && !result_.stopped; }
    void handle(Event event, double tau);
    void after_event(double tau);
    void pass_to(double tau);
    double distance(double t, const BodyState& body) const {
        return stop_->distance(t, sign_, body);
    }
    double find_stop(auto& phase, const auto& step, double s) const;
    double find_stop(const auto& rest, double tau) const;
    double absolute(double tau) const { return segment_.start + tau; }
    void sample_until(double limit, double from, auto&& snapshot_at);
    void record(double t, double tau, const Snapshot& snapshot);
    static Place place(const BodyState& body) { return {body.x, body.y, body.z}; }

    static constexpr double kNoLook = std::numeric_limits<double>::infinity();

    const double sign_;
    const Window window_;
    const VoltageProgram program_;
    const double hold_period_;      // s, effect `sample_hold`
    const double amplifier_limit_;  // V, effect of that name
    const PerCoil field_gain_;
    const CoilSet coils_;
    const Model model_;
    Circuit circuit_;
    Dynamics dynamics_;
    const StepperOptions options_;
    std::optional<PlaneDynamics> plane_;        // of a robot that moves in the whole plane
    Recorder recorder_;
    SummaryObserver observer_;
    DriveObserver drive_;
    RunControl* control_;
    const std::optional<StopCondition> stop_;
    const double max_check_interval_;  // s, at rest

    StretchSource source_;
    VoltageSegment voltages_;
    CurrentSegment segment_;
    double tau_ = 0.0;  // s, in the segment
    // Where the field may turn in what is left of the segment, the next such time last.
    struct FieldLook {
        FieldTurn turn;
        bool for_most, for_least;
    };
    std::vector<FieldLook> looks_;
    double next_look_ = kNoLook;  // s
    double fastest_decay_ = 0.0;
    bool begun_ = false, measured_ = false;  // whether the run and the measuring window have begun
    bool stretch_is_open_ = false;           // whether one is played, or was and is not ended
    bool touches_down_ = false;              // as the run begins
    PerCoilOf<CoilField> start_fields_ = {};
    double turned_before_ = 0.0;  // rad, of the heading before the measuring window
    HybridState state_;
    ContactTransitions transitions_;
    ProgressWatch watch_;
    PhaseMemory memory_;
    RunResult result_;
    std::int64_t segment_count_ = 0;
};

// Samples of the uniform grid in (…, limit] s of absolute time; `snapshot_at(t)` in absolute time.
void HybridRun::sample_until(double limit, double from, auto&& snapshot_at) {
    const auto stopped = [&] { return control_ && control_->stop.load(std::memory_order_relaxed); };
    for (double t = recorder_.next_time(); t <= limit && !stopped(); t = recorder_.next_time()) {
        const double tau = std::max(t, from) - segment_.start;
        record(t, tau, snapshot_at(tau));
    }
}

/// The field in what has been played from one time to another, where it may turn.
void HybridRun::look_at_field(double from, double to, auto&& body_at) {
    const bool in_window = observer_.is_open();
    const auto square = [&](double tau) {
        const double value = squared_field(tau, body_at(tau));
        drive_.see_field(value, in_window);
        return value;
    };
    const auto worth = [this](double value) { return drive_.would_be_least(value); };
    const auto negative = [&](double tau) { return -square(tau); };
    const auto worth_negative = [this](double value) { return drive_.would_be_most(-value); };
    while (next_look_ <= to) {
        FieldLook& look = looks_.back();
        const FieldTurn& turn = look.turn;
        if (turn.curve != 0.0) {
            const double at =
                look.for_least
                    ? least_value_near(turn.at, turn.curve, from, to, square, worth).at
                    : least_value_near(turn.at, -turn.curve, from, to, negative, worth_negative).at;
            if (at > to && turn.to > to) {  // it is in one of the next steps
                look.turn.at = at;
                next_look_ = to;
                break;
            }
        } else {
            const double begin = std::max(turn.from, from), end = std::min(turn.to, to);
            const int parts = end - begin > 0.5 * (to - from) ? 2 : 1;
            if (look.for_least) least_value(begin, end, parts, square, worth);
            if (look.for_most) least_value(begin, end, parts, negative, worth_negative);
            if (turn.to > to) break;  // it goes on after these
        }
        end_look();
    }
}

template <class Phase>
auto HybridRun::observer(Phase& phase) {
    return [this, &phase](const auto& step, double s) {
        double stop = kGoesOn;
        if constexpr (Phase::kTurns) {
            if (plane_->has_moved()) {
                plane_->watch_at(step.start, place(phase.body(step.start, step.first)));
            }
            const double end = (plane_->watch().end().tau - step.start) / step.width;
            if (end < s) s = stop = std::max(end, 0.0);
        }
        const double met = stop_ ? find_stop(phase, step, s) : kGoesOn;
        if (met <= s) {
            s = stop = met;
            result_.stopped = true;
        }
        const double last = step.start + s * step.width;
        if (last >= next_look_) {
            look_at_field(step.start, last, [&](double tau) {
                const double part = (tau - step.start) / step.width;
                return phase.body(tau, part == 0.0 ? step.first : step.dense(part));
            });
        }
        const double limit = absolute(last);
        if (recorder_.next_time() <= limit) {
            sample_until(limit, absolute(step.start), [&](double at) {
                return phase.snapshot(at, step.dense((at - step.start) / step.width));
            });
        }
        return stop;
    };
}

/// The fraction, up to s, of a step at which the condition is met, or kGoesOn.
double HybridRun::find_stop(auto& phase, const auto& step, double s) const {
    if (stop_->quantity == StopCondition::Quantity::time) return kGoesOn;
    const EventHit hit = find_fall([&](double part) {
        const double at = part * s;
        const double tau = step.start + at * step.width;
        return distance(absolute(tau), phase.body(tau, at == 0.0 ? step.first : step.dense(at)));
    });
    return hit ? hit.s * s : kGoesOn;
}

/// The time, up to `tau` s, at which it is met at rest, or infinity. All that changes there is the
/// time, which ends a stretch, and the heading.
double HybridRun::find_stop(const auto& rest, double tau) const {
    if constexpr (requires { rest.body(tau); }) {
        if (stop_ && stop_->quantity == StopCondition::Quantity::heading) {
            return fall_in_rest(tau_, tau, fastest_decay_,
                                [&](double at) { return distance(absolute(at), rest.body(at)); });
        }
    }
    return std::numeric_limits<double>::infinity();
}

template <class Phase>
void HybridRun::end_phase(Phase& phase, const PhaseEnd<Phase>& end, std::int64_t accepted) {
    observer_.phase(phase, end, end.tau - tau_, state_.body.quadrant);
    pass_to(end.tau);
    result_.status = end.status;
    state_.body = phase.body(end.tau, end.y);
    if constexpr (Phase::kSlips) {
        state_.contact_x = phase.contact_x(end.y);
        state_.slip_velocity = phase.slip_velocity(end.y);
        if constexpr (Phase::kTurns) {
            state_.contact_y = phase.contact_y(end.y);
            state_.slip_y = phase.slip_y(end.y);
        }
    }
    // Near the point where sliding loses its solution the reaction grows faster than any step can
    // follow: the limit is the impulse that stops the slip.
    if constexpr (requires { phase.nearly_jams(end.tau, end.y); }) {
        if (end.status == Status::step_underflow && phase.nearly_jams(end.tau, end.y)) {
            result_.status = Status::ok;
            handle(Event::sliding_jams, end.tau);
            return;
        }
    }
    if (end.status == Status::ok && end.event != Event::none) handle(end.event, end.tau);
    // A phase that ends in its first step does not look at the budget.
    const bool spent = accepted > options_.most_steps;
    if (result_.status == Status::ok && spent) result_.status = Status::too_many_steps;
}

}  // namespace stickslip
