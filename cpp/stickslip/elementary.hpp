#pragma once

#include <cstdint>

#include "stickslip/pack.hpp"

/// Exponential and logarithm of a number, or of each member of a pack, by operations that have the
/// same bits on every machine.
namespace stickslip {

/// Adding it rounds a number of less than 2^51 to whole ones, which then stand in its lowest bits.
inline constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52

/// exp(a) for a <= 0, within 2 units in the last place. The C library's differs between machines.
template <class Real>
[[gnu::always_inline]] inline Real exponential(Real a) {
    constexpr double kLeast = -708.0;  // of a result that is a normal number
    // ln 2 in two parts, of which a multiple by less than 2^11 of the first is exact.
    constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
    const Real x = greater(a, Real(kLeast));
    const Real shifted = x * 1.4426950408889634 + kRound;
    const Real twos = shifted - kRound;
    const Real r = (x - twos * kLn2High) - twos * kLn2Low;
    // Taylor's series: |r| <= 0.347, and the next term is below 5e-18.
    const Real rr = r * r, rrrr = rr * rr;
    const Real low = (1.0 + r) + rr * (1.0 / 2 + r * (1.0 / 6));
    const Real middle = (1.0 / 24 + r * (1.0 / 120)) + rr * (1.0 / 720 + r * (1.0 / 5040));
    const Real high =
        (1.0 / 40320 + r * (1.0 / 362880)) + rr * (1.0 / 3628800 + r * (1.0 / 39916800));
    const Real highest = 1.0 / 479001600 + r * (1.0 / 6227020800);
    const Real p = low + rrrr * (middle + rrrr * (high + rrrr * highest));
    return from_bits<Real>(to_bits(p) + (to_bits(shifted) << 52));
}

/// Logarithm to base 2 of a positive normal number, within 0.05: for the choice of a step's width.
/// The mantissa stands for its own logarithm.
template <class Real>
[[gnu::always_inline]] inline Real rough_log2(Real a) {
    constexpr std::int64_t kTwo52 = std::int64_t{1075} << 52;  // the bits of 2^52
    constexpr double kValueTwo52 = 4503599627370496.0, kTwo32 = 4294967296.0;
    const Real bits = from_bits<Real>((to_bits(a) >> 20) | kTwo52) - kValueTwo52;
    return bits * (1.0 / kTwo32) - (1023.0 - 0.043);
}

/// 2 to the power a, |a| < 1000, within 1 % of itself: for the choice of a step's width.
template <class Real>
[[gnu::always_inline]] inline Real rough_exp2(Real a) {
    const Real shifted = a + kRound;
    const Real f = a - (shifted - kRound);
    const Real p = (1.0 + f * 0.69314718) + f * f * 0.24022651;
    return from_bits<Real>(to_bits(p) + (to_bits(shifted) << 52));
}

}  // namespace stickslip
