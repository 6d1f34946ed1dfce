#pragma once

#include <algorithm>

namespace stickslip {

/// Adhesion of the corners to the surface: `strength` in all, shared equally by the corners that
/// touch, zero at those that do not. With a finite `range` it fades linearly to zero at that gap,
/// and a corner near the surface takes its share.
struct Adhesion {
    double strength = 0.0;  ///< N
    double range = 0.0;     ///< m, zero: contact only

    /// Weight of a corner at `gap` m above the surface, one at contact.
    double weight(double gap) const {
        return range > 0.0 ? std::clamp(1.0 - gap / range, 0.0, 1.0) : (gap <= 0.0 ? 1.0 : 0.0);
    }
    /// Pull on a corner of `weight` when all weights add up to `total`, in N.
    double pull(double weight, double total) const {
        return strength * weight / std::max(1.0, total);
    }
};

}  // namespace stickslip
