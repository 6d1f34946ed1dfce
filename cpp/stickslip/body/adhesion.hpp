#pragma once

#include <algorithm>
#include <limits>

#include "stickslip/body/smooth_effects.hpp"
#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

/// Adhesion of the corners to the surface: `strength` in all, shared equally by the corners that
/// touch, zero at those that do not.
struct Adhesion {
    double strength = 0.0;  ///< N
    SmoothAdhesion<double> smooth = {};
    FreeCurve angle = {};  ///< effect `free_adhesion_angle`, of the tilt
    FreeCurve age = {};    ///< effect `free_adhesion_age`, of the time since touch-down

    bool has_free_shape() const { return !angle.absent() || !age.absent(); }
    /// Whether a contact is as strong at all angles and ages.
    bool is_constant() const {
        return smooth.angle_loss == 0.0 && smooth.ageing_rate == 0.0 && !has_free_shape();
    }

    /// Strength of a contact at the sine and cosine of theta, `seconds` after it was made, in N.
    double of_contact(double sine, double cosine, double seconds) const {
        return strength * smooth.at_angle(sine) *
               (ageing(seconds) * angle.factor_at_angle(sine, cosine));
    }

    /// Shortest time (s) over which a free shape may change it while nothing moves.
    double least_time() const {
        return age.absent() ? std::numeric_limits<double>::infinity() : age.spacing();
    }

private:
    // Factor of a contact that was made `seconds` ago.
    double ageing(double seconds) const {
        return smooth.aged(seconds) * age.factor(std::max(seconds, 0.0));
    }
};

}  // namespace stickslip
