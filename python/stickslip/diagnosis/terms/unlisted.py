"""Effects that nobody listed: rivals of the listed causes, which are never claimed.

A list of causes is a sample. Where it has all the probability, what nobody listed gets a listed
name. So effects of the same kinds of shape compete, each with one amplitude: something that acts
with an input, and an error of a reading. All together have the odds of one listed cause.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from stickslip._util.arrays import Array, root_mean_square
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import delay, lag, scale
from stickslip.diagnosis.terms.parameter import LARGEST_ERROR, Parameter

_ACTING, _READ, _SLOW = 0.1, 0.05, 0.03
"""Usual size of what acts, in the root mean square of its input, and of an error of a reading, in
their scatter; and part of the largest speed below which a sign is smooth. Chosen."""

_LISTED = {
    "load": "1", "coulomb": "sign v", "quadratic": "v|v|", "cubic_damping": "v^3",
    "quadratic_stiffness": "x^2", "cubic_stiffness": "x^3", "stiffness": "x", "gravity": "sin x",
    "viscous_asymmetry": "|v|", "gain_asymmetry": "|u|", "loss_growth": "v|v|",
    "power_error": "u", "saturation": "u^3", "zero": "1 read",
}  # fmt: skip
"""Shapes that listed causes have, by their names."""


def unlisted(
    record: Series, states: Mapping[str, Array], name: str | None, listed: Collection[str]
) -> list[Cause]:
    """Make the effects that nobody listed of a record.

    Parameters
    ----------
    record : Series
    states : dict of ndarray, shape (n,)
        Of the recalibrated model: ``x`` and ``v``, or ``v`` alone.
    name : str, optional
        Of the input with which they act; without one there are errors of readings alone.
    listed : collection of str
        Names of listed causes, whose shapes are left out.
    """
    gone = {_LISTED.get(each, "") for each in listed}
    if "x" not in states and "zero" in listed:
        gone.add("1")  # a constant power is a wrong zero of the thermometer
    acting = {} if name is None else _acting(record, record[name], states)
    reading = _reading(record)
    made = [(shape, values, name) for shape, values in acting.items() if shape not in gone]
    made += [(shape, values, None) for shape, values in reading.items()
             if f"{shape} read" not in gone]  # fmt: skip
    causes = [_cause(record, *each) for each in made
              if np.all(np.isfinite(each[1])) and np.any(each[1])]  # fmt: skip
    causes += _instruments(record, name, listed)
    return [replace(cause, odds=1.0 / len(causes), listed=False) for cause in causes]


def _instruments(record: Series, name: str | None, listed: Collection[str]) -> list[Cause]:
    """Delays, lags and scales that are not listed."""
    step, made = record.step, list[Cause]()
    if name is not None and f"late {name}" not in listed:
        made.append(delay(size=step, input=name, name=f"unlisted delay of {name}"))
    if name is not None and f"slow {name}" not in listed and "slow motor" not in listed:
        made.append(lag(step, input=name, name=f"unlisted lag of {name}"))
    if not {"slow sensor", "slow thermometer"} & {*listed}:
        made.append(lag(step, name="unlisted lag of the readings"))
    if "scale" not in listed:
        made.append(scale(name="unlisted scale of the readings"))
    return made


def _acting(record: Series, u: Array, states: Mapping[str, Array]) -> dict[str, Array]:
    """Shapes of what acts, by their formulas."""
    t, v = record.t, states["v"]
    sign = np.tanh(v / (_SLOW * float(np.max(np.abs(v))) or 1.0))
    found = {"1": np.ones(len(t)), "|v|": np.abs(v), "v|v|": v * np.abs(v), "v^3": v**3,
             "|u|": np.abs(u), "u^2": u**2, "u^3": u**3,
             "t": (t - t.mean()) / np.ptp(t)}  # fmt: skip
    if "x" in states:
        x = states["x"] - states["x"].mean()
        found |= {"sign v": sign, "x": x, "x^2": x**2, "x^3": x**3, "sin x": np.sin(states["x"])}
    return found


def _reading(record: Series) -> dict[str, Array]:
    """Shapes of errors of readings, by their formulas."""
    t, y = record.t, record.y - record.y.mean()
    return {"1": np.ones(len(t)), "|y|": np.abs(y), "y^2": y**2, "y^3": y**3,
            "t": (t - t.mean()) / np.ptp(t)}  # fmt: skip


def _cause(record: Series, shape: str, values: Array, name: str | None) -> Cause:
    whole = record[name] if name else record.y - record.y.mean()
    usual = (_ACTING if name else _READ) * root_mean_square(whole)
    size = max(usual, 1e-300) / root_mean_square(values)
    what = f"unlisted {name or 'reading'} as {shape}"
    most = LARGEST_ERROR * size
    amplitude = Parameter(f"{what}.size", low=-most, high=most, size=size)

    def read(readings: Array, given: Array, p: Mapping[str, Array], table: Series) -> Array:
        return readings + p[amplitude.name] * values

    meaning = f"what nobody listed, {name or 'an error of a reading'} with {shape}"
    return Cause(what, amplitude, meaning, read=read, input=name)
