#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "register.hpp"
#include "stickslip/scenario/user_effects.hpp"

namespace stickslip::bindings {
namespace {

/// A Python object that any thread may let go of, also after the interpreter has ended.
using Kept = std::shared_ptr<PyObject>;

Kept keep(const py::object& object) {
    return Kept(py::object(object).release().ptr(), [](PyObject* held) {
        if (!Py_IsInitialized()) return;  // the memory goes with the process
        const py::gil_scoped_acquire acquire;
        Py_DECREF(held);
    });
}

/// `owner`: what has to live as long as the code at the address.
WrenchFunction compiled(std::uintptr_t address, const py::object& owner) {
    using Function = void (*)(const double*, const double*, double*);
    const auto function = reinterpret_cast<Function>(address);
    return [function, held = keep(owner)](const double* state, const double* parameters,
                                          double* wrench) { function(state, parameters, wrench); };
}

/// Python's state of a thread that Python has not made, as long as the thread lives: a state for
/// each call is most of the call's cost.
class ThreadState {
public:
    ThreadState() : made_(PyGILState_GetThisThreadState() == nullptr) {
        if (!made_) return;
        before_ = PyGILState_Ensure();
        state_ = PyEval_SaveThread();
    }
    ~ThreadState() {
        if (!made_ || !Py_IsInitialized()) return;
        PyEval_RestoreThread(state_);
        PyGILState_Release(before_);
    }
    ThreadState(const ThreadState&) = delete;
    ThreadState& operator=(const ThreadState&) = delete;

private:
    bool made_;
    PyGILState_STATE before_{};
    PyThreadState* state_ = nullptr;
};

/// Called with two tuples; returns three numbers. What it raises is thrown.
WrenchFunction interpreted(const py::object& function, std::size_t count) {
    return
        [held = keep(function), count](const double* state, const double* parameters, double* out) {
            thread_local const ThreadState state_of_thread;
            const py::gil_scoped_acquire acquire;
            const auto tuple = [](const double* values, std::size_t size) {
                py::tuple result(size);
                for (std::size_t i = 0; i < size; ++i) result[i] = values[i];
                return result;
            };
            const py::object result = py::reinterpret_borrow<py::object>(held.get())(
                tuple(state, WrenchState::kSize), tuple(parameters, count));
            const auto wrench = result.cast<std::array<double, 3>>();
            for (std::size_t i = 0; i < 3; ++i) out[i] = wrench[i];
        };
}

using ParameterRow = std::tuple<std::string, std::string, double, double, double, std::string>;

/// Makes an effect known to this process, in place of one of the same name. Parameters: name, unit,
/// low, high, absent value, meaning. function: called itself, or owner of the code at an address.
void register_effect(const std::string& name, const std::string& meaning, const std::string& source,
                     const std::vector<ParameterRow>& parameters, const py::object& function,
                     std::uintptr_t address) {
    UserEffect effect{name, meaning, source, {}, {}};
    for (const auto& [parameter, unit, low, high, absent, what] : parameters) {
        effect.parameters.push_back({parameter, unit, low, high, absent, what});
    }
    effect.function =
        address != 0 ? compiled(address, function) : interpreted(function, parameters.size());
    stickslip::register_user_effect(std::move(effect));
}

}  // namespace

void register_user_effect(py::module_& module) {
    module.def("register_effect", &register_effect, py::arg("name"), py::arg("meaning"),
               py::arg("source"), py::arg("parameters"), py::arg("function"),
               py::arg("address") = 0, doc::register_effect);
    module.def(
        "unregister_effect", [](const std::string& name) { unregister_user_effect(name); },
        py::arg("name"), "Forgets an effect. Raises ScenarioError if there is none of that name.");
    module.def(
        "registered_effects",
        [] {
            std::vector<std::string> names;
            for (const UserEffectHandle& effect : user_effects()) names.push_back(effect->name);
            return names;
        },
        "Names of all registered effects, in the order of registration.");
    module.def("registrations", &registrations, doc::registrations);
}

}  // namespace stickslip::bindings
