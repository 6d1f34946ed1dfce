"""Two cascaded tanks with free outlets, as the document of the benchmark describes them.

A pump fills the upper tank, from which the water flows into the lower one. By Bernoulli's principle
x1' = -k1 sqrt(x1) + k4 u and x2' = k2 sqrt(x1) - k3 sqrt(x2), with levels in V of an uncalibrated
sensor and the voltage u held over each step. The document says what that lacks: the upper tank
overflows, partly into the lower one, which overflows too, or its sensor ends at 10 V (Schoukens,
Mattsson, Wigren and Noel, cascaded tanks benchmark).
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np
import pandas as pd

from stickslip import Cause, Diagnosis, Parameter, Prior, Series, diagnose_model, instruments

Values = dict[str, np.ndarray]

_NOISE = 0.01
"""Error of a reading over its root mean square: the document's ratio of 40 dB."""
_RIM = (20.0, 5.0, 2.0)
"""V: where the upper tank's rim begins to act, its usual distance below, and its lowest place.
Chosen: levels are of the order of the sensor's 10 V."""
_END = (11.0, 1.0, 5.0)
"""V, the same of the lower tank and of the sensor, which never read more than 10 V."""


def _constant(name: str) -> Parameter:
    # Levels of some V change by themselves within some tens to hundreds of seconds.
    return Parameter(name, Prior("log-uniform", 5e-3, 0.5), "V^0.5/s", cause=False)


_CONSTANTS = (
    *(_constant(name) for name in ("k1", "k2", "k3", "k4")),
    *(
        Parameter(
            name, Prior("normal", 5.0, 3.0), "V", low=0.0, high=15.0, cause=False,
            each_record=True,
        )
        for name in ("level1", "level2")
    ),
)  # fmt: skip


def _cause(name: str, meaning: str, *parameters: Parameter) -> Cause:
    return Cause(name, parameters, meaning)


def _rim(name: str, highest: float, size: float, lowest: float) -> Parameter:
    return Parameter(name, unit="V", low=lowest, high=highest, size=size, falls=True)


_CAUSES = (
    _cause(
        "upper_overflow",
        "the upper tank overflows, partly into the lower one",
        _rim("upper_overflow.level", *_RIM),
        Parameter(
            "upper_overflow.share", Prior("normal", 0.5, 0.25), low=0.0, high=1.0, cause=False
        ),
    ),
    _cause("lower_overflow", "the lower tank overflows", _rim("lower_overflow.level", *_END)),
    instruments.clipping("V", *_END[:2], lowest=_END[2], name="sensor_end"),
    _cause(
        "pump_curve",
        "the flow bends over the voltage",
        Parameter("pump_curve.bend", unit="1/V", low=-0.3, high=0.3, size=0.03),
    ),
    _cause(
        "dead_pump",
        "the pump gives nothing below a voltage",
        Parameter("dead_pump.voltage", unit="V", low=0.0, high=2.0, size=0.2),
    ),
    _cause(
        "outlet",
        "the flow through an outlet is no square root of the level",
        Parameter("outlet.exponent", low=-0.4, high=0.5, size=0.05),
    ),
    _cause(
        "leak",
        "the upper tank loses water beside the lower one",
        Parameter("leak.rate", unit="1/s", low=0.0, high=0.03, size=1e-3),
    ),
    _cause(
        "pump_drift",
        "the pump changes with time",
        Parameter("pump_drift.change", low=-0.9, high=3.0, size=0.05),
    ),
    instruments.scale(0.05, name="sensor_scale"),
    instruments.offset("V", 0.2, name="sensor_offset"),
    instruments.delay(size=2.0, input="pump", name="pump_delay"),
    instruments.lag(2.0, input="pump", name="pump_lag"),
)


# Of a cause that is not listed.
_ABSENT = {each.name: np.zeros((1, 1)) for cause in _CAUSES for each in cause.parameters}


def lower_level(record: Series, p: Values) -> np.ndarray:
    """Level of the lower tank, V, at the times of a record.

    Classical Runge-Kutta steps of the time between two readings, a tenth of the time in which a
    level changes; what would stand above a rim does not press, and runs over at the end of each.
    """
    p = _ABSENT | p
    t = record.t
    u = np.maximum(record["pump"] - p["dead_pump.voltage"], 0.0)
    u = u * (1.0 + p["pump_curve.bend"] * (u - 2.8)) * (1.0 + p["pump_drift.change"] * t / t[-1])
    # Columns of vectors, so that a step is one operation on all.
    inflow = np.ascontiguousarray((p["k4"] * u).T)

    def of(name: str) -> np.ndarray:
        return np.broadcast_to(p[name], (inflow.shape[1], 1))[:, 0]

    k1, k2, k3, leak, power = map(of, ("k1", "k2", "k3", "leak.rate", "outlet.exponent"))
    rims = np.array([of("upper_overflow.level"), of("lower_overflow.level")])
    rims[rims == 0.0] = np.inf
    into = of("upper_overflow.share") * k2 / k1
    level = np.array([of("level1"), of("level2")])
    bends, leaks = bool(np.any(power)), bool(np.any(leak))
    out = np.array([k1, k3])

    def rate(level: np.ndarray, flow: np.ndarray) -> np.ndarray:
        level = np.minimum(np.maximum(level, 0.0), rims)
        root = level ** (0.5 + power) if bends else np.sqrt(level)
        change = -out * root
        change[0] += flow - leak * level[0] if leaks else flow
        change[1] += k2 * root[0]
        return change

    levels = np.empty(inflow.shape)
    for k, step in enumerate(np.append(np.diff(t), 0.0)):
        levels[k] = level[1]
        flow = inflow[k]
        one = rate(level, flow)
        two = rate(level + (0.5 * step) * one, flow)
        three = rate(level + (0.5 * step) * two, flow)
        four = rate(level + step * three, flow)
        level = level + (step / 6.0) * (one + 2.0 * (two + three) + four)
        over = np.maximum(level[0] - rims[0], 0.0)
        level[1] += into * over
        level = np.minimum(np.maximum(level, 0.0), rims)
    return levels.T


def diagnosed(without: Collection[str] = ()) -> Diagnosis:
    """Both records, each with start levels of its own."""
    records = []
    for name, rows in pd.read_csv(Path(__file__).with_name("tanks.csv")).groupby("record"):
        level = rows["level"].to_numpy()
        error = _NOISE * float(np.sqrt(np.mean(level**2)))
        records.append(
            Series(
                rows["t"].to_numpy(), level, {"pump": rows["pump"].to_numpy()}, sd=error,
                name=str(name), unit="V",
            )
        )  # fmt: skip
    listed = [each for each in _CAUSES if each.name not in without]
    return diagnose_model(lower_level, records, _CONSTANTS, listed)


if __name__ == "__main__":
    result = diagnosed()
    print(result.verdict.kind, *sorted(result.verdict.causes))
    print("nearest:", result.verdict.leader.name)
