#pragma once

#include <cmath>

namespace stickslip {

/// Coulomb friction with a static and a kinetic coefficient, and named extensions that are absent
/// at zero. `slip` is +1 for a contact that slips (or is about to) to the robot's +x, -1 for the
/// other way; `x` (m) is where the contact is.
struct FrictionLaw {
    double static_coefficient = 0.0;
    double kinetic_coefficient = 0.0;
    double stribeck_velocity = 0.0;  ///< m/s, effect `stribeck_friction`
    double viscous = 0.0;            ///< s/m, effect `viscous_friction`
    double anisotropy = 0.0;         ///< -, effect `friction_anisotropy`
    double patch_amplitude = 0.0;    ///< -, effect `friction_patches`
    double patch_wavenumber = 0.0;   ///< 1/m

    double static_limit(int slip, double x) const {
        return plain() ? static_coefficient : static_coefficient * place(slip, x);
    }
    /// Coefficient of a contact that slips at `slip_velocity` (m/s).
    double kinetic(int slip, double slip_velocity, double x) const {
        return plain() ? kinetic_coefficient : extended_kinetic(slip, slip_velocity, x);
    }
    /// Coefficient of an impulse at a contact that stuck before it, or did not.
    double impulsive(int slip, bool stuck, double x) const {
        return (stuck ? static_coefficient : kinetic_coefficient) *
               (plain() ? 1.0 : place(slip, x));
    }

private:
    bool plain() const {
        return stribeck_velocity == 0.0 && viscous == 0.0 && anisotropy == 0.0 &&
               patch_amplitude == 0.0;
    }
    [[gnu::noinline]] double extended_kinetic(int slip, double slip_velocity, double x) const {
        double coefficient = kinetic_coefficient + viscous * std::abs(slip_velocity);
        if (stribeck_velocity != 0.0) {
            const double ratio = slip_velocity / stribeck_velocity;
            coefficient += (static_coefficient - kinetic_coefficient) * std::exp(-ratio * ratio);
        }
        return coefficient * place(slip, x);
    }
    double place(int slip, double x) const {
        return (1.0 + anisotropy * slip) * (1.0 + patch_amplitude * std::sin(patch_wavenumber * x));
    }
};

}  // namespace stickslip
