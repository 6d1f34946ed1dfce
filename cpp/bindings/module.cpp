#include <pybind11/pybind11.h>

#include "register.hpp"

namespace py = pybind11;

#ifndef STICKSLIP_WITH_ARKODE
#define STICKSLIP_WITH_ARKODE 0
#endif

// Without the GIL runs are safe side by side: what they share is constant or has a lock of its own.
PYBIND11_MODULE(_core, module, py::mod_gil_not_used()) {
    module.doc() = "C++ core of stickslip; the public interface is the package `stickslip`.";
    module.attr("__version__") = STICKSLIP_VERSION;
    module.attr("has_arkode") = static_cast<bool>(STICKSLIP_WITH_ARKODE);

    using namespace stickslip::bindings;
    register_field(module);
    register_scenario(module);
    register_user_effect(module);
    register_simulation(module);
    register_simulator(module);
    register_statics(module);
}
