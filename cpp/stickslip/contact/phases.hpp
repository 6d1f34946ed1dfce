#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact/contact.hpp"
#include "stickslip/solver/stepping.hpp"

/// Between two events the robot moves smoothly in one of five phases (a face that slides:
/// face_slide.hpp; one that lies still: rest.hpp). Each phase has the fewest
/// coordinates that its contact leaves free, so a sticking corner cannot creep and a touching one
/// cannot penetrate. A phase offers
///   kDim, kEvents      number of coordinates and of event functions
///   kSlips, kFlies     whether a contact slips, whether nothing touches
///   kTurns             whether it is of a robot that moves in the whole plane (plane_phase.hpp)
///   kEvent             what each event function is; it fires when its function falls through zero
///   field_at(tau)      the field's expansion, apart from the state
///   rates(field, y, dydt, g)   rates and event functions
///   event(i, tau, y)   one event function; y is a State, or has its coordinates one by one
///   speed(y)           bound on the speed of the centre of mass
///   kRests             of a body that lies still: no error tells how long its steps may be
///   longest_step(y, rates)     of a slip in the whole plane, s
///   rebase(y)          centres the field's expansion for the next step
///   centre(y, pose)    the centre of mass
///   angle, omega, contact_x(y)   what the summary watches
///   event_rounding()   see PhaseBase
///   begin(body), body(tau, y)  to coordinates and back
///   scale()            the size of each coordinate, for the error norm
/// The formulas, rates and what they use, are written for any D: Dynamics, or the dynamics of a
/// pack of robots (lane_kernel.cpp), whose numbers D::Real are packs. The rest is of one robot.
namespace stickslip {

template <class Real>
struct Point {
    Real x, z;  ///< m
};

/// What all phases share.
template <class D>
class PhaseBase {
public:
    using Real = typename D::Real;
    static constexpr bool kTurns = false;

    explicit PhaseBase(D& dynamics) : dynamics_(&dynamics) {}

    ExpansionOf<Real> field_at(Real tau) const { return dynamics_->field_at(tau); }
    bool outside() const { return dynamics_->field().outside(); }
    double reach() const { return dynamics_->field().reach(); }
    double min_time_constant() const { return dynamics_->field().min_time_constant(); }
    /// An event function that is born above this has risen since; others may be zero but for
    /// rounding.
    double event_rounding() const { return 0.0; }
    D& dynamics() const { return *dynamics_; }

    /// With the field's expansion, to look elsewhere and come back.
    Dynamics state() const { return *dynamics_; }
    void restore(const Dynamics& state) { *dynamics_ = state; }

protected:
    const Model& model() const { return dynamics_->model(); }
    const PlainDynamics<Real>& robot() const { return dynamics_->robot(); }
    int quadrant() const { return dynamics_->quadrant(); }

    template <class Phase>
    static void rebase_to(const Phase& phase, const typename Phase::State& y) {
        Dynamics& dynamics = phase.dynamics();
        const Point<double> at = phase.centre(y, dynamics.pose(phase.angle(y)));
        dynamics.rebase_field(at.x, at.z);
    }

    template <class Phase>
    static double event_by_rates(const Phase& phase, std::size_t i, double tau,
                                 const typename Phase::State& y) {
        typename Phase::State unused;
        typename Phase::Values g;
        phase.rates(phase.field_at(tau), y, unused, g);
        return g[i];
    }

    D* dynamics_;
};

/// A corner sticks: y = (angle, omega).
template <class D>
class CornerStickPhaseOf : public PhaseBase<D> {
    using Base = PhaseBase<D>;
    using Base::dynamics_, Base::model, Base::robot, Base::quadrant;

public:
    using Real = typename D::Real;
    static constexpr int kDim = 2;
    static constexpr int kEvents = 5;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = false;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::lift_off, Event::breaks_backward,
                                                          Event::breaks_forward,
                                                          Event::behind_lands, Event::ahead_lands};

    CornerStickPhaseOf(D& dynamics, Real contact_x) : Base(dynamics), contact_x_(contact_x) {}

    [[gnu::always_inline]] void rates(const ExpansionOf<Real>& field, const State& y, State& dydt,
                                      Values& g) const {
        const PoseOf<Real> pose = dynamics_->pose(y[0]);
        const CornerStickOf<Real> stick = solve(field, y, pose);
        dydt = {y[1], stick.angular_acceleration};
        const Real normal = stick.reaction.normal, friction = stick.reaction.friction;
        const Real behind = limit(-1.0, pose, normal, field.tau);
        const Real ahead = limit(1.0, pose, normal, field.tau);
        g = {normal, behind * normal - friction, ahead * normal + friction, y[0],
             kQuarterTurn - y[0]};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 3) return y[0];
        if (i == 4) return kQuarterTurn - y[0];
        return Base::event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { Base::rebase_to(*this, y); }
    Point<Real> centre(const State&, const PoseOf<Real>& pose) const {
        return {contact_x_ - (pose.lever - pose.roll), pose.height};
    }
    State begin(const BodyState& body) const { return {body.angle, body.omega}; }
    BodyState body(double, const State& y) const {
        const Pose pose = dynamics_->pose(y[0]);
        return {contact_x_ - (pose.lever - pose.roll),
                pose.height,
                y[0],
                y[1] * pose.height,
                y[1] * pose.lever,
                y[1],
                quadrant()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        const Pose pose = dynamics_->pose(y[0]);
        return {body(tau, y), solve(Base::field_at(tau), y, pose).reaction, contact_x_ + pose.roll,
                0.0};
    }
    State scale(const Scales& s) const { return {1.0, s.rate}; }
    Real speed(const State& y) const { return magnitude(y[1]) * robot().radius; }
    Real angle(const State& y) const { return y[0]; }
    Real omega(const State& y) const { return y[1]; }
    Real contact_x(const State&) const { return contact_x_; }

private:
    [[gnu::always_inline]] Real limit(double slip, const PoseOf<Real>& pose, Real normal,
                                      Real tau) const {
        return dynamics_->static_limit(slip, contact_x_ + pose.roll, pose, normal, tau);
    }
    [[gnu::always_inline]] CornerStickOf<Real> solve(const ExpansionOf<Real>& field, const State& y,
                                                     const PoseOf<Real>& pose) const {
        const LoadOf<Real> load =
            dynamics_->load(field, contact_x_ - (pose.lever - pose.roll), pose.height, pose,
                            y[1] * pose.height, y[1] * pose.lever, y[1]);
        return corner_stick(robot(), pose, y[1], load);
    }

    Real contact_x_;
};
using CornerStickPhase = CornerStickPhaseOf<Dynamics>;

/// A corner slips to one side: y = (contact_x, angle, slip velocity, omega).
template <class D>
class CornerSlipPhaseOf : public PhaseBase<D> {
    using Base = PhaseBase<D>;
    using Base::dynamics_, Base::model, Base::robot, Base::quadrant;

public:
    using Real = typename D::Real;
    static constexpr int kDim = 4;
    static constexpr int kEvents = 5;
    static constexpr bool kSlips = true;
    static constexpr bool kFlies = false;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::lift_off, Event::slip_stops,
                                                          Event::behind_lands, Event::ahead_lands,
                                                          Event::sliding_jams};

    CornerSlipPhaseOf(D& dynamics, Real contact_x, Real slip, Real slip_velocity)
        : Base(dynamics), contact_x_(contact_x), slip_velocity_(slip_velocity), slip_(slip) {}

    [[gnu::always_inline]] void rates(const ExpansionOf<Real>& field, const State& y, State& dydt,
                                      Values& g) const {
        const CornerSlipOf<Real> motion = solve(field, y);
        dydt = {y[2], y[3], motion.slip_acceleration, motion.angular_acceleration};
        g = {motion.normal, slip_ * y[2], y[1], kQuarterTurn - y[1],
             motion.effective_inertia - kJammed * robot().inertia};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 1) return slip_ * y[2];
        if (i == 2) return y[1];
        if (i == 3) return kQuarterTurn - y[1];
        return Base::event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { Base::rebase_to(*this, y); }
    Point<Real> centre(const State& y, const PoseOf<Real>& pose) const {
        return {y[0] - (pose.lever - pose.roll), pose.height};
    }
    State begin(const BodyState& body) const {
        return {contact_x_, body.angle, slip_velocity_, body.omega};
    }
    BodyState body(double, const State& y) const {
        const Pose pose = dynamics_->pose(y[1]);
        return {y[0] - (pose.lever - pose.roll),
                pose.height,
                y[1],
                y[2] + y[3] * pose.height,
                y[3] * pose.lever,
                y[3],
                quadrant()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        const CornerSlipOf<Real> motion = solve(Base::field_at(tau), y);
        const Reaction reaction = {motion.normal, -motion.coefficient * motion.normal};
        return {body(tau, y), reaction, y[0] + dynamics_->pose(y[1]).roll, y[2]};
    }
    State scale(const Scales& s) const { return {s.length, 1.0, s.velocity, s.rate}; }
    Real speed(const State& y) const { return magnitude(y[2]) + magnitude(y[3]) * robot().radius; }
    Real angle(const State& y) const { return y[1]; }
    Real omega(const State& y) const { return y[3]; }
    Real contact_x(const State& y) const { return y[0]; }
    Real slip_velocity(const State& y) const { return y[2]; }
    /// Whether a step that could not be made small enough may be laid to sliding about to jam.
    bool nearly_jams(double tau, const State& y) const {
        return solve(Base::field_at(tau), y).effective_inertia < kNearlyJammed * model().inertia;
    }

private:
    // Sliding is taken as jammed a little before the effective inertia reaches zero, where the
    // reaction, which grows as its inverse, leaves the range of numbers.
    static constexpr double kJammed = 1e-6;
    static constexpr double kNearlyJammed = 1e-2;

    [[gnu::always_inline]] CornerSlipOf<Real> solve(const ExpansionOf<Real>& field,
                                                    const State& y) const {
        const PoseOf<Real> pose = dynamics_->pose(y[1]);
        const LoadOf<Real> load =
            dynamics_->load(field, y[0] - (pose.lever - pose.roll), pose.height, pose,
                            y[2] + y[3] * pose.height, y[3] * pose.lever, y[3]);
        const Real coefficient =
            dynamics_->corner_kinetic(slip_, y[2], y[0] + pose.roll, pose, y[3], load, field.tau);
        return corner_slip(robot(), pose, y[3], load, slip_ * coefficient);
    }

    Real contact_x_, slip_velocity_, slip_;
};
using CornerSlipPhase = CornerSlipPhaseOf<Dynamics>;

/// A touch-down is a gap that rounding cannot make, over the body's radius, since a corner that has
/// just left has none. The gap is the difference of two heights of the body's size.
inline constexpr double kFlightRounding = 16.0 * std::numeric_limits<double>::epsilon();

/// Gaps (m) of the pivot, the corners behind and ahead of it, and the one opposite, where that of
/// the pivot is `gap`; each with room for rounding.
template <class Real>
[[gnu::always_inline]] inline std::array<Real, 4> corner_gaps(const PlainDynamics<Real>& robot,
                                                              Real gap, const PoseOf<Real>& pose) {
    const Real behind = 2.0 * robot.half_base * pose.sine;
    const Real ahead = 2.0 * robot.half_rise * pose.cosine;
    const Real below = gap + kFlightRounding * robot.radius;
    return {below, below + behind, below + ahead, below + behind + ahead};
}

/// Nothing touches: y = (x, z, angle, vx, vz, omega).
template <class D>
class FlightPhaseOf : public PhaseBase<D> {
    using Base = PhaseBase<D>;
    using Base::dynamics_, Base::model, Base::robot, Base::quadrant;

public:
    using Real = typename D::Real;
    static constexpr int kDim = 6;
    static constexpr int kEvents = 4;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = true;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {
        Event::pivot_touches, Event::behind_lands, Event::ahead_lands, Event::opposite_touches};

    using Base::Base;

    [[gnu::always_inline]] void rates(const ExpansionOf<Real>& field, const State& y, State& dydt,
                                      Values& g) const {
        const PoseOf<Real> pose = dynamics_->pose(y[2]);
        const LoadOf<Real> load = dynamics_->load(field, y[0], y[1], pose, y[3], y[4], y[5]);
        dydt = {y[3],
                y[4],
                y[5],
                load.fx * robot().per_mass,
                load.fz * robot().per_mass,
                load.torque * robot().per_inertia};
        g = gaps(y[1] - pose.height, pose);
    }
    double event(std::size_t i, double, const auto& y) const {
        const Pose pose = dynamics_->pose(y[2]);
        return gaps(y[1] - pose.height, pose)[i];
    }
    void rebase(const State& y) { Base::rebase_to(*this, y); }
    Point<Real> centre(const State& y, const PoseOf<Real>&) const { return {y[0], y[1]}; }
    State begin(const BodyState& body) const {
        return {body.x, body.z, body.angle, body.vx, body.vz, body.omega};
    }
    BodyState body(double, const State& y) const {
        return {y[0], y[1], y[2], y[3], y[4], y[5], quadrant()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        Snapshot result;
        result.body = body(tau, y);
        return result;
    }
    State scale(const Scales& s) const {
        return {s.length, s.length, 1.0, s.velocity, s.velocity, s.rate};
    }
    Real speed(const State& y) const { return magnitude(y[3]) + magnitude(y[4]); }
    Real angle(const State& y) const { return y[2]; }
    Real omega(const State& y) const { return y[5]; }
    Real contact_x(const State& y) const { return y[0]; }
    double event_rounding() const { return 2.0 * kFlightRounding * robot().radius; }

private:
    [[gnu::always_inline]] Values gaps(Real gap, const PoseOf<Real>& pose) const {
        return corner_gaps(robot(), gap, pose);
    }
};
using FlightPhase = FlightPhaseOf<Dynamics>;

}  // namespace stickslip
