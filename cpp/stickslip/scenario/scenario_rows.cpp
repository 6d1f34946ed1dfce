#include "stickslip/scenario/scenario_rows.hpp"

#include <stdexcept>

#include "stickslip/scenario/coils.hpp"

namespace stickslip {

ScenarioRows::ScenarioRows(const Scenario& base, const std::vector<std::string>& keys,
                           const std::vector<double>& values)
    : base_(base), values_(values), size_(keys.empty() ? 1 : values.size() / keys.size()) {
    for (const std::string& key : keys) {
        Column column = {key, find_choice(key), find_law_key(key), std::nullopt,
                         is_of_one_coil(key)};
        if (column.choice == nullptr && !column.law && find_parameter(key) == nullptr) {
            column.own = find_user_key(key);
            if (!column.own) throw unknown_key(key);
        }
        columns_.push_back(std::move(column));
    }
    if (values.size() != size_ * keys.size()) {
        throw std::invalid_argument("each row needs a value for each key");
    }
}

void ScenarioRows::Column::set(Scenario& scenario, double value) const {
    if (own) {
        set_parameter(scenario, *own, value);
        return;
    }
    if (law) {
        law->key->words.empty() ? set_law(scenario, *law, value)
                                : set_law_word(scenario, *law, value);
        return;
    }
    if (choice == nullptr) {
        set_parameter(scenario, key, value);
        return;
    }
    if (!(value >= 0.0 && value < static_cast<double>(choice->allowed.size()))) {
        throw std::invalid_argument(key + ": there is no word with this index");
    }
    choice->set(scenario, static_cast<std::size_t>(value));
}

Scenario ScenarioRows::operator[](std::size_t row) const {
    Scenario scenario = base_;
    for (const bool of_one_coil : {false, true}) {
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            if (columns_[k].of_one_coil != of_one_coil) continue;
            columns_[k].set(scenario, values_[row * columns_.size() + k]);
        }
    }
    return scenario;
}

}  // namespace stickslip
