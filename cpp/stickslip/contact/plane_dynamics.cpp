#include "stickslip/contact/plane_dynamics.hpp"

#include <cmath>

namespace stickslip {

PlaneDynamics::PlaneDynamics(Dynamics& upright, SpatialField field,
                             const std::array<double, 2>& weight)
    : upright_(&upright),
      field_(field),
      weight_(weight),
      gradient_scale_(1.0 + upright.model().gradient_excess),
      extended_(upright.model().has_force_effects()),
      watch_(upright.model()) {
    if (!upright.model().field_shape.absent()) field_.set_shape(upright.model().field_shape);
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
