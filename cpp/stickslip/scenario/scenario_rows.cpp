#include "stickslip/scenario/scenario_rows.hpp"

#include <stdexcept>

#include "stickslip/scenario/parameters.hpp"

namespace stickslip {

ScenarioRows::ScenarioRows(const Scenario& base, const std::vector<std::string>& keys,
                           const std::vector<double>& values)
    : base_(base),
      keys_(keys),
      values_(values),
      size_(keys.empty() ? 1 : values.size() / keys.size()) {
    for (const std::string& key : keys) {
        if (find_parameter(key) == nullptr && !find_user_key(key)) {
            throw std::invalid_argument(key + ": there is no such numeric key");
        }
    }
    if (values.size() != size_ * keys.size()) {
        throw std::invalid_argument("each row needs a value for each key");
    }
}

std::optional<Scenario> ScenarioRows::operator[](std::size_t row) const {
    Scenario scenario = base_;
    try {
        for (std::size_t k = 0; k < keys_.size(); ++k) {
            set_parameter(scenario, keys_[k], values_[row * keys_.size() + k]);
        }
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
    return scenario;
}

}  // namespace stickslip
