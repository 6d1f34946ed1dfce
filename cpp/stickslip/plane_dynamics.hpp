#pragma once

#include <array>
#include <cmath>

#include "stickslip/dynamics.hpp"
#include "stickslip/spatial_field.hpp"

/// A robot whose plane of motion turns with the field (docs/theory/steering.md). It faces the way
/// of the horizontal field, so that in the upright plane of that heading the planar equations hold.
/// What is across is a force and a velocity of the centre of mass, which friction shares: a contact
/// slips along a vector. Roll, and what turning adds to the motion, are left out.
namespace stickslip {

/// A vector in the surface: along the heading and to its left.
struct Slip {
    double along = 0.0, across = 0.0;

    double size() const { return std::sqrt(along * along + across * across); }
};

/// The way that a robot faces.
struct Heading {
    double cosine = 1.0, sine = 0.0;

    static Heading of_angle(double angle) { return {std::cos(angle), std::sin(angle)}; }
    double angle() const { return std::atan2(sine, cosine); }
    /// Of a vector of the world; and back.
    Slip seen(double x, double y) const { return {cosine * x + sine * y, cosine * y - sine * x}; }
    double x(const Slip& v) const { return cosine * v.along - sine * v.across; }
    double y(const Slip& v) const { return sine * v.along + cosine * v.across; }
};

/// What a robot at a place in the field feels, along its heading and across.
struct HeadedField {
    Heading heading;
    PlanarField along;
    double across_s = 0.0, across_z = 0.0;  ///< T/m, dB_s/dn and dB_z/dn
};

/// The load along, and the force to the left of the heading, N.
struct PlaneLoad {
    Load along;
    double across = 0.0;
};

/// What is known of the robot between two events: the dynamics in its upright plane, and the field
/// that turns that plane.
class PlaneDynamics {
public:
    /// weight: components in the surface, N. least_slip: m/s, a contact that slips no faster
    /// sticks, or is about to slip.
    PlaneDynamics(Dynamics& upright, SpatialField field, const std::array<double, 2>& weight,
                  double least_slip);

    /// A copy that looks elsewhere, with the copy of its upright dynamics.
    PlaneDynamics(const PlaneDynamics& other, Dynamics& upright) : PlaneDynamics(other) {
        upright_ = &upright;
    }

    Dynamics& upright() const { return *upright_; }
    SpatialField& field() { return field_; }
    const SpatialField& field() const { return field_; }
    double least_slip() const { return least_slip_; }
    /// Slip velocities, m/s, at which a slip that loses speed counts as slow, and one that gains it
    /// no longer does. A direction follows the force within v / (mu g), which at these is about the
    /// time of a step.
    double slow_slip() const { return kSlowSlip; }
    double quick_slip() const { return 2.0 * kSlowSlip; }

    /// The field as a robot at a place feels it, which faces the way of the horizontal field, or
    /// the last one where that is too weak to turn it.
    HeadedField headed(const SpatialExpansion& field, double x, double y, double z) const {
        const SpatialFieldValue b = field(x, y, z);
        const double horizontal = std::sqrt(b.bx * b.bx + b.by * b.by);
        HeadedField result;
        result.heading =
            horizontal > weak_field_ ? Heading{b.bx / horizontal, b.by / horizontal} : heading_;
        const Heading h = result.heading;
        const double cc = h.cosine * h.cosine, ss = h.sine * h.sine, cs = h.cosine * h.sine;
        result.along = {h.cosine * b.bx + h.sine * b.by, b.bz,
                        (cc * b.xx + ss * b.yy) + 2.0 * cs * b.xy, h.cosine * b.xz + h.sine * b.yz,
                        b.zz()};
        result.across_s = cs * (b.yy - b.xx) + (cc - ss) * b.xy;
        result.across_z = h.cosine * b.yz - h.sine * b.xz;
        return result;
    }
    /// The same of a robot whose pivot corner is on the surface at (x, y) m. The centre of mass
    /// lies behind the corner, in the heading that is sought; the corner's own heading is within a
    /// milliradian or two of it, so that one step from there leaves a part in a million.
    HeadedField headed_at_corner(const SpatialExpansion& field, double x, double y,
                                 const Pose& pose) const {
        const Heading near = field.horizontal > weak_field_ ? near_heading(field, x, y) : heading_;
        const double behind = pose.lever - pose.roll;
        return headed(field, x - behind * near.cosine, y - behind * near.sine, pose.height);
    }

    /// Forces but those of touching corners. velocity: of the centre of mass along and across, m/s.
    /// gap: of the pivot corner, m, 0 in contact.
    PlaneLoad load(const HeadedField& field, double tau, const Pose& pose, const Slip& velocity,
                   double vz, double omega, double gap) const {
        // Effects of a user, which alone ask for the place, do not come here.
        const Load along = upright_->load_near_surface(field.along, tau, 0.0, 0.0, pose,
                                                       velocity.along, vz, omega, gap);
        return complete(along, field, pose, velocity, vz, omega);
    }
    /// The same of a body that lies on a face and slides, or does not.
    PlaneLoad load_of_face(const HeadedField& field, double tau, const Pose& pose,
                           const Slip& velocity) const {
        const Load along =
            upright_->load(field.along, tau, 0.0, 0.0, pose, velocity.along, 0.0, 0.0);
        return complete(along, field, pose, velocity, 0.0, 0.0);
    }

    /// Deceleration of a slip by friction, m/s^2, about.
    double braking() const { return braking_; }
    /// Horizontal field (T) below which spin friction may hold the robot more than two degrees off
    /// it.
    double weak_field() const { return weak_field_; }
    void set_heading(const Heading& heading) { heading_ = heading; }
    /// At the last instant that was looked at, see `follow`.
    const Heading& last_heading() const { return heading_; }

    /// Follows the heading of a robot at a place from the last instant that was looked at to `tau`,
    /// over a stretch of voltage in which the field does not jump.
    void follow(double tau, const Place& place);
    /// Begins a stretch, at whose start the field is that of the end of the last one.
    void begin_stretch() { followed_ = 0.0; }
    /// Whether the field was weak and came back from another side, so that nobody knows where the
    /// robot faces.
    bool has_lost_heading() const { return lost_; }
    /// Largest angle (rad) by which the heading lagged behind the field, in the linear motion of
    /// yaw that the field's stiffness gives: the rate of turning over the yaw's own frequency.
    double largest_lag() const { return largest_lag_; }
    /// Angle by which the heading has turned to and fro so far, rad.
    double turned() const { return turned_; }
    /// Of a lag beyond which the robot does not follow, rad. Chosen: at a tenth the response of an
    /// undamped oscillator to a ramp still stays within the two degrees of a weak field on average.
    static constexpr double kMostTurning = 0.2;

    /// What goes on from stretch to stretch.
    struct Memory {
        SpatialField::Memory field;
        Heading heading;
        bool was_weak = true, was_strong = false;
        double largest_lag = 0.0;  ///< rad
    };
    Memory memory() const {
        return {field_.memory(), heading_, was_weak_, was_strong_, largest_lag_};
    }
    void restore(const Memory& memory) {
        field_.restore(memory.field);
        heading_ = memory.heading;
        was_weak_ = memory.was_weak;
        was_strong_ = memory.was_strong;
        largest_lag_ = memory.largest_lag;
        lost_ = false;
    }

private:
    /// Of the field at (x, y) m to first order about the middle of the expansion.
    static Heading near_heading(const SpatialExpansion& field, double x, double y) {
        const double dx = x - field.centre.x, dy = y - field.centre.y;
        const auto& t = field.terms;
        const double bx = t[0] + (t[3] * dx + t[4] * dy), by = t[1] + (t[4] * dx + t[6] * dy);
        // One over the size, from that in the middle by one step of Newton's.
        const double per = 1.0 / field.horizontal;
        const double scale = per * (1.5 - 0.5 * (bx * bx + by * by) * (per * per));
        return {bx * scale, by * scale};
    }
    void look(double tau, const Place& place);
    /// What a load in the upright plane lacks.
    PlaneLoad complete(const Load& along, const HeadedField& field, const Pose& pose,
                       const Slip& velocity, double vz, double omega) const {
        const PlainDynamics<double>& robot = upright_->robot();
        PlaneLoad result = {along};
        double drag = robot.drag;
        if (extended_) drag = correct_drag(pose, velocity, vz, omega, result.along);
        const Slip weight = field.heading.seen(weight_[0], weight_[1]);
        result.along.fx += weight.along;
        const double pull =
            robot.moment_x(pose) * field.across_s + robot.moment_z(pose) * field.across_z;
        result.across = gradient_scale_ * pull + weight.across - drag * velocity.across;
        return result;
    }
    /// Of a load whose drag knows nothing of the velocity across; the drag over the velocity.
    double correct_drag(const Pose& pose, const Slip& velocity, double vz, double omega,
                        Load& load) const;

    static constexpr double kSlowSlip = 3e-5;  // m/s

    Dynamics* upright_;
    SpatialField field_;
    std::array<double, 2> weight_;
    double least_slip_;
    double weak_field_;
    double braking_;
    double gradient_scale_;
    double yaw_inertia_;
    bool extended_;
    bool lost_ = false, was_weak_ = true, was_strong_ = false;
    double followed_ = 0.0;  // s, in the stretch
    double largest_lag_ = 0.0, turned_ = 0.0;
    Heading heading_;  // while the field is weak
};

}  // namespace stickslip
