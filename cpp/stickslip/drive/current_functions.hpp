#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stickslip/drive/coil.hpp"
#include "stickslip/numbers/elementary.hpp"

/// The functions of time that currents are sums of, over a segment of voltage. Here alone stands
/// how they fade, swing and change.
namespace stickslip {

/// One for each mode of the coupled coils (one in all for equal coils that are not coupled), and
/// one for the field's lag.
inline constexpr int kMaxExponentials = kCoilCount + 1;
/// 1, tau, the exponentials, and the second function of each coil with a capacitor.
inline constexpr int kMaxBasis = 2 + kMaxExponentials + kCoilCount;

/// Damped oscillator x'' + 2 rate x' + stiffness x = 0. Its two solutions are exp(-rate tau)
/// cos(w tau) and exp(-rate tau) sin(w tau) / w with w^2 = stiffness - rate^2; where that is zero
/// their limits 1 and tau, where it is negative the hyperbolic ones.
struct Swing {
    double rate = 0.0;       ///< 1/s
    double stiffness = 0.0;  ///< 1/s^2

    using Two = std::array<double, 2>;

    friend bool operator==(const Swing&, const Swing&) = default;

    double square() const { return stiffness - rate * rate; }
    /// Half the difference of the two rates of what does not swing, 1/s.
    double apart() const { return std::sqrt(std::max(-square(), 0.0)); }
    /// Fastest rate, 1/s.
    double fastest() const { return square() > 0.0 ? std::sqrt(stiffness) : rate + apart(); }
    /// Slowest time constant, s.
    double slowest() const { return square() > 0.0 ? 1.0 / rate : (rate + apart()) / stiffness; }

    Two at(double tau) const {
        if (square() > 0.0) {
            const double w = std::sqrt(square()), fading = exponential(-rate * tau);
            return {fading * std::cos(w * tau), fading * std::sin(w * tau) / w};
        }
        // By the slower of the two exponentials and what is gone of the faster: nothing overflows.
        const double between = 2.0 * apart(), fading = exponential(-tau / slowest());
        const double gone = -std::expm1(-between * tau);
        return {fading * (1.0 - 0.5 * gone), fading * (between > 0.0 ? gone / between : tau)};
    }
    /// Time derivatives of the functions from their values.
    Two change(const Two& value) const {
        return {-rate * value[0] - square() * value[1], value[0] - rate * value[1]};
    }
    /// The slope of a sum of the functions, as such a sum.
    Two slope_of(const Two& c) const {
        return {c[1] - rate * c[0], -square() * c[0] - rate * c[1]};
    }
    /// The sum whose first-order lag of `lag` s is the sum with the coefficients `c`.
    Two lagged(const Two& c, double lag) const {
        const double left = 1.0 - lag * rate, turned = lag * square();
        const double all = left * left + lag * turned;
        return {(left * c[0] - lag * c[1]) / all, (turned * c[0] + left * c[1]) / all};
    }
    /// Integrals of a sum and of its square from 0 to `span` s, by the equation of motion times 1,
    /// x' and x.
    Two integrals(const Two& c, double span) const {
        const Two slope = slope_of(c), value = at(span);
        const double x = c[0], v = slope[0];  // at the start
        const double last = c[0] * value[0] + c[1] * value[1];
        const double last_v = slope[0] * value[0] + slope[1] * value[1];
        const double squares = last * last - x * x;
        const double of_slope = -(last_v * last_v - v * v + stiffness * squares) / (4.0 * rate);
        return {-(last_v - v + 2.0 * rate * (last - x)) / stiffness,
                (of_slope - (last * last_v - x * v) - rate * squares) / stiffness};
    }
};

/// The functions of one segment, in the order 1, tau, exp(-rate tau), those of swings.
struct CurrentFunctions {
    using Values = std::array<double, kMaxBasis>;

    int exponentials = 1, swings = 0;
    std::array<double, kMaxExponentials> rate = {};  ///< 1/s
    std::array<Swing, kCoilCount> swing = {};

    std::size_t count() const { return static_cast<std::size_t>(2 + exponentials + 2 * swings); }
    /// Index of the first of the two functions of a swing.
    std::size_t place(std::size_t of_swing) const {
        return static_cast<std::size_t>(2 + exponentials) + 2 * of_swing;
    }
    static Swing::Two two(const Values& of, std::size_t at) { return {of[at], of[at + 1]}; }

    /// Exponential `j` at `tau` s from the start, 1 at 0; the same within a segment and at its end.
    double fading(std::size_t j, double tau) const { return exponential(-rate[j] * tau); }
    /// Values of all functions at `tau` s from the start.
    Values values(double tau) const {
        Values result;
        result[0] = 1.0;
        result[1] = tau;
        for (std::size_t j = 0; j < static_cast<std::size_t>(exponentials); ++j) {
            result[2 + j] = fading(j, tau);
        }
        each_swing([&](std::size_t at, const Swing& s) { put(result, at, s.at(tau)); });
        return result;
    }
    /// Time derivatives of the functions, 1/s, from their values.
    Values changes(const Values& value) const {
        Values result;
        result[0] = 0.0;
        result[1] = value[0];
        fade(value, result);
        each_swing(
            [&](std::size_t at, const Swing& s) { put(result, at, s.change(two(value, at))); });
        return result;
    }
    /// The slope of a sum of the functions, as such a sum.
    Values slope_of(const Values& c) const {
        Values result;
        result[0] = c[1];
        result[1] = 0.0;
        fade(c, result);
        each_swing(
            [&](std::size_t at, const Swing& s) { put(result, at, s.slope_of(two(c, at))); });
        return result;
    }
    double sum(const Values& c, double tau) const {
        double result = c[0] + c[1] * tau;
        for (std::size_t j = 0; j < static_cast<std::size_t>(exponentials); ++j) {
            if (c[2 + j] != 0.0) result += c[2 + j] * fading(j, tau);
        }
        each_swing([&](std::size_t at, const Swing& s) {
            if (c[at] == 0.0 && c[at + 1] == 0.0) return;
            const Swing::Two value = s.at(tau);
            result += c[at] * value[0] + c[at + 1] * value[1];
        });
        return result;
    }
    /// Fastest rate of all functions, 1/s.
    double fastest() const {
        double result = 0.0;
        for (std::size_t j = 0; j < static_cast<std::size_t>(exponentials); ++j) {
            result = std::max(result, rate[j]);
        }
        each_swing([&](std::size_t, const Swing& s) { result = std::max(result, s.fastest()); });
        return result;
    }

    /// Calls `use(place, swing)`.
    void each_swing(auto&& use) const {
        for (std::size_t s = 0; s < static_cast<std::size_t>(swings); ++s) use(place(s), swing[s]);
    }

private:
    static void put(Values& to, std::size_t at, const Swing::Two& two) {
        to[at] = two[0];
        to[at + 1] = two[1];
    }
    void fade(const Values& from, Values& to) const {
        for (std::size_t j = 0; j < static_cast<std::size_t>(exponentials); ++j) {
            to[2 + j] = -rate[j] * from[2 + j];
        }
    }
};

}  // namespace stickslip
