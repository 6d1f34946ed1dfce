"""A linear axis with a ball screw, as its document describes it: force over velocity.

F = M a + Fv v + Fc sign(v) + offset, with the friction that the document's symmetric fit gives. Its
own second fit says what that model lacks: Fv is 166.7 +- 1.2 forwards and 240.4 +- 1.2 N s/m
backwards (Janot, Gautier and Brunot, nonlinear benchmark 2019).
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np
import pandas as pd

from stickslip import Cause, Diagnosis, Parameter, Prior, Series, Table, diagnose_model, instruments

Values = dict[str, np.ndarray]

DATA = Path(__file__).parent / "axis.csv.gz"

_PERIOD = 6.24
"""s, after which the reference motion is repeated."""
_MEAN_OF = 5
"""Readings of 100 Hz that make one of 20 Hz. Chosen: the document filters at 20 to 40 Hz."""
_SEGMENTS, _BIN, _FEWEST = 10, 0.02, 20
"""Segments of the record, width of a bin of velocities, m/s, and readings of a mean. Chosen: a bin
holds one of the velocities at which the motion stays, 0.04, 0.08 and 0.12 m/s; 0.2 s of it."""
_MIDDLE = 0.12
"""m, the middle of the way."""

_CONSTANTS = (
    # 5 %: what friction and a drive's gain change from one day to another. Chosen.
    Parameter("mass", Prior("normal", 95.11, 0.05 * 95.11), "kg"),
    Parameter("viscous", Prior("normal", 203.5, 0.05 * 203.5), "N s/m"),
    Parameter("coulomb", Prior("normal", 20.39, 0.05 * 20.39), "N"),
    Parameter("offset", Prior("normal", -3.16, 1.0), "N"),
)


def _either_way(name: str, unit: str, size: float) -> Parameter:
    return Parameter(name, unit=unit, low=-30.0 * size, high=30.0 * size, size=size)


# Sizes: a tenth of the term that they change, at the usual velocity of 0.1 m/s, 0.1 m from the
# middle and 1 m/s^2. Chosen.
_CAUSES = (
    Cause(
        "viscous_asymmetry",
        _either_way("viscous_asymmetry.half", "N s/m", 20.0),
        "viscous friction that is larger backwards",
    ),
    Cause(
        "coulomb_asymmetry",
        _either_way("coulomb_asymmetry.half", "N", 2.0),
        "dry friction that is larger backwards",
    ),
    Cause(
        "quadratic_drag",
        _either_way("quadratic_drag.coefficient", "N s^2/m^2", 200.0),
        "friction that bends over velocity",
    ),
    Cause(
        "stribeck",
        (
            Parameter("stribeck.force", unit="N", low=0.0, high=60.0, size=2.0),
            Parameter("stribeck.velocity", Prior("log-uniform", 1e-3, 0.1), "m/s", cause=False),
        ),
        "friction rises towards rest",
    ),
    Cause(
        "position_stiffness",
        _either_way("position_stiffness.stiffness", "N/m", 20.0),
        "a pull like that of a spring",
    ),
    Cause(
        "friction_over_place",
        _either_way("friction_over_place.slope", "N/m", 20.0),
        "dry friction that changes along the way",
    ),
    Cause(
        "load_friction",
        _either_way("load_friction.share", "-", 0.02),
        "friction that grows with the force of the drive",
    ),
    Cause(
        "warming",
        _either_way("warming.rate", "1/s", 0.1 / 25.0),
        "viscous friction that changes with time",
    ),
    Cause(
        "ripple",
        (
            _either_way("ripple.sine", "N", 2.0),
            _either_way("ripple.cosine", "N", 2.0),
            Parameter("ripple.length", Prior("log-uniform", 5e-3, 50e-3), "m", cause=False),
        ),
        "a ripple of the force along the way",
    ),
    instruments.scale(0.02, name="force_scale"),
)


# Of a cause that is not listed.
_ABSENT = {each.name: np.zeros((1, 1)) for cause in _CAUSES for each in cause.parameters}
_METERS = (
    instruments.lag(2e-3, input="velocity", name="velocity_lag"),
    instruments.delay(size=2e-3, name="force_delay"),
)


def force(p: Values, v: np.ndarray, a: np.ndarray, x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Force of the motor, N, at velocities, accelerations, places and times, SI."""
    p = _ABSENT | p
    way, off = np.sign(v), x - _MIDDLE
    viscous = p["viscous"] * (1.0 + p["warming.rate"] * t) - p["viscous_asymmetry.half"] * way
    slow = np.exp(-np.abs(v) / np.maximum(p["stribeck.velocity"], 1e-6))
    dry = (
        p["coulomb"]
        - p["coulomb_asymmetry.half"] * way
        + p["stribeck.force"] * slow
        + p["friction_over_place.slope"] * off
        + p["load_friction.share"] * np.abs(p["mass"] * a)
    )
    phase = 2.0 * np.pi * x / np.maximum(p["ripple.length"], 1e-6)
    return (
        p["mass"] * a
        + viscous * v
        + p["quadratic_drag.coefficient"] * v * np.abs(v)
        + dry * way
        + p["offset"]
        + p["position_stiffness.stiffness"] * off
        + p["ripple.sine"] * np.sin(phase)
        + p["ripple.cosine"] * np.cos(phase)
    )


def _readings() -> dict[str, np.ndarray]:
    return {str(name): column.to_numpy() for name, column in pd.read_csv(DATA).items()}


def diagnosed(without: Collection[str] = ()) -> Diagnosis:
    """Mean forces at the velocities of ten segments of the record; whole segments are held out."""
    read = _readings()
    since = read["t"] - read["t"][0]
    segment = np.minimum((since / since[-1] * _SEGMENTS).astype(int), _SEGMENTS - 1)
    cells = segment * 1000 + np.floor(read["velocity"] / _BIN).astype(int)
    rows = [np.flatnonzero(cells == each) for each in np.unique(cells)]
    rows = [each for each in rows if len(each) >= _FEWEST]
    settings = {
        name: np.array([read[name][each].mean() for each in rows])
        for name in ("velocity", "acceleration", "position", "t")
    }
    mean = np.array([read["force"][each].mean() for each in rows])
    error = np.array([read["force"][each].std(ddof=1) / np.sqrt(len(each)) for each in rows])
    run = np.array([segment[each[0]] for each in rows])
    data = Table(settings, mean, sd=error, run=run, name="segments", unit="N")

    def model(table: Table, p: Values) -> np.ndarray:
        v, a, x, t = (table[name] for name in settings)
        return force(p, v - p["velocity_lag.time"] * a, a, x, t)

    lag = Parameter("velocity_lag.time", unit="s", low=0.0, high=0.06, size=2e-3)
    causes = [*_CAUSES, Cause("velocity_lag", lag, "friction that follows the velocity late")]
    listed = [each for each in causes if each.name not in without]
    return diagnose_model(model, data, _CONSTANTS, listed)


def diagnose_in_time(without: Collection[str] = ()) -> Diagnosis:
    """The whole record at 20 Hz, as one series."""
    read = _readings()
    count = len(read["t"]) // _MEAN_OF * _MEAN_OF
    slow = {name: each[:count].reshape(-1, _MEAN_OF).mean(axis=1) for name, each in read.items()}
    motion = {name: slow[name] for name in ("velocity", "acceleration", "position")}
    record = Series(slow["t"] - slow["t"][0], slow["force"], motion, name="axis", unit="N")

    def model(record: Series, p: Values) -> np.ndarray:
        return force(p, *(record[name] for name in motion), record.t)

    listed = [each for each in (*_CAUSES, *_METERS) if each.name not in without]
    return diagnose_model(model, record, _CONSTANTS, listed)


def diagnose_repeats(without: Collection[str] = ()) -> Diagnosis:
    """The record at 20 Hz, as four repeats of the first 6 s of one motion; the last one ends there.

    All runs follow the reference to 1 um, so that the mean motion is that of each.
    """
    read = _readings()
    begin = {f"run {k}": k * _PERIOD for k in range(4)}

    def runs(name: str) -> np.ndarray:
        first = [round(100.0 * each) for each in begin.values()]
        rows = np.stack([read[name][each : each + 600] for each in first])
        return rows.reshape(len(first), -1, _MEAN_OF).mean(axis=2)

    t = runs("t")[0] - read["t"][0]
    motion = {name: runs(name).mean(axis=0) for name in ("velocity", "acceleration", "position")}
    records = [
        Series(t, y, motion, name=name, repeat_of="run 0" if name != "run 0" else None, unit="N")
        for name, y in zip(begin, runs("force"), strict=True)
    ]

    def model(record: Series, p: Values) -> np.ndarray:
        v, a, x = (record[name] for name in motion)
        return force(p, v, a, x, record.t + begin[record.name])

    listed = [each for each in (*_CAUSES, *_METERS) if each.name not in without]
    return diagnose_model(model, records, _CONSTANTS, listed)


if __name__ == "__main__":
    result = diagnosed()
    print(result.verdict.kind, *sorted(result.verdict.causes))
    value, sd, unit = result.params.loc["viscous_asymmetry.half", ["value", "sd", "unit"]]
    print(f"half the difference: {value:.0f} ± {sd:.0f} {unit}")
