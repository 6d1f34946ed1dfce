#pragma once

#include <cmath>
#include <limits>

#include "stickslip/body/model.hpp"
#include "stickslip/field/heading.hpp"
#include "stickslip/numbers/function_ref.hpp"
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
    double tau = std::numeric_limits<double>::infinity();  ///< s, in the segment
    double rate = 0.0, limit = 0.0;  ///< rad/s, of a field that turns too fast
};

/// Whether the heading is known. In a strong horizontal field the robot faces its way; in a weak
/// one, which spin friction may keep it more than two degrees off, it keeps the heading that it
/// had. From one to the other is an event.
class HeadingWatch {
public:
    using FacingAt = FunctionRef<Facing(double tau)>;

    explicit HeadingWatch(const Model& model);

    /// State carried from phase to phase.
    struct State {
        Heading heading;           ///< as the field was last seen strong, or as told
        bool is_weak = true;       ///< the field
        bool was_settled = false;  ///< ever strong and slow
        double turned = 0.0;       ///< rad, by which the heading has turned to and fro
        double since = 0.0;        ///< s, since when its rate of turning is measured
        double turned_then = 0.0;  ///< rad, `turned` at that time
        double next_look = 0.0;    ///< s, before which it has not turned by what counts
    };
    const State& state() const { return state_; }
    void set_state(const State& state) { state_ = state; }

    double weak_field() const { return weak_field_; }  ///< T

    /// Begins a run. A robot that is held from its first instant has turned before.
    void begin(const Facing& now) {
        if (now.horizontal > weak_field_)
            state_ = {.heading = now.heading, .is_weak = false, .was_settled = true};
    }
    /// The event function: what is left, T^2, before a strong field becomes weak, or a weak one
    /// strong. Of squares, as the size of a field that goes through zero has a corner there.
    double left(double horizontal) const {
        const double over = horizontal * horizontal - weak_field_ * weak_field_;
        return state_.is_weak ? -over : over;
    }
    /// Passes an event at `time` s. A field that comes back more than two degrees from where it was
    /// leaves the heading unknown.
    Status pass(const Facing& now, double time);
    /// Follows a strong field over a part of a segment that began at `start` s, from where it was
    /// last seen; `facing(tau)` is had at any time of it. Says where it turns too fast, if it does.
    HeadingEnd follow(double start, double from, double to, FacingAt facing) {
        if (state_.is_weak || !(to > from) || start + to < state_.next_look) return {};
        return see(start, from, to, facing(to), facing);
    }

    /// Limit of the angle by which the heading lags behind the field, rad: the rate of turning over
    /// the natural frequency of yaw, in linear motion under the field's stiffness. Chosen: at this
    /// angle to the field the robot still has all but a fiftieth of it along.
    static constexpr double kMostTurning = 0.2;

private:
    HeadingEnd see(double start, double from, double to, const Facing& now, FacingAt facing);
    HeadingEnd judge(double start, double tau, double horizontal);

    double weak_field_;  // T
    double yaw_;  // natural frequency of yaw over the root of the horizontal field, rad/s/T^0.5
    State state_;
};

}  // namespace stickslip
