"""Notes on values of a scenario that are probably mistakes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from stickslip import _core
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip.simulation.unit_notes import unit_notes

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

MUCH_MEAN = 1e-6
"""Means of a shake's accelerations above this part of the largest are noted. Chosen: rounding."""


def scenario_notes(scenario: Scenario) -> list[Note]:
    """Notes on values of a scenario that are probably mistakes; none for most scenarios."""
    core = scenario.to_core()
    return with_those_of_files(scenario, core, _core.scenario_notes(core))


def with_those_of_files(
    scenario: Scenario, core: _core.Scenario, rows: Iterable[tuple[str, str, float | None]]
) -> list[Note]:
    """Notes of the core, and of what it does not know: how values and files were given."""
    units = unit_notes(scenario, core)
    # A unit explains the density that it makes, and the moment of a mass.
    explained = any(note.code in ("unit-mass", "unit-length") for note in units)
    others = [Note(*row) for row in rows if not (explained and row[0] in ("density", "moment"))]
    return [*units, *others, *_of_files(scenario)]


def _of_files(scenario: Scenario) -> Iterator[Note]:
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


def peak_voltages(scenario: Scenario) -> dict[str, float]:
    """Largest magnitude of the voltage that the drive asks of each coil, V."""
    return dict(zip(_core.coil_names, scenario.to_core().commanded_voltages(), strict=True))
