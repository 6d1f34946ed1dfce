#pragma once

#include <pybind11/pybind11.h>

#include <string_view>

#include "stickslip/scenario/parameters.hpp"

namespace stickslip::bindings {

/// The fields of a State by name.
inline pybind11::dict fields(const SimulationState& state) {
    static const Choice* const contact = find_choice("initial.contact");
    const StateRow row = row_of(state);
    pybind11::dict result;
    for (std::size_t k = 0; k < row.size(); ++k) {
        if (std::string_view(kStateColumns[k]) == "contact") {
            result["contact"] = contact->allowed[static_cast<std::size_t>(state.contact)];
        } else {
            result[kStateColumns[k]] = row[k];
        }
    }
    return result;
}

}  // namespace stickslip::bindings
