#pragma once

#include <array>
#include <limits>
#include <type_traits>

#include "stickslip/contact/dynamics.hpp"
#include "stickslip/field/heading.hpp"

namespace stickslip {

/// Below this approach speed (m/s) a touch-down does not rebound and a rocking face comes to rest;
/// a corner that separates faster takes no impulse and leaves; a slip along a vector that slows
/// down to it sticks if static friction can hold it.
/// It ends the infinite sequences of ever smaller impacts; the energy it removes, m v^2/2 of a 25
/// ug robot, is 1e-20 J, a billionth of its weight times its height.
inline constexpr double kCaptureSpeed = 1e-6;

/// Part of the body on the surface: none, the quadrant's lowest corner, or the face of which that
/// corner is the front end (at angle 0).
enum class Touch { none, corner, face };

/// The contact mode is state: for 0 < N < adhesion both contact and flight are consistent, so it is
/// never derived again from the gap.
struct ContactMode {
    Touch touch = Touch::face;
    int slip = 0;  ///< 0 sticks, +1 slips to +x, -1 to -x

    friend bool operator==(const ContactMode&, const ContactMode&) = default;
};

/// State carried from phase to phase.
struct HybridState {
    BodyState body;
    ContactMode mode;
    double contact_x = 0.0;      ///< m, pivot corner; kept, not derived, so that a stuck one stays
    double slip_velocity = 0.0;  ///< m/s
    // The same along y, for a robot that moves in the whole plane.
    double contact_y = 0.0;  ///< m
    double slip_y = 0.0;     ///< m/s
    InnerState inner = {};

    bool rests() const { return mode.touch == Touch::face && mode.slip == 0; }
};

/// Reaction at the touching corner(s). N is compressive, before adhesion; friction along +x, in N.
template <class Real>
struct ReactionOf {
    Real normal = 0.0;
    Real friction = 0.0;
};
using Reaction = ReactionOf<double>;

/// State, reaction and contact at an instant, for a recording.
struct Sample {
    BodyState body;
    Reaction reaction;
    double contact_x = std::numeric_limits<double>::quiet_NaN();      ///< m, of the pivot corner
    double slip_velocity = std::numeric_limits<double>::quiet_NaN();  ///< m/s, of the pivot corner
    // For a run in the whole plane: y of the pivot; friction and slip to the left of the heading,
    // while those above are along it.
    double contact_y = std::numeric_limits<double>::quiet_NaN();    ///< m
    double friction_across = 0.0;                                   ///< N
    double slip_across = std::numeric_limits<double>::quiet_NaN();  ///< m/s
    InnerState inner = {};
};

/// A corner that neither slips nor leaves: the paper's case 3, Eqs. (10)-(14) with P fixed.
template <class Real>
struct CornerStickOf {
    Real angular_acceleration;  ///< rad/s^2
    ReactionOf<Real> reaction;
};
using CornerStick = CornerStickOf<double>;

/// Moment of a load about the touching corner, N m.
template <class Real>
[[gnu::always_inline]] inline Real moment_about_corner(const PoseOf<Real>& pose,
                                                       const LoadOf<Real>& load) {
    return load.torque + fma(pose.height, load.fx, pose.lever_arm * load.fz);
}

/// Reaction at a corner that stays where it is while the body turns about it, alpha in rad/s^2. The
/// normal force of a corner that slips along the surface is the same.
template <class Real>
[[gnu::always_inline]] inline ReactionOf<Real> pivot_reaction(const PlainDynamics<Real>& robot,
                                                              const PoseOf<Real>& pose, Real omega,
                                                              Real alpha,
                                                              const LoadOf<Real>& load) {
    const Real ww = omega * omega;
    const Real ax = fma(alpha, pose.height, ww * pose.lever_arm);
    const Real az = fnma(ww, pose.height - pose.curvature_radius, alpha * pose.lever_arm);
    return {fma(robot.mass, az, load.contact_adhesion - load.fz), fma(robot.mass, ax, -load.fx)};
}

/// Acceleration (m/s^2) of the centre of mass of a body whose pivot on the surface has one along
/// it.
inline std::array<double, 2> centre_acceleration(const Pose& pose, double slip, double omega,
                                                 double alpha) {
    const double ww = omega * omega;
    return {slip + alpha * pose.height + ww * pose.lever_arm,
            alpha * pose.lever_arm - ww * (pose.height - pose.curvature_radius)};
}

/// Moment of inertia about the contact point, kg m^2.
inline double pivot_inertia(double inertia, double mass, const Pose& pose) {
    return inertia + mass * (pose.lever_arm * pose.lever_arm + pose.height * pose.height);
}

/// Angular acceleration (rad/s^2) of a contact that does not slip: of one that rolls too, whose
/// inertia about the pivot changes with the angle.
template <class Real>
[[gnu::always_inline]] inline Real stuck_acceleration(const PlainDynamics<Real>& robot,
                                                      const PoseOf<Real>& pose, Real omega,
                                                      const LoadOf<Real>& load) {
    const Real moment = moment_about_corner(pose, load);
    if constexpr (std::is_same_v<Real, double>) {
        if (pose.rolled_distance != 0.0 || pose.curvature_radius != 0.0) {
            const double extra =
                robot.mass * pose.lever_arm * pose.curvature_radius * omega * omega;
            return (moment - extra) / pivot_inertia(robot.inertia, robot.mass, pose);
        }
    }
    return moment * robot.per_corner_inertia;
}

template <class Real>
[[gnu::always_inline]] inline CornerStickOf<Real> corner_stick(const PlainDynamics<Real>& robot,
                                                               const PoseOf<Real>& pose, Real omega,
                                                               const LoadOf<Real>& load) {
    const Real alpha = stuck_acceleration(robot, pose, omega, load);
    return {alpha, pivot_reaction(robot, pose, omega, alpha, load)};
}

/// A corner that slips with friction -coefficient N, where `coefficient` carries the sign of the
/// slip: the paper's case 2.
template <class Real>
struct CornerSlipOf {
    Real angular_acceleration;  ///< rad/s^2
    Real slip_acceleration;     ///< m/s^2, of the corner along x
    Real normal;                ///< N
    /// J + m lever (lever - coefficient height), kg m^2: a normal force that lifts the corner. At
    /// or below zero sliding has no solution or two (Painleve).
    Real effective_inertia;
    Real coefficient;  ///< that it was asked for
};
using CornerSlip = CornerSlipOf<double>;

template <class Real>
inline Real painleve_inertia(const PlainDynamics<Real>& robot, const PoseOf<Real>& pose,
                             Real coefficient) {
    return fma(robot.mass * pose.lever_arm, fnma(coefficient, pose.height, pose.lever_arm),
               robot.inertia);
}

template <class Real>
[[gnu::always_inline]] inline CornerSlipOf<Real> corner_slip(const PlainDynamics<Real>& robot,
                                                             const PoseOf<Real>& pose, Real omega,
                                                             const LoadOf<Real>& load,
                                                             Real coefficient) {
    const Real ww = omega * omega;
    const Real adhesion = load.contact_adhesion;
    const Real arm = fnma(coefficient, pose.height, pose.lever_arm);
    const Real effective = painleve_inertia(robot, pose, coefficient);
    const Real rest =
        fnma(robot.mass * ww, pose.height - pose.curvature_radius, adhesion - load.fz);
    const Real per_effective = 1.0 / effective;  // computed while the load is on its way
    const Real alpha = (load.torque + fnma(arm, rest, pose.lever_arm * adhesion)) * per_effective;
    const Real normal = fma(robot.mass * pose.lever_arm, alpha, rest);
    const Real ax = fnma(coefficient, normal, load.fx) * robot.per_mass;
    return {alpha, fnma(ww, pose.lever_arm, fnma(alpha, pose.height, ax)), normal, effective,
            coefficient};
}

/// A face that lies on the surface. `ahead` is its end at +half_base (the quadrant's own corner),
/// `behind` the other.
struct FaceReaction {
    double ahead, behind;  ///< N, compressive
    double friction;       ///< N, of both together

    double normal() const { return ahead + behind; }
};

/// coefficient: signed as above for a slipping face; `sticks`: friction is what holds it.
inline FaceReaction face_reaction(const Model& model, int quadrant, const Load& load, bool sticks,
                                  double coefficient) {
    const double normal = load.contact_adhesion - load.fz;
    const double friction = sticks ? -load.fx : -coefficient * normal;
    const Face face = model.face(quadrant);
    const double tilt =
        (load.torque - face.height * friction + face.shift * load.fz) / (2.0 * face.half_base);
    return {0.5 * normal + tilt, 0.5 * normal - tilt, friction};
}

/// Outcome of asking which mode is consistent with the forces.
struct Resolution {
    ContactMode mode;
    int quadrant = 0;      ///< a tipping face may pivot about its other end
    bool impulse = false;  ///< sliding has no solution: the slip stops by an impulse (Painleve)
    Slip slip = {};        ///< m/s; along a vector of the least size where it has only begun
};

/// The consistent mode of what touches now, at tau seconds into the segment, by the complementarity
/// conditions of section IV-C. `body` has the world's place and the velocities along the heading
/// and across, as the `slip` (m/s) has. Where that is zero, or as slow as not to matter, the
/// contact is tried as sticking, unless `onset` (+1, -1) says that an event has just broken it
/// loose, and of a frame that is fixed which way: there the sign of an acceleration that is zero to
/// rounding decides nothing. For both frames, see frame.hpp.
template <class Frame>
Resolution resolve_contact(const Frame& frame, double tau, const BodyState& body, Touch touch,
                           const Slip& slip, int onset);

/// Puts the slip of a touching corner to zero by an impulse at that corner (impulse without
/// collision).
void stop_slip_by_impulse(const Model& model, const Pose& pose, double slip_velocity,
                          BodyState& body);

/// Pivot-corner velocity along x, m/s.
inline double corner_velocity_x(const Pose& pose, double vx, double omega) {
    return vx - omega * pose.height;
}
/// Pivot-corner velocity along z, m/s.
inline double corner_velocity_z(const Pose& pose, double vz, double omega) {
    return vz - omega * pose.lever_arm;
}

}  // namespace stickslip
