#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "register.hpp"
#include "report_progress.hpp"
#include "stickslip/batch/rollout.hpp"
#include "stickslip/batch/simulator.hpp"
#include "stickslip/numbers/number_text.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "tables.hpp"

namespace py = pybind11;

namespace stickslip::bindings {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
/// Written in place, so that nothing may be converted.
using Output = py::array_t<double, py::array::c_style>;

double duration_of(double seconds) {
    if (!(seconds > 0.0) || !std::isfinite(seconds)) {
        throw std::invalid_argument("duration = " + digits(seconds) +
                                    ": allowed is a number of s above 0");
    }
    return seconds;
}

double voltage_of(const char* coil, double volts, const std::string& argument = "voltages") {
    if (!std::isfinite(volts)) {
        throw std::invalid_argument(argument + ": " + coil + " = " + digits(volts) +
                                    ": allowed is a finite number of V");
    }
    return volts;
}

std::size_t coil_of(const std::string& word, const std::string& argument) {
    for (const Coil coil : kAllCoils) {
        if (word == name(coil)) return static_cast<std::size_t>(coil);
    }
    throw std::invalid_argument(argument + ": \"" + word +
                                "\" is no coil; allowed are xp, xm, yp, ym and clamp");
}

void require_finite(const Array& voltages) {
    for (py::ssize_t i = 0; i < voltages.size(); ++i) {
        voltage_of(name(kAllCoils[static_cast<std::size_t>(i % kCoilCount)]), voltages.data()[i]);
    }
}

std::string shape_of(const py::array& array) {
    std::string text = "(";
    for (py::ssize_t i = 0; i < array.ndim(); ++i) {
        text += (i ? ", " : "") + std::to_string(array.shape(i));
    }
    return text + ")";
}

Scenario placed(Scenario scenario, bool whole_plane) {
    scenario.whole_plane = scenario.whole_plane || whole_plane;
    return scenario;
}

/// Steps whose voltages are named.
struct Stepper {
    Stepper(const Scenario& scenario, bool whole_plane)
        : simulator(placed(scenario, whole_plane)) {}

    SimulationState step(const py::dict& changes, double seconds, bool linear,
                         const std::optional<py::dict>& jump) {
        const double duration = duration_of(seconds);
        const PerCoil before = simulator.voltages();
        const PerCoil start = jump ? changed(before, *jump, "start") : before;
        simulator.step(changed(start, changes, "voltages"), duration, linear,
                       jump ? &start : nullptr);
        return simulator.state();
    }

    static PerCoil changed(PerCoil next, const py::dict& changes, const std::string& argument) {
        for (const auto& [coil, volts] : changes) {
            try {
                const auto word = coil.cast<std::string>();
                next[coil_of(word, argument)] =
                    voltage_of(word.c_str(), volts.cast<double>(), argument);
            } catch (const py::cast_error&) {
                throw std::invalid_argument(argument + ": " + py::repr(coil).cast<std::string>() +
                                            " = " + py::repr(volts).cast<std::string>() +
                                            ": allowed is a number of V for the name of a coil");
            }
        }
        return next;
    }

    Simulator simulator;
};

void set_state(Scenario& scenario, const double* row) {
    for (std::size_t k = 0; k < kStateColumns.size(); ++k) {
        const std::string key = "initial." + std::string(kStateColumns[k].name);
        if (k != kContactColumn) {
            set_parameter(scenario, key, row[k]);
            continue;
        }
        if (!(row[k] >= 0.0 && row[k] < static_cast<double>(kContactWords.size()))) {
            throw std::invalid_argument(key + " = " + digits(row[k]) +
                                        ": there is no contact with this index");
        }
        kStateColumns[k].set(scenario.initial, row[k]);
    }
}

bool are_finite(const double* state) {
    return std::all_of(state, state + kStateColumns.size(),
                       [](double value) { return std::isfinite(value); });
}

void require_states(const Array& states, std::size_t runs) {
    const bool fits = states.ndim() == 2 && static_cast<std::size_t>(states.shape(0)) == runs &&
                      static_cast<std::size_t>(states.shape(1)) == kStateColumns.size();
    if (!fits) {
        throw std::invalid_argument(
            "states of shape " + shape_of(states) + ": allowed is (" + std::to_string(runs) + ", " +
            std::to_string(kStateColumns.size()) + "), a row of state_columns for each run");
    }
}

py::array_t<std::int8_t> status_array(const std::vector<Status>& statuses) {
    py::array_t<std::int8_t> result(static_cast<py::ssize_t>(statuses.size()));
    auto out = result.mutable_unchecked<1>();
    for (std::size_t i = 0; i < statuses.size(); ++i) {
        out(static_cast<py::ssize_t>(i)) = static_cast<std::int8_t>(statuses[i]);
    }
    return result;
}

/// Plays `runs` runs of one scenario, or of as many; writes into `out` (runs, steps, columns).
py::array_t<std::int8_t> rollout_into(const std::vector<Scenario>& scenarios, std::size_t runs,
                                      const std::optional<Array>& states, const Array& voltages,
                                      double seconds, bool linear,
                                      const std::vector<std::size_t>& columns, Output out,
                                      int threads, const py::object& progress) {
    const double duration = duration_of(seconds);
    if (states) require_states(*states, runs);
    const bool shared = voltages.ndim() == 2;
    if (shared) require_finite(voltages);  // else a run fails where its own are not
    const auto steps = static_cast<std::size_t>(voltages.shape(shared ? 0 : 1));
    const ControlRows rows = {voltages.data(), steps, shared ? 0 : steps * kCoilCount, duration,
                              linear};
    const double* first_state = states ? states->data() : nullptr;
    const auto scenario = [&](std::size_t run) -> std::optional<Scenario> {
        Scenario result = scenarios[scenarios.size() == 1 ? 0 : run];
        try {
            if (first_state) {
                const double* state = first_state + run * kStateColumns.size();
                if (!are_finite(state)) return std::nullopt;  // as a run that failed leaves it
                set_state(result, state);
            }
            check(result);
        } catch (const std::invalid_argument& refusal) {
            throw std::invalid_argument("run " + std::to_string(run) + ": " + refusal.what());
        }
        return result;
    };
    RunControl control;
    const auto poll = [&] { report(control, progress); };
    std::vector<Status> statuses;
    double* to = out.mutable_data();
    {
        const py::gil_scoped_release release;
        statuses = rollout(runs, scenario, rows, {to, columns}, threads, control, poll);
    }
    return status_array(statuses);
}

/// Many runs and their states as arrays.
struct Steppers {
    Steppers(std::vector<Scenario> scenarios, bool whole)
        : whole_plane(whole), batch([&] {
              for (Scenario& each : scenarios) each = placed(std::move(each), whole);
              return scenarios;
          }()) {}

    void step(const Array& voltages, double seconds, bool linear, int threads) {
        const double duration = duration_of(seconds);
        if (voltages.ndim() != 2 || static_cast<std::size_t>(voltages.shape(0)) != batch.size() ||
            voltages.shape(1) != kCoilCount) {
            throw std::invalid_argument("voltages of shape " + shape_of(voltages) +
                                        ": allowed is (" + std::to_string(batch.size()) + ", 5)");
        }
        const auto poll = [] {
            const py::gil_scoped_acquire acquire;
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        };
        const py::gil_scoped_release release;
        batch.step(voltages.data(), duration, linear, threads, poll);
    }
    void states(Output out) const {
        require_states(out, batch.size());
        double* to = out.mutable_data();
        for (std::size_t run = 0; run < batch.size(); ++run) {
            const StateRow row = batch.state(run);
            to = std::copy(row.begin(), row.end(), to);
        }
    }
    py::array_t<std::int8_t> statuses() const {
        std::vector<Status> all;
        for (std::size_t run = 0; run < batch.size(); ++run) all.push_back(batch.status(run));
        return status_array(all);
    }

    std::size_t checked(std::size_t run) const {
        if (run >= batch.size()) throw py::index_error("there is no such run");
        return run;
    }

    bool whole_plane;
    SimulatorBatch batch;
};

}  // namespace

void register_simulator(py::module_& module) {
    py::class_<RunSnapshot>(module, "Snapshot")
        .def("to_bytes", [](const RunSnapshot& self) { return py::bytes(self.to_bytes()); })
        .def_static("from_bytes",
                    [](const py::bytes& bytes) { return RunSnapshot::from_bytes(bytes); });

    py::class_<Stepper>(module, "Simulator")
        .def(py::init<const Scenario&, bool>(), py::arg("scenario"), py::arg("whole_plane"))
        .def("step", &Stepper::step, py::arg("voltages"), py::arg("duration"), py::arg("linear"),
             py::arg("start") = py::none())
        .def_property_readonly("time", [](const Stepper& self) { return self.simulator.time(); })
        .def("state", [](const Stepper& self) { return self.simulator.state(); })
        .def_property_readonly("voltages",
                               [](const Stepper& self) { return self.simulator.voltages(); })
        .def_property_readonly(
            "status", [](const Stepper& self) { return row_of(self.simulator.status()).name; })
        .def_property_readonly("message",
                               [](const Stepper& self) { return self.simulator.message(); })
        .def("snapshot", [](const Stepper& self) { return self.simulator.snapshot(); })
        .def("restore",
             [](Stepper& self, const RunSnapshot& snapshot) { self.simulator.restore(snapshot); });

    py::class_<Steppers>(module, "SimulatorBatch")
        .def(py::init<const std::vector<Scenario>&, bool>(), py::arg("scenarios"),
             py::arg("whole_plane"))
        .def("step", &Steppers::step)
        .def("states", &Steppers::states, py::arg("out").noconvert())
        .def("statuses", &Steppers::statuses)
        .def("snapshot", [](const Steppers& self,
                            std::size_t run) { return self.batch.snapshot(self.checked(run)); })
        .def("restore",
             [](Steppers& self, std::size_t run, const RunSnapshot& snapshot) {
                 self.batch.restore(self.checked(run), snapshot);
             })
        .def("reset", [](Steppers& self, std::size_t run, const Scenario& scenario) {
            self.batch.reset(self.checked(run), placed(scenario, self.whole_plane));
        });

    module.def("rollout", &rollout_into, py::arg("scenarios"), py::arg("runs"), py::arg("states"),
               py::arg("voltages"), py::arg("duration"), py::arg("linear"), py::arg("columns"),
               py::arg("out").noconvert(), py::arg("threads"), py::arg("progress"));
    module.def("set_state", [](Scenario& scenario, const Array& row) {
        if (row.size() != static_cast<py::ssize_t>(kStateColumns.size())) {
            throw std::invalid_argument("a state has a value for each of state_columns");
        }
        set_state(scenario, row.data());
    });
    module.attr("state_columns") = quantities_of(kStateColumns);
}

}  // namespace stickslip::bindings
