#pragma once

#include <pybind11/pybind11.h>

namespace stickslip::bindings {

/// Each adds one family of the core to the module; see the file of the same name.
void register_field(pybind11::module_& module);
void register_scenario(pybind11::module_& module);
void register_user_effect(pybind11::module_& module);
void register_simulation(pybind11::module_& module);
void register_simulator(pybind11::module_& module);
void register_statics(pybind11::module_& module);
void register_notes(pybind11::module_& module);

}  // namespace stickslip::bindings
