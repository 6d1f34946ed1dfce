#include "stickslip/plane_dynamics.hpp"

#include <algorithm>
#include <numbers>

namespace stickslip {
namespace {

// Spin friction of an edge of width w under the normal force N is mu N w / 4, Coulomb friction
// spread evenly.
constexpr double kSpinArm = 0.25;
// Largest angle (rad) between heading and field that counts as none: two degrees.
constexpr double kMostLag = 2.0 * std::numbers::pi / 180.0;

double usual_load(const Model& model) {
    return -model.mass * model.gravity_z + model.adhesion.strength;
}

double weak_field(const Model& model) {
    const double load = usual_load(model);
    const double spin = kSpinArm * model.width * model.friction.static_coefficient * load;
    return model.moment > 0.0 ? spin / (model.moment * std::sin(kMostLag)) : 0.0;
}

}  // namespace

PlaneDynamics::PlaneDynamics(Dynamics& upright, SpatialField field,
                             const std::array<double, 2>& weight, double least_slip)
    : upright_(&upright),
      field_(std::move(field)),
      weight_(weight),
      least_slip_(least_slip),
      weak_field_(stickslip::weak_field(upright.model())),
      braking_(upright.model().friction.kinetic_coefficient * usual_load(upright.model()) /
               upright.model().mass),
      gradient_scale_(1.0 + upright.model().gradient_excess),
      yaw_inertia_(upright.model().mass *
                   (4.0 * upright.model().shape.half_base(0) * upright.model().shape.half_base(0) +
                    upright.model().width * upright.model().width) /
                   12.0),
      extended_(upright.model().has_force_effects()) {
    if (!upright.model().field_shape.absent()) field_.set_shape(upright.model().field_shape);
}

void PlaneDynamics::follow(double tau, const Place& place) {
    constexpr int kLooks = 8;
    const double begin = followed_;
    for (int n = 1; n < kLooks; ++n) look(begin + (tau - begin) * n / kLooks, place);
    look(tau, place);
}

void PlaneDynamics::look(double tau, const Place& place) {
    // Angle between two looks between which another one is worth it, and the time below which it
    // is not: a field that goes through zero is then far below a weak one on the way.
    constexpr double kFar = 0.1, kShort = 1e-8;
    const SpatialFieldValue b = field_.at(tau)(place.x, place.y, place.z);
    const double horizontal = std::sqrt(b.bx * b.bx + b.by * b.by);
    const double time = tau - followed_;
    if (!(horizontal > weak_field_)) {
        was_weak_ = true;
        followed_ = tau;
        return;
    }
    const Heading now = {b.bx / horizontal, b.by / horizontal};
    const Slip turned = heading_.seen(now.cosine, now.sine);
    const double angle = std::abs(std::atan2(turned.across, turned.along));
    if (was_strong_ && !was_weak_ && angle > kFar && time > kShort) {
        look(followed_ + 0.5 * time, place);
        look(tau, place);
        return;
    }
    if (was_strong_ && was_weak_) {
        lost_ = lost_ || angle > kMostLag;
    } else if (was_strong_ && time > 0.0) {
        const double yaw = std::sqrt(upright_->model().moment * horizontal / yaw_inertia_);
        largest_lag_ = std::max(largest_lag_, angle / time / yaw);
        turned_ += angle;
    }
    heading_ = now;
    followed_ = tau;
    was_weak_ = false;
    was_strong_ = true;
}

double PlaneDynamics::correct_drag(const Pose& pose, const Slip& velocity, double vz, double omega,
                                   Load& load) const {
    const double upright_speed = std::hypot(velocity.along, vz);
    const double speed = std::hypot(upright_speed, velocity.across);
    const double drag = upright_->drag_coefficient(pose, speed, omega);
    const double less = upright_->drag_coefficient(pose, upright_speed, omega) - drag;
    load.fx += less * velocity.along;
    load.fz += less * vz;
    return drag;
}

}  // namespace stickslip
