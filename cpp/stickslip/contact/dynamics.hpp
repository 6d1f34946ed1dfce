#pragma once

#include <cmath>
#include <limits>

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
    Real drag = 0.0;              ///< N s/m, force of the fluid over the velocity
};
using Load = LoadOf<double>;

/// The constants of a robot in one quadrant, without laws.
template <class Real>
struct PlainDynamics {
    Real mass, per_mass;                        ///< kg, 1/kg
    Real inertia, per_inertia;                  ///< kg m^2, 1/(kg m^2)
    Real per_corner_inertia;                    ///< 1/(kg m^2), of J + m r^2
    Real weight_x, weight_z;                    ///< N
    Real pull;                                  ///< -, factor on the magnetic force
    Real drag;                                  ///< N s/m, Eq. (18)
    Real turning_drag, turning_drag_quadratic;  ///< N m s, N m s^2, Eq. (19)
    Real adhesion;                              ///< N
    Real static_friction, kinetic_friction;
    Real radius, half_base, half_rise;  ///< m
    Real middle_lever, middle_height;   ///< m, of the pose in the middle of the quadrant
    // Components of the magnetic moment along the body's axes, A m^2.
    Real moment_cosine = 0.0, moment_sine = 0.0;

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(mass, per_mass, inertia, per_inertia, per_corner_inertia, weight_x,
                        weight_z, pull, drag, turning_drag, turning_drag_quadratic, adhesion,
                        static_friction, kinetic_friction, radius, half_base, half_rise,
                        middle_lever, middle_height, moment_cosine, moment_sine);
    }

    /// Pose at an angle (rad), by a rotation from the middle of the quadrant. With the cosine
    /// rounded so, it is exact at the ends.
    [[gnu::always_inline]] PoseOf<Real> pose(Real angle) const {
        constexpr double kEighthTurn = 0.5 * kQuarterTurn, kCosineEighth = 0.7071067811865475;
        const CosineAndSine<Real> on = cosine_and_sine(angle - kEighthTurn);
        return {kCosineEighth * (on.cosine - on.sine),
                kCosineEighth * (on.cosine + on.sine),
                fnma(middle_height, on.sine, middle_lever * on.cosine),
                fma(middle_lever, on.sine, middle_height * on.cosine),
                0.0,
                0.0,
                angle};
    }

    /// Magnet, weight and drag, Eqs. (8)-(12), (18), (19). across: m/s, of the centre of mass
    /// across the plane of motion. laws: a Laws, or nothing, which stands for a pull of one too.
    template <class... Some>
    [[gnu::always_inline]] LoadOf<Real> load(const PlanarFieldOf<Real>& field,
                                             [[maybe_unused]] Real tau, const PoseOf<Real>& pose,
                                             Real vx, Real vz, Real omega,
                                             [[maybe_unused]] Real across,
                                             const Some&... laws) const {
        // The field at the robot's place is known last.
        const Real mx = moment_x(pose), mz = moment_z(pose);
        // NOLINTNEXTLINE(misc-const-correctness): laws change them.
        typename Laws<Real>::Forces forces = {
            adhesion, drag, fma(turning_drag_quadratic, magnitude(omega), turning_drag)};
        ((forces =
              laws.forces(forces, pose, tau, fma(vx, vx, fma(vz, vz, across * across)), omega)),
         ...);
        Real px = mx, pz = mz;
        if constexpr (sizeof...(laws) > 0) {
            px = pull * mx;
            pz = pull * mz;
        }
        LoadOf<Real> load;
        load.fx = fma(px, field.dbx_dx, fma(pz, field.dbx_dz, fnma(forces.drag, vx, weight_x)));
        load.fz = fma(px, field.dbx_dz, fma(pz, field.dbz_dz, fnma(forces.drag, vz, weight_z)));
        load.torque = fnma(mx, field.bz, fma(mz, field.bx, -(forces.rotational_drag * omega)));
        load.contact_adhesion = forces.adhesion;
        load.drag = forces.drag;
        return load;
    }
    [[gnu::always_inline]] Real moment_x(const PoseOf<Real>& pose) const {
        return fnma(moment_sine, pose.sine, moment_cosine * pose.cosine);
    }
    [[gnu::always_inline]] Real moment_z(const PoseOf<Real>& pose) const {
        return -fma(moment_cosine, pose.sine, moment_sine * pose.cosine);
    }
};

/// Dynamics of the robot between two events: the model, the field about the robot, the quadrant.
class Dynamics {
public:
    using Real = double;

    Dynamics(const Model& model, const LocalField& field);
    Dynamics(const Model&&, const LocalField&) = delete;  // the model has to outlive this

    const Model& model() const { return *model_; }
    const PlainDynamics<double>& robot() const { return robot_; }
    LocalField& field() { return field_; }
    const LocalField& field() const { return field_; }
    /// The field where the surface has carried the robot's coordinates.
    Expansion field_at(double tau) const {
        Expansion result = field_.at(tau);
        if (is_shaken_) [[unlikely]] {
            const SurfaceMotion surface = surface_at(tau);
            result.centre[0] -= surface.x;
            result.centre[1] -= surface.z;
        }
        return result;
    }
    SurfaceMotion surface_at(double tau) const {
        return model_->shake.at(now_.start + tau, now_.start + inside_);
    }
    /// Place (m) on or above the surface in the frame of the ground, in which the coils rest.
    PlaceOf<double, 2> in_ground(double tau, const PlaceOf<double, 2>& place) const {
        if (!is_shaken_) return place;
        const SurfaceMotion surface = surface_at(tau);
        return {place[0] + surface.x, place[1] + surface.z};
    }
    int quadrant() const { return quadrant_; }

    /// Sets the state of the inner mass, if there is one.
    void set_inner(const InnerState& inner) { inner_ = inner; }
    /// Force of the inner mass on the stop that it rests on, N, from the last `move_with`.
    double push() const { return push_; }
    /// Calls `move`, which computes a motion of the body by its loads and returns the acceleration
    /// of its centre of mass against the surface, until the push on the stop keeps an inner mass
    /// there that rests on it.
    template <class Move>
    void move_with(double tau, const Pose& pose, Move&& move) {
        push_ = 0.0;
        // In any motion but one whose friction depends on the load the second is right.
        constexpr int kMost = 8;
        double last = 0.0, step = 0.0;
        for (int n = 0; n < kMost; ++n) {
            const auto [ax, az] = move();
            if (inner_.stop == 0) return;
            const double towards = inner_.stop * inner_acceleration(tau, pose, ax, az);
            if (n == 0) {
                step = model_->inner.mass * towards;  // of a body that does not move
            } else {
                step *= towards / (last - towards);
            }
            last = towards;
            constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
            if (!(std::abs(step) > kRounding * std::abs(push_))) return;
            push_ += step;
        }
    }
    /// Acceleration of the inner mass relative to the body, whose centre of mass has the
    /// acceleration (ax, az) relative to the surface, m/s^2.
    double inner_acceleration(double tau, const Pose& pose, double ax, double az) const;

    void set_quadrant(int quadrant);

    /// Begins a segment of voltage with the centre of mass at (x, z) m. The field is computed
    /// there; nothing is kept of the segment before.
    void begin_segment(const CurrentSegment& segment, double x, double z) {
        now_.start = segment.start;
        inside_ = 0.5 * segment.duration;
        field_.begin_segment(segment, in_ground(0.0, {x, z}));
    }

    /// Whether the formulas of a PlainDynamics are all there is to it.
    bool is_plain() const { return has_plain_load_ && model_->fits_kernels(); }
    const LawMoment<double>& law_moment() const { return now_; }

    /// Time (s) since the start of the run at which the segment begins.
    void set_start(double time) { now_.start = time; }
    double start() const { return now_.start; }

    /// Age of the contact at the start of the segment, s; negative for one that is made later.
    void set_contact_age(double age) { now_.contact_age = age; }
    double contact_age() const { return now_.contact_age; }

    [[gnu::always_inline]] Pose pose(double angle) const {
        Pose result = robot_.pose(angle);
        model_->place_contact(quadrant_, angle, result);
        return result;
    }

    /// Coefficient up to which a contact sticks that presses with `normal` N at x (m); `tau`: s,
    /// in the segment.
    double static_limit(double slip_sign, double x, const Pose& pose, double normal,
                        double tau) const {
        return directional(static_coefficient(x, pose, normal, tau), slip_sign);
    }
    /// The same in two parts, of which the first holds for both directions.
    double static_coefficient(double x, const Pose& pose, double normal, double tau) const {
        if (has_no_law_) return robot_.static_friction;
        return lawful_static(x, pose, normal, tau);
    }
    double directional(double coefficient, double slip_sign) const {
        return has_no_law_ ? coefficient : laws().directional(coefficient, slip_sign);
    }
    /// Kinetic friction coefficient of a corner that slips at `slip_velocity` (m/s).
    double kinetic(double slip_sign, double slip_velocity, double x, const Pose& pose,
                   double normal, double tau) const {
        if (has_no_law_) return robot_.kinetic_friction;
        return laws().load_dependent(kinetic_coefficient(slip_sign, slip_velocity, x, pose, tau),
                                     normal);
    }
    /// The same of a corner that slips under `load`, whose normal force follows from the
    /// coefficient itself.
    double corner_kinetic(double slip_sign, double slip_velocity, double x, const Pose& pose,
                          double omega, const Load& load, double tau) const {
        if (has_no_law_) return robot_.kinetic_friction;
        const double coefficient = kinetic_coefficient(slip_sign, slip_velocity, x, pose, tau);
        if (!model_->laws.has(Quantity::friction_by_load)) return coefficient;
        return load_dependent_kinetic(coefficient, slip_sign, pose, omega, load);
    }

    /// Forces of everything but the reaction of touching corners.
    [[gnu::always_inline]] Load load(const Expansion& field, double x, double z, const Pose& pose,
                                     double vx, double vz, double omega) const {
        return load(field(x, z), field.tau, x, z, pose, vx, vz, omega);
    }
    /// tau: s, in the segment. across: m/s, of the centre of mass.
    [[gnu::always_inline]] Load load(const PlanarField& field, double tau, double x, double z,
                                     const Pose& pose, double vx, double vz, double omega,
                                     double across = 0.0) const {
        if (has_plain_load_) [[likely]]
            return robot_.load(field, tau, pose, vx, vz, omega, across);
        return extended_load(field, tau, x, z, pose, vx, vz, omega, across);
    }

private:
    Laws<double> laws() const { return {model_->laws.table(), model_->laws.numbers(), now_}; }
    // Apart, so that a model without laws pays one test.
    double lawful_static(double x, const Pose& pose, double normal, double tau) const;
    double kinetic_coefficient(double slip_sign, double slip_velocity, double x, const Pose& pose,
                               double tau) const;
    double load_dependent_kinetic(double coefficient, double slip_sign, const Pose& pose,
                                  double omega, const Load& load) const;
    Load extended_load(const PlanarField& field, double tau, double x, double z, const Pose& pose,
                       double vx, double vz, double omega, double across) const;
    // Adds force and torque of a user's effects to `load`; throws WrenchNotFinite.
    void add_user_effects(double tau, const PlanarField& field, double x, double z,
                          const Pose& pose, double vx, double vz, double omega, Load& load) const;

    const Model* model_;
    LocalField field_;
    // Force on the inner mass along its line, N, and the unit vector of the line.
    struct InnerPull {
        double force, x, z;
    };
    InnerPull inner_pull(double tau, const Pose& pose) const;

    bool is_shaken_, has_no_law_, has_plain_load_;
    static constexpr int kNoQuadrant = 1 << 30;

    int quadrant_ = kNoQuadrant;
    LawMoment<double> now_;
    InnerState inner_;
    double push_ = 0.0;    // N
    double inside_ = 0.0;  // s, of the segment, away from the kinks of a shake at its ends
    PlainDynamics<double> robot_;
};

}  // namespace stickslip
