#include <pybind11/pybind11.h>

#include <exception>
#include <stdexcept>

#include "refusals.hpp"
#include "register.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace py = pybind11;

// Without the GIL runs are safe side by side: what they share is constant or has a lock of its own.
PYBIND11_MODULE(_core, module, py::mod_gil_not_used()) {
    module.doc() = "C++ core of stickslip; the public interface is the package `stickslip`.";
    module.attr("__version__") = STICKSLIP_VERSION;
    module.attr("has_arkode") = stickslip::has_method(stickslip::Method::arkode);

    using namespace stickslip::bindings;
    // A refusal of the core becomes a ScenarioError of the package.
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const std::invalid_argument& refusal) {
            try {
                raise("ScenarioError", refusal.what());
            } catch (py::error_already_set& error) {
                error.restore();
            }
        }
    });
    register_field(module);
    register_scenario(module);
    register_user_effect(module);
    register_simulation(module);
    register_simulator(module);
    register_readings(module);
}
