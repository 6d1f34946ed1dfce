#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "stickslip/drive/circuit.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/field/field_shape.hpp"
#include "stickslip/field/horizontal_field.hpp"
#include "stickslip/field/turning_points.hpp"
#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/pack.hpp"

namespace stickslip {

/// Field and gradient in the plane of motion y = 0. The curl is zero, so dBx/dz = dBz/dx.
template <class Real>
struct PlanarFieldOf {
    Real bx = 0.0, bz = 0.0;                        ///< T
    Real dbx_dx = 0.0, dbx_dz = 0.0, dbz_dz = 0.0;  ///< T/m
};
using PlanarField = PlanarFieldOf<double>;

/// The field at one time as a polynomial in the plane of motion.
template <class Real>
struct ExpansionOf {
    // bx bz | gxx gxz gzz | xxx xxz xzz zzz | xxxx xxxz xxzz xzzz zzzz: derivatives of the
    // potential.
    static constexpr std::size_t kTerms = 14;
    using Terms = std::array<Real, kTerms>;

    Terms terms;
    Real centre_x, centre_z;  ///< m
    Real tau;                 ///< s, the time it holds for

    [[gnu::always_inline]] inline PlanarFieldOf<Real> operator()(Real x, Real z) const;
};
using Expansion = ExpansionOf<double>;

/// The field near a centre over a stretch in which the currents are a + b tau + c exp(-rate tau).
template <class Real>
struct FieldStretch {
    using Terms = typename ExpansionOf<Real>::Terms;

    std::array<Terms, 3> basis;  ///< of a, b and c
    Real centre_x, centre_z;
    Real rate;  ///< 1/s

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(basis, centre_x, centre_z, rate);
    }

    [[gnu::always_inline]] ExpansionOf<Real> at(Real tau) const {
        ExpansionOf<Real> result;
        result.centre_x = centre_x;
        result.centre_z = centre_z;
        result.tau = tau;
        const Real fading = exponential(-rate * tau);
        if constexpr (std::is_same_v<Real, double>) {
            using Pair = Pack<2>;
            for (std::size_t i = 0; i < result.terms.size(); i += 2) {
                store(pair(&basis[0][i]) + pair(&basis[1][i]) * Pair(tau) +
                          pair(&basis[2][i]) * Pair(fading),
                      &result.terms[i]);
            }
        } else {
            for (std::size_t i = 0; i < result.terms.size(); ++i) {
                result.terms[i] = basis[0][i] + basis[1][i] * tau + basis[2][i] * fading;
            }
        }
        return result;
    }
};

/// What an exponential beside the first adds to the field of a stretch.
template <class Real>
struct FurtherExponential {
    using Terms = typename ExpansionOf<Real>::Terms;

    Terms basis;
    Real rate;  ///< 1/s

    [[gnu::always_inline]] constexpr auto members() { return std::tie(basis, rate); }

    /// Where there is no such exponential the terms are minus zero, which leaves the bits of a sum.
    static constexpr double kNothing = -0.0;

    [[gnu::always_inline]] void add(Real tau, ExpansionOf<Real>& expansion) const {
        const Real fading = exponential(-rate * tau);
        for (std::size_t i = 0; i < basis.size(); ++i) {
            expansion.terms[i] = expansion.terms[i] + basis[i] * fading;
        }
    }
};

/// Where in the plane of motion the model of the set-up holds, m: between these.
template <class Real>
struct WorkspaceOf {
    Real x_low, x_high, z_low, z_high;

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(x_low, x_high, z_low, z_high);
    }

    /// Not a place with a coordinate that is NaN.
    [[gnu::always_inline]] auto holds(Real x, Real z) const {
        return ((x > x_low) & (x < x_high)) & ((z > z_low) & (z < z_high));
    }
};
using Workspace = WorkspaceOf<double>;

/// The coordinate (m) of a centre for a robot at `place`, which is a quarter of the reach from it
/// at most: a finer grid would be computed more often.
inline double on_grid(double place, double reach) {
    const double spacing = 0.5 * reach;
    return spacing * std::round(place / spacing);
}

/// What one ampere in a coil makes at the robot.
struct CoilField {
    std::array<double, 3> field = {};  ///< T
    /// T/m, gradient of the component along the robot's heading, along x and y.
    std::array<double, 2> slope = {};
};

/// How far from its centre an expansion of the field of these coils holds, m, and where the model
/// of the set-up does.
double reach_of(const CoilSet& coils);
Box workspace_of(const CoilSet& coils);

/// The field of the driven coils near the robot and over one stretch of voltage.
///
/// In the plane of motion the field derives from a potential, which is expanded to fourth order
/// about a centre near the robot; its coefficients come from the analytic field and gradient at the
/// centre and at four points about it. Inside the reach of the centre the field is then
/// within 1e-9 of the full sum of Eqs. (4)-(6) (cpp/tests/test_local_field.cpp), at a twentieth of
/// its cost. Coils smaller than those of Table I have a smaller reach, in proportion; with a map it
/// is in proportion to the map.
class LocalField {
public:
    static constexpr double kReach = 1.5e-4;  ///< m, the most that the robot may be from the centre

    /// gain: factor on each coil's field; a coil that never has current gets zero and costs
    /// nothing. ambient_x, ambient_z: a uniform field, T.
    LocalField(const CoilSet& coils, const PerCoil& gain, double ambient_x, double ambient_z);

    /// What multiplies the field of the coils from now on; it has to outlive this.
    void set_shape(const FieldShape& shape) { shape_ = &shape; }
    /// That factor, `tau` seconds into the stretch.
    double factor(double tau) const {
        return shape_ ? shape_->factor(segment_.start + tau, segment_.field_currents(tau)) : 1.0;
    }

    void set_segment(const CurrentSegment& segment);
    /// Begins a stretch with the robot at (x, z) m. The place alone decides the centre, a point of
    /// a grid, so that many stretches share one expansion.
    void begin_stretch(const CurrentSegment& segment, double x, double z);

    const PerCoil& gain() const { return gain_; }
    /// For a coil that had none.
    void set_gain(const PerCoil& gain);

    /// Moves the centre to the robot where it has left half the reach.
    void rebase(double x, double z);

    /// How far from its centre an expansion holds, m.
    double reach() const { return reach_; }

    /// Half the time constant of the fastest exponential of the stretch, s.
    double min_time_constant() const { return min_time_constant_; }

    /// The robot has come so near to a coil's plane, or to the end of the map, that the model of
    /// the set-up ends.
    bool outside() const { return outside_; }
    /// Where it may be; anywhere without coils that drive.
    const Workspace& workspace() const { return workspace_; }

    /// The expansion at `tau` seconds into the stretch. It does not depend on the robot's state, so
    /// an integrator can have it ready before a stage begins.
    Expansion at(double tau) const {
        Expansion result = stretch_.at(tau);
        for (std::size_t j = 1; j < static_cast<std::size_t>(segment_.exponentials); ++j) {
            further_[j - 1].add(tau, result);
        }
        if (shape_) multiply(tau, result);
        return result;
    }

    /// The horizontal field at a place in the course of the stretch, but for its segment.
    HorizontalField horizontal(double x, double z) const;
    /// The field there, where no shape multiplies it, but for its segment.
    FieldCourse course(double x, double z) const;
    bool has_shape() const { return shape_ != nullptr; }
    /// What each coil makes there, with its gain.
    PerCoilOf<CoilField> of_coils(double x, double z) const;

    /// The stretch as the formulas see it, where no shape multiplies it: its first exponential.
    const FieldStretch<double>& stretch() const { return stretch_; }
    /// What exponential j adds, counted from 0 and beginning with 1, where there is such a one.
    const FurtherExponential<double>& further(std::size_t j) const { return further_[j - 1]; }

private:
    using Terms = Expansion::Terms;

    void set_workspace();
    void expand(double x, double z);
    void combine();
    void multiply(double tau, Expansion& expansion) const;

    const CoilSet* coils_;
    const FieldShape* shape_ = nullptr;
    double reach_;
    Workspace workspace_;
    double min_time_constant_ = 0.0;
    PerCoil gain_;
    double ambient_x_, ambient_z_;
    CurrentSegment segment_;
    bool expanded_ = false;
    bool outside_ = false;
    std::array<Terms, kCoilCount> unit_ = {};  // per ampere of each coil
    FieldStretch<double> stretch_ = {};
    // Of the second exponential and those after it.
    std::array<FurtherExponential<double>, kMaxExponentials - 1> further_ = {};
};

template <class Real>
inline PlanarFieldOf<Real> ExpansionOf<Real>::operator()(Real x, Real z) const {
    const Real dx = x - centre_x, dz = z - centre_z;
    const Real xx = 0.5 * (dx * dx), xz = dx * dz, zz = 0.5 * (dz * dz);
    constexpr double third = 1.0 / 3.0;
    const Real xxx = third * dx * xx, xxz = dz * xx, xzz = dx * zz, zzz = third * dz * zz;
    // Sums in pairs: what counts is the longest chain of dependent operations. Those of B_z and of
    // dB_x/dz are those of B_x and dB_x/dx with each term's neighbour.
    const auto field_of = [&](auto c, auto first) __attribute__((always_inline)) {
        return ((first + c(2) * dx) + (c(3) * dz + c(5) * xx)) +
               ((c(6) * xz + c(7) * zz) +
                ((c(9) * xxx + c(10) * xxz) + (c(11) * xzz + c(12) * zzz)));
    };
    const auto gradient_of = [&](auto c) __attribute__((always_inline)) {
        return (c(2) + (c(5) * dx + c(6) * dz)) + (c(9) * xx + (c(10) * xz + c(11) * zz));
    };
    const Real zz_gradient = (terms[4] + (terms[7] * dx + terms[8] * dz)) +
                             (terms[11] * xx + (terms[12] * xz + terms[13] * zz));
    if constexpr (std::is_same_v<Real, double>) {
        const auto both = [this](std::size_t i) __attribute__((always_inline)) {
            return pair(&terms[i]);
        };
        const Pack<2> field = field_of(both, both(0)), gradient = gradient_of(both);
        return {field.v[0], field.v[1], gradient.v[0], gradient.v[1], zz_gradient};
    } else {
        const auto x_part = [this](std::size_t i) { return terms[i]; };
        const auto z_part = [this](std::size_t i) { return terms[i + 1]; };
        return {field_of(x_part, terms[0]), field_of(z_part, terms[1]), gradient_of(x_part),
                gradient_of(z_part), zz_gradient};
    }
}

}  // namespace stickslip
