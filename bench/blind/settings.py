"""Where the study measures: drives of the velocities, held fields, probes, films; the priors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Drive = dict[str, float | str]


@dataclass(frozen=True)
class Prior:
    """Prior of a constant; coordinates are standard normal.

    `kind` is "normal" (mean, sd), "log-normal" (median, factor of one sd) or "log-uniform" (low,
    high), with these two numbers.
    """

    kind: str
    first: float
    second: float

    def value(self, coordinate: float) -> float:
        """The constant at a coordinate."""
        if self.kind == "normal":
            return self.first + self.second * coordinate
        if self.kind == "log-normal":
            return float(self.first * np.exp(math.log(self.second) * coordinate))
        share = 0.5 * math.erfc(-coordinate * math.sqrt(0.5))
        return float(self.first * np.exp(math.log(self.second / self.first) * share))

    def coordinate(self, value: float) -> float:
        """Inverse of `value`."""
        if self.kind == "normal":
            return (value - self.first) / self.second
        if self.kind == "log-normal":
            return math.log(value / self.first) / math.log(self.second)
        share = math.log(value / self.first) / math.log(self.second / self.first)
        return NormalDist().inv_cdf(min(max(share, 1e-6), 1.0 - 1e-6))

    @property
    def stated(self) -> str:
        """Text of the prior in a measurement file."""
        one, two = {
            "normal": ("mean", "sd"), "log-normal": ("median", "factor"),
            "log-uniform": ("low", "high"),
        }[self.kind]  # fmt: skip
        return f"{{ {one} = {self.first!r}, {two} = {self.second!r} }}"


PULSES = 8
TRIALS = 3
SCATTER = 0.03  # of a trial, relative
FLOOR = 1e-5  # m/s, of a trial: about 1 % of the usual velocity
ANGLE_SD = float(np.radians(1.0))  # of a reading
FIELD_SD = 5e-6  # T, of a reading
FRAME_RATE, EXPOSURE = 500.0, 3e-4  # Hz, s
FILM_SD = {"x": 5e-7, "theta": 5e-3}  # m, rad, of a frame

_PRIORS = {
    "velocity": {
        "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
        "contact.adhesion": Prior("normal", 0.22e-6, 0.03e-6),
        "drag.linear": Prior("log-uniform", 1e-6, 1e-4),
        "drag.rotational": Prior("log-normal", 9e-17, 2.0),
    },
    "angle": {"robot.magnetization": Prior("normal", 5e5, 2e4)},
    "field": {"coil.side": Prior("normal", 0.1385, 5e-4)},
}
# A static friction of 0.2 leaves kinetic friction room to one side only.
LIMITS = {"contact.kinetic_friction": (0.0, 0.199), "contact.adhesion": (0.0, np.inf)}


def priors(tables: tuple[str, ...]) -> dict[str, Prior]:
    """Priors of the experimenter: those that the first table asks for."""
    return _PRIORS[tables[0]]


def conditions(kind: str, tables: tuple[str, ...]) -> list[Drive]:
    """Drives of the velocities: 30 or 24 that vary all fields, fewer beside other tables.

    Near twins are measured in one mode and one way alone. Causes of one field are alike where the
    other one is always the same, so the hold varies too.
    """
    rows: list[Drive] = []
    modes = ("OPP",) if kind == "near twins" else ("IPP", "OPP")
    for mode in modes:
        usual: Drive = {
            "mode": mode, "base": 0.5e-3, "hold": 1.0e-3, "direction": "+x", "peak": 2.5e-3
        }  # fmt: skip
        paces = (20.0, 30.0, 40.0, 50.0, 65.0, 80.0, 100.0, 120.0)
        if kind == "near twins":
            rows += [{**usual, "frequency": pace} for pace in paces]
            rows += [{**usual, "frequency": pace, "peak": 2.0e-3} for pace in paces[::2]]
            rows += [{**usual, "frequency": 45.0, "peak": peak} for peak in (1.5e-3, 2e-3, 3e-3)]
            continue
        rows += [{**usual, "frequency": pace} for pace in (20.0, 30.0, 45.0, 65.0, 90.0, 120.0)]
        rows += [{**usual, "frequency": 45.0, "peak": peak} for peak in (1.5e-3, 2e-3, 3e-3)]
        rows += [{**usual, "frequency": 55.0, "hold": hold} for hold in (0.6e-3, 1.8e-3)]
        rows += [{**usual, "frequency": 75.0, "base": 0.9e-3}]
        back = {**usual, "direction": "-x"}
        rows += [{**back, "frequency": pace} for pace in (25.0, 50.0, 110.0)]
    if kind.endswith("24 velocities"):
        return [row for number, row in enumerate(rows) if number % 5 != 4]
    return rows[::2] if len(tables) > 1 else rows


def curves(drives: list[Drive]) -> list[list[int]]:
    """Conditions that differ in frequency alone, in its order: a curve each."""
    found: dict[tuple[tuple[str, float | str], ...], list[int]] = {}
    for at in sorted(range(len(drives)), key=lambda k: float(drives[k]["frequency"])):
        others = sorted((key, value) for key, value in drives[at].items() if key != "frequency")
        found.setdefault(tuple(others), []).append(at)
    return list(found.values())


def held_fields() -> Array:
    """(Bx, Bz) in T of the static tilts, each twice, shape (n, 2).

    Without field the robot lies flat: only there an offset of the camera is no tilt.
    """
    rest = [(0.0, 0.0), (2e-5, 0.0), (0.0, 2e-5), (0.0, -2e-5)]
    some = (-3.0, -2.5, -2.0, -1.6, -1.3, -1.0, -0.7, 0.7, 1.0, 1.3, 1.6, 2.0, 2.5, 3.0)
    return np.repeat(np.array(rest + [(2e-3, 1e-3 * z) for z in some]), 2, axis=0)


def probes() -> Array:
    """Currents of xp, xm, yp, ym, clamp in A and places x, y, z in m, shape (n, 8).

    Each coil by itself at four currents, and no current, at the centre and beside it.
    """
    currents = np.vstack([*(i * np.eye(5) for i in (-2.0, -1.0, 1.0, 2.0)), np.zeros((1, 5))])
    places = ((0.0, 0.0, 0.0), (2e-3, 1e-3, -1e-3))
    return np.array([[*amperes, *place] for amperes in currents for place in places])


def films() -> list[Drive]:
    """Drives of the films, one of each mode and way."""
    usual: Drive = {"base": 0.5e-3, "pulses": 12}
    return [
        {**usual, "mode": "IPP", "frequency": 30.0, "direction": "+x"},
        {**usual, "mode": "OPP", "frequency": 40.0, "direction": "-x"},
    ]
