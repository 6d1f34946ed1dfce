#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stickslip/body/smooth_effects.hpp"
#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

/// Adhesion of the corners to the surface: `strength` in all, shared equally by the corners that
/// touch, zero at those that do not. With a finite `range` it fades linearly to zero at that gap,
/// and corners near the surface share it so that it has a potential (docs/theory/contact.md).
struct Adhesion {
    double strength = 0.0;  ///< N
    double range = 0.0;     ///< m, zero: contact only
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

    /// The same's derivative by theta, N/rad.
    double slope_of_contact(double sine, double cosine, double seconds) const {
        const double loss = smooth.at_angle(sine);
        const double loss_slope = -2.0 * smooth.angle_loss * sine * cosine;
        double slope = loss_slope * angle.factor_at_angle(sine, cosine);
        if (!angle.absent()) slope += loss * angle.factor_slope(std::atan2(sine, cosine));
        return slope * (strength * ageing(seconds));
    }

    /// Shortest time (s) over which a free shape may change it while nothing moves.
    double least_time() const {
        return age.absent() ? std::numeric_limits<double>::infinity() : age.spacing();
    }

    /// Weight of a corner at `gap` m above the surface, one at contact.
    double weight(double gap) const {
        return range > 0.0 ? std::clamp(1.0 - gap / range, 0.0, 1.0) : (gap <= 0.0 ? 1.0 : 0.0);
    }

    struct Shares {
        std::array<double, 4> pull = {};  ///< of each corner, over the strength
        double energy = 0.0;              ///< potential energy over -strength range
    };
    /// Corners whose weights add up to no more than one pull by their weights; else each gives up
    /// the same, down to nothing, until the pulls add up to one. These pulls f are the nearest to
    /// the weights w among those that may be, so they are the gradient of max(f.w - f.f/2), and the
    /// force field is conservative.
    static Shares shares(const std::array<double, 4>& weights) {
        // Michelot's projection on a simplex (1986): each pass but the last drops a corner.
        double level = 0.0;
        for (std::size_t pass = 0; pass < weights.size(); ++pass) {
            double excess = -1.0, count = 0.0;
            for (const double weight : weights) {
                excess += weight > level ? weight : 0.0;
                count += weight > level ? 1.0 : 0.0;
            }
            if (excess <= count * level) break;
            level = excess / count;
        }
        Shares result;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            const double pull = std::max(weights[i] - level, 0.0);
            result.pull[i] = pull;
            result.energy += pull * (weights[i] - 0.5 * pull);
        }
        return result;
    }

private:
    // Factor of a contact that was made `seconds` ago.
    double ageing(double seconds) const {
        return smooth.aged(seconds) * age.factor(std::max(seconds, 0.0));
    }
};

}  // namespace stickslip
