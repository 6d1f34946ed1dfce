#include "stickslip/contact/heading_watch.hpp"

#include <numbers>

namespace stickslip {
namespace {

// Spin friction of an edge of width w under the normal force N is mu N w / 4, Coulomb friction
// spread evenly.
constexpr double kSpinArm = 0.25;
// Largest angle (rad) between heading and field that counts as none: two degrees.
constexpr double kMostLag = 2.0 * std::numbers::pi / 180.0;

double weak_field(const Model& model) {
    const double load = model.pressing();
    const double spin = kSpinArm * model.width * model.friction.static_coefficient * load;
    return model.moment > 0.0 ? spin / (model.moment * std::sin(kMostLag)) : 0.0;
}

double yaw_inertia(const Model& model) {
    const double length = 2.0 * model.shape.half_base(0);
    return model.mass * (length * length + model.width * model.width) / 12.0;
}

}  // namespace

HeadingWatch::HeadingWatch(const Model& model)
    : weak_field_(stickslip::weak_field(model)),
      // A robot without moment does not turn.
      yaw_(model.moment > 0.0 ? std::sqrt(model.moment / yaw_inertia(model))
                              : std::numeric_limits<double>::infinity()) {}

Status HeadingWatch::pass(const Facing& now, double time) {
    state_.is_weak = !state_.is_weak;
    if (state_.is_weak) {
        state_.heading = now.heading;
        return Status::ok;
    }
    const bool is_off = std::abs(state_.heading.angle_to(now.heading)) > kMostLag;
    if (state_.was_settled && is_off) return Status::heading_lost;
    state_.heading = now.heading;
    state_.since = state_.next_look = time;
    state_.turned_then = state_.turned;
    return Status::ok;
}

HeadingEnd HeadingWatch::see(double start, double from, double to, const Facing& now,
                             FacingAt facing) {
    // The angle within a step beyond which its halves are looked at, and the time below which they
    // are not: a field that goes through zero is then far below a weak one on the way.
    constexpr double kFar = 0.1, kShort = 1e-8;
    const double angle = std::abs(state_.heading.angle_to(now.heading));
    if (angle > kFar && to - from > kShort) {
        const double middle = 0.5 * (from + to);
        const HeadingEnd end = see(start, from, middle, facing(middle), facing);
        return end.status == Status::ok ? see(start, middle, to, now, facing) : end;
    }
    state_.turned += angle;
    state_.heading = now.heading;
    return judge(start, to, now.horizontal);
}

// The rate over no less than the time that the robot itself takes to yaw: within that, a field that
// fades while it turns leaves the robot behind, and is another matter.
HeadingEnd HeadingWatch::judge(double start, double tau, double horizontal) {
    const double own = yaw_ * std::sqrt(horizontal), time = start + tau - state_.since;
    state_.next_look = start + tau + 1.0 / own;
    if (!(own * time >= 1.0)) return {};
    const double limit = kMostTurning * own, rate = (state_.turned - state_.turned_then) / time;
    // The robot stands up while the coils' field first outgrows one that could not hold it, by
    // which the sum turns by less than half a turn.
    if (rate > limit && (state_.was_settled || state_.turned > std::numbers::pi)) {
        return {Status::turns_too_fast, tau, rate, limit};
    }
    state_.was_settled = state_.was_settled || rate <= limit;
    state_.since = start + tau;
    state_.turned_then = state_.turned;
    return {};
}

}  // namespace stickslip
