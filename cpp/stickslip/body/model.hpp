#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "stickslip/body/adhesion.hpp"
#include "stickslip/body/contact_place.hpp"
#include "stickslip/body/friction.hpp"
#include "stickslip/body/rectangle.hpp"
#include "stickslip/body/user_effect.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/field_shape.hpp"
#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

/// What multiplies the fluid's drag.
struct DragShape {
    FreeCurve angle;  ///< of the tilt, effect `free_drag_angle`: of the force
    FreeCurve speed;  ///< of the centre of mass, effect `free_drag_speed`: of the force
    FreeCurve rate;   ///< of the tilt, effect `free_drag_rate`: of the force and of the torque

    bool absent() const { return angle.absent() && speed.absent() && rate.absent(); }
};

/// A face that lies on the surface, from the centre of mass.
struct Face {
    double half_base = 0.0;  ///< m
    double shift = 0.0;      ///< m, of its middle, to +x
    double height = 0.0;     ///< m, of the centre of mass above it
    double roll = 0.0;       ///< m, as of the pose of its end

    /// m, of its end ahead, to +x of the centre of mass.
    double end() const { return half_base + shift; }
};

/// The mechanical constants of one simulation, in the robot's own frame (its x axis points the way
/// that the moment does at theta = 0), with all named effects already in their places.
struct Model {
    Rectangle shape{0.0, 0.0};
    ContactPlace place;
    double width = 0.0;         ///< m, across the plane of motion
    double mass = 0.0;          ///< kg
    double inertia = 0.0;       ///< kg m^2 about the centre of mass
    double moment = 0.0;        ///< A m^2
    double misalignment = 0.0;  ///< rad, from the body's x axis to the moment, nose-down positive
    double gravity_x = 0.0;     ///< m/s^2, along the surface
    double gravity_z = 0.0;     ///< m/s^2, negative
    double gradient_excess = 0.0;     ///< -, part by which the magnetic force is larger
    double translational_drag = 0.0;  ///< N s/m, Eq. (18)
    double angle_drag = 0.0;          ///< -, the drag grows by this factor times cos^2 theta
    double translational_drag_quadratic = 0.0;  ///< N s^2/m^2
    double rotational_drag_linear = 0.0;        ///< N m s, linear
    double rotational_drag_quadratic = 0.0;     ///< N m s^2, Eq. (19)
    DragShape drag_shape;
    FieldShape field_shape;
    FrictionLaw friction;
    Adhesion adhesion;
    double restitution = 0.0;
    double tangential_restitution = 0.0;
    double frame_sign = 1.0;                ///< world x = frame sign times the robot's x
    std::vector<UserSetting> user_effects;  ///< that are not absent

    /// Whether a named effect acts on the forces between events.
    bool has_force_effects() const {
        return gradient_excess != 0.0 || angle_drag != 0.0 || translational_drag_quadratic != 0.0 ||
               !drag_shape.absent() || !adhesion.is_constant() || !user_effects.empty();
    }

    /// Whether the named effects between events are all among the SmoothEffects.
    bool is_smooth() const {
        return !adhesion.has_free_shape() && !friction.has_free_shape() && drag_shape.absent() &&
               field_shape.absent() && place.absent() && user_effects.empty();
    }

    /// Shortest time (s) over which a free shape may change the forces while nothing moves.
    double least_time() const {
        const double field = field_shape.time.absent() ? std::numeric_limits<double>::infinity()
                                                       : field_shape.time.spacing();
        return std::min({friction.least_time(), adhesion.least_time(), field});
    }

    /// Angular frequency (rad/s) at which the body, touching nothing, rocks in a field of `tesla`.
    double rocking_rate(double tesla) const { return std::sqrt(moment * tesla / inertia); }

    /// Inertia about a corner of the rectangle, J + m r^2.
    double corner_inertia() const { return inertia + mass * shape.radius() * shape.radius(); }

    /// The pivot at an angle in a quadrant, where it touches.
    Pose pose(int quadrant, double angle) const {
        Pose result = shape.pose(quadrant, std::cos(angle), std::sin(angle));
        place_contact(quadrant, angle, result);
        return result;
    }
    /// Puts the contact of a pose of the rectangle where it is.
    void place_contact(int quadrant, double angle, Pose& pose) const {
        pose.angle = angle;
        if (place.absent()) return;
        const PlaceShift shift = place.at(quadrant * kQuarterTurn + angle);
        pose.lever += shift.lever;
        pose.height += shift.height;
        pose.roll = shift.roll;
        pose.bend = shift.bend;
    }
    Face face(int quadrant) const {
        const PlaceShift shift = place.at(quadrant * kQuarterTurn);
        return {shape.half_base(quadrant), shift.lever, shape.half_rise(quadrant) + shift.height,
                shift.roll};
    }
};

}  // namespace stickslip
