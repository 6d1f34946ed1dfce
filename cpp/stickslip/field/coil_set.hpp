#pragma once

#include <Eigen/Core>
#include <memory>

#include "stickslip/drive/coil.hpp"
#include "stickslip/field/field_map.hpp"
#include "stickslip/field/square_coil.hpp"

namespace stickslip {

/// mu_0 / (4 pi) = 1e-7 T m/A, the value of the paper (and of the SI before 2019; the measured
/// value differs by 1.3e-10).
inline constexpr double kMu0Over4Pi = 1e-7;

/// A square coil that faces the origin. Defaults: Table I of Pawashe et al., RSS 2008.
struct CoilGeometry {
    double side = 0.1385;     ///< effective side length, m
    double distance = 0.099;  ///< from the origin to the coil's plane, m
    double turns = 510.0;     ///< N_t

    friend bool operator==(const CoilGeometry&, const CoilGeometry&) = default;
};

/// Currents of the five coils, A, in the order of `Coil`.
using Currents = Eigen::Matrix<double, kCoilCount, 1>;

/// The field of the coils in the frame of the device: right-handed, z up, origin at the centre.
/// Positive current in ANY coil gives a field along the positive axis (+x, +y or +z) at the origin.
/// Equal coils are one coil rotated, so a rotated or mirrored situation has the same bits.
///
/// With a map the field is that of the map, and the geometry has no part in it.
class CoilSet {
public:
    /// Five equal coils. Throws std::invalid_argument if a dimension is not positive and finite.
    explicit CoilSet(const CoilGeometry& geometry = {});
    explicit CoilSet(const PerCoilOf<CoilGeometry>& geometry,
                     std::shared_ptr<const FieldMap> map = nullptr);

    const PerCoilOf<CoilGeometry>& geometry() const { return geometry_; }
    /// nullptr if the field is that of Eqs. (2)-(7).
    const FieldMap* map() const { return map_.get(); }

    /// Throws std::domain_error for a point (m) that lies outside of the map, if there is one.
    void require_known(const Eigen::Vector3d& point) const;

    /// Field (T/A) and gradient (T/m/A) of one coil at `point` (m) for unit current, equations
    /// (3)-(7) or the map, which goes on beyond its box: see `require_known`. Throws
    /// std::domain_error if the point is within `kWireRadius` of the wire.
    FieldAndGradient unit_field(Coil coil, const Eigen::Vector3d& point) const;

    /// Field (T) and gradient (T/m) of all coils at `point` (m). A coil without current takes no
    /// part. Throws std::domain_error if the point is on the wire of a coil that has current, or
    /// not known.
    FieldAndGradient field(const Eigen::Vector3d& point, const Currents& currents) const;

    /// Field at the origin, along the coil's positive axis, per ampere in one coil, T/A.
    double centre_field_per_ampere(Coil coil = Coil::xp) const;
    /// The same for all coils; equal ones are computed once.
    PerCoil centre_fields_per_ampere() const;

private:
    PerCoilOf<CoilGeometry> geometry_;
    std::shared_ptr<const FieldMap> map_;
};

}  // namespace stickslip
