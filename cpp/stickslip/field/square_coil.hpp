#pragma once

#include <Eigen/Core>

namespace stickslip {

/// A magnetic field and its first derivatives at one point.
struct FieldAndGradient {
    Eigen::Vector3d field;     ///< B_i, T (or T/A for unit current)
    Eigen::Matrix3d gradient;  ///< (i, j) = dB_i / dx_j, T/m (or T/m/A)
};

/// Distance from a wire (m) below which a point counts as lying on it. A filament's field has no
/// limit there; 1 nm is far below any size of the device, and far above the rounding of a
/// coordinate of 0.1 m (1e-17 m).
inline constexpr double kWireRadius = 1e-9;

/// True if `point` (m, local frame of `square_coil_field`) is within `kWireRadius` of a wire.
bool on_square_coil(double half_side, const Eigen::Vector3d& point);

/// Field and gradient of a square filament in its local frame (u, v, w): the loop lies in the
/// plane u = 0 with its centre at the origin, its sides at v = +-half_side and w = +-half_side (m),
/// and the current runs from +v to +w, so that the field at the centre points along +u.
///
/// The result is for mu_0 I / (4 pi) = 1, so the field is in 1/m and the gradient in 1/m^2.
/// Equations (3)-(7) of Pawashe, Floyd and Sitti, RSS 2008, with their analytic derivatives, in a
/// form that is also accurate where a wire, prolonged, passes through the point (the printed form
/// is 0/0 there, the field is finite). Even and odd in v and w to the last bit.
///
/// On a wire the result is meaningless; ask `on_square_coil` first.
FieldAndGradient square_coil_field(double half_side, const Eigen::Vector3d& point);

}  // namespace stickslip
