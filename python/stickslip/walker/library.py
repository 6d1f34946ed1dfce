"""The simulator's effects as causes.

Names, units, meanings and possible ranges are the core's; all else that is known of a cause by its
name stands in causes.toml.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Mapping
from typing import Any

from stickslip._util.prior import Prior
from stickslip._util.toml import own_table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.effects import effects, is_free_shape
from stickslip.scenario.keys import PREFIX, Key, known_keys
from stickslip.scenario.scenario import Scenario

_SHAPE_FACTOR = math.exp(0.7)
"""Standard deviation of a shape's prior, as a factor. Chosen: two."""

_SIZES_IN_RANGE = 5.0
"""Sizes from `absent` to the farther end of a range. Chosen: a fifth of what is possible does not
surprise where nothing else is known, as of a user's own effect."""

_SIZE = "size", "low", "high", "negligible", "fineness"

_ACROSS = {"effects.ambient_field.By", "effects.surface_tilt.azimuth"}
"""Effects that push or turn a robot out of the plane y = 0 of the data."""


@functools.cache
def known() -> dict[str, Any]:
    """The rows of causes.toml, whose head says what they have."""
    return own_table("walker/causes.toml")


@functools.cache
def constants() -> dict[str, tuple[str, Mapping[str, float]]]:
    """Causes that are a constant, other than stated, by name: its key, and its size."""
    rows, shaken = known()["causes"], known()["shaken"]
    return {
        name: (row["constant"], row["sizes"][row["constant"].rpartition(".")[2]])
        for name, row in rows.items()
        if "constant" in row
    } | {key.replace(".", "_"): (key, shaken["size"]) for key in shaken["keys"]}


@functools.cache
def alike() -> dict[str, str]:
    """Causes that look like a constant: not offered where its key is uncertain."""
    rows = known()["causes"].items()
    looks = {name: row["looks_like"] for name, row in rows if "looks_like" in row}
    return {name: key for name, (key, _) in constants().items()} | looks


def library(scenario: Scenario, uncertain: Collection[str], volts: float) -> tuple[Cause, ...]:
    """All effects with a known law that the model does not have yet, and `constants`.

    Curves of a free shape are in `laws`. Values of single coils are measured, and `field_gain`
    stands for them. The scenario's own effects are part of the model, and no causes; so is an
    effect with a parameter in `uncertain`: dotted keys of constants that are uncertain, or that
    conditions state on their own. `volts` is the largest voltage of the drives, V, where the
    amplifiers' limit begins to act.
    """
    named = {key.split(".")[1] for key in uncertain if key.startswith(PREFIX)}
    same = {name for name, constant in alike().items() if constant in uncertain}
    others = [
        _constant(name, *row, scenario) for name, row in constants().items() if name not in same
    ]
    rows = known()["causes"]
    return tuple(filter(None, others)) + tuple(
        Cause(
            effect.name,
            tuple(
                _parameter(key, rows.get(effect.name, {}).get("sizes", {}), volts)
                for key in effect.parameters
                if key.name not in _ACROSS
            ),
            effect.meaning,
        )
        for effect in effects()
        if effect.parameters
        and effect.name not in {*scenario.effects, *named, *same}
        and not is_free_shape(effect.name)
    )


def _constant(name: str, key: str, row: Mapping[str, float], scenario: Scenario) -> Cause | None:
    """A constant that is other than stated; None where it is at the end of its range, or zero."""
    known, stated = known_keys()[key], float(scenario.get(key))
    scale = abs(stated) if row.get("relative") else 1.0
    size, low, high = (scale * row[word] for word in ("size", "low", "high"))
    low, high = max(known.low, stated + low), min(known.high, stated + high)
    if not low < high:
        return None
    parameter = Parameter(key, unit=known.unit, low=low, high=high, size=size, absent=stated)
    return Cause(name, (parameter,), f"{key} is other than stated")


def _parameter(key: Key, sizes: Mapping[str, Mapping[str, Any]], volts: float) -> Parameter:
    row = sizes.get(key.name.rpartition(".")[2], {})
    if "middle" in row:
        prior = Prior("log-normal", row["middle"], _SHAPE_FACTOR)
        return Parameter(key.name, prior, key.unit, key.low, key.high, cause=False)
    if row.get("falls"):
        lowest, size = row["low"] * volts, row["size"] * volts
        return Parameter(key.name, unit=key.unit, low=lowest, high=volts, size=size, falls=True)
    absent = float(key.default)
    farthest = max(key.high - absent, absent - key.low)
    size = {"size": farthest / _SIZES_IN_RANGE, "low": key.low, "high": key.high}
    size |= {word: row[word] for word in _SIZE if word in row}
    return Parameter(key.name, unit=key.unit, absent=absent, **size)
