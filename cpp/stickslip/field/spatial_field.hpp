#pragma once

#include <array>

#include "stickslip/drive/circuit.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/field_shape.hpp"
#include "stickslip/field/horizontal_field.hpp"
#include "stickslip/field/local_field.hpp"
#include "stickslip/field/turning_points.hpp"
#include "stickslip/numbers/pack.hpp"

namespace stickslip {

struct Place {
    double x = 0.0, y = 0.0, z = 0.0;  ///< m
};

/// Field and gradient at a place. Both divergence and curl are zero, so that five derivatives are
/// all of them.
struct SpatialFieldValue {
    double bx, by, bz;          ///< T
    double xx, xy, xz, yy, yz;  ///< T/m, dB_x/dx, dB_x/dy ...

    double zz() const { return -(xx + yy); }
};

/// The field at one time as a polynomial about a centre.
struct SpatialExpansion {
    // Derivatives of the potential, of each order those without z first, then those with one; the
    // others follow from Laplace's equation: x y | z | xx xy yy | xz yz | xxx xxy xyy yyy | xxz xyz
    // yyz | xxxx xxxy xxyy xyyy yyyy | xxxz xxyz xyyz yyyz
    static constexpr std::size_t kTerms = 24;
    using Terms = std::array<double, kTerms>;

    Terms terms;
    Place centre;
    double tau;         ///< s, the time it holds for
    double horizontal;  ///< T, size of (B_x, B_y) at the centre

    SpatialFieldValue operator()(double x, double y, double z) const;
};

namespace expansion {

/// Where derivatives of one order begin in the terms.
inline constexpr std::size_t kSecond = 3, kThird = 8, kFourth = 15;

/// The derivative of order N of the potential contracted with a displacement: one of order N - 1,
/// in the order of the terms.
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

}  // namespace expansion

inline SpatialFieldValue SpatialExpansion::operator()(double x, double y, double z) const {
    using namespace expansion;
    using Pair = Pack<2>;  // of what the gradient needs, and of what the field does
    const std::array<double, 3> d = {x - centre.x, y - centre.y, z - centre.z};
    const std::array<Pair, 3> dd = {Pair(d[0]), Pair(d[1]), Pair(d[2])};
    // Of the gradient and of the field the series are G + (T + Q d / 2) d and
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

/// The field of the driven coils near a robot that moves in the whole plane, over one stretch of
/// voltage. As a LocalField, of all places and not only those of the plane y = 0, where the field
/// across and its gradient count too; to fourth order, within 1e-9 of the full sum of Eqs. (4)-(6)
/// (cpp/tests/test_spatial_field.cpp).
///
/// A setting that is turned by 90 degrees about z has the same bits: every sum is ordered so that x
/// and y may change places.
class SpatialField {
public:
    /// gain: factor on each coil's field, zero for one that never has current. ambient: a uniform
    /// field, T.
    SpatialField(const CoilSet& coils, const PerCoil& gain, const std::array<double, 3>& ambient);

    /// What multiplies the field of the coils from now on; it has to outlive this.
    void set_shape(const FieldShape& shape) { shape_ = &shape; }

    void set_segment(const CurrentSegment& segment);
    /// As of a LocalField, with the robot at a place.
    void begin_stretch(const CurrentSegment& segment, const Place& place);
    /// For a coil that had none.
    void set_gain(const PerCoil& gain);
    const PerCoil& gain() const { return gain_; }

    /// Moves the centre to the robot where it has left half the reach.
    void rebase(const Place& place);
    const Place& centre() const { return centre_; }
    double reach() const { return reach_; }  ///< m, as of a LocalField
    /// Half the time constant of the fastest exponential of the stretch, s.
    double min_time_constant() const { return min_time_constant_; }
    /// The robot has come so near to a coil's plane that the model of the set-up ends.
    bool outside() const { return outside_; }

    /// The expansion at `tau` seconds into the stretch.
    SpatialExpansion at(double tau) const;
    /// The horizontal field at a place in the course of the stretch, but for its segment.
    HorizontalField horizontal(const Place& place) const;
    /// The field there, where no shape multiplies it, but for its segment.
    FieldCourse course(const Place& place) const;
    bool has_shape() const { return shape_ != nullptr; }
    /// What each coil makes there of a robot with that heading, with its gain.
    PerCoilOf<CoilField> of_coils(const Place& place, double heading) const;

private:
    using Terms = SpatialExpansion::Terms;

    void set_workspace();
    void expand(const Place& place);
    void combine();

    const CoilSet* coils_;
    const FieldShape* shape_ = nullptr;
    double reach_, min_time_constant_ = 0.0;
    Box workspace_;
    PerCoil gain_;
    std::array<double, 3> ambient_;
    CurrentSegment segment_;
    bool expanded_ = false, outside_ = false;
    Place centre_;
    std::array<Terms, kCoilCount> unit_ = {};  // per ampere of each coil
    std::array<Terms, kMaxBasis> basis_ = {};  // of the stretch
};

}  // namespace stickslip
