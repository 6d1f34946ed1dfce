"""A claim needs 19:1 by likelihood against an exchange: how often, by strength and cosine."""

import numpy as np
import pytest

from stickslip import Cause, Parameter, Prior, Table, diagnose_model

X = np.linspace(0.0, 1.0, 40)
WAVE = np.cos(2.0 * np.pi * X) * np.sqrt(2.0 / 40.0)
OTHER = np.cos(4.0 * np.pi * X) * np.sqrt(2.0 / 40.0)  # at right angles, both of norm 1


def claims(strength, cosine, logs):
    """How many of some logs end in a claim, and whether one of them is wrong."""
    twin = cosine * WAVE + np.sqrt(1.0 - cosine**2) * OTHER
    names = {"wave": WAVE, "twin": twin}
    causes = [Cause(name, Parameter(f"{name}.size", size=5.0, low=-100.0, high=100.0))
              for name in names]  # fmt: skip
    level = Parameter("level", Prior("normal", 0.0, 1e-3), cause=False)

    def model(table, p):
        return p["level"] + sum(p[f"{name}.size"] * shape for name, shape in names.items())

    random, found = np.random.default_rng(round(1e3 * cosine)), []
    for _ in range(logs):
        table = Table({"x": X}, strength * WAVE + random.standard_normal(40), sd=1.0)
        verdict = diagnose_model(model, table, [level], causes).verdict
        found.append(verdict.causes if verdict.claims else ())
    return found


@pytest.mark.parametrize(
    ("strength", "cosine", "least", "most"),
    [(5.0, 0.95, 0.0, 0.35), (8.0, 0.5, 0.85, 1.0), (15.0, 0.95, 0.8, 1.0), (25.0, 0.98, 0.85, 1.0),
     (15.0, 0.999, 0.0, 0.2)],
)  # fmt: skip
def test_a_claim_is_as_frequent_as_likelihood_lets(strength, cosine, least, most):
    logs = 12
    found = claims(strength, cosine, logs)
    share = sum(each == ("wave",) for each in found) / logs
    assert least <= share <= most
    # A wrong one: the twin fits better by the exchange, one time in hundreds.
    assert sum("twin" in each for each in found) <= 1
