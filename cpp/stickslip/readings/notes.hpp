#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "stickslip/run/simulation.hpp"

/// Notes: sentences about a scenario, or a run of it, that a reader could misread.
namespace stickslip {

struct Note {
    const char* code;             ///< stays the same where the words change
    std::string text;             ///< the observation and the remedy
    std::optional<double> value;  ///< the number concerned, SI units
};

/// A number or a word.
using SettingValue = std::variant<double, std::string>;

/// How sentences name settings and numbers. By default settings have the names of a scenario file
/// and SI units.
struct Wording {
    std::function<std::string(std::string_view key)> key;
    std::function<std::string(std::string_view key, const SettingValue& value)> setting;
    /// value: in `unit`, "" for a pure number
    std::function<std::string(double value, int digits, std::string_view unit)> number;

    Wording();
};

/// Notes on probable mistakes among the values of a scenario, the most serious first.
std::vector<Note> scenario_notes(const Scenario& scenario, const Wording& words = {});

/// The same with notes on a run, from its summary. The cause that holds a robot at rest is found by
/// short simulations.
///
/// ok: whether the run came to its end. cut: whether it was ended by its condition.
std::vector<Note> run_notes(const Scenario& scenario, const Summary& summary, bool ok, bool cut,
                            const Wording& words = {}, RunControl* control = nullptr);

/// Swing of the steady field of a sawtooth whose voltage is sudden on one side, over that asked.
///
/// The current follows the voltage by Eq. (1) with the time constant (s). Over a period T from the
/// jump, a sawtooth of swing 1 that falls from 1 gives i(t) = 1 - t/T + c - exp(-t/tau) /
/// (1 - exp(-T/tau)) with c = tau/T, which is least at the jump.
double field_swing(double frequency, double time_constant);

/// The largest voltage that the drive asks of each coil of the world's frame, V.
PerCoil commanded_voltages(const Scenario& scenario);

}  // namespace stickslip
