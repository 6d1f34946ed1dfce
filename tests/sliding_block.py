"""A model of one's own: a block that is pushed, and whose friction may depend on three things."""

import numpy as np

from stickslip import Parameter, Prior, Table, diagnose_model, free_law

# Speed (m/s), load (N) and temperature (K) of 40 conditions; the three do not go together.
_RANDOM = np.random.default_rng(7)
SPEED = np.linspace(0.02, 2.0, 40)
LOAD = _RANDOM.permutation(np.linspace(1.0, 6.0, 40))
WARMTH = _RANDOM.permutation(np.linspace(280.0, 330.0, 40))
SETTINGS = {"speed": SPEED, "load": LOAD, "temperature": WARMTH}
SD = 0.02  # N

UNCERTAIN = (
    Parameter("friction", Prior("normal", 0.3, 0.02), cause=False),
    Parameter("drag", Prior("normal", 0.2, 0.03), "N s/m", cause=False),
)
OVER_SPEED = free_law("friction", "speed", "m/s", 0.0, 2.0, factor_of="friction")
OVER_LOAD = free_law("friction", "load", "N", 1.0, 6.0, factor_of="friction")
OVER_WARMTH = free_law("friction", "temperature", "K", 280.0, 330.0, factor_of="friction")
LAWS = (OVER_SPEED, OVER_LOAD, OVER_WARMTH)
FRICTION, DRAG = 0.31, 0.21
# The law over each argument, and its values at the conditions. All bend more slowly than knots lie.
HIDDEN = {
    OVER_SPEED: (lambda v: 0.3 * np.exp(-v / 0.7), SPEED),
    OVER_LOAD: (lambda n: 0.15 * np.sin(0.7 * n), LOAD),
    OVER_WARMTH: (lambda t: 0.2 * ((t - 305.0) / 25.0) ** 2, WARMTH),
}


def push(table, p, curves):
    """Force that keeps the block at its speed, N, shape (vectors, rows)."""
    factor = 1.0 + sum(curves[law.name](table[law.curve.argument]) for law in LAWS)
    return p["friction"] * factor * table["load"] + p["drag"] * table["speed"]


def measured(seed, factor=1.0, extra=0.0):
    """Forces with a factor of the friction and a further force, and with noise."""
    noise = SD * np.random.default_rng(seed).standard_normal(len(SPEED))
    return FRICTION * factor * LOAD + DRAG * SPEED + extra + noise


def result(observed, laws=LAWS, predict=push, causes=(), **options):
    table = Table(SETTINGS, observed, sd=SD, unit="N")
    return diagnose_model(predict, table, UNCERTAIN, (*causes, *laws), **options)
