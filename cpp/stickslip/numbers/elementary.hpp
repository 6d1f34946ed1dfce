#pragma once

#include <cstddef>
#include <cstdint>

#include "stickslip/numbers/pack.hpp"

/// Exponential, logarithm, sine and cosine of a number, or of each member of a pack, by operations
/// of IEEE 754 alone: all processors with fused multiply-add agree to the bit, and all without. The
/// C library's functions differ between machines.
namespace stickslip {

/// Adding it rounds a number of less than 2^51 to whole ones, which then stand in its lowest bits.
inline constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52

// ln 2 in two parts, of which a multiple by less than 2^11 of the first is exact.
inline constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;

/// exp(a) for a <= 0, within 2 units in the last place.
template <class Real>
[[gnu::always_inline]] inline Real exponential(Real a) {
    constexpr double kLeast = -708.0;  // of a result that is a normal number
    const Real x = greater(a, Real(kLeast));
    const Real shifted = fma(x, Real(1.4426950408889634), Real(kRound));
    const Real twos = shifted - kRound;
    const Real r = fnma(twos, Real(kLn2Low), fnma(twos, Real(kLn2High), x));
    // Taylor's series: |r| <= 0.347, and the next term is below 5e-18.
    const Real rr = r * r, rrrr = rr * rr;
    const auto pair = [r](double c0, double c1) __attribute__((always_inline)) {
        return fma(r, Real(c1), Real(c0));
    };
    const Real low = fma(rr, pair(1.0 / 2, 1.0 / 6), 1.0 + r);
    const Real middle = fma(rr, pair(1.0 / 720, 1.0 / 5040), pair(1.0 / 24, 1.0 / 120));
    const Real high = fma(rr, pair(1.0 / 3628800, 1.0 / 39916800), pair(1.0 / 40320, 1.0 / 362880));
    const Real highest = pair(1.0 / 479001600, 1.0 / 6227020800);
    const Real p = fma(rrrr, fma(rrrr, fma(rrrr, highest, high), middle), low);
    return from_bits<Real>(to_bits(p) + (to_bits(shifted) << 52));
}

/// Natural logarithm of a positive normal number, within 2 units in the last place of itself or,
/// near one, of 1e-16.
template <class Real>
[[gnu::always_inline]] inline Real logarithm(Real a) {
    constexpr std::int64_t kMantissa = (std::int64_t{1} << 52) - 1;
    constexpr std::int64_t kOne = std::int64_t{1023} << 52, kTwo52 = std::int64_t{1075} << 52;
    constexpr double kValueTwo52 = 4503599627370496.0;
    const Real exponent = from_bits<Real>((to_bits(a) >> 52) | kTwo52) - kValueTwo52 - 1023.0;
    const Real mantissa = from_bits<Real>((to_bits(a) & kMantissa) | kOne);
    const auto large = mantissa > 1.4142135623730951;
    const Real m = select(large, 0.5 * mantissa, mantissa);
    const Real twos = select(large, exponent + 1.0, exponent);
    // ln m = 2 artanh s; Taylor's series: |s| <= 0.172, and the next term is below 1e-18.
    const Real s = (m - 1.0) / (m + 1.0);
    const Real z = s * s, zz = z * z, zzzz = zz * zz;
    const auto pair = [z](double c0, double c1) __attribute__((always_inline)) {
        return fma(z, Real(c1), Real(c0));
    };
    const Real low = fma(zz, pair(1.0 / 5, 1.0 / 7), pair(1.0, 1.0 / 3));
    const Real middle = fma(zz, pair(1.0 / 13, 1.0 / 15), pair(1.0 / 9, 1.0 / 11));
    const Real high = fma(zz, Real(1.0 / 21), pair(1.0 / 17, 1.0 / 19));
    const Real artanh = s * fma(zzzz, fma(zzzz, high, middle), low);
    return fma(twos, Real(kLn2High), fma(twos, Real(kLn2Low), 2.0 * artanh));
}

/// sin(a), within 5e-16 for |a| < 3e6 and within the rounding of a beyond.
template <class Real>
[[gnu::always_inline]] inline Real sine(Real a) {
    // pi in three parts, of which a multiple by less than 2^20 of the first two is exact.
    constexpr double kPiHigh = 3.14159265346825122833e+00, kPiMiddle = 1.21542010126079319532e-10,
                     kPiLow = 4.04453249742233291160e-21;
    const Real shifted = fma(a, Real(0.3183098861837907), Real(kRound));
    const Real halves = shifted - kRound;
    const Real r =
        fnma(halves, Real(kPiLow), fnma(halves, Real(kPiMiddle), fnma(halves, Real(kPiHigh), a)));
    // Taylor's series: |r| <= pi/2, and the next term is below 2e-18.
    const Real z = r * r, zz = z * z, zzzz = zz * zz;
    const auto pair = [z](double c0, double c1) __attribute__((always_inline)) {
        return fnma(z, Real(c1), Real(c0));
    };
    const Real low = fma(zz, pair(1.0 / 120, 1.0 / 5040), pair(1.0, 1.0 / 6));
    const Real middle =
        fma(zz, pair(1.0 / 6227020800, 1.0 / 1307674368000), pair(1.0 / 362880, 1.0 / 39916800));
    const Real high = fma(zz, Real(1.0 / 51090942171709440000.0),
                          pair(1.0 / 355687428096000, 1.0 / 121645100408832000.0));
    const Real result = r * fma(zzzz, fma(zzzz, high, middle), low);
    // Half a turn more changes the sign.
    return from_bits<Real>(to_bits(result) ^ (to_bits(shifted) << 63));
}

template <class Real>
struct CosineAndSine {
    Real cosine, sine;
};

/// Cosine and sine of any angle. A function of its own, so that a small angle costs one test.
template <class Real>
[[gnu::noinline, gnu::cold]] CosineAndSine<Real> far_cosine_and_sine(Real a) {
    return {sine(a + 1.5707963267948966), sine(a)};
}

/// Cosine and sine, by series for |a| < 0.888, within 2e-16; beyond by `sine`.
template <class Real>
[[gnu::always_inline]] inline CosineAndSine<Real> cosine_and_sine(Real a) {
    // Taylor's in a^2 up to Chebyshev's polynomial of degree 8 over this range: left out is 1e-19.
    constexpr double kRange = 0.79;  // of a^2
    constexpr double kCosine[] = {1.0,
                                  -0.49999999999999994,
                                  0.04166666666666572,
                                  -0.0013888888888793365,
                                  2.480158725406432e-05,
                                  -2.7557306382838617e-07,
                                  2.0874834007145035e-09,
                                  -1.132064266155941e-11};
    constexpr double kSine[] = {1.0,
                                -0.16666666666666666,
                                0.008333333333333278,
                                -0.0001984126984121359,
                                2.7557319196002105e-06,
                                -2.5052100824458378e-08,
                                1.6057911691506006e-10,
                                -7.558810571848394e-13};
    const Real z = a * a, zz = z * z, zzzz = zz * zz;
    const auto sum = [&](const auto& k) __attribute__((always_inline)) {
        const auto pair = [&](std::size_t i) __attribute__((always_inline)) {
            return fma(z, Real(k[i + 1]), Real(k[i]));
        };
        return fma(zzzz, fma(zz, pair(6), pair(4)), fma(zz, pair(2), pair(0)));
    };
    CosineAndSine<Real> result = {sum(kCosine), a * sum(kSine)};
    const auto far = !(z < kRange);
    if (any(far)) [[unlikely]] {
        const CosineAndSine<Real> there = far_cosine_and_sine(a);
        result.cosine = select(far, there.cosine, result.cosine);
        result.sine = select(far, there.sine, result.sine);
    }
    return result;
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
    const Real p = fma(f * f, Real(0.24022651), fma(f, Real(0.69314718), Real(1.0)));
    return from_bits<Real>(to_bits(p) + (to_bits(shifted) << 52));
}

}  // namespace stickslip
