"""Slips of a paper slider on paper, pulled by a spring: a table of events.

The spring is pulled at a constant speed, so that its force grows until the slider slips. Nominally
it slips at one force, friction at rest times weight. The document says what that lacks: friction
ages (0.022 of the weight a factor e of the time at rest), and the surface is uneven (a wave of 3.8
mm was found in two records of it; Colas et al., Phys. Rev. E 2019). An event of slip a row:
stiffness (N/m), speed (m/s), t (s), wait since the last slip (s), force after the last slip and at
this one over the weight, slope of the force over that of the pulled spring, place (m); found in a
record of `npusteln/stickslip` at 84acb98 (Nelly Pustelnik and Valerie Vidal, CeCILL-B).
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np
import pandas as pd
from real.sets import Measured, Truth, with_absent

from stickslip import Cause, Diagnosis, Parameter, Prior, Table, diagnose_model, instruments

Values = dict[str, np.ndarray]

_FRICTION = Parameter("friction", Prior("log-uniform", 0.1, 1.0), cause=False)
"""Friction of paper on paper, known only in range."""

_SIZE = 0.02
"""Usual size of a change, in weights. Chosen: ageing by one factor e on many materials."""


def _change(name: str) -> Parameter:
    return Parameter(name, low=-0.3, high=0.3, size=_SIZE)


_CAUSES = (
    Cause("ageing", _change("ageing.rate"), "friction that grows with the logarithm of the rest"),
    Cause(
        "wave",
        (
            _change("wave.sine"),
            _change("wave.cosine"),
            Parameter("wave.length", Prior("log-uniform", 1e-3, 15e-3), "m", cause=False),
        ),
        "a surface that is uneven along the way",
    ),
    Cause("drift", _change("drift.change"), "friction that changes steadily with time"),
    Cause(
        "wear",
        (
            _change("wear.change"),
            Parameter("wear.time", Prior("log-uniform", 10.0, 400.0), "s", cause=False),
        ),
        "friction that settles as the surface wears in",
    ),
    Cause(
        "step",
        (
            _change("step.height"),
            Parameter("step.time", Prior("normal", 190.0, 100.0), "s", cause=False),
        ),
        "friction that jumps at one time",
    ),
    Cause(
        "speed", _change("speed.rate"), "friction that depends on the logarithm of the loading rate"
    ),
    instruments.scale(0.05, name="stiffness"),
    instruments.clipping("-", 0.5, 0.05),
)


def force_at_slip(table: Table, p: Values) -> np.ndarray:
    """Force of the spring as the slider slips, over the weight."""
    p = with_absent(p, _CAUSES)
    t, place = table["t"], table["place"]
    span = np.ptp(t)
    phase = 2.0 * np.pi * place / np.maximum(p["wave.length"], 1e-6)
    worn = -np.expm1(-t / np.maximum(p["wear.time"], 1e-3))
    return (
        p["friction"]
        + p["ageing.rate"] * np.log(table["wait"])
        + p["wave.sine"] * np.sin(phase)
        + p["wave.cosine"] * np.cos(phase)
        + p["drift.change"] * (t - t[0]) / span
        + p["wear.change"] * worn
        + p["step.height"] * (t > p["step.time"])
        + p["speed.rate"] * np.log(table["slope"])
    )


def diagnosed(without: Collection[str] = ()) -> Diagnosis:
    """The forces at the slips of one record, in the order of time.

    No event was repeated: how far one differs from the next serves as its error. The force after
    the last slip is no setting: the wait times the pull of the spring is how far the force then
    grows, whatever the friction.
    """
    events = pd.read_csv(Path(__file__).with_name("events.csv"))
    settings = {name: events[name].to_numpy() for name in ("t", "wait", "place", "slope")}
    top = events["top"].to_numpy()
    error = float(np.sqrt(0.5 * np.mean(np.diff(top) ** 2)))
    data = Table(settings, top, sd=error, run=np.zeros(len(top)), name="slips")
    listed = [each for each in _CAUSES if each.name not in without]
    return diagnose_model(force_at_slip, data, [_FRICTION], listed)


SETS = [
    Measured(
        "slider",
        # What is known of the length are two digits.
        Truth(("ageing", "wave"), values={"ageing.rate": (0.022, 0.002),
                                          "wave.length": (3.8e-3, 0.1e-3)}),
        diagnosed,
    )
]  # fmt: skip
