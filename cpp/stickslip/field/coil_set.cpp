#include "stickslip/field/coil_set.hpp"

#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace stickslip {
namespace {

/// A proper rotation that maps the local frame of a coil to the device's, as a signed permutation:
/// local axis k is sign[k] times device axis axis[k]. The local u axis points outwards, so that the
/// coil's plane is at u = distance. `polarity` turns the field of positive current back to the
/// positive device axis where outwards is the negative one.
struct Placement {
    std::array<Eigen::Index, 3> axis;
    std::array<double, 3> sign;
    double polarity;
};

constexpr std::array<Placement, kCoilCount> kPlacements{{
    {{0, 1, 2}, {1.0, 1.0, 1.0}, 1.0},     // xp
    {{0, 1, 2}, {-1.0, -1.0, 1.0}, -1.0},  // xm: half a turn about z
    {{1, 0, 2}, {1.0, -1.0, 1.0}, 1.0},    // yp: a quarter turn about z
    {{1, 0, 2}, {-1.0, 1.0, 1.0}, -1.0},   // ym: three quarter turns about z
    {{2, 1, 0}, {-1.0, 1.0, 1.0}, -1.0},   // clamp: a quarter turn about y
}};

void require_positive(double value, const char* what) {
    if (!(value > 0.0 && std::isfinite(value))) {
        std::ostringstream message;
        message << "coil " << what << " must be positive and finite, got " << value;
        throw std::invalid_argument(message.str());
    }
}

[[noreturn]] void throw_on_wire(Coil coil, const Eigen::Vector3d& point) {
    std::ostringstream message;
    message.precision(12);
    message << "point (" << point[0] << ", " << point[1] << ", " << point[2]
            << ") m lies on the wire of coil " << name(coil) << ", where the field is infinite";
    throw std::domain_error(message.str());
}

}  // namespace

const char* name(Coil coil) {
    constexpr std::array<const char*, kCoilCount> kNames{"xp", "xm", "yp", "ym", "clamp"};
    return kNames[static_cast<std::size_t>(coil)];
}

CoilSet::CoilSet(const CoilGeometry& geometry)
    : CoilSet(PerCoilOf<CoilGeometry>{geometry, geometry, geometry, geometry, geometry}) {}

CoilSet::CoilSet(const PerCoilOf<CoilGeometry>& geometry, std::shared_ptr<const FieldMap> map)
    : geometry_(geometry), map_(std::move(map)) {
    for (const CoilGeometry& each : geometry) {
        require_positive(each.side, "side (m)");
        require_positive(each.distance, "distance (m)");
        require_positive(each.turns, "turns");
    }
}

void CoilSet::require_known(const Eigen::Vector3d& point) const {
    if (map_ == nullptr || map_->box().holds(point)) return;
    const auto& [low, high] = map_->box();
    std::ostringstream message;
    message << "point (" << point[0] << ", " << point[1] << ", " << point[2]
            << ") m lies outside of the field map, x " << low[0] << " to " << high[0] << " m, y "
            << low[1] << " to " << high[1] << " m, z " << low[2] << " to " << high[2] << " m";
    throw std::domain_error(message.str());
}

FieldAndGradient CoilSet::unit_field(Coil coil, const Eigen::Vector3d& point) const {
    if (map_ != nullptr) return map_->unit_field(coil, point);
    const Placement& placement = kPlacements[static_cast<std::size_t>(coil)];
    const auto& [axis, sign, polarity] = placement;
    const CoilGeometry& own = geometry_[static_cast<std::size_t>(coil)];
    const double half_side = 0.5 * own.side;

    const Eigen::Vector3d local(sign[0] * point[axis[0]] - own.distance, sign[1] * point[axis[1]],
                                sign[2] * point[axis[2]]);
    if (on_square_coil(half_side, local)) throw_on_wire(coil, point);
    const FieldAndGradient in_local = square_coil_field(half_side, local);

    const double scale = polarity * (kMu0Over4Pi * own.turns);
    FieldAndGradient result;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        result.field[axis[k]] = scale * sign[k] * in_local.field[row];
        for (std::size_t l = 0; l < 3; ++l) {
            const auto column = static_cast<Eigen::Index>(l);
            result.gradient(axis[k], axis[l]) =
                scale * sign[k] * sign[l] * in_local.gradient(row, column);
        }
    }
    return result;
}

FieldAndGradient CoilSet::field(const Eigen::Vector3d& point, const Currents& currents) const {
    require_known(point);
    FieldAndGradient total{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
    for (const Coil coil : kAllCoils) {
        const double current = currents[static_cast<Eigen::Index>(coil)];
        if (current == 0.0) continue;
        const FieldAndGradient unit = unit_field(coil, point);
        total.field += current * unit.field;
        total.gradient += current * unit.gradient;
    }
    return total;
}

double CoilSet::centre_field_per_ampere(Coil coil) const {
    const Placement& placement = kPlacements[static_cast<std::size_t>(coil)];
    return unit_field(coil, Eigen::Vector3d::Zero()).field[placement.axis[0]];
}

PerCoil CoilSet::centre_fields_per_ampere() const {
    PerCoil result;
    for (const Coil coil : kAllCoils) {
        const auto k = static_cast<std::size_t>(coil);
        const bool as_before = k > 0 && map_ == nullptr && geometry_[k] == geometry_[k - 1];
        result[k] = as_before ? result[k - 1] : centre_field_per_ampere(coil);
    }
    return result;
}

}  // namespace stickslip
