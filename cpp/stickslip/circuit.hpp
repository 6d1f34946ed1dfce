#pragma once

#include <array>

#include "stickslip/voltage_program.hpp"

namespace stickslip {

/// Exponentials that the currents of one stretch are made of: the coil's own, and the lag's.
inline constexpr int kMaxExponentials = 2;
inline constexpr int kMaxBasis = 2 + kMaxExponentials;

/// Effective coil currents over one linear stretch of voltage, as
///   I_k(tau) = c[0][k] + c[1][k] tau + sum_j c[2+j][k] exp(-rate[j] tau),   tau = t - start.
struct CurrentSegment {
    double start = 0.0;     ///< s
    double duration = 0.0;  ///< s
    int exponentials = 1;
    std::array<double, kMaxExponentials> rate = {};   ///< 1/s
    std::array<PerCoil, kMaxBasis> coefficient = {};  ///< A, A/s, A, A

    /// Currents that make the field at `tau` seconds from the start, in A.
    PerCoil currents(double tau) const;
};

/// The resistive-inductive circuit of each coil, Eq. (1), solved in closed form stretch by stretch,
/// and behind it the first-order lag of the field (effect `eddy_lag`), which is zero by default.
class Circuit {
public:
    /// resistance in ohm, inductance in H, lag in s.
    Circuit(double resistance, double inductance, double lag);

    /// The currents over `segment`, going on from where the previous stretch ended.
    CurrentSegment advance(const VoltageSegment& segment);

private:
    double resistance_;
    double time_constant_;
    double lag_;
    PerCoil current_ = {};    ///< A, at the end of the last stretch
    PerCoil effective_ = {};  ///< A, the lagging current that makes the field
};

}  // namespace stickslip
