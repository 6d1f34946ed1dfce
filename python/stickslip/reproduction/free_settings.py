"""Pairs of settings with what the study's grid fixes: a continuous space for a search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.control.design_space import Axis
from stickslip.reproduction.settings import MODES, Mode, Setting
from stickslip.scenario.scenario import Scenario

Array = NDArray[np.float64]
Words = tuple[str, ...]
"""Edge and clamp of IPP, then of OPP."""

WORDS = ("edge", "clamp")

# The numbers of a pair: two of each mode, then those of the apparatus, the robot and the fluid,
# which both modes share. Chosen: fields beyond the grid on both sides; edges that still leave a
# sawtooth at 150 Hz; damping a decade and more about that of section VI-C.
OWN = {"base": (-1e-3, 1.5e-3, "T"), "hold": (0.2e-3, 4e-3, "T")}
SHARED = {
    "edge_time": (0.0, 5e-3, "s"),
    "ramp": (0.02, 0.3, "s"),
    "linear": (1e-6, 1e-4, "N s/m"),
    "rotational": (1e-17, 1e-14, "N m s^2"),
}
AXES = (
    *(Axis(f"{mode} {name}", unit, *ends) for mode in MODES for name, (*ends, unit) in OWN.items()),
    *(Axis(name, unit, *ends) for name, (*ends, unit) in SHARED.items()),
)
"""What is searched, with its ranges; linear and rotational are the drag coefficients."""

_SHARED_KEYS = ("drive.edge_time", "drive.ramp", "drag.linear", "drag.rotational")


@dataclass(frozen=True)
class FreeSetting(Setting):
    """A setting with what the grid fixes.

    Attributes
    ----------
    edge_time, ramp : float
        s.
    linear, rotational : float
        Drag coefficients, N s/m and N m s^2.
    """

    edge_time: float
    ramp: float
    linear: float
    rotational: float

    def keys(self) -> dict[str, Any]:
        """The setting by the keys of a scenario."""
        return {
            **super().keys(),
            **{key: getattr(self, name) for key, name in zip(_SHARED_KEYS, SHARED, strict=True)},
        }

    def text(self) -> str:
        """The setting in words."""
        return (
            f"sudden {self.edge}, clamp {self.clamp}, base {self.base * 1e3:.3g} mT, "
            f"hold {self.hold * 1e3:.3g} mT, edge {self.edge_time * 1e3:.3g} ms, "
            f"ramp {self.ramp:.3g} s, "
            f"drag {self.linear:.3g} N s/m and {self.rotational:.3g} N m s²"
        )


Pair = dict[Mode, FreeSetting]


def words_of(pair: Sequence[Setting]) -> Words:
    """The words of a pair of settings."""
    return tuple(getattr(each, word) for each in pair for word in WORDS)


def point_of(pair: Sequence[Setting]) -> Array:
    """Coordinates of a pair of the grid, whose shared numbers are those of a default scenario."""
    values = [getattr(each, name) for each in pair for name in OWN]
    values += [Scenario().get(key) for key in _SHARED_KEYS]
    return np.array([axis.coordinate(float(v)) for axis, v in zip(AXES, values, strict=True)])


def pair_at(words: Words, point: Array) -> Pair:
    """The pair of settings with these words at a point of the unit cube."""
    values = {axis.name: axis.value(float(u)) for axis, u in zip(AXES, point, strict=True)}
    shared = {name: values[name] for name in SHARED}
    edges, clamps = words[::2], words[1::2]
    return {
        mode: FreeSetting(
            mode=mode,
            edge=edge,
            clamp=clamp,
            base=values[f"{mode} base"],
            hold=values[f"{mode} hold"],
            **shared,
        )
        for mode, edge, clamp in zip(MODES, edges, clamps, strict=True)
    }
