#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "register.hpp"
#include "stickslip/readings/notes.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/free_shapes.hpp"
#include "stickslip/scenario/named_laws.hpp"
#include "stickslip/scenario/own_laws.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip::bindings {
namespace {

/// A number or a word.
using Value = std::variant<double, std::int64_t, std::string>;

Value value_of(const Parameter& row, const Scenario& scenario) {
    if (row.integer) return static_cast<std::int64_t>(row.get(scenario));
    return row.get(scenario);
}

Value law_value(const Scenario& scenario, const LawPlace& place) {
    const OwnLaw* law = find_law(scenario, place.law);
    const std::string name = place.name();
    if (law == nullptr) {
        throw std::invalid_argument(name + ": there is no law laws." + place.law + " here");
    }
    const LawKey& key = *place.key;
    if (key.words.empty() && law->numbers[key.place]) return *law->numbers[key.place];
    if (!key.words.empty() && law->words[key.place]) return key.words[*law->words[key.place]];
    throw std::invalid_argument(name + ": the law has no " + key.name);
}

/// The number or word of a key. Throws std::invalid_argument if there is no such key.
Value value_of(const Scenario& scenario, const std::string& key) {
    if (const Choice* choice = find_choice(key)) {
        std::string word = choice->get(scenario);
        if (!word.empty()) return word;
    }
    if (const Parameter* row = find_parameter(key)) return value_of(*row, scenario);
    if (const std::optional<LawPlace> law = find_law_key(key)) return law_value(scenario, *law);
    const std::optional<UserKey> own = find_user_key(key);
    if (!own) throw unknown_key(key);
    return get_parameter(scenario, *own);
}

void set_value(Scenario& scenario, const std::string& key, const py::handle& value) {
    if (PyUnicode_Check(value.ptr())) {
        const char* word = PyUnicode_AsUTF8(value.ptr());
        if (word == nullptr) throw py::error_already_set();  // it is not UTF-8
        if (const auto law = find_law_key(key)) return set_law(scenario, *law, word);
        return set_choice(scenario, key, word);
    }
    const bool is_number = PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr());
    if (!is_number || PyBool_Check(value.ptr())) throw py::type_error("a float, an int or a str");
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (const auto law = find_law_key(key)) return set_law(scenario, *law, number);
    set_parameter(scenario, key, number);
}

/// The number or word of a key of the section `initial`, which may stand before the name.
Value state_value(const SimulationState& state, const std::string& key) {
    const std::size_t place = place_of(kStateColumns, key.substr(key.find('.') + 1));
    if (place == kStateColumns.size()) throw unknown_key(key);
    if (place != kContactColumn) return kStateColumns[place].get(state);
    return std::string(kContactWords[static_cast<std::size_t>(state.contact)].name);
}

/// Unequal to that of the scenario without any change; of a single coil, to that of all coils.
bool is_changed(const Parameter& row, const Scenario& scenario) {
    static const Scenario kDefaults{};
    const std::string_view key = row.key;
    if (!is_of_one_coil(key)) return row.get(scenario) != row.get(kDefaults);
    const std::string of_all = "coil" + std::string(key.substr(key.rfind('.')));
    return row.get(scenario) != find_parameter(of_all)->get(scenario);
}

/// The values that make a scenario of the default one, by key in the order of the tables: equal
/// scenarios have equal ones.
py::dict changed_values(const Scenario& scenario) {
    static const Scenario kDefaults{};
    py::dict result;
    for (const Choice& row : choices()) {
        const std::string word = row.get(scenario);
        if (!word.empty() && word != row.get(kDefaults)) result[row.key] = word;
    }
    for (const Parameter& row : parameters()) {
        if (is_changed(row, scenario)) result[row.key] = value_of(row, scenario);
    }
    for (const UserSetting& each : scenario.user_effects) {
        for (std::size_t i = 0; i < each.values.size(); ++i) {
            if (each.values[i] == each.effect->parameters[i].absent) continue;
            result[py::str(each.effect->key(i))] = each.values[i];
        }
    }
    for (const OwnLaw& law : scenario.laws) {
        for (const LawKey& key : law_keys()) {
            const LawPlace place{law.name, &key};
            const bool is_given = key.words.empty() ? law.numbers[key.place].has_value()
                                                    : law.words[key.place].has_value();
            if (is_given) result[py::str(place.name())] = law_value(scenario, place);
        }
    }
    return result;
}

/// Sets all that another scenario has in a section, also what is no number or word.
void take_section(Scenario& scenario, const Scenario& other, const std::string& section) {
    const auto is_of_it = [start = section + "."](const std::string_view key) {
        return key.starts_with(start);
    };
    for (const Choice& row : choices()) {
        const std::string word = row.get(other);
        if (is_of_it(row.key) && !word.empty()) set_choice(scenario, row.key, word);
    }
    for (const Parameter& row : parameters()) {
        if (!is_of_it(row.key)) continue;
        const Choice* words = find_choice(row.key);  // of a key that holds a word now
        if (words == nullptr || words->get(other).empty()) row.set(scenario, row.get(other));
    }
    if (section == "drive") scenario.program = other.program;
    if (section == "coil") scenario.map = other.map;
    if (section == "shake") scenario.shake.accelerations = other.shake.accelerations;
    if (section == "inner") scenario.inner.drive.rows = other.inner.drive.rows;
}

py::dict describe(const std::string& key, const char* kind, const char* meaning,
                  const Value& default_value) {
    py::dict row;
    row["name"] = key;
    row["kind"] = kind;
    row["meaning"] = meaning;
    row["default"] = default_value;
    return row;
}

py::dict describe(const std::string& key, const Parameter& p, const Value& default_value) {
    py::dict row = describe(key, p.integer ? "whole" : "real", p.meaning, default_value);
    row["unit"] = p.unit;
    row["low"] = p.low;
    row["high"] = p.high;
    row["allowed"] = allowed_range(p);
    return row;
}

std::string quoted_words(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "\"" : ", \"") + word + "\"";
    return text;
}

/// Every key of a scenario, section by section in the order of a file: dictionaries with name,
/// kind, meaning, default, allowed, and unit, low, high or words.
py::list describe_keys() {
    const Scenario defaults;
    std::vector<py::dict> rows;
    for (const Choice& c : choices()) {
        const Parameter* number = find_parameter(c.key);
        py::dict row = describe(c.key, c.set_some ? "fields" : "word", c.meaning, c.get(defaults));
        row["allowed"] = (c.set_some ? "one or more of " : "one of ") + quoted_words(c.allowed);
        if (number != nullptr) {
            row = describe(c.key, *number, c.get(defaults));
            row["kind"] = "rate";
            row["allowed"] = allowed_range(*number) + ", or one of " + quoted_words(c.allowed);
        }
        row["words"] = py::tuple(py::cast(c.allowed));
        rows.push_back(row);
    }
    for (const Parameter& p : parameters()) {
        if (find_choice(p.key) != nullptr) continue;
        rows.push_back(describe(p.key, p, value_of(p, defaults)));
    }
    for (const UserEffectHandle& effect : user_effects()) {
        for (std::size_t i = 0; i < effect->parameters.size(); ++i) {
            const std::string key = effect->key(i);
            const UserParameter& p = effect->parameters[i];
            rows.push_back(describe(key, row_of(key, p), p.absent));
        }
    }
    const auto place = [](const py::dict& row) {
        const auto key = row["name"].cast<std::string>();
        const auto found =
            std::find_if(sections().begin(), sections().end(), [&](const Section& section) {
                return key.starts_with(std::string(section.name) + ".");
            });
        return found - sections().begin();
    };
    std::stable_sort(rows.begin(), rows.end(), [&](const py::dict& one, const py::dict& other) {
        return place(one) < place(other);
    });
    return py::cast(rows);
}

/// A key that laws of one's own can have, as in `key_table`; None for another.
py::object describe_law_key(const std::string& name) {
    const std::optional<LawPlace> place = find_law_key(name);
    if (!place) return py::none();
    const LawKey& key = *place->key;
    if (!key.words.empty()) {
        py::dict row = describe(name, "word", key.meaning, std::string());
        row["allowed"] = "one of " + quoted_words(key.words);
        row["words"] = py::tuple(py::cast(key.words));
        return row;
    }
    const Parameter number{.key = name.c_str(),
                           .unit = "-",
                           .low = key.low,
                           .high = key.high,
                           .low_allowed = key.low_allowed,
                           .meaning = key.meaning};
    py::dict row = describe(name, number, 0.0);
    row["unit"] = key.unit;
    return row;
}

/// The kind of drive that each word of drive.mode is.
py::dict drive_kinds() {
    py::dict kinds;
    const std::vector<std::string>& modes = find_choice("drive.mode")->allowed;
    for (std::size_t i = 0; i < modes.size(); ++i) {
        const DriveKind kind = kind_of(static_cast<DriveMode>(i));
        kinds[py::str(modes[i])] = kDriveKinds[static_cast<std::size_t>(kind)];
    }
    return kinds;
}

/// Name, meaning and source of the named effects: those of the model, then those of the user.
py::list describe_effects() {
    py::list rows;
    const auto add = [&](const auto& name, const auto& meaning, const auto& source) {
        py::dict row;
        row["name"] = name;
        row["meaning"] = meaning;
        row["source"] = source;
        rows.append(row);
    };
    for (const EffectDescription& e : effects()) add(e.name, e.meaning, e.source);
    for (const UserEffectHandle& e : user_effects()) add(e->name, e->meaning, e->source);
    return rows;
}

VoltageProgram program_from(const std::vector<std::tuple<Array, Array, std::int64_t>>& blocks) {
    std::vector<VoltageBlock> result;
    for (const auto& [times, voltages, repeats] : blocks) {
        const auto t = times.unchecked<1>();
        const auto v = voltages.unchecked<2>();
        if (v.shape(0) != t.shape(0) || v.shape(1) != py::ssize_t{kCoilCount}) {
            throw std::invalid_argument("voltages must have the shape (n, 5) for n times");
        }
        std::vector<VoltagePoint> points;
        for (py::ssize_t i = 0; i < t.shape(0); ++i) {
            points.push_back({t(i), {v(i, 0), v(i, 1), v(i, 2), v(i, 3), v(i, 4)}});
        }
        result.push_back({std::move(points), repeats});
    }
    return VoltageProgram(std::move(result));
}

/// Blocks as (times (s), voltages (V) of shape (n, 5), repeats).
py::list blocks_of(const VoltageProgram& program) {
    py::list result;
    for (const VoltageBlock& block : program.blocks()) {
        const VoltagePoint& first = block.points.front();
        constexpr py::ssize_t kNumber = sizeof(double), kNext = sizeof(VoltagePoint);
        const auto count = static_cast<py::ssize_t>(block.points.size());
        result.append(py::make_tuple(py::array_t<double>({count}, {kNext}, &first.time),
                                     py::array_t<double>({count, py::ssize_t{kCoilCount}},
                                                         {kNext, kNumber}, &first.voltage[0]),
                                     block.repeats));
    }
    return result;
}

/// Takes rows of time (s) and acceleration along x and z (m/s^2), or none; gives the means left
/// out.
std::array<double, 2> set_accelerations(Scenario& scenario, const std::optional<Array>& rows) {
    scenario.shake.accelerations = nullptr;
    if (!rows) return {};
    const auto r = rows->unchecked<2>();
    std::vector<Accelerations::Point> points;
    for (py::ssize_t i = 0; i < r.shape(0); ++i) points.push_back({r(i, 0), r(i, 1), r(i, 2)});
    const auto made = std::make_shared<const Accelerations>(std::move(points));
    scenario.shake.accelerations = made;
    return made->mean();
}

/// Takes rows of time (s) and force on the inner mass (N), or none.
void set_forces(Scenario& scenario, const std::optional<Array>& rows) {
    scenario.inner.drive.rows = nullptr;
    if (!rows) return;
    const auto r = rows->unchecked<2>();
    std::vector<InnerDrive::Row> given;
    for (py::ssize_t i = 0; i < r.shape(0); ++i) given.push_back({r(i, 0), r(i, 1)});
    scenario.inner.drive.set_rows(std::move(given));
}

/// The voltages as the coils get them, in the world's frame.
VoltageProgram world_program(const Scenario& scenario) {
    const RobotFrame frame = frame_of(scenario);
    return frame.to_world(make_program(scenario, frame));
}

/// f of an effect with a free shape, or of a law that is a curve, as an array of the shape of
/// `arguments`.
Array free_curve_at(const Scenario& scenario, const std::string& name, const Array& arguments) {
    const FreeCurve curve(free_shape(scenario, name));
    Array result(std::vector<py::ssize_t>(arguments.shape(), arguments.shape() + arguments.ndim()));
    for (py::ssize_t i = 0; i < arguments.size(); ++i) {
        result.mutable_data()[i] = curve.at(arguments.data()[i]);
    }
    return result;
}

}  // namespace

void register_scenario(py::module_& module) {
    module.def("key_table", &describe_keys, doc::describe_keys);
    module.def("law_key", &describe_law_key, py::arg("name"), doc::describe_law_key);
    module.def("effects", &describe_effects, doc::describe_effects);
    module.attr("sections") = meanings_of(sections());
    module.attr("drive_kinds") = drive_kinds();
    module.attr("law_keys") = names_of(law_keys());
    module.attr("named_laws") = names_of(with_named_laws(std::vector<EffectDescription>()));

    py::class_<VoltageProgram>(module, "VoltageProgram", doc::VoltageProgram)
        .def(py::init(&program_from), py::arg("blocks"), "From blocks like those of `blocks`.")
        .def_property_readonly("blocks", &blocks_of, doc::blocks_of)
        .def_property_readonly("duration", &VoltageProgram::duration, "Of all blocks together, s.")
        .def(
            "turned", [](const VoltageProgram& self) { return turned(self); },
            "The program as a robot turned by 180 degrees about z sees it.");

    py::class_<SimulationState>(module, "State", doc::SimulationState)
        .def("get", &state_value, py::arg("key"), doc::state_value);

    py::class_<Scenario>(module, "Scenario", doc::Scenario)
        .def(py::init<>())
        .def(py::init([](const Scenario& other) {
            Scenario made(other);
            renew_user_effects(made);
            return made;
        }))
        .def("set", &set_value, py::arg("key"), py::arg("value"), doc::set_parameter)
        .def(
            "get", [](const Scenario& self, const std::string& key) { return value_of(self, key); },
            py::arg("key"), doc::value_of)
        .def("remove_law", &remove_law, py::arg("name"), "Removes the law of that name.")
        .def("changed", &changed_values, doc::changed_values)
        .def("take", &take_section, py::arg("other"), py::arg("section"), doc::take_section)
        .def(
            "take",
            [](Scenario& self, const SimulationState& state, const std::string& /*section*/) {
                self.initial = state;
            },
            "Sets the section `initial`.")
        .def(
            "set_program",
            [](Scenario& self, const VoltageProgram* program) {
                self.program = program ? *program : VoltageProgram();
            },
            py::arg("program"), "Sets the voltages of a program; None removes them.")
        .def(
            "set_map",
            [](Scenario& self, const FieldMap* map) {
                self.map = map ? std::make_shared<const FieldMap>(*map) : nullptr;
            },
            py::arg("map"), "Sets the map of the field; None removes it.")
        .def("set_accelerations", &set_accelerations, py::arg("rows"), doc::set_accelerations)
        .def("set_forces", &set_forces, py::arg("rows"), doc::set_forces)
        .def("check", &check, doc::check)
        .def("coils", &world_coil_set, doc::world_coil_set)
        .def(
            "resistances",
            [](const Scenario& self) {
                PerCoil result;
                for (std::size_t k = 0; k < kCoilCount; ++k) {
                    result[k] = self.coils[k].resistance;
                }
                return result;
            },
            "Resistance of each coil, ohm.")
        .def("program", &world_program, doc::world_program)
        .def("commanded_voltages", &commanded_voltages, doc::commanded_voltages)
        .def(
            "rocking_rate",
            [](const Scenario& self, double tesla) {
                return make_model(self, frame_of(self)).rocking_rate(tesla);
            },
            py::arg("tesla"), doc::Model_rocking_rate)
        .def("free_curve", &free_curve_at, py::arg("name"), py::arg("arguments"),
             doc::free_curve_at)
        .def_property_readonly(
            "in_plane_coil",
            [](const Scenario& self) { return name(in_plane_coil(drive_direction(self))); },
            "Name of the coil that the drive pulls with in the plane.")
        .def_property_readonly(
            "whole_plane", [](const Scenario& self) { return frame_of(self).whole_plane; },
            doc::RobotFrame_whole_plane)
        .def_property_readonly("duration", &duration, doc::duration)
        .def_property_readonly("pulse_rate", &pulse_rate, doc::pulse_rate)
        .def_property_readonly(
            "window",
            [](const Scenario& self) {
                const Window window = measuring_window(self);
                return py::make_tuple(window.start, window.end);
            },
            doc::Window);
}

}  // namespace stickslip::bindings
