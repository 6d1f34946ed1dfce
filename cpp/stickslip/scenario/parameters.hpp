#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/scenario/scenario.hpp"
#include "stickslip/scenario/user_effects.hpp"

namespace stickslip {

/// A numeric key of a scenario file: the one place where its unit, range and meaning stand.
struct Parameter {
    const char* key = nullptr;   ///< "section.name", "effects.effect.name"
    const char* unit = nullptr;  ///< SI, "-" for none
    double low = 0.0, high = 0.0;
    bool low_allowed = true;  ///< whether `low` itself is allowed
    bool integer = false;
    const char* meaning = nullptr;
    double (*get)(const Scenario&) = nullptr;
    void (*set)(Scenario&, double) = nullptr;
};

/// A key that takes one of a few words. One that stands among the `Parameter`s too takes a number
/// or a word, and `get` gives "" where it holds a number.
struct Choice {
    const char* key;
    std::vector<std::string> allowed;
    const char* meaning;
    std::string (*get)(const Scenario&);
    void (*set)(Scenario&, std::size_t index) = nullptr;
    /// Where some of the words, with commas between them, are one value: sets all of them.
    void (*set_some)(Scenario&, const std::vector<std::size_t>& indices) = nullptr;
};

/// A section of a scenario file that is always there, in the order of a file.
struct Section {
    const char* name;
    const char* meaning;  ///< a sentence, and more lines of what its keys have in common
};

/// A named extension: what it adds and where the form comes from. Its parameters are those whose
/// keys begin with "effects.<name>.".
struct EffectDescription {
    const char* name;
    const char* meaning;
    const char* source;
};

/// All numeric keys, all keys that take words, all named extensions.
const std::vector<Parameter>& parameters();
const std::vector<Choice>& choices();
const std::vector<EffectDescription>& effects();
const std::vector<Section>& sections();

/// nullptr if there is no numeric key, or no key that takes words, of that name.
const Parameter* find_parameter(std::string_view key);
const Choice* find_choice(std::string_view key);

/// A user's parameter as a row of the table, without accessors. `key` and `parameter` have to
/// outlive it.
Parameter row_of(const std::string& key, const UserParameter& parameter);

/// The allowed range in words, with the unit.
std::string allowed_range(const Parameter& parameter);

/// The value of a user's effect in a scenario.
double get_parameter(const Scenario& scenario, const UserKey& key);

/// Sets a key, also of a user's effect. Throws std::invalid_argument naming key, value and what is
/// allowed for an unknown key or a value out of range.
void set_parameter(Scenario& scenario, std::string_view key, double value);
void set_parameter(Scenario& scenario, const UserKey& key, double value);

/// Takes the effects that are registered now, by name, in place of those of one's own that the
/// scenario was made with. Throws as `set_parameter` does where one is gone.
void renew_user_effects(Scenario& scenario);

/// The error of a key that there is not.
std::invalid_argument unknown_key(std::string_view key);

void set_choice(Scenario& scenario, std::string_view key, std::string_view value);

}  // namespace stickslip
