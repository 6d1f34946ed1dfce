"""A model whose answers are known: a line, a wave on it, and data of stated noise."""

import math

import numpy as np

from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain
from stickslip.diagnosis.fit.fit_result import Start, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.model.problem import Problem

X = np.linspace(1.0, 3.0, 24)
SD = 0.05
SLOPE = Uncertain("slope", Prior("normal", 1.0, 0.5))
WAVE = Cause("wave", (CauseParameter("wave.height", "-", -5.0, 5.0, 1.0),))
BEND = Cause("bend", (CauseParameter("bend.height", "-", -5.0, 5.0, 1.0),))


def line(_, p):
    """Slope times x and, where there is a second column, a wave."""
    return p[:, :1] * X + (p[:, 1:2] * np.sin(4 * X) if p.shape[1] > 1 else 0.0)


def problem(observed, causes=(WAVE,), predict=line):
    return Problem(predict, None, observed, np.eye(len(X)) / SD, math.inf, (SLOPE,), causes)


def fitted(given, causes=()):
    candidate = make_candidate(given, causes)
    return fit_candidates(given, [candidate], [[Start(np.zeros(given.size))]], 20)[0]
