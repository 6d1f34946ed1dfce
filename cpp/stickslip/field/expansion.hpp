#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "stickslip/drive/circuit.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/field_shape.hpp"
#include "stickslip/field/turning_points.hpp"
#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/pack.hpp"

/// The field of the coils near the robot as a series about a place: in the plane of motion y = 0,
/// of dimension D = 2, and in space, of dimension 3. A `Series` says what differs: which
/// derivatives there are, and how they add up.
namespace stickslip {

/// Coordinates, m: x, z in the plane of motion; x, y, z in space.
template <class Real, int D>
using PlaceOf = std::array<Real, D>;
using Place = PlaceOf<double, 3>;

/// Field and gradient in the plane of motion. The curl is zero, so dBx/dz = dBz/dx.
template <class Real>
struct PlanarFieldOf {
    Real bx = 0.0, bz = 0.0;                        ///< T
    Real dbx_dx = 0.0, dbx_dz = 0.0, dbz_dz = 0.0;  ///< T/m
};
using PlanarField = PlanarFieldOf<double>;

/// Field and gradient in space. Both divergence and curl are zero, so that five derivatives are all
/// of them.
struct SpatialFieldValue {
    double bx, by, bz;          ///< T
    double xx, xy, xz, yy, yz;  ///< T/m, dB_x/dx, dB_x/dy ...

    double zz() const { return -(xx + yy); }
};

template <class Real, int D>
struct Series;

template <class Real>
struct Series<Real, 2> {
    // Derivatives of the potential, bx bz | gxx gxz gzz | xxx xxz xzz zzz: of a near centre.
    using Terms = std::array<Real, 9>;
    // The same, and | xxxx xxxz xxzz xzzz zzzz.
    using FarTerms = std::array<Real, 14>;
    using Value = PlanarFieldOf<Real>;

    /// Value of the series at a displacement (m) from the centre.
    [[gnu::always_inline]] static Value at(const Terms& terms, Real dx, Real dz);
    [[gnu::always_inline]] static Value at(const FarTerms& terms, Real dx, Real dz);
    /// The terms about a near centre at a displacement from the far one.
    [[gnu::always_inline]] static Terms moved(const FarTerms& terms,
                                              const PlaceOf<Real, 2>& distance);
};

template <>
struct Series<double, 3> {
    // Derivatives of the potential, of each order those without z first, then those with one; the
    // others follow from Laplace's equation: x y | z | xx xy yy | xz yz | xxx xxy xyy yyy | xxz xyz
    // yyz | xxxx xxxy xxyy xyyy yyyy | xxxz xxyz xyyz yyyz
    using Terms = std::array<double, 24>;
    using FarTerms = Terms;
    using Value = SpatialFieldValue;
    /// Index of the first derivative of each order.
    static constexpr std::size_t kSecond = 3, kThird = 8, kFourth = 15;

    static Value at(const Terms& terms, double dx, double dy, double dz);
};

/// The field at one time as a polynomial about a centre.
template <class Real, int D = 2>
struct ExpansionOf {
    using Terms = typename Series<Real, D>::Terms;

    Terms terms;
    PlaceOf<Real, D> centre;
    Real tau;  ///< s, the time it holds for

    /// Value at a place, by its coordinates, m.
    template <class... Coordinates>
    [[gnu::always_inline]] auto operator()(const Coordinates&... place) const {
        return at(std::make_index_sequence<D>(), place...);
    }

    /// Value at a displacement from the centre, m.
    template <class... Coordinates>
    [[gnu::always_inline]] auto beside(const Coordinates&... displacement) const {
        return Series<Real, D>::at(terms, displacement...);
    }

private:
    // No loop, for which the compiler would have the coordinates as an array in memory.
    template <std::size_t... I, class... Coordinates>
    [[gnu::always_inline]] auto at(std::index_sequence<I...>, const Coordinates&... place) const {
        return Series<Real, D>::at(terms, (place - centre[I])...);
    }
};
using Expansion = ExpansionOf<double>;
using SpatialExpansion = ExpansionOf<double, 3>;

/// The field near a centre over a segment in which the currents are a + b tau + c exp(-rate tau).
template <class Real, int D = 2>
struct FieldSegment {
    using Terms = typename ExpansionOf<Real, D>::Terms;

    std::array<Terms, 3> basis;  ///< of a, b and c
    PlaceOf<Real, D> centre;
    Real rate;  ///< 1/s

    [[gnu::always_inline]] constexpr auto members() { return std::tie(basis, centre, rate); }

    [[gnu::always_inline]] ExpansionOf<Real, D> at(Real tau) const {
        ExpansionOf<Real, D> result;
        result.centre = centre;
        result.tau = tau;
        const Real fading = exponential(-rate * tau);
        combine(basis[0], basis[1], tau, basis[2], fading, result.terms);
        return result;
    }
};

/// Field about a far centre, to one order more, from which a FieldSegment about a near one is made.
template <class Real, int D = 2>
struct FarField {
    using Terms = typename Series<Real, D>::FarTerms;

    std::array<Terms, 3> basis;
    PlaceOf<Real, D> centre;

    [[gnu::always_inline]] constexpr auto members() { return std::tie(basis, centre); }

    /// Moves the near centre to a place.
    [[gnu::always_inline]] void move(const PlaceOf<Real, D>& place,
                                     FieldSegment<Real, D>& near) const {
        for (std::size_t b = 0; b < basis.size(); ++b) {
            near.basis[b] = Series<Real, D>::moved(basis[b], distance_to(place));
        }
        near.centre = place;
    }
    [[gnu::always_inline]] PlaceOf<Real, D> distance_to(const PlaceOf<Real, D>& place) const {
        PlaceOf<Real, D> result;
        for (std::size_t i = 0; i < D; ++i) result[i] = place[i] - centre[i];
        return result;
    }
};

/// Whether a coordinate of a place is more than `reach` m from that of a centre.
template <class Real, std::size_t D>
[[gnu::always_inline]] inline MaskOf<Real> is_far(const std::array<Real, D>& place,
                                                  const std::array<Real, D>& centre, Real reach) {
    MaskOf<Real> result = magnitude(place[0] - centre[0]) > reach;
    for (std::size_t i = 1; i < D; ++i) {
        result = result | (magnitude(place[i] - centre[i]) > reach);
    }
    return result;
}

/// Contribution of one exponential of the currents, after the first, to the field of a segment.
template <class Real, int D = 2>
struct FurtherExponential {
    using Terms = typename ExpansionOf<Real, D>::Terms;
    using FarTerms = typename Series<Real, D>::FarTerms;

    Terms basis;
    FarTerms far;
    Real rate;  ///< 1/s, zero where there is no such exponential

    [[gnu::always_inline]] constexpr auto members() { return std::tie(basis, far, rate); }

    /// Where there is no such exponential the terms are minus zero: adding it changes no bit.
    static constexpr double kNothing = -0.0;

    [[gnu::always_inline]] void add(Real tau, ExpansionOf<Real, D>& expansion) const {
        const Real fading = exponential(-rate * tau);
        for (std::size_t i = 0; i < basis.size(); ++i) {
            expansion.terms[i] = fma(basis[i], fading, expansion.terms[i]);
        }
    }
};

/// Box in which the model of the set-up holds, by two corners.
template <class Real, int D = 2>
struct WorkspaceOf {
    PlaceOf<Real, D> low, high;

    [[gnu::always_inline]] constexpr auto members() { return std::tie(low, high); }

    /// Whether a place is inside; false for a coordinate that is NaN.
    [[gnu::always_inline]] auto holds(const PlaceOf<Real, D>& place) const {
        auto result = (place[0] > low[0]) & (place[0] < high[0]);
        for (std::size_t i = 1; i < D; ++i) {
            result = result & ((place[i] > low[i]) & (place[i] < high[i]));
        }
        return result;
    }
};

/// Field and gradient at the robot per ampere of one coil.
struct CoilField {
    std::array<double, 3> field = {};  ///< T/A
    /// T/(m A), gradient of the component along the robot's heading, along x and y.
    std::array<double, 2> slope = {};
};

/// The field of the driven coils near the robot and over one segment of voltage.
///
/// The field derives from a potential, which is expanded to fourth order about a far centre; its
/// coefficients come from the analytic field and gradient at the centre and at points about it.
/// Inside the reach of the centre the field is then within 1e-9 of the full sum of Eqs. (4)-(6)
/// (cpp/tests/test_expansion.cpp), at a twentieth of its cost. Coils smaller than those of Table I
/// have a smaller reach, in proportion; with a map it is in proportion to the map. In the plane,
/// terms about a near centre, which follows the robot, are derived from it to third order: nine
/// instead of fourteen at each stage of a step. In space the two centres are the same.
///
/// In space, a setting that is turned by 90 degrees about z has the same bits: every sum is ordered
/// so that x and y may change places.
template <int D>
class LocalFieldOf {
public:
    using Centre = PlaceOf<double, D>;

    static constexpr double kReach = 1.5e-4;  ///< m, the most that the robot may be from the centre

    /// gain: factor on each coil's field; a coil that never has current gets zero and costs
    /// nothing. ambient: a uniform field along the coordinates, T.
    LocalFieldOf(const CoilSet& coils, const PerCoil& gain, const Centre& ambient = {});

    /// Factor on the field of the coils from now on; `shape` has to outlive this.
    void set_shape(const FieldShape& shape) { shape_ = &shape; }
    bool has_shape() const { return shape_ != nullptr; }
    /// Factor of the shape `tau` seconds into the segment, 1 without a shape.
    double factor(double tau) const {
        return shape_ ? shape_->factor(segment_.start + tau, segment_.field_currents(tau)) : 1.0;
    }

    void set_segment(const CurrentSegment& segment);
    /// Begins a segment with the robot at a place, which alone decides the centre, a point of a
    /// grid, so that many segments share one expansion.
    void begin_segment(const CurrentSegment& segment, const Centre& place);

    const PerCoil& gain() const { return gain_; }
    bool has_coils() const { return gain_ != PerCoil{}; }
    /// Sets the gains anew where a coil gets its first current.
    void set_gain(const PerCoil& gain);

    /// Moves the near centre to the robot once it is more than kNear of the reach away, and the far
    /// one once it is more than half.
    void rebase(const Centre& place);
    /// Moves both to the robot where it has gone half the reach from the far one; whether it has.
    bool recentre(const Centre& place);
    /// Takes over the near centre that a kernel has moved (run/step_kernel.cpp).
    void set_near(const FieldSegment<double, D>& near) { course_ = near; }
    void set_near(std::size_t j, const FurtherExponential<double, D>& near) {
        further_[j - 1].basis = near.basis;
    }
    const Centre& centre() const { return course_.centre; }
    /// Distance from its centre within which an expansion holds, m.
    double reach() const { return reach_; }
    /// Reach of a near centre, as a part of the reach. At 0.05, frozen runs differed by up to 3e-8
    /// of their velocity; at 0.01 by up to 3e-9. Both take the same time.
    static constexpr double kNear = 0.01;

    /// Half the time constant of the fastest exponential of the segment, s.
    double min_time_constant() const { return min_time_constant_; }

    /// The robot has come so near to a coil's plane, or to the end of the map, that the model of
    /// the set-up ends.
    bool outside() const { return outside_; }
    /// Box in which the robot may be; unbounded without coils that drive.
    const WorkspaceOf<double, D>& workspace() const { return workspace_; }

    /// The expansion at `tau` seconds into the segment. It does not depend on the robot's state, so
    /// an integrator can have it ready before a stage begins.
    ExpansionOf<double, D> at(double tau) const { return sum_at(tau); }

    /// The field over the segment at a place, without a shape; the caller sets `segment`.
    FieldCourse course(const Centre& place) const;
    /// Field and gradient of each coil per ampere at `centre`, times its gain. heading: rad.
    PerCoilOf<CoilField> of_coils(const Centre& place, double heading = 0.0) const;

    /// The segment as the formulas see it, where no shape multiplies it: its first exponential.
    const FieldSegment<double, D>& segment() const { return course_; }
    const FarField<double, D>& far() const { return far_; }
    /// Contribution of exponential j >= 1; the first, j = 0, is in `segment`.
    const FurtherExponential<double, D>& further(std::size_t j) const { return further_[j - 1]; }

private:
    using Expansion = ExpansionOf<double, D>;
    using Terms = typename Expansion::Terms;
    using FarTerms = typename Series<double, D>::FarTerms;

    [[gnu::always_inline]] Expansion sum_at(double tau) const {
        // One name, in which it is made: a copy costs a hundredth of a run in the whole plane.
        const bool fades = segment_.swings == 0;
        Expansion result = fades ? course_.at(tau) : sum_with_swings(tau);
        const auto more = static_cast<std::size_t>(fades ? segment_.exponentials : 0);
        for (std::size_t j = 1; j < more; ++j) {
            further_[j - 1].add(tau, result);
        }
        if (shape_) multiply(tau, result);
        return result;
    }
    Expansion sum_with_swings(double tau) const;
    void set_workspace();
    void expand(const Centre& place);
    // Moves the near centre there.
    void approach(const Centre& place);
    void combine();
    void multiply(double tau, Expansion& expansion) const;
    /// Value at a place of the series with these terms about the far centre.
    auto value(const FarTerms& terms, const Centre& place) const {
        return std::apply([&](auto... d) { return Series<double, D>::at(terms, d...); },
                          far_.distance_to(place));
    }
    /// Far terms of the currents' function of time `b`.
    FarTerms& basis(std::size_t b) { return b < 3 ? far_.basis[b] : further_[b - 3].far; }
    const FarTerms& basis(std::size_t b) const {
        return b < 3 ? far_.basis[b] : further_[b - 3].far;
    }

    const CoilSet* coils_;
    const FieldShape* shape_ = nullptr;
    double reach_;
    WorkspaceOf<double, D> workspace_;
    double min_time_constant_ = 0.0;
    PerCoil gain_;
    Centre ambient_;
    CurrentSegment segment_;
    bool expanded_ = false;
    bool outside_ = false;
    std::array<FarTerms, kCoilCount> unit_ = {};  // per ampere of each coil
    FarField<double, D> far_ = {};
    FieldSegment<double, D> course_ = {};
    // The second exponential and the functions after it.
    std::array<FurtherExponential<double, D>, kMaxBasis - 3> further_ = {};
};
using LocalField = LocalFieldOf<2>;
using SpatialField = LocalFieldOf<3>;

/// Compiled apart: in space it is too long to be in every phase.
template <>
SpatialExpansion LocalFieldOf<3>::at(double tau) const;

template <class Real>
inline PlanarFieldOf<Real> Series<Real, 2>::at(const Terms& t, Real dx, Real dz) {
    // The gradient there, and half way, which is its mean on the way. In an order that leaves
    // little to do once the displacement is known.
    const auto gradient = [&](std::size_t i, Real x, Real z) __attribute__((always_inline)) {
        return fma(z, dz, fma(x, dx, t[i]));
    };
    const Real xxx = 0.5 * t[5], xxz = 0.5 * t[6], xzz = 0.5 * t[7], zzz = 0.5 * t[8];
    const Real xx = gradient(2, xxx, xxz), xz = gradient(3, xxz, xzz), zz = gradient(4, xzz, zzz);
    return {fma(xx, dx, fma(xz, dz, t[0])), fma(xz, dx, fma(zz, dz, t[1])), gradient(2, t[5], t[6]),
            gradient(3, t[6], t[7]), gradient(4, t[7], t[8])};
}

template <class Real>
inline typename Series<Real, 2>::Terms Series<Real, 2>::moved(const FarTerms& t,
                                                              const PlaceOf<Real, 2>& distance) {
    const Real dx = distance[0], dz = distance[1], half_x = 0.5 * dx, half_z = 0.5 * dz;
    const auto plus =
        [](Real first, Real xs, Real x, Real zs, Real z) __attribute__((always_inline)) {
        return fma(zs, z, fma(xs, x, first));
    };
    // With the fourth derivatives Q, the third ones T, the gradient G and the field B they are
    // T + Q d, G + (T + Q d / 2) d and B + (G + (T + Q d / 3) d / 2) d.
    Terms result;
    std::array<Real, 4> for_gradient, for_field;
    for (std::size_t i = 0; i < 4; ++i) {
        const Real change = fma(t[10 + i], dz, t[9 + i] * dx);
        result[5 + i] = t[5 + i] + change;
        for_gradient[i] = fma(Real(0.5), change, t[5 + i]);
        for_field[i] = fma(Real(1.0 / 3.0), change, t[5 + i]);
    }
    std::array<Real, 3> mean;
    for (std::size_t i = 0; i < 3; ++i) {
        result[2 + i] = plus(t[2 + i], for_gradient[i], dx, for_gradient[i + 1], dz);
        mean[i] = plus(t[2 + i], for_field[i], half_x, for_field[i + 1], half_z);
    }
    for (std::size_t i = 0; i < 2; ++i) result[i] = plus(t[i], mean[i], dx, mean[i + 1], dz);
    return result;
}

template <class Real>
inline PlanarFieldOf<Real> Series<Real, 2>::at(const FarTerms& t, Real dx, Real dz) {
    const Terms there = moved(t, {dx, dz});
    return {there[0], there[1], there[2], there[3], there[4]};
}

/// The derivative of order N of the potential contracted with a displacement: one of order N - 1,
/// in the order of the terms in space.
template <std::size_t N, class Real>
[[gnu::always_inline]] inline std::array<Real, 2 * N - 1> contract(const Real* t,
                                                                   const std::array<Real, 3>& d) {
    constexpr std::size_t kWithZ = N + 1;
    std::array<Real, 2 * N - 1> result;
    for (std::size_t i = 0; i < N; ++i) {
        result[i] = (t[i] * d[0] + t[i + 1] * d[1]) + t[kWithZ + i] * d[2];
    }
    for (std::size_t i = 0; i + 1 < N; ++i) {
        const Real with_zz = t[i] + t[i + 2];  // its negative
        result[N + i] = (t[kWithZ + i] * d[0] + t[kWithZ + i + 1] * d[1]) - with_zz * d[2];
    }
    return result;
}

inline SpatialFieldValue Series<double, 3>::at(const Terms& terms, double dx, double dy,
                                               double dz) {
    using Pair = Pack<2>;  // lane 0: for the gradient; lane 1: for the field
    const std::array<double, 3> d = {dx, dy, dz};
    const std::array<Pair, 3> dd = {Pair(d[0]), Pair(d[1]), Pair(d[2])};
    // The series of the gradient is G + (T + Q d / 2) d, that of the field
    // B + (G + (T + Q d / 3) d / 2) d.
    const Pair per_third(Pair::Vector{1.0 / 2.0, 1.0 / 3.0});
    const Pair per_second(Pair::Vector{1.0, 1.0 / 2.0});
    const std::array<double, 7> of_fourth = contract<4>(&terms[kFourth], d);
    std::array<Pair, 7> third;
    for (std::size_t i = 0; i < third.size(); ++i) {
        third[i] = Pair(terms[kThird + i]) + per_third * Pair(of_fourth[i]);
    }
    const std::array<Pair, 5> of_third = contract<3>(third.data(), dd);
    std::array<double, 5> gradient, mean;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        const Pair second = Pair(terms[kSecond + i]) + per_second * of_third[i];
        gradient[i] = second.v[0];
        mean[i] = second.v[1];
    }
    const std::array<double, 3> field = contract<2>(mean.data(), d);
    return {terms[0] + field[0], terms[1] + field[1], terms[2] + field[2], gradient[0],
            gradient[1],         gradient[3],         gradient[2],         gradient[4]};
}

}  // namespace stickslip
