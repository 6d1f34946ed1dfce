#include "stickslip/run/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/run/initial_state.hpp"
#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/named_laws.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {
namespace {

// Pulses after which the motion counts as steady, section VII.
constexpr std::int64_t kSettlingPulses = 3;

// Most samples of a recording, some 170 bytes each. Memory may set a lower limit.
constexpr double kMostSamples = 1e9;

constexpr double kTurn = 2.0 * std::numbers::pi;

// Lower limit of solver.max_step, s.
constexpr double kLeastMaxStep = 1e-9;

[[noreturn]] void refuse(const char* key, double value, const std::string& allowed) {
    throw std::invalid_argument(std::string(key) + " = " + digits(value) + ": allowed is " +
                                allowed);
}

// Two values that exclude each other; which of them is wrong only the user knows.
[[noreturn]] void refuse_pair(const char* key, double value, const char* other, double other_value,
                              const char* allowed) {
    throw std::invalid_argument(std::string(key) + " = " + digits(value) + " with " + other +
                                " = " + digits(other_value) + ": allowed is " + allowed);
}

// Pulses before the measuring window.
std::int64_t settling_pulses(const Drive& drive) {
    return drive.pulses > kSettlingPulses ? kSettlingPulses : 0;
}

double pulsing_time(const Scenario& s) {
    return static_cast<double>(s.drive.pulses) / pulse_rate(s);
}

// Time before the first pulse, s.
double lead_in(const Drive& drive) {
    return drive.kind() == DriveKind::none ? 0.0 : drive.latency + drive.ramp;
}

// Refuses a scenario that needs more steps than a run may have, however the robot moves.
void check_work(const Scenario& s, double duration) {
    const auto most = static_cast<double>(s.solver.max_steps);
    const auto refuse_span = [&](const char* key, double value, const char* zero) {
        const double least = duration / most;
        if (value > 0.0 && value < least) {
            refuse(key, value,
                   std::string(zero) + "at least " + lowest(least) + " s in a run of " +
                       rounded(duration) + " s with solver.max_steps = " + digits(most));
        }
    };
    refuse_span("solver.max_step", s.solver.max_step, "0 (no limit) or ");
    refuse_span("effects.sample_hold.period", s.effects.sample_hold_period, "0 (none) or ");
    // A pulse has two straight parts at least.
    if (s.drive.kind() != DriveKind::program && 2.0 * static_cast<double>(s.drive.pulses) > most) {
        refuse("drive.pulses", static_cast<double>(s.drive.pulses),
               "at most " + digits(std::floor(0.5 * most)) +
                   " with solver.max_steps = " + digits(most));
    }
}

// Whether neither a shake nor an inner mass moves the robot.
bool is_alone(const Scenario& s) {
    return s.shake.absent() && (s.inner.absent() || s.inner.drive.absent());
}

// A program of voltages says all of the drive but which way the robot faces; without a drive there
// is nothing to say but how long.
void check_no_sawtooth(const Scenario& s) {
    static const Scenario kDefaults{};
    const bool is_none = s.drive.kind() == DriveKind::none;
    const auto require_default = [&](const auto& row) {
        const std::string_view key = row.key;
        if (!key.starts_with("drive.") || key == "drive.mode" || key == "drive.direction" ||
            (key == "drive.latency" && !is_none)) {
            return;
        }
        if (row.get(s) == row.get(kDefaults)) return;
        if (is_none) {
            if (key == "drive.pulses" || (key == "drive.frequency" && is_alone(s))) return;
            throw std::invalid_argument(
                std::string(key) +
                ": not allowed with drive.mode = \"none\", where nothing "
                "drives the coils; leave it out" +
                (key == "drive.frequency" ? ", or set that of what shakes it" : ""));
        }
        throw std::invalid_argument(std::string(key) +
                                    ": not allowed with drive.mode = \"program\", whose voltages "
                                    "(drive.file, or drive.program in Python) say it all; leave it "
                                    "out");
    };
    for (const Parameter& row : parameters()) require_default(row);
    for (const Choice& row : choices()) require_default(row);
}

// Rows say all of what they are in place of.
void check_no_sines(const Scenario& s, std::initializer_list<std::string_view> starts,
                    const std::string& rows) {
    static const Scenario kDefaults{};
    for (const Parameter& row : parameters()) {
        const std::string key = row.key;
        const bool is_said = std::any_of(starts.begin(), starts.end(), [&](std::string_view each) {
            return key.starts_with(each);
        });
        if (!is_said || row.get(s) == row.get(kDefaults)) continue;
        std::string refused = key;
        refused.append(": not allowed with ").append(rows);
        throw std::invalid_argument(refused.append(", which says it all; leave it out"));
    }
}

// A sawtooth is given as the field of two coils at the centre.
void check_drive_of_map(const Scenario& s) {
    for (const Coil coil : {in_plane_coil(drive_direction(s)), Coil::clamp}) {
        const double field = world_coil_set(s).centre_field_per_ampere(coil);
        if (field > 0.0) continue;
        throw std::invalid_argument(
            std::string("coil.map: coil ") + name(coil) + " has " + digits(field) +
            " T/A along its axis at x = y = z = 0, from which the drive counts: allowed is a field "
            "above 0");
    }
}

FieldShape make_field_shape(const Effects& e) {
    return {.time = FreeCurve(e.free_field_time), .amplitude = FreeCurve(e.free_field_amplitude)};
}

PerCoil field_gain_at(const Scenario& s, double factor) {
    const double in_plane = (1.0 + s.effects.field_gain_in_plane) * factor;
    const double clamp = (1.0 + s.effects.field_gain_clamp) * factor;
    return {in_plane, in_plane, in_plane, in_plane, clamp};
}

}  // namespace

void check(const Scenario& s) {
    if (s.contact.kinetic_friction > s.contact.static_friction) {
        refuse_pair("contact.kinetic_friction", s.contact.kinetic_friction,
                    "contact.static_friction", s.contact.static_friction,
                    "a kinetic friction that is not above the static one");
    }
    check_coils(s);
    for (const CoilParameters& coil : s.coils) {
        if (coil.capacitance == 0.0 || s.effects.mutual_inductance_coupling == 0.0) continue;
        refuse_pair("coil.capacitance", coil.capacitance, "effects.mutual_inductance.coupling",
                    s.effects.mutual_inductance_coupling,
                    "one of the two: circuits of coupled coils have no capacitor here");
    }
    const RobotFrame frame = frame_of(s);
    check_plane(s, frame);
    check_own_laws(s);
    if (s.shake.accelerations) {
        check_no_sines(s, {"shake."}, "shake.file (shake.accelerations in Python)");
    }
    if (s.inner.drive.rows) {
        check_no_sines(
            s,
            {"inner.amplitude", "inner.frequency", "inner.phase", "inner.harmonic_", "inner.duty"},
            "inner.file (inner.forces in Python)");
    }
    if (!(s.inner.low < s.inner.high)) {
        refuse_pair("inner.stop_low", s.inner.low, "inner.stop_high", s.inner.high,
                    "a stop behind that is below the one ahead");
    }
    if (s.solver.max_step > 0.0 && s.solver.max_step < kLeastMaxStep) {
        refuse("solver.max_step", s.solver.max_step, "0 (no limit) or at least 1e-9 s");
    }
    const bool pulses = s.drive.kind() == DriveKind::sawtooth;
    if (s.map && pulses) check_drive_of_map(s);
    if (!pulses) {
        if (s.drive.kind() == DriveKind::program && s.program.blocks().empty()) {
            throw std::invalid_argument("drive.mode = \"program\": needs drive.file or a waveform");
        }
        check_no_sawtooth(s);
    } else {
        const double period = 1.0 / s.drive.frequency;
        if (s.drive.peak < s.drive.base) {
            refuse_pair("drive.peak", s.drive.peak, "drive.base", s.drive.base,
                        "a peak that is not below the base");
        }
        if (s.drive.edge_time >= period) {
            refuse_pair("drive.edge_time", s.drive.edge_time, "drive.frequency", s.drive.frequency,
                        "less than one period, 1/drive.frequency");
        }
    }
    if (!(s.initial == SimulationState{})) initial_state(s, make_model(s, frame));
    make_program(s, frame);  // refuses voltages that are not finite
    const double longest = duration(s);
    check_work(s, longest);
    const double highest_rate = kMostSamples / longest;
    if (s.record.kind == RecordKind::uniform && !(s.record.rate > 0.0)) {
        refuse("record.rate", s.record.rate, "above 0 Hz");
    }
    if (s.record.kind == RecordKind::uniform && s.record.rate > highest_rate) {
        refuse("record.rate", s.record.rate,
               "at most 1e9 samples in all, here " + highest(highest_rate) + " Hz");
    }
    if (s.record.pull_share && !s.inner.absent()) {
        throw std::invalid_argument(
            "record.pull_share = \"yes\": not allowed with [inner], whose mass presses too");
    }
    if (s.record.from > longest * (1.0 + 1e-12)) {  // rounding of the last sample's time
        refuse("record.from", s.record.from,
               "from 0 to " + highest(longest) + " s, the duration of the run");
    }
}

double duration(const Scenario& scenario) {
    const Drive& drive = scenario.drive;
    if (drive.kind() == DriveKind::program) return drive.latency + scenario.program.duration();
    if (drive.kind() == DriveKind::none) return pulsing_time(scenario);
    return lead_in(drive) + pulsing_time(scenario) + drive.ramp_down;
}

Model make_model(const Scenario& s, const RobotFrame& frame) {
    const RobotParameters& robot = s.robot;
    const Effects& e = s.effects;
    Model model;
    model.shape = Rectangle(robot.length, robot.height);
    model.width = robot.width;
    model.mass = robot.mass;
    model.inertia = robot.mass * (robot.length * robot.length + robot.height * robot.height) / 12.0;
    model.moment = robot.magnetization * robot.length * robot.width * robot.height;
    model.misalignment = e.misalignment_angle;
    model.gradient_excess = e.gradient_scale_fraction;
    // In the whole plane what acts along the surface has any direction, see `surface_weight`.
    const double downhill = surface_direction(e.surface_tilt_azimuth).x;
    const double tilt = frame.sign * (downhill < 0.0 ? -1.0 : 1.0) * e.surface_tilt_angle;
    model.gravity_x = frame.whole_plane ? 0.0 : s.gravity * std::sin(tilt);
    model.gravity_z = -s.gravity * std::cos(tilt);
    model.translational_drag = s.drag.linear;
    model.rotational_drag_linear = e.rotational_drag_coefficient;
    model.rotational_drag_quadratic = s.drag.rotational;
    model.friction = {s.contact.static_friction, s.contact.kinetic_friction};
    model.adhesion = s.contact.adhesion;
    model.laws = LawSet(all_laws(s, frame));
    model.place = ContactPlace(e.free_contact_place, model.shape.half_base(0));
    model.field_shape = make_field_shape(e);
    model.shake = Shake(s.shake, frame.sign);
    model.inner = s.inner;
    model.restitution = s.contact.restitution;
    model.tangential_restitution = s.contact.tangential_restitution;
    model.frame = frame;
    for (const UserSetting& each : s.user_effects) {
        if (!each.absent()) model.user_effects.push_back(each);
    }
    return model;
}

Circuit make_circuit(const Scenario& s, const RobotFrame& frame, const VoltageProgram& program) {
    const Effects& e = s.effects;
    CircuitParameters parameters;
    const PerCoilOf<CoilParameters> coils = robot_coils(s, frame);
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        parameters.resistance[k] = coils[k].resistance;
        parameters.inductance[k] = coils[k].inductance;
        parameters.capacitance[k] = coils[k].capacitance;
    }
    parameters.coupling = e.mutual_inductance_coupling;
    parameters.lag = e.eddy_lag_time;
    if (e.coil_heating_coefficient != 0.0) {
        parameters.resistance = warm_resistances(program, parameters, e.coil_heating_coefficient);
    }
    Circuit circuit(parameters);
    if (!(s.initial == SimulationState{})) {
        circuit.set_currents(frame.to_robot(s.initial.current), frame.to_robot(s.initial.field_lag),
                             frame.to_robot(s.initial.capacitor));
    }
    return circuit;
}

PerCoil field_gain(const Scenario& s) {
    // The voltages of a program repeat at no frequency.
    if (s.drive.kind() == DriveKind::program) return field_gain_at(s, 1.0);
    return field_gain_at(s, FreeCurve(s.effects.free_field_frequency).factor(s.drive.frequency));
}

PerCoil held_field_gain(const Scenario& s, const PerCoil& currents) {
    const double still = FreeCurve(s.effects.free_field_frequency).factor(0.0);
    return field_gain_at(s, still * make_field_shape(s.effects).factor(0.0, currents));
}

VoltageProgram commanded_program(const Scenario& s, const RobotFrame& frame) {
    if (s.drive.kind() == DriveKind::program) return frame.to_robot(s.program);
    if (s.drive.kind() == DriveKind::none) {
        return VoltageProgram({{{{0.0, {}}, {1.0 / pulse_rate(s), {}}}, s.drive.pulses}});
    }
    const PerCoilOf<CoilParameters> coils = robot_coils(s, frame);
    PerCoil volts_per_tesla = robot_coil_set(s, frame).centre_fields_per_ampere();
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        volts_per_tesla[k] = coils[k].resistance / volts_per_tesla[k];
    }
    // The frame of a robot that stays in one plane is its own.
    const SurfaceDirection towards = frame.whole_plane ? drive_direction(s) : SurfaceDirection{};
    return sawtooth_program(s.drive, towards, volts_per_tesla);
}

VoltageProgram make_program(const Scenario& s, const RobotFrame& frame) {
    const double limit = s.effects.amplifier_limit_voltage;
    const VoltageProgram program = commanded_program(s, frame);
    return limit > 0.0 ? clipped(program, limit) : program;
}

namespace {

// Gain of each coil; zero for one that has no current in the run.
PerCoil driven_gain(const Scenario& scenario, const RobotFrame& frame,
                    const VoltageProgram& program) {
    PerCoil gain = field_gain(scenario);
    const PerCoil current = frame.to_robot(scenario.initial.current);
    const PerCoil lag = frame.to_robot(scenario.initial.field_lag);
    const PerCoil charged = frame.to_robot(scenario.initial.capacitor);
    // Coupled coils all have current.
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const bool driven = program.largest_voltage()[k] > 0.0 || current[k] != 0.0 ||
                            lag[k] != 0.0 || charged[k] != 0.0 ||
                            scenario.effects.mutual_inductance_coupling != 0.0;
        if (!driven) gain[k] = 0.0;
    }
    return gain;
}

}  // namespace

// In the whole plane the field is that of the PlaneDynamics.
LocalField make_local_field(const Scenario& scenario, const RobotFrame& frame,
                            const VoltageProgram& program, const CoilSet& coils) {
    const PerCoil gain = frame.whole_plane ? PerCoil{} : driven_gain(scenario, frame, program);
    return LocalField(
        coils, gain,
        {frame.sign * scenario.effects.ambient_field_bx, scenario.effects.ambient_field_bz});
}

PlaneDynamics make_plane_dynamics(const Scenario& s, const VoltageProgram& program,
                                  const CoilSet& coils, Dynamics& upright) {
    const Effects& e = s.effects;
    const SurfaceDirection downhill = surface_direction(e.surface_tilt_azimuth);
    const double weight = s.robot.mass * s.gravity * std::sin(e.surface_tilt_angle);
    PlaneDynamics plane(upright,
                        SpatialField(coils, driven_gain(s, upright.model().frame, program),
                                     {e.ambient_field_bx, e.ambient_field_by, e.ambient_field_bz}),
                        {weight * downhill.x, weight * downhill.y});
    plane.watch().set_state({.heading = start_heading(s)});
    return plane;
}

// Natural scales: the free swing about a corner in the strongest field, under weight and adhesion.
StepperOptions make_stepper_options(const Scenario& scenario, const Model& model,
                                    const VoltageProgram& program, const CoilSet& coils,
                                    const std::atomic<bool>* stop) {
    const Effects& e = scenario.effects;
    double field =
        std::hypot(std::hypot(e.ambient_field_bx, e.ambient_field_by), e.ambient_field_bz);
    const PerCoil current = model.frame.to_robot(scenario.initial.current);
    const PerCoilOf<CoilParameters> own = robot_coils(scenario, model.frame);
    const PerCoil centre = coils.centre_fields_per_ampere();
    double ringing = 0.0;  // 1/s, of the fastest coil with a capacitor
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const double root = std::sqrt(own[k].inductance * own[k].capacitance);
        if (root > 0.0) ringing = std::max(ringing, 1.0 / root);
        const double held = program.largest_voltage()[k] / own[k].resistance;
        field += std::max(held, std::abs(current[k])) * std::abs(centre[k]);
    }
    const double radius = model.shape.radius();
    const double weight =
        (model.mass + model.inner.mass) * (scenario.gravity + model.shake.most_acceleration()) +
        model.adhesion;
    const double torque = model.moment * field + weight * radius;
    StepperOptions result;
    result.max_step = scenario.solver.max_step;
    result.most_steps = scenario.solver.max_steps;
    const double swing = std::sqrt(torque / model.corner_inertia());
    result.swing_rate = swing > 0.0 ? swing : 1.0;
    // A free shape changes with time over the distance of its knots. A user's force may too, and
    // nothing is known of how fast: it is looked at as often as a phase's first step would.
    result.longest_rest = 0.125 * model.least_time();
    if (!model.user_effects.empty()) {
        result.longest_rest = std::min(result.longest_rest, 0.25 / result.swing_rate);
    }
    // Forces change with the shake, and with an inner mass, whether the body moves or not.
    double period = model.shake.shortest_period();
    if (!model.inner.absent()) {
        const InnerMass& inner = model.inner;
        const double per_mass = 1.0 / inner.mass + 1.0 / model.mass;
        const double rate = std::sqrt(inner.stiffness * per_mass);
        period = std::min({period, inner.drive.shortest_period(), kTurn / rate});
    }
    if (ringing > 0.0) result.longest_rest = std::min(result.longest_rest, 0.25 / ringing);
    const double longest = 0.125 * period;
    result.is_shaken = !model.shake.absent() || !model.inner.absent();
    if (result.is_shaken && !(result.max_step > 0.0 && result.max_step < longest)) {
        result.max_step = longest;
    }
    result.surface_speed = model.shake.most_speed();
    result.scales = {radius, radius * result.swing_rate, result.swing_rate};
    // A motion forgets its errors as fast as it is damped; what is hardly damped adds them up. In
    // proportion to the damping, the error of a run goes with rtol whatever the drag.
    constexpr double kForgetting = 0.1;  // damping over swing rate, near the paper's
    constexpr double kLeastPart = 1e-3, kLeastTolerance = 1e-13;
    const double drag = model.laws.lowest(Quantity::drag, Quantity::drag, model.translational_drag);
    const double least_drag =
        model.laws.lowest(Quantity::fluid, Quantity::fluid, std::max(drag, 0.0));
    const double damping = least_drag / model.mass / result.swing_rate;
    const double rtol = scenario.solver.rtol;
    result.tolerance = std::max(rtol * std::clamp(damping / kForgetting, kLeastPart, 1.0),
                                std::min(rtol, kLeastTolerance));
    result.stop = stop;
    return result;
}

Decay fastest_decay(const Model& model, double swing_rate) {
    const double load =
        (model.mass + model.inner.mass) *
            (std::hypot(model.gravity_x, model.gravity_z) + model.shake.most_acceleration()) +
        model.adhesion;
    const double speed = model.shape.radius() * swing_rate;
    Decay fastest;
    const auto see = [&](const std::string& key, double value, double rate) {
        if (rate > fastest.rate) fastest = {key, value, rate};
    };
    see("drag.linear", model.translational_drag, model.translational_drag / model.mass);
    see("drag.rotational", model.rotational_drag_quadratic,
        model.rotational_drag_quadratic * swing_rate / model.inertia);
    see("effects.rotational_drag.coefficient", model.rotational_drag_linear,
        model.rotational_drag_linear / model.inertia);
    if (!model.inner.absent()) {
        see("inner.damping", model.inner.damping,
            model.inner.damping * (1.0 / model.inner.mass + 1.0 / model.mass));
    }
    for (const Law& law : model.laws.laws()) {
        const auto of = [&](double plain) {
            return law.kind.acts == Acts::multiplies ? plain : 1.0;
        };
        const bool counts_time =
            law.kind.argument == Argument::time || law.kind.argument == Argument::age;
        const double reached = law.kind.argument == Argument::speed  ? speed
                               : law.kind.argument == Argument::rate ? swing_rate
                               : counts_time                         ? 1.0 / swing_rate
                                                                     : law.scale;
        switch (law.kind.quantity) {
            case Quantity::sliding_friction:
                see(law.key, law.stated,
                    of(model.friction.kinetic_coefficient) * law.steepest(speed) * load /
                        model.mass);
                break;
            case Quantity::drag:
            case Quantity::fluid:
                see(law.key, law.stated,
                    of(model.translational_drag) * law.largest(reached) / model.mass);
                break;
            case Quantity::rotational_drag:
                see(law.key, law.stated,
                    of(model.rotational_drag_linear) * law.largest(reached) / model.inertia);
                break;
            default:
                break;
        }
    }
    return fastest;
}

double pulse_rate(const Scenario& s) {
    if (s.drive.kind() == DriveKind::program) return 0.0;
    if (s.drive.kind() != DriveKind::none || is_alone(s)) return s.drive.frequency;
    return s.shake.absent() ? s.inner.drive.rate() : s.shake.rate();
}

double pulse_period(const Scenario& s) {
    const double rate = pulse_rate(s);
    return rate > 0.0 ? 1.0 / rate : 0.0;
}

Window measuring_window(const Scenario& s) {
    const Drive& drive = s.drive;
    if (drive.kind() == DriveKind::program) return {drive.latency, duration(s)};
    return {lead_in(drive) + static_cast<double>(settling_pulses(drive)) / pulse_rate(s),
            lead_in(drive) + pulsing_time(s)};
}

}  // namespace stickslip
