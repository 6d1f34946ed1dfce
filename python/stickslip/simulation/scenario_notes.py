"""What a colleague would ask about a scenario before it is run: values that are probably mistakes.

Each limit lies beyond what robots, coils and drives of this kind have; within it there is no note.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip.scenario.sections import Solver
from stickslip.simulation.note import Note
from stickslip.simulation.unit_notes import time_constants, unit_notes

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

HIGH_VOLTAGE = 200.0
"""Voltages of the drive above this are noted, V; Table I's 6.5 mT need 67.5 V."""

LOOSE_TOLERANCE = 1e-5
"""Values of solver.rtol above this are noted: with base 0.5 mT and 20 pulses at 20 to 150 Hz the
mean velocity is off by up to 0.1 % at 1e-5, by 1 % at 1e-4 and by 8 % at 1e-3."""

DENSITIES = 100.0, 25_000.0
"""Densities outside of these are noted, kg/m3: foams are lighter, and no element is heavier (osmium
has 22 600)."""

LEAST_SWING = 0.05
"""Parts of the asked swing of the field below this are noted. With the coils of Table I that is a
sawtooth of more than 357 Hz, whose pulses last 0.4 L/R; the paper's 200 Hz give 9 %."""

MUCH_ADHESION = 20.0
"""Adhesion above so many times the weight is noted; the paper's is 0.9 times."""

STEADY_PULSES = 4
"""Fewest pulses whose measuring window, from the end of the third, has no start-up; section VII."""


def pulses_measured(pulses: Any) -> Any:
    """Pulses of the measuring window of a drive of so many, or of each of an array; section VII."""
    return pulses - (STEADY_PULSES - 1) * (pulses >= STEADY_PULSES)


def counts_start_up(scenario: Scenario) -> bool:
    """Whether a pulsed drive is so short that its measuring window begins after the ramp."""
    return scenario.drive.mode != "program" and scenario.drive.pulses < STEADY_PULSES


def without_pulses(scenario: Scenario) -> bool:
    """Whether a pulsed drive has a constant voltage."""
    drive = scenario.drive
    return drive.mode != "program" and drive.base == drive.peak


def scenario_notes(scenario: Scenario) -> list[Note]:
    """Notes on values of a scenario that are probably mistakes; none for most scenarios."""
    core = scenario.to_core()  # once for all notes
    units = unit_notes(scenario, core)
    # A unit explains the density that it makes.
    explained = any(note.code in ("unit-mass", "unit-length") for note in units)
    return [
        *_of_drive(scenario, core),
        *_of_coils(scenario, core),
        *([] if explained else _of_body(scenario)),
        *units,
        *_of_contact(scenario),
        *_of_solver(scenario),
    ]


def peak_voltages(scenario: Scenario) -> dict[str, float]:
    """Largest magnitude of the voltage that the drive asks of each coil, V."""
    return _asked_voltages(scenario.to_core())


def field_swing(frequency: float, time_constant: float) -> float:
    """Swing of the steady field of a sawtooth whose voltage is sudden on one side, over that asked.

    The current follows the voltage by Eq. (1) with the time constant (s). Over a period T from the
    jump, a sawtooth of swing 1 that falls from 1 gives i(t) = 1 - t/T + c - exp(-t/tau) /
    (1 - exp(-T/tau)) with c = tau/T, which is least at the jump.
    """
    share = 1.0 / max(frequency * time_constant, 1e-300)
    if share < 1e-6:
        return share / 8.0  # the first term in it, of which rounding would leave nothing
    fall = -math.expm1(-share)
    top = -math.log(fall / share)  # t/tau where i is largest
    return (1.0 - math.exp(-top)) / fall - top / share


def weight(scenario: Scenario) -> float:
    """Weight of the robot, N."""
    return scenario.robot.mass * scenario.environment.gravity


def _asked_voltages(core: _core.Scenario) -> dict[str, float]:
    return dict(zip(_core.coil_names, core.asked_voltages(), strict=True))


def _of_drive(scenario: Scenario, core: _core.Scenario) -> list[Note]:
    notes = []
    drive = scenario.drive
    if without_pulses(scenario):
        text = (
            f"drive.base = drive.peak = {drive.peak:g} T: the voltage is constant and gives no "
            "pulses; set drive.peak above drive.base"
        )
        notes.append(Note("no-pulses", text, drive.peak))
    if counts_start_up(scenario):
        text = (
            f"drive.pulses = {drive.pulses} is fewer than {STEADY_PULSES}: the measuring window "
            "begins after the ramp and includes the start-up"
        )
        notes.append(Note("start-up", text, float(drive.pulses)))
    resistances = core.resistances()
    for (name, volts), ohms in zip(_asked_voltages(core).items(), resistances, strict=True):
        if volts > HIGH_VOLTAGE:
            text = (
                f"the drive asks for {volts:.4g} V at coil {name}, {volts / ohms:.4g} A in the "
                "steady state"
            )
            notes.append(Note("voltage", text, volts))
    return notes


def _of_coils(scenario: Scenario, core: _core.Scenario) -> list[Note]:
    field_map = scenario.coil.map
    told = []
    if field_map is not None:
        told.append(Note("map", f"the field of the coils is that of {field_map}"))
    return [*told, *_of_window(scenario, core), *_of_pulses(scenario, core)]


def _of_window(scenario: Scenario, core: _core.Scenario) -> list[Note]:
    """Whether all that is measured is over before a current has followed its voltage."""
    start, end = scenario.window
    asked = _asked_voltages(core)
    times = {n: each for n, each in time_constants(scenario, core).items() if asked[n] > 0.0}
    slowest = max(times, key=lambda name: times[name], default=None)
    if slowest is None or end - start >= times[slowest]:
        return []
    text = (
        f"the measuring window lasts {1e3 * (end - start):.3g} ms, less than the time constant of "
        f"coil {slowest}, L/R = {1e3 * times[slowest]:.3g} ms: the field is "
        "still changing from before, and what is measured is no steady motion"
    )
    return [Note("window-short", text, end - start)]


def _of_pulses(scenario: Scenario, core: _core.Scenario) -> list[Note]:
    drive = scenario.drive
    asked = drive.peak - drive.base
    if drive.mode == "program" or asked == 0.0:
        return []
    name = core.in_plane_coil if drive.mode == "IPP" else "clamp"
    time_constant = time_constants(scenario, core)[name]
    share = field_swing(drive.frequency, time_constant)
    if share >= LEAST_SWING:
        return []
    text = (
        f"drive.frequency = {drive.frequency:g}: a pulse of {1e3 / drive.frequency:.3g} ms is "
        f"{1.0 / (drive.frequency * time_constant):.2g} times the time constant of its coil, "
        f"L/R = {1e3 * time_constant:.3g} ms, so that the field comes to swing by "
        f"{1e3 * share * asked:.2g} mT of the {1e3 * asked:.3g} mT between drive.base and "
        "drive.peak"
    )
    return [Note("pulses-short", text, share * asked)]


def _of_body(scenario: Scenario) -> list[Note]:
    robot = scenario.robot
    density = robot.mass / (robot.length * robot.width * robot.height)
    if DENSITIES[0] <= density <= DENSITIES[1]:
        return []
    text = (
        f"robot.mass = {robot.mass:g} makes a density of {density:.3g} kg/m3 with robot.length, "
        f"width and height: bodies have {DENSITIES[0]:g} to {DENSITIES[1]:g} kg/m3"
    )
    return [Note("density", text, density)]


def _of_contact(scenario: Scenario) -> list[Note]:
    notes = []
    contact, pull = scenario.contact, weight(scenario)
    tilt = abs(float(scenario.get("effects.surface_tilt.angle")))
    # Along the surface, and what presses the robot on it.
    along, across = pull * math.sin(tilt), pull * math.cos(tilt) + contact.adhesion
    if along > contact.static_friction * across:
        text = (
            f"effects.surface_tilt.angle = {tilt:.3g} rad is steeper than friction holds: without "
            f"any field the robot slides, as {along:.3g} N of its weight act along the surface and "
            f"contact.static_friction = {contact.static_friction:g} gives "
            f"{contact.static_friction * across:.3g} N"
        )
        notes.append(Note("steep-surface", text, tilt))
    if contact.adhesion > MUCH_ADHESION * pull:
        much = "acts on a robot without weight"
        if pull > 0.0:
            much = f"is {contact.adhesion / pull:.3g} times the weight"
        text = f"contact.adhesion = {contact.adhesion:g} N {much}"
        notes.append(Note("adhesion", text, contact.adhesion))
    back = contact.tangential_restitution
    if back and not contact.restitution:
        text = (
            f"contact.tangential_restitution = {back:g} has no effect while contact.restitution is "
            "0: only a corner that rebounds gives slip back"
        )
        notes.append(Note("tangential-restitution", text, back))
    return notes


def _of_solver(scenario: Scenario) -> list[Note]:
    rtol = scenario.solver.rtol
    if rtol <= LOOSE_TOLERANCE:
        return []
    text = (
        f"solver.rtol = {rtol:g} is looser than {LOOSE_TOLERANCE:g}: the mean velocity may be off "
        f"by a per cent or more; the default, {Solver().rtol:g}, is recommended"
    )
    return [Note("tolerance", text, rtol)]
