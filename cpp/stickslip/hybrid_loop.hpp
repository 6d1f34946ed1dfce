#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "stickslip/assembly.hpp"
#include "stickslip/contact_transitions.hpp"
#include "stickslip/drive_observer.hpp"
#include "stickslip/hybrid_state.hpp"
#include "stickslip/initial_state.hpp"
#include "stickslip/progress_watch.hpp"
#include "stickslip/recording.hpp"
#include "stickslip/simulation.hpp"
#include "stickslip/stepping.hpp"
#include "stickslip/stretch_source.hpp"

namespace stickslip {

/// All that a run takes from one stretch of voltage to the next: restored, it goes on with the same
/// bits.
struct LoopMemory {
    Circuit::Memory circuit;
    Dynamics::Memory dynamics;
    IntegratorMemory integrator;
    PhaseMemory phase;
    HybridState state;
    ProgressWatch watch{0.0};
    ControlSteps::Memory steps;
    double stretch = 0.0;  ///< s, duration of the last one
    bool begun = false;
};

/// The hybrid loop: smooth phases, handed to the integrator, and the events between them.
template <class Integrator>
class HybridLoop {
public:
    /// Ends early where `stop` says.
    HybridLoop(const Scenario& scenario, RunControl* control,
               std::optional<StopCondition> stop = std::nullopt);
    RunResult run();
    /// Plays to the end; the result is then to be taken.
    void go();

    // The parts of a run that is stepped.

    /// Plays the steps of `steps()` from now on, and not the drive of the scenario, which says only
    /// how strong the fields are. `on_step` is called at the end of each step.
    void play_steps(std::function<void()> on_step) {
        source_.play_steps({hold_period_, amplifier_limit_, sign_ < 0.0}, std::move(on_step));
    }
    ControlSteps& steps() { return source_.steps(); }
    /// Counts anew what solver.max_steps limits.
    void reset_counts() {
        integrator_.reset_counts();
        segment_count_ = 0;
    }
    Status status() const { return result_.status; }
    /// At the end of the last stretch.
    SimulationState state() const;
    /// The same without currents.
    SimulationState motion() const {
        return world_state(state_, dynamics_.contact_age() + tau_, sign_);
    }
    LoopMemory loop_memory() const;
    void restore(const LoopMemory& memory);

    // The parts of `run`, for lanes, which integrate the phases of several runs together.

    /// Plays up to the next phase that has to be integrated; false if the run is over.
    bool next_phase();
    /// Calls `use` with that phase.
    void with_phase(auto&& use) { stickslip::with_phase(dynamics_, state_, use); }
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end);
    RunResult take_result();
    void interrupt() { result_.status = Status::interrupted; }
    /// What is called for each step of a phase, see Tsit5::advance.
    template <class Phase>
    auto observer(Phase& phase);

    /// Whether lanes can have it: no named effect, and nothing to look for within the steps.
    bool is_plain() const {
        return dynamics_.is_plain() && circuit_.exponentials() == 1 && !recorder_.on_grid() &&
               !stop_;
    }
    Integrator& integrator() { return integrator_; }
    PhaseMemory& memory() { return memory_; }
    Dynamics& dynamics() { return dynamics_; }
    const BodyState& body() const { return state_.body; }
    int slip() const { return state_.mode.slip; }
    double tau() const { return tau_; }
    double tau_end() const { return segment_.duration; }

private:
    bool next_segment();
    void drive_further_coils();
    void end_stretch();
    void watch_window(double time);
    void close_window(double time);
    std::vector<double> marks() const;
    void begin();
    void begin_segment(const VoltageSegment& voltages);
    void finish();
    void run_rest();
    bool goes_on() const { return result_.status == Status::ok && !result_.stopped; }
    double distance(double t, const BodyState& body) const {
        return stop_->distance(t, sign_ * body.x, body.z, body.theta());
    }
    double find_stop(auto& phase, const auto& step, double s) const;

    void handle(Event event, double tau);
    void after_event(double tau);
    void pass_to(double tau);
    void sample_until(double limit, double from, auto&& snapshot_at);
    void record(double t, double tau, const Snapshot& snapshot);
    double absolute(double tau) const { return segment_.start + tau; }

    const double sign_;
    const Window window_;
    const VoltageProgram program_;
    const double hold_period_;      // s, effect `sample_hold`
    const double amplifier_limit_;  // V, effect of that name
    const PerCoil field_gain_;
    const MeasurementChain chain_;
    const CoilSet coils_;
    const Model model_;
    Circuit circuit_;
    Dynamics dynamics_;
    Integrator integrator_;
    Recorder recorder_;
    SummaryObserver observer_;
    DriveObserver drive_;
    const bool stays_planar_;
    RunControl* control_;
    const std::optional<StopCondition> stop_;
    const double max_check_interval_;  // s, at rest

    StretchSource source_;
    VoltageSegment voltages_;
    CurrentSegment segment_;
    double tau_ = 0.0;  // s, in the segment
    double fastest_decay_ = 0.0;
    bool begun_ = false, measured_ = false;  // whether the run and the measuring window have begun
    bool stretch_is_open_ = false;           // whether one is played, or was and is not ended
    bool touches_down_ = false;              // as the run begins
    HybridState state_;
    ContactTransitions transitions_;
    ProgressWatch watch_;
    const StepDemand demand_;
    Effort effort_;
    PhaseMemory memory_;
    RunResult result_;
    std::int64_t segment_count_ = 0;
};

template <class Integrator>
HybridLoop<Integrator>::HybridLoop(const Scenario& scenario, RunControl* control,
                                   std::optional<StopCondition> stop)
    : sign_(frame_sign(scenario)),
      window_(measuring_window(scenario)),
      program_(make_program(scenario)),
      hold_period_(scenario.effects.sample_hold_period),
      amplifier_limit_(scenario.effects.amplifier_limit_voltage),
      field_gain_(stickslip::field_gain(scenario)),
      chain_(make_measurement_chain(scenario)),
      coils_(scenario.coil.geometry),
      model_(make_model(scenario)),
      circuit_(make_circuit(scenario, program_)),
      dynamics_(model_, make_local_field(scenario, program_, coils_)),
      integrator_(make_stepper_options(scenario, model_, program_, coils_,
                                       control ? &control->stop : nullptr)),
      recorder_(scenario.record, chain_, sign_),
      observer_(pulse_period(scenario)),
      drive_(coils_, circuit_),
      stays_planar_(scenario.solver.planar == Planar::refuse),
      control_(control),
      stop_(stop),
      max_check_interval_(max_check_interval(model_, integrator_.options())),
      source_(program_, hold_period_, marks()),
      transitions_(dynamics_, state_),
      // Fifty free swings.
      watch_(50.0 * 2.0 * std::numbers::pi / integrator_.options().swing_rate),
      demand_(scenario, model_, integrator_.options().swing_rate, program_.duration()) {
    result_.most_steps = scenario.solver.max_steps;
    const Start start = initial_state(scenario, model_);
    state_ = start.state;
    touches_down_ = start.touches_down;
    dynamics_.set_contact_age(start.contact_age);
}

template <class Integrator>
RunResult HybridLoop<Integrator>::run() {
    try {
        go();
    } catch (...) {  // of an effect of the user: the record's sink gets what there is
        recorder_.take();
        throw;
    }
    return take_result();
}

template <class Integrator>
void HybridLoop<Integrator>::go() {
    try {
        while (next_phase()) {
            with_phase([&](auto phase) {
                end_phase(phase, integrator_.advance(phase, memory_, tau_, segment_.duration,
                                                     phase.begin(state_.body), observer(phase)));
            });
        }
    } catch (const WrenchNotFinite& failure) {
        result_.status = Status::not_finite;
        result_.effect = failure.effect;
        result_.summary.simulated_time = failure.time;
    }
}

template <class Integrator>
RunResult HybridLoop<Integrator>::take_result() {
    drive_.write(result_.summary);
    result_.steps = integrator_.counts();
    result_.summary.events = transitions_.counts();
    observer_.write(sign_, result_.summary);
    chain_.apply(result_.summary);
    result_.recording = recorder_.take();
    result_.final_body = state_.body;
    result_.final_state = state();
    effort_.steps = static_cast<double>(result_.steps.accepted + result_.steps.rejected);
    result_.stiffness = demand_.stiffness(effort_);
    result_.bound = demand_.bound(effort_);
    return std::move(result_);
}

template <class Integrator>
bool HybridLoop<Integrator>::next_phase() {
    while (goes_on()) {
        if (tau_ >= segment_.duration) {
            if (!next_segment()) break;
        } else if (state_.rests()) {
            run_rest();
        } else {
            dynamics_.set_quadrant(state_.body.quadrant);
            return true;
        }
    }
    if (result_.status == Status::ok && !source_.is_stepped()) finish();
    return false;
}

template <class Integrator>
bool HybridLoop<Integrator>::next_segment() {
    // The integrators look too; a body at rest needs none.
    if (control_ && control_->stop.load(std::memory_order_relaxed)) {
        result_.status = Status::interrupted;
        return false;
    }
    if (stretch_is_open_) end_stretch();
    if (result_.status != Status::ok) return false;
    if (!source_.next(voltages_)) return false;
    if (++segment_count_ > integrator_.options().most_steps) {
        effort_.stretches = segment_count_;
        result_.status = Status::too_many_steps;
        return false;
    }
    if (source_.is_stepped())
        drive_further_coils();
    else
        watch_window(voltages_.start);
    if (result_.stopped) return false;
    begin_segment(voltages_);
    if (!begun_) begin();
    return !result_.stopped;
}

template <class Integrator>
void HybridLoop<Integrator>::end_stretch() {
    stretch_is_open_ = false;
    // A run that is stepped has no summary: what counts is whether it leaves the plane.
    if (source_.is_stepped() && !DriveObserver::drives_across(dynamics_.field().gain())) return;
    drive_.stretch(voltages_, segment_, dynamics_, state_.body, observer_.is_open());
    if (stays_planar_ && drive_.leaves_plane()) result_.status = Status::leaves_plane;
}

// Coils that the scenario's drive does not use, and a step does.
template <class Integrator>
void HybridLoop<Integrator>::drive_further_coils() {
    PerCoil gain = dynamics_.field().gain();
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        if (voltages_.first[k] != 0.0 || voltages_.last[k] != 0.0) gain[k] = field_gain_[k];
    }
    if (gain != dynamics_.field().gain()) dynamics_.field().set_gain(gain);
}

// Boundaries of stretches carry rounding; the window's ends, and a stop's time, are some of them.
template <class Integrator>
void HybridLoop<Integrator>::watch_window(double time) {
    const double slack = 1e-9 * program_.duration();
    if (!measured_ && time >= window_.start - slack) {
        observer_.open(time, state_.body.x);
        measured_ = true;
    }
    if (observer_.is_open()) observer_.pass(time, state_.body.x);
    if (observer_.is_open() && time >= window_.end - slack) {
        close_window(time);
    }
    if (stop_ && stop_->quantity == StopCondition::Quantity::time) {
        result_.stopped = distance(time + slack, state_.body) <= 0.0;
    }
}

template <class Integrator>
void HybridLoop<Integrator>::close_window(double time) {
    observer_.close(time, state_.body.x, sign_, result_.summary);
    drive_.close(time - observer_.start(), result_.summary);
}

template <class Integrator>
std::vector<double> HybridLoop<Integrator>::marks() const {
    std::vector<double> result = {window_.start, window_.end};
    if (stop_ && stop_->quantity == StopCondition::Quantity::time) {
        result.push_back(stop_->value);
        std::sort(result.begin(), result.end());
    }
    return result;
}

template <class Integrator>
void HybridLoop<Integrator>::begin() {
    begun_ = true;
    transitions_.begin(touches_down_);
    after_event(0.0);
}

template <class Integrator>
SimulationState HybridLoop<Integrator>::state() const {
    SimulationState result = motion();
    // Within a stretch the circuit is at its end already.
    PerCoil current = circuit_.currents(), lag = circuit_.field_lag();
    if (tau_ < segment_.duration) {
        current = segment_.currents(tau_);
        const PerCoil field = segment_.field_currents(tau_);
        for (std::size_t k = 0; k < kCoilCount; ++k) lag[k] = field[k] - current[k];
    }
    result.current = sign_ > 0.0 ? current : turned(current);
    result.field_lag = sign_ > 0.0 ? lag : turned(lag);
    return result;
}

template <class Integrator>
LoopMemory HybridLoop<Integrator>::loop_memory() const {
    return {circuit_.memory(),
            dynamics_.memory(),
            integrator_.memory(),
            memory_,
            state_,
            watch_,
            source_.steps().memory(),
            segment_.duration,
            begun_};
}

template <class Integrator>
void HybridLoop<Integrator>::restore(const LoopMemory& memory) {
    circuit_.restore(memory.circuit);
    dynamics_.restore(memory.dynamics);
    integrator_.restore(memory.integrator);
    memory_ = memory.phase;
    state_ = memory.state;
    watch_ = memory.watch;
    source_.restore(memory.steps);
    segment_.duration = tau_ = memory.stretch;
    begun_ = memory.begun;
    stretch_is_open_ = false;
    result_.status = Status::ok;
}

template <class Integrator>
void HybridLoop<Integrator>::begin_segment(const VoltageSegment& voltages) {
    stretch_is_open_ = true;
    dynamics_.set_contact_age(dynamics_.contact_age() + segment_.duration);
    segment_ = circuit_.advance(voltages);
    tau_ = 0.0;
    dynamics_.set_start(segment_.start);
    dynamics_.field().set_segment(segment_);
    fastest_decay_ =
        *std::max_element(segment_.rate.begin(), segment_.rate.begin() + segment_.exponentials);
}

template <class Integrator>
void HybridLoop<Integrator>::finish() {
    if (result_.stopped) {
        CurrentSegment played = segment_;
        played.duration = tau_;
        if (tau_ > 0.0) {
            drive_.stretch(voltages_, played, dynamics_, state_.body, observer_.is_open());
        }
        if (observer_.is_open()) close_window(absolute(tau_));
        return;
    }
    // The grid's last sample may lie beyond the end by rounding.
    sample_until(program_.duration() * (1.0 + 1e-12), absolute(0.0),
                 [&](double) { return snapshot(dynamics_, state_, segment_.duration); });
    if (observer_.is_open()) close_window(program_.duration());
}

// Samples of the uniform grid in (…, limit] s of absolute time; `snapshot_at(t)` in absolute time.
template <class Integrator>
void HybridLoop<Integrator>::sample_until(double limit, double from, auto&& snapshot_at) {
    const auto stopped = [&] { return control_ && control_->stop.load(std::memory_order_relaxed); };
    for (double t = recorder_.next_time(); t <= limit && !stopped(); t = recorder_.next_time()) {
        const double tau = std::max(t, from) - segment_.start;
        record(t, tau, snapshot_at(tau));
    }
}

template <class Integrator>
void HybridLoop<Integrator>::record(double t, double tau, const Snapshot& snapshot) {
    recorder_.add(t, snapshot, state_.mode,
                  dynamics_.field_at(tau)(snapshot.body.x, snapshot.body.z),
                  field_across(coils_, dynamics_.field().gain(), segment_.field_currents(tau),
                               snapshot.body.x, snapshot.body.z),
                  segment_.currents(tau));
}

template <class Integrator>
void HybridLoop<Integrator>::handle(Event event, double tau) {
    watch_.event(absolute(tau));
    if (watch_.hangs()) result_.status = Status::too_many_events;
    transitions_.handle(event, tau);
    after_event(tau);
    const BodyState& body = state_.body;
    if (!std::isfinite(body.x + body.z + body.angle + body.vx + body.vz + body.omega)) {
        result_.status = Status::not_finite;
    }
}

template <class Integrator>
void HybridLoop<Integrator>::after_event(double tau) {
    memory_ = {};
    memory_.stalled = watch_.stalled();
    // A face that has landed may lie still from now on, so that no step looks.
    if (stop_ && distance(absolute(tau), state_.body) <= 0.0) result_.stopped = true;
    if (!recorder_.at_event(absolute(tau))) return;
    // One sample for each change at this instant, with the state after all of them.
    for (const EventKind kind : transitions_.changes()) {
        record(absolute(tau), tau, snapshot(dynamics_, state_, tau));
        recorder_.add_event(kind);
    }
}

template <class Integrator>
void HybridLoop<Integrator>::run_rest() {
    const FaceRest rest(dynamics_, state_.body);
    if (dynamics_.field().outside()) {
        result_.status = Status::left_workspace;
        return;
    }
    const FaceRest::End end = rest.advance(memory_, tau_, segment_.duration, fastest_decay_,
                                           max_check_interval_, integrator_.options().stop);
    observer_.rest(state_.body.theta());
    sample_until(absolute(end.tau), absolute(tau_), [&](double at) { return rest.snapshot(at); });
    pass_to(end.tau);
    if (end.event != Event::none) {
        handle(end.event, end.tau);
    } else if (end.tau < segment_.duration) {
        result_.status = Status::interrupted;
    }
}

template <class Integrator>
void HybridLoop<Integrator>::pass_to(double tau) {
    result_.summary.simulated_time = absolute(tau);
    if (control_) control_->simulated_time.fetch_add(tau - tau_, std::memory_order_relaxed);
    tau_ = tau;
}

template <class Integrator>
template <class Phase>
auto HybridLoop<Integrator>::observer(Phase& phase) {
    return [this, &phase](const auto& step, double s) {
        const double stop = stop_ ? find_stop(phase, step, s) : kGoesOn;
        if (stop <= s) {
            s = stop;
            result_.stopped = true;
        }
        const double limit = absolute(step.start + s * step.width);
        if (recorder_.next_time() <= limit) {
            sample_until(limit, absolute(step.start), [&](double at) {
                return phase.snapshot(at, step.dense((at - step.start) / step.width));
            });
        }
        return stop;
    };
}

/// The fraction, up to s, of a step at which the condition is met, or kGoesOn.
template <class Integrator>
double HybridLoop<Integrator>::find_stop(auto& phase, const auto& step, double s) const {
    if (stop_->quantity == StopCondition::Quantity::time) return kGoesOn;
    const EventHit hit = find_fall([&](double part) {
        const double at = part * s;
        return distance(absolute(step.start + at * step.width),
                        phase.body(at == 0.0 ? step.first : step.dense(at)));
    });
    return hit ? hit.s * s : kGoesOn;
}

template <class Integrator>
template <class Phase>
void HybridLoop<Integrator>::end_phase(Phase& phase, const PhaseEnd<Phase>& end) {
    observer_.phase(phase, end, end.tau - tau_, state_.body.quadrant);
    effort_.moving_time += end.tau - tau_;
    if (end.event == Event::none) ++effort_.stretches;
    pass_to(end.tau);
    result_.status = end.status;
    state_.body = phase.body(end.y);
    if constexpr (Phase::kSlips) {
        state_.contact_x = phase.contact_x(end.y);
        state_.slip_velocity = phase.slip_velocity(end.y);
    }
    // Near the point where sliding loses its solution the reaction grows faster than any step can
    // follow: the limit is the impulse that stops the slip.
    if constexpr (std::is_same_v<Phase, CornerSlipPhase>) {
        if (end.status == Status::step_underflow && phase.nearly_jams(end.y)) {
            result_.status = Status::ok;
            handle(Event::sliding_jams, end.tau);
            return;
        }
    }
    if (end.status == Status::ok && end.event != Event::none) handle(end.event, end.tau);
    // A phase that ends in its first step does not look at the budget.
    const bool spent = integrator_.counts().accepted > integrator_.options().most_steps;
    if (result_.status == Status::ok && spent) result_.status = Status::too_many_steps;
}

}  // namespace stickslip
