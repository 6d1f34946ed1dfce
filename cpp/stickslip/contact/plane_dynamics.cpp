#include "stickslip/contact/plane_dynamics.hpp"

namespace stickslip {

PlaneDynamics::PlaneDynamics(Dynamics& upright, SpatialField field,
                             const std::array<double, 2>& weight)
    : upright_(&upright), field_(field), weight_(weight), watch_(upright.model()) {
    if (!upright.model().field_shape.absent()) field_.set_shape(upright.model().field_shape);
}

}  // namespace stickslip
