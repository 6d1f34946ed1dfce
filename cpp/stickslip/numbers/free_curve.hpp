#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace stickslip {

/// Where the knots of a free shape lie.
enum class FreeReach {
    from_zero,  ///< evenly over [0, span], for an argument that is never negative
    anchored,   ///< at span/5 .. span, and f(0) = 0, for one that is never negative
    both_ways,  ///< evenly over [-span, span]
};

inline constexpr std::size_t kKnots = 5;

/// The parameters of an effect whose shape is free, as a scenario has them.
struct FreeShape {
    FreeReach reach = FreeReach::from_zero;
    double span = 1.0;                      ///< in the argument's unit
    std::array<double, kKnots> knots = {};  ///< f there
};

/// A function f of one argument with a free shape, by which an effect multiplies a quantity of the
/// model by 1 + f: the cubic Hermite interpolant (in the form of Fritsch and Carlson, 1980) of its
/// knots, whose slopes are the central differences, so that f is linear in the knots and once
/// continuously differentiable. Beyond its ends it is constant, so that its slope there is zero;
/// but zero as the least value that an argument can have is no end to go beyond, and the slope is
/// that of the first two knots. A straight line through the knots is thus met from there on up to
/// the last knot but one.
class FreeCurve {
public:
    FreeCurve() = default;
    explicit FreeCurve(const FreeShape& shape) {
        const bool anchored = shape.reach == FreeReach::anchored;
        const bool both_ways = shape.reach == FreeReach::both_ways;
        first_ = both_ways ? -shape.span : 0.0;
        const double width = both_ways ? 2.0 * shape.span : shape.span;
        last_ = kKnots - (anchored ? 0 : 1);
        per_spacing_ = static_cast<double>(last_) / width;
        std::copy(shape.knots.begin(), shape.knots.end(), values_.begin() + (anchored ? 1 : 0));
        for (std::size_t i = 1; i < last_; ++i) {
            slopes_[i] = 0.5 * (values_[i + 1] - values_[i - 1]);
        }
        if (!both_ways) slopes_[0] = values_[1] - values_[0];
        absent_ = std::all_of(shape.knots.begin(), shape.knots.end(),
                              [](double knot) { return knot == 0.0; });
    }

    bool absent() const { return absent_; }

    double at(double argument) const {
        const Place place = find(argument);
        const double s = place.part, t = 1.0 - s;
        const std::size_t i = place.interval;
        // Hermite's basis in factors, which are exact at both ends.
        return t * t * ((1.0 + 2.0 * s) * values_[i] + s * slopes_[i]) +
               s * s * ((1.0 + 2.0 * t) * values_[i + 1] - t * slopes_[i + 1]);
    }

    /// df/d(argument), from the right at an end where it jumps.
    double slope(double argument) const {
        const double position = (argument - first_) * per_spacing_;
        if (position < 0.0 || position >= static_cast<double>(last_)) return 0.0;
        const Place place = find(argument);
        const double s = place.part, t = 1.0 - s;
        const std::size_t i = place.interval;
        const double rise = 6.0 * s * t * (values_[i + 1] - values_[i]);
        const double own = t * (1.0 - 3.0 * s) * slopes_[i] + s * (1.0 - 3.0 * t) * slopes_[i + 1];
        return (rise + own) * per_spacing_;
    }

    /// 1 + f, or zero where that would be negative; exactly 1 where the effect is absent.
    double factor(double argument) const {
        return absent_ ? 1.0 : std::max(1.0 + at(argument), 0.0);
    }
    /// The same at the angle of a direction (rad, from -pi to pi), which is only computed if asked
    /// for.
    double factor_at_angle(double sine, double cosine) const {
        return absent_ ? 1.0 : factor(std::atan2(sine, cosine));
    }
    /// d(1 + f)/d(argument), zero where 1 + f is cut off.
    double factor_slope(double argument) const {
        return absent_ || 1.0 + at(argument) <= 0.0 ? 0.0 : slope(argument);
    }

    /// The least factor at a knot, and at most 1.
    double least_factor() const {
        return std::clamp(1.0 + *std::min_element(values_.begin(), values_.end()), 0.0, 1.0);
    }
    /// Distance of two knots, in the argument's unit.
    double spacing() const { return 1.0 / per_spacing_; }

private:
    struct Place {
        std::size_t interval;
        double part;  // of the interval
    };
    Place find(double argument) const {
        const double end = static_cast<double>(last_);
        // In this order what is not a number is taken as the first end.
        const double along = std::max(0.0, (argument - first_) * per_spacing_);
        const double position = std::min(along, end);
        const auto interval = std::min(static_cast<std::size_t>(position), last_ - 1);
        return {interval, position - static_cast<double>(interval)};
    }

    bool absent_ = true;
    double first_ = 0.0, per_spacing_ = 1.0;
    std::size_t last_ = kKnots - 1;               // index of the last value
    std::array<double, kKnots + 1> values_ = {};  // with that of an anchor
    std::array<double, kKnots + 1> slopes_ = {};  // a spacing
};

}  // namespace stickslip
