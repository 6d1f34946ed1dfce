#pragma once

#include <cmath>

namespace stickslip {

/// Named extensions of Coulomb friction, each absent at zero.
struct FrictionExtensions {
    double stribeck_velocity = 0.0;  ///< m/s, effect `stribeck_friction`
    double viscous = 0.0;            ///< s/m, effect `viscous_friction`
    double anisotropy = 0.0;         ///< -, effect `friction_anisotropy`
    double patch_amplitude = 0.0;    ///< -, effect `friction_patches`
    double patch_wavenumber = 0.0;   ///< 1/m

    bool absent() const {
        return stribeck_velocity == 0.0 && viscous == 0.0 && anisotropy == 0.0 &&
               patch_amplitude == 0.0;
    }
};

/// Coulomb friction with a static and a kinetic coefficient. `slip` is +1 for a contact that slips
/// (or is about to) to the robot's +x, -1 for the other way; `x` (m) is where the contact is.
class FrictionLaw {
public:
    FrictionLaw() = default;
    FrictionLaw(double static_friction, double kinetic_friction,
                const FrictionExtensions& extensions = {})
        : static_coefficient(static_friction),
          kinetic_coefficient(kinetic_friction),
          extensions_(extensions),
          plain_(extensions.absent()) {}

    bool is_plain() const { return plain_; }

    double static_coefficient = 0.0;
    double kinetic_coefficient = 0.0;

    double static_limit(double slip, double x) const {
        return plain_ ? static_coefficient : static_coefficient * place(slip, x);
    }
    /// Coefficient of a contact that slips at `slip_velocity` (m/s).
    double kinetic(double slip, double slip_velocity, double x) const {
        return plain_ ? kinetic_coefficient : extended_kinetic(slip, slip_velocity, x);
    }
    /// Coefficient of an impulse at a contact that stuck before it, or did not.
    double impulsive(double slip, bool stuck, double x) const {
        return (stuck ? static_coefficient : kinetic_coefficient) * (plain_ ? 1.0 : place(slip, x));
    }

private:
    [[gnu::noinline]] double extended_kinetic(double slip, double slip_velocity, double x) const {
        const FrictionExtensions& e = extensions_;
        double coefficient = kinetic_coefficient + e.viscous * std::abs(slip_velocity);
        if (e.stribeck_velocity != 0.0) {
            const double ratio = slip_velocity / e.stribeck_velocity;
            coefficient += (static_coefficient - kinetic_coefficient) * std::exp(-ratio * ratio);
        }
        return coefficient * place(slip, x);
    }
    double place(double slip, double x) const {
        return (1.0 + extensions_.anisotropy * slip) *
               (1.0 + extensions_.patch_amplitude * std::sin(extensions_.patch_wavenumber * x));
    }

    FrictionExtensions extensions_;
    bool plain_ = true;
};

}  // namespace stickslip
