#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "stickslip/body/model.hpp"
#include "stickslip/field/heading.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// The way of the horizontal field at a robot, and its size, T.
struct Facing {
    Heading heading;
    double horizontal = 0.0;
};

/// How a run ends whose heading is no longer known.
struct HeadingEnd {
    Status status = Status::ok;                            ///< or heading_lost, turns_too_fast
    double tau = std::numeric_limits<double>::infinity();  ///< s, in the stretch
    double rate = 0.0, limit = 0.0;  ///< rad/s, of a field that turns too fast
};

/// Whether the heading is known. In a strong horizontal field the robot faces its way; in a weak
/// one, which spin friction may keep it more than two degrees off, it keeps the heading that it
/// had. From one to the other is an event.
class HeadingWatch {
public:
    explicit HeadingWatch(const Model& model);

    /// What goes on from phase to phase.
    struct State {
        Heading heading;           ///< as the field was last seen strong, or as told
        bool is_weak = true;       ///< the field
        bool was_settled = false;  ///< ever strong and slow
        double turned = 0.0;       ///< rad, by which the heading has turned to and fro
    };
    const State& state() const { return state_; }
    void set_state(const State& state) { state_ = state; }

    double weak_field() const { return weak_field_; }  ///< T

    /// As a run begins. A robot that is held from its first instant has turned before.
    void begin(const Facing& now) {
        if (now.horizontal > weak_field_) state_ = {now.heading, false, true, state_.turned};
    }
    /// The event function: what is left, T, before a strong field becomes weak, or a weak one
    /// strong.
    double left(double horizontal) const {
        return state_.is_weak ? weak_field_ - horizontal : horizontal - weak_field_;
    }
    /// Where the event is. A field that comes back more than two degrees from where it was leaves
    /// the heading unknown.
    Status pass(const Facing& now);
    /// Follows a strong field over a part of a stretch, from where it was last seen; `facing(tau)`
    /// is had at any time of it. Says where it turns too fast, if it does.
    HeadingEnd follow(double from, double to, auto&& facing) {
        return state_.is_weak || !(to > from) ? HeadingEnd{} : see(from, to, facing(to), facing);
    }

    /// Of the angle by which the heading lags behind the field, in the linear motion of yaw that
    /// the field's stiffness gives, rad: the rate of turning over the yaw's own frequency. Chosen:
    /// beside the field by this angle the robot still has all but a fiftieth of it along.
    static constexpr double kMostTurning = 0.2;

private:
    HeadingEnd see(double from, double to, const Facing& now, auto&& facing);

    double weak_field_;  // T
    double yaw_;  // rad/s over the root of the horizontal field in T, the yaw's own frequency
    State state_;
};

HeadingEnd HeadingWatch::see(double from, double to, const Facing& now, auto&& facing) {
    // The angle within a step beyond which its halves are looked at, and the time below which they
    // are not: a field that goes through zero is then far below a weak one on the way.
    constexpr double kFar = 0.1, kShort = 1e-8;
    const double angle = std::abs(state_.heading.angle_to(now.heading)), time = to - from;
    if (angle > kFar && time > kShort) {
        const double middle = 0.5 * (from + to);
        const HeadingEnd end = see(from, middle, facing(middle), facing);
        return end.status == Status::ok ? see(middle, to, now, facing) : end;
    }
    const double limit = kMostTurning * yaw_ * std::sqrt(now.horizontal);
    const bool too_fast = angle > limit * time;
    state_.turned += angle;
    // The robot stands up while the coils' field first outgrows one that could not hold it, by
    // which the sum turns by less than half a turn.
    if (too_fast && (state_.was_settled || state_.turned > std::numbers::pi)) {
        return {Status::turns_too_fast, to, angle / time, limit};
    }
    state_.was_settled = state_.was_settled || !too_fast;
    state_.heading = now.heading;
    return {};
}

}  // namespace stickslip
