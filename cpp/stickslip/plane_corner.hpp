#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/plane_phase.hpp"

namespace stickslip {

/// A corner sticks: y = (angle, omega).
class PlaneCornerStick : public PlanePhase {
public:
    static constexpr int kDim = 2;
    static constexpr int kEvents = 4;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = false;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::lift_off, Event::breaks_loose,
                                                          Event::behind_lands, Event::ahead_lands};

    PlaneCornerStick(PlaneDynamics& plane, double contact_x, double contact_y)
        : PlanePhase(plane), contact_x_(contact_x), contact_y_(contact_y) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        dydt = {y[1], motion.alpha};
        g = {motion.normal, motion.limit * motion.normal - motion.friction.size(), y[0],
             kQuarterTurn - y[0]};
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
        double alpha, normal;
        Slip friction;  // N
        double limit;   // coefficient
    };
    Motion solve(const SpatialExpansion& field, const State& y) const {
        const Pose pose = upright().pose(y[0]);
        const HeadedField headed = plane_->headed_at_corner(field, contact_x_, contact_y_, pose);
        const PlaneLoad load = plane_->load(headed, field.tau, pose, {y[1] * pose.height, 0.0},
                                            y[1] * pose.lever, y[1], 0.0);
        const CornerStick stick = corner_stick(robot(), pose, y[1], load.along);
        const Slip friction = {stick.reaction.friction, -load.across};
        const double size = friction.size();
        // The contact would slip against its friction.
        const double way = size > 0.0 ? -friction.along / size : 1.0;
        return {headed.heading, stick.angular_acceleration, stick.reaction.normal, friction,
                upright().static_limit(way, contact_x_, pose, stick.reaction.normal, field.tau)};
    }

    double contact_x_, contact_y_;
};

/// What the two phases of a slipping corner share. A fast slip has coordinates in which nothing is
/// special about its way, a slow one those in which its end is smooth, and another integrator: each
/// ends where the other begins.
class PlaneCornerSlip : public PlanePhase {
public:
    static constexpr int kDim = 6;
    static constexpr bool kSlips = true;
    static constexpr bool kFlies = false;
    using State = std::array<double, kDim>;

    void rebase(const State& y) { rebase_to_corner(y[2], y[0], y[1]); }
    double angle(const State& y) const { return y[2]; }
    double omega(const State& y) const { return y[5]; }
    double contact_x(const State& y) const { return y[0]; }
    double contact_y(const State& y) const { return y[1]; }
    double place_along(const State& y) const { return along_front(y[0], y[1]); }

protected:
    PlaneCornerSlip(PlaneDynamics& plane, double contact_x, double contact_y, double slip_x,
                    double slip_y)
        : PlanePhase(plane),
          contact_x_(contact_x),
          contact_y_(contact_y),
          slip_x_(slip_x),
          slip_y_(slip_y) {}

    // As of CornerSlipPhase.
    static constexpr double kJammed = 1e-6, kNearlyJammed = 1e-2;

    struct Motion {
        Heading heading;
        Slip way;           // of the slip, of size one
        Slip friction;      // N
        Slip acceleration;  // m/s^2, of the contact
        CornerSlip upright;
    };
    /// y: with the contact, the angle and the rate in their places. way: of the slip, in the world.
    Motion solve(const SpatialExpansion& field, const State& y, const Heading& way,
                 double speed) const {
        const Pose pose = upright().pose(y[2]);
        const HeadedField headed = plane_->headed_at_corner(field, y[0], y[1], pose);
        Motion motion;
        motion.heading = headed.heading;
        motion.way = headed.heading.seen(way.cosine, way.sine);
        const PlaneLoad load =
            plane_->load(headed, field.tau, pose,
                         {speed * motion.way.along + y[5] * pose.height, speed * motion.way.across},
                         y[5] * pose.lever, y[5], 0.0);
        const double coefficient = upright().corner_kinetic(motion.way.along, speed, y[0], pose,
                                                            y[5], load.along, field.tau);
        motion.upright =
            corner_slip(robot(), pose, y[5], load.along, motion.way.along * coefficient);
        const double friction = -coefficient * motion.upright.normal;
        motion.friction = {motion.way.along * friction, motion.way.across * friction};
        motion.acceleration = {motion.upright.slip_acceleration,
                               (load.across + motion.friction.across) * robot().per_mass};
        return motion;
    }
    double jam(const Motion& motion) const {
        return motion.upright.effective_inertia - kJammed * robot().inertia;
    }
    BodyState body_at(double tau, const State& y, double slip_x, double slip_y) const {
        const Pose pose = upright().pose(y[2]);
        const HeadedField field = plane_->headed_at_corner(field_at(tau), y[0], y[1], pose);
        return on_corner(field.heading, pose, y[2], y[0], y[1], slip_x, slip_y, y[5]);
    }
    Snapshot snapshot_of(const BodyState& body, const Motion& motion, const State& y,
                         double speed) const {
        const double roll = upright().pose(y[2]).roll;
        return {body,
                {motion.upright.normal, motion.friction.along},
                y[0] + roll * motion.heading.cosine,
                speed * motion.way.along,
                y[1] + roll * motion.heading.sine,
                motion.friction.across,
                speed * motion.way.across};
    }

    double contact_x_, contact_y_, slip_x_, slip_y_;
};

/// A corner slips fast: y = (x and y of the contact, angle, slip velocity along x and y, omega).
class PlaneCornerFastSlip : public PlaneCornerSlip {
public:
    static constexpr int kEvents = 5;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::lift_off, Event::slip_slows,
                                                          Event::behind_lands, Event::ahead_lands,
                                                          Event::sliding_jams};

    PlaneCornerFastSlip(PlaneDynamics& plane, double contact_x, double contact_y, double slip_x,
                        double slip_y)
        : PlaneCornerSlip(plane, contact_x, contact_y, slip_x, slip_y) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const double speed = size(y);
        const Motion motion = solve(field, y, way(y, speed), speed);
        const Heading& h = motion.heading;
        dydt = {y[3],
                y[4],
                y[5],
                h.x(motion.acceleration),
                h.y(motion.acceleration),
                motion.upright.angular_acceleration};
        g = {motion.upright.normal, speed - plane_->slow_slip(), y[2], kQuarterTurn - y[2],
             jam(motion)};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 1) return size(y) - plane_->slow_slip();
        if (i == 2) return y[2];
        if (i == 3) return kQuarterTurn - y[2];
        return event_by_rates(*this, i, tau, y);
    }
    State begin(const BodyState& body) const {
        return {contact_x_, contact_y_, body.angle, slip_x_, slip_y_, body.omega};
    }
    BodyState body(double tau, const State& y) const { return body_at(tau, y, y[3], y[4]); }
    Snapshot snapshot(double tau, const State& y) const {
        const double speed = size(y);
        return snapshot_of(body(tau, y), solve(field_at(tau), y, way(y, speed), speed), y, speed);
    }
    State scale(const Scales& s) const {
        return {s.length, s.length, 1.0, s.velocity, s.velocity, s.rate};
    }
    double speed(const State& y) const { return size(y) + std::abs(y[5]) * robot().radius; }
    double longest_step(const State& y, const State& rates) const {
        const double speed = size(y);
        return slip_time(speed, (y[3] * rates[3] + y[4] * rates[4]) / speed, kMostOfExplicit);
    }
    double slip_velocity(const State& y) const { return y[3]; }
    double slip_y(const State& y) const { return y[4]; }
    double slip_along(const State& y) const { return along_front(y[3], y[4]); }
    double slip_acceleration(const State&, const State& rates) const {
        return along_front(rates[3], rates[4]);
    }
    bool nearly_jams(double tau, const State& y) const {
        const double speed = size(y);
        const Motion motion = solve(field_at(tau), y, way(y, speed), speed);
        return motion.upright.effective_inertia < kNearlyJammed * model().inertia;
    }

private:
    static double size(const auto& y) {
        const double x = y[3], z = y[4];
        return std::sqrt(x * x + z * z);
    }
    static Heading way(const State& y, double speed) {
        return speed > 0.0 ? Heading{y[3] / speed, y[4] / speed} : Heading{};
    }
};

/// A corner slips slowly: y = (x and y of the contact, angle, slip speed, its way from the x axis,
/// omega).
class PlaneCornerSlowSlip : public PlaneCornerSlip {
public:
    static constexpr bool kStiff = true;
    static constexpr int kEvents = 6;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {
        Event::lift_off,    Event::slip_stops,   Event::behind_lands,
        Event::ahead_lands, Event::sliding_jams, Event::slip_quickens};

    PlaneCornerSlowSlip(PlaneDynamics& plane, double contact_x, double contact_y, double slip_x,
                        double slip_y)
        : PlaneCornerSlip(plane, contact_x, contact_y, slip_x, slip_y) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Heading way = Heading::of_angle(y[4]);
        const Motion motion = solve(field, y, way, y[3]);
        const Slip& a = motion.acceleration;
        const Slip& w = motion.way;
        dydt = {y[3] * way.cosine,
                y[3] * way.sine,
                y[5],
                w.along * a.along + w.across * a.across,
                (w.along * a.across - w.across * a.along) / std::max(y[3], plane_->least_slip()),
                motion.upright.angular_acceleration};
        g = {motion.upright.normal, y[3],        y[2],
             kQuarterTurn - y[2],   jam(motion), plane_->quick_slip() - y[3]};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 1) return y[3];
        if (i == 2) return y[2];
        if (i == 3) return kQuarterTurn - y[2];
        if (i == 5) return plane_->quick_slip() - y[3];
        return event_by_rates(*this, i, tau, y);
    }
    State begin(const BodyState& body) const {
        return {contact_x_,
                contact_y_,
                body.angle,
                std::hypot(slip_x_, slip_y_),
                std::atan2(slip_y_, slip_x_),
                body.omega};
    }
    BodyState body(double tau, const State& y) const {
        return body_at(tau, y, slip_velocity(y), slip_y(y));
    }
    Snapshot snapshot(double tau, const State& y) const {
        const Motion motion = solve(field_at(tau), y, Heading::of_angle(y[4]), y[3]);
        return snapshot_of(body(tau, y), motion, y, y[3]);
    }
    State scale(const Scales& s, const State& y) const {
        return {s.length, s.length, 1.0, s.velocity, way_scale(s, y[3]), s.rate};
    }
    State nudge(const Scales& s) const {
        return {s.length, s.length, 1.0, s.velocity, 1.0, s.rate};
    }
    double speed(const State& y) const { return std::abs(y[3]) + std::abs(y[5]) * robot().radius; }
    double longest_step(const State& y, const State& rates) const {
        return slip_time(y[3], rates[3], kMostOfStiff);
    }
    double slip_velocity(const State& y) const { return y[3] * std::cos(y[4]); }
    double slip_y(const State& y) const { return y[3] * std::sin(y[4]); }
    double slip_along(const State& y) const { return along_front(slip_velocity(y), slip_y(y)); }
    double slip_acceleration(const State& y, const State& rates) const {
        const double cosine = std::cos(y[4]), sine = std::sin(y[4]), turning = y[3] * rates[4];
        return along_front(rates[3] * cosine - turning * sine, rates[3] * sine + turning * cosine);
    }
    bool nearly_jams(double tau, const State& y) const {
        const Motion motion = solve(field_at(tau), y, Heading::of_angle(y[4]), y[3]);
        return motion.upright.effective_inertia < kNearlyJammed * model().inertia;
    }
};

}  // namespace stickslip
