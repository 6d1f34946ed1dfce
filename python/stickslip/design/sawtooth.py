"""The reference sawtooth of an optimised drive: the best of a grid, under the same limits.

Of a sawtooth, too, only what is free changes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stickslip.design.design_space import DesignSpace, as_program, drive_waveform
from stickslip.design.goal import Changes, Evaluate, Goal, Judged
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value
from stickslip.scenario.sections import COIL_NAMES

Grid = Mapping[str, Sequence[Any]]

GRID: Grid = {
    "drive.mode": ("IPP", "OPP"),
    "drive.edge": ("rise", "fall"),
    "drive.clamp": ("down", "up"),
    "drive.frequency": np.geomspace(50.0, 300.0, 4).round(1).tolist(),  # Hz
    "drive.base": (-0.4, 0.0, 0.2, 0.4),
    "drive.hold": (0.2, 0.4, 0.7, 1.0),
}
"""Values of each key; base and hold in parts of the peak. Chosen: from pulses that the field
follows to such as the coil lets little through of."""

POINTS = math.prod(map(len, GRID.values()))
"""Sawtooths of the grid."""

_FIELDS = ("drive.peak", "drive.base", "drive.hold")

# Power of the voltages with which a figure grows.
_GROWTH = {"voltage_max": 1.0, "current_max": 1.0, "field_max": 1.0, "power_mean": 2.0}
_BELOW = 0.999  # chosen: a field is not quite proportional where the robot moves


def sawtooths(
    space: DesignSpace, goal: Goal, evaluate: Evaluate, grid: Grid = GRID
) -> list[dict[str, Value]]:
    """The sawtooths of a grid and the start, each once, as near as what is free allows, by keys.

    Where the peak is free, limits on voltage, current, field and power decide how high each is;
    without them all have the top of the peaks that are free, or the start's peak. `evaluate` judges
    drives in the draws in which the limits have to hold.
    """
    ends = [axis.high for axis in space.axes if axis.name == "drive.peak"]
    top = max([*ends, 0.0]) or space.scenario.drive.peak
    shapes = [
        {"drive.peak": 1.0, **dict(zip(grid, each, strict=True))}
        for each in itertools.product(*grid.values())
    ]
    growing = [name for name in goal.limits if name in _GROWTH and (ends or space.periodic)]
    kept = _FIELDS if growing else ()  # until they are scaled
    found = _each_once(space, [_scaled(each, top) for each in shapes], kept)
    if space.periodic and found:  # a sawtooth drives no coil that the waveform may not
        drive = space.scenario.drive
        asked = drive_waveform(space.scenario.replace(found[0])).voltages([drive.ramp])[0]
        if not {COIL_NAMES[k] for k in np.flatnonzero(asked)} <= set(space.periodic.coils):
            return []
    own = {key: space.scenario.get(key) for key in ("drive.peak", *grid)}  # the start
    if not growing:
        return _each_once(space, [*found, own])
    measured = evaluate([played(space, values) for values in found])
    scaled = [
        _scaled(values, min(_room(goal, each, name) for name in growing), *ends)
        for values, each in zip(found, measured, strict=True)
    ]
    return _each_once(space, [*scaled, own])


def _each_once(
    space: DesignSpace, shapes: Sequence[dict[str, Value]], kept: Sequence[str] = ()
) -> list[dict[str, Value]]:
    allowed = [{**space.nearest(each), **{name: each[name] for name in kept}} for each in shapes]
    return list({tuple(each.items()): space.as_long(each) for each in allowed}.values())


def _room(goal: Goal, judged: Judged, name: str) -> float:
    """Factor by which the voltages may grow until a figure is at its limit."""
    room = max(goal.limits[name], 0.0) / judged.worst[name] if judged.worst[name] > 0.0 else 1.0
    return _BELOW * float(room ** (1.0 / _GROWTH[name]))


def _scaled(values: dict[str, Value], factor: float, *highest: float) -> dict[str, Value]:
    """All fields of a sawtooth times a factor, up to a highest peak; as it is if that is none."""
    peak = float(values["drive.peak"])
    if not np.isfinite(factor):
        return values
    factor = min([factor, *(each / peak for each in highest)])
    return {**values, **{name: factor * float(values[name]) for name in _FIELDS}}


def played(space: DesignSpace, values: Mapping[str, Value]) -> Changes:
    """Changes for a draw that plays a pulsed drive, as a program where that is compared with one.

    A program is measured over all of it, and a pulsed drive after its third pulse only.
    """
    if space.periodic is None:
        return dict(values)
    try:
        return as_program(drive_waveform(space.scenario.replace(values)), values)
    except ScenarioError as error:
        return error
