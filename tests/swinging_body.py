"""A model of one's own, a body that swings, with causes of its own and a camera that reads it."""

import numpy as np

from stickslip import Cause, CauseParameter, Prior, Uncertain, diagnose_model, instruments

TIMES = np.linspace(0.0, 4.0, 60)
COUNT = len(TIMES)
X, Z, THETA = (slice(at, at + COUNT) for at in (0, COUNT, 2 * COUNT))
SD = np.repeat([1e-3, 1e-3, 0.01], COUNT)  # m, m, rad
_ARM = 0.2  # m

UNCERTAIN = (
    Uncertain("amplitude", Prior("normal", 0.6, 0.05), "rad"),
    Uncertain("rate", Prior("normal", 4.0, 0.3), "rad/s"),
    Uncertain("damping", Prior("log-normal", 0.1, 1.5), "1/s"),
)
CAUSES = (
    Cause("air_drag", (CauseParameter("air_drag.rate", "1/s", 0.0, 5.0, 0.1),)),
    Cause("softening", (CauseParameter("softening.strength", "-", -3.0, 3.0, 0.1),)),
    Cause("lean", (CauseParameter("lean.angle", "rad", -0.5, 0.5, 0.03),)),
)


def swing(times, parameters):
    """x and z (m) of the body, then theta (rad), at these times, shape (vectors, 3 times)."""
    amplitude, rate, damping, drag, softening, lean = (row[:, None] for row in parameters.T)
    size = amplitude * np.exp(-damping * times) / (1.0 + drag * times)
    slower = np.cumsum(size**2, axis=1) * (times[1] - times[0])
    theta = lean + size * np.cos(rate * (times + softening * slower))
    return np.concatenate([_ARM * np.sin(theta), -_ARM * np.cos(theta), theta], axis=1)


INSTRUMENTS = (
    instruments.marker_place(X, Z, 5e-3, theta=THETA),
    instruments.angle_offset(rows=THETA),
    instruments.scale(rows=X),
    instruments.offset("m", 2e-3, rows=Z),
    instruments.delay(np.tile(TIMES, 3), 0.02, curve=np.repeat([0, 1, 2], COUNT)),
    instruments.clipping("rad", 0.8, 0.2, rows=THETA),
)
READ = instruments.with_instruments(swing, INSTRUMENTS)


def result(seed, hidden=None, sizes=()):
    """Diagnosis of a swing with one suspect hidden in it."""
    random = np.random.default_rng(seed)
    constants = [0.6 + 0.05 * random.standard_normal(), 4.0 + 0.3 * random.standard_normal(), 0.1]
    own = [np.full(len(each.parameters), 0.0) for each in (*CAUSES, *INSTRUMENTS)]
    names = [each.name for each in (*CAUSES, *INSTRUMENTS)]
    if hidden is not None:
        own[names.index(hidden)][:] = sizes
    truth = READ(TIMES, np.concatenate([constants, *own])[None, :])[0]
    values = truth + SD * random.standard_normal(len(truth))
    return diagnose_model(READ, TIMES, values, UNCERTAIN, [*CAUSES, *INSTRUMENTS], sd=SD, seed=seed)
