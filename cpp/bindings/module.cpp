#include <pybind11/pybind11.h>

#include "register.hpp"

#ifndef STICKSLIP_WITH_ARKODE
#define STICKSLIP_WITH_ARKODE 0
#endif

PYBIND11_MODULE(_core, module) {
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
