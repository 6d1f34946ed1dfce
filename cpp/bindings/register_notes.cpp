#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "register.hpp"
#include "report_progress.hpp"
#include "stickslip/batch/batch.hpp"
#include "stickslip/readings/note_rows.hpp"

namespace py = pybind11;

namespace stickslip::bindings {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Code, text and value.
py::list as_list(const std::vector<Note>& notes) {
    py::list result;
    for (const Note& note : notes) {
        result.append(py::make_tuple(note.code, note.text, note.value));
    }
    return result;
}

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

}  // namespace

void register_notes(py::module_& module) {
    module.attr("note_rows") = rows();
    module.def("field_swing", &field_swing, py::arg("frequency"), py::arg("time_constant"));
    module.def(
        "scenario_notes",
        [](const Scenario& scenario) { return as_list(scenario_notes(scenario)); },
        py::arg("scenario"));
    module.def("run_notes", &of_run, py::arg("scenario"), py::arg("numbers"), py::arg("ok"),
               py::arg("cut"));
    module.def("count_notes", &counts, py::arg("base"), py::arg("columns"), py::arg("pulses"));
}

}  // namespace stickslip::bindings
