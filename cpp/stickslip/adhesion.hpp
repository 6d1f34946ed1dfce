#pragma once

#include <algorithm>
#include <cmath>

namespace stickslip {

/// Adhesion of the corners to the surface: `strength` in all, shared equally by the corners that
/// touch, zero at those that do not. With a finite `range` it fades linearly to zero at that gap,
/// and a corner near the surface takes its share.
struct Adhesion {
    double strength = 0.0;     ///< N
    double range = 0.0;        ///< m, zero: contact only
    double angle_loss = 0.0;   ///< -, effect `angle_adhesion`
    double ageing_rate = 0.0;  ///< -, effect `adhesion_ageing`
    double ageing_time = 1.0;  ///< s

    /// Strength of a contact at the sine of theta, `age` seconds after it was made, in N.
    double of_contact(double sine, double age) const {
        double result = strength;
        if (angle_loss != 0.0) result *= 1.0 - angle_loss * sine * sine;
        if (ageing_rate != 0.0) {
            result *= 1.0 + ageing_rate * std::log1p(std::max(age, 0.0) / ageing_time);
        }
        return result;
    }

    /// Weight of a corner at `gap` m above the surface, one at contact.
    double weight(double gap) const {
        return range > 0.0 ? std::clamp(1.0 - gap / range, 0.0, 1.0) : (gap <= 0.0 ? 1.0 : 0.0);
    }
    /// Part of the strength that acts at a corner of `weight` when all weights add up to `total`.
    static double share(double weight, double total) { return weight / std::max(1.0, total); }
};

}  // namespace stickslip
