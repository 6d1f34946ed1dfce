#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stickslip/drive/voltage_program.hpp"

namespace stickslip {

enum class DriveMode { ipp, opp, program, none };
/// Source of the voltages: a sawtooth, the rows of a program, or none.
enum class DriveKind { sawtooth, program, none };
inline constexpr std::array<std::string_view, 3> kDriveKinds = {"sawtooth", "program", "none"};
constexpr DriveKind kind_of(DriveMode mode) {
    if (mode == DriveMode::program) return DriveKind::program;
    return mode == DriveMode::none ? DriveKind::none : DriveKind::sawtooth;
}
enum class Clamp { down, up };
enum class Edge { rise, fall };
enum class Direction { plus_x, minus_x };
/// Which coils of an axis make its part of the field in the surface: the one that lies ahead, which
/// pulls the robot too, or both alike, which leaves no gradient at the centre.
enum class DriveCoils { single, pairs };

/// The pulsed drive, section V: one in-plane coil and the clamp coil, of which one plays a sawtooth
/// and the other holds. Fields are those at the centre if the voltage were held for ever.
struct Drive {
    DriveMode mode = DriveMode::ipp;
    double frequency = 100.0;  ///< Hz
    double peak = 2.5e-3;      ///< T, top of the sawtooth
    double base = 0.0;         ///< T, bottom of the sawtooth
    double hold = 1.0e-3;      ///< T, of the holding coil
    Clamp clamp = Clamp::down;
    Edge edge = Edge::rise;
    double edge_time = 0.0;  ///< s
    Direction direction = Direction::plus_x;
    double heading = 0.0;  ///< rad, from `direction` to where the robot is driven
    DriveCoils coils = DriveCoils::single;
    double ramp = 0.05;  ///< s
    std::int64_t pulses = 100;
    double latency = 0.0;    ///< s, by which all voltages are late
    double ramp_down = 0.0;  ///< s

    DriveKind kind() const { return kind_of(mode); }
};

/// A direction in the surface as a unit vector, exact at multiples of a quarter turn.
struct SurfaceDirection {
    double x = 1.0, y = 0.0;
};
SurfaceDirection surface_direction(double angle);

/// Voltages of IPP or OPP for a robot that is driven `towards`, in the frame of that direction.
/// volts_per_tesla: voltage of each coil for a field at the centre. Throws std::invalid_argument
/// for a drive of another kind.
VoltageProgram sawtooth_program(const Drive& drive, const SurfaceDirection& towards,
                                const PerCoil& volts_per_tesla);

/// The coil of the world's frame that does most to drive a robot along the surface.
Coil in_plane_coil(const SurfaceDirection& towards);

/// A world-frame program in the frame of the turned robot, and back.
VoltageProgram turned(const VoltageProgram& program);

}  // namespace stickslip
