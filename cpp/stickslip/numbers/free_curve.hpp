#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stickslip/numbers/pack.hpp"

namespace stickslip {

/// Layout of the knots of a free shape.
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

/// Sizes of the array that a curve is evaluated from: how far its first knot lies below zero and
/// the number of its last, in spacings; then its values at six knots and its slopes, per spacing.
inline constexpr std::size_t kCurveValues = kKnots + 1, kCurveNumbers = 2 + 2 * kCurveValues;

/// The curve with these numbers, at an argument in spacings.
template <class Real>
[[gnu::always_inline]] inline Real curve_at(const Real* curve, Real argument) {
    // In this order what is not a number is taken as the first end.
    const Real position = lesser(greater(Real(0.0), argument + curve[0]), curve[1]);
    const Real* values = curve + 2;
    const Real* slopes = values + kCurveValues;
    Real start = 0.0, low = values[0], high = values[1], first = slopes[0], last = slopes[1];
    for (std::size_t i = 1; i < kKnots; ++i) {
        const Real knot = static_cast<double>(i);
        const auto beyond = position > knot;
        if (!any(beyond)) break;
        start = select(beyond, knot, start);
        low = select(beyond, values[i], low);
        high = select(beyond, values[i + 1], high);
        first = select(beyond, slopes[i], first);
        last = select(beyond, slopes[i + 1], last);
    }
    const Real s = position - start, t = 1.0 - s;
    // Hermite's basis in factors, which are exact at both ends.
    const Real rising = fma(s, first, fma(2.0 * s, low, low));
    const Real falling = fnma(t, last, fma(2.0 * t, high, high));
    return fma(t * t, rising, s * s * falling);
}

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
        const double width = both_ways ? 2.0 * shape.span : shape.span;
        const std::size_t last = kKnots - (anchored ? 0 : 1);  // with the value of an anchor
        numbers_[1] = static_cast<double>(last);
        numbers_[0] = both_ways ? 0.5 * numbers_[1] : 0.0;
        per_spacing_ = numbers_[1] / width;
        double* values = numbers_.data() + 2;
        double* slopes = values + kCurveValues;
        std::copy(shape.knots.begin(), shape.knots.end(), values + (anchored ? 1 : 0));
        for (std::size_t i = 1; i < last; ++i) slopes[i] = 0.5 * (values[i + 1] - values[i - 1]);
        if (!both_ways) slopes[0] = values[1] - values[0];
        absent_ = std::all_of(shape.knots.begin(), shape.knots.end(),
                              [](double knot) { return knot == 0.0; });
    }

    bool absent() const { return absent_; }

    double at(double argument) const { return curve_at(numbers_.data(), argument * per_spacing_); }

    /// Numbers for `curve_at`, and the factor from an argument to spacings.
    const std::array<double, kCurveNumbers>& numbers() const { return numbers_; }
    double per_spacing() const { return per_spacing_; }

    /// df/d(argument), from the right at an end where it jumps.
    double slope(double argument) const {
        const double position = argument * per_spacing_ + numbers_[0];
        if (position < 0.0 || position >= numbers_[1]) return 0.0;
        const auto i = static_cast<std::size_t>(position);
        const double* value = numbers_.data() + 2 + i;
        const double* slope = value + kCurveValues;
        const double s = position - static_cast<double>(i), t = 1.0 - s;
        const double rise = 6.0 * s * t * (value[1] - value[0]);
        const double own = t * (1.0 - 3.0 * s) * slope[0] + s * (1.0 - 3.0 * t) * slope[1];
        return (rise + own) * per_spacing_;
    }

    /// 1 + f, or zero where that would be negative; exactly 1 where the effect is absent.
    double factor(double argument) const {
        return absent_ ? 1.0 : std::max(1.0 + at(argument), 0.0);
    }
    /// Distance of two knots, in the argument's unit.
    double spacing() const { return 1.0 / per_spacing_; }

private:
    bool absent_ = true;
    double per_spacing_ = 1.0;
    std::array<double, kCurveNumbers> numbers_ = {};
};

}  // namespace stickslip
