#pragma once

#include <string>
#include <vector>

#include "stickslip/field/coil_set.hpp"
#include "stickslip/scenario/scenario.hpp"

/// A probe that reads the field at given places while known currents flow in the coils.
namespace stickslip {

/// Field of each coil by itself (T) at each place: a row of 5 x 3 numbers a place, Eqs. (2)-(7).
/// NaN for a coil with current whose wire the place lies on, or of whose map it lies outside.
/// `places`: x, y, z (m) of each; `currents`: those of the coils (A). Throws std::invalid_argument
/// for sizes that do not fit.
std::vector<double> coil_shares(const CoilSet& coils, const std::vector<double>& places,
                                const std::vector<double>& currents);

/// Bx, By, Bz (T) at each place, for each row of `values` (see ScenarioRows): with the effects that
/// act between a coil's current and the field. What acts between voltage and current, or on the
/// robot, has no part in it. NaN in a row whose values make no scenario.
std::vector<double> probe_readings(const Scenario& base, const std::vector<std::string>& keys,
                                   const std::vector<double>& values,
                                   const std::vector<double>& places,
                                   const std::vector<double>& currents);

}  // namespace stickslip
