#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/phases.hpp"
#include "stickslip/contact/plane_dynamics.hpp"

/// The phases of a robot that moves in the whole plane. They offer what those of phases.hpp do.
/// Places and velocities are the world's, so that a heading that turns moves nothing by itself: a
/// stuck edge keeps its middle, a body in flight its centre of mass, a face its middle.
namespace stickslip {

/// Slip velocity (m/s) of a contact that has just broken loose: it says which way.
inline constexpr double kLeastSlip = 1e-9;

/// Whether a slip is slow: up to the capture speed, and a little more for rounding. A slow slip
/// sticks if static friction can hold it. Otherwise its friction keeps the direction that it had
/// when the phase began, until the slip stops or is twice as fast. (A friction that follows a slow
/// slip is stiff: its direction changes within v / (mu g), less than 1 us.)
inline bool is_slow(const Slip& slip) {
    return slip.size() <= kCaptureSpeed * (1.0 + 1e-9);
}

/// The slip of a phase, a vector along x and y, m/s. kSlow: it began slow, see above.
template <bool kSlow>
class VectorSlip {
public:
    /// What ends such a phase.
    static constexpr Event kEnds = kSlow ? Event::slip_stops : Event::slip_slows;

    explicit VectorSlip(const Slip& begin) : begin_(begin), way_(way_of(begin)) {}

    /// As the phase begins.
    const Slip& begin() const { return begin_; }
    /// The direction against which friction acts.
    Heading way(const Slip& now) const { return kSlow ? way_ : way_of(now); }
    /// What is left before it stops, or slows down to the capture speed.
    double left(const Slip& now) const {
        if constexpr (kSlow) return way_.cosine * now.along + way_.sine * now.across;
        return now.size() - kCaptureSpeed;
    }
    /// What a slow slip still lacks to be a fast one.
    static double lacking(const Slip& now) { return 2.0 * kCaptureSpeed - now.size(); }
    /// The longest step, s. Where a fast slip ends its friction has no direction, so that a step
    /// which leaps over the end is rejected again and again. acceleration: m/s^2.
    static double longest_step(const Slip& now, const Slip& acceleration) {
        constexpr double kMost = 0.7;  // of the time to the end; measured
        const double change = now.along * acceleration.along + now.across * acceleration.across;
        return !kSlow && change < 0.0 ? kMost * now.size() * now.size() / -change
                                      : std::numeric_limits<double>::infinity();
    }

private:
    static Heading way_of(const Slip& slip) {
        const double speed = slip.size();
        return speed > 0.0 ? Heading{slip.along / speed, slip.across / speed} : Heading{};
    }

    Slip begin_;
    Heading way_;
};

class PlanePhase {
public:
    using Real = double;
    static constexpr bool kTurns = true;

    explicit PlanePhase(PlaneDynamics& plane) : plane_(&plane) {}

    /// What the slip of the summary is counted along.
    void set_front(double heading) { front_ = Heading::of_angle(heading); }

    SpatialExpansion field_at(double tau) const { return plane_->field().at(tau); }
    bool outside() const { return plane_->field().outside(); }
    double reach() const { return plane_->field().reach(); }
    double min_time_constant() const { return plane_->field().min_time_constant(); }
    double event_rounding() const { return 0.0; }

    /// With the field's expansion, to look elsewhere and come back.
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
        const Pose pose = upright().pose(angle);
        const Heading& h = plane_->watch().state().heading;
        plane_->field().rebase({x - (pose.lever - pose.roll) * h.cosine,
                                y - (pose.lever - pose.roll) * h.sine, pose.height});
    }
    /// (x, y): of the middle of a face.
    void rebase_to_face(double x, double y) {
        plane_->field().rebase({x, y, upright().pose(0.0).height});
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

    /// Of a vector of the world, along the front.
    double along_front(double x, double y) const { return front_.cosine * x + front_.sine * y; }

    PlaneDynamics* plane_;
    Heading front_;
};

}  // namespace stickslip
