"""Records in which nothing is hidden, of four machines, and causes that may be listed for them."""

from functools import partial

import numpy as np
from scipy.signal import lfilter

from stickslip import Cause, Note, Parameter, Prior, Series, Table, events, instruments, models
from stickslip.diagnosis.decision.misfit_test import tested
from stickslip.diagnosis.model import posed
from stickslip.diagnosis.pipeline import run

ONLY_TESTED = Note("only-tested", "No cause is looked for.")


def line(record, p):
    return p["first"] + p["second"] * record["t"]


def relaxed(record, p):
    """A lag of 8 readings behind an input that is held between two readings."""
    kept = np.exp(-1.0 / 8.0)
    driven = p["first"] * record["u"]
    rest, _ = lfilter([1.0 - kept], [1.0, -kept], driven[:, :-1], axis=1, zi=kept * driven[:, :1])
    return np.hstack([driven[:, :1], rest]) + 0.1 * p["second"]


def circle(table, p):
    """A body that turns about a point at (first, second)."""
    angle = np.linspace(0.0, 2.0, 40)
    places = p["first"] + np.cos(angle), p["second"] + np.sin(angle)
    return np.hstack([*places, np.tile(angle, (len(p["first"]), 1))])


CONSTANTS = [
    Parameter("first", Prior("normal", 2.0, 0.1), cause=False),
    Parameter("second", Prior("normal", 0.3, 0.03), cause=False),
]
OSCILLATOR = models.oscillator(stiffness=(40.0, 1.0), viscous=(0.5, 0.1), mass=1.0)


def machine(name, draw):
    """A model, its constants, readings for drawn ones without errors, and what makes them data."""
    if name == "oscillator":
        t, inputs = 0.05 * np.arange(120.0), {"force": np.repeat(draw.uniform(-4.0, 4.0, 12), 10)}
        values = {"stiffness": draw.normal(40.0, 1.0), "viscous": draw.normal(0.5, 0.1)}
        sound = OSCILLATOR.simulate(t, inputs, **values)
        make = partial(Series, t, inputs=inputs, unit="m")
        return OSCILLATOR, OSCILLATOR.terms(make(sound, sd=1.0))[0], sound, make
    predict = {"line": line, "relaxed": relaxed, "circle": circle}[name]
    t, inputs = np.linspace(0.0, 12.0, 120), {}
    if name == "relaxed":
        inputs = {"u": np.repeat(draw.choice([-1.0, 1.0], 20), 6)}
    make = partial(Series, t, inputs=inputs)
    if name == "circle":
        make = partial(Table, {"t": t})
    drawn = {one.name: one.prior.value(draw.standard_normal((1, 1))) for one in CONSTANTS}
    return predict, CONSTANTS, predict(make(t, sd=1.0), drawn)[0], make


def waved(values, _, p, table):
    return values + p["wave.height"] * np.sin(2.0 * np.pi * table.t / p["wave.period"])


def wave(size, last):
    height = Parameter("wave.height", size=size, low=-30.0 * size, high=30.0 * size)
    period = Parameter("wave.period", Prior("log-normal", 0.2 * last, 1.8), unit="s")
    return Cause("wave", (height, period), "a wave", read=waved)


# Each makes a cause, given a usual size, the largest reading, the last time, s, and an input. Times
# of instruments are a few readings.
OF_READINGS = (
    lambda size, most, last: events.step(size, 0.0, 0.9 * last),
    lambda size, most, last: events.pulse(size, 0.0, 0.9 * last, 0.1 * last),
    lambda size, most, last: wave(size, last),
    lambda size, most, last: instruments.scale(),
    lambda size, most, last: instruments.offset("-", size),
    lambda size, most, last: instruments.clipping("-", 1.2 * most, 0.1 * most),
    lambda size, most, last: instruments.lag(last / 60.0),
    lambda size, most, last: instruments.delay(size=last / 60.0),
)
OF_INPUTS = (
    lambda last, u: events.step(0.3, 0.0, 0.9 * last, input=u, name="input_step"),
    lambda last, u: events.pulse(
        0.3, 0.0, 0.9 * last, 0.1 * last, input=u, name="input_pulse"
    ),
    lambda last, u: instruments.lag(last / 60.0, input=u, name="input_lag"),
    lambda last, u: instruments.delay(size=last / 60.0, input=u, name="input_delay"),
)  # fmt: skip
MACHINES = ("relaxed", "oscillator", "line", "circle")


def listed(name, data, size):
    """All causes for the data of a machine."""
    if name == "circle":
        x, z, theta = (slice(k, k + 40) for k in (0, 40, 80))
        return [instruments.marker_place(x, z, size, theta=theta)]
    last, most = float(data.t[-1]), float(np.max(np.abs(data.y)))
    causes = [make(size, most, last) for make in OF_READINGS]
    return causes + [make(last, given) for make in OF_INPUTS for given in data.inputs]


def p_values(name, seed):
    """p-values of a record of a machine with white errors of stated size, by the listed causes.

    These are each cause alone, and all together.
    """
    draw = np.random.default_rng([seed, MACHINES.index(name)])
    predict, constants, sound, make = machine(name, draw)
    sd = 0.02 * float(np.std(sound))
    data = make(sound + sd * draw.standard_normal(len(sound)), sd=sd)
    causes = listed(name, data, 5.0 * sd)
    # With a fault of the data no cause is looked for, and the test is as ever.
    found = run(posed(data, predict, constants, causes), 0, fault=ONLY_TESTED)
    result = {"all": found.test.p_value}
    for cause in causes:
        own = [effect for effect in found.responses if effect.cause.name == cause.name]
        result[cause.name] = tested(found.problem, found.models.null, own, 0).p_value
    return result
