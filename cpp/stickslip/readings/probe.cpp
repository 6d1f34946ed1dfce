#include "stickslip/readings/probe.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/own_coils.hpp"
#include "stickslip/scenario/scenario_rows.hpp"

namespace stickslip {
namespace {

constexpr std::size_t kAxes = 3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::vector<double> coil_shares(const CoilSet& coils, const std::vector<double>& places,
                                const std::vector<double>& currents) {
    const std::size_t count = places.size() / kAxes;
    if (places.size() != count * kAxes || currents.size() != count * kCoilCount) {
        throw std::invalid_argument("each place needs x, y, z and the currents of five coils");
    }
    std::vector<double> shares(count * kCoilCount * kAxes, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Map<const Eigen::Vector3d> place(&places[i * kAxes]);
        for (const Coil coil : kAllCoils) {
            const std::size_t k = i * kCoilCount + static_cast<std::size_t>(coil);
            if (currents[k] == 0.0) continue;
            Eigen::Map<Eigen::Vector3d> share(&shares[k * kAxes]);
            try {
                coils.require_known(place);
                share = currents[k] * coils.unit_field(coil, place).field;
            } catch (const std::domain_error&) {
                share.setConstant(kNaN);
            }
        }
    }
    return shares;
}

std::vector<double> probe_readings(const Scenario& base, const std::vector<std::string>& keys,
                                   const std::vector<double>& values,
                                   const std::vector<double>& places,
                                   const std::vector<double>& currents) {
    const ScenarioRows rows(base, keys, values);
    std::vector<double> readings(rows.size() * places.size(), kNaN);
    // Most rows have the coils of the row before, and these are most of the work.
    PerCoilOf<CoilGeometry> geometry;
    std::vector<double> shares;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const std::optional<Scenario> scenario = rows[row];
        if (!scenario) continue;
        const CoilSet coils = world_coil_set(*scenario);
        if (shares.empty() || !(coils.geometry() == geometry)) {
            geometry = coils.geometry();
            shares = coil_shares(coils, places, currents);
        }
        const Effects& effects = scenario->effects;
        const double ambient[kAxes] = {effects.ambient_field_bx, effects.ambient_field_by,
                                       effects.ambient_field_bz};
        for (std::size_t place = 0; place < places.size() / kAxes; ++place) {
            PerCoil held;
            std::copy_n(&currents[place * kCoilCount], kCoilCount, held.begin());
            const PerCoil gain = held_field_gain(*scenario, held);
            for (std::size_t axis = 0; axis < kAxes; ++axis) {
                double field = 0.0;
                for (std::size_t k = 0; k < kCoilCount; ++k) {
                    field += gain[k] * shares[(place * kCoilCount + k) * kAxes + axis];
                }
                readings[row * places.size() + place * kAxes + axis] = field + ambient[axis];
            }
        }
    }
    return readings;
}

}  // namespace stickslip
