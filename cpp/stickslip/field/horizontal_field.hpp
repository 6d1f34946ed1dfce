#pragma once

#include <array>
#include <cstddef>

#include "stickslip/drive/circuit.hpp"
#include "stickslip/field/field_shape.hpp"
#include "stickslip/numbers/elementary.hpp"

namespace stickslip {

/// The horizontal field at a place over one stretch of voltage, whose currents are known in closed
/// form.
struct HorizontalField {
    using Vector = std::array<double, 2>;  // x and y, T

    const CurrentSegment* segment = nullptr;
    const FieldShape* shape = nullptr;         ///< of the coils' part, or none
    std::array<Vector, kMaxBasis> basis = {};  ///< of the coils, by the functions of the currents
    Vector ambient = {};

    Vector at(double tau) const {
        Vector b = {basis[0][0] + basis[1][0] * tau, basis[0][1] + basis[1][1] * tau};
        for (std::size_t j = 0; j < static_cast<std::size_t>(segment->exponentials); ++j) {
            const double fading = exponential(-segment->rate[j] * tau);
            b[0] += basis[2 + j][0] * fading;
            b[1] += basis[2 + j][1] * fading;
        }
        const double factor =
            shape ? shape->factor(segment->start + tau, segment->field_currents(tau)) : 1.0;
        return {factor * b[0] + ambient[0], factor * b[1] + ambient[1]};
    }
};

}  // namespace stickslip
