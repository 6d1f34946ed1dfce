#pragma once

#include <string_view>
#include <vector>

#include "stickslip/scenario/parameters.hpp"

/// The named extensions whose law is a free curve (free_curve.hpp), one a place where the model may
/// be wrong and an argument of which the law may depend there.
namespace stickslip {

/// The table with the rows of these extensions after its own.
std::vector<Parameter> with_free_shapes(std::vector<Parameter> rows);
std::vector<EffectDescription> with_free_shapes(std::vector<EffectDescription> rows);

/// The curve of an extension, or of a law of the scenario's own. Throws std::invalid_argument for a
/// name that is neither.
FreeShape free_shape(const Scenario& scenario, std::string_view name);

}  // namespace stickslip
