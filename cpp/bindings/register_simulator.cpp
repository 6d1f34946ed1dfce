#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "refusals.hpp"
#include "register.hpp"
#include "report_progress.hpp"
#include "stickslip/batch/rollout.hpp"
#include "stickslip/batch/simulator.hpp"
#include "stickslip/numbers/number_text.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace stickslip::bindings {
namespace {

/// Written in place, so that nothing may be converted.
using Output = py::array_t<double, py::array::c_style>;

constexpr const char* kStepTypes =
    "a step takes a mapping from coils to V, or five numbers of V (xp, xm, yp, ym, clamp), and a "
    "duration in s";

double duration_of(double seconds) {
    if (!(seconds > 0.0) || !std::isfinite(seconds)) {
        throw std::invalid_argument("duration = " + digits(seconds) +
                                    ": allowed is a number of s above 0");
    }
    return seconds;
}

/// refusal: makes the message for what is no number.
double number_of(const py::handle& value, auto&& refusal) {
    if (PyFloat_CheckExact(value.ptr())) return PyFloat_AS_DOUBLE(value.ptr());
    try {
        return value.cast<double>();
    } catch (const py::cast_error&) {
        throw std::invalid_argument(refusal());
    }
}

/// Whether voltages go linearly to those of a step.
bool is_linear(const py::object& hold) {
    const auto is = [&](const char* word) {
        return PyUnicode_Check(hold.ptr()) &&
               PyUnicode_CompareWithASCIIString(hold.ptr(), word) == 0;
    };
    if (is("constant")) return false;
    if (!is("linear")) refuse("hold", hold, "\"constant\" or \"linear\"");
    return true;
}

void require_finite(std::size_t coil, double volts, const char* argument = "voltages") {
    if (!std::isfinite(volts)) {
        throw std::invalid_argument(std::string(argument) + ": " + name(kAllCoils[coil]) + " = " +
                                    digits(volts) + ": allowed is a finite number of V");
    }
}

void require_finite(const Array& voltages) {
    for (py::ssize_t i = 0; i < voltages.size(); ++i) {
        require_finite(static_cast<std::size_t>(i % kCoilCount), voltages.data()[i]);
    }
}

/// Sets the voltage of one coil of those of `argument`.
void change(PerCoil& voltages, const py::handle& coil, const py::handle& volts,
            const char* argument) {
    const auto refusal = [&] {
        return std::string(argument) + ": " + py::repr(coil).cast<std::string>() + " = " +
               py::repr(volts).cast<std::string>() +
               ": allowed is a number of V for the name of a coil";
    };
    if (!PyUnicode_Check(coil.ptr())) throw std::invalid_argument(refusal());
    for (std::size_t i = 0; i < voltages.size(); ++i) {
        if (PyUnicode_CompareWithASCIIString(coil.ptr(), name(kAllCoils[i])) != 0) continue;
        voltages[i] = number_of(volts, refusal);
        return require_finite(i, voltages[i], argument);
    }
    throw std::invalid_argument(std::string(argument) + ": \"" + coil.cast<std::string>() +
                                "\" is no coil; allowed are xp, xm, yp, ym and clamp");
}

/// Voltages with the changes of a mapping from coils to V, or those of an array of five.
PerCoil changed(PerCoil voltages, const py::object& changes, const char* argument) {
    if (PyDict_Check(changes.ptr()) || py::hasattr(changes, "keys")) {
        for (const auto& [coil, volts] : py::dict(changes)) {
            change(voltages, coil, volts, argument);
        }
        return voltages;
    }
    const auto row = py::array::ensure(changes);
    const bool fits = row && std::strchr("iuf", row.dtype().kind()) != nullptr && row.ndim() == 1 &&
                      row.size() == kCoilCount;
    if (!fits) {
        PyErr_Clear();
        throw std::invalid_argument(std::string(argument) + " = " + shown(changes) + ": " +
                                    kStepTypes);
    }
    const Array given(row);
    for (std::size_t coil = 0; coil < voltages.size(); ++coil) {
        voltages[coil] = given.data()[coil];
        require_finite(coil, voltages[coil], argument);
    }
    return voltages;
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

py::object state_view(const SimulationState& state) {
    PYBIND11_CONSTINIT static py::gil_safe_call_once_and_store<py::object> view;
    return view
        .call_once_and_store_result([] {
            return py::module_::import("stickslip.scenario.sections").attr("State").attr("view");
        })
        .get_stored()(state);
}

py::object step(Simulator& self, const py::object& voltages, const py::object& duration,
                const py::object& hold, const py::object& start) {
    const bool linear = is_linear(hold);
    if (!start.is_none() && !linear) {
        throw std::invalid_argument("start: allowed with hold = \"linear\" only");
    }
    PerCoil jump = self.voltages();
    if (!start.is_none()) jump = changed(jump, start, "start");
    const PerCoil end = changed(jump, voltages, "voltages");
    const double seconds = duration_of(number_of(duration, [] { return kStepTypes; }));
    if (self.status() != Status::ok) {
        raise("SimulationError", "the simulation has ended: " + self.message());
    }
    self.step(end, seconds, linear, start.is_none() ? nullptr : &jump);
    if (self.status() != Status::ok) raise("SimulationError", self.message());
    return state_view(self.state());
}

py::dict voltages_of(const Simulator& self) {
    py::dict result;
    const PerCoil voltages = self.voltages();
    for (const Coil coil : kAllCoils) {
        result[name(coil)] = voltages[static_cast<std::size_t>(coil)];
    }
    return result;
}

RunSnapshot snapshot_of(const py::object& bytes) {
    const bool fits = PyBytes_Check(bytes.ptr()) || PyByteArray_Check(bytes.ptr()) ||
                      PyMemoryView_Check(bytes.ptr());
    if (!fits) refuse("data", bytes, "the bytes of a snapshot");
    const auto copy = py::reinterpret_steal<py::bytes>(PyBytes_FromObject(bytes.ptr()));
    if (!copy) throw py::error_already_set();
    return RunSnapshot::from_bytes(copy);
}

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

/// Plays `runs` runs of one scenario, or of as many, each with the same number of steps, from
/// states (runs, columns) or None, by voltages (V) of shape (steps, 5) or (runs, steps, 5). Writes
/// the chosen columns of state_columns into `out`, shape (runs, steps, columns), and returns the
/// index in `statuses` of each run.
py::array_t<std::int8_t> rollout_into(const std::vector<Scenario>& scenarios, std::size_t runs,
                                      const std::optional<Array>& states, const Array& voltages,
                                      double seconds, const py::object& hold,
                                      const std::vector<std::size_t>& columns, Output out,
                                      int threads, const py::object& progress) {
    const bool linear = is_linear(hold);
    const double duration = duration_of(seconds);
    if (scenarios.size() != 1 && scenarios.size() != runs) {
        throw std::invalid_argument("scenarios: allowed is one, or one for each run");
    }
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

    /// Plays a step (s) of all runs with voltages (V) of shape (runs, 5); a failed run stays.
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
    /// Writes a row of state_columns for each run into `out`, shape (runs, columns).
    void states(Output out) const {
        require_states(out, batch.size());
        double* to = out.mutable_data();
        for (std::size_t run = 0; run < batch.size(); ++run) {
            to = std::ranges::copy(row_of(batch.run(run).state()), to).out;
        }
    }
    /// Index in `statuses` of how the last step of each run ended.
    py::array_t<std::int8_t> statuses() const {
        std::vector<Status> all;
        for (std::size_t k = 0; k < batch.size(); ++k) all.push_back(batch.run(k).status());
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
    // A docstring begins with its own signature.
    py::options options;
    options.disable_function_signatures();

    const auto bytes_of = [](const RunSnapshot& self) { return py::bytes(self.to_bytes()); };
    py::class_<RunSnapshot>(module, "Snapshot",
                            "State, time and voltages of a `Simulator`, which goes on from them "
                            "with the same bits.")
        .def("to_bytes", bytes_of, R"(to_bytes()

        The snapshot as bytes with a checksum.

        Only the same version, on a machine of the same byte order, can read them.)")
        .def_static("from_bytes", &snapshot_of, py::arg("data"),
                    "from_bytes(data)\n\nThe snapshot that `to_bytes` wrote; a ScenarioError for "
                    "anything else.")
        .def("__eq__",
             [](const RunSnapshot& self, const py::object& other) {
                 return py::isinstance<RunSnapshot>(other) &&
                        self.to_bytes() == other.cast<const RunSnapshot&>().to_bytes();
             })
        .def("__hash__", [bytes_of](const RunSnapshot& self) { return py::hash(bytes_of(self)); })
        .def(py::pickle(bytes_of, &snapshot_of));

    py::class_<Simulator>(module, "Simulator", doc::Simulator)
        .def(py::init([](const Scenario& scenario, bool whole_plane) {
                 return std::make_unique<Simulator>(placed(scenario, whole_plane));
             }),
             py::arg("scenario"), py::arg("whole_plane"))
        .def("step", &step, py::arg("voltages"), py::arg("duration"), py::arg("hold") = "constant",
             py::arg("start") = py::none(), R"(step(voltages, duration, hold="constant", start=None)

        Play one step.

        Parameters
        ----------
        voltages : mapping of str to float, or array_like of shape (5,)
            New voltages of coils (``xp``, ``xm``, ``yp``, ``ym``, ``clamp``), V. A coil that is not
            named keeps its voltage, which is zero at first. An array has all five, in this order.
        duration : float
            Of the step, s.
        hold : {"constant", "linear"}
            Whether the voltages jump to their new values and stay there, or go there linearly over
            the step.
        start : mapping of str to float, or array_like of shape (5,), optional
            With ``hold="linear"`` the voltages to which coils jump at the beginning of the step, V.
            A coil that it does not name begins where it was, and one that `voltages` does not name
            stays where it begins.

        Returns
        -------
        State
            At the end of the step.

        Raises
        ------
        ScenarioError
            If a coil is unknown, a voltage or the duration is not allowed, `start` is given to a
            constant step, or the voltages turn a robot without ``whole_plane``.
        SimulationError
            If the simulation cannot go on; `state` is then where it stopped.)")
        .def_property_readonly(
            "time", &Simulator::time,
            "Simulated time since the start, s; after a step that failed, the time of the failure.")
        .def_property_readonly(
            "state", [](const Simulator& self) { return state_view(self.state()); },
            "The `State` in which the last step ended.")
        .def_property_readonly("voltages", &voltages_of,
                               "Voltage of each coil by name at the end of the last step, V; a "
                               "coil is of the world's frame.")
        .def_property_readonly(
            "status", [](const Simulator& self) { return row_of(self.status()).name; },
            "``\"ok\"``, or how the last step failed; no step follows a failed one.")
        .def_property_readonly("whole_plane", &Simulator::in_whole_plane,
                               "Whether the robot may turn and move in the whole plane.")
        .def("snapshot", &Simulator::snapshot,
             "snapshot()\n\nA snapshot, from which `restore` goes on with the same bits.")
        .def(
            "restore",
            [](Simulator& self, const py::object& snapshot) {
                if (!py::isinstance<RunSnapshot>(snapshot)) {
                    refuse("snapshot", snapshot, "a Snapshot");
                }
                self.restore(snapshot.cast<const RunSnapshot&>());
            },
            py::arg("snapshot"), R"(restore(snapshot)

        Go on from a snapshot, of this simulator or of another one of the same scenario.

        The scenarios may differ in `record`, and in the initial state except its currents.

        Raises
        ------
        ScenarioError
            If `snapshot` is no Snapshot, or of another scenario, or of another ``whole_plane``.)");

    options.enable_function_signatures();  // these have none in their text
    py::class_<Steppers>(module, "SimulatorBatch", doc::SimulatorBatch)
        .def(py::init<const std::vector<Scenario>&, bool>(), py::arg("scenarios"),
             py::arg("whole_plane"))
        .def("step", &Steppers::step, py::arg("voltages"), py::arg("duration"), py::arg("linear"),
             py::arg("threads"), doc::Steppers_step)
        .def("states", &Steppers::states, py::arg("out").noconvert(), doc::Steppers_states)
        .def("statuses", &Steppers::statuses, doc::Steppers_statuses)
        .def(
            "snapshot",
            [](const Steppers& self, std::size_t run) {
                return self.batch.run(self.checked(run)).snapshot();
            },
            py::arg("run"), "The snapshot of one run.")
        .def(
            "restore",
            [](Steppers& self, std::size_t run, const RunSnapshot& snapshot) {
                self.batch.restore(self.checked(run), snapshot);
            },
            py::arg("run"), py::arg("snapshot"),
            "Goes on with one run from a snapshot; see `Simulator.restore`.")
        .def(
            "reset",
            [](Steppers& self, std::size_t run, const Scenario& scenario) {
                self.batch.reset(self.checked(run), placed(scenario, self.whole_plane));
            },
            py::arg("run"), py::arg("scenario"), "Begins run `run` anew with a scenario.");

    module.def("rollout", &rollout_into, py::arg("scenarios"), py::arg("runs"), py::arg("states"),
               py::arg("voltages"), py::arg("duration"), py::arg("hold"), py::arg("columns"),
               py::arg("out").noconvert(), py::arg("threads"), py::arg("progress"),
               doc::rollout_into);
    module.attr("state_columns") = quantities_of(kStateColumns);
}

}  // namespace stickslip::bindings
