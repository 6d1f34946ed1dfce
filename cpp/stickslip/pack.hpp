#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

/// Numbers that the formulas of a step are written in: a double, or a pack of doubles of which each
/// belongs to another run. Every operation on a pack is the IEEE operation on each of its members,
/// so that a run has the same bits in a pack as alone.
namespace stickslip {

template <int N>
struct Registers;
template <>
struct Registers<2> {
    using Vector [[gnu::vector_size(16)]] = double;
    using Bits [[gnu::vector_size(16)]] = std::int64_t;
};
template <>
struct Registers<4> {
    using Vector [[gnu::vector_size(32)]] = double;
    using Bits [[gnu::vector_size(32)]] = std::int64_t;
};
template <>
struct Registers<8> {
    using Vector [[gnu::vector_size(64)]] = double;
    using Bits [[gnu::vector_size(64)]] = std::int64_t;
};

/// N doubles in one register (N a power of two that the machine's registers hold).
template <int N>
struct Pack {
    static constexpr int kSize = N;
    using Vector = typename Registers<N>::Vector;
    using Bits = typename Registers<N>::Bits;
    /// All bits set where a condition holds.
    struct Mask {
        static constexpr int kSize = N;
        Bits bits;

        friend Mask operator&(Mask a, Mask b) { return {a.bits & b.bits}; }
        friend Mask operator|(Mask a, Mask b) { return {a.bits | b.bits}; }
        friend Mask operator!(Mask a) { return {~a.bits}; }
    };

    Vector v;

    Pack() = default;
    Pack(Vector vector) : v(vector) {}
    Pack(double value) : v(value - Vector{}) {}

    friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
    friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
    friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
    friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
    friend Pack operator-(Pack a) { return -a.v; }
    Pack& operator+=(Pack b) {
        v += b.v;
        return *this;
    }
    Pack& operator*=(Pack b) {
        v *= b.v;
        return *this;
    }
    friend Mask operator<(Pack a, Pack b) { return {a.v < b.v}; }
    friend Mask operator>(Pack a, Pack b) { return {a.v > b.v}; }
    friend Mask operator<=(Pack a, Pack b) { return {a.v <= b.v}; }
    friend Mask operator>=(Pack a, Pack b) { return {a.v >= b.v}; }
};

/// Two neighbours in memory, for the pairs of one run.
[[gnu::always_inline]] inline Pack<2> pair(const double* from) {
    Pack<2> result;
    std::memcpy(&result.v, from, sizeof result.v);
    return result;
}
[[gnu::always_inline]] inline void store(Pack<2> numbers, double* to) {
    std::memcpy(to, &numbers.v, sizeof numbers.v);
}

template <class Real>
struct MaskType {
    using Type = bool;
};
template <int N>
struct MaskType<Pack<N>> {
    using Type = typename Pack<N>::Mask;
};
/// The outcome of a comparison.
template <class Real>
using MaskOf = typename MaskType<Real>::Type;

inline bool any(bool mask) {
    return mask;
}
/// Bit i set where the condition holds for member i.
template <class Mask, int N = Mask::kSize>
[[gnu::always_inline]] inline unsigned members(Mask mask) {
#if defined(__SSE2__)
    if constexpr (N == 2) {
        return static_cast<unsigned>(_mm_movemask_pd(std::bit_cast<__m128d>(mask.bits)));
    }
#endif
#if defined(__AVX2__)
    if constexpr (N == 4) {
        return static_cast<unsigned>(_mm256_movemask_pd(std::bit_cast<__m256d>(mask.bits)));
    }
#endif
#if defined(__AVX512DQ__)
    if constexpr (N == 8) return _mm512_movepi64_mask(std::bit_cast<__m512i>(mask.bits));
#endif
    unsigned result = 0;
    for (int i = 0; i < N; ++i) result |= (mask.bits[i] != 0 ? 1u : 0u) << i;
    return result;
}
template <class Mask, int N = Mask::kSize>
[[gnu::always_inline]] inline bool any(Mask mask) {
    return members(mask) != 0;
}

/// `where ? yes : no`; both are computed.
inline double select(bool where, double yes, double no) {
    return where ? yes : no;
}
template <int N>
[[gnu::always_inline]] inline Pack<N> select(typename Pack<N>::Mask where, Pack<N> yes,
                                             Pack<N> no) {
    return Pack<N>(where.bits ? yes.v : no.v);
}

/// `target` becomes `source` where `where` holds; both are numbers of the type Real throughout.
template <class Real, class Numbers>
[[gnu::always_inline]] inline void blend(MaskOf<Real> where, Numbers& target,
                                         const Numbers& source) {
    if constexpr (std::is_same_v<Real, double>) {
        if (where) target = source;
    } else {
        static_assert(sizeof(Numbers) % sizeof(Real) == 0);
        auto* to = reinterpret_cast<Real*>(&target);
        const auto* from = reinterpret_cast<const Real*>(&source);
        for (std::size_t k = 0; k < sizeof(Numbers) / sizeof(Real); ++k) {
            to[k] = select(where, from[k], to[k]);
        }
    }
}

/// As std::min and std::max: the first where the two do not compare.
template <class Real>
[[gnu::always_inline]] inline Real lesser(Real a, Real b) {
    return select(b < a, b, a);
}
template <class Real>
[[gnu::always_inline]] inline Real greater(Real a, Real b) {
    return select(a < b, b, a);
}

inline double magnitude(double a) {
    return std::abs(a);
}
template <int N>
[[gnu::always_inline]] inline Pack<N> magnitude(Pack<N> a) {
    using Bits = typename Pack<N>::Bits;
    const Bits sign = Bits{} + INT64_MIN;
    return Pack<N>(std::bit_cast<typename Pack<N>::Vector>(std::bit_cast<Bits>(a.v) & ~sign));
}

/// Bits of numbers as integers of the same size, and back.
inline std::int64_t to_bits(double a) {
    return std::bit_cast<std::int64_t>(a);
}
template <int N>
[[gnu::always_inline]] inline typename Pack<N>::Bits to_bits(Pack<N> a) {
    return std::bit_cast<typename Pack<N>::Bits>(a.v);
}

template <class Real, class Bits>
[[gnu::always_inline]] inline Real from_bits(const Bits& bits) {
    Real result;
    std::memcpy(&result, &bits, sizeof result);
    return result;
}

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
