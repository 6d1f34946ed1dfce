#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "docstrings.hpp"

namespace stickslip::bindings {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::vector<double> flat(const Array& values) {
    return {values.data(), values.data() + values.size()};
}

/// The names of a table's rows.
template <class Rows>
py::tuple names_of(const Rows& rows) {
    py::list names;
    for (const auto& row : rows) names.append(row.name);
    return py::tuple(names);
}

/// Unit and meaning by name.
template <class Rows>
py::dict quantities_of(const Rows& rows) {
    py::dict result;
    for (const auto& row : rows) {
        const std::string unit = row.unit;
        result[py::str(row.name)] = py::make_tuple(unit, row.meaning);
    }
    return result;
}

/// Meaning by word.
template <class Rows>
py::dict meanings_of(const Rows& rows) {
    py::dict result;
    for (const auto& row : rows) result[py::str(row.name)] = row.meaning;
    return result;
}

/// Each adds one family of the core to the module; see the file of the same name.
void register_field(py::module_& module);
void register_scenario(py::module_& module);
void register_user_effect(py::module_& module);
void register_simulation(py::module_& module);
void register_simulator(py::module_& module);
void register_readings(py::module_& module);

}  // namespace stickslip::bindings
