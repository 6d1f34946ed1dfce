#include "stickslip/field/expansion.hpp"

#include <algorithm>
#include <limits>

namespace stickslip {
namespace {

// Reach over the distance from the centre to a wire; the expansion's error is some fourth power of
// it.
constexpr double kReachPart = 1.3e-3;

// Reach over half the diagonal of a map, which does not say where its wires are. Where they are
// eight times as far, this too is 1.3e-3 of the distance to them; where they are nearer, the error
// is larger, and still far below what the fit of such a map leaves (docs/theory/field.md).
constexpr double kReachInMap = 1e-2;

// Part of the way to a coil's plane that the robot may go.
constexpr double kWorkspace = 0.9;

// Axes of the coordinates.
template <int D>
constexpr PlaceOf<Eigen::Index, D> kAxes = {};
template <>
constexpr PlaceOf<Eigen::Index, 2> kAxes<2> = {0, 2};
template <>
constexpr PlaceOf<Eigen::Index, 3> kAxes<3> = {0, 1, 2};

template <std::size_t D>
Eigen::Vector3d point(const std::array<double, D>& place) {
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < D; ++i) result[kAxes<D>[i]] = place[i];
    return result;
}

// The least over all coils of what `of` makes of each.
double least(const CoilSet& coils, auto of) {
    double result = std::numeric_limits<double>::infinity();
    for (const CoilGeometry& each : coils.geometry()) result = std::min(result, of(each));
    return result;
}

// How far from its centre an expansion of the field of these coils holds, m.
double reach_of(const CoilSet& coils) {
    if (coils.map() != nullptr) {
        const Box& box = coils.map()->box();
        return std::min(LocalField::kReach, kReachInMap * 0.5 * (box.high - box.low).norm());
    }
    return std::min(LocalField::kReach, kReachPart * least(coils, [](const CoilGeometry& each) {
                                            return std::hypot(each.distance, 0.5 * each.side);
                                        }));
}

// Where the model of the set-up holds.
Box workspace_of(const CoilSet& coils) {
    if (coils.map() != nullptr) return coils.map()->box();
    const double far =
        kWorkspace * least(coils, [](const CoilGeometry& each) { return each.distance; });
    return {Eigen::Vector3d::Constant(-far), Eigen::Vector3d::Constant(far)};
}

// The coordinate (m) of a centre for a robot at `place`, which is a quarter of the reach from it at
// most: a finer grid would be computed more often.
double on_grid(double place, double reach) {
    const double spacing = 0.5 * reach;
    return spacing * std::round(place / spacing);
}

// The terms of one coil about a place by differences over d, in m.
Series<double, 2>::FarTerms expanded(const CoilSet& coils, Coil coil,
                                     const PlaceOf<double, 2>& place, double d) {
    struct Gradient {
        double xx, xz, zz;
    };
    const auto at = [&](double dx, double dz) -> Gradient {
        const Eigen::Matrix3d g =
            coils.unit_field(coil, Eigen::Vector3d(place[0] + dx, 0.0, place[1] + dz)).gradient;
        return {g(0, 0), g(0, 2), g(2, 2)};
    };
    const double per_d = 1.0 / (2.0 * d), per_dd = 1.0 / (d * d);
    const FieldAndGradient unit = coils.unit_field(coil, point(place));
    const double xx = unit.gradient(0, 0), xz = unit.gradient(0, 2), zz = unit.gradient(2, 2);
    const Gradient east = at(d, 0.0), west = at(-d, 0.0), up = at(0.0, d), down = at(0.0, -d);
    return {unit.field.x(),
            unit.field.z(),
            xx,
            xz,
            zz,
            (east.xx - west.xx) * per_d,
            (up.xx - down.xx) * per_d,
            (up.xz - down.xz) * per_d,
            (up.zz - down.zz) * per_d,
            (east.xx - 2.0 * xx + west.xx) * per_dd,
            (east.xz - 2.0 * xz + west.xz) * per_dd,
            (up.xx - 2.0 * xx + down.xx) * per_dd,
            (up.xz - 2.0 * xz + down.xz) * per_dd,
            (up.zz - 2.0 * zz + down.zz) * per_dd};
}

Series<double, 3>::Terms expanded(const CoilSet& coils, Coil coil, const PlaceOf<double, 3>& place,
                                  double d) {
    struct Gradient {
        double xx, xy, xz, yy, yz;
    };
    const auto gradient = [](const Eigen::Matrix3d& g) -> Gradient {
        return {g(0, 0), g(0, 1), g(0, 2), g(1, 1), g(1, 2)};
    };
    const auto at = [&](double dx, double dy, double dz) {
        const Eigen::Vector3d there(place[0] + dx, place[1] + dy, place[2] + dz);
        return gradient(coils.unit_field(coil, there).gradient);
    };
    const double per_d = 1.0 / (2.0 * d), per_dd = 1.0 / (d * d);
    const FieldAndGradient unit = coils.unit_field(coil, point(place));
    const Gradient here = gradient(unit.gradient);
    const Gradient east = at(d, 0.0, 0.0), west = at(-d, 0.0, 0.0);
    const Gradient north = at(0.0, d, 0.0), south = at(0.0, -d, 0.0);
    const Gradient up = at(0.0, 0.0, d), down = at(0.0, 0.0, -d);
    const auto slope = [&](double after, double before) { return (after - before) * per_d; };
    const auto bend = [&](double after, double middle, double before) {
        return ((after + before) - 2.0 * middle) * per_dd;
    };
    return {unit.field.x(),
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

FieldCourse::Vector field_of(const PlanarField& b) {
    return {b.bx, 0.0, b.bz};
}
FieldCourse::Vector field_of(const SpatialFieldValue& b) {
    return {b.bx, b.by, b.bz};
}
// xx xy xz yy yz zz
std::array<double, 6> gradient_of(const PlanarField& b) {
    return {b.dbx_dx, 0.0, b.dbx_dz, 0.0, 0.0, b.dbz_dz};
}
std::array<double, 6> gradient_of(const SpatialFieldValue& b) {
    return {b.xx, b.xy, b.xz, b.yy, b.yz, b.zz()};
}

}  // namespace

template <int D>
LocalFieldOf<D>::LocalFieldOf(const CoilSet& coils, const PerCoil& gain, const Centre& ambient)
    : coils_(&coils), reach_(reach_of(coils)), gain_(gain), ambient_(ambient) {
    for (auto& each : further_) {
        each.basis.fill(FurtherExponential<double, D>::kNothing);
        each.far.fill(FurtherExponential<double, D>::kNothing);
    }
    set_workspace();
}

// Coils that never have current are not there.
template <int D>
void LocalFieldOf<D>::set_workspace() {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const bool driven = std::any_of(gain_.begin(), gain_.end(), [](double g) { return g != 0.0; });
    const Box box = driven ? workspace_of(*coils_)
                           : Box{Eigen::Vector3d::Constant(-kFar), Eigen::Vector3d::Constant(kFar)};
    for (std::size_t i = 0; i < D; ++i) {
        workspace_.low[i] = box.low[kAxes<D>[i]];
        workspace_.high[i] = box.high[kAxes<D>[i]];
    }
}

template <int D>
void LocalFieldOf<D>::set_gain(const PerCoil& gain) {
    gain_ = gain;
    set_workspace();
    if (expanded_) expand(far_.centre);
}

template <int D>
void LocalFieldOf<D>::set_segment(const CurrentSegment& segment) {
    // Without the currents in the coils and what is zero: segments may be short.
    segment_.start = segment.start;
    static_cast<CurrentFunctions&>(segment_) = segment;
    std::copy_n(segment.field.begin(), segment.count(), segment_.field.begin());
    min_time_constant_ = 0.5 / segment.fastest();
    course_.rate = segment.rate[0];
    for (std::size_t j = 1; j < static_cast<std::size_t>(segment.exponentials); ++j) {
        further_[j - 1].rate = segment.rate[j];
    }
    if (expanded_) combine();
}

template <int D>
void LocalFieldOf<D>::begin_segment(const CurrentSegment& segment, const Centre& place) {
    if (workspace_.holds(place)) {
        Centre centre;
        for (std::size_t i = 0; i < D; ++i) centre[i] = on_grid(place[i], reach_);
        if (!expanded_ || centre != far_.centre) expand(centre);
        course_.centre = place;
    }
    set_segment(segment);
    rebase(place);
}

template <int D>
bool LocalFieldOf<D>::recentre(const Centre& place) {
    outside_ = !workspace_.holds(place);
    if (outside_ || (expanded_ && !is_far(place, far_.centre, 0.5 * reach_))) return false;
    expand(place);
    course_.centre = place;
    combine();
    return true;
}

template <int D>
void LocalFieldOf<D>::rebase(const Centre& place) {
    if (recentre(place) || outside_) return;
    if (D == 2 && is_far(place, course_.centre, kNear * reach_)) approach(place);
}

template <int D>
void LocalFieldOf<D>::approach(const Centre& place) {
    if constexpr (D == 2) {
        far_.move(place, course_);
        for (std::size_t b = 3; b < segment_.count(); ++b) {
            auto& each = further_[b - 3];
            each.basis = Series<double, D>::moved(each.far, far_.distance_to(place));
        }
    } else {
        course_.basis = far_.basis;
        course_.centre = far_.centre;
        for (std::size_t b = 3; b < segment_.count(); ++b) {
            further_[b - 3].basis = further_[b - 3].far;
        }
    }
}

template <int D>
FieldCourse LocalFieldOf<D>::course(const Centre& place) const {
    FieldCourse result;
    for (std::size_t b = 0; b < segment_.count(); ++b) {
        const auto part = value(basis(b), place);
        result.basis[b] = field_of(part);
        result.gradient[b] = gradient_of(part);
    }
    return result;
}

template <int D>
PerCoilOf<CoilField> LocalFieldOf<D>::of_coils(const Centre& place, double heading) const {
    const double c = std::cos(heading), s = std::sin(heading);
    PerCoilOf<CoilField> result;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const auto unit = value(unit_[k], place);
        const auto [xx, xy, xz, yy, yz, zz] = gradient_of(unit);
        result[k].field = field_of(unit);
        for (double& component : result[k].field) component *= gain_[k];
        result[k].slope = {gain_[k] * (c * xx + s * xy), gain_[k] * (c * xy + s * yy)};
    }
    return result;
}

template <int D>
void LocalFieldOf<D>::multiply(double tau, Expansion& expansion) const {
    const double scale = factor(tau);
    for (double& term : expansion.terms) term *= scale;
    for (std::size_t i = 0; i < D; ++i) expansion.terms[i] += (1.0 - scale) * ambient_[i];
}

template <int D>
void LocalFieldOf<D>::expand(const Centre& place) {
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        if (gain_[k] == 0.0) continue;
        unit_[k] = expanded(*coils_, static_cast<Coil>(k), place, reach_ / 1.5);
    }
    far_.centre = place;
    expanded_ = true;
}

template <int D>
void LocalFieldOf<D>::combine() {
    for (std::size_t b = 0; b < segment_.count(); ++b) {
        FarTerms& sum = basis(b);
        sum = {};
        PerCoil c;
        for (std::size_t k = 0; k < kCoilCount; ++k) c[k] = gain_[k] * segment_.field[b][k];
        // In space the coils of x and of y in pairs, whose sum does not see which is which.
        constexpr std::size_t kTogether = D == 3 ? 2 : 1;
        for (std::size_t first = 0; first < kCoilCount; first += kTogether) {
            const std::size_t end = std::min<std::size_t>(first + kTogether, kCoilCount);
            if (std::all_of(&c[first], &c[0] + end, [](double each) { return each == 0.0; })) {
                continue;
            }
            for (std::size_t i = 0; i < sum.size(); ++i) {
                double part = c[first] * unit_[first][i];
                for (std::size_t k = first + 1; k < end; ++k) part += c[k] * unit_[k][i];
                sum[i] += part;
            }
        }
    }
    for (std::size_t i = 0; i < D; ++i) far_.basis[0][i] += ambient_[i];
    approach(course_.centre);
}

template <int D>
ExpansionOf<double, D> LocalFieldOf<D>::sum_with_swings(double tau) const {
    const CurrentFunctions::Values value = segment_.values(tau);
    Expansion result;
    result.centre = course_.centre;
    result.tau = tau;
    stickslip::combine(course_.basis[0], course_.basis[1], tau, course_.basis[2], value[2],
                       result.terms);
    for (std::size_t b = 3; b < segment_.count(); ++b) {
        for (std::size_t i = 0; i < result.terms.size(); ++i) {
            result.terms[i] += further_[b - 3].basis[i] * value[b];
        }
    }
    return result;
}

template <>
SpatialExpansion LocalFieldOf<3>::at(double tau) const {
    return sum_at(tau);
}

template class LocalFieldOf<2>;
template class LocalFieldOf<3>;

}  // namespace stickslip
