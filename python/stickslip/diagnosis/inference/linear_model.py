"""A model with a curve of free shape, linear about its fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Fit, free_parameters
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.problem import Problem


@dataclass(frozen=True)
class LinearModel:
    """The data as a linear function of the constants and the knots, about the fit of a curve.

    The priors of the constants are in it, and those of the knots are not.

    Attributes
    ----------
    whiten : ndarray, shape (m, m)
    constants : ndarray, shape (constants,)
        Their coordinates there.
    slope : ndarray, shape (m, constants)
        Derivatives of the prediction by them.
    by_knots : ndarray, shape (m, knots)
        The same by the values at the knots.
    design : ndarray, shape (m + constants, constants)
        `slope`, whitened, with the rows of the constants' priors.
    residual : ndarray, shape (m + constants,)
        What is left without the curve, whitened.
    """

    whiten: Array
    constants: Array
    slope: Array
    by_knots: Array
    design: Array
    residual: Array

    @staticmethod
    def about(problem: Problem, term: Term, fit: Fit) -> LinearModel:
        """The derivatives that the fit has ended with."""
        base, m = problem.base_count, len(problem.observed)
        knots = [each for each in free_parameters(problem, fit) if each.name in term.knots]
        by_knots = fit.slope[:, [each.position for each in knots]]
        by_knots = by_knots / [each.slope(fit) for each in knots]
        now = problem.physical(fit.x[None, :])[0][[each.column for each in knots]]
        residual = fit.residual[: m + base].copy()
        residual[:m] += problem.whiten @ (by_knots @ now)
        return LinearModel(
            problem.whiten,
            fit.x[:base],
            fit.slope[:, :base],
            by_knots,
            fit.jacobian[: m + base, :base],
            residual,
        )

    def beside(self, response: Array, size: float) -> tuple[float, float, Array]:
        """Chi-square at best, factor, and step of the constants, beside a response of factor 1.

        `size` is of the factor, whose prior keeps it finite where the data say nothing.
        """
        base = len(self.constants)
        column = np.concatenate([self.whiten @ response, np.zeros(base), [1.0 / size]])
        rows = np.vstack([self.design, np.zeros(base)])
        target = np.append(self.residual, 0.0)
        step = np.linalg.lstsq(np.column_stack([rows, column]), target, rcond=None)[0]
        left = target - rows @ step[:base] - column * step[base]
        return float(left @ left), float(step[base]), step[:base]

    def of_knots(self) -> tuple[Array, Array, Array, Array]:
        """What the data say of the knots, and the constants beside them.

        Returns
        -------
        precision : ndarray, shape (knots, knots)
            Inverse covariance of the knots, whatever the constants.
        pull : ndarray, shape (knots,)
            `precision` times the knots that the data want.
        spread : ndarray, shape (constants, constants)
            Covariance of the constants for given knots.
        follow : ndarray, shape (constants, knots)
            By how much the constants follow the knots.
        """
        solve = np.linalg.pinv(self.design)
        response = np.zeros((len(self.residual), self.by_knots.shape[1]))
        response[: len(self.by_knots)] = self.whiten @ self.by_knots
        follow = -solve @ response
        alone = response + self.design @ follow
        return alone.T @ alone, alone.T @ self.residual, solve @ solve.T, follow
