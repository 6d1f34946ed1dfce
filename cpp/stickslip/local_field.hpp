#pragma once

#include <array>
#include <cmath>

#include "stickslip/circuit.hpp"
#include "stickslip/coil_set.hpp"

namespace stickslip {

/// Field and gradient in the plane of motion y = 0. The curl is zero, so dBx/dz = dBz/dx.
struct PlanarField {
    double bx = 0.0, bz = 0.0;                        ///< T
    double dbx_dx = 0.0, dbx_dz = 0.0, dbz_dz = 0.0;  ///< T/m
};

/// The field of the driven coils near the robot and over one stretch of voltage.
///
/// In the plane of motion the field derives from a potential, which is expanded to fourth order
/// about a centre near the robot; its coefficients come from the analytic field and gradient at the
/// centre and at four points `kSpacing` away. Inside `kReach` of the centre the field is then
/// within 1e-9 of the full sum of Eqs. (4)-(6) (tests/field), at a twentieth of its cost.
class LocalField {
public:
    static constexpr double kReach = 1.5e-4;    ///< m, the robot is never further from the centre
    static constexpr double kSpacing = 1.0e-4;  ///< m

    /// driven: a coil that is never driven costs nothing. ambient_x, ambient_z: a uniform field, T.
    LocalField(const CoilSet& coils, const std::array<bool, kCoilCount>& driven, double ambient_x,
               double ambient_z);

    void set_segment(const CurrentSegment& segment);

    /// Moves the centre to the robot where it has left half the reach, and takes `tau` as the time
    /// about which exponentials are expanded.
    void rebase(double tau, double x, double z);

    /// The robot has come so near to a coil's plane that the model of the set-up ends.
    bool outside() const { return outside_; }

    /// Field at `tau` seconds into the stretch at (x, 0, z).
    PlanarField at(double tau, double x, double z) const;

private:
    // bx bz | gxx gxz gzz | xxx xxz xzz zzz | xxxx xxxz xxzz xzzz zzzz, padded for the vector unit
    static constexpr std::size_t kTerms = 14;
    using Terms = std::array<double, kTerms>;

    void expand(double x, double z);
    void combine();
    double decay(double tau, std::size_t j) const;

    const CoilSet* coils_;
    std::array<bool, kCoilCount> driven_;
    double ambient_x_, ambient_z_;
    CurrentSegment segment_;
    double centre_x_ = 0.0, centre_z_ = 0.0;
    bool expanded_ = false;
    bool outside_ = false;
    std::array<Terms, kCoilCount> unit_ = {};  // per ampere of each coil
    std::array<Terms, kMaxBasis> basis_ = {};  // per function of time
    double base_tau_ = 0.0;
    std::array<double, kMaxExponentials> base_decay_ = {};
};

/// exp(-rate tau), from its value at the base time by a short series where the two are near.
inline double LocalField::decay(double tau, std::size_t j) const {
    const double u = segment_.rate[j] * (tau - base_tau_);
    if (std::abs(u) > 0.0625) return std::exp(-segment_.rate[j] * tau);
    // The next term, u^9/9!, is below 4e-17.
    const double series =
        1.0 -
        u * (1.0 -
             u * (1.0 / 2 -
                  u * (1.0 / 6 -
                       u * (1.0 / 24 -
                            u * (1.0 / 120 - u * (1.0 / 720 - u * (1.0 / 5040 - u / 40320)))))));
    return base_decay_[j] * series;
}

inline PlanarField LocalField::at(double tau, double x, double z) const {
    Terms c;
    const double first = decay(tau, 0);
    for (std::size_t i = 0; i < kTerms; ++i) {
        c[i] = basis_[0][i] + basis_[1][i] * tau + basis_[2][i] * first;
    }
    if (segment_.exponentials > 1) {
        const double second = decay(tau, 1);
        for (std::size_t i = 0; i < kTerms; ++i) c[i] += basis_[3][i] * second;
    }
    const double dx = x - centre_x_;
    const double dz = z - centre_z_;
    const double xx = 0.5 * dx * dx, xz = dx * dz, zz = 0.5 * dz * dz;
    // The gradient in terms of equal degree; a homogeneous term of degree n in the gradient gives
    // (x, z) . term / (n + 1) in the field (Euler).
    const double l_xx = c[5] * dx + c[6] * dz;
    const double l_xz = c[6] * dx + c[7] * dz;
    const double l_zz = c[7] * dx + c[8] * dz;
    const double q_xx = c[9] * xx + c[10] * xz + c[11] * zz;
    const double q_xz = c[10] * xx + c[11] * xz + c[12] * zz;
    const double q_zz = c[11] * xx + c[12] * xz + c[13] * zz;
    constexpr double third = 1.0 / 3.0;
    const double s_xx = c[2] + 0.5 * l_xx + third * q_xx;
    const double s_xz = c[3] + 0.5 * l_xz + third * q_xz;
    const double s_zz = c[4] + 0.5 * l_zz + third * q_zz;
    PlanarField field;
    field.bx = c[0] + s_xx * dx + s_xz * dz;
    field.bz = c[1] + s_xz * dx + s_zz * dz;
    field.dbx_dx = c[2] + l_xx + q_xx;
    field.dbx_dz = c[3] + l_xz + q_xz;
    field.dbz_dz = c[4] + l_zz + q_zz;
    return field;
}

}  // namespace stickslip
