#pragma once

#include <atomic>
#include <string>

#include "stickslip/body/model.hpp"
#include "stickslip/contact/plane_dynamics.hpp"
#include "stickslip/drive/circuit.hpp"
#include "stickslip/field/expansion.hpp"
#include "stickslip/solver/stepping.hpp"

/// From the values of a scenario to the parts of its simulation, each effect put where it acts.
namespace stickslip {

struct Scenario;

/// Throws std::invalid_argument, naming key, value and what is allowed, for values that are each in
/// their range but make no sense together.
void check(const Scenario& scenario);

/// Constants of motion in the robot's own frame.
Model make_model(const Scenario& scenario, const RobotFrame& frame);

/// The coils' circuits for `program` (which heats them, if they do).
Circuit make_circuit(const Scenario& scenario, const RobotFrame& frame,
                     const VoltageProgram& program);

/// Constant factor on the field of each coil by Eqs. (4)-(6); `Model::field_shape` varies within
/// the run.
PerCoil field_gain(const Scenario& scenario);

/// The whole factor for steady currents (A): free shapes at time and frequency zero.
PerCoil held_field_gain(const Scenario& scenario, const PerCoil& currents);

/// Voltages that the drive asks for, in the robot's own frame.
VoltageProgram commanded_program(const Scenario& scenario, const RobotFrame& frame);

/// The same voltages as the amplifiers give them.
VoltageProgram make_program(const Scenario& scenario, const RobotFrame& frame);

/// The field near the robot, of the coils that have current. `coils` have to outlive it.
LocalField make_local_field(const Scenario& scenario, const RobotFrame& frame,
                            const VoltageProgram& program, const CoilSet& coils);

/// Dynamics of a robot that moves in the whole plane: heading, and forces across it. `upright` and
/// `coils` have to outlive it.
PlaneDynamics make_plane_dynamics(const Scenario& scenario, const VoltageProgram& program,
                                  const CoilSet& coils, Dynamics& upright);

/// Tolerances and limits of the steps, from the natural scales of the motion. `stop`: or nullptr.
StepperOptions make_stepper_options(const Scenario& scenario, const Model& model,
                                    const VoltageProgram& program, const CoilSet& coils,
                                    const std::atomic<bool>* stop);

/// The key that damps a motion fastest: steps have to be about as short, even where all of it has
/// died away.
struct Decay {
    std::string key = {};  ///< "": nothing damps
    double value = 0.0;
    double rate = 0.0;  ///< 1/s
};
/// swing_rate: rad/s, of the free swing.
Decay fastest_decay(const Model& model, double swing_rate);

/// Simulated time from start to end, s.
double duration(const Scenario& scenario);

/// Pulses a second, Hz; zero for a free program. Without a drive they are periods of the shake, of
/// the inner mass's force, or those of drive.frequency.
double pulse_rate(const Scenario& scenario);
/// Time from pulse to pulse, s; zero for a free program.
double pulse_period(const Scenario& scenario);

/// Times (s) between which the mean velocity is taken: from the end of the third pulse (of the
/// ramp, with three pulses or fewer) to the end of the last (section VII); all of a free program.
struct Window {
    double start = 0.0, end = 0.0;
};
Window measuring_window(const Scenario& scenario);

}  // namespace stickslip
