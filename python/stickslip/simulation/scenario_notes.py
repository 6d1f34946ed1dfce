"""Notes on values of a scenario that are probably mistakes.

Each limit lies beyond what robots, coils and drives of this kind have; within it there is no note.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from stickslip import _core
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip.simulation.note_table import STEADY_PULSES, Facts, notes_of_table
from stickslip.simulation.unit_notes import DEFAULTS, time_constants, unit_notes

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

HIGH_VOLTAGE = 200.0
"""Voltages of the drive above this are noted, V; Table I's 6.5 mT need 67.5 V."""

LOOSE_TOLERANCE = 1e-5
"""Values of solver.rtol above this are noted: with base 0.5 mT and 20 pulses at 20 to 150 Hz the
mean velocity is off by up to 0.1 % at 1e-5, by 1 % at 1e-4 and by 8 % at 1e-3."""

MUCH_MEAN = 1e-6
"""Means of a shake's accelerations above this part of the largest are noted. Chosen: rounding."""

LEAST_SWING = 0.05
"""Parts of the asked swing of the field below this are noted. With the coils of Table I that is a
sawtooth of more than 357 Hz, whose pulses last 0.4 L/R; the paper's 200 Hz give 9 %."""


def scenario_notes(scenario: Scenario, facts: Facts | None = None) -> list[Note]:
    """Notes on values of a scenario that are probably mistakes; none for most scenarios.

    `facts` are those of the scenario or of a run of it, if they are known.
    """
    core = scenario.to_core()  # once for all notes
    units = unit_notes(scenario, core)
    # A unit explains the density that it makes, and the moment of a mass.
    explained = any(note.code in ("unit-mass", "unit-length") for note in units)
    others = [
        *notes_of_table(facts or Facts(scenario), "scenario"),
        *_of_drive(scenario, core),
        *_of_robot(scenario),
    ]
    return [
        *units,
        *(note for note in others if not (explained and note.code in ("density", "moment"))),
    ]


def peak_voltages(scenario: Scenario) -> dict[str, float]:
    """Largest magnitude of the voltage that the drive asks of each coil, V."""
    return dict(zip(_core.coil_names, scenario.to_core().asked_voltages(), strict=True))


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


def _of_drive(scenario: Scenario, core: _core.Scenario) -> Iterator[Note]:
    drive, is_sawtooth = scenario.drive, scenario.drive.kind == "sawtooth"
    if drive.kind != "program" and drive.pulses < STEADY_PULSES:
        begin = "after the ramp" if is_sawtooth else "with the run"
        text = (
            f"drive.pulses = {drive.pulses} is fewer than {STEADY_PULSES}: the measuring window "
            f"begins {begin} and includes the start-up"
        )
        yield Note("start-up", text, float(drive.pulses))
    asked = dict(zip(_core.coil_names, core.asked_voltages(), strict=True))
    ohms = dict(zip(_core.coil_names, core.resistances(), strict=True))
    for name, volts in asked.items():
        if volts > HIGH_VOLTAGE:
            amperes = volts / ohms[name]
            text = f"the drive asks for {volts:.4g} V at coil {name}, {amperes:.4g} A when steady"
            yield Note("voltage", text, volts)
    for key, value in scenario.hidden.items():
        text = f"{key} = {shown(value)} has no effect: all five coils have their own values"
        yield Note("hidden-key", f"{text}, such as those of [coil.xp]", float(value))
    if scenario.coil.map is not None:
        yield Note("map", f"the field of the coils is that of {scenario.coil.map}")
    shaken = scenario.shake.accelerations
    if shaken is not None and math.hypot(*shaken.mean) > MUCH_MEAN * shaken.most:
        x, z = shaken.mean
        text = (
            f"shake.file: the mean of its accelerations, {x:.3g} m/s^2 along x and {z:.3g} m/s^2 "
            "along z, is taken out, as the surface would drift away"
        )
        yield Note("shake-mean", text, math.hypot(x, z))
    times = time_constants(scenario, core)
    start, end = scenario.window
    used = [name for name, volts in asked.items() if volts > 0.0]
    blocked = [name for name in used if getattr(scenario.coil, name).capacitance > 0.0]
    if blocked and is_sawtooth:
        text = (
            f"coil {blocked[0]} has a capacitor in series, through which no voltage holds a "
            "current: drive.peak, drive.base and drive.hold are fields without it"
        )
        yield Note("capacitor", text, float(getattr(scenario.coil, blocked[0]).capacitance))
    slowest = max(used, key=lambda name: times[name], default=None)
    if slowest is not None and end - start < times[slowest]:
        text = (
            f"the measuring window lasts {1e3 * (end - start):.3g} ms, less than the time constant "
            f"of coil {slowest}, L/R = {1e3 * times[slowest]:.3g} ms: the field still changes from "
            "before, and what is measured is no steady motion"
        )
        yield Note("window-short", text, end - start)
    if not is_sawtooth or drive.base == drive.peak or blocked:
        return
    tau = times[core.in_plane_coil if drive.mode == "IPP" else "clamp"]
    swing = drive.peak - drive.base
    share = field_swing(drive.frequency, tau)
    if share < LEAST_SWING:
        text = (
            f"drive.frequency = {drive.frequency:g}: a pulse of {1e3 / drive.frequency:.3g} ms is "
            f"{1.0 / (drive.frequency * tau):.2g} times the time constant of its coil, L/R = "
            f"{1e3 * tau:.3g} ms: the field swings by {1e3 * share * swing:.2g} mT of the "
            f"{1e3 * swing:.3g} mT between drive.base and drive.peak"
        )
        yield Note("pulses-short", text, share * swing)


def _of_robot(scenario: Scenario) -> Iterator[Note]:
    """Notes on its contact, and on the tolerance."""
    contact = scenario.contact
    back = contact.tangential_restitution
    if back and not contact.restitution:
        text = (
            f"contact.tangential_restitution = {back:g} has no effect while contact.restitution is "
            "0: only a corner that rebounds gives slip back"
        )
        yield Note("tangential-restitution", text, back)
    rtol = scenario.solver.rtol
    if rtol > LOOSE_TOLERANCE:
        text = (
            f"solver.rtol = {rtol:g} is looser than {LOOSE_TOLERANCE:g}: the mean velocity may be "
            f"off by a per cent or more; set {DEFAULTS['solver.rtol']:g}, the default"
        )
        yield Note("tolerance", text, rtol)
