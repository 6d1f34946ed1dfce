#include "stickslip/dynamics.hpp"

#include <array>
#include <cmath>

namespace stickslip {

namespace {

constexpr double kStale = 1000.0;  // turns of a base pose that is of another quadrant

}  // namespace

Dynamics::Dynamics(const Model& model, LocalField field)
    : model_(&model), field_(std::move(field)), extended_(model.has_force_effects()) {
    robot_.mass = model.mass;
    robot_.per_mass = 1.0 / model.mass;
    robot_.inertia = model.inertia;
    robot_.per_inertia = 1.0 / model.inertia;
    robot_.per_corner_inertia = 1.0 / model.corner_inertia();
    robot_.weight_x = model.mass * model.gravity_x;
    robot_.weight_z = model.mass * model.gravity_z;
    robot_.drag = model.translational_drag;
    robot_.turning_drag = model.rotational_drag_linear;
    robot_.turning_drag_quadratic = model.rotational_drag_quadratic;
    robot_.adhesion = model.adhesion.strength;
    robot_.static_friction = model.friction.static_coefficient;
    robot_.kinetic_friction = model.friction.kinetic_coefficient;
    robot_.radius = model.shape.radius();
    set_quadrant(0);
}

void Dynamics::set_quadrant(int quadrant) {
    if (quadrant == quadrant_) return;
    quadrant_ = quadrant;
    turn_ = QuarterTurns(quadrant);
    const Model& m = *model_;
    const double c = std::cos(m.misalignment), s = std::sin(m.misalignment);
    robot_.base.turns = kStale;
    robot_.half_base = m.shape.half_base(quadrant);
    robot_.half_rise = m.shape.half_rise(quadrant);
    robot_.moment_cosine = m.moment * (turn_.cosine * c - turn_.sine * s);
    robot_.moment_sine = m.moment * (turn_.sine * c + turn_.cosine * s);
}

void Dynamics::extend(const Expansion& expansion, const PlanarField& field, double mx, double mz,
                      const Pose& pose, double vx, double vz, Load& load) const {
    const Model& m = *model_;
    const double cosine = turn_.cosine * pose.cosine - turn_.sine * pose.sine;
    const double sine = turn_.sine * pose.cosine + turn_.cosine * pose.sine;
    const double drag = m.translational_drag * m.angle_drag * cosine * cosine +
                        m.translational_drag_quadratic * std::hypot(vx, vz);
    load.fx += m.gradient_excess * (mx * field.dbx_dx + mz * field.dbx_dz) - drag * vx;
    load.fz += m.gradient_excess * (mx * field.dbx_dz + mz * field.dbz_dz) - drag * vz;
    load.contact_adhesion = m.adhesion.of_contact(sine, age_ + expansion.tau);
}

void Dynamics::add_user_effects(double tau, const PlanarField& field, double x, double z,
                                const Pose& pose, double vx, double vz, double omega,
                                Load& load) const {
    const double sign = model_->frame_sign;
    // The pose has lost its whole turns, which a body in flight may have made within its quadrant.
    constexpr double kTurn = 4.0 * kQuarterTurn;
    double angle = std::atan2(pose.sine, pose.cosine);
    const double off = robot_.base.angle - angle;
    if (std::abs(off) > 0.5 * kTurn) angle += kTurn * std::round(off / kTurn);
    const std::array<double, WrenchState::kSize> state = {
        start_ + tau, sign * x,        z,       angle + quadrant_ * kQuarterTurn, sign * vx, vz,
        omega,        sign * field.bx, field.bz};
    for (const UserSetting& each : model_->user_effects) {
        std::array<double, 3> wrench = {};
        each.effect->function(state.data(), each.values.data(), wrench.data());
        if (!std::isfinite(wrench[0]) || !std::isfinite(wrench[1]) || !std::isfinite(wrench[2])) {
            throw WrenchNotFinite(each.effect->name, state[0]);
        }
        load.fx += sign * wrench[0];
        load.fz += wrench[1];
        load.torque += wrench[2];
    }
}

void Dynamics::add_ranged_adhesion(double tau, const Pose& pose, double gap, Load& load) const {
    const Adhesion& adhesion = model_->adhesion;
    const double base = 2.0 * model_->shape.half_base(quadrant_);
    const double rise = 2.0 * model_->shape.half_rise(quadrant_);
    // Gap and lever of the pivot, the corners behind and ahead of it, and the one opposite.
    const double along_base = base * pose.cosine, up_base = base * pose.sine;
    const double along_rise = rise * pose.sine, up_rise = rise * pose.cosine;
    const std::array<double, 4> gaps = {gap, gap + up_base, gap + up_rise, gap + up_base + up_rise};
    const std::array<double, 4> levers = {pose.lever, pose.lever - along_base,
                                          pose.lever + along_rise,
                                          pose.lever - along_base + along_rise};
    std::array<double, 4> weights;
    for (std::size_t i = 0; i < 4; ++i) weights[i] = adhesion.weight(gaps[i]);
    const Adhesion::Shares shares = Adhesion::shares(weights);

    const bool flies = gap > 0.0;
    const double age = flies ? 0.0 : age_ + tau;  // what is not in contact does not age
    const double sine = turn_.sine * pose.cosine + turn_.cosine * pose.sine;
    const double cosine = turn_.cosine * pose.cosine - turn_.sine * pose.sine;
    const double strength = adhesion.of_contact(sine, age);
    load.contact_adhesion = flies ? 0.0 : strength * shares.pull[0];
    for (std::size_t i = flies ? 0 : 1; i < 4; ++i) {
        const double pull = strength * shares.pull[i];
        load.fz -= pull;
        load.torque += levers[i] * pull;
    }
    load.torque += adhesion.slope_of_contact(sine, cosine, age) * adhesion.range * shares.energy;
}

}  // namespace stickslip
