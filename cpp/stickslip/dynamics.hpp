#pragma once

#include <cmath>

#include "stickslip/local_field.hpp"
#include "stickslip/model.hpp"

namespace stickslip {

/// Position and velocity of the robot. The angle is theta = quadrant pi/2 + angle.
struct BodyState {
    double x = 0.0, z = 0.0;    ///< m, centre of mass
    double angle = 0.0;         ///< rad, within the quadrant
    double vx = 0.0, vz = 0.0;  ///< m/s
    double omega = 0.0;         ///< rad/s
    int quadrant = 0;

    double theta() const { return angle + quadrant * kQuarterTurn; }
};

/// Forces at the centre of mass other than those of touching corners.
struct Load {
    double fx = 0.0, fz = 0.0;      ///< N
    double torque = 0.0;            ///< N m about +y
    double contact_adhesion = 0.0;  ///< N, adhesion of whatever touches
};

/// What is known of the robot between two events: the model, the field about the robot, the
/// quadrant. Angles are handled relative to a base angle, so that the inner stages need no sine and
/// cosine.
class Dynamics {
public:
    Dynamics(const Model& model, LocalField field)
        : model_(&model), field_(std::move(field)), extended_(model.has_force_effects()) {
        set_quadrant(0);
    }
    Dynamics(const Model&&, LocalField) = delete;  // the model has to outlive this

    const Model& model() const { return *model_; }
    LocalField& field() { return field_; }
    const LocalField& field() const { return field_; }
    Expansion field_at(double tau) const { return field_.at(tau); }
    int quadrant() const { return quadrant_; }

    void set_quadrant(int quadrant) {
        if (quadrant == quadrant_) return;
        quadrant_ = quadrant;
        turns_ = kStale;
        const QuarterTurns turn(quadrant);
        const double c = std::cos(model_->misalignment), s = std::sin(model_->misalignment);
        moment_cosine_ = model_->moment * (turn.cosine * c - turn.sine * s);
        moment_sine_ = model_->moment * (turn.sine * c + turn.cosine * s);
        turn_ = turn;
    }

    /// Takes `angle` as the base of the next step; the robot's pose there.
    Pose rebase_angle(double angle) {
        // Turning the last base on is quicker than sine and cosine; rounding adds up over few
        // turns.
        constexpr int kMostTurns = 32;
        if (++turns_ < kMostTurns && std::abs(angle - base_angle_) < 0.125) {
            base_pose_ = pose(angle);
        } else {
            base_pose_ = model_->shape.pose(quadrant_, std::cos(angle), std::sin(angle));
            turns_ = 0;
        }
        base_angle_ = angle;
        return base_pose_;
    }
    void rebase_field(double tau, double x, double z) { field_.rebase(tau, x, z); }

    /// Time (s) since the start of the run at which the stretch begins.
    void set_start(double time) { start_ = time; }

    /// Age of the contact at the start of the stretch, s; negative for one that is made later.
    void set_contact_age(double age) { age_ = age; }
    double contact_age() const { return age_; }

    [[gnu::always_inline]] inline Pose pose(double angle) const;

    /// Magnet, weight and drag, Eqs. (8)-(12), (18), (19).
    [[gnu::always_inline]] inline Load load(const Expansion& field, double x, double z,
                                            const Pose& pose, double vx, double vz,
                                            double omega) const;

    /// The same with the adhesion of corners that are near but do not touch, where it has a range.
    /// `gap`: height of the pivot corner above the surface in m, 0 in contact.
    [[gnu::always_inline]] Load load_near_surface(const Expansion& field, double x, double z,
                                                  const Pose& pose, double vx, double vz,
                                                  double omega, double gap) const {
        Load result = load(field, x, z, pose, vx, vz, omega);
        if (model_->adhesion.range > 0.0) add_ranged_adhesion(field.tau, pose, gap, result);
        return result;
    }

private:
    /// What named effects add; apart, so that a model without them pays one test.
    void extend(const Expansion& expansion, const PlanarField& field, double mx, double mz,
                const Pose& pose, double vx, double vz, Load& load) const;
    /// The same of a user's effects; throws WrenchNotFinite.
    void add_user_effects(double tau, const PlanarField& field, double x, double z,
                          const Pose& pose, double vx, double vz, double omega, Load& load) const;
    void add_ranged_adhesion(double tau, const Pose& pose, double gap, Load& load) const;

    const Model* model_;
    LocalField field_;
    bool extended_;
    static constexpr int kNoQuadrant = 1 << 30;
    static constexpr int kStale = 1000;  // in `turns_`: the base pose is of another quadrant

    int quadrant_ = kNoQuadrant;
    QuarterTurns turn_{0};
    double moment_cosine_ = 0.0, moment_sine_ = 0.0;
    double age_ = 0.0;
    double start_ = 0.0;
    double base_angle_ = 0.0;
    int turns_ = kStale;
    Pose base_pose_;
};

inline Pose Dynamics::pose(double angle) const {
    const double d = angle - base_angle_;
    const double dd = d * d;
    if (!(dd < 0.015625)) return base_pose_.turned(std::cos(d), std::sin(d));
    // Series whose next terms are below 3e-16 at |d| = 1/8, summed in pairs for the processor to
    // overlap.
    const double dddd = dd * dd;
    const double c =
        (1.0 - dd * (1.0 / 2)) + dddd * ((1.0 / 24 - dd * (1.0 / 720)) + dddd * (1.0 / 40320));
    const double s = d * ((1.0 - dd * (1.0 / 6)) +
                          dddd * ((1.0 / 120 - dd * (1.0 / 5040)) + dddd * (1.0 / 362880)));
    return base_pose_.turned(c, s);
}

inline Load Dynamics::load(const Expansion& expansion, double x, double z, const Pose& pose,
                           double vx, double vz, double omega) const {
    const Model& m = *model_;
    const PlanarField field = expansion(x, z);
    const double mx = moment_cosine_ * pose.cosine - moment_sine_ * pose.sine;
    const double mz = -(moment_sine_ * pose.cosine + moment_cosine_ * pose.sine);
    Load load;
    load.fx =
        mx * field.dbx_dx + mz * field.dbx_dz + m.mass * m.gravity_x - m.translational_drag * vx;
    load.fz =
        mx * field.dbx_dz + mz * field.dbz_dz + m.mass * m.gravity_z - m.translational_drag * vz;
    const double turning_drag =
        (m.rotational_drag_linear + m.rotational_drag_quadratic * std::abs(omega)) * omega;
    load.torque = (mz * field.bx - turning_drag) - mx * field.bz;
    load.contact_adhesion = m.adhesion.strength;
    if (extended_) {
        extend(expansion, field, mx, mz, pose, vx, vz, load);
        if (!m.user_effects.empty()) {
            add_user_effects(expansion.tau, field, x, z, pose, vx, vz, omega, load);
        }
    }
    return load;
}

}  // namespace stickslip
