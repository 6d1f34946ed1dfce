#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

/// A scenario with other values of some numeric keys, a row of `values` for each point; without
/// keys it is one point, the scenario itself. All that is given has to outlive it.
class ScenarioRows {
public:
    /// Throws std::invalid_argument for an unknown key or a size that does not fit.
    ScenarioRows(const Scenario& base, const std::vector<std::string>& keys,
                 const std::vector<double>& values);

    std::size_t size() const { return size_; }

    /// The scenario of a row; nothing where a value is out of its range.
    std::optional<Scenario> operator[](std::size_t row) const;

private:
    const Scenario& base_;
    const std::vector<std::string>& keys_;
    const std::vector<double>& values_;
    std::size_t size_;
};

}  // namespace stickslip
