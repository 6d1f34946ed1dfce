#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stickslip/scenario/parameters.hpp"

namespace stickslip {

/// A scenario with other values of some keys, a row of `values` for each point; without keys it is
/// one point, the scenario itself. A key that takes words has the index of the word; keys of single
/// coils come after those of all coils. Scenario and values have to outlive it.
class ScenarioRows {
public:
    /// Throws std::invalid_argument for an unknown key or a size that does not fit.
    ScenarioRows(const Scenario& base, const std::vector<std::string>& keys,
                 const std::vector<double>& values);

    std::size_t size() const { return size_; }

    /// The scenario of a row. Throws std::invalid_argument where a value is out of its range.
    Scenario operator[](std::size_t row) const;

private:
    // Found once for all rows: they must not meet different effects of one name.
    struct Column {
        std::string key;
        const Choice* choice = nullptr;
        std::optional<LawPlace> law;
        std::optional<UserKey> own;
        bool of_one_coil = false;

        void set(Scenario& scenario, double value) const;
    };

    const Scenario& base_;
    const std::vector<double>& values_;
    std::vector<Column> columns_;
    std::size_t size_;
};

}  // namespace stickslip
