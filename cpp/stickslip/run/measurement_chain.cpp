#include "stickslip/run/measurement_chain.hpp"

#include "stickslip/run/recording.hpp"
#include "stickslip/run/summary.hpp"

namespace stickslip {
namespace {

void scale(std::vector<double>& column, double factor) {
    for (double& value : column) value *= factor;
}

}  // namespace

void MeasurementChain::apply(Summary& summary) const {
    if (!scales_nothing()) {
        for (double* velocity : {&summary.mean_velocity, &summary.finished_velocity,
                                 &summary.mean_velocity_y, &summary.finished_velocity_y,
                                 &summary.slip_up, &summary.slip_down, &summary.slip_flat}) {
            *velocity *= length_factor() / time_factor();
        }
    }
    if (angle_offset != 0.0) {
        summary.theta_min += angle_offset;
        summary.theta_max += angle_offset;
    }
}

void MeasurementChain::apply(Recording& recording) const {
    if (!scales_nothing()) {
        const double length = length_factor(), time = time_factor();
        scale(recording.t, time);
        for (auto* column : {&recording.x, &recording.y, &recording.z, &recording.contact_x,
                             &recording.contact_y}) {
            scale(*column, length);
        }
        for (auto* column : {&recording.vx, &recording.vy, &recording.vz, &recording.slip_velocity,
                             &recording.slip_across}) {
            scale(*column, length / time);
        }
        scale(recording.omega, 1.0 / time);
    }
    if (angle_offset != 0.0) {
        for (double& theta : recording.theta) theta += angle_offset;
    }
}

}  // namespace stickslip
