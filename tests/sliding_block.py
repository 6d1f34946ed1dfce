"""A model of one's own: a block that is pushed, and whose friction may depend on three things."""

import numpy as np

from stickslip import FreeTerm, Prior, Uncertain, diagnose_model

# Speed (m/s), load (N) and temperature (K) of 40 conditions; the three do not go together.
_RANDOM = np.random.default_rng(7)
SPEED = np.linspace(0.02, 2.0, 40)
LOAD = _RANDOM.permutation(np.linspace(1.0, 6.0, 40))
WARMTH = _RANDOM.permutation(np.linspace(280.0, 330.0, 40))
CONDITIONS = (SPEED, LOAD, WARMTH)
SD = 0.02  # N

UNCERTAIN = (
    Uncertain("friction", Prior("normal", 0.3, 0.02), suspect=False),
    Uncertain("drag", Prior("normal", 0.2, 0.03), "N s/m", suspect=False),
)
OVER_SPEED = FreeTerm("friction", "speed", "m/s", 0.0, 2.0, factor_of="friction")
OVER_LOAD = FreeTerm("friction", "load", "N", 1.0, 6.0, factor_of="friction")
OVER_WARMTH = FreeTerm("friction", "temperature", "K", 280.0, 330.0, factor_of="friction")
TERMS = (OVER_SPEED, OVER_LOAD, OVER_WARMTH)
FRICTION, DRAG = 0.31, 0.21
# The law over each argument, and its values at the conditions. All bend more slowly than knots lie.
HIDDEN = {
    OVER_SPEED: (lambda v: 0.3 * np.exp(-v / 0.7), SPEED),
    OVER_LOAD: (lambda n: 0.15 * np.sin(0.7 * n), LOAD),
    OVER_WARMTH: (lambda t: 0.2 * ((t - 305.0) / 25.0) ** 2, WARMTH),
}


def push(conditions, parameters, curves):
    """Force that keeps the block at its speed, N, shape (vectors, conditions)."""
    friction, drag = parameters.T[:2, :, None]
    factor = 1.0 + sum(curves[term.name](u) for term, u in zip(TERMS, conditions, strict=True))
    return friction * factor * conditions[1] + drag * conditions[0]


def measured(seed, factor=1.0, extra=0.0):
    """Forces with a factor of the friction and a further force, and with noise."""
    noise = SD * np.random.default_rng(seed).standard_normal(len(SPEED))
    return FRICTION * factor * LOAD + DRAG * SPEED + extra + noise


def result(observed, terms=TERMS, predict=push, causes=(), **options):
    return diagnose_model(
        predict, CONDITIONS, observed, UNCERTAIN, causes, free_terms=terms,
        sd=np.full(len(SPEED), SD), **options,
    )  # fmt: skip
