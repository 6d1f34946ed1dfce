#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact/frame.hpp"

/// Between two events the robot moves smoothly in one of five phases (those of a face:
/// face_phases.hpp). Each phase has the fewest
/// coordinates that its contact leaves free, so a sticking corner cannot creep and a touching one
/// cannot penetrate. A phase offers
///   kDim, kEvents      number of coordinates and of event functions
///   kSlips, kFlies     whether a contact slips, whether nothing touches
///   kTurns             whether it is of a robot that moves in the whole plane
///   kEvent             what each event function is; it fires when its function falls through zero
///   field_at(tau)      the field's expansion, apart from the state
///   rates(field, y, dydt, g)   rates and event functions
///   event(i, tau, y)   one event function; y is a State, or has its coordinates one by one
///   speed(y)           bound on the speed of the centre of mass
///   kRests             of a body that lies still: no error tells how long its steps may be
///   longest_step(y, rates)     of a slip in the whole plane, s
///   place_of(tau, y)   where the field's expansion is to be: at the centre of mass, in the ground
///   centre(y, pose)    the centre of mass, of a phase that packs have
///   angle, omega, slip_place, slip_speed(y)   what the summary watches
///   acceleration(y, rates)     of the centre of mass, m/s^2, of a phase that may have an inner
///   mass contact(y), slip(y)        place and velocity of what slips, to go on with
///   event_rounding()   see PhaseBase
///   begin(body), body(tau, y)  to coordinates and back
///   scale()            the size of each coordinate, for the error norm
/// They are written for any frame (frame.hpp), and the formulas, rates and what they use, for any
/// numbers: those of a FixedFrame of a pack of robots (run/step_kernel.cpp) are packs. The rest is
/// of one robot.
namespace stickslip {

/// Base of all phases.
template <class F>
class PhaseBase {
public:
    using Frame = F;
    using Real = typename Frame::Real;
    using Place = typename Frame::Place;
    using Vector = typename Frame::Vector;
    using Field = typename Frame::Field;
    static constexpr bool kTurns = Frame::kTurns;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = false;
    static constexpr bool kRests = false;
    static constexpr bool kHasInner = false;

    explicit PhaseBase(const Frame& frame) : frame_(frame) {}

    auto& field() const { return frame_.field(); }
    [[gnu::always_inline]] Field field_at(Real tau) const { return frame_.field_at(tau); }
    bool outside() const { return frame_.field().outside(); }
    double reach() const { return frame_.field().reach(); }
    double min_time_constant() const { return frame_.field().min_time_constant(); }
    /// An event function that is born above this has risen since; others may be zero but for
    /// rounding.
    double event_rounding() const { return 0.0; }

    /// The field's expansion, to look elsewhere and come back.
    auto state() const { return frame_.field(); }
    void restore(const auto& field) { frame_.field() = field; }

protected:
    static constexpr std::size_t kSurface = Frame::kSurface;

    auto& dynamics() const { return frame_.dynamics(); }
    const Model& model() const { return dynamics().model(); }
    const PlainDynamics<Real>& robot() const { return dynamics().robot(); }
    int quadrant() const { return dynamics().quadrant(); }

    template <class Phase>
    static double event_by_rates(const Phase& phase, std::size_t i, double tau,
                                 const typename Phase::State& y) {
        typename Phase::State unused;
        typename Phase::Values g;
        phase.rates(phase.field_at(tau), y, unused, g);
        return g[i];
    }

    Frame frame_;
};

/// Base of the two phases of a corner on the surface.
template <class Frame>
class CornerBase : public PhaseBase<Frame> {
protected:
    using Base = PhaseBase<Frame>;
    using Base::Base, Base::frame_, Base::dynamics;
    using typename Base::Place, typename Base::Real;

    auto centre_behind(const Place& corner, const PoseOf<Real>& pose) const {
        return frame_.centre(frame_.moved(corner, frame_.last_heading(), -pose.place()),
                             pose.height);
    }
    /// A body whose pivot corner is on the surface and slips.
    BodyState body_on(double tau, const Place& corner, double angle, const Place& slip,
                      double omega) const {
        const Pose pose = dynamics().pose(angle);
        const auto heading = frame_.heading_at_corner(tau, corner, pose);
        return frame_.body(heading, frame_.moved(corner, heading, -pose.place()), pose.height,
                           angle, frame_.moved(slip, heading, omega * pose.height),
                           omega * pose.lever_arm, omega);
    }
};

/// A corner sticks: y = (angle, omega).
template <class Frame>
class CornerStickIn : public CornerBase<Frame> {
    using Base = CornerBase<Frame>;
    using Base::frame_, Base::dynamics, Base::robot;

public:
    using typename Base::Real, typename Base::Place, typename Base::Vector, typename Base::Field;
    using Seen = typename Frame::Seen;
    static constexpr std::array kEvent =
        join(std::array{Event::lift_off}, Frame::kBreaks,
             std::array{Event::behind_lands, Event::ahead_lands}, Frame::kFrameEvents);
    static constexpr int kDim = 2;
    static constexpr int kEvents = kEvent.size();
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;

    CornerStickIn(const Frame& frame, const Place& contact) : Base(frame), contact_(contact) {}

    [[gnu::always_inline]] void rates(const Field& field, const State& y, State& dydt,
                                      Values& g) const {
        const PoseOf<Real> pose = dynamics().pose(y[0]);
        const auto seen = frame_.seen_at_corner(field, contact_, pose);
        const Motion motion = solve(seen, field.tau, pose, y);
        const Real normal = motion.stick.reaction.normal;
        const Real touch_x = frame_.moved(contact_, seen.heading, pose.rolled_distance)[0];
        const Real most = dynamics().static_coefficient(touch_x, pose, normal, field.tau);
        const auto limit = [&](double slip_sign) __attribute__((always_inline)) {
            return dynamics().directional(most, slip_sign) * normal;
        };
        dydt = {y[1], motion.stick.angular_acceleration};
        put(g, normal, frame_.left_to_break(motion.friction, limit), y[0], kQuarterTurn - y[0],
            frame_.events(seen));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        switch (kEvent[i]) {
            case Event::behind_lands:
                return y[0];
            case Event::ahead_lands:
                return kQuarterTurn - y[0];
            default:
                return Base::event_by_rates(*this, i, tau, y);
        }
    }
    auto centre(const State&, const PoseOf<Real>& pose) const {
        return Base::centre_behind(contact_, pose);
    }
    auto place_of(double tau, const State& y) const {
        return frame_.in_ground(tau, centre(y, dynamics().pose(y[0])));
    }
    std::array<double, 2> acceleration(const State& y, const State& rates) const {
        return centre_acceleration(dynamics().pose(y[0]), 0.0, y[1], rates[1]);
    }
    State begin(const BodyState& body) const { return {body.angle, body.omega}; }
    BodyState body(double tau, const State& y) const {
        return Base::body_on(tau, contact_, y[0], {}, y[1]);
    }
    Sample sample(double tau, const State& y) const {
        const Pose pose = dynamics().pose(y[0]);
        const auto seen = frame_.seen_at_corner(Base::field_at(tau), contact_, pose);
        const Motion motion = solve(seen, tau, pose, y);
        return frame_.sample(body(tau, y), motion.stick.reaction.normal, motion.friction,
                             frame_.moved(contact_, seen.heading, pose.rolled_distance), {});
    }
    State scale(const Scales& s) const { return {1.0, s.rate}; }
    Real speed(const State& y) const { return magnitude(y[1]) * robot().radius; }
    Real angle(const State& y) const { return y[0]; }
    Real omega(const State& y) const { return y[1]; }
    Place contact(const State&) const { return contact_; }
    Real slip_place(const State&) const { return frame_.along_front(contact_); }

private:
    struct Motion {
        CornerStickOf<Real> stick;
        Vector friction;  // N
    };
    // Filled in place: a copy is not always had for nothing.
    [[gnu::always_inline]] Motion solve(const Seen& seen, Real tau, const PoseOf<Real>& pose,
                                        const State& y) const {
        const Vector velocity = {y[1] * pose.height};
        const auto load = frame_.load(seen, tau, pose, velocity, y[1] * pose.lever_arm, y[1]);
        Motion motion;
        motion.stick = corner_stick(robot(), pose, y[1], load);
        motion.friction = frame_.vector(motion.stick.reaction.friction, -frame_.across(load));
        return motion;
    }

    Place contact_;
};

/// A corner slips: y = (its place, angle, its velocity, omega).
template <class Slide>
class CornerSlipIn : public CornerBase<typename Slide::Frame> {
    using Frame = typename Slide::Frame;
    using Base = CornerBase<Frame>;
    using Base::frame_, Base::dynamics, Base::model, Base::robot, Base::kSurface;
    static constexpr std::size_t kAngle = kSurface, kSlip = kAngle + 1, kOmega = kSlip + kSurface;

public:
    using typename Base::Real, typename Base::Place, typename Base::Vector, typename Base::Field;
    using Seen = typename Frame::Seen;
    static constexpr std::array kEvent =
        join(std::array{Event::lift_off, Slide::kEnds, Event::behind_lands, Event::ahead_lands,
                        Event::sliding_jams},
             Frame::kFrameEvents, Slide::kFrameEvents);
    static constexpr int kDim = kOmega + 1;
    static constexpr int kEvents = kEvent.size();
    static constexpr bool kSlips = true;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;

    CornerSlipIn(const Frame& frame, const Place& contact, const Slide& slide)
        : Base(frame), contact_(contact), slide_(slide) {}

    [[gnu::always_inline]] void rates(const Field& field, const State& y, State& dydt,
                                      Values& g) const {
        const PoseOf<Real> pose = dynamics().pose(y[kAngle]);
        const auto seen = frame_.seen_at_corner(field, contact(y), pose);
        const Motion motion = solve(seen, field.tau, pose, y);
        put(dydt, slip(y), y[kOmega], frame_.in_world(seen.heading, motion.acceleration),
            motion.upright.angular_acceleration);
        put(g, motion.upright.normal, slide_.left(slip(y)), y[kAngle], kQuarterTurn - y[kAngle],
            motion.upright.effective_inertia - kJammed * robot().inertia, frame_.events(seen),
            slide_.events(slip(y)));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        switch (kEvent[i]) {
            case Slide::kEnds:
                return slide_.left(slip(y));
            case Event::behind_lands:
                return y[kAngle];
            case Event::ahead_lands:
                return kQuarterTurn - y[kAngle];
            default:
                return Base::event_by_rates(*this, i, tau, y);
        }
    }
    auto centre(const State& y, const PoseOf<Real>& pose) const {
        return Base::centre_behind(contact(y), pose);
    }
    auto place_of(double tau, const State& y) const {
        return frame_.in_ground(tau, centre(y, dynamics().pose(y[kAngle])));
    }
    std::array<double, 2> acceleration(const State& y, const State& rates) const {
        return centre_acceleration(dynamics().pose(y[kAngle]), rates[kSlip], y[kOmega],
                                   rates[kOmega]);
    }
    State begin(const BodyState& body) const {
        return gather<State>(contact_, body.angle, slide_.begin(), body.omega);
    }
    BodyState body(double tau, const State& y) const {
        return Base::body_on(tau, contact(y), y[kAngle], slip(y), y[kOmega]);
    }
    Sample sample(double tau, const State& y) const {
        const Pose pose = dynamics().pose(y[kAngle]);
        const auto seen = frame_.seen_at_corner(Base::field_at(tau), contact(y), pose);
        const Motion motion = solve(seen, tau, pose, y);
        return frame_.sample(body(tau, y), motion.upright.normal, motion.friction,
                             frame_.moved(contact(y), seen.heading, pose.rolled_distance),
                             motion.slip);
    }
    State scale(const Scales& s) const {
        return gather<State>(frame_.both(s.length), 1.0, frame_.both(s.velocity), s.rate);
    }
    Real speed(const State& y) const {
        return frame_.size(slip(y)) + magnitude(y[kOmega]) * robot().radius;
    }
    double longest_step(const State& y, const State& rates) const {
        return slide_.longest_step(slip(y), slip(rates));
    }
    Real angle(const State& y) const { return y[kAngle]; }
    Real omega(const State& y) const { return y[kOmega]; }
    Place contact(const auto& y) const { return frame_.part(y, 0); }
    Place slip(const auto& y) const { return frame_.part(y, kSlip); }
    Real slip_place(const State& y) const { return frame_.along_front(contact(y)); }
    Real slip_speed(const State& y) const { return frame_.along_front(slip(y)); }
    /// Whether a step that could not be made small enough may be laid to sliding about to jam.
    bool nearly_jams(double tau, const State& y) const {
        const Pose pose = dynamics().pose(y[kAngle]);
        const auto seen = frame_.seen_at_corner(Base::field_at(tau), contact(y), pose);
        return solve(seen, tau, pose, y).upright.effective_inertia <
               kNearlyJammed * model().inertia;
    }

private:
    // Sliding is taken as jammed a little before the effective inertia reaches zero, where the
    // reaction, which grows as its inverse, leaves the range of numbers.
    static constexpr double kJammed = 1e-6;
    static constexpr double kNearlyJammed = 1e-2;

    struct Motion {
        Vector slip;          // m/s
        Vector friction;      // N
        Vector acceleration;  // m/s^2, of the contact
        CornerSlipOf<Real> upright;
    };
    [[gnu::always_inline]] Motion solve(const Seen& seen, Real tau, const PoseOf<Real>& pose,
                                        const State& y) const {
        const Real omega = y[kOmega];
        Motion motion;
        const Vector direction = slide_.direction(seen.heading, slip(y));
        motion.slip = frame_.in_plane(seen.heading, slip(y));
        const auto load = frame_.load(
            seen, tau, pose,
            frame_.vector(fma(omega, pose.height, motion.slip.along), motion.slip.across),
            omega * pose.lever_arm, omega);
        const Real touch_x = frame_.moved(contact(y), seen.heading, pose.rolled_distance)[0];
        const Real coefficient = dynamics().corner_kinetic(direction.along, motion.slip.size(),
                                                           touch_x, pose, omega, load, tau);
        motion.upright = corner_slip(robot(), pose, omega, load, direction.along * coefficient);
        const Real size = -coefficient * motion.upright.normal;
        motion.friction = frame_.vector(direction.along * size, direction.across * size);
        motion.acceleration =
            frame_.vector(motion.upright.slip_acceleration,
                          (frame_.across(load) + motion.friction.across) * robot().per_mass);
        return motion;
    }

    Place contact_;
    Slide slide_;
};

/// A touch-down is a gap that rounding cannot make, over the body's radius, since a corner that has
/// just left has none. The gap is the difference of two heights of the body's size.
inline constexpr double kFlightRounding = 16.0 * std::numeric_limits<double>::epsilon();

/// Flight: y = (place in the surface, z, angle, velocity in the surface, vz, omega).
template <class Frame>
class FlightIn : public PhaseBase<Frame> {
    using Base = PhaseBase<Frame>;
    using Base::frame_, Base::dynamics, Base::robot, Base::kSurface;
    static constexpr std::size_t kZ = kSurface, kAngle = kZ + 1, kVelocity = kAngle + 1,
                                 kVz = kVelocity + kSurface, kOmega = kVz + 1;

public:
    using typename Base::Real, typename Base::Place, typename Base::Vector, typename Base::Field;
    static constexpr std::array kEvent =
        join(std::array{Event::pivot_touches, Event::behind_lands, Event::ahead_lands,
                        Event::opposite_touches},
             Frame::kFrameEvents);
    static constexpr int kDim = kOmega + 1;
    static constexpr int kEvents = kEvent.size();
    static constexpr bool kFlies = true;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;

    using Base::Base;

    [[gnu::always_inline]] void rates(const Field& field, const State& y, State& dydt,
                                      Values& g) const {
        const PoseOf<Real> pose = dynamics().pose(y[kAngle]);
        const auto seen = frame_.seen_at(field, place(y), y[kZ]);
        const auto load = frame_.load(
            seen, field.tau, pose, frame_.in_plane(seen.heading, velocity(y)), y[kVz], y[kOmega]);
        const Vector acceleration =
            frame_.vector(load.fx * robot().per_mass, frame_.across(load) * robot().per_mass);
        put(dydt, velocity(y), y[kVz], y[kOmega], frame_.in_world(seen.heading, acceleration),
            load.fz * robot().per_mass, load.torque * robot().per_inertia);
        put(g, gaps(y, pose), frame_.events(seen));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (kEvent[i] == Event::heading) return Base::event_by_rates(*this, i, tau, y);
        return gaps(y, dynamics().pose(y[kAngle]))[i];
    }
    auto centre(const State& y, const PoseOf<Real>&) const {
        return frame_.centre(place(y), y[kZ]);
    }
    auto place_of(double tau, const State& y) const { return frame_.in_ground(tau, centre(y, {})); }
    std::array<double, 2> acceleration(const State&, const State& rates) const {
        return {rates[kVelocity], rates[kVz]};
    }
    State begin(const BodyState& body) const {
        return gather<State>(frame_.place(body.x, body.y), body.z, body.angle,
                             frame_.place(body.vx, body.vy), body.vz, body.omega);
    }
    BodyState body(double tau, const State& y) const {
        return frame_.body(frame_.heading_at(tau, place(y), y[kZ]), place(y), y[kZ], y[kAngle],
                           velocity(y), y[kVz], y[kOmega]);
    }
    Sample sample(double tau, const State& y) const {
        Sample result;
        result.body = body(tau, y);
        return result;
    }
    State scale(const Scales& s) const {
        return gather<State>(frame_.both(s.length), s.length, 1.0, frame_.both(s.velocity),
                             s.velocity, s.rate);
    }
    Real speed(const State& y) const { return frame_.size(velocity(y)) + magnitude(y[kVz]); }
    Real angle(const State& y) const { return y[kAngle]; }
    Real omega(const State& y) const { return y[kOmega]; }
    Place contact(const State& y) const { return place(y); }
    Real slip_place(const State& y) const { return frame_.along_front(place(y)); }
    double event_rounding() const { return 2.0 * kFlightRounding * robot().radius; }

private:
    Place place(const auto& y) const { return frame_.part(y, 0); }
    Place velocity(const auto& y) const { return frame_.part(y, kVelocity); }
    /// Gaps (m) of the pivot, the corners behind and ahead of it, and the one opposite, each with
    /// room for rounding.
    [[gnu::always_inline]] std::array<Real, 4> gaps(const auto& y, const PoseOf<Real>& pose) const {
        const Real behind = 2.0 * robot().half_base * pose.sine;
        const Real ahead = 2.0 * robot().half_rise * pose.cosine;
        const Real below = fma(Real(kFlightRounding), robot().radius, y[kZ] - pose.height);
        return {below, below + behind, below + ahead, below + (behind + ahead)};
    }
};

/// Phases of a robot that stays in its plane, or of a pack of such robots.
template <class D>
using CornerStickPhaseOf = CornerStickIn<FixedFrame<D>>;
template <class D>
using CornerSlipPhaseOf = CornerSlipIn<SignedSlide<D>>;
template <class D>
using FlightPhaseOf = FlightIn<FixedFrame<D>>;

using CornerStickPhase = CornerStickPhaseOf<Dynamics>;
using CornerSlipPhase = CornerSlipPhaseOf<Dynamics>;
using FlightPhase = FlightPhaseOf<Dynamics>;

}  // namespace stickslip
