#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact.hpp"
#include "stickslip/phases.hpp"
#include "stickslip/plane_dynamics.hpp"

/// The phases of a robot that moves in the whole plane. They offer what those of phases.hpp do.
/// Places and velocities are the world's, so that a heading that turns moves nothing by itself: a
/// stuck edge keeps its middle, a body in flight its centre of mass, a face its middle.
namespace stickslip {

class PlanePhase {
public:
    using Real = double;
    static constexpr bool kTurns = true;
    /// Whether its equations are stiff, see Rosenbrock.
    static constexpr bool kStiff = false;

    explicit PlanePhase(PlaneDynamics& plane) : plane_(&plane) {}

    /// What the slip of the summary is counted along.
    void set_front(double heading) { front_ = Heading::of_angle(heading); }

    SpatialExpansion field_at(double tau) const { return plane_->field().at(tau); }
    bool outside() const { return plane_->field().outside(); }
    double reach() const { return plane_->field().reach(); }
    double min_time_constant() const { return plane_->field().min_time_constant(); }
    double event_rounding() const { return 0.0; }

    /// The bases and the field's expansion, to look elsewhere and come back.
    struct Bases {
        Dynamics upright;
        SpatialField field;
    };
    Bases state() const { return {upright(), plane_->field()}; }
    void restore(const Bases& bases) {
        upright() = bases.upright;
        plane_->field() = bases.field;
    }

protected:
    Dynamics& upright() const { return plane_->upright(); }
    const Model& model() const { return upright().model(); }
    const PlainDynamics<double>& robot() const { return upright().robot(); }
    int quadrant() const { return upright().quadrant(); }
    /// (x, y): of the pivot corner.
    void rebase_to_corner(double angle, double x, double y) {
        const Pose pose = upright().rebase_angle(angle);
        const Heading& h = plane_->watch().first();
        plane_->field().rebase({x - (pose.lever - pose.roll) * h.cosine,
                                y - (pose.lever - pose.roll) * h.sine, pose.height});
    }
    /// (x, y): of the middle of a face.
    void rebase_to_face(double x, double y) {
        plane_->field().rebase({x, y, upright().rebase_angle(0.0).height});
    }
    template <class Phase>
    static double event_by_rates(const Phase& phase, std::size_t i, double tau,
                                 const typename Phase::State& y) {
        typename Phase::State unused;
        typename Phase::Values g;
        phase.rates(phase.field_at(tau), y, unused, g);
        return g[i];
    }
    /// A body whose pivot corner is on the surface at (x, y) and slips at (vx, vy).
    BodyState on_corner(const Heading& h, const Pose& pose, double angle, double x, double y,
                        double vx, double vy, double omega) const {
        const double turning = omega * pose.height;
        const double behind = pose.lever - pose.roll;
        return {x - behind * h.cosine, pose.height, angle,      vx + turning * h.cosine,
                omega * pose.lever,    omega,       quadrant(), y - behind * h.sine,
                vy + turning * h.sine, h.angle()};
    }

    /// What the way of a slip counts is the velocity that it turns, which is little while it is
    /// slow.
    double way_scale(const Scales& s, double speed) const {
        return s.velocity / std::max(speed, plane_->least_slip());
    }

    /// The longest step (s) of a slip of `speed` m/s that changes by `gain` m/s^2. Where it ends
    /// its friction has no way, so that a step which leaps over the end, and not only from next to
    /// it, is rejected again and again; `most`: the part of the time to the end that it may take.
    /// One that begins turns the faster the slower it is, beyond what an error estimate sees.
    double slip_time(double speed, double gain, double most) const {
        constexpr double kLeast = 30.0, kOver = 2.0, kBegin = 0.2;
        const double least = plane_->least_slip();
        const bool is_least = speed <= kLeast * least;
        if (gain < 0.0) return (is_least ? kOver : most) * std::max(speed, least) / -gain;
        return is_least ? kBegin * plane_->slow_slip() / gain
                        : std::numeric_limits<double>::infinity();
    }

    /// Parts of the time to the end of a slip which a step of the two integrators takes with few
    /// rejections at rtol from 1e-6 to 1e-8; measured.
    static constexpr double kMostOfExplicit = 0.7, kMostOfStiff = 0.85;

    /// Of a vector of the world, along the front.
    double along_front(double x, double y) const { return front_.cosine * x + front_.sine * y; }

    PlaneDynamics* plane_;
    Heading front_;
};

}  // namespace stickslip
