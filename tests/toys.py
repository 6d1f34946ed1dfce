"""Small models of which the answers are known."""

import numpy as np

from stickslip import Cause, Parameter, Prior, Table

SLOPE = Parameter("slope", Prior("normal", 1.0, 0.1), cause=False)
LEVEL = Parameter("level", Prior("normal", 0.0, 0.5), cause=False)
WAVE = Cause("wave", Parameter("wave.height", size=0.5, low=-5.0, high=5.0), "a wave")
STEP = Cause("step", Parameter("step.height", size=0.5, low=0.0, high=5.0), "a step at 2")
BEND = Cause("bend", Parameter("bend.size", size=0.2, low=-3.0, high=3.0), "a parabola")
TWIN = Cause("twin", Parameter("twin.height", size=0.5, low=-5.0, high=5.0), "nearly the wave")
CAUSES = (WAVE, STEP, BEND, TWIN)


def shapes(x):
    return {
        "wave.height": np.sin(5.0 * x),
        "step.height": (x > 2.0).astype(float),
        "bend.size": (x - 2.0) ** 2,
        "twin.height": np.sin(5.0 * x + 0.25),
    }


def line(table, p):
    """A line with whatever is added to it, shape (vectors, rows)."""
    x = table["x"]
    made = p["slope"] * x + p["level"]
    for name, shape in shapes(x).items():
        made = made + p.get(name, np.zeros((1, 1))) * shape
    return made


def data(extra=0.0, sd=0.1, n=30, seed=0, **options):
    """Readings of a line and `extra`, with normal errors."""
    x = np.linspace(1.0, 3.0, n)
    noise = sd * np.random.default_rng(seed).standard_normal(n)
    # Over a second setting, as over one alone no discrepancy is smooth.
    settings = {"x": x, "z": np.random.default_rng(9).permutation(n) / n}
    return Table(settings, 1.05 * x + 0.2 + extra + noise, sd=sd, name="line", **options)


def problem(table, causes=CAUSES, uncertain=(SLOPE, LEVEL)):
    # The rest of this file asks for public names alone: an earlier package can answer it.
    from stickslip.diagnosis.model import posed

    return posed(table, line, uncertain, causes)


def fitted(posed, causes=(), form="exact", at=None):
    """The fit of some causes beside a form, begun at the stated constants."""
    from stickslip.diagnosis.fitting.descent import finished
    from stickslip.diagnosis.fitting.forms import forms
    from stickslip.diagnosis.fitting.models import minimise

    at = np.zeros(posed.size) if at is None else at
    return finished(posed, minimise(posed, forms(posed)[form], causes, at))
