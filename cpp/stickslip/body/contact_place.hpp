#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

/// Change of a pose by a contact place, m; see `ContactPlace`.
struct PlaceShift {
    double lever_arm = 0.0, height = 0.0;  ///< of the pivot from the centre of mass
    double rolled_distance = 0.0;   ///< of the pivot from the point that stays where it sticks
    double curvature_radius = 0.0;  ///< of the contour at the contact
};

/// A contact that does not lie where the rectangle has its corner, effect `free_contact_place`: at
/// the tilt theta it lies c(theta) cos theta farther along the surface, with c = half length times
/// a free curve. Whatever touches a plane has a height h(theta) of the centre of mass, and its
/// lever arm is dh/dtheta, since the point that touches has no normal velocity. So h grows by the
/// integral g of c cos theta, which is zero at theta = 0. A contact that does not slip rolls: dx =
/// h dtheta; its place on the surface advances by rho dtheta, with rho = g + d(c cos theta)/dtheta
/// the radius of curvature. A constant c is a corner that lies so much farther to the front, with
/// rho = 0.
class ContactPlace {
public:
    ContactPlace() = default;
    ContactPlace(const FreeShape& shape, double half_length)
        : curve_(shape), span_(shape.span), scale_(half_length) {
        if (curve_.absent()) return;
        for (std::size_t i = kMiddle; i + 1 < kKnots; ++i) step(i, i + 1);
        for (std::size_t i = kMiddle; i > 0; --i) step(i, i - 1);
        const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
        largest_ =
            scale_ * std::abs(*std::max_element(shape.knots.begin(), shape.knots.end(), size));
    }

    bool absent() const { return curve_.absent(); }

    PlaceShift at(double theta) const {
        if (curve_.absent()) return {};
        const double end = std::clamp(theta, -span_, span_);
        const double along = (end + span_) / spacing();
        const auto nearest = static_cast<std::size_t>(std::lround(along));
        Sum sum = added(sums_[nearest], knot(nearest), end);
        const double f = curve_.at(theta), cosine = std::cos(theta), sine = std::sin(theta);
        if (theta != end) {
            // The curve is constant there.
            const double beyond = theta - end;
            sum.twice += sum.once * beyond + f * (std::cos(end) - cosine - beyond * std::sin(end));
            sum.once += f * (sine - std::sin(end));
        }
        const double slope = curve_.slope(theta);
        return {scale_ * f * cosine, scale_ * sum.once, scale_ * (f * cosine + sum.twice),
                scale_ * (sum.once + slope * cosine - f * sine)};
    }

    /// Bound on how far a contact is from where the rectangle's corner would be, m.
    double reach() const {
        // Knots as far as c and its overshoot, over the range of tilts, which is two turns at most.
        constexpr double kTimes = 10.0;
        return kTimes * largest_;
    }

private:
    static constexpr std::size_t kMiddle = kKnots / 2;  // the knot at theta = 0

    /// Integral of f cos from zero, once and twice.
    struct Sum {
        double once = 0.0, twice = 0.0;
    };

    double spacing() const { return 2.0 * span_ / (kKnots - 1); }
    double knot(std::size_t i) const {
        return (static_cast<double>(i) - static_cast<double>(kMiddle)) * spacing();
    }
    void step(std::size_t from, std::size_t to) {
        sums_[to] = added(sums_[from], knot(from), knot(to));
    }

    // From one angle to another without a knot between them, by Gauss's quadrature of eight points,
    // which is exact to rounding for a cubic times a cosine over 1.6 rad; the second integral by
    // Cauchy's formula, the integral of (to - t) f cos dt.
    Sum added(const Sum& sum, double from, double to) const {
        constexpr std::array<double, 4> kPlaces = {0.1834346424956498, 0.5255324099163290,
                                                   0.7966664774136267, 0.9602898564975363};
        constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873,
                                                    0.2223810344533745, 0.1012285362903763};
        const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
        Sum result = {sum.once, sum.twice + sum.once * (to - from)};
        for (std::size_t i = 0; i < kPlaces.size(); ++i) {
            for (const double side : {-half, half}) {
                const double t = middle + side * kPlaces[i];
                const double part = half * kWeights[i] * curve_.at(t) * std::cos(t);
                result.once += part;
                result.twice += (to - t) * part;
            }
        }
        return result;
    }

    FreeCurve curve_;
    double span_ = 1.0, scale_ = 0.0, largest_ = 0.0;
    std::array<Sum, kKnots> sums_ = {};
};

}  // namespace stickslip
