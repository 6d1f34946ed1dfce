#pragma once

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

/// A key that takes one of a few words.
struct Choice {
    const char* key;
    std::vector<std::string> allowed;
    const char* meaning;
    std::string (*get)(const Scenario&);
    void (*set)(Scenario&, std::size_t index);
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

/// nullptr if there is no numeric key, or no key that takes words, of that name.
const Parameter* find_parameter(std::string_view key);
const Choice* find_choice(std::string_view key);

/// A user's parameter as a row of the table, without accessors. `key` and `parameter` have to
/// outlive it.
Parameter row_of(const std::string& key, const UserParameter& parameter);

/// The allowed range in words, with the unit.
std::string allowed_range(const Parameter& parameter);

/// Sets a key, also of a user's effect. Throws std::invalid_argument naming key, value and what is
/// allowed for an unknown key or a value out of range.
void set_parameter(Scenario& scenario, std::string_view key, double value);
void set_parameter(Scenario& scenario, const UserKey& key, double value);
void set_choice(Scenario& scenario, std::string_view key, std::string_view value);

}  // namespace stickslip
