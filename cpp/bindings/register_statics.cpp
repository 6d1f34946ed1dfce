#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <stdexcept>

#include "register.hpp"
#include "stickslip/readings/static_tilt.hpp"

namespace py = pybind11;

namespace stickslip::bindings {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Readings, shape (vectors, fields).
Array tilts(const Scenario& base, const std::vector<std::string>& keys, const Array& values,
            const Array& fields) {
    if (values.ndim() != 2 || values.shape(1) != static_cast<py::ssize_t>(keys.size()) ||
        fields.ndim() != 2 || fields.shape(1) != 2) {
        throw std::invalid_argument("values must be (n, keys) and fields (m, 2)");
    }
    Array result({values.shape(0), fields.shape(0)});
    if (result.size() == 0) return result;
    const std::vector<double> flat(values.data(), values.data() + values.size());
    const std::vector<double> pairs(fields.data(), fields.data() + fields.size());
    std::vector<double> readings;
    {
        const py::gil_scoped_release release;
        readings = static_tilts(base, keys, flat, pairs);
    }
    // Without keys all vectors are alike.
    double* out = result.mutable_data();
    for (py::ssize_t i = 0; i < result.size(); ++i) {
        out[i] = readings[static_cast<std::size_t>(i) % readings.size()];
    }
    return result;
}

}  // namespace

void register_statics(py::module_& module) {
    module.def("static_tilts", &tilts, py::arg("base"), py::arg("keys"), py::arg("values"),
               py::arg("fields"));
}

}  // namespace stickslip::bindings
