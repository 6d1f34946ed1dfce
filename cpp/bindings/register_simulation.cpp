#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "register.hpp"
#include "report_progress.hpp"
#include "state_fields.hpp"
#include "stickslip/batch/batch.hpp"
#include "stickslip/batch/sweep.hpp"

namespace py = pybind11;

namespace stickslip::bindings {
namespace {

// The words stand in the order of the enumerators.
constexpr std::array<const char*, 7> kStopQuantities = {"time",  "x",     "y",      "z",
                                                        "theta", "turns", "heading"};

StopCondition::Quantity quantity_named(const std::string& word) {
    const auto found = std::find(kStopQuantities.begin(), kStopQuantities.end(), word);
    if (found == kStopQuantities.end()) throw std::invalid_argument(word + ": no such quantity");
    return static_cast<StopCondition::Quantity>(found - kStopQuantities.begin());
}

/// A numpy array that takes the vector's memory over.
template <class T>
py::array_t<T> as_array(std::vector<T>&& values) {
    auto owner = std::make_unique<std::vector<T>>(std::move(values));
    const auto* data = owner->data();
    const auto count = static_cast<py::ssize_t>(owner->size());
    const py::capsule free(owner.release(),
                           [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(count, data, free);
}

py::array_t<double> as_array(std::vector<PerCoil>&& values) {
    auto owner = std::make_unique<std::vector<PerCoil>>(std::move(values));
    const auto* data = owner->empty() ? nullptr : owner->data()->data();
    const auto count = static_cast<py::ssize_t>(owner->size());
    const py::capsule free(owner.release(),
                           [](void* p) { delete static_cast<std::vector<PerCoil>*>(p); });
    return py::array_t<double>({count, py::ssize_t{kCoilCount}}, data, free);
}

py::dict recording_dict(Recording&& recording) {
    py::dict result;
    recording.for_each_column([&](std::size_t index, auto& column) {
        result[kColumnNames[index]] = as_array(std::move(column));
    });
    return result;
}

py::dict summary_dict(const RunResult& run) {
    const Summary& s = run.summary;
    py::dict result;
    result["mean_velocity"] = s.mean_velocity;
    result["mean_velocity_y"] = s.mean_velocity_y;
    result["turning_speed"] = s.turning_speed;
    result["theta_min"] = s.theta_min;
    result["theta_max"] = s.theta_max;
    result["slip_up"] = s.slip_up;
    result["slip_down"] = s.slip_down;
    result["slip_flat"] = s.slip_flat;
    result["airborne_fraction"] = s.airborne_fraction;
    result["velocity_growth"] = s.velocity_growth;
    result["pull_ratio"] = s.pull_ratio;
    result["field_change"] = s.field_change;
    result["field_max"] = s.field_max;
    result["field_min"] = s.field_min;
    result["current_max"] = s.current_max;
    result["voltage_max"] = s.voltage_max;
    result["power_mean"] = s.power_mean;
    result["simulated_time"] = s.simulated_time;
    py::dict events;
    for (std::size_t k = 0; k < kEventKinds; ++k) {
        if (static_cast<EventKind>(k) == EventKind::painleve) continue;
        events[name(static_cast<EventKind>(k))] = s.events[k];
    }
    result["events"] = events;
    result["painleve_events"] = s.events[static_cast<std::size_t>(EventKind::painleve)];
    py::dict steps;
    steps["accepted"] = run.steps.accepted;
    steps["rejected"] = run.steps.rejected;
    steps["evaluations"] = run.steps.evaluations;
    result["steps"] = steps;
    return result;
}

/// Quantity, whether it is met from below, and value.
using Until = std::optional<std::tuple<std::string, bool, double>>;

std::optional<StopCondition> stop_condition(const Until& until) {
    if (!until) return std::nullopt;
    const auto& [quantity, from_below, value] = *until;
    return StopCondition{quantity_named(quantity), from_below, value};
}

std::vector<RunResult> batch(const std::vector<Scenario>& scenarios, int threads,
                             const py::object& progress, const Until& until) {
    RunControl control;
    const std::optional<StopCondition> stop = stop_condition(until);
    const auto poll = [&] { report(control, progress); };
    const py::gil_scoped_release release;
    return simulate_batch(scenarios, threads, control, poll, stop);
}

/// Simulates one scenario whose record goes to `sink` chunk by chunk, as a dictionary. `result`
/// then has the rest, also where Ctrl-C, `progress` or `sink` ended the run with an exception.
void stream(RunResult& result, Scenario scenario, const py::object& sink,
            const py::object& progress, const Until& until) {
    RunControl control;
    const std::optional<StopCondition> stop = stop_condition(until);
    scenario.record.sink = [&sink](Recording&& chunk) {
        const py::gil_scoped_acquire acquire;
        sink(recording_dict(std::move(chunk)));
    };
    result.status = Status::interrupted;  // until it has ended
    const auto poll = [&] { report(control, progress); };
    const py::gil_scoped_release release;
    run_workers(
        1, control, [&] { result = simulate(scenario, &control, stop); }, poll);
}

/// A column of a sweep's points.
template <class T, class Get>
py::array_t<T> column(const std::vector<SweepPoint>& points, Get&& get) {
    py::array_t<T> result(static_cast<py::ssize_t>(points.size()));
    auto out = result.template mutable_unchecked<1>();
    for (std::size_t i = 0; i < points.size(); ++i) {
        out(static_cast<py::ssize_t>(i)) = static_cast<T>(get(points[i]));
    }
    return result;
}

/// Columns by name, and messages by the index of a point that did not end well.
py::tuple sweep_columns(
    const Scenario& base, const std::vector<std::string>& keys,
    const py::array_t<double, py::array::c_style | py::array::forcecast>& values, int threads,
    const py::object& progress) {
    const std::vector<double> flat(values.data(), values.data() + values.size());
    RunControl control;
    const auto poll = [&] { report(control, progress); };
    std::vector<SweepPoint> points;
    {
        const py::gil_scoped_release release;
        points = sweep(base, keys, flat, threads, control, poll);
    }
    py::dict columns;
    const auto add = [&](const char* key, double Summary::*member) {
        columns[key] =
            column<double>(points, [member](const SweepPoint& p) { return p.summary.*member; });
    };
    columns["status"] = column<std::int8_t>(
        points, [](const SweepPoint& p) { return p.refused ? -1 : static_cast<int>(p.status); });
    add("mean_velocity", &Summary::mean_velocity);
    add("mean_velocity_y", &Summary::mean_velocity_y);
    add("theta_min", &Summary::theta_min);
    add("theta_max", &Summary::theta_max);
    add("slip_up", &Summary::slip_up);
    add("slip_down", &Summary::slip_down);
    add("slip_flat", &Summary::slip_flat);
    add("airborne_fraction", &Summary::airborne_fraction);
    add("velocity_growth", &Summary::velocity_growth);
    add("pull_ratio", &Summary::pull_ratio);
    add("field_change", &Summary::field_change);
    add("field_max", &Summary::field_max);
    add("field_min", &Summary::field_min);
    add("current_max", &Summary::current_max);
    add("voltage_max", &Summary::voltage_max);
    add("power_mean", &Summary::power_mean);
    add("simulated_time", &Summary::simulated_time);
    for (std::size_t k = 0; k < kEventKinds; ++k) {
        columns[name(static_cast<EventKind>(k))] =
            column<std::int64_t>(points, [k](const SweepPoint& p) { return p.summary.events[k]; });
    }
    py::dict messages;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points[i].message.empty()) messages[py::int_(i)] = points[i].message;
    }
    return py::make_tuple(columns, messages);
}

}  // namespace

void register_simulation(py::module_& module) {
    py::class_<RunResult>(module, "RunResult")
        .def(py::init<>())
        .def_property_readonly("status", [](const RunResult& self) { return name(self.status); })
        .def_property_readonly("message", &message)
        .def_property_readonly("mean_velocity",
                               [](const RunResult& self) { return self.summary.mean_velocity; })
        .def_property_readonly("stopped", [](const RunResult& self) { return self.stopped; })
        .def_property_readonly("final_state",
                               [](const RunResult& self) { return fields(self.final_state); })
        .def("summary", &summary_dict)
        .def("take_recording",
             [](RunResult& self) { return recording_dict(std::move(self.recording)); });

    module.def("simulate_batch", &batch, py::arg("scenarios"), py::arg("threads") = 1,
               py::arg("progress") = py::none(), py::arg("until") = py::none());
    module.def("stream", &stream, py::arg("result"), py::arg("scenario"), py::arg("sink"),
               py::arg("progress") = py::none(), py::arg("until") = py::none());
    module.def("sweep", &sweep_columns, py::arg("base"), py::arg("keys"), py::arg("values"),
               py::arg("threads") = 1, py::arg("progress") = py::none());
    py::list contact_names, event_names, status_names;
    for (const char* contact : kContactNames) contact_names.append(contact);
    for (std::size_t k = 0; k < kEventKinds; ++k) {
        event_names.append(name(static_cast<EventKind>(k)));
    }
    for (int k = 0; k <= static_cast<int>(Status::turns_too_fast); ++k) {
        status_names.append(name(static_cast<Status>(k)));
    }
    module.attr("stop_quantities") = py::cast(kStopQuantities);
    module.attr("status_names") = py::tuple(status_names);
    module.attr("record_columns") = py::tuple(py::cast(kColumnNames));
    module.attr("plane_columns") = py::tuple(
        py::cast(std::vector<std::string>(kColumnNames.end() - kPlaneColumns, kColumnNames.end())));
    module.attr("contact_names") = py::tuple(contact_names);
    module.attr("event_names") = py::tuple(event_names);
}

}  // namespace stickslip::bindings
