#pragma once

#include <array>

#include "stickslip/circuit.hpp"
#include "stickslip/coil_set.hpp"
#include "stickslip/field_shape.hpp"
#include "stickslip/local_field.hpp"

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
    // Derivatives of the potential; those that are left out follow from Laplace's equation:
    // x y z | xx xy xz yy yz | xxx xxy xxz xyy xyz yyy yyz | xxxx xxxy xxxz xxyy xxyz xyyy xyyz
    // yyyy yyyz
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

/// Contractions of a derivative of the potential with a displacement. `t` has its independent terms
/// in the order of `SpatialExpansion`; what is left out is minus the sum of two others.

[[gnu::always_inline]] inline std::array<double, 7> contract_fourth(const double* t,
                                                                    const Place& d) {
    const double xxxx = t[0], xxxy = t[1], xxxz = t[2], xxyy = t[3], xxyz = t[4], xyyy = t[5],
                 xyyz = t[6], yyyy = t[7], yyyz = t[8];
    const double xxzz = -(xxxx + xxyy), xyzz = -(xxxy + xyyy), yyzz = -(xxyy + yyyy);
    return {(xxxx * d.x + xxxy * d.y) + xxxz * d.z, (xxxy * d.x + xxyy * d.y) + xxyz * d.z,
            (xxxz * d.x + xxyz * d.y) + xxzz * d.z, (xxyy * d.x + xyyy * d.y) + xyyz * d.z,
            (xxyz * d.x + xyyz * d.y) + xyzz * d.z, (xyyy * d.x + yyyy * d.y) + yyyz * d.z,
            (xyyz * d.x + yyyz * d.y) + yyzz * d.z};
}

[[gnu::always_inline]] inline std::array<double, 5> contract_third(const double* t,
                                                                   const Place& d) {
    const double xxx = t[0], xxy = t[1], xxz = t[2], xyy = t[3], xyz = t[4], yyy = t[5], yyz = t[6];
    const double xzz = -(xxx + xyy), yzz = -(xxy + yyy);
    return {(xxx * d.x + xxy * d.y) + xxz * d.z, (xxy * d.x + xyy * d.y) + xyz * d.z,
            (xxz * d.x + xyz * d.y) + xzz * d.z, (xyy * d.x + yyy * d.y) + yyz * d.z,
            (xyz * d.x + yyz * d.y) + yzz * d.z};
}

[[gnu::always_inline]] inline std::array<double, 3> contract_second(const double* t,
                                                                    const Place& d) {
    const double xx = t[0], xy = t[1], xz = t[2], yy = t[3], yz = t[4];
    return {(xx * d.x + xy * d.y) + xz * d.z, (xy * d.x + yy * d.y) + yz * d.z,
            (xz * d.x + yz * d.y) - (xx + yy) * d.z};
}

}  // namespace expansion

inline SpatialFieldValue SpatialExpansion::operator()(double x, double y, double z) const {
    const Place d = {x - centre.x, y - centre.y, z - centre.z};
    using namespace expansion;
    const std::array<double, 7> fourth = contract_fourth(&terms[kFourth], d);
    // Of the gradient and of the field the series are G + (T + Q d / 2) d and
    // B + (G + (T + Q d / 3) d / 2) d.
    std::array<double, 7> for_gradient, for_field;
    for (std::size_t i = 0; i < 7; ++i) {
        for_gradient[i] = terms[kThird + i] + 0.5 * fourth[i];
        for_field[i] = terms[kThird + i] + (1.0 / 3.0) * fourth[i];
    }
    std::array<double, 5> gradient = contract_third(for_gradient.data(), d);
    std::array<double, 5> mean = contract_third(for_field.data(), d);
    for (std::size_t i = 0; i < 5; ++i) {
        gradient[i] += terms[kSecond + i];
        mean[i] = terms[kSecond + i] + 0.5 * mean[i];
    }
    const std::array<double, 3> field = contract_second(mean.data(), d);
    return {terms[0] + field[0], terms[1] + field[1], terms[2] + field[2], gradient[0],
            gradient[1],         gradient[2],         gradient[3],         gradient[4]};
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
    /// For a coil that had none.
    void set_gain(const PerCoil& gain);
    const PerCoil& gain() const { return gain_; }

    /// Moves the centre to the robot where it has left half the reach.
    void rebase(const Place& place);
    double reach() const { return reach_; }  ///< m, as of a LocalField
    /// Half the time constant of the fastest exponential of the stretch, s.
    double min_time_constant() const { return min_time_constant_; }
    /// The robot has come so near to a coil's plane that the model of the set-up ends.
    bool outside() const { return outside_; }

    /// The expansion at `tau` seconds into the stretch.
    SpatialExpansion at(double tau) const;

    /// What goes on from stretch to stretch; the next `set_segment` completes a restored one.
    struct Memory {
        PerCoil gain = {};
        Place centre;
        bool expanded = false, outside = false;
    };
    Memory memory() const { return {gain_, centre_, expanded_, outside_}; }
    void restore(const Memory& memory);

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
