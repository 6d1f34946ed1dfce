#include "stickslip/contact/contact_transitions.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/contact/turning_frame.hpp"

namespace stickslip {

// Makes a change, or none if it throws: then velocities are not left in another frame.
template <class How>
void ContactTransitions::change(double tau, How&& how) {
    changes_.clear();
    const HybridState before = state_;
    const auto counts = counts_;
    const double age = dynamics_.contact_age();
    try {
        enter_heading(tau);
        along_inner_ = along_inner();
        follow_with_inner();
        how();
        follow_with_inner();
        leave_heading();
    } catch (...) {
        state_ = before;
        counts_ = counts;
        dynamics_.set_contact_age(age);
        throw;
    }
}

void ContactTransitions::begin(bool touches_down) {
    change(0.0, [&] {
        if (touches_down) {
            touch_down(0, 0.0);
        } else {
            settle(state_.mode.touch, slip(), state_.mode.slip, 0.0);
        }
    });
}

void ContactTransitions::handle(Event event, double tau) {
    change(tau, [&] { react(event, tau); });
}

void ContactTransitions::enter_heading(double tau) {
    if (!plane_) return;
    BodyState& body = state_.body;
    plane_->field().rebase({body.x, body.y, body.z});
    heading_ = plane_->headed(plane_->field().at(tau), body.x, body.y, body.z).heading;
    const Slip velocity = heading_.seen(body.vx, body.vy);
    body.vx = velocity.along;
    body.vy = velocity.across;
    const Slip slip = heading_.seen(state_.slip_velocity, state_.slip_y);
    state_.slip_velocity = slip.along;
    state_.slip_y = slip.across;
    if (state_.mode.touch == Touch::face) {
        // A heading that has turned has moved the end of the face about its middle.
        state_.contact_x = body.x;
        state_.contact_y = body.y;
        const Face face = model().face(body.quadrant);
        move_contact(face.place());
    }
}

void ContactTransitions::leave_heading() {
    if (!plane_) return;
    BodyState& body = state_.body;
    const Slip velocity = {body.vx, body.vy}, slip = this->slip();
    body.vx = heading_.x(velocity);
    body.vy = heading_.y(velocity);
    body.heading = heading_.angle();
    state_.slip_velocity = heading_.x(slip);
    state_.slip_y = heading_.y(slip);
}

void ContactTransitions::react(Event event, double tau) {
    switch (event) {
        case Event::none:
        case Event::slip_quickens:
        case Event::heading:  // the contact does not know of it
            break;
        case Event::inner_ahead:
            meet_stop(1, tau);
            break;
        case Event::inner_behind:
            meet_stop(-1, tau);
            break;
        case Event::slip_slows:
            settle(state_.mode.touch, slip(), 0, tau);
            break;
        case Event::lift_off:
            settle(Touch::none, {}, 0, tau);
            break;
        case Event::breaks_loose:
        case Event::breaks_forward:
            settle(state_.mode.touch, {}, 1, tau);
            break;
        case Event::breaks_backward:
            settle(state_.mode.touch, {}, -1, tau);
            break;
        case Event::slip_stops:
            settle(state_.mode.touch, {}, 0, tau);
            // With a slip along a vector, the mode does not give its direction.
            if (plane_ && state_.mode.slip != 0) count(EventKind::reversal);
            break;
        case Event::ahead_lifts:
            pivot_on_rear_end();
            settle(Touch::corner, slip(), 0, tau);
            break;
        case Event::behind_lifts:
            settle(Touch::corner, slip(), 0, tau);
            break;
        case Event::behind_lands:
            if (state_.mode.touch == Touch::none)
                touch_down(-1, tau);
            else
                land(state_.body.quadrant, Arrival::behind, tau);
            break;
        case Event::ahead_lands:
            if (state_.mode.touch == Touch::none)
                touch_down(1, tau);
            else
                land(state_.body.quadrant + 1, Arrival::ahead, tau);
            break;
        case Event::pivot_touches:
            touch_down(0, tau);
            break;
        case Event::opposite_touches:
            touch_down(2, tau);
            break;
        case Event::sliding_jams:
            stop_slip_by_impulse(model(), pose(), state_.slip_velocity, state_.body);
            count(EventKind::painleve);
            settle(Touch::corner, {}, 0, tau);
            break;
    }
}

// A body on one corner has turned until a face lies on the surface.
void ContactTransitions::land(int quadrant, Arrival arrival, double tau) {
    BodyState& body = state_.body;
    const bool old_slips = state_.mode.slip != 0;
    BodyState before = body;
    before.quadrant = quadrant;
    before.angle = 0.0;
    if (quadrant != body.quadrant) move_contact(2.0 * model().shape.half_base(quadrant));
    const double front_x = state_.contact_x, front_y = state_.contact_y;
    const ImpactResult impact =
        face_impact(model(), before, arrival, old_slips, dynamics_.start() + tau);
    body = impact.body;
    state_.contact_x = front_x;
    state_.contact_y = front_y;
    if (body.quadrant != quadrant) move_contact(-2.0 * model().shape.half_base(quadrant));
    place_by_contact();
    const bool on_front = body.quadrant == quadrant;
    if (impact.touch == Touch::face) {
        count(EventKind::landing);
    } else if (impact.touch == Touch::corner && on_front == (arrival == Arrival::ahead)) {
        count(EventKind::roll_over);
    } else {
        count(EventKind::rebound);
    }
    settle(impact.touch, {impact.slip_velocity, impact.slip_across}, 0, tau);
}

// The corner `offset` quadrants on from the pivot meets the surface out of flight.
void ContactTransitions::touch_down(int offset, double tau) {
    // A gap below which the second corner of a face has arrived with the first, m.
    constexpr double kTogether = 1e-13;
    BodyState& body = state_.body;
    // The body may have turned on since the flight's quadrant was set: of the quadrants in which
    // this corner is the lowest, the one of the angle.
    const double quarters = body.theta() / kQuarterTurn;
    const int corner = body.quadrant + offset;
    body.angle = body.theta();
    body.quadrant = corner + 4 * static_cast<int>(std::lround((quarters - corner - 0.5) / 4.0));
    body.angle = std::clamp(body.angle - body.quadrant * kQuarterTurn, 0.0, kQuarterTurn);
    count(EventKind::touch_down);
    const double to_behind = 2.0 * model().shape.half_base(body.quadrant) * body.angle;
    const double to_ahead =
        2.0 * model().shape.half_rise(body.quadrant) * (kQuarterTurn - body.angle);
    ImpactResult impact;
    if (to_behind < kTogether || to_ahead < kTogether) {
        if (to_ahead < kTogether) body.quadrant += 1;
        body.angle = 0.0;
        impact = face_impact(model(), body, Arrival::both, false, dynamics_.start() + tau);
    } else {
        dynamics_.set_quadrant(body.quadrant);
        impact = corner_impact(model(), pose(), body, dynamics_.start() + tau, heading_.cosine);
    }
    body = impact.body;
    dynamics_.set_contact_age(-tau);
    dynamics_.set_quadrant(body.quadrant);
    const Pose there = pose();
    state_.contact_x = body.x;
    state_.contact_y = body.y;
    move_contact(there.place());
    place_by_contact();
    settle(impact.touch, {impact.slip_velocity, impact.slip_across}, 0, tau);
}

// Puts the centre of mass where the pivot corner on the surface has it.
void ContactTransitions::place_by_contact() {
    BodyState& body = state_.body;
    dynamics_.set_quadrant(body.quadrant);
    const Pose now = pose();
    body.x = state_.contact_x - now.place() * heading_.cosine;
    body.y = state_.contact_y - now.place() * heading_.sine;
    body.z = now.height;
}

// Takes the rear end of the face for the pivot.
void ContactTransitions::pivot_on_rear_end() {
    BodyState& body = state_.body;
    move_contact(-2.0 * model().shape.half_base(body.quadrant));
    body.quadrant -= 1;
    body.angle = kQuarterTurn;
}

// Finds the mode that the forces allow for what touches, and enters it.
void ContactTransitions::settle(Touch touch, const Slip& slip, int onset, double tau) {
    const ContactMode before = state_.mode;
    follow_with_inner();
    int& stop = state_.inner.stop;
    if (stop * state_.inner.velocity > 0.0) {
        strike_stop(stop, touch, slip.size() > 0.0, tau);
        return;
    }
    const auto resolve = [&] {
        return plane_
                   ? resolve_contact(TurningFrame(*plane_), tau, state_.body, touch, slip, onset)
                   : resolve_contact(FixedFrame(dynamics_), tau, state_.body, touch, slip, onset);
    };
    Resolution found = resolve();
    if (stop != 0 && touch != Touch::none && dynamics_.push() < 0.0) {
        stop = 0;
        dynamics_.set_inner(state_.inner);
        found = resolve();
    }
    if (found.quadrant != state_.body.quadrant) pivot_on_rear_end();
    // A slow slip that static friction holds; a jam has its impulse below.
    const bool sticks = !found.impulse && slip.size() > 0.0 && found.mode.touch == Touch::corner &&
                        found.mode.slip == 0;
    if (sticks) stop_slip_by_impulse(model(), pose(), slip.along, state_.body);
    state_.slip_velocity = found.slip.along;
    state_.slip_y = found.slip.across;
    state_.mode = found.mode;
    if (state_.rests()) {
        state_.body.vx = state_.body.vy = state_.body.vz = state_.body.omega = 0.0;
    }
    count_change(before);
    if (found.impulse) react(Event::sliding_jams, tau);
}

double ContactTransitions::along_inner() const {
    if (model().inner.absent()) return 0.0;
    const BodyState& body = state_.body;
    const auto [c, s] = cosine_and_sine(body.theta() + model().inner.direction);
    return body.vx * c - body.vz * s;
}

void ContactTransitions::follow_with_inner() {
    if (model().inner.absent()) return;
    const double now = along_inner();
    InnerState& inner = state_.inner;
    inner.velocity += along_inner_ - now;
    along_inner_ = now;
    if (inner.stop != 0) {
        if (std::abs(inner.velocity) <= kCaptureSpeed) inner.velocity = 0.0;
        if (inner.stop * inner.velocity < 0.0) inner.stop = 0;
    }
    dynamics_.set_inner(inner);
}

void ContactTransitions::meet_stop(int stop, double tau) {
    InnerState& inner = state_.inner;
    if (inner.stop == stop) {
        inner.stop = 0;
        return;
    }
    inner.place = model().inner.place(stop);
    strike_stop(stop, state_.mode.touch, state_.mode.slip != 0, tau);
}

void ContactTransitions::strike_stop(int stop, Touch touch, bool slips, double tau) {
    InnerState& inner = state_.inner;
    BodyState& body = state_.body;
    const auto [c, s] = cosine_and_sine(body.theta() + model().inner.direction);
    const double speed = stop * inner.velocity, rebound = model().inner.restitution * speed;
    Strike strike = {stop * c, -stop * s, speed,
                     rebound > kCaptureSpeed ? model().inner.restitution : 0.0};
    const int quadrant = body.quadrant;
    dynamics_.set_quadrant(quadrant);
    const ImpactResult impact =
        stop_impact(model(), pose(), body, touch, slips, strike, dynamics_.start() + tau);
    body = impact.body;
    if (body.quadrant != quadrant) move_contact(-2.0 * model().shape.half_base(quadrant));
    dynamics_.set_quadrant(body.quadrant);
    inner.velocity = -strike.restitution * inner.velocity;
    inner.stop = strike.restitution == 0.0 ? stop : 0;
    along_inner_ = along_inner();
    settle(impact.touch, {impact.slip_velocity, impact.slip_across}, 0, tau);
}

void ContactTransitions::count(EventKind kind) {
    ++counts_[static_cast<std::size_t>(kind)];
    changes_.push_back(kind);
}

void ContactTransitions::count_change(const ContactMode& before) {
    if (before.touch == Touch::face && state_.mode.touch == Touch::corner) count(EventKind::tip);
    if (before.touch != Touch::none && state_.mode.touch == Touch::none) {
        count(EventKind::lift_off);
    } else if (before.touch != Touch::none && before.slip != state_.mode.slip) {
        count(before.slip == 0        ? EventKind::slip_start
              : state_.mode.slip == 0 ? EventKind::stick
                                      : EventKind::reversal);
    }
}

}  // namespace stickslip
