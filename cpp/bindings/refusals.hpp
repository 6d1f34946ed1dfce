#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace stickslip::bindings {

/// Raises an exception of `stickslip.errors`.
[[noreturn]] inline void raise(const char* error, const std::string& message) {
    const pybind11::object type = pybind11::module_::import("stickslip.errors").attr(error);
    PyErr_SetObject(type.ptr(), pybind11::str(message).ptr());
    throw pybind11::error_already_set();
}

/// A value as messages have it, on one line and shortened.
inline std::string shown(const pybind11::object& value) {
    const auto messages = pybind11::module_::import("stickslip._util.messages");
    return messages.attr("shown")(value).cast<std::string>();
}

/// Raises the ScenarioError of a value that is not allowed.
[[noreturn]] inline void refuse(const std::string& key, const pybind11::object& value,
                                const std::string& allowed) {
    raise("ScenarioError", key + " = " + shown(value) + ": allowed is " + allowed);
}

}  // namespace stickslip::bindings
