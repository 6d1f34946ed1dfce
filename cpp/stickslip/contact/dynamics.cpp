#include "stickslip/contact/dynamics.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace stickslip {

Dynamics::Dynamics(const Model& model, const LocalField& field)
    : model_(&model),
      field_(field),
      is_shaken_(!model.shake.absent()),
      has_no_law_(model.laws.empty()),
      has_plain_load_(model.laws.empty() && model.gradient_excess == 0.0 &&
                      model.user_effects.empty() && !is_shaken_ && model.inner.absent()) {
    if (!model.field_shape.absent()) field_.set_shape(model.field_shape);
    robot_.mass = model.mass;
    robot_.per_mass = 1.0 / model.mass;
    robot_.inertia = model.inertia;
    robot_.per_inertia = 1.0 / model.inertia;
    robot_.per_corner_inertia = 1.0 / model.corner_inertia();
    robot_.weight_x = model.mass * model.gravity_x;
    robot_.weight_z = model.mass * model.gravity_z;
    robot_.pull = 1.0 + model.gradient_excess;
    robot_.drag = model.translational_drag;
    robot_.turning_drag = model.rotational_drag_linear;
    robot_.turning_drag_quadratic = model.rotational_drag_quadratic;
    robot_.adhesion = model.adhesion;
    robot_.static_friction = model.friction.static_coefficient;
    robot_.kinetic_friction = model.friction.kinetic_coefficient;
    robot_.radius = model.shape.radius() + model.place.reach();
    set_quadrant(0);
}

void Dynamics::set_quadrant(int quadrant) {
    if (quadrant == quadrant_) return;
    quadrant_ = quadrant;
    const QuarterTurns turn(quadrant);
    now_.turn = (((quadrant + 2) & 3) - 2) * kQuarterTurn;
    now_.turn_sine = turn.sine;
    now_.turn_cosine = turn.cosine;
    const Model& m = *model_;
    const double c = std::cos(m.misalignment), s = std::sin(m.misalignment);
    robot_.half_base = m.shape.half_base(quadrant);
    robot_.half_rise = m.shape.half_rise(quadrant);
    const Pose middle = m.shape.pose(quadrant, std::sqrt(0.5), std::sqrt(0.5));
    robot_.middle_lever = middle.lever_arm;
    robot_.middle_height = middle.height;
    robot_.moment_cosine = m.moment * (turn.cosine * c - turn.sine * s);
    robot_.moment_sine = m.moment * (turn.sine * c + turn.cosine * s);
}

double Dynamics::lawful_static(double x, const Pose& pose, double normal, double tau) const {
    const double free = laws().static_coefficient(robot_.static_friction, x, pose, tau);
    return laws().load_dependent(free, normal);
}

double Dynamics::kinetic_coefficient(double slip_sign, double slip_velocity, double x,
                                     const Pose& pose, double tau) const {
    return laws().kinetic_coefficient(robot_.kinetic_friction, slip_sign, slip_velocity, x, pose,
                                      tau);
}

Load Dynamics::extended_load(const PlanarField& field, double tau, double x, double z,
                             const Pose& pose, double vx, double vz, double omega,
                             double across) const {
    SurfaceMotion surface;
    if (is_shaken_) surface = surface_at(tau);
    const bool flows = is_shaken_ && !model_->shake.carries_liquid();
    Load load = robot_.load(field, tau, pose, flows ? vx + surface.vx : vx,
                            flows ? vz + surface.vz : vz, omega, across, laws());
    if (is_shaken_) {  // the surface's own acceleration is a weight that changes
        load.fx -= robot_.mass * surface.ax;
        load.fz -= robot_.mass * surface.az;
    }
    if (!model_->inner.absent()) {
        const InnerPull pull = inner_pull(tau, pose);
        const double gx = model_->gravity_x - surface.ax, gz = model_->gravity_z - surface.az;
        const double along = gx * pull.x + gz * pull.z, mass = model_->inner.mass;
        load.fx += mass * (gx - along * pull.x) - pull.force * pull.x;
        load.fz += mass * (gz - along * pull.z) - pull.force * pull.z;
    }
    if (!model_->user_effects.empty()) {
        add_user_effects(tau, field, x + surface.x, z + surface.z, pose, vx + surface.vx,
                         vz + surface.vz, omega, load);
    }
    return load;
}

Dynamics::InnerPull Dynamics::inner_pull(double tau, const Pose& pose) const {
    const double cosine = now_.turn_cosine * pose.cosine - now_.turn_sine * pose.sine;
    const double sine = now_.turn_sine * pose.cosine + now_.turn_cosine * pose.sine;
    const double c = std::cos(model_->inner.direction), s = std::sin(model_->inner.direction);
    const double force = model_->inner.force(inner_, now_.start + tau, now_.start + inside_);
    return {force - inner_.stop * push_, cosine * c - sine * s, -(sine * c + cosine * s)};
}

// The body carries the force across the line: there the mass has weight, but no inertia of its own.
double Dynamics::inner_acceleration(double tau, const Pose& pose, double ax, double az) const {
    const InnerPull pull = inner_pull(tau, pose);
    SurfaceMotion surface;
    if (is_shaken_) surface = surface_at(tau);
    const double driven = pull.force / model_->inner.mass;
    const double along = pull.x * (model_->gravity_x - surface.ax - ax);
    const double up = pull.z * (model_->gravity_z - surface.az - az);
    // Where the terms cancel, the rest is rounding, by which no push can be found.
    constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();
    const double size = std::abs(driven) + std::abs(along) + std::abs(up);
    const double sum = driven + along + up;
    return std::abs(sum) > kRounding * size ? sum : 0.0;
}

// The normal force N of a corner that slips is A / (B - C mu(N)), with A, B and C from
// `corner_slip`, so that N (B - C mu(N)) - A is looked for zero: it is negative at N = 0, and its
// zero is followed by secants between bounds that close in on it. Where there is none the sliding
// has no solution, which `corner_slip` finds for the coefficient of the largest loads. Only a law
// so steep that C (N mu(N))' exceeds B has more than one.
double Dynamics::load_dependent_kinetic(double coefficient, double slip_sign, const Pose& pose,
                                        double omega, const Load& load) const {
    const PlainDynamics<double>& r = robot_;
    const auto mu = [&](double normal) { return laws().load_dependent(coefficient, normal); };
    const double lever = pose.lever_arm, adhesion = load.contact_adhesion;
    const double rest =
        adhesion - r.mass * omega * omega * (pose.height - pose.curvature_radius) - load.fz;
    const double a = r.mass * lever * (load.torque + lever * adhesion) + r.inertia * rest;
    const double b = r.inertia + r.mass * lever * lever;
    const double c = slip_sign * r.mass * lever * pose.height;
    if (!(a > 0.0)) return mu(0.0);
    const auto residual = [&](double normal) { return normal * (b - c * mu(normal)) - a; };
    constexpr int kMostRises = 100, kMostIterations = 100;
    constexpr double kRise = 1.25;  // not to pass over the least of several zeros
    double low = 0.0, high = a / b, low_value = -a, value = residual(high);
    for (int n = 0; value < 0.0; ++n) {
        if (n == kMostRises) return mu(high);
        low = high;
        low_value = value;
        high *= kRise;
        value = residual(high);
    }
    double normal = high, last = low, last_value = low_value;
    for (int n = 0; n < kMostIterations; ++n) {
        const double step = value * (normal - last) / (value - last_value);
        if (std::abs(step) <= 4.0 * std::numeric_limits<double>::epsilon() * normal) break;
        last = normal;
        last_value = value;
        const double next = normal - step;
        normal = next > low && next < high ? next : 0.5 * (low + high);
        value = residual(normal);
        (value < 0.0 ? low : high) = normal;
    }
    return mu(normal);
}

void Dynamics::add_user_effects(double tau, const PlanarField& field, double x, double z,
                                const Pose& pose, double vx, double vz, double omega,
                                Load& load) const {
    const double sign = model_->frame.sign;
    const std::array<double, WrenchState::kSize> state = {
        now_.start + tau, sign * x, z, pose.angle + quadrant_ * kQuarterTurn, sign * vx, vz, omega,
        sign * field.bx,  field.bz};
    for (const UserSetting& each : model_->user_effects) {
        // A compiled function that fails, such as numba's after a division by zero, writes nothing.
        std::array<double, 3> wrench;
        wrench.fill(std::numeric_limits<double>::quiet_NaN());
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
