#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <bitset>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "register.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/free_shapes.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace py = pybind11;

namespace stickslip::bindings {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::dict describe(const Parameter& p, double default_value) {
    py::dict row;
    row["key"] = p.key;
    row["unit"] = p.unit;
    row["low"] = p.low;
    row["high"] = p.high;
    row["allowed"] = allowed_range(p);
    row["integer"] = p.integer;
    row["default"] = default_value;
    row["meaning"] = p.meaning;
    return row;
}

py::list describe_parameters() {
    const Scenario defaults;
    py::list rows;
    for (const Parameter& p : parameters()) rows.append(describe(p, p.get(defaults)));
    for (const UserEffectHandle& effect : user_effects()) {
        for (std::size_t i = 0; i < effect->parameters.size(); ++i) {
            const std::string key = effect->key(i);
            const UserParameter& p = effect->parameters[i];
            rows.append(describe(row_of(key, p), p.absent));
        }
    }
    return rows;
}

py::list describe_choices() {
    const Scenario defaults;
    py::list rows;
    for (const Choice& c : choices()) {
        py::dict row;
        row["key"] = c.key;
        row["allowed"] = c.allowed;
        row["default"] = c.get(defaults);
        row["meaning"] = c.meaning;
        rows.append(row);
    }
    return rows;
}

/// Those of the model, then those of the user.
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

/// Blocks as (times, voltages (n, 5), repeats).
VoltageProgram program_from(const py::list& blocks) {
    std::vector<VoltageBlock> result;
    for (const py::handle item : blocks) {
        const auto [times, voltages, repeats] = item.cast<std::tuple<Array, Array, std::int64_t>>();
        const auto t = times.unchecked<1>();
        const auto v = voltages.unchecked<2>();
        if (v.shape(0) != t.shape(0) || v.shape(1) != kCoilCount) {
            throw std::invalid_argument("voltages must have the shape (n, 5) for n times");
        }
        VoltageBlock block;
        block.repeats = repeats;
        for (py::ssize_t i = 0; i < t.shape(0); ++i) {
            VoltagePoint point{t(i), {}};
            for (py::ssize_t k = 0; k < kCoilCount; ++k) {
                point.voltage[static_cast<std::size_t>(k)] = v(i, k);
            }
            block.points.push_back(point);
        }
        result.push_back(std::move(block));
    }
    return VoltageProgram(std::move(result));
}

py::list blocks_of(const VoltageProgram& program) {
    py::list result;
    for (const VoltageBlock& block : program.blocks()) {
        const auto count = static_cast<py::ssize_t>(block.points.size());
        Array times(count);
        Array voltages({count, py::ssize_t{kCoilCount}});
        auto t = times.mutable_unchecked<1>();
        auto v = voltages.mutable_unchecked<2>();
        for (py::ssize_t i = 0; i < count; ++i) {
            const VoltagePoint& point = block.points[static_cast<std::size_t>(i)];
            t(i) = point.time;
            for (py::ssize_t k = 0; k < kCoilCount; ++k) {
                v(i, k) = point.voltage[static_cast<std::size_t>(k)];
            }
        }
        result.append(py::make_tuple(times, voltages, block.repeats));
    }
    return result;
}

/// The voltages as the coils get them, in the world's frame.
VoltageProgram world_program(const Scenario& scenario) {
    const VoltageProgram program = make_program(scenario);
    return frame_sign(scenario) > 0.0 ? program : turned(program);
}

/// The largest that the drive asks of each coil of the world's frame, V.
PerCoil asked_voltages(const Scenario& scenario) {
    const VoltageProgram program = asked_program(scenario);
    return frame_sign(scenario) > 0.0 ? program.largest_voltage()
                                      : turned(program).largest_voltage();
}

std::vector<std::string> every_column() {
    std::vector<std::string> names;
    for (const RecordColumn& column : kRecordColumns) names.emplace_back(column.name);
    return names;
}

/// The columns that are not among `fields`, t never among them.
std::bitset<kColumns> all_but(const std::vector<std::string>& fields) {
    std::bitset<kColumns> dropped;
    for (std::size_t k = 1; k < kColumns; ++k) {
        dropped[k] =
            std::find(fields.begin(), fields.end(), kRecordColumns[k].name) == fields.end();
    }
    return dropped;
}

/// f of one of the effects with a free shape, as an array of the shape of `arguments`.
Array free_curve_at(const Scenario& scenario, const std::string& effect, const Array& arguments) {
    const FreeCurve curve(free_shape(scenario, effect));
    Array result(std::vector<py::ssize_t>(arguments.shape(), arguments.shape() + arguments.ndim()));
    for (py::ssize_t i = 0; i < arguments.size(); ++i) {
        result.mutable_data()[i] = curve.at(arguments.data()[i]);
    }
    return result;
}

}  // namespace

void register_scenario(py::module_& module) {
    module.def("parameters", &describe_parameters);
    module.def("choices", &describe_choices);
    module.def("effects", &describe_effects);

    py::class_<Scenario>(module, "Scenario")
        .def(py::init<>())
        .def(py::init<const Scenario&>())
        .def(
            "set",
            [](Scenario& self, const std::string& key,
               const std::variant<double, std::string>& value) {
                if (const auto* number = std::get_if<double>(&value)) {
                    set_parameter(self, key, *number);
                } else {
                    set_choice(self, key, std::get<std::string>(value));
                }
            },
            py::arg("key"), py::arg("value"))
        .def(
            "set_program",
            [](Scenario& self, const py::list& blocks) { self.program = program_from(blocks); },
            py::arg("blocks"))
        .def(
            "set_map",
            [](Scenario& self, const FieldMap& map) {
                self.map = std::make_shared<const FieldMap>(map);
            },
            py::arg("map"))
        .def("record_nothing", [](Scenario& self) { self.record = {}; })
        .def(
            "record_events",
            [](Scenario& self, double start, const std::vector<std::string>& fields) {
                self.record = {RecordKind::events, 0.0, start, all_but(fields), {}};
            },
            py::arg("start") = 0.0, py::arg("fields") = every_column())
        .def(
            "record_uniform",
            [](Scenario& self, double rate, double start, const std::vector<std::string>& fields) {
                self.record = {RecordKind::uniform, rate, start, all_but(fields), {}};
            },
            py::arg("rate"), py::arg("start") = 0.0, py::arg("fields") = every_column())
        .def("check", &check)
        .def("coils", [](const Scenario& self) { return world_coil_set(self); })
        .def("resistances",
             [](const Scenario& self) {
                 PerCoil result;
                 for (std::size_t k = 0; k < kCoilCount; ++k) {
                     result[k] = self.coils[k].resistance;
                 }
                 return result;
             })
        .def("program", [](const Scenario& self) { return blocks_of(world_program(self)); })
        .def("asked_voltages", &asked_voltages)
        .def(
            "rocking_rate",
            [](const Scenario& self, double tesla) { return make_model(self).rocking_rate(tesla); },
            py::arg("tesla"))
        .def("free_curve", &free_curve_at, py::arg("effect"), py::arg("arguments"))
        .def_property_readonly(
            "in_plane_coil",
            [](const Scenario& self) { return name(in_plane_coil(drive_direction(self))); })
        .def_property_readonly("turns", [](const Scenario& self) { return in_whole_plane(self); })
        .def_property_readonly("duration", &duration)
        .def_property_readonly("window", [](const Scenario& self) {
            const Window window = measuring_window(self);
            return py::make_tuple(window.start, window.end);
        });
}

}  // namespace stickslip::bindings
