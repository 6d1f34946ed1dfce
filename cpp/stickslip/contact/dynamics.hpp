#pragma once

#include <cmath>

#include "stickslip/body/model.hpp"
#include "stickslip/field/expansion.hpp"

namespace stickslip {

/// Position and velocity of the robot. The angle is theta = quadrant pi/2 + angle. What is across
/// the plane of motion stays zero in a run that has one plane (plane_dynamics.hpp).
struct BodyState {
    double x = 0.0, z = 0.0;    ///< m, centre of mass
    double angle = 0.0;         ///< rad, within the quadrant
    double vx = 0.0, vz = 0.0;  ///< m/s
    double omega = 0.0;         ///< rad/s
    int quadrant = 0;
    double y = 0.0;        ///< m
    double vy = 0.0;       ///< m/s
    double heading = 0.0;  ///< rad, from the x axis to the way that the robot faces

    double theta() const { return angle + quadrant * kQuarterTurn; }
};

/// Forces at the centre of mass other than those of touching corners.
template <class Real>
struct LoadOf {
    Real fx = 0.0, fz = 0.0;      ///< N
    Real torque = 0.0;            ///< N m about +y
    Real contact_adhesion = 0.0;  ///< N, adhesion of whatever touches
};
using Load = LoadOf<double>;

/// The constants of a robot in one quadrant, without named effects.
template <class Real>
struct PlainDynamics {
    Real mass, per_mass;                        ///< kg, 1/kg
    Real inertia, per_inertia;                  ///< kg m^2, 1/(kg m^2)
    Real per_corner_inertia;                    ///< 1/(kg m^2), of J + m r^2
    Real weight_x, weight_z;                    ///< N
    Real drag;                                  ///< N s/m, Eq. (18)
    Real turning_drag, turning_drag_quadratic;  ///< N m s, N m s^2, Eq. (19)
    Real adhesion;                              ///< N
    Real static_friction, kinetic_friction;
    Real radius, half_base, half_rise;  ///< m
    Real middle_lever, middle_height;   ///< m, of the pose in the middle of the quadrant
    // Of the magnetic moment along the body's axes, A m^2.
    Real moment_cosine = 0.0, moment_sine = 0.0;

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(mass, per_mass, inertia, per_inertia, per_corner_inertia, weight_x,
                        weight_z, drag, turning_drag, turning_drag_quadratic, adhesion,
                        static_friction, kinetic_friction, radius, half_base, half_rise,
                        middle_lever, middle_height, moment_cosine, moment_sine);
    }

    /// By that in the middle of the quadrant, turned on. Its ends are exact with the cosine rounded
    /// so.
    [[gnu::always_inline]] PoseOf<Real> pose(Real angle) const {
        constexpr double kEighthTurn = 0.5 * kQuarterTurn, kCosineEighth = 0.7071067811865475;
        const CosineAndSine<Real> on = cosine_and_sine(angle - kEighthTurn);
        return {kCosineEighth * (on.cosine - on.sine), kCosineEighth * (on.cosine + on.sine),
                fnma(middle_height, on.sine, middle_lever * on.cosine),
                fma(middle_lever, on.sine, middle_height * on.cosine)};
    }

    /// Magnet, weight and drag, Eqs. (8)-(12), (18), (19).
    [[gnu::always_inline]] LoadOf<Real> load(const PlanarFieldOf<Real>& field, Real mx, Real mz,
                                             Real vx, Real vz, Real omega) const {
        // The field at the robot's place is known last.
        const Real turning = fma(turning_drag_quadratic, magnitude(omega), turning_drag) * omega;
        LoadOf<Real> load;
        load.fx = fma(mx, field.dbx_dx, fma(mz, field.dbx_dz, fnma(drag, vx, weight_x)));
        load.fz = fma(mx, field.dbx_dz, fma(mz, field.dbz_dz, fnma(drag, vz, weight_z)));
        load.torque = fnma(mx, field.bz, fma(mz, field.bx, -turning));
        load.contact_adhesion = adhesion;
        return load;
    }
    [[gnu::always_inline]] Real moment_x(const PoseOf<Real>& pose) const {
        return fnma(moment_sine, pose.sine, moment_cosine * pose.cosine);
    }
    [[gnu::always_inline]] Real moment_z(const PoseOf<Real>& pose) const {
        return -fma(moment_cosine, pose.sine, moment_sine * pose.cosine);
    }
};

/// What is known of the robot between two events: the model, the field about the robot, the
/// quadrant.
class Dynamics {
public:
    using Real = double;

    Dynamics(const Model& model, const LocalField& field);
    Dynamics(const Model&&, const LocalField&) = delete;  // the model has to outlive this

    const Model& model() const { return *model_; }
    const PlainDynamics<double>& robot() const { return robot_; }
    LocalField& field() { return field_; }
    const LocalField& field() const { return field_; }
    Expansion field_at(double tau) const { return field_.at(tau); }
    int quadrant() const { return quadrant_; }

    void set_quadrant(int quadrant);

    /// Begins a segment of voltage with the centre of mass at (x, z) m. The field is computed
    /// there; nothing is kept of the segment before.
    void begin_segment(const CurrentSegment& segment, double x, double z) {
        start_ = segment.start;
        field_.begin_segment(segment, {x, z});
    }

    void rebase_field(double x, double z) { field_.rebase({x, z}); }

    /// Whether the formulas of a PlainDynamics are all there is to it.
    bool is_plain() const {
        return !extended_ && model_->friction.is_plain() && model_->is_smooth();
    }
    /// The effects of a model that `is_smooth`.
    SmoothEffects<double> smooth_effects() const {
        return {
            forces_, model_->adhesion.smooth, model_->friction.smooth(), turn_.sine, turn_.cosine,
            age_};
    }

    /// Time (s) since the start of the run at which the segment begins.
    void set_start(double time) { start_ = time; }
    double start() const { return start_; }

    /// Age of the contact at the start of the segment, s; negative for one that is made later.
    void set_contact_age(double age) { age_ = age; }
    double contact_age() const { return age_; }

    [[gnu::always_inline]] Pose pose(double angle) const {
        Pose result = robot_.pose(angle);
        model_->place_contact(quadrant_, angle, result);
        return result;
    }

    /// Coefficient up to which a contact sticks that presses with `normal` N at x (m); `tau`: s,
    /// in the segment.
    double static_limit(double slip, double x, const Pose& pose, double normal, double tau) const {
        const FrictionLaw& law = model_->friction;
        if (law.is_plain()) return law.static_coefficient;
        return extended_static_limit(slip, x, pose, normal, tau);
    }
    /// The same of one that slips at `slip_velocity` (m/s).
    double kinetic(double slip, double slip_velocity, double x, const Pose& pose, double normal,
                   double tau) const {
        const FrictionLaw& law = model_->friction;
        if (law.is_plain()) return law.kinetic_coefficient;
        return extended_kinetic(slip, slip_velocity, x, pose, normal, tau);
    }
    /// The same of a corner that slips under `load`, whose normal force follows from the
    /// coefficient itself.
    double corner_kinetic(double slip, double slip_velocity, double x, const Pose& pose,
                          double omega, const Load& load, double tau) const {
        const FrictionLaw& law = model_->friction;
        if (law.is_plain()) return law.kinetic_coefficient;
        return extended_corner_kinetic(slip, slip_velocity, x, pose, omega, load, tau);
    }

    /// Forces of everything but the reaction of touching corners.
    [[gnu::always_inline]] Load load(const Expansion& field, double x, double z, const Pose& pose,
                                     double vx, double vz, double omega) const {
        return load(field(x, z), field.tau, x, z, pose, vx, vz, omega);
    }
    /// tau: s, in the segment.
    [[gnu::always_inline]] inline Load load(const PlanarField& field, double tau, double x,
                                            double z, const Pose& pose, double vx, double vz,
                                            double omega) const;

    /// Drag force over the velocity, N s/m, of a body that moves at `speed` m/s.
    double drag_coefficient(const Pose& pose, double speed, double omega) const;

private:
    /// What named effects add; apart, so that a model without them pays one test.
    void extend(double tau, const PlanarField& field, double mx, double mz, const Pose& pose,
                double vx, double vz, double omega, Load& load) const;
    void shape_drag(double sine, double cosine, double vx, double vz, double omega, double drag,
                    Load& load) const;
    /// The same of a user's effects; throws WrenchNotFinite.
    void add_user_effects(double tau, const PlanarField& field, double x, double z,
                          const Pose& pose, double vx, double vz, double omega, Load& load) const;
    // Of friction that is not plain; apart for the same reason.
    double extended_static_limit(double slip, double x, const Pose& pose, double normal,
                                 double tau) const;
    double extended_kinetic(double slip, double slip_velocity, double x, const Pose& pose,
                            double normal, double tau) const;
    double extended_corner_kinetic(double slip, double slip_velocity, double x, const Pose& pose,
                                   double omega, const Load& load, double tau) const;
    double sine_of_tilt(const Pose& pose) const {
        return turn_.sine * pose.cosine + turn_.cosine * pose.sine;
    }
    double cosine_of_tilt(const Pose& pose) const {
        return turn_.cosine * pose.cosine - turn_.sine * pose.sine;
    }
    ContactPoint contact_point(double x, const Pose& pose, double normal, double tau) const {
        return {x, sine_of_tilt(pose), cosine_of_tilt(pose), normal, start_ + tau};
    }

    const Model* model_;
    LocalField field_;
    SmoothForces<double> forces_;
    bool extended_;
    static constexpr int kNoQuadrant = 1 << 30;

    int quadrant_ = kNoQuadrant;
    QuarterTurns turn_{0};
    double age_ = 0.0;
    double start_ = 0.0;
    PlainDynamics<double> robot_;
};

inline Load Dynamics::load(const PlanarField& field, double tau, double x, double z,
                           const Pose& pose, double vx, double vz, double omega) const {
    const double mx = robot_.moment_x(pose), mz = robot_.moment_z(pose);
    Load load = robot_.load(field, mx, mz, vx, vz, omega);
    if (extended_) {
        extend(tau, field, mx, mz, pose, vx, vz, omega, load);
        if (!model_->user_effects.empty()) {
            add_user_effects(tau, field, x, z, pose, vx, vz, omega, load);
        }
    }
    return load;
}

}  // namespace stickslip
