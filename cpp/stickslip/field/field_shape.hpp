#pragma once

#include <array>
#include <cmath>

#include "stickslip/drive/coil.hpp"
#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

/// Factor on the field of all coils as a function of time and current.
struct FieldShape {
    FreeCurve time;       ///< of the time since the run began, effect `free_field_time`
    FreeCurve amplitude;  ///< of the in-plane current, effect `free_field_amplitude`

    bool absent() const { return time.absent() && amplitude.absent(); }

    /// seconds: since the run began. currents: that make the field, A.
    double factor(double seconds, const PerCoil& currents) const {
        return time.factor(seconds) * amplitude.factor(in_plane(currents));
    }

private:
    /// Root of the sum of squares of the currents of the four coils whose axes are in the plane of
    /// the surface, A: the size of the current where one of them is driven.
    static double in_plane(const PerCoil& currents) {
        double squares = 0.0;
        for (const Coil coil : {Coil::xp, Coil::xm, Coil::yp, Coil::ym}) {
            const double current = currents[static_cast<std::size_t>(coil)];
            squares += current * current;
        }
        return std::sqrt(squares);
    }
};

}  // namespace stickslip
