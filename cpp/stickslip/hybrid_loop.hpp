#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stickslip/impact.hpp"
#include "stickslip/measurement_chain.hpp"
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

private:
    // One stretch of voltage.
    void begin_segment(const VoltageSegment& voltages);
    void run_segment();
    double run_rest(double tau, double duration);
    template <class Phase>
    double run_phase(Phase phase, double tau, double duration);
    double run_mode(double tau, double duration);

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
    void record_last();
    void watch_progress(double tau);

    void sample_until(double limit, double from, auto&& snapshot_at);
    void place_by_contact();
    double absolute(double tau) const { return segment_.start + tau; }
    Pose pose() { return dynamics_.rebase_angle(body_.angle); }

    static StepperOptions options(const Scenario& scenario, const Model& model,
                                  const VoltageProgram& program, const CoilSet& coils,
                                  RunControl* control);
    static LocalField local_field(const Scenario& scenario, const VoltageProgram& program,
                                  const CoilSet& coils);

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

    CurrentSegment segment_;
    double fastest_decay_ = 0.0;
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
    double burst_span_;          // s, of one free swing
    int stalls_ = 0;
    int burst_ = 0;
};

template <class Integrator>
LocalField HybridLoop<Integrator>::local_field(const Scenario& scenario,
                                               const VoltageProgram& program,
                                               const CoilSet& coils) {
    PerCoil gain = field_gain(scenario);
    // Coupled coils all have current.
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const bool driven = program.largest_voltage()[k] > 0.0 ||
                            scenario.effects.mutual_inductance_coupling != 0.0;
        if (!driven) gain[k] = 0.0;
    }
    return LocalField(coils, gain, frame_sign(scenario) * scenario.effects.ambient_field_bx,
                      scenario.effects.ambient_field_bz);
}

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
    result.tolerance = scenario.solver.rtol;
    result.max_step = scenario.solver.max_step;
    const double swing = std::sqrt(torque / model.corner_inertia());
    result.swing_rate = swing > 0.0 ? swing : 1.0;
    result.scales = {radius, radius * result.swing_rate, result.swing_rate};
    result.stop = control ? &control->stop : nullptr;
    return result;
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
      dynamics_(model_, local_field(scenario, program_, coils_)),
      integrator_(options(scenario, model_, program_, coils_, control)),
      recorder_(scenario.record.kind == RecordKind::uniform ? scenario.record.rate : 0.0,
                scenario.record.kind == RecordKind::events, sign_),
      control_(control),
      burst_span_(2.0 * std::numbers::pi / integrator_.options().swing_rate) {
    body_.z = model_.shape.half_rise(0);
    contact_x_ = model_.shape.half_base(0);
}

template <class Integrator>
RunResult HybridLoop<Integrator>::run() {
    SegmentStream cursor(program_, hold_period_, {window_.start, window_.end});
    VoltageSegment voltages;
    bool settled = false;
    // Boundaries of stretches carry rounding; the window's ends are two of them.
    const double slack = 1e-9 * program_.duration();
    bool begun = false;
    while (result_.status == Status::ok && cursor.next(voltages)) {
        if (!settled && voltages.start >= window_.start - slack) {
            observer_.open(voltages.start, body_.x);
            settled = true;
        }
        if (observer_.is_open() && voltages.start >= window_.end - slack) {
            observer_.close(voltages.start, body_.x, sign_, result_.summary);
        }
        begin_segment(voltages);
        if (!begun) {
            settle(Touch::face, 0.0, 0, 0.0);  // it may not be able to lie still
            if (recorder_.at_events()) record_events(0.0);
            begun = true;
        }
        run_segment();
        // The integrators look too; a body at rest needs none.
        if (control_ && control_->stop.load(std::memory_order_relaxed)) {
            result_.status = Status::interrupted;
        }
    }
    if (result_.status == Status::ok) record_last();
    if (observer_.is_open() && result_.status == Status::ok) {
        observer_.close(program_.duration(), body_.x, sign_, result_.summary);
    }
    result_.steps = integrator_.counts();
    result_.recording = recorder_.take();
    chain_.apply(result_.summary, result_.recording);
    result_.final_state = body_;
    return std::move(result_);
}

template <class Integrator>
void HybridLoop<Integrator>::begin_segment(const VoltageSegment& voltages) {
    dynamics_.set_contact_age(dynamics_.contact_age() + segment_.duration);
    segment_ = circuit_.advance(voltages);
    dynamics_.field().set_segment(segment_);
    fastest_decay_ = *std::max_element(segment_.rate.begin(), segment_.rate.end());
}

template <class Integrator>
void HybridLoop<Integrator>::run_segment() {
    double tau = 0.0;
    while (result_.status == Status::ok && tau < segment_.duration) {
        const double before = tau;
        tau = run_mode(tau, segment_.duration);
        result_.summary.simulated_time = absolute(tau);
        if (control_) {
            control_->simulated_time.fetch_add(tau - before, std::memory_order_relaxed);
        }
    }
}

// The grid's last sample may lie beyond the end by rounding.
template <class Integrator>
void HybridLoop<Integrator>::record_last() {
    sample_until(program_.duration() * (1.0 + 1e-12), absolute(0.0),
                 [&](double) { return snapshot_now(segment_.duration); });
}

template <class Integrator>
double HybridLoop<Integrator>::run_mode(double tau, double duration) {
    dynamics_.set_quadrant(body_.quadrant);
    switch (mode_.touch) {
        case Touch::none:
            return run_phase(FlightPhase(dynamics_), tau, duration);
        case Touch::corner:
            if (mode_.slip == 0) {
                return run_phase(CornerStickPhase(dynamics_, contact_x_), tau, duration);
            }
            return run_phase(CornerSlipPhase(dynamics_, contact_x_, mode_.slip, slip_velocity_),
                             tau, duration);
        case Touch::face:
            if (mode_.slip == 0) return run_rest(tau, duration);
            return run_phase(FaceSlidePhase(dynamics_, mode_.slip), tau, duration);
    }
    return duration;
}

// Samples of the uniform grid in (…, limit] s of absolute time; `snapshot_at(t)` in absolute time.
template <class Integrator>
void HybridLoop<Integrator>::sample_until(double limit, double from, auto&& snapshot_at) {
    for (double t = recorder_.next_time(); t <= limit; t = recorder_.next_time()) {
        const double tau = std::max(t, from) - segment_.start;
        const Snapshot snapshot = snapshot_at(tau);
        recorder_.add(t, snapshot, mode_, dynamics_.field_at(tau)(snapshot.body.x, snapshot.body.z),
                      segment_.currents(tau));
    }
}

template <class Integrator>
double HybridLoop<Integrator>::run_rest(double tau, double duration) {
    const FaceRest rest(dynamics_, body_);
    const FaceRest::End end = rest.advance(memory_, tau, duration, fastest_decay_);
    observer_.rest(body_.theta());
    sample_until(absolute(end.tau), absolute(tau), [&](double at) { return rest.snapshot(at); });
    if (end.event != Event::none) handle(end.event, end.tau);
    return end.tau;
}

template <class Integrator>
template <class Phase>
double HybridLoop<Integrator>::run_phase(Phase phase, double tau, double duration) {
    const auto observe = [&](const auto& step, double s) {
        observer_.step(phase, step, s, body_.quadrant);
        const double limit = absolute(step.start + s * step.width);
        if (recorder_.next_time() > limit) return;
        sample_until(limit, absolute(step.start), [&](double at) {
            return phase.snapshot(at, step.dense((at - step.start) / step.width));
        });
    };
    const PhaseEnd<Phase> end =
        integrator_.advance(phase, memory_, tau, duration, phase.begin(body_), observe);
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
            return end.tau;
        }
    }
    if (end.status == Status::ok && end.event != Event::none) handle(end.event, end.tau);
    return end.tau;
}

template <class Integrator>
void HybridLoop<Integrator>::handle(Event event, double tau) {
    watch_progress(tau);
    react(event, tau);
    if (recorder_.at_events()) record_events(tau);
    if (!std::isfinite(body_.x + body_.z + body_.angle + body_.vx + body_.vz + body_.omega)) {
        result_.status = Status::not_finite;
    }
}

template <class Integrator>
void HybridLoop<Integrator>::react(Event event, double tau) {
    switch (event) {
        case Event::none:
            break;
        case Event::lift_off:
            settle(Touch::none, 0.0, 0, tau);
            break;
        case Event::breaks_forward:
            settle(mode_.touch, 0.0, 1, tau);
            break;
        case Event::breaks_backward:
            settle(mode_.touch, 0.0, -1, tau);
            break;
        case Event::slip_stops:
            settle(mode_.touch, 0.0, 0, tau);
            break;
        case Event::ahead_lifts:
            pivot_on_rear_end();
            settle(Touch::corner, slip_velocity_, 0, tau);
            break;
        case Event::behind_lifts:
            settle(Touch::corner, slip_velocity_, 0, tau);
            break;
        case Event::behind_lands:
            if (mode_.touch == Touch::none)
                touch_down(-1, tau);
            else
                land(body_.quadrant, Arrival::behind, tau);
            break;
        case Event::ahead_lands:
            if (mode_.touch == Touch::none)
                touch_down(1, tau);
            else
                land(body_.quadrant + 1, Arrival::ahead, tau);
            break;
        case Event::pivot_touches:
            touch_down(0, tau);
            break;
        case Event::opposite_touches:
            touch_down(2, tau);
            break;
        case Event::sliding_jams:
            stop_slip_by_impulse(model_, pose(), slip_velocity_, body_);
            count(EventKind::painleve);
            settle(Touch::corner, 0.0, 0, tau);
            break;
    }
}

// A body on one corner has turned until a face lies on the surface.
template <class Integrator>
void HybridLoop<Integrator>::land(int quadrant, Arrival arrival, double tau) {
    const bool old_slips = mode_.slip != 0;
    BodyState before = body_;
    before.quadrant = quadrant;
    before.angle = 0.0;
    if (quadrant != body_.quadrant) contact_x_ += 2.0 * model_.shape.half_base(quadrant);
    const double front = contact_x_;
    const ImpactResult impact = face_impact(model_, before, arrival, old_slips);
    body_ = impact.body;
    if (body_.quadrant != quadrant) contact_x_ = front - 2.0 * model_.shape.half_base(quadrant);
    place_by_contact();
    const bool on_front = body_.quadrant == quadrant;
    if (impact.touch == Touch::face) {
        count(EventKind::landing);
    } else if (impact.touch == Touch::corner && on_front == (arrival == Arrival::ahead)) {
        count(EventKind::roll_over);
    } else {
        count(EventKind::touch_down);
    }
    settle(impact.touch, impact.slip_velocity, 0, tau);
}

// The corner `offset` quadrants on from the pivot meets the surface out of flight.
template <class Integrator>
void HybridLoop<Integrator>::touch_down(int offset, double tau) {
    // A gap below which the second corner of a face has arrived with the first, m.
    constexpr double kTogether = 1e-13;
    // The body may have turned on since the flight's quadrant was set: of the quadrants in which
    // this corner is the lowest, the one of the angle.
    const double quarters = body_.theta() / kQuarterTurn;
    const int corner = body_.quadrant + offset;
    body_.angle = body_.theta();
    body_.quadrant = corner + 4 * static_cast<int>(std::lround((quarters - corner - 0.5) / 4.0));
    body_.angle = std::clamp(body_.angle - body_.quadrant * kQuarterTurn, 0.0, kQuarterTurn);
    count(EventKind::touch_down);
    const double to_behind = 2.0 * model_.shape.half_base(body_.quadrant) * body_.angle;
    const double to_ahead =
        2.0 * model_.shape.half_rise(body_.quadrant) * (kQuarterTurn - body_.angle);
    ImpactResult impact;
    if (to_behind < kTogether || to_ahead < kTogether) {
        if (to_ahead < kTogether) body_.quadrant += 1;
        body_.angle = 0.0;
        impact = face_impact(model_, body_, Arrival::both, false);
    } else {
        dynamics_.set_quadrant(body_.quadrant);
        impact = corner_impact(model_, pose(), body_);
    }
    body_ = impact.body;
    dynamics_.set_contact_age(-tau);
    dynamics_.set_quadrant(body_.quadrant);
    contact_x_ = body_.x + pose().lever;
    place_by_contact();
    settle(impact.touch, impact.slip_velocity, 0, tau);
}

// Puts the centre of mass where the pivot corner on the surface has it.
template <class Integrator>
void HybridLoop<Integrator>::place_by_contact() {
    dynamics_.set_quadrant(body_.quadrant);
    const Pose now = pose();
    body_.x = contact_x_ - now.lever;
    body_.z = now.height;
}

// Takes the rear end of the face for the pivot.
template <class Integrator>
void HybridLoop<Integrator>::pivot_on_rear_end() {
    contact_x_ -= 2.0 * model_.shape.half_base(body_.quadrant);
    body_.quadrant -= 1;
    body_.angle = kQuarterTurn;
}

// Finds the mode that the forces allow for what touches, and enters it.
template <class Integrator>
void HybridLoop<Integrator>::settle(Touch touch, double slip_velocity, int onset, double tau) {
    const ContactMode before = mode_;
    const Resolution found = resolve_contact(dynamics_, tau, body_, touch, slip_velocity, onset);
    if (found.quadrant != body_.quadrant) pivot_on_rear_end();
    slip_velocity_ = slip_velocity;
    mode_ = found.mode;
    if (mode_.touch == Touch::face && mode_.slip == 0) body_.vx = body_.vz = body_.omega = 0.0;
    memory_ = {};
    memory_.stalled = stalls_ > kMostStalls;
    count_change(before);
    if (found.impulse) react(Event::sliding_jams, tau);
}

template <class Integrator>
void HybridLoop<Integrator>::count(EventKind kind) {
    ++result_.summary.events[static_cast<std::size_t>(kind)];
    if (recorder_.at_events()) pending_.push_back(kind);
}

template <class Integrator>
void HybridLoop<Integrator>::count_change(const ContactMode& before) {
    if (before.touch == Touch::face && mode_.touch == Touch::corner) count(EventKind::tip);
    if (before.touch != Touch::none && mode_.touch == Touch::none) {
        count(EventKind::lift_off);
    } else if (before.touch != Touch::none && before.slip != mode_.slip) {
        count(before.slip == 0  ? EventKind::slip_start
              : mode_.slip == 0 ? EventKind::stick
                                : EventKind::reversal);
    }
}

// On a copy of the dynamics: looking must not move the bases of the steps to come.
template <class Integrator>
Snapshot HybridLoop<Integrator>::snapshot_now(double tau) const {
    Dynamics dynamics = dynamics_;
    dynamics.set_quadrant(body_.quadrant);
    const auto of = [&](auto phase) {
        const auto y = phase.begin(body_);
        phase.rebase(tau, y);
        return phase.snapshot(tau, y);
    };
    if (mode_.touch == Touch::none) return of(FlightPhase(dynamics));
    if (mode_.touch == Touch::face) {
        if (mode_.slip != 0) return of(FaceSlidePhase(dynamics, mode_.slip));
        return FaceRest(dynamics, body_).snapshot(tau);
    }
    if (mode_.slip != 0) {
        return of(CornerSlipPhase(dynamics, contact_x_, mode_.slip, slip_velocity_));
    }
    return of(CornerStickPhase(dynamics, contact_x_));
}

// One sample for each change at this instant, with the state after all of them.
template <class Integrator>
void HybridLoop<Integrator>::record_events(double tau) {
    for (const EventKind kind : pending_) {
        const Snapshot snapshot = snapshot_now(tau);
        recorder_.add(absolute(tau), snapshot, mode_,
                      dynamics_.field_at(tau)(snapshot.body.x, snapshot.body.z),
                      segment_.currents(tau));
        recorder_.add_event(kind);
    }
    pending_.clear();
}

// Counts events without progress, and refuses to go on where events pile up: a fault of the model
// or of this program that would else be a hang. The limit is far above what ends by itself, such as
// the bounces of a restitution of 0.999.
template <class Integrator>
void HybridLoop<Integrator>::watch_progress(double tau) {
    constexpr int kMostInBurst = 20000;
    const double now = absolute(tau);
    stalls_ = now == last_event_ ? stalls_ + 1 : 0;
    last_event_ = now;
    if (now - burst_start_ > burst_span_) {
        burst_start_ = now;
        burst_ = 0;
    }
    if (++burst_ > kMostInBurst) result_.status = Status::too_many_events;
}

}  // namespace stickslip
