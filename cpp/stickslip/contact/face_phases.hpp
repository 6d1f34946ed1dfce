#pragma once

#include "stickslip/contact/phases.hpp"

namespace stickslip {

/// Base of the two phases of a face on the surface. Their first coordinates are the place of the
/// centre of mass.
template <class Frame>
class FaceBase : public PhaseBase<Frame> {
    using Base = PhaseBase<Frame>;

public:
    using typename Base::Place;

    explicit FaceBase(const Frame& frame)
        : Base(frame), face_(Base::model().face(Base::quadrant())) {}

    auto place_of(double tau, const auto& y) const {
        return frame_.in_ground(tau, frame_.centre(middle(y), face_.height));
    }
    double angle(const auto&) const { return 0.0; }
    double omega(const auto&) const { return 0.0; }
    Place contact(const auto& y) const { return frame_.of_face(middle(y), face_); }
    double slip_place(const auto& y) const { return frame_.along_front(contact(y)); }

protected:
    using Base::frame_;

    Place middle(const auto& y) const { return frame_.part(y, 0); }
    auto seen_there(const typename Base::Field& field, const auto& y) const {
        return frame_.seen_at(field, middle(y), face_.height);
    }
    BodyState body_on(double tau, const Place& middle, const Place& slip) const {
        return frame_.body(frame_.heading_at(tau, middle, face_.height), middle, face_.height, 0.0,
                           slip, 0.0, 0.0);
    }
    Sample sample_of(const BodyState& body, const auto& motion, const auto& slip) const {
        const Place middle = frame_.place(body.x, body.y);
        return frame_.sample(body, motion.reaction.normal(), motion.friction,
                             frame_.moved(middle, motion.seen.heading, face_.end()), slip);
    }

    Face face_;
};

/// A face slides: y = (place of the centre of mass, slip velocity).
template <class Slide>
class FaceSlideIn : public FaceBase<typename Slide::Frame> {
    using Frame = typename Slide::Frame;
    using Base = FaceBase<Frame>;
    using Base::frame_, Base::dynamics, Base::model, Base::robot, Base::middle, Base::kSurface;

public:
    using typename Base::Real, typename Base::Place, typename Base::Vector, typename Base::Field;
    static constexpr std::array kEvent =
        join(std::array{Event::ahead_lifts, Event::behind_lifts, Slide::kEnds}, Frame::kFrameEvents,
             Slide::kFrameEvents);
    static constexpr int kDim = 2 * kSurface;
    static constexpr int kEvents = kEvent.size();
    static constexpr bool kSlips = true;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;

    FaceSlideIn(const Frame& frame, const Slide& slide) : Base(frame), slide_(slide) {}

    [[gnu::always_inline]] void rates(const Field& field, const State& y, State& dydt,
                                      Values& g) const {
        const Motion motion = solve(field, y);
        put(dydt, slip(y), frame_.in_world(motion.seen.heading, motion.acceleration));
        put(g, motion.reaction.ahead, motion.reaction.behind, slide_.left(slip(y)),
            frame_.events(motion.seen), slide_.events(slip(y)));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (kEvent[i] == Slide::kEnds) return slide_.left(slip(y));
        return Base::event_by_rates(*this, i, tau, y);
    }
    std::array<double, 2> acceleration(const State&, const State& rates) const {
        return {rates[kSurface], 0.0};
    }
    State begin(const BodyState& body) const {
        return gather<State>(frame_.place(body.x, body.y), slide_.begin());
    }
    BodyState body(double tau, const State& y) const {
        return Base::body_on(tau, middle(y), slip(y));
    }
    Sample sample(double tau, const State& y) const {
        const Motion motion = solve(Base::field_at(tau), y);
        return Base::sample_of(body(tau, y), motion, motion.slip);
    }
    State scale(const Scales& s) const {
        return gather<State>(frame_.both(s.length), frame_.both(s.velocity));
    }
    double speed(const State& y) const { return frame_.size(slip(y)); }
    double longest_step(const State& y, const State& rates) const {
        return slide_.longest_step(slip(y), slip(rates));
    }
    Place slip(const auto& y) const { return frame_.part(y, kSurface); }
    double slip_speed(const State& y) const { return frame_.along_front(slip(y)); }

private:
    struct Motion {
        typename Frame::Seen seen;
        Vector slip;          // m/s
        Vector friction;      // N
        Vector acceleration;  // m/s^2
        FaceReaction reaction;
    };
    Motion solve(const Field& field, const State& y) const {
        const Pose pose = dynamics().pose(0.0);
        const auto seen = Base::seen_there(field, y);
        const Vector direction = slide_.direction(seen.heading, slip(y));
        const Vector slipping = frame_.in_plane(seen.heading, slip(y));
        const auto load = frame_.load(seen, field.tau, pose, slipping, 0.0, 0.0);
        const double normal = load.contact_adhesion - load.fz;
        const double coefficient = dynamics().kinetic(direction.along, slipping.size(),
                                                      middle(y)[0], pose, normal, field.tau);
        const FaceReaction reaction =
            face_reaction(model(), Base::quadrant(), load, false, direction.along * coefficient);
        const Vector friction =
            frame_.vector(reaction.friction, -direction.across * coefficient * normal);
        const Vector acceleration =
            frame_.vector((load.fx + friction.along) * robot().per_mass,
                          (frame_.across(load) + friction.across) * robot().per_mass);
        return {seen, slipping, friction, acceleration, reaction};
    }

    Slide slide_;
};

/// A face lies still: y = (place of the centre of mass), which no rate moves, so that it keeps its
/// bits. What changes are the forces, with the currents, and a user's or a free shape's with time.
template <class Frame>
class FaceRestIn : public FaceBase<Frame> {
    using Base = FaceBase<Frame>;
    using Base::frame_, Base::dynamics, Base::model;

public:
    using typename Base::Real, typename Base::Place, typename Base::Vector, typename Base::Field;
    static constexpr std::array kEvent = join(std::array{Event::ahead_lifts, Event::behind_lifts},
                                              Frame::kBreaks, Frame::kFrameEvents);
    static constexpr int kDim = Base::kSurface;
    static constexpr int kEvents = kEvent.size();
    static constexpr bool kRests = true;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;

    using Base::Base;

    void rates(const Field& field, const State& y, State& dydt, Values& g) const {
        const Motion motion = solve(field, y);
        const Pose pose = dynamics().pose(0.0);
        const double normal = motion.reaction.normal();
        const auto limit = [&](double slip_sign) {
            return dynamics().static_limit(slip_sign, y[0], pose, normal, field.tau) * normal;
        };
        dydt = {};
        put(g, motion.reaction.ahead, motion.reaction.behind,
            frame_.left_to_break(motion.friction, limit), frame_.events(motion.seen));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        return Base::event_by_rates(*this, i, tau, y);
    }
    static std::array<double, 2> acceleration(const State&, const State&) { return {}; }
    State begin(const BodyState& body) const { return frame_.place(body.x, body.y); }
    BodyState body(double tau, const State& y) const { return Base::body_on(tau, y, {}); }
    Sample sample(double tau, const State& y) const {
        const Motion motion = solve(Base::field_at(tau), y);
        return Base::sample_of(body(tau, y), motion, Vector());
    }
    State scale(const Scales& s) const { return frame_.both(s.length); }
    double speed(const State&) const { return 0.0; }

private:
    struct Motion {
        typename Frame::Seen seen;
        Vector friction;  // N
        FaceReaction reaction;
    };
    Motion solve(const Field& field, const State& y) const {
        const auto seen = Base::seen_there(field, y);
        const auto load = frame_.load(seen, field.tau, dynamics().pose(0.0), {}, 0.0, 0.0);
        const FaceReaction reaction = face_reaction(model(), Base::quadrant(), load, true, 0.0);
        return {seen, frame_.vector(reaction.friction, -frame_.across(load)), reaction};
    }
};

using FaceRestPhase = FaceRestIn<FixedFrame<Dynamics>>;
using FaceSlidePhase = FaceSlideIn<SignedSlide<Dynamics>>;

}  // namespace stickslip
