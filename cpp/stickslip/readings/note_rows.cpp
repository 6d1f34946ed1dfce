#include "stickslip/readings/note_rows.hpp"

#include <algorithm>
#include <numbers>

namespace stickslip {
namespace {

const Scenario& usual() {
    static const Scenario scenario;
    return scenario;
}

NoteTrial with_field(const NoteFacts& f, double factor) {
    const Drive& drive = f.s.drive;
    if (f.program()) return {.voltages = factor};
    // At no base the holding coil alone turns it upright.
    const double peak = factor * drive.peak, base = factor * drive.base;
    return {.settings = {{"drive.peak", peak},
                         {"drive.base", base != 0.0 ? base : 0.2 * peak},
                         {"drive.hold", factor * drive.hold}}};
}

NoteTrial with_friction(double kinetic, double resting) {  // that first: it may not be the larger
    return {
        .settings = {{"contact.kinetic_friction", kinetic}, {"contact.static_friction", resting}}};
}

NoteTrial with_drag(double linear, double rotational) {
    return {.settings = {{"drag.linear", linear}, {"drag.rotational", rotational}}};
}

const char* without_pull(const NoteFacts& f) {
    if (f.program()) return "drive opposite coils with the same current";
    if (f.s.drive.coils == DriveCoils::pairs) return "work nearer to the centre";
    return "set {drive.coils=pairs} for the walk alone";
}

}  // namespace

// A table: clang-format would give each member of a row a line of its own.
// clang-format off
#define STICKSLIP_OF_FACTS(type, ...) \
    []([[maybe_unused]] const NoteFacts& f) -> type { return __VA_ARGS__; }
#define STICKSLIP_IF(...) STICKSLIP_OF_FACTS(bool, __VA_ARGS__)
#define STICKSLIP_TRY(...) STICKSLIP_OF_FACTS(std::vector<NoteTrial>, {__VA_ARGS__})
#define STICKSLIP_ADVICE(...) STICKSLIP_OF_FACTS(const char*, __VA_ARGS__)
#define STICKSLIP_REST "the robot stays in its place: "

const std::vector<NoteRow>& note_rows() {
    static const std::vector<NoteRow> rows = {
        {.code = "window-cut", .value = "simulated_time",
         .when = STICKSLIP_IF(f.cut && f.measured() < f.window_duration()),
         .text = "the run was ended by its condition at {simulated_time:s:6}: {advice}",
         .advice = STICKSLIP_ADVICE(f.measured() <= 0.0
             ? "before the measuring window, so that nothing is measured"
             : "velocity and angles are measured over {measured::4} of the {window_duration:s:4} "
               "of the measuring window only")},

        // A robot at rest. A constant that is far beyond published robots is tried before what is
        // more usual.
        {.code = "rest-no-field", .value = "field_max", .first_of = "rest",
         .when = STICKSLIP_IF(f.rests() && f.run.field_max <= 0.0),
         .text = STICKSLIP_REST "there is no field; {advice}",
         .advice = STICKSLIP_ADVICE(f.program() ? "give voltages"
                                                : "set {drive.peak} and {drive.hold}")},
        {.code = "rest-no-moment", .value = "moment", .first_of = "rest",
         .when = STICKSLIP_IF(f.rests() && f.moment() <= 0.0),
         .text = STICKSLIP_REST "it has no magnetic moment, which no field moves; set "
                 "{robot.magnetization}"},
        {.code = "rest-drag", .value = "drag.linear", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.s.drag.linear > 100.0 * usual().drag.linear),
         .trials = STICKSLIP_TRY(with_drag(usual().drag.linear, usual().drag.rotational)),
         .text = STICKSLIP_REST "{drag.linear=} is far above the default, with which it walks"},
        {.code = "rest-drag", .value = "drag.rotational", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.s.drag.rotational > 100.0 * usual().drag.rotational),
         .trials = STICKSLIP_TRY(with_drag(usual().drag.linear, usual().drag.rotational)),
         .text = STICKSLIP_REST "{drag.rotational=} is far above the default, with which it walks"},
        {.code = "rest-friction", .value = "contact.static_friction", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.s.contact.static_friction >
                                               10.0 * usual().contact.static_friction),
         .trials = STICKSLIP_TRY(with_friction(usual().contact.kinetic_friction,
                                               usual().contact.static_friction)),
         .text = STICKSLIP_REST "{contact.static_friction=} is far above the default, with which "
                 "it walks"},
        {.code = "rest-adhesion", .value = "contact.adhesion", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.s.contact.adhesion > 10.0 * usual().contact.adhesion),
         .trials = STICKSLIP_TRY({{{"contact.adhesion", usual().contact.adhesion}}}),
         .text = STICKSLIP_REST "{contact.adhesion=} holds the edge against every stroke; it walks "
                 "with {set}"},
        {.code = "rest-torque", .value = "torque", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() &&
                              f.s.robot.magnetization < 0.05 * usual().robot.magnetization),
         .trials = STICKSLIP_TRY({{{"robot.magnetization", usual().robot.magnetization}}}),
         .text = STICKSLIP_REST "the magnet is too weak: the field turns it with at most "
                 "{torque:nN m}, and weight and adhesion hold it with {held_torque:nN m}; it walks "
                 "with {set}"},
        // A field that is too weak by more than a thousand is not what is meant.
        {.code = "rest-torque", .value = "torque", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.torque() > 1e-3 * f.held_torque() &&
                              f.torque() < 2.0 * f.held_torque()),
         .trials = STICKSLIP_TRY(with_field(f, 2.0 * f.tipping()),
                                 with_field(f, 20.0 * f.tipping()),
                                 with_field(f, 200.0 * f.tipping())),
         .text = STICKSLIP_REST "the field, {field_max:mT} at most, turns it with at most "
                 "{torque:nN m}, and weight and adhesion hold it with {held_torque:nN m}; it walks "
                 "with {set}"},
        {.code = "rest-torque", .value = "torque", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.sawtooth() && f.s.drive.hold < 0.4 * f.s.drive.peak),
         .trials = STICKSLIP_TRY({{{"drive.hold", 0.4 * f.s.drive.peak}}}),
         .text = STICKSLIP_REST "with {drive.hold=} the pulses change the size of the field and "
                 "hardly its direction, and do not rock the magnet; it walks with {set}"},
        {.code = "rest-torque", .value = "torque", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.sawtooth() && f.s.drive.base > 0.5 * f.s.drive.peak),
         .trials = STICKSLIP_TRY({{{"drive.base", 0.33 * f.s.drive.peak}}}),
         .text = STICKSLIP_REST "{drive.base} and {drive.peak} differ by {swing:mT}, so that the "
                 "pulses are too small to break the edge loose; it walks with {set}"},
        {.code = "rest-friction", .value = "friction_held", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck()),
         .trials = STICKSLIP_TRY(with_friction(0.25 * f.s.contact.kinetic_friction,
                                               0.25 * f.s.contact.static_friction)),
         .text = STICKSLIP_REST "friction holds it, {contact.static_friction=} under weight and "
                 "adhesion of {resting_force:nN}; with a quarter of the friction it walks"},
        {.code = "rest-drag", .value = "drag.rotational", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.s.drag.rotational > 0.0),
         .trials = STICKSLIP_TRY(with_drag(1e-3 * f.s.drag.linear, 1e-3 * f.s.drag.rotational)),
         .text = STICKSLIP_REST "drag holds it, {advice} it walks",
         .advice = STICKSLIP_ADVICE(
             f.s.drag.linear > 0.0
                 ? "{drag.linear=} and {drag.rotational=}; with a thousandth of both"
                 : "{drag.rotational=}; with a thousandth")},
        {.code = "rest-drag", .value = "drag.linear", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck() && f.s.drag.rotational == 0.0),
         .trials = STICKSLIP_TRY(with_drag(1e-3 * f.s.drag.linear, 0.0)),
         .text = STICKSLIP_REST "drag holds it, {drag.linear=}; with a thousandth it walks"},
        {.code = "rest-torque", .value = "torque", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck()),
         .trials = STICKSLIP_TRY(with_field(f, 2.0), with_field(f, 5.0)),
         .text = STICKSLIP_REST "the field rocks it too little; it walks with {set}"},
        {.code = "rest", .first_of = "rest",
         .when = STICKSLIP_IF(f.stuck()),
         .text = "the robot stays in its place; none of 5 times the field, a quarter of the "
                 "friction or a thousandth of the drag alone makes it walk"},
        {.code = "no-pulses", .value = "drive.peak", .of = NoteOf::scenario,
         .when = STICKSLIP_IF(f.sawtooth() && f.swing() <= 0.0 && !f.shaken()),
         .text = "{drive.base} and {drive.peak} are the same: the field is steady and has no "
                 "pulses, and turns the robot once at most; set {drive.peak} above {drive.base}"},

        // A robot that does not walk. Half of the time in flight: chosen.
        {.code = "flight", .value = "airborne_fraction", .above = 0.5,
         .text = "the robot is in flight for {airborne_fraction:%} of the measuring window: it "
                 "hops and does not walk, and its velocity depends on how it lands; {advice}",
         .advice = STICKSLIP_ADVICE(
             f.resting_force() <= 0.0 ? "without weight and adhesion nothing holds it down"
             : f.program() ? "let its voltages swing by less"
             : !f.driven() ? "shake it by less"
             : "bring {drive.base} nearer to {drive.peak}, such as {drive.base=middle_field}"),
         .many = "in flight for more than half of the window"},
        {.code = "no-friction",
         .when = STICKSLIP_IF(f.moves() && f.s.contact.static_friction <= 0.0),
         .text = "without friction nothing holds the edge: the robot goes where the pull of the "
                 "field or a tilt of the surface takes it, which is no walk"},
        // Up to it most walks keep half of their velocity without the gradient: design/goal.py.
        {.code = "dragged", .value = "pull_share", .above = 0.4,
         .when = STICKSLIP_IF(f.s.record.pull_share && !f.rests()),
         .text = "the gradient of the field drags the robot: along its way it pulls with "
                 "{pull_share:%} of what friction could have held, so that most of its velocity is "
                 "no walk; {advice}",
         .advice = &without_pull,
         .many = "dragged by the gradient of the field"},
        // Where nobody asked for the share.
        {.code = "pulled", .value = "pull_ratio", .above = 0.5,
         .when = STICKSLIP_IF(!f.s.record.pull_share && !f.rests()),
         .text = "the gradient of the in-plane field pulls the robot with up to {pull_ratio:%} of "
                 "what friction holds, so that part of its velocity is no walk; {advice}",
         .advice = &without_pull,
         .many = "the gradient of the in-plane field pulls the robot with more than half of what "
                 "friction holds"},
        {.code = "backward", .value = "forward",
         .when = STICKSLIP_IF(f.goes_back()),
         .trials = STICKSLIP_TRY(
             {{{"drive.edge", f.s.drive.edge == Edge::rise ? "fall" : "rise"}}}),
         .then = STICKSLIP_IF(f.walks() && f.advance() > 2e-3),
         .text = "the sudden stroke pushes the edge the wrong way, so that the robot slides back; "
                 "with {set} it walks {tried.forward:mm/s} forward"},
        {.code = "roll-over", .value = "roll_over", .above = 0.0,
         .text = "the robot rolled over, forth or back, from one corner over a face to the next "
                 "(in all: {roll_over:}){advice}",
         .advice = STICKSLIP_ADVICE(
             f.s.drive.mode == DriveMode::ipp && f.s.drive.base <= 0.0
             ? "; at {drive.base=} the holding coil alone turns it upright: set "
               "{drive.base=usual_base}"
             : "")},
        {.code = "beyond-upright", .value = "tilt", .above = 0.5 * std::numbers::pi,
         .text = "the robot pitched beyond upright: theta from {theta_min:degrees} to "
                 "{theta_max:degrees} in the measuring window"},
        {.code = "no-slip",
         .when = STICKSLIP_IF(f.moves() && f.slips() <= 0.0),
         .text = "the contact never slipped in the measuring window: the robot rolls or hops"},

        // A motion whose mean velocity says less than it seems to.
        {.code = "field-change", .value = "field_change", .above = 0.1,
         .text = "the field of the coils where the run ends differs by {field_change:%} from that "
                 "where it begins: the mean velocity mixes different fields; {advice}",
         .advice = STICKSLIP_ADVICE(f.program() ? "give a shorter program" : "give fewer pulses"),
         .many = "more than 10 % off in field where the run ends"},
        // Where the field changes, the velocity follows it; more pulses would lead further away.
        // Quarters of fewer than 20 pulses differ by chance, as the pulses of a sound walk are not
        // all alike.
        {.code = "velocity-grows", .value = "velocity_growth", .above = 0.03,
         .when = STICKSLIP_IF(f.run.field_change <= 0.1 && f.measured_pulses() >= 20.0),
         .text = "the velocity still grows, from each quarter of the window to the next by "
                 "{velocity_growth:%} or more; more {drive.pulses} give the steady one",
         .many = "still growing in velocity"},
        // With a steady heading near the centre it is 0.5 % at most, or below 5e-5 m/s; walks whose
        // heading turns or swings have 10 % and more, and there the rigid body with eight corners
        // walks differently by as much (docs/theory/steering.md).
        {.code = "turning", .value = "turning_speed",
         .when = STICKSLIP_IF(f.speed() != 0.0 &&
                              f.run.turning_speed > std::max(0.05 * f.speed(), 5e-5)),
         .text = "the robot turned while it walked: what turning adds at its contact is not in the "
                 "model, and may change its speed along the path by up to about "
                 "{turning_speed:mm/s:2} (turning_speed); straight from the start to the end of "
                 "the window it made {speed:mm/s}"},
        {.code = "start-up", .value = "drive.pulses", .of = NoteOf::scenario,
         .when = STICKSLIP_IF(!f.program() && f.s.drive.pulses < 4),
         .text = "{drive.pulses=} is fewer than 4: the measuring window begins {advice} and "
                 "includes the start-up",
         .advice = STICKSLIP_ADVICE(f.sawtooth() ? "after the ramp" : "with the run")},
        {.code = "window-short", .value = "window_duration", .first_of = "window",
         .of = NoteOf::coil,
         .when = STICKSLIP_IF(f.asked_voltage() > 0.0 && !f.has_slower() &&
                              f.window_duration() < f.time_constant()),
         .text = "the measuring window lasts {window_duration:ms}, less than the time constant of "
                 "coil {coil}, L/R = {time_constant:ms}: the field still changes from before, and "
                 "what is measured is no steady motion"},
        // With the coils of Table I that is a sawtooth of more than 357 Hz, whose pulses last 0.4
        // L/R; the paper's 200 Hz give 9 %.
        {.code = "pulses-short", .value = "swing_left", .of = NoteOf::coil,
         .when = STICKSLIP_IF(f.sawtooth() && f.swing() != 0.0 && !f.blocked() &&
                              f.pulses_in_it() && f.swing_part() < 0.05),
         .text = "{drive.frequency} = {drive.frequency::6}: a pulse of {pulse:ms} is "
                 "{pulse_in_times::2} times the time constant of its coil, L/R = "
                 "{time_constant:ms}: the field swings by {swing_left:mT:2} of the {swing:mT} "
                 "between {drive.base} and {drive.peak}"},
        // Where it tilts by more than that, rad, or flies as much of the time. Chosen.
        {.code = "inner", .value = "inner_share",
         .when = STICKSLIP_IF(f.inner_share() > 0.05 &&
                              std::max(f.tilt(), f.run.airborne_fraction) > 0.05),
         .text = "the inner mass, {inner_share:%} of the robot's, has no inertia across its line, "
                 "and the robot does not only slide along it: it turns by up to {tilt:degrees:2} "
                 "and flies {airborne_fraction:%:2} of the time"},

        // Values of a scenario that are probably mistakes: beyond what robots, coils and drives of
        // this kind have.
        {.code = "capacitor", .value = "capacitance", .first_of = "capacitor", .of = NoteOf::coil,
         .when = STICKSLIP_IF(f.sawtooth() && f.asked_voltage() > 0.0 &&
                              f.s.coils[f.coil].capacitance > 0.0),
         .text = "coil {coil} has a capacitor in series, through which no voltage holds a current: "
                 "{drive.peak}, {drive.base} and {drive.hold} are fields without it"},
        // Table I's 6.5 mT need 67.5 V.
        {.code = "voltage", .value = "asked_voltage", .above = 200.0, .of = NoteOf::coil,
         .text = "the drive asks for {asked_voltage:V:4} at coil {coil}, {asked_current:A:4} when "
                 "steady"},
        // Gels with magnetic particles have 1000, the heaviest magnets, of iron and platinum,
        // 15500.
        {.code = "density", .value = "density", .first_of = "density", .of = NoteOf::scenario,
         .when = STICKSLIP_IF(f.density() < 1000.0 || f.density() > 16000.0),
         .text = "{robot.mass=} makes a density of {density:kg/m3} with length, width and height "
                 "of the robot: magnets have 1000 (gels with particles) to 15500 (with platinum)"},
        // Iron with a third of cobalt has the largest moment of all: 240 A m2/kg, and 1.95e6 A/m.
        // The best permanent magnets have 160 and 1.2e6.
        {.code = "moment", .value = "robot.magnetization", .above = 2e6, .first_of = "density",
         .of = NoteOf::scenario,
         .text = "{robot.magnetization=} is more than any material has: magnets have up to 1.2e6 "
                 "A/m, their remanence over the magnetic constant"},
        {.code = "moment", .value = "moment", .first_of = "density", .of = NoteOf::scenario,
         .when = STICKSLIP_IF(f.moment() > 240.0 * f.s.robot.mass),
         .text = "{robot.magnetization=} is more than {robot.mass=} of any material has in a robot "
                 "of this size, whose density would be {density:kg/m3}: the best magnets have 160 "
                 "A m2 per kg; mend mass, size or magnetization"},
        {.code = "steep-surface", .value = "slope", .of = NoteOf::scenario,
         .when = STICKSLIP_IF(f.slope_force() > f.slope_hold()),
         .text = "{effects.surface_tilt.angle=} is steeper than friction holds: the robot slides "
                 "without any field, which is no walk, as its weight pulls along the surface with "
                 "{slope_force:nN} and {contact.static_friction=} gives {slope_hold:nN}"},
        // The paper's adhesion is 0.9 times the weight.
        {.code = "adhesion", .value = "contact.adhesion", .of = NoteOf::scenario,
         .when = STICKSLIP_IF(f.s.contact.adhesion > 20.0 * f.weight()),
         .text = "{contact.adhesion=} is more than 20 times the weight"},
        {.code = "tangential-restitution", .value = "contact.tangential_restitution",
         .of = NoteOf::scenario,
         .when = STICKSLIP_IF(f.s.contact.tangential_restitution != 0.0 &&
                              f.s.contact.restitution == 0.0),
         .text = "{contact.tangential_restitution} = {contact.tangential_restitution::6} has no "
                 "effect while {contact.restitution} is 0: only a corner that rebounds gives slip "
                 "back"},
        // With base 0.5 mT and 20 pulses at 20 to 150 Hz the mean velocity is off by up to 0.1 % at
        // 1e-5, by 1 % at 1e-4 and by 8 % at 1e-3.
        {.code = "tolerance", .value = "solver.rtol", .above = 1e-5, .of = NoteOf::scenario,
         .text = "{solver.rtol} = {solver.rtol::6} is looser than 1e-05: the mean velocity may be "
                 "off by a per cent or more; set 1e-08, the default"},
    };
    return rows;
}

#undef STICKSLIP_REST
#undef STICKSLIP_ADVICE
#undef STICKSLIP_TRY
#undef STICKSLIP_IF
#undef STICKSLIP_OF_FACTS
// clang-format on

}  // namespace stickslip
