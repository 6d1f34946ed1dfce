#include "stickslip/field/local_field.hpp"

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

struct PlanarGradient {
    double xx, xz, zz;
};

PlanarGradient gradient_at(const CoilSet& coils, Coil coil, double x, double z) {
    const FieldAndGradient unit = coils.unit_field(coil, Eigen::Vector3d(x, 0.0, z));
    return {unit.gradient(0, 0), unit.gradient(0, 2), unit.gradient(2, 2)};
}

// The least over all coils of what `of` makes of each.
double least(const CoilSet& coils, auto of) {
    double result = std::numeric_limits<double>::infinity();
    for (const CoilGeometry& each : coils.geometry()) result = std::min(result, of(each));
    return result;
}

}  // namespace

double reach_of(const CoilSet& coils) {
    if (coils.map() != nullptr) {
        const Box& box = coils.map()->box();
        return std::min(LocalField::kReach, kReachInMap * 0.5 * (box.high - box.low).norm());
    }
    return std::min(LocalField::kReach, kReachPart * least(coils, [](const CoilGeometry& each) {
                                            return std::hypot(each.distance, 0.5 * each.side);
                                        }));
}

Box workspace_of(const CoilSet& coils) {
    if (coils.map() != nullptr) return coils.map()->box();
    const double far =
        kWorkspace * least(coils, [](const CoilGeometry& each) { return each.distance; });
    return {Eigen::Vector3d::Constant(-far), Eigen::Vector3d::Constant(far)};
}

LocalField::LocalField(const CoilSet& coils, const PerCoil& gain, double ambient_x,
                       double ambient_z)
    : coils_(&coils),
      reach_(reach_of(coils)),
      gain_(gain),
      ambient_x_(ambient_x),
      ambient_z_(ambient_z) {
    for (auto& each : further_) each.basis.fill(FurtherExponential<double>::kNothing);
    set_workspace();
}

// Coils that never have current are not there.
void LocalField::set_workspace() {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const bool driven = std::any_of(gain_.begin(), gain_.end(), [](double g) { return g != 0.0; });
    const Box box = driven ? workspace_of(*coils_)
                           : Box{Eigen::Vector3d::Constant(-kFar), Eigen::Vector3d::Constant(kFar)};
    workspace_ = {box.low.x(), box.high.x(), box.low.z(), box.high.z()};
}

void LocalField::set_gain(const PerCoil& gain) {
    gain_ = gain;
    set_workspace();
    if (expanded_) expand(stretch_.centre_x, stretch_.centre_z);
}

void LocalField::set_segment(const CurrentSegment& segment) {
    // Without the currents in the coils and what is zero: stretches may be short.
    segment_.start = segment.start;
    segment_.exponentials = segment.exponentials;
    segment_.rate = segment.rate;
    std::copy_n(segment.field.begin(), 2 + segment.exponentials, segment_.field.begin());
    min_time_constant_ =
        0.5 / *std::max_element(segment.rate.begin(), segment.rate.begin() + segment.exponentials);
    stretch_.rate = segment.rate[0];
    for (std::size_t j = 1; j < static_cast<std::size_t>(segment.exponentials); ++j) {
        further_[j - 1].rate = segment.rate[j];
    }
    if (expanded_) combine();
}

void LocalField::begin_stretch(const CurrentSegment& segment, double x, double z) {
    if (workspace_.holds(x, z)) {
        const double centre_x = on_grid(x, reach_), centre_z = on_grid(z, reach_);
        if (!expanded_ || centre_x != stretch_.centre_x || centre_z != stretch_.centre_z) {
            expand(centre_x, centre_z);
        }
    }
    set_segment(segment);
    rebase(x, z);
}

void LocalField::rebase(double x, double z) {
    outside_ = !workspace_.holds(x, z);
    if (outside_) return;
    const double half = 0.5 * reach_;
    if (!expanded_ || std::abs(x - stretch_.centre_x) > half ||
        std::abs(z - stretch_.centre_z) > half) {
        expand(x, z);
        combine();
    }
}

HorizontalField LocalField::horizontal(double x, double z) const {
    HorizontalField result;
    result.shape = shape_;
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + segment_.exponentials); ++b) {
        const Terms& terms = b < 3 ? stretch_.basis[b] : further_[b - 3].basis;
        const Expansion part = {terms, stretch_.centre_x, stretch_.centre_z, 0.0};
        result.basis[b] = {part(x, z).bx, 0.0};
    }
    result.basis[0][0] -= ambient_x_;
    result.ambient = {ambient_x_, 0.0};
    return result;
}

FieldCourse LocalField::course(double x, double z) const {
    FieldCourse result;
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + segment_.exponentials); ++b) {
        const Terms& terms = b < 3 ? stretch_.basis[b] : further_[b - 3].basis;
        const PlanarField part = Expansion{terms, stretch_.centre_x, stretch_.centre_z, 0.0}(x, z);
        result.basis[b] = {part.bx, 0.0, part.bz};
        result.gradient[b] = {part.dbx_dx, 0.0, part.dbx_dz, 0.0, 0.0, part.dbz_dz};
    }
    return result;
}

PerCoilOf<CoilField> LocalField::of_coils(double x, double z) const {
    PerCoilOf<CoilField> result;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const PlanarField unit =
            Expansion{unit_[k], stretch_.centre_x, stretch_.centre_z, 0.0}(x, z);
        result[k].field = {gain_[k] * unit.bx, 0.0, gain_[k] * unit.bz};
        result[k].slope = {gain_[k] * unit.dbx_dx, 0.0};
    }
    return result;
}

void LocalField::multiply(double tau, Expansion& expansion) const {
    const double scale = factor(tau);
    for (double& term : expansion.terms) term *= scale;
    expansion.terms[0] += (1.0 - scale) * ambient_x_;
    expansion.terms[1] += (1.0 - scale) * ambient_z_;
}

void LocalField::expand(double x, double z) {
    const double d = reach_ / 1.5;
    const double per_d = 1.0 / (2.0 * d);
    const double per_dd = 1.0 / (d * d);
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        if (gain_[k] == 0.0) continue;
        const auto coil = static_cast<Coil>(k);
        const FieldAndGradient unit = coils_->unit_field(coil, Eigen::Vector3d(x, 0.0, z));
        const double xx = unit.gradient(0, 0), xz = unit.gradient(0, 2), zz = unit.gradient(2, 2);
        const PlanarGradient east = gradient_at(*coils_, coil, x + d, z);
        const PlanarGradient west = gradient_at(*coils_, coil, x - d, z);
        const PlanarGradient up = gradient_at(*coils_, coil, x, z + d);
        const PlanarGradient down = gradient_at(*coils_, coil, x, z - d);
        unit_[k] = {unit.field.x(),
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
    stretch_.centre_x = x;
    stretch_.centre_z = z;
    expanded_ = true;
}

void LocalField::combine() {
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + segment_.exponentials); ++b) {
        Terms sum = {};
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double coefficient = gain_[k] * segment_.field[b][k];
            if (coefficient == 0.0) continue;
            for (std::size_t i = 0; i < Expansion::kTerms; ++i) sum[i] += coefficient * unit_[k][i];
        }
        (b < 3 ? stretch_.basis[b] : further_[b - 3].basis) = sum;
    }
    stretch_.basis[0][0] += ambient_x_;
    stretch_.basis[0][1] += ambient_z_;
}

}  // namespace stickslip
