#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stickslip/assembly.hpp"
#include "stickslip/contact_transitions.hpp"
#include "stickslip/hybrid_state.hpp"
#include "stickslip/progress_watch.hpp"
#include "stickslip/recording.hpp"
#include "stickslip/simulation.hpp"
#include "stickslip/stepping.hpp"

namespace stickslip {

/// The hybrid loop: smooth phases, handed to the integrator, and the events between them.
template <class Integrator>
class HybridLoop {
public:
    HybridLoop(const Scenario& scenario, RunControl* control);
    RunResult run();

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

    /// Whether lanes can have it: no named effect, and no samples within the steps.
    bool is_plain() const {
        return dynamics_.is_plain() && circuit_.exponentials() == 1 && !recorder_.on_grid();
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
    void begin_segment(const VoltageSegment& voltages);
    void finish();
    void run_rest();

    void handle(Event event, double tau);
    void after_event(double tau);
    void pass_to(double tau);
    void sample_until(double limit, double from, auto&& snapshot_at);
    void record(double t, double tau, const Snapshot& snapshot);
    double absolute(double tau) const { return segment_.start + tau; }

    const double sign_;
    const Window window_;
    const VoltageProgram program_;
    const double hold_period_;  // s, effect `sample_hold`
    const MeasurementChain chain_;
    const CoilSet coils_;
    const Model model_;
    Circuit circuit_;
    Dynamics dynamics_;
    Integrator integrator_;
    Recorder recorder_;
    SummaryObserver observer_;
    RunControl* control_;
    const double max_check_interval_;  // s, at rest

    SegmentStream segments_;
    CurrentSegment segment_;
    double tau_ = 0.0;  // s, in the segment
    double fastest_decay_ = 0.0;
    bool begun_ = false, measured_ = false;  // whether the run and the measuring window have begun
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
HybridLoop<Integrator>::HybridLoop(const Scenario& scenario, RunControl* control)
    : sign_(frame_sign(scenario)),
      window_(measuring_window(scenario)),
      program_(make_program(scenario)),
      hold_period_(scenario.effects.sample_hold_period),
      chain_(make_measurement_chain(scenario)),
      coils_(scenario.coil.geometry),
      model_(make_model(scenario)),
      circuit_(make_circuit(scenario, program_)),
      dynamics_(model_, make_local_field(scenario, program_, coils_)),
      integrator_(make_stepper_options(scenario, model_, program_, coils_,
                                       control ? &control->stop : nullptr)),
      recorder_(scenario.record.kind == RecordKind::uniform ? scenario.record.rate : 0.0,
                scenario.record.kind == RecordKind::events, sign_),
      control_(control),
      max_check_interval_(max_check_interval(model_, integrator_.options())),
      segments_(program_, hold_period_, {window_.start, window_.end}),
      transitions_(dynamics_, state_),
      // Fifty free swings.
      watch_(50.0 * 2.0 * std::numbers::pi / integrator_.options().swing_rate),
      demand_(scenario, model_, integrator_.options().swing_rate, program_.duration()) {
    result_.most_steps = scenario.solver.max_steps;
    state_.body.z = model_.shape.half_rise(0);
    state_.contact_x = model_.shape.half_base(0);
}

template <class Integrator>
RunResult HybridLoop<Integrator>::run() {
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
    return take_result();
}

template <class Integrator>
RunResult HybridLoop<Integrator>::take_result() {
    result_.steps = integrator_.counts();
    result_.summary.events = transitions_.counts();
    result_.recording = recorder_.take();
    chain_.apply(result_.summary, result_.recording);
    result_.final_state = state_.body;
    effort_.steps = static_cast<double>(result_.steps.accepted + result_.steps.rejected);
    result_.stiffness = demand_.stiffness(effort_);
    result_.bound = demand_.bound(effort_);
    return std::move(result_);
}

template <class Integrator>
bool HybridLoop<Integrator>::next_phase() {
    while (result_.status == Status::ok) {
        if (tau_ >= segment_.duration) {
            if (!next_segment()) break;
        } else if (state_.rests()) {
            run_rest();
        } else {
            dynamics_.set_quadrant(state_.body.quadrant);
            return true;
        }
    }
    if (result_.status == Status::ok) finish();
    return false;
}

template <class Integrator>
bool HybridLoop<Integrator>::next_segment() {
    // The integrators look too; a body at rest needs none.
    if (control_ && control_->stop.load(std::memory_order_relaxed)) {
        result_.status = Status::interrupted;
        return false;
    }
    VoltageSegment voltages;
    if (!segments_.next(voltages)) return false;
    if (++segment_count_ > integrator_.options().most_steps) {
        effort_.stretches = segment_count_;
        result_.status = Status::too_many_steps;
        return false;
    }
    // Boundaries of stretches carry rounding; the window's ends are two of them.
    const double slack = 1e-9 * program_.duration();
    if (!measured_ && voltages.start >= window_.start - slack) {
        observer_.open(voltages.start, state_.body.x);
        measured_ = true;
    }
    if (observer_.is_open() && voltages.start >= window_.end - slack) {
        observer_.close(voltages.start, state_.body.x, sign_, result_.summary);
    }
    begin_segment(voltages);
    if (!begun_) {
        transitions_.begin();
        after_event(0.0);
        begun_ = true;
    }
    return true;
}

template <class Integrator>
void HybridLoop<Integrator>::begin_segment(const VoltageSegment& voltages) {
    dynamics_.set_contact_age(dynamics_.contact_age() + segment_.duration);
    segment_ = circuit_.advance(voltages);
    tau_ = 0.0;
    dynamics_.set_start(segment_.start);
    dynamics_.field().set_segment(segment_);
    fastest_decay_ = *std::max_element(segment_.rate.begin(), segment_.rate.end());
}

template <class Integrator>
void HybridLoop<Integrator>::finish() {
    // The grid's last sample may lie beyond the end by rounding.
    sample_until(program_.duration() * (1.0 + 1e-12), absolute(0.0),
                 [&](double) { return snapshot(dynamics_, state_, segment_.duration); });
    if (observer_.is_open()) {
        observer_.close(program_.duration(), state_.body.x, sign_, result_.summary);
    }
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
    if (!recorder_.at_events()) return;
    // One sample for each change at this instant, with the state after all of them.
    for (const EventKind kind : transitions_.changes()) {
        record(absolute(tau), tau, snapshot(dynamics_, state_, tau));
        recorder_.add_event(kind);
    }
}

template <class Integrator>
void HybridLoop<Integrator>::run_rest() {
    const FaceRest rest(dynamics_, state_.body);
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
        const double limit = absolute(step.start + s * step.width);
        if (recorder_.next_time() > limit) return;
        sample_until(limit, absolute(step.start), [&](double at) {
            return phase.snapshot(at, step.dense((at - step.start) / step.width));
        });
    };
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
