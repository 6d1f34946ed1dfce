"""The reference of an optimised drive: the best sawtooth of a grid, under the same limits."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip.design.goal import Goal
from stickslip.design.space import Space, Values
from stickslip.scenario.keys import COIL_NAMES, FIELDS, Value
from stickslip.scenario.waveform import drive_waveform

GRID: Mapping[str, Sequence[Any]] = {
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

# Power of the voltages with which a figure grows.
_GROWTH = {"voltage_max": 1.0, "current_max": 1.0, "field_max": 1.0, "power_mean": 2.0}
_BELOW = 0.999  # chosen: a field is not quite proportional where the robot moves


Probe = Callable[[Sequence[Values], int], Array]
"""From drives and the index of a draw to their numbers in it, (drives, 1 + bounds)."""


class NoSawtooth(Exception):
    """There is none to compare with, for the reason that it says."""


def sawtooths(space: Space, goal: Goal, of_start: Array, probe: Probe) -> list[dict[str, Value]]:
    """The sawtooths of the grid and the start, each once, as near as what is free allows, by keys.

    Where the peak is free, limits on voltage, current, field and power decide how strong each is,
    by one run in the draw in which the start has most of them. `of_start` are its numbers, (draws,
    1 + bounds). Without such limits all have the top of the free peaks, or the start's peak. Raises
    NoSawtooth beside a drive of another kind, or where they drive a coil that a free waveform may
    not.
    """
    drive, ends = space.start.drive, space.ranges.get("drive.peak")
    if drive.kind != "sawtooth":
        raise NoSawtooth(f'drive.mode = "{drive.mode}"')
    top = ends[1] if ends and ends[1] > 0.0 else drive.peak
    shapes = [
        _scaled({"drive.peak": 1.0, **dict(zip(GRID, values, strict=True))}, top)
        for values in itertools.product(*GRID.values())
    ]
    start = {key: space.start.get(key) for key in ("drive.peak", *GRID)}
    growing = {name: 1 + rank for rank, name in enumerate(goal.limits) if name in _GROWTH}
    if not (ends or space.knots):
        growing = {}
    drives = _each_once(space, shapes, FIELDS if growing else ())
    if space.knots:
        asked = drive_waveform(space.start.replace(drives[0])).voltages([drive.ramp])[0]
        driven = [COIL_NAMES[k] for k in np.flatnonzero(asked)]
        if left_out := [coil for coil in driven if coil not in space.coils]:
            raise NoSawtooth(f"it drives {', '.join(left_out)}, which --coils leaves out")
    if growing:
        of_draws = np.nan_to_num(of_start[:, list(growing.values())])
        relative = of_draws / np.maximum(of_draws.max(axis=0), np.finfo(float).tiny)
        hardest = np.argmax(relative.sum(axis=1))
        numbers = probe(drives, int(hardest))
        factors = np.full(len(drives), math.inf)
        for name, column in growing.items():
            grown = numbers[:, column]
            room = np.ones(len(drives))
            np.divide(max(goal.limits[name], 0.0), grown, out=room, where=grown > 0.0)
            factors = np.minimum(factors, _BELOW * room ** (1.0 / _GROWTH[name]))
        if ends:
            factors = np.minimum(factors, ends[1] / top)
        drives = [_scaled(drive, by) for drive, by in zip(drives, factors.tolist(), strict=True)]
    return _each_once(space, [*drives, start])


def _scaled(values: Values, factor: float) -> dict[str, Value]:
    return {**values, **{name: factor * float(values[name]) for name in FIELDS}}


def _each_once(
    space: Space, shapes: Sequence[Values], kept: Sequence[str] = ()
) -> list[dict[str, Value]]:
    """As near as what is free allows, but for some keys that are kept."""
    allowed = [{**space.nearest(shape), **{key: shape[key] for key in kept}} for shape in shapes]
    return list({tuple(drive.items()): space.timed(drive) for drive in allowed}.values())
