"""How much of a misfit any smooth function of the conditions could explain.

A Gaussian process over the conditions' settings, orthogonal to what recalibration can do. A cause
that explains much less than it leaves something smooth behind.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.model.problem import Array, Indices, Problem

# Standard deviations of the process in errors, and correlation lengths in standard deviations of
# the settings. Chosen: factors of two.
_SIZES = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
_LENGTHS = (0.3, 0.6, 1.2, 2.4)


@dataclass(frozen=True, repr=False, eq=False)
class Settings(OneLine):
    """Where the first n observables were taken.

    Attributes
    ----------
    numbers : ndarray, shape (n, d)
        Numbers that describe them, such as the logarithm of the frequency.
    kinds : ndarray of int, shape (n,)
        Observables of different kinds, such as modes, share nothing but the process' parameters.
    """

    numbers: Array
    kinds: Indices


def smooth_residual_bound(problem: Problem, null: Fit, settings: Settings) -> float:
    """Chi-square that the smooth function takes from the recalibrated model's misfit.

    Less what it would take of pure noise on average.

    Parameters
    ----------
    problem : Problem
    null : Fit
        The recalibrated model.
    settings : Settings
    """
    n, size = len(settings.numbers), len(null.residual)
    spread = np.std(settings.numbers, axis=0)
    scaled = settings.numbers[:, spread > 0.0] / spread[spread > 0.0]
    distance = np.sum((scaled[:, None, :] - scaled[None, :, :]) ** 2, axis=2)
    same = settings.kinds[:, None] == settings.kinds[None, :]
    basis = np.linalg.qr(null.jacobian)[0]
    project = np.eye(size) - basis @ basis.T
    residual = project @ null.residual
    best, taken = -np.inf, 0.0
    for amplitude, length in itertools.product(_SIZES, _LENGTHS):
        kernel = np.zeros((size, size))
        kernel[:n, :n] = amplitude**2 * np.exp(-0.5 * distance / length**2) * same
        signal = project @ kernel @ project
        total = signal + np.eye(size)
        solved = np.linalg.solve(total, residual)
        score = -0.5 * residual @ solved - 0.5 * np.linalg.slogdet(total)[1]
        if score > best:
            left = residual - signal @ solved
            smoother = np.linalg.solve(total, signal)
            by_noise = 2.0 * np.trace(smoother) - np.sum(smoother**2)
            best, taken = float(score), float(residual @ residual - left @ left - by_noise)
    return max(taken, 0.0)
