#include "stickslip/scenario/parameters.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/free_shapes.hpp"
#include "stickslip/scenario/named_laws.hpp"

namespace stickslip {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

// A number of the state that a scenario begins with.
template <std::size_t K>
void add_state(std::vector<Parameter>& rows) {
    constexpr StateColumn column = kStateColumns[K];
    if (K == kContactColumn) return;  // it has words
    static const std::string key = "initial." + std::string(column.name);
    rows.push_back(
        {.key = key.c_str(),
         .unit = column.unit,
         .low = column.low,
         .high = column.high,
         .meaning = column.meaning,
         .get = [](const Scenario& s) { return kStateColumns[K].get(s.initial); },
         .set = [](Scenario& s, double value) { kStateColumns[K].set(s.initial, value); }});
}

// A table: clang-format would give each member of a row a line of its own.
// clang-format off
// The two accessors of a member, from one expression.
#define STICKSLIP_MEMBER(path)                                                      \
    .get = [](const Scenario& s) -> double { return static_cast<double>(s.path); }, \
    .set = [](Scenario& s, double value) { s.path = static_cast<decltype(s.path)>(value); }

// A harmonic of the shake.
#define STICKSLIP_HARMONIC(number, axis, member)                                                \
    {.key = "shake.harmonic_" number "_" axis, .unit = "-", .low = -10, .high = 10,             \
     .meaning = "amplitude of harmonic " number " of " axis " over that of the first",          \
     STICKSLIP_MEMBER(shake.member.part)},                                                      \
    {.key = "shake.phase_" number "_" axis, .unit = "rad", .low = -6.3, .high = 6.3,            \
     .meaning = "phase of its sine at t = 0", STICKSLIP_MEMBER(shake.member.phase)}

#define STICKSLIP_INNER(number, member)                                                         \
    {.key = "inner.harmonic_" number, .unit = "-", .low = -10, .high = 10,                      \
     .meaning = "amplitude of harmonic " number " over that of the first",                      \
     STICKSLIP_MEMBER(inner.drive.member.part)},                                                \
    {.key = "inner.phase_" number, .unit = "rad", .low = -6.3, .high = 6.3,                     \
     .meaning = "phase of its sine at t = 0", STICKSLIP_MEMBER(inner.drive.member.phase)}

std::vector<Parameter> make_parameters() {
    return {
        {.key = "drive.frequency", .unit = "Hz", .low = 1e-6, .high = 1e5,
         .meaning = "pulses a second", STICKSLIP_MEMBER(drive.frequency)},
        {.key = "drive.peak", .unit = "T", .low = 0, .high = 1,
         .meaning = "top of the sawtooth, as the field at the centre if its voltage were held for "
                    "ever", STICKSLIP_MEMBER(drive.peak)},
        {.key = "drive.base", .unit = "T", .low = -1, .high = 1,
         .meaning = "bottom of the sawtooth, same meaning", STICKSLIP_MEMBER(drive.base)},
        {.key = "drive.hold", .unit = "T", .low = 0, .high = 1,
         .meaning = "field of the holding coil, same meaning", STICKSLIP_MEMBER(drive.hold)},
        {.key = "drive.edge_time", .unit = "s", .low = 0, .high = kAny,
         .meaning = "duration of the sudden edge", STICKSLIP_MEMBER(drive.edge_time)},
        {.key = "drive.heading", .unit = "rad", .low = -6.3, .high = 6.3,
         .meaning = "where the robot is driven, from drive.direction to the left; a program has none, "
                    "and no choice of drive.coils",
         STICKSLIP_MEMBER(drive.heading)},
        {.key = "drive.ramp", .unit = "s", .low = 0, .high = 1e4,
         .meaning = "rise of both coils from zero before the first pulse",
         STICKSLIP_MEMBER(drive.ramp)},
        {.key = "drive.pulses", .unit = "-", .low = 1, .high = 1e12, .integer = true,
         .meaning = "number of pulses", STICKSLIP_MEMBER(drive.pulses)},
        {.key = "drive.ramp_down", .unit = "s", .low = 0, .high = 1e4,
         .meaning = "fall of the in-plane coil to zero after the last pulse",
         STICKSLIP_MEMBER(drive.ramp_down)},
        {.key = "drive.latency", .unit = "s", .low = 0, .high = 10,
         .meaning = "time by which the coils get all voltages late, and none before the first; a "
                    "run is longer by it", STICKSLIP_MEMBER(drive.latency)},
        {.key = "robot.length", .unit = "m", .low = 1e-6, .high = 0.2,
         .meaning = "length along the magnetization, Table II", STICKSLIP_MEMBER(robot.length)},
        {.key = "robot.width", .unit = "m", .low = 1e-6, .high = 0.2,
         .meaning = "width, across the plane of motion, Table II", STICKSLIP_MEMBER(robot.width)},
        {.key = "robot.height", .unit = "m", .low = 1e-6, .high = 0.2,
         .meaning = "height, Table II", STICKSLIP_MEMBER(robot.height)},
        {.key = "robot.mass", .unit = "kg", .low = 1e-18, .high = 1,
         .meaning = "mass, Table II read as micrograms", STICKSLIP_MEMBER(robot.mass)},
        {.key = "robot.magnetization", .unit = "A/m", .low = 0, .high = 1e7,
         .meaning = "magnetization along the length, Table II",
         STICKSLIP_MEMBER(robot.magnetization)},
        {.key = "contact.static_friction", .unit = "-", .low = 0, .high = 100,
         .meaning = "Coulomb coefficient of a contact that sticks",
         STICKSLIP_MEMBER(contact.static_friction)},
        {.key = "contact.kinetic_friction", .unit = "-", .low = 0, .high = 100,
         .meaning = "Coulomb coefficient of a contact that slips",
         STICKSLIP_MEMBER(contact.kinetic_friction)},
        {.key = "contact.adhesion", .unit = "N", .low = 0, .high = 1,
         .meaning = "pull of the surface on the touching corners together",
         STICKSLIP_MEMBER(contact.adhesion)},
        {.key = "contact.restitution", .unit = "-", .low = 0, .high = 1,
         .meaning = "Newton restitution of a touch-down", STICKSLIP_MEMBER(contact.restitution)},
        {.key = "contact.tangential_restitution", .unit = "-", .low = 0, .high = 1,
         .meaning = "part of its slip that a corner which rebounds reverses, as far as friction "
                    "can; what the surfaces' tangential elasticity gives back (Walton, 1993)",
         STICKSLIP_MEMBER(contact.tangential_restitution)},
        {.key = "drag.linear", .unit = "N s/m", .low = 0, .high = 1e3,
         .meaning = "drag force by velocity at the centre of mass, Eq. (18)",
         STICKSLIP_MEMBER(drag.linear)},
        {.key = "drag.rotational", .unit = "N m s^2", .low = 0, .high = 1,
         .meaning = "drag torque by the square of the angular rate, Eq. (19)",
         STICKSLIP_MEMBER(drag.rotational)},
        {.key = "environment.gravity", .unit = "m/s^2", .low = 0, .high = 1e3,
         .meaning = "acceleration of gravity", STICKSLIP_MEMBER(gravity)},
        {.key = "shake.frequency", .unit = "Hz", .low = 1e-3, .high = 1e7,
         .meaning = "frequency of the first harmonic", STICKSLIP_MEMBER(shake.frequency)},
        {.key = "shake.amplitude_x", .unit = "m", .low = -1, .high = 1,
         .meaning = "amplitude along +x of the world, a sine from t = 0 on",
         STICKSLIP_MEMBER(shake.amplitude_x)},
        {.key = "shake.amplitude_z", .unit = "m", .low = -1, .high = 1,
         .meaning = "the same away from the surface", STICKSLIP_MEMBER(shake.amplitude_z)},
        {.key = "shake.phase", .unit = "rad", .low = -6.3, .high = 6.3,
         .meaning = "by which the sine of z is ahead of that of x", STICKSLIP_MEMBER(shake.phase)},
        STICKSLIP_HARMONIC("2", "x", harmonics_x[0]), STICKSLIP_HARMONIC("3", "x", harmonics_x[1]),
        STICKSLIP_HARMONIC("4", "x", harmonics_x[2]), STICKSLIP_HARMONIC("2", "z", harmonics_z[0]),
        STICKSLIP_HARMONIC("3", "z", harmonics_z[1]), STICKSLIP_HARMONIC("4", "z", harmonics_z[2]),
        {.key = "inner.mass", .unit = "kg", .low = 0, .high = 1,
         .meaning = "mass that moves in the body, beside robot.mass; 0: there is none",
         STICKSLIP_MEMBER(inner.mass)},
        {.key = "inner.stiffness", .unit = "N/m", .low = 0, .high = 1e9,
         .meaning = "of its spring, which is at rest in the middle of the body",
         STICKSLIP_MEMBER(inner.stiffness)},
        {.key = "inner.damping", .unit = "N s/m", .low = 0, .high = 1e6,
         .meaning = "of its damper, by its velocity in the body", STICKSLIP_MEMBER(inner.damping)},
        {.key = "inner.direction", .unit = "rad", .low = -6.3, .high = 6.3,
         .meaning = "angle from the body's long axis to its line, nose-down positive",
         STICKSLIP_MEMBER(inner.direction)},
        {.key = "inner.stop_low", .unit = "m", .low = -10, .high = 0,
         .meaning = "place of the stop behind, beside that at rest", STICKSLIP_MEMBER(inner.low)},
        {.key = "inner.stop_high", .unit = "m", .low = 0, .high = 10,
         .meaning = "the same ahead", STICKSLIP_MEMBER(inner.high)},
        {.key = "inner.restitution", .unit = "-", .low = 0, .high = 1,
         .meaning = "Newton restitution of an impact on a stop",
         STICKSLIP_MEMBER(inner.restitution)},
        {.key = "inner.amplitude", .unit = "N", .low = -1e6, .high = 1e6,
         .meaning = "amplitude of the force on the mass, which the body has the other way",
         STICKSLIP_MEMBER(inner.drive.amplitude)},
        {.key = "inner.frequency", .unit = "Hz", .low = 1e-3, .high = 1e7,
         .meaning = "frequency of that force", STICKSLIP_MEMBER(inner.drive.frequency)},
        {.key = "inner.phase", .unit = "rad", .low = -6.3, .high = 6.3,
         .meaning = "phase of its sine, or of its pulses, at t = 0",
         STICKSLIP_MEMBER(inner.drive.phase)},
        STICKSLIP_INNER("2", harmonics[0]), STICKSLIP_INNER("3", harmonics[1]),
        STICKSLIP_INNER("4", harmonics[2]),
        {.key = "inner.duty", .unit = "-", .low = 0, .high = 1,
         .meaning = "part of each period in which the whole amplitude acts, and none in the rest; "
                    "0: sines", STICKSLIP_MEMBER(inner.drive.duty)},
        {.key = "solver.rtol", .unit = "-", .low = 1e-13, .high = 1e-2,
         .meaning = "local error a step, relative to the natural scales of the motion; tightened "
                    "where the linear drag is low",
         STICKSLIP_MEMBER(solver.rtol)},
        {.key = "solver.max_step", .unit = "s", .low = 0, .high = kAny,
         .meaning = "longest step; 0: no limit", STICKSLIP_MEMBER(solver.max_step)},
        {.key = "solver.max_steps", .unit = "-", .low = 1, .high = 1e15, .integer = true,
         .meaning = "most steps of a run; one that needs more ends with a status that says why",
         STICKSLIP_MEMBER(solver.max_steps)},
        {.key = "record.rate", .unit = "Hz", .low = 0, .high = kAny, .low_allowed = false,
         .meaning = "rate of a uniform grid of samples, or a sample at each event of the contact, "
                    "or none",
         .get = [](const Scenario& s) { return s.record.rate; },
         .set = [](Scenario& s, double value) {
             s.record.kind = RecordKind::uniform;
             s.record.rate = value;
         }},
        {.key = "record.from", .unit = "s", .low = 0, .high = kAny,
         .meaning = "simulated time before which nothing is recorded",
         STICKSLIP_MEMBER(record.from)},
    };
}

std::vector<Parameter> make_effect_parameters() {
    return {
        {.key = "effects.coil_heating.coefficient", .unit = "1/W", .low = 0, .high = 1000,
         .meaning = "growth of a coil's resistance by its mean power",
         STICKSLIP_MEMBER(effects.coil_heating_coefficient)},
        {.key = "effects.amplifier_limit.voltage", .unit = "V", .low = 0, .high = 1e6,
         .meaning = "largest voltage that the amplifiers give; 0: no limit",
         STICKSLIP_MEMBER(effects.amplifier_limit_voltage)},
        {.key = "effects.eddy_lag.time", .unit = "s", .low = 0, .high = 10,
         .meaning = "time constant with which the field follows the currents",
         STICKSLIP_MEMBER(effects.eddy_lag_time)},
        {.key = "effects.sample_hold.period", .unit = "s", .low = 0, .high = 1,
         .meaning = "period over which the controller holds its output; 0: none",
         STICKSLIP_MEMBER(effects.sample_hold_period)},
        {.key = "effects.mutual_inductance.coupling", .unit = "-", .low = -0.9, .high = 0.24,
         .meaning = "mutual over self inductance of each pair of coils",
         STICKSLIP_MEMBER(effects.mutual_inductance_coupling)},
        {.key = "effects.gradient_scale.fraction", .unit = "-", .low = -1, .high = 10,
         .meaning = "part by which the field's gradient is larger than computed",
         STICKSLIP_MEMBER(effects.gradient_scale_fraction)},
        {.key = "effects.field_gain.in_plane", .unit = "-", .low = -1, .high = 10,
         .meaning = "part by which the field of the in-plane coils is larger than computed",
         STICKSLIP_MEMBER(effects.field_gain_in_plane)},
        {.key = "effects.field_gain.clamp", .unit = "-", .low = -1, .high = 10,
         .meaning = "part by which the field of the clamp coil is larger than computed",
         STICKSLIP_MEMBER(effects.field_gain_clamp)},
        {.key = "effects.misalignment.angle", .unit = "rad", .low = -3.2, .high = 3.2,
         .meaning = "angle from the body's long axis to its moment, nose-down positive",
         STICKSLIP_MEMBER(effects.misalignment_angle)},
        {.key = "effects.ambient_field.Bx", .unit = "T", .low = -0.1, .high = 0.1,
         .meaning = "uniform field along +x of the world",
         STICKSLIP_MEMBER(effects.ambient_field_bx)},
        {.key = "effects.ambient_field.Bz", .unit = "T", .low = -0.1, .high = 0.1,
         .meaning = "uniform field along +z", STICKSLIP_MEMBER(effects.ambient_field_bz)},
        {.key = "effects.ambient_field.By", .unit = "T", .low = -0.1, .high = 0.1,
         .meaning = "uniform field along +y of the world",
         STICKSLIP_MEMBER(effects.ambient_field_by)},
        {.key = "effects.rotational_drag.coefficient", .unit = "N m s", .low = 0, .high = 1,
         .meaning = "drag torque by angular rate",
         STICKSLIP_MEMBER(effects.rotational_drag_coefficient)},
        {.key = "effects.surface_tilt.angle", .unit = "rad", .low = -1.5, .high = 1.5,
         .meaning = "tilt of the surface; positive: downhill towards +x of the world, or towards "
                    "the azimuth",
         STICKSLIP_MEMBER(effects.surface_tilt_angle)},
        {.key = "effects.surface_tilt.azimuth", .unit = "rad", .low = -6.3, .high = 6.3,
         .meaning = "from +x of the world to the way that is downhill",
         STICKSLIP_MEMBER(effects.surface_tilt_azimuth)},
    };
}

#undef STICKSLIP_INNER
#undef STICKSLIP_HARMONIC
#undef STICKSLIP_MEMBER

std::vector<Parameter> all_parameters() {
    std::vector<Parameter> rows = make_parameters();
    [&]<std::size_t... K>(std::index_sequence<K...>) {
        (add_state<K>(rows), ...);
    }(std::make_index_sequence<kStateColumns.size()>());
    for (const Parameter& row : make_effect_parameters()) rows.push_back(row);
    return rows;
}

template <class Rows>
std::vector<std::string> names_of(const Rows& rows, std::vector<std::string> before = {}) {
    for (const auto& row : rows) before.emplace_back(row.name);
    return before;
}

// The kept columns, or all of them as one word; t is always kept.
std::string recorded(const Scenario& s) {
    if (s.record.dropped.none()) return "all";
    std::string text;
    for (std::size_t k = 1; k < kColumns; ++k) {
        if (s.record.dropped[k]) continue;
        text += (text.empty() ? "" : ", ") + std::string(kRecordColumns[k].name);
    }
    return text.empty() ? std::string(kRecordColumns[0].name) : text;
}

void set_recorded(Scenario& s, const std::vector<std::size_t>& words) {
    s.record.dropped.reset();
    if (std::find(words.begin(), words.end(), 0) != words.end()) return;  // all
    s.record.dropped.set();
    s.record.dropped[0] = false;
    for (const std::size_t word : words) s.record.dropped[word - 1] = false;
}

template <class Enum>
std::string word(const char* key, Enum value) {
    return find_choice(key)->allowed[static_cast<std::size_t>(value)];
}

// The words stand in the order of the enumerators.
#define STICKSLIP_CHOICE(key, path)                             \
    .get = [](const Scenario& s) { return word(key, s.path); }, \
    .set = [](Scenario& s, std::size_t index) { s.path = static_cast<decltype(s.path)>(index); }

// A program has no use for the keys of the sawtooth.
void set_mode(Scenario& s, std::size_t index) {
    const auto mode = static_cast<DriveMode>(index);
    const Drive before = s.drive;
    const DriveKind kind = kind_of(mode);
    if (kind != DriveKind::sawtooth && before.mode != mode) s.drive = {};
    if (kind == DriveKind::program) s.drive.latency = before.latency;
    if (kind == DriveKind::none) s.drive.pulses = before.pulses;
    s.drive.mode = mode;
    s.drive.direction = before.direction;
}

std::vector<Choice> make_choices() {
    return {
        {.key = "drive.mode", .allowed = {"IPP", "OPP", "program", "none"},
         .meaning = "in-plane pulsing, where the clamp coil holds; out-of-plane pulsing, the "
                    "reverse; or voltages from a file, with which all other keys but "
                    "drive.direction and drive.latency have their defaults; or no voltage, with "
                    "which drive.pulses counts periods of the shake, or of drive.frequency",
         .get = [](const Scenario& s) { return word("drive.mode", s.drive.mode); },
         .set = &set_mode},
        {.key = "drive.clamp", .allowed = {"down", "up"},
         .meaning = "sign of the clamp coil's field; down: B_z < 0, nose-down",
         STICKSLIP_CHOICE("drive.clamp", drive.clamp)},
        {.key = "drive.edge", .allowed = {"rise", "fall"},
         .meaning = "where the sawtooth is sudden", STICKSLIP_CHOICE("drive.edge", drive.edge)},
        {.key = "drive.direction", .allowed = {"+x", "-x"},
         .meaning = "where the robot faces and is driven; -x: rotated by 180 degrees about z, and a "
                    "pulsed drive with it, but not the voltages of a program",
         STICKSLIP_CHOICE("drive.direction", drive.direction)},
        {.key = "drive.coils", .allowed = {"single", "pairs"},
         .meaning = "which coils of an axis make its part of the field in the surface: the one "
                    "ahead, or both alike", STICKSLIP_CHOICE("drive.coils", drive.coils)},
        {.key = "shake.liquid", .allowed = {"moves", "rests"},
         .meaning = "whether the liquid goes along with the surface or rests in the ground's frame; "
                    "the drag is against it", STICKSLIP_CHOICE("shake.liquid", shake.liquid)},
        {.key = "initial.contact", .allowed = names_of(kContactWords),
         .meaning = "mode of the contact at the start; from_motion: what touches is what lies on "
                    "the surface and does not leave it",
         STICKSLIP_CHOICE("initial.contact", initial.contact)},
        {.key = "solver.method", .allowed = {"tsit5", "arkode"}, .meaning = "own Runge-Kutta method of fifth order, or that of SUNDIALS, where the build has it",
         STICKSLIP_CHOICE("solver.method", solver.method)},
        {.key = "record.rate", .allowed = {"none", "events"},
         .meaning = "",
         .get = [](const Scenario& s) -> std::string {
             constexpr std::array kWords = {"none", "events", ""};
             return kWords[static_cast<std::size_t>(s.record.kind)];
         },
         .set = [](Scenario& s, std::size_t index) {
             s.record.kind = static_cast<RecordKind>(index);
             s.record.rate = 0.0;
         }},
        {.key = "record.fields", .allowed = names_of(kRecordColumns, {"all"}),
         .meaning = "recorded quantities, with commas between them; t is always there",
         .get = &recorded, .set_some = &set_recorded},
        {.key = "record.dtype", .allowed = {"float64", "float32"},
         .meaning = "precision of the recorded numbers; t always has float64, as in float32 the "
                    "samples of a run of some minutes would share times",
         STICKSLIP_CHOICE("record.dtype", record.dtype)},
        {.key = "record.pull_share", .allowed = {"no", "yes"},
         .meaning = "whether the summary has pull_share, for which every step is looked at",
         STICKSLIP_CHOICE("record.pull_share", record.pull_share)},
    };
}

#undef STICKSLIP_CHOICE

std::vector<Section> make_sections() {
    return {
        {"drive",
         "What the coils are driven with, section V of the paper.\n"
         "\n"
         "A field given in tesla is the steady-state one of one coil, at the centre. The paper\n"
         "gives the default of `peak` (Figs. 4-13) and uses 100 Hz in Figs. 8-11. It states\n"
         "neither `base`, `hold`, `edge` nor `clamp`: their defaults are this package's, as are\n"
         "those of all other keys."},
        {"coil",
         "The five coils, Table I.\n"
         "\n"
         "Where coils differ, `resistance` and its like are those of coils without own values."},
        {"robot",
         "The magnetic body, Table II.\n"
         "\n"
         "Table II's \"ng\" are micrograms: the body's density leaves no other reading."},
        {"contact", "Contact of the body with the surface, sections IV-C, VI-A and VI-B."},
        {"drag", "Drag of the fluid, section VI-C."},
        {"environment", "What is the same for everything."},
        {"shake",
         "Motion of the surface, seen from the ground; still by default.\n"
         "\n"
         "Up to four sines along each axis. The place of the surface counts from t = 0, when a\n"
         "robot at rest moves with it. What is recorded and measured is in the ground's frame,\n"
         "slip and states are against the surface."},
        {"inner",
         "A mass within the body, on a spring and a damper along a line through its centre.\n"
         "\n"
         "A force between both drives it. It rebounds from stops. Across its line the mass has\n"
         "weight, and no inertia of its own. Where it begins is in `initial`; by default at rest in\n"
         "the middle."},
        {"initial",
         "Robot and coils at an instant, in the world's frame.\n"
         "\n"
         "A scenario begins at one, by default at rest and without current, and every run and step\n"
         "ends at one."},
        {"solver", "The integrator."},
        {"record", "What a run keeps beside its summary."},
    };
}

std::vector<EffectDescription> make_effects() {
    return {
        {.name = "coil_heating",
         .meaning = "warm coils have more resistance, so less current and a shorter time constant",
         .source = "Ohm's law with a temperature coefficient"},
        {.name = "amplifier_limit", .meaning = "the amplifiers clip the voltage",
         .source = "saturation of the output stage"},
        {.name = "eddy_lag", .meaning = "eddy currents delay the field behind the coil currents",
         .source = "first-order lag of a conducting shell"},
        {.name = "sample_hold", .meaning = "the controller gives its voltages in steps",
         .source = "control bandwidth of 1 kHz, section II"},
        {.name = "mutual_inductance",
         .meaning = "the coils couple, so a pulse in one drives the others",
         .source = "Eq. (1) with a full inductance matrix"},
        {.name = "gradient_scale",
         .meaning = "the field's gradient is not what the filament model gives",
         .source = "Table I states 149 mT/m where the model gives 121"},
        {.name = "field_gain",
         .meaning = "the coils' fields are not what the filament model gives for their currents",
         .source = "calibration of the amplifiers and windings"},
        {.name = "misalignment", .meaning = "the moment is not along the robot's long axis",
         .source = "rotation of M in Eqs. (8)-(9); laser cutting, section III"},
        {.name = "ambient_field",
         .meaning = "a uniform field that no coil makes, such as the Earth's",
         .source = "superposition in Eqs. (8)-(9)"},
        {.name = "rotational_drag", .meaning = "drag torque proportional to the angular rate",
         .source = "Stokes drag, Eq. (19) in the limit of slow flow"},
        {.name = "surface_tilt",
         .meaning = "the surface is not level: a part of the weight acts along it",
         .source = "rigid-body statics; cf. the tilted wafer of Eq. (15)"},
    };
}

// clang-format on

}  // namespace

const std::vector<Parameter>& parameters() {
    static const std::vector<Parameter> table = [] {
        std::vector<Parameter> rows = all_parameters();
        const std::vector<Parameter> coils = coil_rows();
        const auto robot = std::find_if(rows.begin(), rows.end(), [](const Parameter& row) {
            return std::string_view(row.key).starts_with("robot.");
        });
        rows.insert(robot, coils.begin(), coils.end());
        return with_free_shapes(with_named_laws(std::move(rows)));
    }();
    return table;
}

const std::vector<Section>& sections() {
    static const std::vector<Section> table = make_sections();
    return table;
}

const std::vector<Choice>& choices() {
    static const std::vector<Choice> table = make_choices();
    return table;
}

const std::vector<EffectDescription>& effects() {
    static const std::vector<EffectDescription> table =
        with_free_shapes(with_named_laws(make_effects()));
    return table;
}

}  // namespace stickslip
