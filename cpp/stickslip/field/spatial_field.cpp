#include "stickslip/field/spatial_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/numbers/elementary.hpp"

namespace stickslip {
namespace {

struct Gradient {
    double xx, xy, xz, yy, yz;
};

Gradient gradient_at(const CoilSet& coils, Coil coil, const Place& p) {
    const Eigen::Matrix3d g = coils.unit_field(coil, Eigen::Vector3d(p.x, p.y, p.z)).gradient;
    return {g(0, 0), g(0, 1), g(0, 2), g(1, 1), g(1, 2)};
}

}  // namespace

SpatialField::SpatialField(const CoilSet& coils, const PerCoil& gain,
                           const std::array<double, 3>& ambient)
    : coils_(&coils), reach_(reach_of(coils)), gain_(gain), ambient_(ambient) {
    set_workspace();
}

void SpatialField::set_workspace() {
    const bool driven = std::any_of(gain_.begin(), gain_.end(), [](double g) { return g != 0.0; });
    constexpr double kFar = std::numeric_limits<double>::infinity();
    workspace_ = driven ? workspace_of(*coils_)
                        : Box{Eigen::Vector3d::Constant(-kFar), Eigen::Vector3d::Constant(kFar)};
}

void SpatialField::set_gain(const PerCoil& gain) {
    gain_ = gain;
    set_workspace();
    if (expanded_) expand(centre_);
}

void SpatialField::set_segment(const CurrentSegment& segment) {
    segment_ = segment;
    min_time_constant_ =
        0.5 / *std::max_element(segment.rate.begin(), segment.rate.begin() + segment.exponentials);
    if (expanded_) combine();
}

void SpatialField::begin_stretch(const CurrentSegment& segment, const Place& place) {
    if (workspace_.holds(Eigen::Vector3d(place.x, place.y, place.z))) {
        const Place centre = {on_grid(place.x, reach_), on_grid(place.y, reach_),
                              on_grid(place.z, reach_)};
        if (!expanded_ || centre.x != centre_.x || centre.y != centre_.y || centre.z != centre_.z) {
            expand(centre);
        }
    }
    set_segment(segment);
    rebase(place);
}

void SpatialField::rebase(const Place& place) {
    outside_ = !workspace_.holds(Eigen::Vector3d(place.x, place.y, place.z));
    if (outside_) return;
    const double half = 0.5 * reach_;
    if (!expanded_ || std::abs(place.x - centre_.x) > half ||
        std::abs(place.y - centre_.y) > half || std::abs(place.z - centre_.z) > half) {
        expand(place);
        combine();
    }
}

SpatialExpansion SpatialField::at(double tau) const {
    SpatialExpansion result;
    result.centre = centre_;
    result.tau = tau;
    using Pair = Pack<2>;
    const Pair time(tau), fading(exponential(-segment_.rate[0] * tau));
    for (std::size_t i = 0; i < result.terms.size(); i += 2) {
        store(pair(&basis_[0][i]) + pair(&basis_[1][i]) * time + pair(&basis_[2][i]) * fading,
              &result.terms[i]);
    }
    for (std::size_t j = 1; j < static_cast<std::size_t>(segment_.exponentials); ++j) {
        const Pair further(exponential(-segment_.rate[j] * tau));
        for (std::size_t i = 0; i < result.terms.size(); i += 2) {
            store(pair(&result.terms[i]) + pair(&basis_[2 + j][i]) * further, &result.terms[i]);
        }
    }
    if (shape_) {
        const double factor = shape_->factor(segment_.start + tau, segment_.field_currents(tau));
        for (double& term : result.terms) term *= factor;
    }
    for (std::size_t i = 0; i < 3; ++i) result.terms[i] += ambient_[i];
    result.horizontal =
        std::sqrt(result.terms[0] * result.terms[0] + result.terms[1] * result.terms[1]);
    return result;
}

HorizontalField SpatialField::horizontal(const Place& place) const {
    HorizontalField result;
    result.shape = shape_;
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + segment_.exponentials); ++b) {
        const SpatialFieldValue part =
            SpatialExpansion{basis_[b], centre_, 0.0, 0.0}(place.x, place.y, place.z);
        result.basis[b] = {part.bx, part.by};
    }
    result.ambient = {ambient_[0], ambient_[1]};
    return result;
}

FieldCourse SpatialField::course(const Place& place) const {
    FieldCourse result;
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + segment_.exponentials); ++b) {
        const SpatialFieldValue part =
            SpatialExpansion{basis_[b], centre_, 0.0, 0.0}(place.x, place.y, place.z);
        result.basis[b] = {part.bx, part.by, part.bz};
        result.gradient[b] = {part.xx, part.xy, part.xz, part.yy, part.yz, part.zz()};
    }
    for (std::size_t i = 0; i < 3; ++i) result.basis[0][i] += ambient_[i];
    return result;
}

PerCoilOf<CoilField> SpatialField::of_coils(const Place& place, double heading) const {
    const double c = std::cos(heading), s = std::sin(heading);
    PerCoilOf<CoilField> result;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const SpatialFieldValue unit =
            SpatialExpansion{unit_[k], centre_, 0.0, 0.0}(place.x, place.y, place.z);
        const double gain = gain_[k];
        result[k].field = {gain * unit.bx, gain * unit.by, gain * unit.bz};
        result[k].slope = {gain * (c * unit.xx + s * unit.xy), gain * (c * unit.xy + s * unit.yy)};
    }
    return result;
}

void SpatialField::expand(const Place& place) {
    const double d = reach_ / 1.5;
    const double per_d = 1.0 / (2.0 * d), per_dd = 1.0 / (d * d);
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        if (gain_[k] == 0.0) continue;
        const auto coil = static_cast<Coil>(k);
        const FieldAndGradient unit =
            coils_->unit_field(coil, Eigen::Vector3d(place.x, place.y, place.z));
        const auto at = [&](double dx, double dy, double dz) {
            return gradient_at(*coils_, coil, {place.x + dx, place.y + dy, place.z + dz});
        };
        const Gradient east = at(d, 0.0, 0.0), west = at(-d, 0.0, 0.0);
        const Gradient north = at(0.0, d, 0.0), south = at(0.0, -d, 0.0);
        const Gradient up = at(0.0, 0.0, d), down = at(0.0, 0.0, -d);
        const Gradient here = {unit.gradient(0, 0), unit.gradient(0, 1), unit.gradient(0, 2),
                               unit.gradient(1, 1), unit.gradient(1, 2)};
        const auto slope = [&](double after, double before) { return (after - before) * per_d; };
        const auto bend = [&](double after, double middle, double before) {
            return ((after + before) - 2.0 * middle) * per_dd;
        };
        unit_[k] = {unit.field.x(),
                    unit.field.y(),
                    unit.field.z(),
                    here.xx,
                    here.xy,
                    here.yy,
                    here.xz,
                    here.yz,
                    slope(east.xx, west.xx),
                    slope(east.xy, west.xy),
                    slope(north.xy, south.xy),
                    slope(north.yy, south.yy),
                    slope(up.xx, down.xx),
                    slope(up.xy, down.xy),
                    slope(up.yy, down.yy),
                    bend(east.xx, here.xx, west.xx),
                    bend(east.xy, here.xy, west.xy),
                    0.5 * (bend(east.yy, here.yy, west.yy) + bend(north.xx, here.xx, south.xx)),
                    bend(north.xy, here.xy, south.xy),
                    bend(north.yy, here.yy, south.yy),
                    bend(east.xz, here.xz, west.xz),
                    bend(east.yz, here.yz, west.yz),
                    bend(north.xz, here.xz, south.xz),
                    bend(north.yz, here.yz, south.yz)};
    }
    centre_ = place;
    expanded_ = true;
}

void SpatialField::combine() {
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + segment_.exponentials); ++b) {
        // The coils of x and y in pairs, whose sum does not see which is which.
        std::array<double, kCoilCount> c;
        for (std::size_t k = 0; k < kCoilCount; ++k) c[k] = gain_[k] * segment_.field[b][k];
        for (std::size_t i = 0; i < SpatialExpansion::kTerms; ++i) {
            const auto part = [&](std::size_t k) { return c[k] == 0.0 ? 0.0 : c[k] * unit_[k][i]; };
            basis_[b][i] = ((part(0) + part(1)) + (part(2) + part(3))) + part(4);
        }
    }
}

}  // namespace stickslip
