#include "stickslip/readings/notes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/readings/note_rows.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace stickslip {
namespace {

// Pulses of a trial; chosen: enough to see a step.
constexpr std::int64_t kTriedPulses = 12;

// Factor from SI to each unit.
constexpr std::array<std::pair<std::string_view, double>, 7> kUnits = {
    {{"%", 100.0},
     {"mT", 1e3},
     {"mm/s", 1e3},
     {"ms", 1e3},
     {"nN", 1e9},
     {"nN m", 1e9},
     {"degrees", 180.0 / std::numbers::pi}}};

std::string number_text(double value, int digits, std::string_view unit) {
    const std::string text = by_printf::formatted("%.*g", digits, value);
    return unit.empty() ? text : text + " " + std::string(unit);
}

/// A scenario's first pulses with the changes of a trial. Throws std::invalid_argument for a value
/// beyond its range.
Scenario tried_scenario(const Scenario& scenario, const NoteTrial& trial) {
    Scenario tried = scenario;
    tried.record = {.pull_share = scenario.record.pull_share};
    if (trial.voltages != 1.0) {
        const RobotFrame frame = frame_of(scenario);
        std::vector<VoltageBlock> blocks = frame.to_world(make_program(scenario, frame)).blocks();
        for (VoltageBlock& block : blocks) {
            for (VoltagePoint& point : block.points) {
                for (double& volts : point.voltage) volts *= trial.voltages;
            }
        }
        tried.program = VoltageProgram(std::move(blocks));
    }
    if (scenario.drive.kind() != DriveKind::program) {
        tried.drive.pulses = std::min(scenario.drive.pulses, kTriedPulses);
    }
    for (const auto& [key, value] : trial.settings) {
        const auto* word = std::get_if<std::string>(&value);
        word ? set_choice(tried, key, *word) : set_parameter(tried, key, std::get<double>(value));
    }
    return tried;
}

/// The text of a row with what stands in braces.
class Sentence {
public:
    Sentence(const NoteRow& row, const NoteFacts& facts, const Wording& words)
        : row_(row), facts_(facts), words_(words), trial_(), tried_(&facts) {}

    /// Nothing where no trial does as the row says.
    std::optional<std::string> text(RunControl* control) {
        if (row_.trials == nullptr) return filled(row_.text);
        for (const NoteTrial& trial : row_.trials(facts_)) {
            try {
                const Scenario scenario = tried_scenario(facts_.s, trial);
                const RunResult run = simulate(scenario, control);
                const NoteFacts tried{.s = scenario, .run = run.summary, .ok = true};
                if (run.status != Status::ok || !row_.then(tried)) continue;
                trial_ = trial;
                tried_ = &tried;
                return filled(row_.text);
            } catch (const std::invalid_argument&) {
                continue;  // a value beyond its range
            }
        }
        return std::nullopt;
    }

private:
    std::string filled(std::string_view text) const {
        std::string result;
        while (true) {
            const std::size_t open = text.find('{');
            result += text.substr(0, open);
            if (open == std::string_view::npos) return result;
            const std::size_t close = text.find('}', open);
            result += place(text.substr(open + 1, close - open - 1));
            text.remove_prefix(close + 1);
        }
    }

    std::string place(std::string_view name) const {
        if (name == "advice") return filled(row_.advice(facts_));
        if (name == "coil") return stickslip::name(kAllCoils[facts_.coil]);
        if (name == "set") return changes();
        if (const std::size_t at = name.find('='); at != std::string_view::npos) {
            return setting(name.substr(0, at), name.substr(at + 1));
        }
        const std::size_t at = name.find(':');
        if (at == std::string_view::npos) return words_.key(name);
        return number(name.substr(0, at), name.substr(at + 1));
    }

    std::string changes() const {
        if (trial_.voltages != 1.0) return "larger voltages";
        std::string text;
        for (const auto& [key, value] : trial_.settings) {
            text += (text.empty() ? "" : ", ") + words_.setting(key, value);
        }
        return text;
    }

    std::string setting(std::string_view key, std::string_view value) const {
        if (!value.empty() && find_choice(key)) return words_.setting(key, std::string(value));
        return words_.setting(key, facts_.number(value.empty() ? key : value));
    }

    std::string number(std::string_view name, std::string_view unit) const {
        const bool of_trial = name.starts_with("tried.");
        if (of_trial) name.remove_prefix(6);
        int digits = 3;
        if (const std::size_t at = unit.find(':'); at != std::string_view::npos) {
            digits = unit[at + 1] - '0';
            unit = unit.substr(0, at);
        }
        double value = (of_trial ? *tried_ : facts_).number(name);
        for (const auto& [known, factor] : kUnits) {
            if (unit == known) value *= factor;
        }
        return words_.number(value, digits, unit);
    }

    const NoteRow& row_;
    const NoteFacts& facts_;
    const Wording& words_;
    NoteTrial trial_;
    const NoteFacts* tried_;
};

std::vector<Note> notes_of(NoteFacts facts, bool of_run, const Wording& words,
                           RunControl* control) {
    std::vector<Note> notes;
    std::set<std::string_view> given;
    for (const NoteRow& row : note_rows()) {
        if (!of_run && row.of == NoteOf::run) continue;
        for (facts.coil = 0; facts.coil < (row.of == NoteOf::coil ? kCoilCount : 1u);
             ++facts.coil) {
            if ((row.first_of && given.contains(row.first_of)) || !row.holds(facts)) continue;
            const auto text = Sentence(row, facts, words).text(control);
            if (!text) continue;
            if (row.first_of) given.insert(row.first_of);
            const auto value = row.value ? std::optional(facts.number(row.value)) : std::nullopt;
            notes.push_back({row.code, *text, value});
        }
    }
    return notes;
}

}  // namespace

// clang-format off
#define STICKSLIP_FACT(name) {#name, &NoteFacts::name}
double NoteFacts::number(std::string_view name) const {
    static constexpr std::pair<std::string_view, double (NoteFacts::*)() const> kOwn[] = {
        STICKSLIP_FACT(density), STICKSLIP_FACT(moment), STICKSLIP_FACT(inner_share),
        STICKSLIP_FACT(resting_force), STICKSLIP_FACT(friction_held), STICKSLIP_FACT(slope),
        STICKSLIP_FACT(slope_force), STICKSLIP_FACT(slope_hold), STICKSLIP_FACT(swing),
        STICKSLIP_FACT(middle_field), STICKSLIP_FACT(usual_base), STICKSLIP_FACT(pulse),
        STICKSLIP_FACT(window_duration), STICKSLIP_FACT(time_constant),
        STICKSLIP_FACT(capacitance), STICKSLIP_FACT(asked_voltage), STICKSLIP_FACT(asked_current),
        STICKSLIP_FACT(pulse_in_times), STICKSLIP_FACT(swing_left), STICKSLIP_FACT(measured),
        STICKSLIP_FACT(speed), STICKSLIP_FACT(forward), STICKSLIP_FACT(tilt),
        STICKSLIP_FACT(torque), STICKSLIP_FACT(held_torque), STICKSLIP_FACT(roll_over),
    };
#undef STICKSLIP_FACT
    // clang-format on
    for (const auto& [known, fact] : kOwn) {
        if (known == name) return (this->*fact)();
    }
    for (const SummaryNumber& each : kSummaryNumbers) {
        if (each.name == name) return run.*each.member;
    }
    if (const Parameter* row = find_parameter(name)) return row->get(s);
    throw std::logic_error(std::string(name) + ": no such number of notes");
}

Wording::Wording()
    : key([](std::string_view name) { return std::string(name); }),
      setting([](std::string_view name, const SettingValue& value) {
          const std::string start = std::string(name) + " = ";
          if (const auto* word = std::get_if<std::string>(&value)) return start + '"' + *word + '"';
          const std::string_view unit = find_parameter(name)->unit;
          return start + number_text(std::get<double>(value), 4, unit == "-" ? "" : unit);
      }),
      number(&number_text) {}

std::vector<Note> scenario_notes(const Scenario& scenario, const Wording& words) {
    return notes_of({.s = scenario, .asked = commanded_voltages(scenario)}, false, words, nullptr);
}

std::vector<Note> run_notes(const Scenario& scenario, const Summary& summary, bool ok, bool cut,
                            const Wording& words, RunControl* control) {
    const PerCoil asked = commanded_voltages(scenario);
    return notes_of({.s = scenario, .run = summary, .ok = ok, .cut = cut, .asked = asked}, true,
                    words, control);
}

double field_swing(double frequency, double time_constant) {
    const double share = 1.0 / std::max(frequency * time_constant, 1e-300);
    if (share < 1e-6) return share / 8.0;  // the first term in it, of which rounding leaves nothing
    const double fall = -std::expm1(-share);
    const double top = -std::log(fall / share);  // t/tau where i is largest
    return (1.0 - std::exp(-top)) / fall - top / share;
}

PerCoil commanded_voltages(const Scenario& scenario) {
    const RobotFrame frame = frame_of(scenario);
    return frame.to_world(commanded_program(scenario, frame)).largest_voltage();
}

}  // namespace stickslip
