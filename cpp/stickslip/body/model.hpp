#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "stickslip/body/contact_place.hpp"
#include "stickslip/body/inner_mass.hpp"
#include "stickslip/body/laws.hpp"
#include "stickslip/body/rectangle.hpp"
#include "stickslip/body/robot_frame.hpp"
#include "stickslip/body/user_effect.hpp"
#include "stickslip/drive/shake.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/field_shape.hpp"

namespace stickslip {

/// Coulomb's coefficients.
struct Friction {
    double static_coefficient = 0.0, kinetic_coefficient = 0.0;
};

/// A face that lies on the surface, from the centre of mass.
struct Face {
    double half_base = 0.0;        ///< m
    double shift = 0.0;            ///< m, of its middle, to +x
    double height = 0.0;           ///< m, of the centre of mass above it
    double rolled_distance = 0.0;  ///< m, as of the pose of its end

    /// x (m) from the centre of mass of its end ahead, and of the point that stays if it sticks.
    double end() const { return half_base + shift; }
    double place() const { return end() - rolled_distance; }
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
    double gradient_excess = 0.0;            ///< -, part by which the magnetic force is larger
    double translational_drag = 0.0;         ///< N s/m, Eq. (18)
    double rotational_drag_linear = 0.0;     ///< N m s, linear
    double rotational_drag_quadratic = 0.0;  ///< N m s^2, Eq. (19)
    FieldShape field_shape;
    Shake shake;  ///< of the surface, in which the robot's x and z are
    InnerMass inner;
    Friction friction;
    /// Adhesion to the surface, N; the touching corners share it equally.
    double adhesion = 0.0;
    LawSet laws;  ///< how friction, adhesion and drag depend on the motion
    double restitution = 0.0;
    double tangential_restitution = 0.0;
    RobotFrame frame;
    std::vector<UserSetting> user_effects;  ///< that are not absent

    /// Whether the formulas of a PlainDynamics and laws are all there is to it, as kernels ask.
    bool fits_kernels() const {
        return !laws.has(Quantity::friction_by_load) && field_shape.absent() && place.absent() &&
               user_effects.empty() && shake.absent() && inner.absent();
    }

    /// Shortest time (s) over which laws and free shapes may change the forces while nothing moves.
    double least_time() const {
        const double field = field_shape.time.absent() ? std::numeric_limits<double>::infinity()
                                                       : field_shape.time.spacing();
        return std::min(laws.least_time(), field);
    }

    /// Normal force on the surface at rest, adhesion included, without field and shake, N.
    double pressing() const { return -(mass + inner.mass) * gravity_z + adhesion; }

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
        pose.lever_arm += shift.lever_arm;
        pose.height += shift.height;
        pose.rolled_distance = shift.rolled_distance;
        pose.curvature_radius = shift.curvature_radius;
    }
    Face face(int quadrant) const {
        const PlaceShift shift = place.at(quadrant * kQuarterTurn);
        return {shape.half_base(quadrant), shift.lever_arm,
                shape.half_rise(quadrant) + shift.height, shift.rolled_distance};
    }
};

}  // namespace stickslip
