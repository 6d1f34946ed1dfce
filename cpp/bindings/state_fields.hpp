#pragma once

#include <pybind11/pybind11.h>

#include "stickslip/scenario/state.hpp"

namespace stickslip::bindings {

/// The fields of a State by name.
inline pybind11::dict fields(const SimulationState& state) {
    pybind11::dict result;
    for (std::size_t k = 0; k < kStateColumns.size(); ++k) {
        const StateColumn& column = kStateColumns[k];
        const pybind11::str name(column.name);
        if (k == kContactColumn) {
            result[name] = kContactWords[static_cast<std::size_t>(state.contact)].name;
        } else {
            result[name] = column.get(state);
        }
    }
    return result;
}

}  // namespace stickslip::bindings
