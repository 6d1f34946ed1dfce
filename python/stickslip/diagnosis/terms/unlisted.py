"""Effects that nobody listed: rivals of the listed causes, which are never claimed.

A list of causes is a sample. Where it has all the probability, what nobody listed gets a listed
name. So effects of the same kinds of shape compete, each with one amplitude: something that acts
with an input, and an error of a reading. All together have the odds of one listed cause.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

import numpy as np

from stickslip._util.arrays import Array, root_mean_square
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
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
    t, y, v = record.t, record.y - record.y.mean(), states["v"]
    even = {"1": np.ones(len(t)), "t": (t - t.mean()) / np.ptp(t)}
    reading = even | {"|y|": np.abs(y), "y^2": y**2, "y^3": y**3}
    gone = {_LISTED.get(each, "") for each in listed}
    made = [_shaped(None, y, *each) for each in reading.items() if f"{each[0]} read" not in gone]
    if name is not None:
        u = record[name]
        acting = even | {"|v|": np.abs(v), "v|v|": v * np.abs(v), "v^3": v**3, "|u|": np.abs(u),
                         "u^2": u**2, "u^3": u**3}  # fmt: skip
        if "x" in states:
            x, size = states["x"] - states["x"].mean(), _SLOW * float(np.max(np.abs(v)))
            acting |= {"sign v": np.tanh(v / (size or 1.0)), "x": x, "x^2": x**2, "x^3": x**3,
                       "sin x": np.sin(states["x"])}  # fmt: skip
        if "zero" in listed and ("x" not in states or name == "force"):
            gone.add("1")  # against a loss or a spring, a constant push is a wrong zero
        made += [_shaped(name, u, *each) for each in acting.items() if each[0] not in gone]
    made += _instruments(record.step, name, listed)
    return [replace(cause, odds=1.0 / len(made), listed=False) for cause in made]


def _instruments(step: float, name: str | None, listed: Collection[str]) -> Iterator[Cause]:
    """Yield delays, lags and a scale that are not listed."""
    if name is not None and f"late {name}" not in listed:
        yield delay(size=step, input=name, name=f"unlisted delay of {name}")
    if name is not None and not {f"slow {name}", "slow motor"} & {*listed}:
        yield lag(step, input=name, name=f"unlisted lag of {name}")
    if not {"slow sensor", "slow thermometer"} & {*listed}:
        yield lag(step, name="unlisted lag of the readings")
    if "scale" not in listed:
        yield scale(name="unlisted scale of the readings")


def _shaped(name: str | None, whole: Array, shape: str, values: Array) -> Cause:
    """Make an effect with an input, or else an error of a reading, of a shape (n,)."""
    usual = (_ACTING if name else _READ) * root_mean_square(whole)
    size = max(usual, 1e-300) / max(root_mean_square(values), 1e-300)
    what, most = f"unlisted {name or 'reading'} as {shape}", LARGEST_ERROR * size
    amplitude = Parameter(f"{what}.size", low=-most, high=most, size=size)

    def read(readings: Array, given: Array, p: Mapping[str, Array], table: Table) -> Array:
        return readings + p[amplitude.name] * values

    return Cause(what, amplitude, f"an unlisted {name or 'error of a reading'} with {shape}",
                 read=read, input=name)  # fmt: skip
