#pragma once

#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/pack.hpp"

/// The named effects on forces, adhesion and friction that have one formula for all runs, in which
/// an absent one has zeros. They are written for a number or a pack of numbers, so that runs with
/// different effects go on together (run/step_kernel.cpp). A zero leaves the bits of a result as
/// they are, so what takes long is left out where no member has it.
namespace stickslip {

/// Effects `gradient_scale`, `angle_drag` and `quadratic_drag`.
template <class Real>
struct SmoothForces {
    Real gradient_excess = 0.0;  ///< -, part by which the magnetic force is larger
    Real angle_drag = 0.0;       ///< N s/m, times cos^2 theta
    Real quadratic_drag = 0.0;   ///< N s^2/m^2

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(gradient_excess, angle_drag, quadratic_drag);
    }
    /// Adds them to a load of the moment (mx, mz) at the cosine of theta; the drag that they have
    /// beyond the linear one, N s/m.
    [[gnu::always_inline]] Real add(const auto& field, Real mx, Real mz, Real cosine, Real vx,
                                    Real vz, auto& load) const {
        Real drag = angle_drag * cosine * cosine;
        if (any(quadratic_drag > 0.0)) {
            drag = fma(quadratic_drag, root(fma(vx, vx, vz * vz)), drag);
        }
        load.fx =
            fma(gradient_excess, fma(mx, field.dbx_dx, mz * field.dbx_dz), fnma(drag, vx, load.fx));
        load.fz =
            fma(gradient_excess, fma(mx, field.dbx_dz, mz * field.dbz_dz), fnma(drag, vz, load.fz));
        return drag;
    }
};

/// Effects `angle_adhesion` and `adhesion_ageing`.
template <class Real>
struct SmoothAdhesion {
    Real angle_loss = 0.0;   ///< -
    Real ageing_rate = 0.0;  ///< -
    Real ageing_time = 1.0;  ///< s

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(angle_loss, ageing_rate, ageing_time);
    }
    /// Factor at the sine of theta.
    [[gnu::always_inline]] Real at_angle(Real sine) const {
        return fnma(angle_loss * sine, sine, Real(1.0));
    }
    /// Factor of a contact that was made `seconds` ago.
    [[gnu::always_inline]] Real aged(Real seconds) const {
        if (!any(ageing_rate > 0.0)) return 1.0;
        const Real past = greater(seconds, Real(0.0));
        return fma(ageing_rate, logarithm(1.0 + past / ageing_time), Real(1.0));
    }
};

/// Effects `stribeck_friction`, `viscous_friction`, `friction_anisotropy` and `friction_patches`.
template <class Real>
struct SmoothFriction {
    Real stribeck_velocity = 0.0;  ///< m/s
    Real viscous = 0.0;            ///< s/m
    Real anisotropy = 0.0;         ///< -
    Real patch_amplitude = 0.0;    ///< -
    Real patch_wavenumber = 0.0;   ///< 1/m

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(stribeck_velocity, viscous, anisotropy, patch_amplitude, patch_wavenumber);
    }
    /// Of one run.
    bool absent() const {
        return stribeck_velocity == 0.0 && viscous == 0.0 && anisotropy == 0.0 &&
               patch_amplitude == 0.0;
    }

    /// Factor on both coefficients of a contact at x (m) that slips, or is about to, to the side
    /// `slip`.
    [[gnu::always_inline]] Real place(Real slip, Real x) const {
        Real factor = fma(anisotropy, slip, Real(1.0));
        if (any(magnitude(patch_amplitude) > 0.0)) {
            factor = factor * fma(patch_amplitude, sine(patch_wavenumber * x), Real(1.0));
        }
        return factor;
    }
    /// Coefficient, apart from that factor, of a contact that slips at `slip_velocity` (m/s).
    [[gnu::always_inline]] Real kinetic(Real static_friction, Real kinetic_friction,
                                        Real slip_velocity) const {
        Real coefficient = fma(viscous, magnitude(slip_velocity), kinetic_friction);
        const auto falls = stribeck_velocity > 0.0;
        if (any(falls)) {
            const Real ratio = slip_velocity / stribeck_velocity;
            const Real excess =
                (static_friction - kinetic_friction) * exponential(-(ratio * ratio));
            coefficient = select(falls, coefficient + excess, coefficient);
        }
        return coefficient;
    }
};

/// All of them on a robot in one quadrant over one segment of voltage.
template <class Real>
struct SmoothEffects {
    SmoothForces<Real> forces;
    SmoothAdhesion<Real> adhesion;
    SmoothFriction<Real> friction;
    Real turn_sine = 0.0, turn_cosine = 1.0;  ///< of the quadrant
    Real contact_age = 0.0;                   ///< s, at the start of the segment

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(forces, adhesion, friction, turn_sine, turn_cosine, contact_age);
    }
};

}  // namespace stickslip
