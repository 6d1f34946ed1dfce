#include <pybind11/stl.h>

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "register.hpp"
#include "report_progress.hpp"
#include "stickslip/batch/batch.hpp"
#include "stickslip/readings/note_rows.hpp"
#include "stickslip/readings/probe.hpp"
#include "stickslip/readings/static_tilt.hpp"

namespace stickslip::bindings {
namespace {

/// Code, text and value.
py::list as_list(const std::vector<Note>& notes) {
    py::list result;
    for (const Note& note : notes) {
        result.append(py::make_tuple(note.code, note.text, note.value));
    }
    return result;
}

/// Notes on a scenario and on its run, from the summary; short simulations find what holds a robot
/// at rest. ok: whether the run came to its end; cut: whether its condition ended it.
py::list of_run(const Scenario& scenario, const py::dict& numbers, bool ok, bool cut) {
    Summary summary;
    for (const SummaryNumber& each : kSummaryNumbers) {
        const py::str name(each.name);
        if (numbers.contains(name)) summary.*each.member = numbers[name].cast<double>();
    }
    const py::object events = numbers["events"];
    for (const auto& event : kEvents) {
        const auto count = events.attr("get")(py::str(event.name), 0).cast<std::int64_t>();
        summary.events[static_cast<std::size_t>(event.code)] = count;
    }
    RunControl control;
    std::vector<Note> notes;
    const py::object progress = py::none();
    {
        const py::gil_scoped_release release;  // for an effect of the user's in a trial
        run_workers(
            1, control, [&] { notes = run_notes(scenario, summary, ok, cut, Wording(), &control); },
            [&] { report(control, progress); });
    }
    return as_list(notes);
}

/// How many of some runs, by columns of their summaries, have each note that is counted, by code.
/// They differ from `base` in their pulses, and what else differs is not asked.
py::dict counts(Scenario base, const std::map<std::string, Array>& columns, const Array& pulses) {
    std::map<std::string, std::int64_t> found;
    for (py::ssize_t i = 0; i < pulses.size(); ++i) {
        Summary summary;
        for (const SummaryNumber& each : kSummaryNumbers) {
            const auto column = columns.find(std::string(each.name));
            if (column != columns.end()) summary.*each.member = column->second.data()[i];
        }
        base.drive.pulses = static_cast<std::int64_t>(pulses.data()[i]);
        const NoteFacts facts{.s = base, .run = summary};
        for (const NoteRow& row : note_rows()) {
            if (row.many != nullptr && row.holds(facts)) ++found[row.code];
        }
    }
    return py::cast(found);
}

py::list rows() {
    py::list result;
    for (const NoteRow& row : note_rows()) {
        py::dict each;
        each["code"] = row.code;
        each["text"] = row.text;
        if (row.value != nullptr) each["value"] = row.value;
        if (row.above) each["above"] = *row.above;
        if (row.many != nullptr) each["many"] = row.many;
        result.append(each);
    }
    return result;
}

/// Readings for each row of values of the keys at each row of `places`, called `what`, scalars or
/// vectors: those of read(values, places), which is called without the GIL.
template <class Read>
Array readings_of(const std::vector<std::string>& keys, const Array& values, const Array& places,
                  const std::string& what, py::ssize_t width, bool vectors, const Read& read) {
    if (values.ndim() != 2 || values.shape(1) != static_cast<py::ssize_t>(keys.size()) ||
        places.ndim() != 2 || places.shape(1) != width) {
        throw std::invalid_argument("values must be (n, keys) and " + what + " (m, " +
                                    std::to_string(width) + ")");
    }
    std::vector<py::ssize_t> shape = {values.shape(0), places.shape(0)};
    if (vectors) shape.push_back(width);
    Array result(shape);
    if (result.size() == 0) return result;
    const std::vector<double> rows = flat(values), at = flat(places);
    std::vector<double> found;
    {
        const py::gil_scoped_release release;
        found = read(rows, at);
    }
    // Without keys all rows are alike.
    for (py::ssize_t i = 0; i < result.size(); ++i) {
        result.mutable_data()[i] = found[static_cast<std::size_t>(i) % found.size()];
    }
    return result;
}

/// Bx, By, Bz (T) at points (m) for each row of values of the keys, shape (rows, points, 3), with
/// the effects between current and field; NaN in a row that makes no scenario.
Array probe(const Scenario& base, const std::vector<std::string>& keys, const Array& values,
            const Array& points, const Array& currents) {
    return readings_of(keys, values, points, "points", 3, true,
                       [&, amperes = flat(currents)](const auto& rows, const auto& at) {
                           return probe_readings(base, keys, rows, at, amperes);
                       });
}

/// Angle (rad) at which the robot rests in each field (Bx, Bz; T) for each row of values of the
/// keys, shape (rows, fields); NaN where nothing holds it, and in a row that makes no scenario.
Array tilts(const Scenario& base, const std::vector<std::string>& keys, const Array& values,
            const Array& fields) {
    return readings_of(
        keys, values, fields, "fields", 2, false,
        [&](const auto& rows, const auto& at) { return static_tilts(base, keys, rows, at); });
}

}  // namespace

void register_readings(py::module_& module) {
    module.attr("note_rows") = rows();
    module.def("field_swing", &field_swing, py::arg("frequency"), py::arg("time_constant"),
               doc::field_swing);
    module.def(
        "scenario_notes",
        [](const Scenario& scenario) { return as_list(scenario_notes(scenario)); },
        py::arg("scenario"), doc::scenario_notes);
    module.def("run_notes", &of_run, py::arg("scenario"), py::arg("numbers"), py::arg("ok"),
               py::arg("cut"), doc::of_run);
    module.def("count_notes", &counts, py::arg("base"), py::arg("columns"), py::arg("pulses"),
               doc::counts);
    module.def("probe_readings", &probe, py::arg("base"), py::arg("keys"), py::arg("values"),
               py::arg("points"), py::arg("currents"), doc::probe);
    module.def("static_tilts", &tilts, py::arg("base"), py::arg("keys"), py::arg("values"),
               py::arg("fields"), doc::tilts);
}

}  // namespace stickslip::bindings
