#pragma once

#include <cstdint>

#include "stickslip/voltage_program.hpp"

namespace stickslip {

enum class DriveMode { ipp, opp, program };
enum class Clamp { down, up };
enum class Edge { rise, fall };
enum class Direction { plus_x, minus_x };

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
    double ramp = 0.05;  ///< s
    std::int64_t pulses = 100;
    double ramp_down = 0.0;  ///< s
};

/// Voltages of IPP or OPP in the robot's own frame, in which it is always driven towards +x.
/// volts_per_tesla: voltage of each coil for a field at the centre. Throws std::invalid_argument
/// for a mode without pulses.
VoltageProgram sawtooth_program(const Drive& drive, const PerCoil& volts_per_tesla);

/// The coil of the world's frame that drives a robot along the surface.
Coil in_plane_coil(Direction direction);

/// A world-frame program in the frame of the turned robot, and back.
VoltageProgram turned(const VoltageProgram& program);

}  // namespace stickslip
