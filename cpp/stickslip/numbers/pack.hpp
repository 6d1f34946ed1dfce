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
/// so that a run has the same bits in a pack of any width.
namespace stickslip {

/// Processors that the steps of runs are compiled for (run/step_kernel.cpp). Packs carry theirs in
/// their type, so that the linker never takes the code for one for that for another.
enum class Processor { baseline, x86_64_v3, x86_64_v4 };

template <int N>
struct Registers;
template <>
struct Registers<1> {
    using Vector = double;
    using Bits = std::int64_t;
};
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
template <int N, Processor P = Processor::baseline>
struct Pack {
    static constexpr int kSize = N;
    using Vector = typename Registers<N>::Vector;
    using Bits = typename Registers<N>::Bits;
    /// All bits set where a condition holds.
    struct BitMask {
        static constexpr int kSize = N;
        Bits bits;

        friend BitMask operator&(BitMask a, BitMask b) { return {a.bits & b.bits}; }
        friend BitMask operator|(BitMask a, BitMask b) { return {a.bits | b.bits}; }
        friend BitMask operator!(BitMask a) { return {~a.bits}; }
    };
    using Mask = std::conditional_t<N == 1, bool, BitMask>;

    Vector v;

    Pack() = default;
    Pack(Vector vector) : v(vector) {}
    Pack(double value) requires(N > 1) : v(value - Vector{}) {}

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

    /// a b + c, rounded once where the processor can do so, else as written; see `fma(double ...)`.
    friend Pack fma(Pack a, Pack b, Pack c) { return fused<false>(a, b, c); }
    /// c - a b, likewise.
    friend Pack fnma(Pack a, Pack b, Pack c) { return fused<true>(a, b, c); }

private:
#if defined(__AVX512F__)
    static constexpr int kMostFused = 8;
#elif defined(__FMA__)
    static constexpr int kMostFused = 4;
#else
    static constexpr int kMostFused = 0;
#endif
    static_assert(P == Processor::baseline || N <= kMostFused, "compiled without its processor");
    template <bool kNegative>
    [[gnu::always_inline]] static Pack fused(Pack a, Pack b, Pack c) {
        if constexpr (P == Processor::baseline) {
            return kNegative ? c - a * b : a * b + c;
#if defined(__FMA__)
        } else if constexpr (N == 1) {
            return Pack(__builtin_fma(kNegative ? -a.v : a.v, b.v, c.v));
        } else if constexpr (N == 2) {
            return Pack(std::bit_cast<Vector>(kNegative ? _mm_fnmadd_pd(a.v, b.v, c.v)
                                                        : _mm_fmadd_pd(a.v, b.v, c.v)));
        } else if constexpr (N == 4) {
            return Pack(std::bit_cast<Vector>(kNegative ? _mm256_fnmadd_pd(a.v, b.v, c.v)
                                                        : _mm256_fmadd_pd(a.v, b.v, c.v)));
#endif
#if defined(__AVX512F__)
        } else if constexpr (N == 8) {
            return Pack(std::bit_cast<Vector>(kNegative ? _mm512_fnmadd_pd(a.v, b.v, c.v)
                                                        : _mm512_fmadd_pd(a.v, b.v, c.v)));
#endif
        }
    }
};

/// a b + c in one operation: packs that are compiled for a processor with fused multiply-add round
/// it once. For a double, which every processor has to handle, the product is rounded too.
inline double fma(double a, double b, double c) {
    return a * b + c;
}
/// c - a b, likewise.
inline double fnma(double a, double b, double c) {
    return c - a * b;
}

template <class Real>
struct MaskType {
    using Type = bool;
};
template <int N, Processor P>
struct MaskType<Pack<N, P>> {
    using Type = typename Pack<N, P>::Mask;
};
/// The outcome of a comparison.
template <class Real>
using MaskOf = typename MaskType<Real>::Type;
/// Whether a Real holds one number.
template <class Real>
inline constexpr bool kIsOne = std::is_same_v<MaskOf<Real>, bool>;

inline bool any(bool mask) {
    return mask;
}
inline unsigned members(bool mask) {
    return mask ? 1u : 0u;
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
template <int N, Processor P>
[[gnu::always_inline]] inline Pack<N, P> select(typename Pack<N, P>::Mask where, Pack<N, P> yes,
                                                Pack<N, P> no) {
    if constexpr (N == 1) {
        return where ? yes : no;
    } else {
        return Pack<N, P>(where.bits ? yes.v : no.v);
    }
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
    if constexpr (kIsOne<Real>) {
        if (where) target = source;
    } else {
        const auto choose = [&](Real & to, const Real& from) __attribute__((always_inline)) {
            to = select(where, from, to);
        };
        visit_numbers(choose, target, source);
    }
}

/// Minimum and maximum, as std::min and std::max: the first where the two do not compare.
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
template <int N, Processor P>
[[gnu::always_inline]] inline Pack<N, P> magnitude(Pack<N, P> a) {
    using Bits = typename Pack<N, P>::Bits;
    if constexpr (N == 1) {
        return Pack<N, P>(std::abs(a.v));
    } else {
        const Bits sign = Bits{} + INT64_MIN;
        return Pack<N, P>(
            std::bit_cast<typename Pack<N, P>::Vector>(std::bit_cast<Bits>(a.v) & ~sign));
    }
}

/// The square root, which IEEE 754 rounds as it does a sum.
inline double root(double a) {
    return std::sqrt(a);
}
template <int N, Processor P>
[[gnu::always_inline]] inline Pack<N, P> root(Pack<N, P> a) {
    if constexpr (N == 1) return Pack<N, P>(std::sqrt(a.v));
#if defined(__AVX2__)
    if constexpr (N == 4) {
        return Pack<N, P>(std::bit_cast<typename Pack<N, P>::Vector>(_mm256_sqrt_pd(a.v)));
    }
#endif
#if defined(__AVX512F__)
    if constexpr (N == 8) {
        // With all members: the form without a mask has a warning of uninitialized numbers.
        return Pack<N, P>(
            std::bit_cast<typename Pack<N, P>::Vector>(_mm512_maskz_sqrt_pd(0xff, a.v)));
    }
#endif
    if constexpr (N > 1) {
        Pack<N, P> result;
        for (int i = 0; i < N; ++i) result.v[i] = std::sqrt(a.v[i]);
        return result;
    }
}

/// Numbers of one run that stand side by side, in the width that is quickest.
template <class Real>
struct SideBySide {
    using Type = Pack<2>;
};
template <Processor P>
struct SideBySide<Pack<1, P>> {
    using Type = Pack<P == Processor::baseline ? 2 : 4, P>;
};

template <class Some, class Real>
[[gnu::always_inline]] inline Some side_by_side(const Real& first) {
    Some numbers;
    std::memcpy(&numbers.v, &first, sizeof numbers.v);
    return numbers;
}

/// a + b x + c y of arrays of numbers.
template <class Real, std::size_t N>
[[gnu::always_inline]] inline void combine(const std::array<Real, N>& a,
                                           const std::array<Real, N>& b, Real x,
                                           const std::array<Real, N>& c, Real y,
                                           std::array<Real, N>& result) {
    std::size_t i = 0;
    if constexpr (kIsOne<Real>) {
        using Some = typename SideBySide<Real>::Type;
        const auto all = [](Real of) __attribute__((always_inline)) {
            return Some(std::bit_cast<double>(of));
        };
        for (; i + Some::kSize <= N; i += Some::kSize) {
            const Some sum = fma(side_by_side<Some>(c[i]), all(y),
                                 fma(side_by_side<Some>(b[i]), all(x), side_by_side<Some>(a[i])));
            std::memcpy(&result[i], &sum.v, sizeof sum.v);
        }
    }
    for (; i < N; ++i) result[i] = fma(c[i], y, fma(b[i], x, a[i]));
}

/// Bits of numbers as integers of the same size, and back.
inline std::int64_t to_bits(double a) {
    return std::bit_cast<std::int64_t>(a);
}
template <int N, Processor P>
[[gnu::always_inline]] inline typename Pack<N, P>::Bits to_bits(Pack<N, P> a) {
    return std::bit_cast<typename Pack<N, P>::Bits>(a.v);
}

template <class Real, class Bits>
[[gnu::always_inline]] inline Real from_bits(const Bits& bits) {
    Real result;
    std::memcpy(&result, &bits, sizeof result);
    return result;
}

}  // namespace stickslip
