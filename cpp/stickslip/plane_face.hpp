#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/plane_phase.hpp"

namespace stickslip {

/// A face slides: y = (x and y of the centre of mass, slip speed, its way from the x axis).
class PlaneFaceSlide : public PlanePhase {
public:
    static constexpr int kDim = 4;
    static constexpr int kEvents = 3;
    static constexpr bool kSlips = true;
    static constexpr bool kStiff = true;
    static constexpr bool kFlies = false;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::ahead_lifts, Event::behind_lifts,
                                                          Event::slip_stops};

    PlaneFaceSlide(PlaneDynamics& plane, double slip_x, double slip_y)
        : PlanePhase(plane), slip_x_(slip_x), slip_y_(slip_y) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        dydt = {y[2] * motion.way.cosine, y[2] * motion.way.sine, motion.acceleration.along,
                motion.acceleration.across / std::max(y[2], plane_->least_slip())};
        g = {motion.reaction.ahead, motion.reaction.behind, y[2]};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 2) return y[2];
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to_face(y[0], y[1]); }
    State begin(const BodyState& body) const {
        return {body.x, body.y, std::hypot(slip_x_, slip_y_), std::atan2(slip_y_, slip_x_)};
    }
    BodyState body(double tau, const State& y) const {
        const Heading h = plane_->headed(field_at(tau), y[0], y[1], height()).heading;
        return {y[0], height(),   0.0,  slip_velocity(y), 0.0,
                0.0,  quadrant(), y[1], slip_y(y),        h.angle()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        const Motion motion = solve(field_at(tau), y);
        const Face face = model().face(quadrant());
        const double base = face.half_base + face.shift;
        return {body(tau, y),
                {motion.reaction.normal(), motion.friction.along},
                y[0] + base * motion.heading.cosine,
                motion.slip.along,
                y[1] + base * motion.heading.sine,
                motion.friction.across,
                motion.slip.across};
    }
    State scale(const Scales& s, const State& y) const {
        return {s.length, s.length, s.velocity, way_scale(s, y[2])};
    }
    State nudge(const Scales& s) const { return {s.length, s.length, s.velocity, 1.0}; }
    double speed(const State& y) const { return std::abs(y[2]); }
    double longest_step(const State& y, const State& rates) const {
        return slip_time(y[2], rates[2], kMostOfStiff);
    }
    double angle(const State&) const { return 0.0; }
    double omega(const State&) const { return 0.0; }
    /// Of the middle of the face, not of its end, which a heading that turns moves.
    double contact_x(const State& y) const { return y[0]; }
    double contact_y(const State& y) const { return y[1]; }
    double place_along(const State& y) const { return along_front(y[0], y[1]); }
    double slip_velocity(const State& y) const { return y[2] * std::cos(y[3]); }
    double slip_y(const State& y) const { return y[2] * std::sin(y[3]); }
    double slip_along(const State& y) const { return along_front(slip_velocity(y), slip_y(y)); }
    double slip_acceleration(const State& y, const State& rates) const {
        const double cosine = std::cos(y[3]), sine = std::sin(y[3]), turning = y[2] * rates[3];
        return along_front(rates[2] * cosine - turning * sine, rates[2] * sine + turning * cosine);
    }

private:
    struct Motion {
        Heading heading;
        Heading way;        // of the slip, in the world
        Slip slip;          // m/s
        Slip friction;      // N
        Slip acceleration;  // m/s^2, along the slip and to its left
        FaceReaction reaction;
    };
    double height() const { return model().face(quadrant()).height; }
    Motion solve(const SpatialExpansion& field, const State& y) const {
        const Pose pose = upright().pose(0.0);
        const HeadedField headed = plane_->headed(field, y[0], y[1], height());
        Motion motion;
        motion.heading = headed.heading;
        motion.way = Heading::of_angle(y[3]);
        const Slip way = headed.heading.seen(motion.way.cosine, motion.way.sine);
        motion.slip = {y[2] * way.along, y[2] * way.across};
        const PlaneLoad load = plane_->load_of_face(headed, field.tau, pose, motion.slip);
        const double normal = load.along.contact_adhesion - load.along.fz;
        const double coefficient =
            upright().kinetic(way.along, y[2], y[0], pose, normal, field.tau);
        motion.reaction =
            face_reaction(model(), quadrant(), load.along, false, way.along * coefficient);
        motion.friction = {motion.reaction.friction, -way.across * coefficient * normal};
        const double along = (load.along.fx + motion.friction.along) * robot().per_mass;
        const double across = (load.across + motion.friction.across) * robot().per_mass;
        motion.acceleration = {way.along * along + way.across * across,
                               way.along * across - way.across * along};
        return motion;
    }

    double slip_x_, slip_y_;
};

/// A face that lies still: its middle stays where it is, also when the heading turns.
class PlaneFaceRest : public PlanePhase {
public:
    static constexpr int kEvents = 3;
    static constexpr std::array<Event, kEvents> kEvent = {Event::ahead_lifts, Event::behind_lifts,
                                                          Event::breaks_loose};
    using Values = std::array<double, kEvents>;

    PlaneFaceRest(PlaneDynamics& plane, const BodyState& body) : PlanePhase(plane), body_(body) {
        rebase_to_face(body.x, body.y);
    }

    Values values(double tau) const {
        const Motion motion = solve(tau);
        const double normal = motion.reaction.normal(), size = motion.friction.size();
        const double way = size > 0.0 ? -motion.friction.along / size : 1.0;
        const double limit =
            upright().static_limit(way, body_.x, upright().pose(0.0), normal, tau) * normal;
        return {motion.reaction.ahead, motion.reaction.behind, limit - size};
    }
    BodyState body(double tau) const {
        BodyState result = body_;
        result.heading = solve(tau).heading.angle();
        return result;
    }
    Snapshot snapshot(double tau) const {
        const Motion motion = solve(tau);
        const Face face = model().face(body_.quadrant);
        const double base = face.half_base + face.shift;
        return {body(tau),
                {motion.reaction.normal(), motion.friction.along},
                body_.x + base * motion.heading.cosine,
                0.0,
                body_.y + base * motion.heading.sine,
                motion.friction.across,
                0.0};
    }

private:
    struct Motion {
        Heading heading;
        Slip friction;  // N
        FaceReaction reaction;
    };
    Motion solve(double tau) const {
        const HeadedField headed = plane_->headed(field_at(tau), body_.x, body_.y, body_.z);
        const PlaneLoad load = plane_->load_of_face(headed, tau, upright().pose(0.0), {});
        const FaceReaction reaction = face_reaction(model(), body_.quadrant, load.along, true, 0.0);
        return {headed.heading, {reaction.friction, -load.across}, reaction};
    }

    BodyState body_;
};

}  // namespace stickslip
