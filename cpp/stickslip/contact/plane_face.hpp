#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact/plane_phase.hpp"

namespace stickslip {

/// A face slides along a vector: y = (x and y of the centre of mass, slip velocity along x and y).
/// kSlow: friction keeps the way of the slip with which the phase begins, see is_slow.
template <bool kSlow>
class PlaneFaceSlide : public PlanePhase {
public:
    static constexpr int kDim = 4;
    static constexpr int kEvents = kSlow ? 5 : 4;
    static constexpr bool kSlips = true;
    static constexpr bool kFlies = false;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = [] {
        std::array<Event, kEvents> result = {Event::ahead_lifts, Event::behind_lifts,
                                             VectorSlip<kSlow>::kEnds, Event::heading};
        if constexpr (kSlow) result[4] = Event::slip_quickens;
        return result;
    }();

    /// slip: m/s, along x and y.
    PlaneFaceSlide(PlaneDynamics& plane, const Slip& slip) : PlanePhase(plane), slip_(slip) {}

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        const Heading& h = motion.heading;
        dydt = {y[2], y[3], h.x(motion.acceleration), h.y(motion.acceleration)};
        g[0] = motion.reaction.ahead;
        g[1] = motion.reaction.behind;
        g[2] = slip_.left(slip_of(y));
        g[3] = plane_->watch().left(motion.horizontal);
        if constexpr (kSlow) g[4] = slip_.lacking(slip_of(y));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 2) return slip_.left(slip_of(y));
        if (i == 4) return slip_.lacking(slip_of(y));
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to_face(y[0], y[1]); }
    State begin(const BodyState& body) const {
        return {body.x, body.y, slip_.begin().along, slip_.begin().across};
    }
    BodyState body(double tau, const State& y) const {
        const Heading h = plane_->headed(field_at(tau), y[0], y[1], height()).heading;
        return {y[0], height(), 0.0, y[2], 0.0, 0.0, quadrant(), y[1], y[3], h.angle()};
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
    State scale(const Scales& s) const { return {s.length, s.length, s.velocity, s.velocity}; }
    double speed(const State& y) const { return slip_of(y).size(); }
    double longest_step(const State& y, const State& rates) const {
        return slip_.longest_step(slip_of(y), {rates[2], rates[3]});
    }
    double angle(const State&) const { return 0.0; }
    double omega(const State&) const { return 0.0; }
    /// Of the middle of the face, not of its end, which a heading that turns moves.
    double contact_x(const State& y) const { return y[0]; }
    double contact_y(const State& y) const { return y[1]; }
    double place_along(const State& y) const { return along_front(y[0], y[1]); }
    double slip_velocity(const State& y) const { return y[2]; }
    double slip_y(const State& y) const { return y[3]; }
    double slip_along(const State& y) const { return along_front(y[2], y[3]); }

private:
    // Along the heading and across.
    struct Motion {
        Heading heading;
        double horizontal;  // T
        Slip slip;          // m/s
        Slip friction;      // N
        Slip acceleration;  // m/s^2
        FaceReaction reaction;
    };
    double height() const { return model().face(quadrant()).height; }
    Motion solve(const SpatialExpansion& field, const State& y) const {
        const Pose pose = upright().pose(0.0);
        const HeadedField headed = plane_->headed(field, y[0], y[1], height());
        const Heading front = slip_.way(slip_of(y));
        const Slip way = headed.heading.seen(front.cosine, front.sine);
        Motion motion;
        motion.heading = headed.heading;
        motion.horizontal = headed.horizontal;
        motion.slip = headed.heading.seen(y[2], y[3]);
        const PlaneLoad load = plane_->load_of_face(headed, field.tau, pose, motion.slip);
        const double normal = load.along.contact_adhesion - load.along.fz;
        const double coefficient =
            upright().kinetic(way.along, motion.slip.size(), y[0], pose, normal, field.tau);
        motion.reaction =
            face_reaction(model(), quadrant(), load.along, false, way.along * coefficient);
        motion.friction = {motion.reaction.friction, -way.across * coefficient * normal};
        motion.acceleration = {(load.along.fx + motion.friction.along) * robot().per_mass,
                               (load.across + motion.friction.across) * robot().per_mass};
        return motion;
    }
    static Slip slip_of(const auto& y) { return {y[2], y[3]}; }

    VectorSlip<kSlow> slip_;
};

/// A face that lies still: y = (x and y of the centre of mass), which stay where they are, also
/// when the heading turns.
class PlaneFaceRest : public PlanePhase {
public:
    static constexpr int kDim = 2;
    static constexpr int kEvents = 4;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = false;
    static constexpr bool kRests = true;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::ahead_lifts, Event::behind_lifts,
                                                          Event::breaks_loose, Event::heading};

    using PlanePhase::PlanePhase;

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        const double normal = motion.reaction.normal(), size = motion.friction.size();
        const double way = size > 0.0 ? -motion.friction.along / size : 1.0;
        const double limit =
            upright().static_limit(way, y[0], upright().pose(0.0), normal, field.tau) * normal;
        dydt = {0.0, 0.0};
        g = {motion.reaction.ahead, motion.reaction.behind, limit - size,
             plane_->watch().left(motion.horizontal)};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to_face(y[0], y[1]); }
    State begin(const BodyState& body) const { return {body.x, body.y}; }
    BodyState body(double tau, const State& y) const {
        const Heading h = plane_->headed(field_at(tau), y[0], y[1], height()).heading;
        return {y[0], height(), 0.0, 0.0, 0.0, 0.0, quadrant(), y[1], 0.0, h.angle()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        const Motion motion = solve(field_at(tau), y);
        const Face face = model().face(quadrant());
        const double base = face.half_base + face.shift;
        return {body(tau, y),
                {motion.reaction.normal(), motion.friction.along},
                y[0] + base * motion.heading.cosine,
                0.0,
                y[1] + base * motion.heading.sine,
                motion.friction.across,
                0.0};
    }
    State scale(const Scales& s) const { return {s.length, s.length}; }
    double speed(const State&) const { return 0.0; }
    double angle(const State&) const { return 0.0; }
    double omega(const State&) const { return 0.0; }
    double place_along(const State& y) const { return along_front(y[0], y[1]); }

private:
    struct Motion {
        Heading heading;
        double horizontal;  // T
        Slip friction;      // N
        FaceReaction reaction;
    };
    double height() const { return model().face(quadrant()).height; }
    Motion solve(const SpatialExpansion& field, const State& y) const {
        const HeadedField headed = plane_->headed(field, y[0], y[1], height());
        const PlaneLoad load = plane_->load_of_face(headed, field.tau, upright().pose(0.0), {});
        const FaceReaction reaction = face_reaction(model(), quadrant(), load.along, true, 0.0);
        return {headed.heading, headed.horizontal, {reaction.friction, -load.across}, reaction};
    }
};

}  // namespace stickslip
