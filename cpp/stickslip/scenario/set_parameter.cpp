#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace stickslip {
namespace {

std::string out_of_range(const Parameter& parameter, double value) {
    std::ostringstream text;
    text << parameter.key << " = " << digits(value) << ": allowed is " << allowed_range(parameter);
    return text.str();
}

void require_in_range(const Parameter& parameter, double value) {
    const bool above = parameter.low_allowed ? value >= parameter.low : value > parameter.low;
    const bool fits = std::isfinite(value) && above && value <= parameter.high &&
                      (!parameter.integer || value == std::floor(value));
    if (!fits) throw std::invalid_argument(out_of_range(parameter, value));
}

std::string_view without_blanks(std::string_view text) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    return text;
}

// Index of one word of a choice; `value`: the whole text that was given, for the message.
std::size_t place_of_word(const Choice& choice, std::string_view word, std::string_view value) {
    std::string allowed;
    for (std::size_t i = 0; i < choice.allowed.size(); ++i) {
        if (choice.allowed[i] == word) return i;
        allowed += (i ? ", \"" : "\"") + choice.allowed[i] + "\"";
    }
    throw std::invalid_argument(std::string(choice.key) + " = \"" + std::string(value) +
                                "\": allowed is one of " + allowed);
}

}  // namespace

const Parameter* find_parameter(std::string_view key) {
    static const auto index = [] {
        std::unordered_map<std::string_view, const Parameter*> map;
        for (const Parameter& parameter : parameters()) map.emplace(parameter.key, &parameter);
        return map;
    }();
    const auto found = index.find(key);
    return found == index.end() ? nullptr : found->second;
}

const Choice* find_choice(std::string_view key) {
    for (const Choice& choice : choices()) {
        if (key == choice.key) return &choice;
    }
    return nullptr;
}

Parameter row_of(const std::string& key, const UserParameter& parameter) {
    return {.key = key.c_str(),
            .unit = parameter.unit.c_str(),
            .low = parameter.low,
            .high = parameter.high,
            .meaning = parameter.meaning.c_str()};
}

std::string allowed_range(const Parameter& parameter) {
    std::ostringstream text;
    const bool has_unit = std::string_view(parameter.unit) != "-";
    text << (parameter.integer ? "a whole number" : "a number");
    text << (parameter.low_allowed ? " from " : " above ") << lowest(parameter.low);
    const bool bounded = std::isfinite(parameter.high);
    if (bounded) text << (parameter.low_allowed ? " to " : " up to ") << highest(parameter.high);
    if (has_unit) text << " " << parameter.unit;
    if (!bounded) text << " upwards";
    return text.str();
}

void set_parameter(Scenario& scenario, std::string_view key, double value) {
    if (const Parameter* parameter = find_parameter(key)) {
        require_in_range(*parameter, value);
        parameter->set(scenario, value);
        return;
    }
    const std::optional<UserKey> own = find_user_key(key);
    if (!own) throw unknown_key(key);
    set_parameter(scenario, *own, value);
}

void set_parameter(Scenario& scenario, const UserKey& key, double value) {
    const std::string name = key.effect->key(key.parameter);
    require_in_range(row_of(name, key.effect->parameters[key.parameter]), value);
    // In the order of the names: the sum of two forces must not depend on which was set first.
    std::vector<UserSetting>& all = scenario.user_effects;
    auto place = std::find_if(all.begin(), all.end(), [&](const UserSetting& each) {
        return each.effect->name >= key.effect->name;
    });
    if (place == all.end() || place->effect->name != key.effect->name) {
        place = all.insert(place, UserSetting{});
    }
    if (place->effect != key.effect) {
        place->effect = key.effect;
        place->values.clear();
        for (const UserParameter& each : key.effect->parameters) {
            place->values.push_back(each.absent);
        }
    }
    place->values[key.parameter] = value;
}

double get_parameter(const Scenario& scenario, const UserKey& key) {
    const UserParameter& wanted = key.effect->parameters[key.parameter];
    for (const UserSetting& each : scenario.user_effects) {
        if (each.effect->name != key.effect->name) continue;
        for (std::size_t i = 0; i < each.values.size(); ++i) {
            if (each.effect->parameters[i].name == wanted.name) return each.values[i];
        }
    }
    return wanted.absent;
}

void renew_user_effects(Scenario& scenario) {
    for (const UserSetting& before : std::exchange(scenario.user_effects, {})) {
        for (std::size_t i = 0; i < before.values.size(); ++i) {
            if (before.values[i] == before.effect->parameters[i].absent) continue;
            set_parameter(scenario, before.effect->key(i), before.values[i]);
        }
    }
}

std::invalid_argument unknown_key(std::string_view key) {
    const bool of_effect = key.starts_with("effects.");
    return std::invalid_argument(
        std::string(key) + ": there is no such key" +
        (of_effect ? "; an effect of your own has to be registered in this process too" : ""));
}

void set_choice(Scenario& scenario, std::string_view key, std::string_view value) {
    const Choice* choice = find_choice(key);
    if (choice == nullptr) throw unknown_key(key);
    if (choice->set_some == nullptr) {
        choice->set(scenario, place_of_word(*choice, value, value));
        return;
    }
    std::vector<std::size_t> places;
    for (std::string_view rest = value; !rest.empty();) {
        const std::string_view word = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(word.size() + 1, rest.size()));
        places.push_back(place_of_word(*choice, without_blanks(word), value));
    }
    if (places.empty()) place_of_word(*choice, "", value);
    choice->set_some(scenario, places);
}

}  // namespace stickslip
