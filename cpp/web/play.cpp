// Functions of the core for the page to play with, by Embind.

#include <emscripten/bind.h>

#include <Eigen/LU>
#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/readings/note_rows.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace stickslip {
namespace {

using emscripten::val;

/// A copy that outlives the next growth of the module's memory.
template <class Number>
val copied(const std::vector<Number>& column) {
    return val(emscripten::typed_memory_view(column.size(), column.data())).call<val>("slice");
}

val object_of(const RunResult& run) {
    val out = val::object();
    out.set("status", std::string(row_of(run.status).name));
    out.set("message", message(run));
    for (const SummaryNumber& number : kSummaryNumbers) {
        out.set(std::string(number.name), run.summary.*number.member);
    }
    val events = val::object();
    for (std::size_t kind = 0; kind < kEventKinds; ++kind) {
        events.set(std::string(kEvents[kind].name), static_cast<double>(run.summary.events[kind]));
    }
    out.set("events", events);
    return out;
}

/// The magnetic force (N) at each sample of a run with the in-plane coils of a heading along x and
/// the clamp coil: which field each of the two makes is in the recorded sum, whatever the effects
/// between voltage and field.
void add_magnetic_force(const Scenario& scenario, const Recording& record, val& out) {
    const CoilSet coils = world_coil_set(scenario);
    const Model model = make_model(scenario, frame_of(scenario));
    const double sign = model.frame.sign;
    const Coil driven = sign > 0.0 ? Coil::xp : Coil::xm;
    const Coil behind = sign > 0.0 ? Coil::xm : Coil::xp;
    // Both coils of a pair make the same field at the centre.
    const double of_behind =
        scenario.drive.coils == DriveCoils::pairs
            ? coils.centre_field_per_ampere(driven) / coils.centre_field_per_ampere(behind)
            : 0.0;
    const Effects& effects = scenario.effects;
    std::vector<double> fx, fz;
    for (std::size_t i = 0; i < record.t.size(); ++i) {
        const Eigen::Vector3d place(record.x[i], 0.0, record.z[i]);
        FieldAndGradient ahead = coils.unit_field(driven, place);
        if (of_behind != 0.0) {
            const FieldAndGradient other = coils.unit_field(behind, place);
            ahead.field += of_behind * other.field;
            ahead.gradient += of_behind * other.gradient;
        }
        const FieldAndGradient below = coils.unit_field(Coil::clamp, place);
        Eigen::Matrix2d unit;
        unit << ahead.field.x(), below.field.x(), ahead.field.z(), below.field.z();
        const Eigen::Vector2d of_coils(record.bx[i] - effects.ambient_field_bx,
                                       record.bz[i] - effects.ambient_field_bz);
        const Eigen::Vector2d currents = unit.inverse() * of_coils;
        const Eigen::Matrix3d gradient =
            ahead.gradient * currents[0] + below.gradient * currents[1];
        const double angle = record.theta[i] + model.misalignment;
        const double size = model.moment * (1.0 + model.gradient_excess);
        const Eigen::Vector3d moment(sign * std::cos(angle), 0.0, -std::sin(angle));
        const Eigen::Vector3d force = size * gradient.transpose() * moment;
        fx.push_back(force.x());
        fz.push_back(force.z());
    }
    out.set("magnetic_x", copied(fx));
    out.set("magnetic_z", copied(fz));
    out.set("misalignment", model.misalignment);
}

/// The result of `make`, or {error: why the scenario is refused}.
template <class Make>
val or_error(Make make) {
    try {
        return make();
    } catch (const std::exception& failure) {
        val out = val::object();
        out.set("error", std::string(failure.what()));
        return out;
    }
}

void set_in(Scenario& scenario, const val& changes) {
    const val keys = val::global("Object").call<val>("keys", changes);
    for (const std::string& key : emscripten::vecFromJSArray<std::string>(keys)) {
        const val value = changes[key];
        if (value.isString()) {
            set_choice(scenario, key, value.as<std::string>());
        } else {
            set_parameter(scenario, key, value.as<double>());
        }
    }
}

/// Each call takes an object of keys and values, which the scenario has beside its defaults.

/// Plays a run, recorded `rate` times a second of simulated time.
val play(const val& changes, double rate) {
    return or_error([&] {
        Scenario scenario;
        set_in(scenario, changes);
        scenario.record.kind = RecordKind::uniform;
        scenario.record.rate = rate;
        const RunResult run = simulate(scenario);
        const Recording& record = run.recording;
        val out = object_of(run);
        const auto keep = [&](const char* column, const auto& values) {
            out.set(column, copied(values));
        };
        keep("t", record.t);
        keep("x", record.x);
        keep("z", record.z);
        keep("theta", record.theta);
        keep("vx", record.vx);
        keep("normal_force", record.normal_force);
        keep("friction_force", record.friction_force);
        keep("contact_x", record.contact_x);
        keep("slip_velocity", record.slip_velocity);
        keep("bx", record.bx);
        keep("bz", record.bz);
        keep("contact", record.contact);
        add_magnetic_force(scenario, record, out);
        const Window window = measuring_window(scenario);
        out.set("window_start", window.start);
        out.set("window_end", window.end);
        return out;
    });
}

/// The numbers of a run.
val measure(const val& changes) {
    return or_error([&] {
        Scenario scenario;
        set_in(scenario, changes);
        return object_of(simulate(scenario));
    });
}

/// Judgement of a run that `play` or `measure` gave: its notes, in words that `wording` finds as
/// `Wording` does, whether it moves, and whether it goes back.
val notes(const val& changes, const val& run, const val& wording) {
    return or_error([&] {
        Scenario scenario;
        set_in(scenario, changes);
        Summary summary;
        for (const SummaryNumber& number : kSummaryNumbers) {
            summary.*number.member = run[std::string(number.name)].as<double>();
        }
        for (std::size_t kind = 0; kind < kEventKinds; ++kind) {
            const val count = run["events"][std::string(kEvents[kind].name)];
            summary.events[kind] = static_cast<std::int64_t>(count.as<double>());
        }
        const bool ok = run["status"].as<std::string>() == "ok";
        Wording words;
        words.key = [&](std::string_view key) {
            return wording.call<std::string>("key", std::string(key));
        };
        words.setting = [&](std::string_view key, const SettingValue& value) {
            return std::visit(
                [&](const auto& is) {
                    return wording.call<std::string>("setting", std::string(key), is);
                },
                value);
        };
        words.number = [&](double value, int digits, std::string_view unit) {
            return wording.call<std::string>("number", value, digits, std::string(unit));
        };
        val list = val::array();
        for (const Note& note : run_notes(scenario, summary, ok, false, words)) {
            val each = val::object();
            each.set("code", std::string(note.code));
            each.set("text", note.text);
            list.call<void>("push", each);
        }
        const NoteFacts facts{.s = scenario, .run = summary, .ok = ok};
        val out = val::object();
        out.set("notes", list);
        out.set("moves", facts.moves());
        out.set("goes_back", facts.goes_back());
        return out;
    });
}

/// Default, unit and meaning of a numeric key.
val describe(const std::string& key) {
    return or_error([&] {
        const Parameter* parameter = find_parameter(key);
        if (parameter == nullptr) throw std::invalid_argument(key + ": there is no such key");
        val out = val::object();
        out.set("default", parameter->get(Scenario()));
        out.set("unit", std::string(parameter->unit));
        out.set("meaning", std::string(parameter->meaning));
        return out;
    });
}

/// Meaning of a named extension; empty for an unknown one.
std::string effect_meaning(const std::string& name) {
    for (const EffectDescription& each : effects()) {
        if (name == each.name) return each.meaning;
    }
    return {};
}

/// Names of the contact modes, in the order of their codes in `contact`.
val contact_names() {
    std::vector<std::string> names;
    for (const auto& word : kContactWords) names.emplace_back(word.name);
    return val::array(std::vector<std::string>(names.begin() + 1, names.end()));
}

}  // namespace
}  // namespace stickslip

EMSCRIPTEN_BINDINGS(stickslip) {
    emscripten::function("play", &stickslip::play);
    emscripten::function("measure", &stickslip::measure);
    emscripten::function("notes", &stickslip::notes);
    emscripten::function("describe", &stickslip::describe);
    emscripten::function("effectMeaning", &stickslip::effect_meaning);
    emscripten::function("contactNames", &stickslip::contact_names);
}
