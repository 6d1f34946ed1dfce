#include "stickslip/readings/probe.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/scenario_rows.hpp"

namespace stickslip {
namespace {

constexpr std::size_t kAxes = 3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::size_t count_places(const std::vector<double>& places, const std::vector<double>& currents) {
    const std::size_t count = places.size() / kAxes;
    if (places.size() != count * kAxes || currents.size() != count * kCoilCount) {
        throw std::invalid_argument("each place needs x, y, z and the currents of five coils");
    }
    return count;
}

// Readings of one scenario, into `out`.
void read(const Scenario& scenario, const std::vector<double>& places,
          const std::vector<double>& currents, double* out) {
    const CoilSet coils = world_coil_set(scenario);
    const Effects& effects = scenario.effects;
    const Eigen::Vector3d ambient(effects.ambient_field_bx, effects.ambient_field_by,
                                  effects.ambient_field_bz);
    for (std::size_t i = 0; i < count_places(places, currents); ++i) {
        PerCoil held;
        std::copy_n(&currents[i * kCoilCount], kCoilCount, held.begin());
        const PerCoil gain = held_field_gain(scenario, held);
        Currents driven;
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            driven[static_cast<Eigen::Index>(k)] = gain[k] * held[k];
        }
        try {
            const Eigen::Map<const Eigen::Vector3d> place(&places[i * kAxes]);
            Eigen::Map<Eigen::Vector3d>(out + i * kAxes) =
                coils.field(place, driven).field + ambient;
        } catch (const std::domain_error&) {
            continue;  // on a wire, or outside of a map
        }
    }
}

}  // namespace

std::vector<double> coil_shares(const CoilSet& coils, const std::vector<double>& places,
                                const std::vector<double>& currents) {
    const std::size_t count = count_places(places, currents);
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
    for (std::size_t row = 0; row < rows.size(); ++row) {
        try {
            read(rows[row], places, currents, &readings[row * places.size()]);
        } catch (const std::invalid_argument&) {
            continue;
        }
    }
    return readings;
}

}  // namespace stickslip
