#include "stickslip/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <unordered_map>

#include "stickslip/number_text.hpp"

namespace stickslip {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

// The two accessors of a member, from one expression.
#define STICKSLIP_MEMBER(path)                                               \
    [](const Scenario& s) -> double { return static_cast<double>(s.path); }, \
        [](Scenario& s, double value) { s.path = static_cast<decltype(s.path)>(value); }

std::vector<Parameter> make_parameters() {
    constexpr bool kOpen = false, kClosed = true, kReal = false, kWhole = true;
    return {
        {"drive.frequency", "Hz", 1e-6, 1e5, kClosed, kReal, "pulses a second",
         STICKSLIP_MEMBER(drive.frequency)},
        {"drive.peak", "T", 0, 1, kClosed, kReal,
         "top of the sawtooth, as the field at the centre if its voltage were held for ever",
         STICKSLIP_MEMBER(drive.peak)},
        {"drive.base", "T", -1, 1, kClosed, kReal, "bottom of the sawtooth, same meaning",
         STICKSLIP_MEMBER(drive.base)},
        {"drive.hold", "T", 0, 1, kClosed, kReal, "field of the holding coil, same meaning",
         STICKSLIP_MEMBER(drive.hold)},
        {"drive.edge_time", "s", 0, kAny, kClosed, kReal, "duration of the sudden edge",
         STICKSLIP_MEMBER(drive.edge_time)},
        {"drive.ramp", "s", 0, 1e4, kClosed, kReal,
         "rise of both coils from zero before the first pulse", STICKSLIP_MEMBER(drive.ramp)},
        {"drive.pulses", "-", 1, 1e12, kClosed, kWhole, "number of pulses",
         STICKSLIP_MEMBER(drive.pulses)},
        {"drive.ramp_down", "s", 0, 1e4, kClosed, kReal,
         "fall of the in-plane coil to zero after the last pulse",
         STICKSLIP_MEMBER(drive.ramp_down)},
        {"coil.resistance", "ohm", 0, 1e9, kOpen, kReal, "resistance of one coil, Table I",
         STICKSLIP_MEMBER(coil.resistance)},
        {"coil.inductance", "H", 0, 1e3, kOpen, kReal, "inductance of one coil, Table I",
         STICKSLIP_MEMBER(coil.inductance)},
        {"coil.side", "m", 1e-6, 100, kClosed, kReal, "effective length of a coil's side, Table I",
         STICKSLIP_MEMBER(coil.geometry.side)},
        {"coil.distance", "m", 1e-3, 100, kClosed, kReal,
         "distance of each coil's plane from the centre, Table I",
         STICKSLIP_MEMBER(coil.geometry.distance)},
        {"coil.turns", "-", 1e-3, 1e6, kClosed, kReal, "turns of one coil, Table I",
         STICKSLIP_MEMBER(coil.geometry.turns)},
        {"robot.length", "m", 1e-6, 1e-2, kClosed, kReal,
         "length along the magnetization, Table II", STICKSLIP_MEMBER(robot.length)},
        {"robot.width", "m", 1e-6, 1e-2, kClosed, kReal,
         "width, across the plane of motion, Table II", STICKSLIP_MEMBER(robot.width)},
        {"robot.height", "m", 1e-6, 1e-2, kClosed, kReal, "height, Table II",
         STICKSLIP_MEMBER(robot.height)},
        {"robot.mass", "kg", 1e-18, 1, kClosed, kReal, "mass, Table II read as micrograms",
         STICKSLIP_MEMBER(robot.mass)},
        {"robot.magnetization", "A/m", 0, 1e7, kClosed, kReal,
         "magnetization along the length, Table II", STICKSLIP_MEMBER(robot.magnetization)},
        {"contact.static_friction", "-", 0, 100, kClosed, kReal,
         "Coulomb coefficient of a contact that sticks", STICKSLIP_MEMBER(contact.static_friction)},
        {"contact.kinetic_friction", "-", 0, 100, kClosed, kReal,
         "Coulomb coefficient of a contact that slips", STICKSLIP_MEMBER(contact.kinetic_friction)},
        {"contact.adhesion", "N", 0, 1, kClosed, kReal,
         "pull of the surface on the touching corners together",
         STICKSLIP_MEMBER(contact.adhesion)},
        {"contact.adhesion_range", "m", 0, 1e-2, kClosed, kReal,
         "gap at which adhesion has faded to nothing; 0: at contact only",
         STICKSLIP_MEMBER(contact.adhesion_range)},
        {"contact.restitution", "-", 0, 1, kClosed, kReal, "Newton restitution of a touch-down",
         STICKSLIP_MEMBER(contact.restitution)},
        {"drag.linear", "N s/m", 0, 1e3, kClosed, kReal,
         "drag force by velocity at the centre of mass, Eq. (18)", STICKSLIP_MEMBER(drag.linear)},
        {"drag.rotational", "N m s^2", 0, 1, kClosed, kReal,
         "drag torque by the square of the angular rate, Eq. (19)",
         STICKSLIP_MEMBER(drag.rotational)},
        {"environment.gravity", "m/s^2", 0, 1e3, kClosed, kReal, "acceleration of gravity",
         STICKSLIP_MEMBER(gravity)},
        {"solver.rtol", "-", 1e-13, 1e-2, kClosed, kReal,
         "local error a step, relative to the natural scales of the motion",
         STICKSLIP_MEMBER(solver.rtol)},
        {"solver.max_step", "s", 0, kAny, kClosed, kReal, "longest step; 0: no limit",
         STICKSLIP_MEMBER(solver.max_step)},
        {"solver.max_steps", "-", 1, 1e15, kClosed, kWhole,
         "most steps of a run; one that needs more ends with a status that says why",
         STICKSLIP_MEMBER(solver.max_steps)},
        {"effects.coil_heating.coefficient", "1/W", 0, 1000.0, kClosed, kReal,
         "growth of a coil's resistance by its mean power",
         STICKSLIP_MEMBER(effects.coil_heating_coefficient)},
        {"effects.amplifier_limit.voltage", "V", 0, 1000000.0, kClosed, kReal,
         "largest voltage that the amplifiers give; 0: no limit",
         STICKSLIP_MEMBER(effects.amplifier_limit_voltage)},
        {"effects.eddy_lag.time", "s", 0, 10, kClosed, kReal,
         "time constant with which the field follows the currents",
         STICKSLIP_MEMBER(effects.eddy_lag_time)},
        {"effects.sample_hold.period", "s", 0, 1, kClosed, kReal,
         "period over which the controller holds its output; 0: none",
         STICKSLIP_MEMBER(effects.sample_hold_period)},
        {"effects.edge_time.time", "s", 0, 1, kClosed, kReal,
         "duration of the sawtooth's sudden edge beyond drive.edge_time",
         STICKSLIP_MEMBER(effects.edge_time_time)},
        {"effects.mutual_inductance.coupling", "-", -0.9, 0.24, kClosed, kReal,
         "mutual over self inductance of each pair of coils",
         STICKSLIP_MEMBER(effects.mutual_inductance_coupling)},
        {"effects.gradient_scale.fraction", "-", -1, 10, kClosed, kReal,
         "part by which the field's gradient is larger than computed",
         STICKSLIP_MEMBER(effects.gradient_scale_fraction)},
        {"effects.field_gain.in_plane", "-", -1, 10, kClosed, kReal,
         "part by which the field of the in-plane coils is larger than computed",
         STICKSLIP_MEMBER(effects.field_gain_in_plane)},
        {"effects.field_gain.clamp", "-", -1, 10, kClosed, kReal,
         "part by which the field of the clamp coil is larger than computed",
         STICKSLIP_MEMBER(effects.field_gain_clamp)},
        {"effects.misalignment.angle", "rad", -3.2, 3.2, kClosed, kReal,
         "angle from the body's long axis to its moment, nose-down positive",
         STICKSLIP_MEMBER(effects.misalignment_angle)},
        {"effects.magnetization_scale.fraction", "-", -1, 10, kClosed, kReal,
         "part by which the moment is larger than stated",
         STICKSLIP_MEMBER(effects.magnetization_scale_fraction)},
        {"effects.ambient_field.Bx", "T", -0.1, 0.1, kClosed, kReal,
         "uniform field along +x of the world", STICKSLIP_MEMBER(effects.ambient_field_bx)},
        {"effects.ambient_field.Bz", "T", -0.1, 0.1, kClosed, kReal, "uniform field along +z",
         STICKSLIP_MEMBER(effects.ambient_field_bz)},
        {"effects.stribeck_friction.velocity", "m/s", 0, 100, kClosed, kReal,
         "v_s in: mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^2) while slipping",
         STICKSLIP_MEMBER(effects.stribeck_friction_velocity)},
        {"effects.viscous_friction.coefficient", "s/m", 0, 10000.0, kClosed, kReal,
         "growth of the kinetic coefficient by slip velocity",
         STICKSLIP_MEMBER(effects.viscous_friction_coefficient)},
        {"effects.friction_anisotropy.fraction", "-", -1, 1, kClosed, kReal,
         "part by which friction is higher for slip to the robot's front, and lower to its rear",
         STICKSLIP_MEMBER(effects.friction_anisotropy_fraction)},
        {"effects.angle_adhesion.strength", "-", -10, 1, kClosed, kReal,
         "k in: adhesion times (1 - k sin^2 theta)",
         STICKSLIP_MEMBER(effects.angle_adhesion_strength)},
        {"effects.adhesion_ageing.rate", "-", 0, 100, kClosed, kReal,
         "k in: adhesion times (1 + k ln(1 + age/time)), age since touch-down",
         STICKSLIP_MEMBER(effects.adhesion_ageing_rate)},
        {"effects.adhesion_ageing.time", "s", 1e-09, 10000.0, kClosed, kReal, "time in the same",
         STICKSLIP_MEMBER(effects.adhesion_ageing_time)},
        {"effects.restitution.coefficient", "-", 0, 1, kClosed, kReal,
         "restitution beyond contact.restitution",
         STICKSLIP_MEMBER(effects.restitution_coefficient)},
        {"effects.angle_drag.strength", "-", -0.99, 1000.0, kClosed, kReal,
         "k in: linear drag times (1 + k cos^2 theta)",
         STICKSLIP_MEMBER(effects.angle_drag_strength)},
        {"effects.quadratic_drag.coefficient", "N s^2/m^2", 0, 1000.0, kClosed, kReal,
         "drag force by the square of the velocity",
         STICKSLIP_MEMBER(effects.quadratic_drag_coefficient)},
        {"effects.rotational_drag.coefficient", "N m s", 0, 1, kClosed, kReal,
         "drag torque by angular rate", STICKSLIP_MEMBER(effects.rotational_drag_coefficient)},
        {"effects.surface_tilt.angle", "rad", -1.5, 1.5, kClosed, kReal,
         "tilt of the surface about y; positive: downhill towards +x of the world",
         STICKSLIP_MEMBER(effects.surface_tilt_angle)},
        {"effects.friction_patches.amplitude", "-", -1, 1, kClosed, kReal,
         "a in: friction times (1 + a sin(2 pi x / period)), x in the world of the touching "
         "corner, or of the middle of a face",
         STICKSLIP_MEMBER(effects.friction_patches_amplitude)},
        {"effects.friction_patches.period", "m", 1e-06, 1, kClosed, kReal, "period in the same",
         STICKSLIP_MEMBER(effects.friction_patches_period)},
        {"effects.length_scale.fraction", "-", -0.9, 10, kClosed, kReal,
         "part by which lengths are read too long",
         STICKSLIP_MEMBER(effects.length_scale_fraction)},
        {"effects.clock_scale.fraction", "-", -0.9, 10, kClosed, kReal,
         "part by which times are read too long", STICKSLIP_MEMBER(effects.clock_scale_fraction)},
        {"effects.angle_offset.angle", "rad", -3.2, 3.2, kClosed, kReal,
         "added to every angle that is read", STICKSLIP_MEMBER(effects.angle_offset_angle)},
    };
}

#undef STICKSLIP_MEMBER

template <class Enum>
std::string word(const char* key, Enum value) {
    const Choice* found = find_choice(key);
    return found->allowed[static_cast<std::size_t>(value)];
}

// The words stand in the order of the enumerators.
#define STICKSLIP_CHOICE(key, path)                      \
    [](const Scenario& s) { return word(key, s.path); }, \
        [](Scenario& s, std::size_t index) { s.path = static_cast<decltype(s.path)>(index); }

std::vector<Choice> make_choices() {
    return {
        {"drive.mode",
         {"IPP", "OPP", "program"},
         "which coil pulses, or voltages from a file",
         STICKSLIP_CHOICE("drive.mode", drive.mode)},
        {"drive.clamp",
         {"down", "up"},
         "sign of the clamp coil's field; down: B_z < 0, nose-down",
         STICKSLIP_CHOICE("drive.clamp", drive.clamp)},
        {"drive.edge",
         {"rise", "fall"},
         "where the sawtooth is sudden",
         STICKSLIP_CHOICE("drive.edge", drive.edge)},
        {"drive.direction",
         {"+x", "-x"},
         "where the robot faces and is driven",
         STICKSLIP_CHOICE("drive.direction", drive.direction)},
        {"solver.method",
         {"tsit5", "arkode"},
         "integrator",
         STICKSLIP_CHOICE("solver.method", solver.method)},
    };
}

#undef STICKSLIP_CHOICE

std::vector<EffectDescription> make_effects() {
    return {
        {"coil_heating",
         "warm coils have more resistance, so less current and a shorter time constant",
         "Ohm's law with a temperature coefficient"},
        {"amplifier_limit", "the amplifiers clip the voltage", "saturation of the output stage"},
        {"eddy_lag", "eddy currents delay the field behind the coil currents",
         "first-order lag of a conducting shell"},
        {"sample_hold", "the controller gives its voltages in steps",
         "control bandwidth of 1 kHz, section II"},
        {"edge_time", "the sudden edge of the sawtooth takes time", "slew rate of the amplifiers"},
        {"mutual_inductance", "the coils couple, so a pulse in one drives the others",
         "Eq. (1) with a full inductance matrix"},
        {"gradient_scale", "the field's gradient is not what the filament model gives",
         "Table I states 149 mT/m where the model gives 121"},
        {"field_gain", "the coils' fields are not what the filament model gives for their currents",
         "calibration of the amplifiers and windings"},
        {"misalignment", "the moment is not along the robot's long axis",
         "rotation of M in Eqs. (8)-(9); laser cutting, section III"},
        {"magnetization_scale", "the moment is not what the volume and the magnetization give",
         "demagnetization by laser heating, section III"},
        {"ambient_field", "a uniform field that no coil makes, such as the Earth's",
         "superposition in Eqs. (8)-(9)"},
        {"stribeck_friction",
         "friction falls from the static to the kinetic coefficient over a range of slip "
         "velocities",
         "Stribeck curve in the Gaussian form of Bo and Pavelescu (1982)"},
        {"viscous_friction", "friction grows with slip velocity", "Coulomb-viscous friction"},
        {"friction_anisotropy", "friction differs between slip to the front and to the rear",
         "direction-dependent Coulomb friction"},
        {"angle_adhesion", "adhesion falls as the robot stands up on an edge",
         "contact area of a tilted face"},
        {"adhesion_ageing", "adhesion grows while a contact lasts",
         "logarithmic ageing of capillary bridges"},
        {"restitution", "touch-downs rebound", "Newton's law of impact"},
        {"angle_drag", "the fluid's drag depends on the angle of the body",
         "suspected in section VI-C"},
        {"quadratic_drag", "drag grows with the square of the velocity", "form drag"},
        {"rotational_drag", "drag torque proportional to the angular rate",
         "Stokes drag, Eq. (19) in the limit of slow flow"},
        {"surface_tilt", "the surface is not level: a part of the weight acts along it",
         "rigid-body statics; cf. the tilted wafer of Eq. (15)"},
        {"friction_patches", "friction varies along the surface", "periodic Coulomb coefficient"},
        {"length_scale", "the camera's scale is off", "microns per pixel, section VII"},
        {"clock_scale", "the camera's clock is off", "frame rate"},
        {"angle_offset", "the camera is turned against the surface", "side view of section II"},
    };
}

std::string out_of_range(const Parameter& parameter, double value) {
    std::ostringstream text;
    text << parameter.key << " = " << digits(value) << ": allowed is " << allowed_range(parameter);
    return text.str();
}

void require_in_range(const Parameter& parameter, double value) {
    const bool above = parameter.low_allowed ? value >= parameter.low : value > parameter.low;
    const bool fits = std::isfinite(value) && above && value <= parameter.high &&
                      (!parameter.integer || value == std::floor(value));
    if (!fits) throw std::invalid_argument(out_of_range(parameter, value));
}

}  // namespace

const std::vector<Parameter>& parameters() {
    static const std::vector<Parameter> table = make_parameters();
    return table;
}

const std::vector<Choice>& choices() {
    static const std::vector<Choice> table = make_choices();
    return table;
}

const std::vector<EffectDescription>& effects() {
    static const std::vector<EffectDescription> table = make_effects();
    return table;
}

const Parameter* find_parameter(std::string_view key) {
    static const auto index = [] {
        std::unordered_map<std::string_view, const Parameter*> map;
        for (const Parameter& parameter : parameters()) map.emplace(parameter.key, &parameter);
        return map;
    }();
    const auto found = index.find(key);
    return found == index.end() ? nullptr : found->second;
}

const Choice* find_choice(std::string_view key) {
    for (const Choice& choice : choices()) {
        if (key == choice.key) return &choice;
    }
    return nullptr;
}

Parameter row_of(const std::string& key, const UserParameter& parameter) {
    return {key.c_str(), parameter.unit.c_str(),    parameter.low, parameter.high, true,
            false,       parameter.meaning.c_str(), nullptr,       nullptr};
}

std::string allowed_range(const Parameter& parameter) {
    std::ostringstream text;
    const bool has_unit = std::string_view(parameter.unit) != "-";
    text << (parameter.integer ? "a whole number" : "a number");
    text << (parameter.low_allowed ? " from " : " above ") << lowest(parameter.low);
    const bool bounded = std::isfinite(parameter.high);
    if (bounded) text << (parameter.low_allowed ? " to " : " up to ") << highest(parameter.high);
    if (has_unit) text << " " << parameter.unit;
    if (!bounded) text << " upwards";
    return text.str();
}

void set_parameter(Scenario& scenario, std::string_view key, double value) {
    if (const Parameter* parameter = find_parameter(key)) {
        require_in_range(*parameter, value);
        parameter->set(scenario, value);
        return;
    }
    const std::optional<UserKey> own = find_user_key(key);
    if (!own) throw std::invalid_argument(std::string(key) + ": there is no such numeric key");
    set_parameter(scenario, *own, value);
}

void set_parameter(Scenario& scenario, const UserKey& key, double value) {
    const std::string name = key.effect->key(key.parameter);
    require_in_range(row_of(name, key.effect->parameters[key.parameter]), value);
    // In the order of the names: the sum of two forces must not depend on which was set first.
    std::vector<UserSetting>& all = scenario.user_effects;
    auto place = std::find_if(all.begin(), all.end(), [&](const UserSetting& each) {
        return each.effect->name >= key.effect->name;
    });
    if (place == all.end() || place->effect->name != key.effect->name) {
        place = all.insert(place, UserSetting{});
    }
    if (place->effect != key.effect) {
        place->effect = key.effect;
        place->values.clear();
        for (const UserParameter& each : key.effect->parameters) {
            place->values.push_back(each.absent);
        }
    }
    place->values[key.parameter] = value;
}

void set_choice(Scenario& scenario, std::string_view key, std::string_view value) {
    const Choice* choice = find_choice(key);
    if (choice == nullptr) {
        throw std::invalid_argument(std::string(key) + ": there is no such key");
    }
    std::string allowed;
    for (std::size_t i = 0; i < choice->allowed.size(); ++i) {
        if (choice->allowed[i] == value) {
            choice->set(scenario, i);
            return;
        }
        allowed += (i ? ", \"" : "\"") + choice->allowed[i] + "\"";
    }
    throw std::invalid_argument(std::string(key) + " = \"" + std::string(value) +
                                "\": allowed is one of " + allowed);
}

}  // namespace stickslip
