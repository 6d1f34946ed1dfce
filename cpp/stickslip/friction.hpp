#pragma once

#include <cmath>

namespace stickslip {

/// Coulomb friction with a static and a kinetic coefficient, and named extensions that are absent
/// at zero.
struct FrictionLaw {
    double static_coefficient = 0.0;
    double kinetic_coefficient = 0.0;
    double stribeck_velocity = 0.0;  ///< m/s, effect `stribeck_friction`

    /// Coefficient of a contact that slips at `slip_velocity` (m/s).
    double kinetic(double slip_velocity) const {
        if (stribeck_velocity == 0.0) return kinetic_coefficient;
        const double ratio = slip_velocity / stribeck_velocity;
        return kinetic_coefficient +
               (static_coefficient - kinetic_coefficient) * std::exp(-ratio * ratio);
    }
};

}  // namespace stickslip
