#pragma once

#include <array>
#include <cmath>

#include "stickslip/contact/dynamics.hpp"
#include "stickslip/contact/heading_watch.hpp"
#include "stickslip/field/expansion.hpp"
#include "stickslip/field/heading.hpp"

/// A robot whose plane of motion turns with the field (docs/theory/steering.md). It faces the way
/// of the horizontal field, so that in the upright plane of that heading the planar equations hold.
/// Across it the centre of mass has a force and a velocity, which friction shares: a contact slips
/// along a vector. Roll, and the effects of turning on the motion, are left out.
namespace stickslip {

/// Field and gradient at a place, along the robot's heading and across.
struct HeadedField {
    Heading heading;
    double horizontal = 0.0;  ///< T
    PlanarField along;
    double across_s = 0.0, across_z = 0.0;  ///< T/m, dB_s/dn and dB_z/dn
};

/// The load along the heading, and the force across it.
struct PlaneLoad : Load {
    double across = 0.0;  ///< N, to the left
};

/// Dynamics of the robot between two events: those in its upright plane, and the field that turns
/// that plane.
class PlaneDynamics {
public:
    /// weight: components in the surface, N.
    PlaneDynamics(Dynamics& upright, SpatialField field, const std::array<double, 2>& weight);

    /// A copy that looks elsewhere, with the copy of its upright dynamics.
    PlaneDynamics(const PlaneDynamics& other, Dynamics& upright) : PlaneDynamics(other) {
        upright_ = &upright;
    }

    Dynamics& upright() const { return *upright_; }
    SpatialField& field() { return field_; }
    const SpatialField& field() const { return field_; }

    /// The field as a robot at a place feels it, which faces the way of the horizontal field, or
    /// while that is too weak to turn it as it did before.
    HeadedField headed(const SpatialExpansion& field, double x, double y, double z) const {
        const SpatialFieldValue b = field(x, y, z);
        HeadedField result;
        result.horizontal = std::sqrt(b.bx * b.bx + b.by * b.by);
        result.heading = heading_in(b, result.horizontal);
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
        const auto& t = field.terms;
        const double horizontal = std::sqrt(t[0] * t[0] + t[1] * t[1]);
        // Also of a trial state beyond the event at which the field becomes weak.
        const bool is_held = watch_.state().is_weak || !(horizontal > watch_.weak_field());
        const Heading near =
            is_held ? watch_.state().heading : near_heading(field, 1.0 / horizontal, x, y);
        const double behind = pose.place();
        return headed(field, x - behind * near.cosine, y - behind * near.sine, pose.height);
    }

    /// Forces but those of touching corners. velocity: of the centre of mass along and across, m/s.
    PlaneLoad load(const HeadedField& field, double tau, const Pose& pose, const Slip& velocity,
                   double vz, double omega) const {
        // Effects of a user, which alone ask for the place, do not come here.
        PlaneLoad result = {upright_->load(field.along, tau, 0.0, 0.0, pose, velocity.along, vz,
                                           omega, velocity.across)};
        const PlainDynamics<double>& robot = upright_->robot();
        const Slip weight = field.heading.seen(weight_[0], weight_[1]);
        result.fx += weight.along;
        const double pull =
            robot.moment_x(pose) * field.across_s + robot.moment_z(pose) * field.across_z;
        result.across = robot.pull * pull + weight.across - result.drag * velocity.across;
        return result;
    }

    /// The way of the field at a place.
    Facing facing(const SpatialExpansion& field, const Place& at) const {
        const SpatialFieldValue b = std::apply(field, at);
        return facing(b.bx, b.by);
    }
    /// The same in the middle of the expansion, which is near the robot: enough for how fast the
    /// field turns.
    Facing facing(const SpatialExpansion& field) const {
        return facing(field.terms[0], field.terms[1]);
    }
    HeadingWatch& watch() { return watch_; }
    const HeadingWatch& watch() const { return watch_; }

private:
    Facing facing(double bx, double by) const {
        const double horizontal = std::sqrt(bx * bx + by * by);
        if (!(horizontal > 0.0)) return {watch_.state().heading, 0.0};
        return {{bx / horizontal, by / horizontal}, horizontal};
    }
    /// Heading of the field at (x, y) m, to first order about the centre of the expansion. per: the
    /// inverse of the horizontal field's magnitude at the centre, 1/T.
    static Heading near_heading(const SpatialExpansion& field, double per, double x, double y) {
        const double dx = x - field.centre[0], dy = y - field.centre[1];
        const auto& t = field.terms;
        const double bx = t[0] + (t[3] * dx + t[4] * dy), by = t[1] + (t[4] * dx + t[5] * dy);
        // One over the size, from that in the middle by one step of Newton's.
        const double scale = per * (1.5 - 0.5 * (bx * bx + by * by) * (per * per));
        return {bx * scale, by * scale};
    }
    Heading heading_in(const SpatialFieldValue& b, double horizontal) const {
        if (watch_.state().is_weak || !(horizontal > 0.0)) return watch_.state().heading;
        return {b.bx / horizontal, b.by / horizontal};
    }
    Dynamics* upright_;
    SpatialField field_;
    std::array<double, 2> weight_;
    HeadingWatch watch_;
};

}  // namespace stickslip
