"""Limits of the coils of a scenario and of their amplifiers."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array
from stickslip._util.messages import check_above_zero, check_kind
from stickslip.field.coils import AXES, Coils
from stickslip.scenario.keys import COIL_NAMES, GEOMETRY
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.notes import peak_voltages

ROOM = 5e-3
"""Side of the cube around the centre in which the fringe is told, m: where such robots walk."""

SHARE = 0.05
"""By which a dimension is off where it is told what that changes. Chosen: a tape measure's error of
the middle of a winding."""

_COPPER = 1.72e-8 * 8960.0 * 385.0  # ohm m kg/m^3 J/(kg K), of copper at 20 degrees C; CRC Handbook


class CoilFacts(NamedTuple):
    """Numbers of one coil; its scenario's drive is that of `current`. NaN: not known.

    Attributes
    ----------
    field, gradient : float
        At the centre along its axis per ampere, T/A and T/(m A), both without sign.
    fringe : float
        Largest field across the axis over that along it, in a cube of 5 mm.
    rise_time : float
        Inductance over resistance, s.
    resonance : float
        Of the coil with its capacitor, 1 / (2 pi sqrt(L C)), Hz; NaN without one.
    current, power, heating : float
        Where the highest voltage of the drive is held: A, W, and the rise of the temperature at
        first, of a winding of copper without cooling, K/s. A capacitor lets nothing through.
    most_current, most_field : float
        That the amplifier can hold, A and T.
    most_swing : float
        Of the field of a sawtooth from zero to that, at the drive's frequency, T; NaN of
        a drive without one.
    """

    field: float
    gradient: float
    fringe: float
    rise_time: float
    resonance: float
    current: float
    power: float
    heating: float
    most_current: float
    most_field: float
    most_swing: float


UNITS = dict(
    zip(
        CoilFacts._fields,
        ("T/A", "T/m/A", "1", "s", "Hz", "A", "W", "K/s", "A", "T", "T"),
        strict=True,
    )
)


def coil_facts(
    scenario: Scenario, volts: float | None = None, amperes: float | None = None
) -> dict[str, CoilFacts]:
    """The numbers of each coil, by its name.

    Parameters
    ----------
    scenario : Scenario
        Its coils, and the drive that they play.
    volts, amperes : float, optional
        The most that the amplifier of a coil gives, V and A; without `volts` the scenario's
        ``amplifier_limit``, if it has one.

    Raises
    ------
    ScenarioError
        If `scenario` is none, or a number is not allowed.
    """
    check_kind("scenario", scenario, Scenario)
    for name, value, unit in (("volts", volts, "V"), ("amperes", amperes, "A")):
        if value is not None:
            check_above_zero(name, value, unit)
    limit = float(scenario.get("effects.amplifier_limit.voltage")) or math.inf
    volts = limit if volts is None else volts
    asked, made = peak_voltages(scenario), Coils.of(scenario)
    is_sawtooth = scenario.drive.kind == "sawtooth"
    facts = {}
    for name, axis, one in zip(COIL_NAMES, AXES, np.eye(len(AXES)), strict=True):
        coil = getattr(scenario.coil, name)
        field, gradient, fringe = _of_field(made, one, axis)
        tau, passes = coil.inductance / coil.resistance, coil.capacitance == 0.0
        root = math.sqrt(coil.inductance * coil.capacitance)
        resonance = math.nan if passes else 1.0 / (2.0 * math.pi * root)
        current = passes * asked[name] / coil.resistance
        power = current**2 * coil.resistance
        # A wire of length l and resistance R has the mass d r l^2 / R.
        wire = 4.0 * coil.side * coil.turns if made.box is None else math.nan
        heating = power * coil.resistance / (_COPPER * wire**2)
        most = min(volts / coil.resistance, math.inf if amperes is None else amperes)
        most = passes * most if math.isfinite(most) else math.nan
        swing = _core.field_swing(scenario.drive.frequency, tau) if is_sawtooth else math.nan
        ends = (most, most * field, most * field * swing)
        held = (current, power, heating)
        facts[name] = CoilFacts(field, gradient, fringe, tau, resonance, *held, *ends)
    return facts


def dimension_changes(scenario: Scenario, name: str) -> dict[str, dict[str, float]]:
    """Changes of one coil's numbers by 5 % more of a dimension, as parts, by dimension."""
    before = coil_facts(scenario)[name]
    geometry = () if scenario.coil.map is not None else GEOMETRY
    changes = {}
    for dimension in (*geometry, "resistance", "inductance"):
        key = f"coil.{name}.{dimension}"
        after = coil_facts(scenario.replace({key: (1.0 + SHARE) * float(scenario.get(key))}))[name]
        per_field = (after.gradient / after.field) / (before.gradient / before.field)
        changes[dimension] = {
            "field": after.field / before.field - 1.0,
            "gradient": after.gradient / before.gradient - 1.0,
            "gradient_per_field": per_field - 1.0,
            "rise_time": after.rise_time / before.rise_time - 1.0,
        }
    return changes


def _of_field(made: Coils, one: Array, axis: int) -> tuple[float, float, float]:
    """Field and gradient at the centre along an axis, and the fringe, of one ampere."""
    line = np.linspace(-0.5 * ROOM, 0.5 * ROOM, 5)
    points = np.stack(np.meshgrid(line, line, line), axis=-1).reshape(-1, 3)
    if made.box is not None:
        low, high = made.box
        points = points[np.all((points >= low) & (points <= high), axis=1)]
    field = np.abs(made.field(points, one))
    across = np.delete(field, axis, axis=1).max(axis=1)
    centre = made.field(np.zeros(3), one)[axis], made.gradient(np.zeros(3), one)[axis, axis]
    return abs(float(centre[0])), abs(float(centre[1])), float((across / field[:, axis]).max())
