#include "stickslip/contact/heading_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stickslip {
namespace {

// Spin friction of an edge of width w under the normal force N is mu N w / 4, Coulomb friction
// spread evenly.
constexpr double kSpinArm = 0.25;
// Largest angle (rad) between heading and field that counts as none: two degrees.
constexpr double kMostLag = 2.0 * std::numbers::pi / 180.0;
// Within which the times are found at which a field becomes weak and comes back, s.
constexpr double kInstant = 1e-9;

double usual_load(const Model& model) {
    return -model.mass * model.gravity_z + model.adhesion.strength;
}

double weak_field(const Model& model) {
    const double load = usual_load(model);
    const double spin = kSpinArm * model.width * model.friction.static_coefficient * load;
    return model.moment > 0.0 ? spin / (model.moment * std::sin(kMostLag)) : 0.0;
}

double yaw_inertia(const Model& model) {
    const double length = 2.0 * model.shape.half_base(0);
    return model.mass * (length * length + model.width * model.width) / 12.0;
}

double size(const HorizontalField::Vector& b) {
    return std::sqrt(b[0] * b[0] + b[1] * b[1]);
}

// Time between two looks at a field whose fastest exponential has this rate (1/s). It dies out from
// the start of the stretch, so that the time grows with `tau`.
double time_to_look(double tau, double fastest) {
    constexpr double kPart = 0.5;
    return std::max(kPart / fastest, kPart * tau);
}

}  // namespace

HeadingWatch::HeadingWatch(const Model& model)
    : weak_field_(stickslip::weak_field(model)),
      // A robot without moment does not turn.
      yaw_(model.moment > 0.0 ? std::sqrt(model.moment / yaw_inertia(model))
                              : std::numeric_limits<double>::infinity()) {}

void HeadingWatch::watch(const HorizontalField& field) {
    if (track_.state.lost) return;
    field_ = field;
    from_ = 0.0;
    end_ = {};
    track_.tau = 0.0;
    track_.holds = 1;
    track_.hold[0] = {0.0, track_.state.heading};
    begun_ = track_;
    look_over(0.0, field.segment->duration);
}

void HeadingWatch::move(double tau, const HorizontalField& field) {
    cut(tau);
    field_ = field;
    from_ = tau;
    begun_ = track_;
    look_over(tau, field.segment->duration);
}

void HeadingWatch::cut(double tau) {
    track_ = begun_;
    end_ = {};
    look_over(from_, tau);
}

void HeadingWatch::look_over(double from, double to) {
    const auto& rate = field_.segment->rate;
    const double fastest =
        *std::max_element(rate.begin(), rate.begin() + field_.segment->exponentials);
    // What the robot has moved since the last stretch turns the heading at once.
    look(from);
    for (double tau = from; tau < to && end_.status == Status::ok;) {
        const double next = tau + time_to_look(tau, fastest);
        tau = next < to ? next : to;
        look(tau);
    }
}

void HeadingWatch::look(double tau) {
    if (end_.status != Status::ok) return;
    State& state = track_.state;
    const HorizontalField::Vector b = field_.at(tau);
    const double horizontal = size(b);
    if (!(horizontal > weak_field_)) {
        if (!state.was_weak) fade(tau);
        state.was_weak = true;
        track_.tau = tau;
    } else if (!state.was_weak || come_back(tau)) {
        look_strong(tau, b, horizontal);
    }
}

void HeadingWatch::look_strong(double tau, const HorizontalField::Vector& b, double horizontal) {
    // Angle between two looks between which another one is worth it, and the time below which it
    // is not: a field that goes through zero is then far below a weak one on the way.
    constexpr double kFar = 0.1, kShort = 1e-8, kSmall = 1e-3;
    State& state = track_.state;
    const Heading now = {b[0] / horizontal, b[1] / horizontal};
    const Slip turn = state.heading.seen(now.cosine, now.sine);
    const bool is_small = turn.along > 0.0 && std::abs(turn.across) < kSmall;
    const double angle = std::abs(is_small ? turn.across : std::atan2(turn.across, turn.along));
    const double time = tau - track_.tau;
    if (angle > kFar && time > kShort) {
        look(track_.tau + 0.5 * time);
        look(tau);
        return;
    }
    const double limit = kMostTurning * yaw_ * std::sqrt(horizontal);
    const bool too_fast = time > 0.0 && angle > limit * time;
    state.turned += angle;
    // The robot stands up while the coils' field first outgrows one that could not hold it, by
    // which the sum turns by less than half a turn.
    if (too_fast && (state.was_settled || state.turned > std::numbers::pi)) {
        end({Status::turns_too_fast, tau, angle / time, limit});
        return;
    }
    if (time > 0.0 && !too_fast) state.was_settled = true;
    state.heading = now;
    track_.tau = tau;
}

// The field becomes weak between the last look and `tau`.
void HeadingWatch::fade(double tau) {
    double strong = track_.tau, weak = tau;
    while (weak - strong > kInstant) {
        const double middle = 0.5 * (strong + weak);
        (size_at(middle) > weak_field_ ? strong : weak) = middle;
    }
    if (strong > track_.tau) look(strong);
    if (track_.holds < kMostHolds) ++track_.holds;
    track_.hold[track_.holds - 1] = {strong, track_.state.heading};
}

// It was weak at the last look and is not at `tau`: whether the heading is known on.
bool HeadingWatch::come_back(double tau) {
    double weak = track_.tau, strong = tau;
    const bool at_once = weak == strong;
    while (strong - weak > kInstant) {
        const double middle = 0.5 * (strong + weak);
        (size_at(middle) > weak_field_ ? strong : weak) = middle;
    }
    State& state = track_.state;
    const HorizontalField::Vector b = field_.at(strong);
    const double horizontal = size(b);
    const Heading now = {b[0] / horizontal, b[1] / horizontal};
    const Slip turn = state.heading.seen(now.cosine, now.sine);
    if (state.was_settled && std::abs(std::atan2(turn.across, turn.along)) > kMostLag) {
        // At the last instant at which the field does not say another one.
        end({Status::heading_lost, weak});
        return false;
    }
    state.heading = now;
    state.was_weak = false;
    state.was_settled = state.was_settled || at_once;
    track_.tau = strong;
    return true;
}

double HeadingWatch::size_at(double tau) const {
    return size(field_.at(tau));
}

}  // namespace stickslip
