#include "stickslip/field/square_coil.hpp"

#include <cmath>

namespace stickslip {
namespace {

/// Field factor of one straight wire and its derivatives. At distance rho from the wire's line and
/// position t along it, the field of a wire from t = -a to t = a has the magnitude rho * value.
struct WireFactor {
    double value;     ///< G = [(t + a)/R1 - (t - a)/R2] / rho^2
    double by_rho2;   ///< dG / d(rho^2)
    double by_along;  ///< dG / dt = 1/R1^3 - 1/R2^3
};

/// `to_start` = t + a and `to_end` = t - a; R1 and R2 are the distances from the wire's two ends.
WireFactor wire_factor(double rho2, double to_start, double to_end, double r1, double r2) {
    const double inverse_r1 = 1.0 / r1;
    const double inverse_r2 = 1.0 / r2;
    const double cube1 = inverse_r1 * inverse_r1 * inverse_r1;
    const double cube2 = inverse_r2 * inverse_r2 * inverse_r2;
    WireFactor factor{};
    factor.by_along = cube1 - cube2;
    if (to_start >= 0.0 && to_end <= 0.0) {
        // Beside the wire both terms have one sign: nothing cancels, and rho = 0 is the wire.
        const double inverse_rho2 = 1.0 / rho2;
        factor.value = (to_start * inverse_r1 - to_end * inverse_r2) * inverse_rho2;
        factor.by_rho2 = -(factor.value + 0.5 * (to_start * cube1 - to_end * cube2)) * inverse_rho2;
    } else {
        // Past an end they cancel, to 0/0 on the wire's prolongation. Expanding with their sum
        // takes rho^2 out: (t+a)^2 R2^2 - (t-a)^2 R1^2 = rho^2 [(t+a)^2 - (t-a)^2].
        const double inverse_product = inverse_r1 * inverse_r2;
        const double inverse_sum = 1.0 / (to_start * r2 + to_end * r1);
        factor.value = (to_start - to_end) * (to_start + to_end) * inverse_product * inverse_sum;
        factor.by_rho2 = -0.5 * factor.value *
                         (inverse_r1 * inverse_r1 + inverse_r2 * inverse_r2 +
                          (to_start * r1 + to_end * r2) * inverse_product * inverse_sum);
    }
    return factor;
}

bool on_wire(double rho2, double along, double half_side) {
    return rho2 < kWireRadius * kWireRadius && std::abs(along) < half_side + kWireRadius;
}

}  // namespace

bool on_square_coil(double half_side, const Eigen::Vector3d& point) {
    const double u2 = point[0] * point[0];
    const double v_distance = std::abs(point[1]) - half_side;
    const double w_distance = std::abs(point[2]) - half_side;
    return on_wire(u2 + v_distance * v_distance, point[2], half_side) ||
           on_wire(u2 + w_distance * w_distance, point[1], half_side);
}

FieldAndGradient square_coil_field(double half_side, const Eigen::Vector3d& point) {
    const double u = point[0];
    const double v_plus = point[1] - half_side;  // distance from the wire at v = +half_side
    const double v_minus = point[1] + half_side;
    const double w_plus = point[2] - half_side;
    const double w_minus = point[2] + half_side;

    const double u2 = u * u;
    const double rho2_v_plus = u2 + v_plus * v_plus;
    const double rho2_v_minus = u2 + v_minus * v_minus;
    const double rho2_w_plus = u2 + w_plus * w_plus;
    const double rho2_w_minus = u2 + w_minus * w_minus;

    // Equation (3) for the four corners, named by the signs of v and w. Adding u^2 last makes the
    // distances the same bit for bit when v and w change places.
    const double r_pp = std::sqrt((v_plus * v_plus + w_plus * w_plus) + u2);
    const double r_pm = std::sqrt((v_plus * v_plus + w_minus * w_minus) + u2);
    const double r_mp = std::sqrt((v_minus * v_minus + w_plus * w_plus) + u2);
    const double r_mm = std::sqrt((v_minus * v_minus + w_minus * w_minus) + u2);

    const WireFactor at_v_plus = wire_factor(rho2_v_plus, w_minus, w_plus, r_pm, r_pp);
    const WireFactor at_v_minus = wire_factor(rho2_v_minus, w_minus, w_plus, r_mm, r_mp);
    const WireFactor at_w_plus = wire_factor(rho2_w_plus, v_minus, v_plus, r_mp, r_pp);
    const WireFactor at_w_minus = wire_factor(rho2_w_minus, v_minus, v_plus, r_mm, r_pm);

    FieldAndGradient result;
    result.field[0] = (v_minus * at_v_minus.value - v_plus * at_v_plus.value) +
                      (w_minus * at_w_minus.value - w_plus * at_w_plus.value);
    result.field[1] = u * (at_v_plus.value - at_v_minus.value);
    result.field[2] = u * (at_w_plus.value - at_w_minus.value);

    // Off the wires div B = 0 and curl B = 0, so five derivatives of (4)-(6) give all nine. The
    // derivatives of (4) itself, with twice the terms, are the ones left out.
    const double uv =
        (at_v_plus.value - at_v_minus.value) + 2.0 * u2 * (at_v_plus.by_rho2 - at_v_minus.by_rho2);
    const double uw =
        (at_w_plus.value - at_w_minus.value) + 2.0 * u2 * (at_w_plus.by_rho2 - at_w_minus.by_rho2);
    const double vw = u * (at_v_plus.by_along - at_v_minus.by_along);
    const double vv = 2.0 * u * (v_plus * at_v_plus.by_rho2 - v_minus * at_v_minus.by_rho2);
    const double ww = 2.0 * u * (w_plus * at_w_plus.by_rho2 - w_minus * at_w_minus.by_rho2);
    result.gradient << -(vv + ww), uv, uw,  //
        uv, vv, vw,                         //
        uw, vw, ww;
    return result;
}

}  // namespace stickslip
