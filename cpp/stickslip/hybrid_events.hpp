#pragma once

/// What the hybrid loop does at an event: from the impact to the mode that the forces allow, and
/// the counting and recording of it. The second half of hybrid_loop.hpp.

#include "stickslip/hybrid_loop.hpp"

namespace stickslip {

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
        count(EventKind::rebound);
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
        phase.rebase(y);
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
    constexpr int kMostInBurst = 200000;
    const double now = absolute(tau);
    // After a long step has been cut by an event at its very start, its dense output may well not
    // show an acceleration that is zero to rounding: short steps do.
    stalls_ = now - last_event_ < 10.0 * kShortestStep ? stalls_ + 1 : 0;
    last_event_ = now;
    if (now - burst_start_ > burst_span_) {
        burst_start_ = now;
        burst_ = 0;
    }
    if (++burst_ > kMostInBurst) result_.status = Status::too_many_events;
}

}  // namespace stickslip
