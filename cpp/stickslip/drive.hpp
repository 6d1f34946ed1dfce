#pragma once

#include "stickslip/drive/circuit.hpp"
#include "stickslip/drive/coil.hpp"
#include "stickslip/drive/control_steps.hpp"
#include "stickslip/drive/current_functions.hpp"
#include "stickslip/drive/inner_drive.hpp"
#include "stickslip/drive/sawtooth.hpp"
#include "stickslip/drive/segment_source.hpp"
#include "stickslip/drive/shake.hpp"
#include "stickslip/drive/voltage_program.hpp"

/// From voltages to currents, and what else drives.
///
/// - coil: the five coils by name, and a value of each
/// - voltage_program: piecewise linear voltages, with blocks that repeat
/// - sawtooth: the program of a pulsed drive, Eq. (1) turned around
/// - shake: a motion of the surface; inner_drive: a force on a mass within the body
/// - control_steps, segment_source: voltages that a controller gives while the run goes on
/// - current_functions: what the currents of a segment are sums of
/// - circuit: the currents of a segment in closed form, for coils that are coupled, unequal, warm,
///   have a capacitor, or a field that lags behind them
namespace stickslip {}
