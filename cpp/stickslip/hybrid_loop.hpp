#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stickslip/assembly.hpp"
#include "stickslip/impact.hpp"
#include "stickslip/phases.hpp"
#include "stickslip/recording.hpp"
#include "stickslip/rest.hpp"
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
    void with_phase(auto&& use);
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
    const BodyState& body() const { return body_; }
    int slip() const { return mode_.slip; }
    double tau() const { return tau_; }
    double tau_end() const { return segment_.duration; }

private:
    bool next_segment();
    void begin_segment(const VoltageSegment& voltages);
    void finish();
    void run_rest();

    // Events.
    void handle(Event event, double tau);
    void react(Event event, double tau);
    void land(int quadrant, Arrival arrival, double tau);
    void touch_down(int corner_offset, double tau);
    void settle(Touch touch, double slip_velocity, int onset, double tau);
    void pivot_on_rear_end();
    void count(EventKind kind);
    void count_change(const ContactMode& before);
    void record_events(double tau);
    Snapshot snapshot_now(double tau) const;
    void watch_progress(double tau);
    void pass_to(double tau);

    void sample_until(double limit, double from, auto&& snapshot_at);
    void place_by_contact();
    double absolute(double tau) const { return segment_.start + tau; }
    Pose pose() { return dynamics_.rebase_angle(body_.angle); }

    static StepperOptions options(const Scenario& scenario, const Model& model,
                                  const VoltageProgram& program, const CoilSet& coils,
                                  RunControl* control);
    static double longest_look(const Model& model, const StepperOptions& options);

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
    const double longest_look_;  // s, at rest

    SegmentStream segments_;
    CurrentSegment segment_;
    double tau_ = 0.0;  // s, in the segment
    double fastest_decay_ = 0.0;
    bool begun_ = false, measured_ = false;  // whether the run and the measuring window have begun
    BodyState body_;
    ContactMode mode_;
    double contact_x_ = 0.0;  // m, pivot corner; kept, not derived, so that a stuck corner stays
    double slip_velocity_ = 0.0;  // m/s
    PhaseMemory memory_;
    std::vector<EventKind> pending_;  // counted, not yet recorded
    RunResult result_;
    // See watch_progress.
    static constexpr int kMostStalls = 4;
    double last_event_ = -1.0;   // s
    double burst_start_ = -1.0;  // s
    double burst_span_;          // s, of fifty free swings
    int stalls_ = 0;
    int burst_ = 0;
    std::int64_t segment_count_ = 0;
};

// Natural scales: the free swing about a corner in the strongest field, under weight and adhesion.
template <class Integrator>
StepperOptions HybridLoop<Integrator>::options(const Scenario& scenario, const Model& model,
                                               const VoltageProgram& program, const CoilSet& coils,
                                               RunControl* control) {
    double field = std::hypot(scenario.effects.ambient_field_bx, scenario.effects.ambient_field_bz);
    for (const double voltage : program.largest_voltage()) {
        field += voltage / scenario.coil.resistance * coils.centre_field_per_ampere();
    }
    const double radius = model.shape.radius();
    const double weight = model.mass * scenario.gravity + model.adhesion.strength;
    const double torque = model.moment * field + weight * radius;
    StepperOptions result;
    result.max_step = scenario.solver.max_step;
    result.most_steps = scenario.solver.max_steps;
    const double swing = std::sqrt(torque / model.corner_inertia());
    result.swing_rate = swing > 0.0 ? swing : 1.0;
    result.scales = {radius, radius * result.swing_rate, result.swing_rate};
    // A motion forgets its errors as fast as it is damped; what is hardly damped adds them up. In
    // proportion to the damping, the error of a run goes with rtol whatever the drag.
    constexpr double kForgetting = 0.1;  // damping over swing rate, near the paper's
    constexpr double kLeastPart = 1e-3, kLeastTolerance = 1e-13;
    const double least_drag = model.translational_drag * std::min(1.0, 1.0 + model.angle_drag);
    const double damping = least_drag / model.mass / result.swing_rate;
    const double rtol = scenario.solver.rtol;
    result.tolerance = std::max(rtol * std::clamp(damping / kForgetting, kLeastPart, 1.0),
                                std::min(rtol, kLeastTolerance));
    result.stop = control ? &control->stop : nullptr;
    return result;
}

// A user's force may change with time while the body rests, and nothing is known of how fast: it is
// looked at as often as a phase's first step would.
template <class Integrator>
double HybridLoop<Integrator>::longest_look(const Model& model, const StepperOptions& options) {
    if (model.user_effects.empty()) return std::numeric_limits<double>::infinity();
    const double look = 0.25 / options.swing_rate;
    return options.max_step > 0.0 ? std::min(look, options.max_step) : look;
}

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
      integrator_(options(scenario, model_, program_, coils_, control)),
      recorder_(scenario.record.kind == RecordKind::uniform ? scenario.record.rate : 0.0,
                scenario.record.kind == RecordKind::events, sign_),
      control_(control),
      longest_look_(longest_look(model_, integrator_.options())),
      segments_(program_, hold_period_, {window_.start, window_.end}),
      burst_span_(50.0 * 2.0 * std::numbers::pi / integrator_.options().swing_rate) {
    result_.stiffness = stiffness(scenario, model_, integrator_.options().swing_rate);
    body_.z = model_.shape.half_rise(0);
    contact_x_ = model_.shape.half_base(0);
}

template <class Integrator>
RunResult HybridLoop<Integrator>::run() {
    try {
        while (next_phase()) {
            with_phase([&](auto phase) {
                end_phase(phase, integrator_.advance(phase, memory_, tau_, segment_.duration,
                                                     phase.begin(body_), observer(phase)));
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
    result_.recording = recorder_.take();
    chain_.apply(result_.summary, result_.recording);
    result_.final_state = body_;
    return std::move(result_);
}

template <class Integrator>
bool HybridLoop<Integrator>::next_phase() {
    while (result_.status == Status::ok) {
        if (tau_ >= segment_.duration) {
            if (!next_segment()) break;
        } else if (mode_.touch == Touch::face && mode_.slip == 0) {
            run_rest();
        } else {
            dynamics_.set_quadrant(body_.quadrant);
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
        result_.status = Status::too_many_steps;
        return false;
    }
    // Boundaries of stretches carry rounding; the window's ends are two of them.
    const double slack = 1e-9 * program_.duration();
    if (!measured_ && voltages.start >= window_.start - slack) {
        observer_.open(voltages.start, body_.x);
        measured_ = true;
    }
    if (observer_.is_open() && voltages.start >= window_.end - slack) {
        observer_.close(voltages.start, body_.x, sign_, result_.summary);
    }
    begin_segment(voltages);
    if (!begun_) {
        settle(Touch::face, 0.0, 0, 0.0);  // it may not be able to lie still
        if (recorder_.at_events()) record_events(0.0);
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
                 [&](double) { return snapshot_now(segment_.duration); });
    if (observer_.is_open()) {
        observer_.close(program_.duration(), body_.x, sign_, result_.summary);
    }
}

template <class Integrator>
void HybridLoop<Integrator>::with_phase(auto&& use) {
    if (mode_.touch == Touch::none) {
        use(FlightPhase(dynamics_));
    } else if (mode_.touch == Touch::face) {
        use(FaceSlidePhase(dynamics_, mode_.slip));
    } else if (mode_.slip == 0) {
        use(CornerStickPhase(dynamics_, contact_x_));
    } else {
        use(CornerSlipPhase(dynamics_, contact_x_, mode_.slip, slip_velocity_));
    }
}

// Samples of the uniform grid in (…, limit] s of absolute time; `snapshot_at(t)` in absolute time.
template <class Integrator>
void HybridLoop<Integrator>::sample_until(double limit, double from, auto&& snapshot_at) {
    const auto stopped = [&] { return control_ && control_->stop.load(std::memory_order_relaxed); };
    for (double t = recorder_.next_time(); t <= limit && !stopped(); t = recorder_.next_time()) {
        const double tau = std::max(t, from) - segment_.start;
        const Snapshot snapshot = snapshot_at(tau);
        recorder_.add(t, snapshot, mode_, dynamics_.field_at(tau)(snapshot.body.x, snapshot.body.z),
                      segment_.currents(tau));
    }
}

template <class Integrator>
void HybridLoop<Integrator>::run_rest() {
    const FaceRest rest(dynamics_, body_);
    const FaceRest::End end = rest.advance(memory_, tau_, segment_.duration, fastest_decay_,
                                           longest_look_, integrator_.options().stop);
    observer_.rest(body_.theta());
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
    observer_.phase(phase, end, end.tau - tau_, body_.quadrant);
    pass_to(end.tau);
    result_.status = end.status;
    body_ = phase.body(end.y);
    if constexpr (Phase::kSlips) {
        contact_x_ = phase.contact_x(end.y);
        slip_velocity_ = phase.slip_velocity(end.y);
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

#include "stickslip/hybrid_events.hpp"
