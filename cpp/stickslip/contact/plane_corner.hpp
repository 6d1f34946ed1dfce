#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact/plane_phase.hpp"

namespace stickslip {

/// A corner sticks: y = (angle, omega).
class PlaneCornerStick : public PlanePhase {
public:
    static constexpr int kDim = 2;
    static constexpr int kEvents = 5;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = false;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::lift_off, Event::breaks_loose,
                                                          Event::behind_lands, Event::ahead_lands,
                                                          Event::heading};

    PlaneCornerStick(PlaneDynamics& plane, double contact_x, double contact_y)
        : PlanePhase(plane), contact_x_(contact_x), contact_y_(contact_y) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        dydt = {y[1], motion.alpha};
        g = {motion.normal, motion.limit * motion.normal - motion.friction.size(), y[0],
             kQuarterTurn - y[0], plane_->watch().left(motion.horizontal)};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 2) return y[0];
        if (i == 3) return kQuarterTurn - y[0];
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to_corner(y[0], contact_x_, contact_y_); }
    State begin(const BodyState& body) const { return {body.angle, body.omega}; }
    BodyState body(double tau, const State& y) const {
        const Pose pose = upright().pose(y[0]);
        const HeadedField field =
            plane_->headed_at_corner(field_at(tau), contact_x_, contact_y_, pose);
        return on_corner(field.heading, pose, y[0], contact_x_, contact_y_, 0.0, 0.0, y[1]);
    }
    Snapshot snapshot(double tau, const State& y) const {
        const Motion motion = solve(field_at(tau), y);
        const double roll = upright().pose(y[0]).roll;
        return {body(tau, y),
                {motion.normal, motion.friction.along},
                contact_x_ + roll * motion.heading.cosine,
                0.0,
                contact_y_ + roll * motion.heading.sine,
                motion.friction.across,
                0.0};
    }
    State scale(const Scales& s) const { return {1.0, s.rate}; }
    double speed(const State& y) const { return std::abs(y[1]) * robot().radius; }
    double angle(const State& y) const { return y[0]; }
    double omega(const State& y) const { return y[1]; }
    double place_along(const State&) const { return along_front(contact_x_, contact_y_); }

private:
    struct Motion {
        Heading heading;
        double horizontal;  // T
        double alpha, normal;
        Slip friction;  // N
        double limit;   // coefficient
    };
    Motion solve(const SpatialExpansion& field, const State& y) const {
        const Pose pose = upright().pose(y[0]);
        const HeadedField headed = plane_->headed_at_corner(field, contact_x_, contact_y_, pose);
        const PlaneLoad load = plane_->load(headed, field.tau, pose, {y[1] * pose.height, 0.0},
                                            y[1] * pose.lever, y[1]);
        const CornerStick stick = corner_stick(robot(), pose, y[1], load.along);
        const Slip friction = {stick.reaction.friction, -load.across};
        const double size = friction.size();
        // The contact would slip against its friction.
        const double way = size > 0.0 ? -friction.along / size : 1.0;
        return {headed.heading,
                headed.horizontal,
                stick.angular_acceleration,
                stick.reaction.normal,
                friction,
                upright().static_limit(way, contact_x_ + pose.roll * headed.heading.cosine, pose,
                                       stick.reaction.normal, field.tau)};
    }

    double contact_x_, contact_y_;
};

/// A corner slips along a vector: y = (x and y of the contact, angle, slip velocity along x and y,
/// omega). kSlow: friction keeps the way of the slip with which the phase begins, see is_slow.
template <bool kSlow>
class PlaneCornerSlip : public PlanePhase {
public:
    static constexpr int kDim = 6;
    static constexpr int kEvents = kSlow ? 7 : 6;
    static constexpr bool kSlips = true;
    static constexpr bool kFlies = false;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = [] {
        std::array<Event, kEvents> result = {Event::lift_off,     VectorSlip<kSlow>::kEnds,
                                             Event::behind_lands, Event::ahead_lands,
                                             Event::sliding_jams, Event::heading};
        if constexpr (kSlow) result[6] = Event::slip_quickens;
        return result;
    }();

    /// slip: m/s, along x and y.
    PlaneCornerSlip(PlaneDynamics& plane, double contact_x, double contact_y, const Slip& slip)
        : PlanePhase(plane), contact_x_(contact_x), contact_y_(contact_y), slip_(slip) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        const Heading& h = motion.heading;
        dydt = {y[3],
                y[4],
                y[5],
                h.x(motion.acceleration),
                h.y(motion.acceleration),
                motion.upright.angular_acceleration};
        g[0] = motion.upright.normal;
        g[1] = slip_.left(slip_of(y));
        g[2] = y[2];
        g[3] = kQuarterTurn - y[2];
        g[4] = motion.upright.effective_inertia - kJammed * robot().inertia;
        g[5] = plane_->watch().left(motion.horizontal);
        if constexpr (kSlow) g[6] = slip_.lacking(slip_of(y));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 1) return slip_.left(slip_of(y));
        if (i == 2) return y[2];
        if (i == 3) return kQuarterTurn - y[2];
        if (i == 6) return slip_.lacking(slip_of(y));
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to_corner(y[2], y[0], y[1]); }
    State begin(const BodyState& body) const {
        return {contact_x_,          contact_y_,           body.angle,
                slip_.begin().along, slip_.begin().across, body.omega};
    }
    BodyState body(double tau, const State& y) const {
        const Pose pose = upright().pose(y[2]);
        const HeadedField field = plane_->headed_at_corner(field_at(tau), y[0], y[1], pose);
        return on_corner(field.heading, pose, y[2], y[0], y[1], y[3], y[4], y[5]);
    }
    Snapshot snapshot(double tau, const State& y) const {
        const Motion motion = solve(field_at(tau), y);
        const double roll = upright().pose(y[2]).roll;
        return {body(tau, y),
                {motion.upright.normal, motion.friction.along},
                y[0] + roll * motion.heading.cosine,
                motion.slip.along,
                y[1] + roll * motion.heading.sine,
                motion.friction.across,
                motion.slip.across};
    }
    State scale(const Scales& s) const {
        return {s.length, s.length, 1.0, s.velocity, s.velocity, s.rate};
    }
    double speed(const State& y) const {
        return slip_of(y).size() + std::abs(y[5]) * robot().radius;
    }
    double longest_step(const State& y, const State& rates) const {
        return slip_.longest_step(slip_of(y), {rates[3], rates[4]});
    }
    double angle(const State& y) const { return y[2]; }
    double omega(const State& y) const { return y[5]; }
    double contact_x(const State& y) const { return y[0]; }
    double contact_y(const State& y) const { return y[1]; }
    double place_along(const State& y) const { return along_front(y[0], y[1]); }
    double slip_velocity(const State& y) const { return y[3]; }
    double slip_y(const State& y) const { return y[4]; }
    double slip_along(const State& y) const { return along_front(y[3], y[4]); }
    bool nearly_jams(double tau, const State& y) const {
        return solve(field_at(tau), y).upright.effective_inertia < kNearlyJammed * model().inertia;
    }

private:
    // As of CornerSlipPhase.
    static constexpr double kJammed = 1e-6, kNearlyJammed = 1e-2;

    // Along the heading and across.
    struct Motion {
        Heading heading;
        double horizontal;  // T
        Slip slip;          // m/s
        Slip friction;      // N
        Slip acceleration;  // m/s^2, of the contact
        CornerSlip upright;
    };
    Motion solve(const SpatialExpansion& field, const State& y) const {
        const Pose pose = upright().pose(y[2]);
        const HeadedField headed = plane_->headed_at_corner(field, y[0], y[1], pose);
        const Heading front = slip_.way(slip_of(y));
        const Slip way = headed.heading.seen(front.cosine, front.sine);
        Motion motion;
        motion.heading = headed.heading;
        motion.horizontal = headed.horizontal;
        motion.slip = headed.heading.seen(y[3], y[4]);
        const PlaneLoad load = plane_->load(
            headed, field.tau, pose, {motion.slip.along + y[5] * pose.height, motion.slip.across},
            y[5] * pose.lever, y[5]);
        const double touch_x = y[0] + pose.roll * headed.heading.cosine;
        const double coefficient = upright().corner_kinetic(way.along, motion.slip.size(), touch_x,
                                                            pose, y[5], load.along, field.tau);
        motion.upright = corner_slip(robot(), pose, y[5], load.along, way.along * coefficient);
        const double friction = -coefficient * motion.upright.normal;
        motion.friction = {way.along * friction, way.across * friction};
        motion.acceleration = {motion.upright.slip_acceleration,
                               (load.across + motion.friction.across) * robot().per_mass};
        return motion;
    }
    static Slip slip_of(const auto& y) { return {y[3], y[4]}; }

    double contact_x_, contact_y_;
    VectorSlip<kSlow> slip_;
};

}  // namespace stickslip
