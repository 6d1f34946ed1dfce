#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "stickslip/drive/coil.hpp"
#include "stickslip/field/square_coil.hpp"

namespace stickslip {

/// A box along the axes of the device, m.
struct Box {
    Eigen::Vector3d low, high;

    /// Whether a point (m) lies in it or on its faces; not one with a coordinate that is NaN.
    bool holds(const Eigen::Vector3d& point) const {
        return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
    }
};

/// The field of five coils per ampere, fitted to a measured map.
///
/// Without a current in the box, B = grad Phi with a potential that obeys Laplace's equation, so
/// that Phi is a sum of regular solid harmonics; a constant (l = 0) makes no field. With u = (point
/// - centre of the box) / (half of its diagonal), those of degree l and order m are the real part
/// C_lm and the imaginary part S_lm of
///     R_lm = r^l P_l^m(cos theta) exp(i m phi) / (l + m)!   of u, without the phase (-1)^m,
/// the "scaled regular solid harmonics" of Helgaker, Joergensen and Olsen, Molecular
/// Electronic-Structure Theory, section 9.13. Their derivatives are harmonics of the degree below,
/// so that div B = 0 and curl B = 0 hold for whatever coefficients.
class FieldMap {
public:
    static constexpr std::size_t kMostDegree = 10;

    /// Number of harmonics from degree 1 to `degree`.
    static constexpr std::size_t count(std::size_t degree) { return degree * (degree + 2); }

    /// coefficients: of grad C_lm and grad S_lm, T/A, of each coil, in the order of C_10, C_11,
    /// S_11, C_20, C_21, S_21, C_22, ...; each coil may have its own degree, 1 to kMostDegree.
    /// Throws std::invalid_argument for numbers that are not finite, another count of them, or a
    /// box without the origin or with no more than one point.
    FieldMap(const Box& box, const PerCoilOf<std::vector<double>>& coefficients);

    /// Where points were measured. The field beyond is an extrapolation.
    const Box& box() const { return box_; }

    const PerCoilOf<std::vector<double>>& coefficients() const { return coefficients_; }

    /// Field (T/A) and gradient (T/m/A) of one coil at `point` (m), also beyond the box.
    FieldAndGradient unit_field(Coil coil, const Eigen::Vector3d& point) const;

    /// The same as a robot turned by 180 degrees about z sees it: see `turned` of currents.
    FieldMap turned() const;

private:
    // One harmonic's share of Bx, By, Bz and of the derivatives xy, xz, yy, yz, zz.
    using Parts = std::array<double, 8>;

    Box box_;
    Eigen::Vector3d centre_;
    double radius_;  // m
    PerCoilOf<std::vector<double>> coefficients_;
    PerCoilOf<std::vector<Parts>> parts_;  // of the harmonics from degree 0
};

/// grad C_lm and grad S_lm of u (see FieldMap) from degree 1 to `degree` at each point (m) of a
/// box: what multiplies each coefficient in the field. A matrix of 3 x count(degree) numbers a
/// point, a row an axis.
std::vector<double> harmonic_fields(const Box& box, std::size_t degree,
                                    const std::vector<Eigen::Vector3d>& points);

}  // namespace stickslip
