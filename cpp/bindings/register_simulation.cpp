#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "register.hpp"
#include "report_progress.hpp"
#include "stickslip/batch/batch.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip::bindings {
namespace {

StopCondition::Quantity quantity_named(const std::string& word) {
    const std::size_t place = place_of(kStopQuantities, word);
    if (place == kStopQuantities.size()) throw std::invalid_argument(word + ": no such quantity");
    return kStopQuantities[place].code;
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

/// Takes the columns of the record that there are, arrays by name.
py::dict recording_dict(Recording&& recording) {
    py::dict result;
    recording.for_each_column([&](const RecordColumn& column, auto& values) {
        result[py::str(column.name)] = as_array(std::move(values));
    });
    return result;
}

/// The summary_numbers by name, counts of events by name, and counts of the integrator's steps.
py::dict summary_dict(const RunResult& run) {
    const Summary& s = run.summary;
    py::dict result;
    for (const SummaryNumber& number : kSummaryNumbers) {
        result[py::str(number.name)] = s.*number.member;
    }
    py::dict events;
    for (const auto& event : kEvents) {
        if (event.code == EventKind::painleve) continue;
        events[py::str(event.name)] = s.events[static_cast<std::size_t>(event.code)];
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

std::vector<SweepPoint> points_of(const Scenario& base, const std::vector<std::string>& keys,
                                  const Array& values, int threads, const py::object& progress,
                                  bool motion_only) {
    const std::vector<double> rows = flat(values);
    RunControl control;
    control.motion_only = motion_only;
    const py::gil_scoped_release release;
    return sweep(base, keys, rows, threads, control, [&] { report(control, progress); });
}

/// Mean velocities alone (m/s) of a sweep's points; NaN where a run did not end well.
py::array_t<double> mean_velocities(const Scenario& base, const std::vector<std::string>& keys,
                                    const Array& values, int threads) {
    const auto points = points_of(base, keys, values, threads, py::none(), true);
    return column<double>(points, [](const SweepPoint& p) {
        const bool ended = !p.refused && p.status == Status::ok;
        return ended ? p.summary.mean_velocity : Summary::kNone;
    });
}

/// Simulates `base` with each row of values of the keys, where a key that takes words has the index
/// of the word; the same bits for any number of threads. Columns by name, with the status -1 of a
/// point that is refused, and messages by the index of a point that did not end well.
py::tuple sweep_columns(const Scenario& base, const std::vector<std::string>& keys,
                        const Array& values, int threads, const py::object& progress) {
    const auto points = points_of(base, keys, values, threads, progress, false);
    py::dict columns;
    columns["status"] = column<std::int8_t>(
        points, [](const SweepPoint& p) { return p.refused ? -1 : static_cast<int>(p.status); });
    for (const SummaryNumber& number : kSummaryNumbers) {
        columns[py::str(number.name)] =
            column<double>(points, [&](const SweepPoint& p) { return p.summary.*number.member; });
    }
    for (std::size_t k = 0; k < kEventKinds; ++k) {
        columns[py::str(kEvents[k].name)] =
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
    py::class_<RunResult>(module, "RunResult", "A run that has ended.")
        .def(py::init<>())
        .def_property_readonly(
            "status", [](const RunResult& self) { return row_of(self.status).name; },
            "A word of `statuses`, which has its meaning.")
        .def_property_readonly("message", &message, doc::message)
        .def_property_readonly(
            "mean_velocity", [](const RunResult& self) { return self.summary.mean_velocity; },
            "Along the surface in the measuring window, m/s.")
        .def_readonly("stopped", &RunResult::stopped, "Whether its condition ended it.")
        .def_property_readonly(
            "final_state", [](const RunResult& self) { return self.final_state; },
            doc::RunResult_final_state)
        .def("summary", &summary_dict, doc::summary_dict)
        .def(
            "take_recording",
            [](RunResult& self) { return recording_dict(std::move(self.recording)); },
            doc::recording_dict);

    module.def(
        "kernel",
        [] {
            const StepKernels& chosen = step_kernels();
            return py::make_tuple(name_of(chosen.processor), chosen.size);
        },
        "Kind of processor that steps are made for, and runs in a pack.");
    module.def("simulate_batch", &batch, py::arg("scenarios"), py::arg("threads") = 1,
               py::arg("progress") = py::none(), py::arg("until") = py::none(),
               doc::simulate_batch);
    module.def("stream", &stream, py::arg("result"), py::arg("scenario"), py::arg("sink"),
               py::arg("progress") = py::none(), py::arg("until") = py::none(), doc::stream);
    module.def("sweep", &sweep_columns, py::arg("base"), py::arg("keys"), py::arg("values"),
               py::arg("threads") = 1, py::arg("progress") = py::none(), doc::sweep_columns);
    module.def("mean_velocities", &mean_velocities, py::arg("base"), py::arg("keys"),
               py::arg("values"), py::arg("threads") = 1, doc::mean_velocities);
    py::dict statuses;
    for (const StatusRow& row : kStatuses) {
        statuses[py::str(row.name)] = py::make_tuple(row.message, row.remedy);
    }
    py::list plane_columns, inner_columns;
    for (const RecordColumn& column : kRecordColumns) {
        if (column.of_plane) plane_columns.append(column.name);
        if (column.of_inner) inner_columns.append(column.name);
    }
    module.attr("stop_quantities") = names_of(kStopQuantities);
    module.attr("statuses") = statuses;
    module.attr("summary_numbers") = quantities_of(kSummaryNumbers);
    module.attr("record_columns") = quantities_of(kRecordColumns);
    module.attr("plane_columns") = py::tuple(plane_columns);
    module.attr("inner_columns") = py::tuple(inner_columns);
    module.attr("contact_words") = meanings_of(kContactWords);
    module.attr("events") = meanings_of(kEvents);
}

}  // namespace stickslip::bindings
