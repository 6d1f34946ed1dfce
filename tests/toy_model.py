"""A cheap forward model with two modes, four uncertain constants and eight causes."""

import functools

import numpy as np

from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain, diagnose_model

SIZE = 30
TRIALS = 3
X = np.tile(np.linspace(0.2, 1.0, SIZE // 2), 2)
MODE = np.repeat([0, 1], SIZE // 2)

_BASIS = np.stack([1 + 0 * X, X, X**2 * MODE, np.where(MODE == 0, 1 - X, 0.5 * X)])
_SIGNATURES = {
    "wave": np.sin(5 * X) * (MODE == 0),
    "swell": np.cos(4 * X) * MODE,
    "split": 2.0 * MODE - 1.0,
    "split_twin": (2.0 * MODE - 1.0) * (1 + 0.05 * X),
    "cube": X**3,
    "ripple": np.sin(9 * X),
    "step": (X > 0.8) * 1.0,
    "tail": X * MODE,
}
CAUSES = tuple(
    Cause(name, (CauseParameter(f"{name}.size", "-", -3.0, 3.0, 0.3),)) for name in _SIGNATURES
)
UNCERTAIN = tuple(Uncertain(f"k{k}", Prior("normal", 0.0, 1.0)) for k in range(4))


def predict(_, parameters):
    """Linear in the causes, and bent in the constants."""
    bent = parameters[:, :4] + 0.03 * parameters[:, :4] ** 2
    base = 1 + X + 0.5 * MODE * X
    return base * (1 + 0.05 * bent @ _BASIS) + 0.3 * parameters[:, 4:] @ np.stack(
        list(_SIGNATURES.values())
    )


def truth(causes=None, constants=None):
    """Observables with causes of these sizes and constants at these values."""
    point = np.zeros((1, 4 + len(CAUSES)))
    if constants is not None:
        point[0, :4] = constants
    for name, size in (causes or {}).items():
        point[0, 4 + list(_SIGNATURES).index(name)] = size
    return predict(None, point)[0]


def trials(level, random, noise=0.03, law=None):
    """Three trials of each condition, and the index of their condition."""
    index = np.repeat(np.arange(SIZE), TRIALS)
    draws = random.standard_normal(len(index)) if law is None else law(random, len(index))
    return level[index] * (1 + noise * draws), index


@functools.cache
def shared_result(seed, **causes):
    """`result` with causes of these sizes, made once for all tests that only look at it."""
    return result(seed, causes)


def shared_diagnosis(seed, **causes):
    """What is found in it."""
    return shared_result(seed, **causes).findings


def diagnosis(seed, *given, **options):
    """What is found in toy data whose constants are drawn from the priors; see `result`."""
    return result(seed, *given, **options).findings


def result(seed, causes=None, shift=None, extra=None, noise=0.03, law=None, **options):
    """Diagnosis of toy data whose constants are drawn from the priors."""
    random = np.random.default_rng(seed)
    constants = random.standard_normal(4)
    for k, value in (shift or {}).items():
        constants[k] = value
    level = truth(causes, constants) + (0.0 if extra is None else extra)
    values, index = trials(level, random, noise, law)
    return diagnose_model(
        predict, None, values, UNCERTAIN, CAUSES, condition=index, seed=seed, **options
    )


def like_the_simulators(name, parameter, unit, scale, size):
    """A diagnosis whose one cause has the name of an effect of the simulator."""
    angle = CauseParameter(f"effects.{name}.{parameter}", unit, -50 * scale, 50 * scale, scale)
    x = np.linspace(0.2, 1.0, 24)

    def model(_, p):
        return p[:, :1] * x + p[:, 1:] / scale * np.cos(6.0 * x)

    observed = model(None, np.array([[0.3, size]]))[0]
    slope = Uncertain("slope", Prior("normal", 0.0, 1.0), suspect=False)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(x))
    causes = [Cause(name, (angle,), "a meaning")]
    return diagnose_model(model, None, observed + noise, [slope], causes, sd=0.02)
