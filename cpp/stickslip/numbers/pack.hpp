#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#if defined(__AVX2__)
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

/// Calls `visit` with each number of a struct of numbers, or with those of several that are alike,
/// as of a pack and of one run. Such a struct says what it has by members(), a tuple of references
/// to numbers, to arrays of them, and to such structs.
template <class First, class... More>
[[gnu::always_inline]] constexpr void visit_numbers(const auto& visit, First&& first,
                                                    More&&... more) {
    using Struct = std::remove_cvref_t<First>;
    if constexpr (requires { first.members(); }) {
        visit_numbers(visit, first.members(), more.members()...);
    } else if constexpr (requires { std::tuple_size<Struct>::value; }) {
        [[maybe_unused]] const auto at = [&]<std::size_t I>(std::integral_constant<std::size_t, I>)
            __attribute__((always_inline)) {
            visit_numbers(visit, std::get<I>(first), std::get<I>(more)...);
        };
        [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
            (at(std::integral_constant<std::size_t, I>()), ...);
        }
        (std::make_index_sequence<std::tuple_size_v<Struct>>());
    } else {
        visit(first, more...);
    }
}

/// Whether a struct of one run lists all that it has.
template <class Struct>
inline constexpr bool kListsAll = [] {
    Struct numbers = {};
    std::size_t count = 0;
    visit_numbers([&](double&) { ++count; }, numbers);
    return count * sizeof(double) == sizeof(Struct);
}();

/// `target` becomes `source` where `where` holds; both are numbers of the type Real throughout.
template <class Real, class Numbers>
[[gnu::always_inline]] inline void blend(MaskOf<Real> where, Numbers& target, Numbers& source) {
    if constexpr (std::is_same_v<Real, double>) {
        if (where) target = source;
    } else {
        const auto choose = [&](Real & to, const Real& from) __attribute__((always_inline)) {
            to = select(where, from, to);
        };
        visit_numbers(choose, target, source);
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

/// The square root, which IEEE 754 rounds as it does a sum.
inline double root(double a) {
    return std::sqrt(a);
}
template <int N>
[[gnu::always_inline]] inline Pack<N> root(Pack<N> a) {
#if defined(__AVX2__)
    if constexpr (N == 4) {
        return Pack<N>(std::bit_cast<typename Pack<N>::Vector>(_mm256_sqrt_pd(a.v)));
    }
#endif
#if defined(__AVX512F__)
    if constexpr (N == 8) {
        // With all members: the form without a mask has a warning of uninitialized numbers.
        return Pack<N>(std::bit_cast<typename Pack<N>::Vector>(_mm512_maskz_sqrt_pd(0xff, a.v)));
    }
#endif
    Pack<N> result;
    for (int i = 0; i < N; ++i) result.v[i] = std::sqrt(a.v[i]);
    return result;
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

}  // namespace stickslip
