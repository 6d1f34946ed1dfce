#pragma once

#include <cmath>
#include <limits>

#include "stickslip/body/smooth_effects.hpp"
#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

/// Named extensions of Coulomb friction, each absent at zero.
struct FrictionExtensions {
    SmoothFriction<double> smooth = {};
    FreeCurve speed = {};  ///< effect `free_friction_speed`, of the slip velocity's size
    FreeCurve angle = {};  ///< effect `free_friction_angle`, of the tilt
    FreeCurve load = {};   ///< effect `free_friction_load`, of the normal force
    FreeCurve time = {};   ///< effect `free_friction_age`, of the time in the run

    bool has_free_shape() const {
        return !speed.absent() || !angle.absent() || !load.absent() || !time.absent();
    }
    bool absent() const { return smooth.absent() && !has_free_shape(); }
};

/// A contact as friction sees it.
struct ContactPoint {
    double x = 0.0;                   ///< m
    double sine = 0.0, cosine = 1.0;  ///< of the body's tilt
    double normal = 0.0;              ///< N; infinite in an impact
    double time = 0.0;                ///< s, since the run began
};

/// Coulomb friction with a static and a kinetic coefficient. `slip` is +1 for a contact that slips
/// (or is about to) to the robot's +x, -1 for the other way.
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
    bool has_free_shape() const { return extensions_.has_free_shape(); }
    const SmoothFriction<double>& smooth() const { return extensions_.smooth; }

    double static_coefficient = 0.0;
    double kinetic_coefficient = 0.0;

    double static_limit(double slip, const ContactPoint& at) const {
        if (plain_) return static_coefficient;
        return static_coefficient * place(slip, at) * extensions_.load.factor(at.normal);
    }
    /// Coefficient of a contact that slips at `slip_velocity` (m/s).
    double kinetic(double slip, double slip_velocity, const ContactPoint& at) const {
        if (plain_) return kinetic_coefficient;
        return kinetic_of_no_load(slip, slip_velocity, at) * extensions_.load.factor(at.normal);
    }
    /// Coefficient of an impulse at a contact that stuck before it, or did not.
    double impulsive(double slip, bool stuck, const ContactPoint& at) const {
        const double coefficient = stuck ? static_coefficient : kinetic_coefficient;
        if (plain_) return coefficient;
        return coefficient * place(slip, at) * extensions_.load.factor(at.normal);
    }

    /// The factor of `kinetic` that the normal force has, and the rest of it.
    const FreeCurve& load() const { return extensions_.load; }
    [[gnu::noinline]] double kinetic_of_no_load(double slip, double slip_velocity,
                                                const ContactPoint& at) const {
        return extensions_.smooth.kinetic(static_coefficient, kinetic_coefficient, slip_velocity) *
               place(slip, at) * extensions_.speed.factor(std::abs(slip_velocity));
    }

    /// Shortest time (s) over which a free shape may change it while nothing moves.
    double least_time() const {
        return extensions_.time.absent() ? std::numeric_limits<double>::infinity()
                                         : extensions_.time.spacing();
    }

private:
    double place(double slip, const ContactPoint& at) const {
        return extensions_.smooth.place(slip, at.x) *
               (extensions_.angle.factor_at_angle(at.sine, at.cosine) *
                extensions_.time.factor(at.time));
    }

    FrictionExtensions extensions_;
    bool plain_ = true;
};

}  // namespace stickslip
