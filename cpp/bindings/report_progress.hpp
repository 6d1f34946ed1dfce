#pragma once

#include <pybind11/pybind11.h>

#include "stickslip/run/simulation.hpp"

namespace stickslip::bindings {

/// Called while runs go on: lets Python see signals and the simulated time.
inline void report(const RunControl& control, const pybind11::object& progress) {
    const pybind11::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
    if (!progress.is_none()) progress(control.simulated_time.load());
}

}  // namespace stickslip::bindings
