#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stickslip/body/inner_mass.hpp"
#include "stickslip/body/user_effect.hpp"
#include "stickslip/drive/sawtooth.hpp"
#include "stickslip/drive/shake.hpp"
#include "stickslip/field/coil_set.hpp"
#include "stickslip/numbers/free_curve.hpp"
#include "stickslip/scenario/own_laws.hpp"
#include "stickslip/scenario/record_columns.hpp"
#include "stickslip/scenario/state.hpp"

namespace stickslip {

/// One coil, Table I.
struct CoilParameters : CoilGeometry {
    double resistance = 10.0;  ///< ohm
    double inductance = 0.07;  ///< H
    double capacitance = 0.0;  ///< F, in series; zero: none

    friend bool operator==(const CoilParameters&, const CoilParameters&) = default;
};

/// Table II.
struct RobotParameters {
    double length = 250e-6;      ///< m
    double width = 130e-6;       ///< m
    double height = 100e-6;      ///< m
    double mass = 25.6e-9;       ///< kg
    double magnetization = 5e5;  ///< A/m
};

struct ContactParameters {
    double static_friction = 0.2;
    double kinetic_friction = 0.145;
    double adhesion = 0.22e-6;  ///< N
    double restitution = 0.0;
    double tangential_restitution = 0.0;
};

struct DragParameters {
    double linear = 1.0e-5;       ///< N s/m, Eq. (18)
    double rotational = 9.0e-17;  ///< N m s^2, Eq. (19)
};

/// The numbers of the named laws, two of each at most, in the order of the rows of named_laws.cpp.
using NamedLawNumbers = std::array<std::array<double, 2>, 12>;
/// Numbers with which none of the named laws acts.
const NamedLawNumbers& absent_laws();

/// Parameters of the named extensions. Each is absent at zero; see parameters.cpp for their
/// meaning.
struct Effects {
    // drive
    double coil_heating_coefficient = 0.0;  ///< 1/W
    double amplifier_limit_voltage = 0.0;   ///< V
    double eddy_lag_time = 0.0;             ///< s
    double sample_hold_period = 0.0;        ///< s
    double mutual_inductance_coupling = 0.0;
    double gradient_scale_fraction = 0.0;
    double field_gain_in_plane = 0.0;
    double field_gain_clamp = 0.0;
    // magnet
    double misalignment_angle = 0.0;  ///< rad
    double ambient_field_bx = 0.0;    ///< T
    double ambient_field_bz = 0.0;    ///< T
    double ambient_field_by = 0.0;    ///< T
    // fluid
    double rotational_drag_coefficient = 0.0;  ///< N m s
    // surface
    double surface_tilt_angle = 0.0;    ///< rad
    double surface_tilt_azimuth = 0.0;  ///< rad, has no effect at angle zero
    NamedLawNumbers laws = absent_laws();
    // free shapes, each absent while its knots are zero; see free_shapes.cpp
    FreeShape free_contact_place{FreeReach::both_ways, 1.5};      ///< of rad
    FreeShape free_field_time{FreeReach::from_zero, 1.0};         ///< of s
    FreeShape free_field_frequency{FreeReach::from_zero, 200.0};  ///< of Hz
    FreeShape free_field_amplitude{FreeReach::from_zero, 2.5};    ///< of A
};

enum class Method { tsit5, arkode };

struct SolverSettings {
    Method method = Method::tsit5;
    double rtol = 1e-8;
    double max_step = 0.0;  ///< s, zero: no limit
    std::int64_t max_steps = 1'000'000'000;
};

/// All that defines one simulation.
struct Scenario {
    Drive drive;
    VoltageProgram program;               ///< V, world frame; used by DriveKind::program
    CoilParameters coil;                  ///< of all coils but for their own values
    PerCoilOf<CoilParameters> coils;      ///< world frame
    std::shared_ptr<const FieldMap> map;  ///< world frame; nullptr: the coils' own field
    RobotParameters robot;
    ContactParameters contact;
    DragParameters drag;
    double gravity = 9.81;  ///< m/s^2
    ShakeParameters shake;
    InnerMass inner;
    Effects effects;
    std::vector<UserSetting> user_effects;  ///< by name; see set_parameter
    std::vector<OwnLaw> laws;               ///< by name; see own_laws.hpp
    SimulationState initial;
    /// Whether the robot moves in the whole plane though nothing above asks for it: voltages of a
    /// run that is stepped may.
    bool whole_plane = false;
    SolverSettings solver;
    RecordSettings record;
};

}  // namespace stickslip
