#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace stickslip::bindings {

/// The names of a table's rows.
template <class Rows>
pybind11::tuple names_of(const Rows& rows) {
    pybind11::list names;
    for (const auto& row : rows) names.append(row.name);
    return pybind11::tuple(names);
}

/// Unit and meaning by name.
template <class Rows>
pybind11::dict quantities_of(const Rows& rows) {
    pybind11::dict result;
    for (const auto& row : rows) {
        const std::string unit = row.unit;
        result[pybind11::str(row.name)] = pybind11::make_tuple(unit, row.meaning);
    }
    return result;
}

/// Meaning by word.
template <class Rows>
pybind11::dict meanings_of(const Rows& rows) {
    pybind11::dict result;
    for (const auto& row : rows) result[pybind11::str(row.name)] = row.meaning;
    return result;
}

}  // namespace stickslip::bindings
