#include "stickslip/contact/dynamics.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace stickslip {

Dynamics::Dynamics(const Model& model, const LocalField& field)
    : model_(&model),
      field_(field),
      forces_{model.gradient_excess, model.translational_drag * model.angle_drag,
              model.translational_drag_quadratic},
      extended_(model.has_force_effects()) {
    if (!model.field_shape.absent()) field_.set_shape(model.field_shape);
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
    robot_.radius = model.shape.radius() + model.place.reach();
    set_quadrant(0);
}

void Dynamics::set_quadrant(int quadrant) {
    if (quadrant == quadrant_) return;
    quadrant_ = quadrant;
    turn_ = QuarterTurns(quadrant);
    const Model& m = *model_;
    const double c = std::cos(m.misalignment), s = std::sin(m.misalignment);
    robot_.half_base = m.shape.half_base(quadrant);
    robot_.half_rise = m.shape.half_rise(quadrant);
    const Pose middle = m.shape.pose(quadrant, std::sqrt(0.5), std::sqrt(0.5));
    robot_.middle_lever = middle.lever;
    robot_.middle_height = middle.height;
    robot_.moment_cosine = m.moment * (turn_.cosine * c - turn_.sine * s);
    robot_.moment_sine = m.moment * (turn_.sine * c + turn_.cosine * s);
}

void Dynamics::extend(double tau, const PlanarField& field, double mx, double mz, const Pose& pose,
                      double vx, double vz, double omega, Load& load) const {
    const Model& m = *model_;
    const double cosine = cosine_of_tilt(pose), sine = sine_of_tilt(pose);
    const double drag = forces_.add(field, mx, mz, cosine, vx, vz, load);
    load.contact_adhesion = m.adhesion.of_contact(sine, cosine, age_ + tau);
    if (!m.drag_shape.absent()) {
        shape_drag(sine, cosine, vx, vz, omega, m.translational_drag + drag, load);
    }
}

// drag: N s/m, of the force that the load has already.
void Dynamics::shape_drag(double sine, double cosine, double vx, double vz, double omega,
                          double drag, Load& load) const {
    const DragShape& shape = model_->drag_shape;
    const double rate = shape.rate.factor(std::abs(omega));
    const double speed = shape.speed.absent() ? 0.0 : std::hypot(vx, vz);
    const double force =
        shape.angle.factor_at_angle(sine, cosine) * shape.speed.factor(speed) * rate;
    load.fx -= (force - 1.0) * drag * vx;
    load.fz -= (force - 1.0) * drag * vz;
    const double turning = robot_.turning_drag + robot_.turning_drag_quadratic * std::abs(omega);
    load.torque -= (rate - 1.0) * turning * omega;
}

double Dynamics::drag_coefficient(const Pose& pose, double speed, double omega) const {
    const double cosine = cosine_of_tilt(pose);
    const double drag =
        robot_.drag + forces_.angle_drag * cosine * cosine + forces_.quadratic_drag * speed;
    const DragShape& shape = model_->drag_shape;
    if (shape.absent()) return drag;
    return drag * shape.angle.factor_at_angle(sine_of_tilt(pose), cosine) *
           shape.speed.factor(speed) * shape.rate.factor(std::abs(omega));
}

double Dynamics::extended_static_limit(double slip, double x, const Pose& pose, double normal,
                                       double tau) const {
    return model_->friction.static_limit(slip, contact_point(x, pose, normal, tau));
}

double Dynamics::extended_kinetic(double slip, double slip_velocity, double x, const Pose& pose,
                                  double normal, double tau) const {
    return model_->friction.kinetic(slip, slip_velocity, contact_point(x, pose, normal, tau));
}

// The normal force N of a corner that slips is A / (B - C mu(N)), with A, B and C from
// `corner_slip`, so that N (B - C mu(N)) - A is looked for zero: it is negative at N = 0, and its
// zero is followed by Newton's method between bounds that close in on it. Where there is none the
// sliding has no solution, which `corner_slip` finds for the coefficient of the largest loads. Only
// a curve so steep that C (N mu(N))' exceeds B has more than one.
double Dynamics::extended_corner_kinetic(double slip, double slip_velocity, double x,
                                         const Pose& pose, double omega, const Load& load,
                                         double tau) const {
    const FrictionLaw& law = model_->friction;
    const ContactPoint at = contact_point(x, pose, 0.0, tau);
    const double coefficient = law.kinetic_of_no_load(slip, slip_velocity, at);
    const FreeCurve& curve = law.load();
    if (curve.absent()) return coefficient;
    const PlainDynamics<double>& r = robot_;
    const double rest =
        load.contact_adhesion - r.mass * omega * omega * (pose.height - pose.bend) - load.fz;
    const double a =
        r.mass * pose.lever * (load.torque + pose.lever * load.contact_adhesion) + r.inertia * rest;
    const double b = r.inertia + r.mass * pose.lever * pose.lever;
    const double c = slip * r.mass * pose.lever * pose.height;
    if (!(a > 0.0)) return coefficient * curve.factor(0.0);
    const auto residual = [&](double normal) {
        return normal * (b - c * coefficient * curve.factor(normal)) - a;
    };
    constexpr int kMostRises = 100, kMostIterations = 100;
    constexpr double kRise = 1.25;  // not to pass over the least of several zeros
    double low = 0.0, high = a / b;
    for (int n = 0; residual(high) < 0.0; ++n) {
        if (n == kMostRises) return coefficient * curve.factor(high);
        low = high;
        high *= kRise;
    }
    double normal = high;
    for (int n = 0; n < kMostIterations; ++n) {
        const double value = residual(normal);
        (value < 0.0 ? low : high) = normal;
        const double slope =
            b - c * coefficient * (curve.factor(normal) + normal * curve.factor_slope(normal));
        const double step = value / slope;
        if (std::abs(step) <= 4.0 * std::numeric_limits<double>::epsilon() * normal) break;
        const double next = normal - step;
        normal = next > low && next < high ? next : 0.5 * (low + high);
    }
    return coefficient * curve.factor(normal);
}

void Dynamics::add_user_effects(double tau, const PlanarField& field, double x, double z,
                                const Pose& pose, double vx, double vz, double omega,
                                Load& load) const {
    const double sign = model_->frame_sign;
    const std::array<double, WrenchState::kSize> state = {
        start_ + tau,    sign * x, z, pose.angle + quadrant_ * kQuarterTurn, sign * vx, vz, omega,
        sign * field.bx, field.bz};
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

}  // namespace stickslip
