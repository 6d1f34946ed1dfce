"""Where fits of the causes begin: points at which the responses of all causes are known."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit, Start
from stickslip.diagnosis.fit.sensitivity import (
    Screened,
    Sensitivities,
    find_sensitivities,
    projected_responses,
    screen,
)
from stickslip.diagnosis.model.problem import Array, Problem

# The numbers below are chosen, not derived.
#
# Largest Gauss-Newton step of a coordinate toward the minimum: two standard deviations of the
# prior; a longer one is no linear matter.
_LARGEST_STEP = 2.0
# Least multiple of a response with which a start has its cause: with less the search would begin
# where a cause behind a threshold has no slope.
_LEAST_MULTIPLE = 0.3
# Least and largest multiple where nothing but the cause moves: near the response that was
# simulated, as no constant corrects what the multiple misses.
_ALONE = 0.5, 1.5


@dataclass(frozen=True, repr=False)
class View(OneLine):
    """A fit, and the responses of all causes about it that it does not have itself."""

    problem: Problem
    fit: Fit
    sensitivities: Sensitivities

    @staticmethod
    def of(problem: Problem, fit: Fit) -> View:
        """The responses simulated at a fit."""
        return View(problem, fit, find_sensitivities(problem, fit))

    def moved_to(self, fit: Fit, factor: float) -> View:
        """The same responses about another fit, with errors larger by a factor.

        The responses are not simulated again, but what the constants can make up for, and what is
        left to be explained, are those of the other fit.
        """
        m, free = len(self.problem.observed), fit.candidate.free
        weight = np.concatenate([np.full(m, 1.0 / factor), np.ones(len(free))])
        residual, jacobian = fit.residual * weight, fit.jacobian * weight[:, None]
        chi2 = float(residual @ residual)
        softer = replace(fit, residual=residual, jacobian=jacobian, chi2=chi2)
        raw = self.sensitivities.raw * weight
        projected, basis, move = projected_responses(raw, jacobian)
        point = self.sensitivities.point.copy()
        point[:, free] = fit.x[free] - move
        moved = replace(self.sensitivities, point=point, raw=raw, projected=projected, basis=basis)
        return View(self.problem, softer, moved)

    @cached_property
    def screened(self) -> Screened:
        """What every row would explain of the fit's residual, by linear estimate."""
        return screen(self.sensitivities, self.fit.residual)

    @cached_property
    def linear_step(self) -> Array:
        """Gauss-Newton step of the free coordinates; zero at the best fit, shape (free,)."""
        step = np.linalg.lstsq(self.fit.jacobian, self.fit.residual, rcond=None)[0]
        return np.clip(step, -_LARGEST_STEP, _LARGEST_STEP)

    def starts(self, cause: int, count: int) -> list[tuple[float, Start]]:
        """Starts of a cause at its most promising amplitudes, of both signs first.

        Each with what is left of chi-square there by linear estimate. Causes that the fit has are
        there too.
        """
        found, fit = self.sensitivities, self.fit
        rows = found.seen_rows(cause)
        rows = rows[np.argsort(self.screened.left[rows], kind="stable")]
        first: dict[tuple[int, float], int] = {}
        for row in rows.tolist():
            first.setdefault((int(found.at[row]), float(np.sign(found.amplitude[row]))), row)
        chosen = [*first.values(), *(row for row in rows.tolist() if row not in first.values())]
        # What the constants would gain by themselves is common to all rows.
        own = float(np.sum((found.basis.T @ fit.residual) ** 2))
        free = fit.candidate.free
        result = []
        for row in chosen[:count]:
            scale = max(float(self.screened.scale[row]), _LEAST_MULTIPLE)
            x = found.point[row].copy()
            x[free] = fit.x[free] + scale * (x[free] - fit.x[free]) + self.linear_step
            left = float(self.screened.left[row]) - own
            result.append((left, self.start_with(row, x, scale)))
        return result

    def starts_at(self, cause: int) -> list[Start]:
        """Starts at which a cause is added to the fit and nothing else moves, of either sign."""
        found, base = self.sensitivities, self.problem.base_count
        if self.problem.causes[cause].relaxes_prior is not None:
            return [Start.of(self.fit)]
        result = []
        seen = found.seen_rows(cause)
        for sign in (1.0, -1.0):
            rows = seen[np.sign(found.amplitude[seen]) == sign]
            if not len(rows):
                continue
            raw = found.raw[rows]
            power = np.sum(raw**2, axis=1) + found.amplitude[rows] ** 2
            along = raw @ self.fit.residual
            scale = np.clip(along / power, *_ALONE)
            k = int(np.argmax(2.0 * scale * along - scale**2 * power))
            x = self.fit.x.copy()
            x[base:] = found.point[rows[k], base:]
            # The causes that the fit has stay where they are too.
            own = self.fit.candidate.free[self.fit.candidate.free >= base]
            x[own] = self.fit.x[own]
            result.append(self.start_with(int(rows[k]), x, float(scale[k])))
        return result

    def start_with(self, row: int, x: Array, scale: float) -> Start:
        """A start with a multiple of a row's amplitude, and the derivatives that its gap gives."""
        found, fit = self.sensitivities, self.fit
        at = int(found.at[row])
        if at < 0:
            return Start(x, fit.slope)
        x[at] *= scale
        added = self.problem.columns([self.problem.causes[found.cause[row]]])
        every = sorted([*fit.candidate.free, *added])
        slope = np.zeros((len(self.problem.observed), len(every)))
        slope[:, [every.index(k) for k in fit.candidate.free]] = fit.slope
        slope[:, every.index(at)] = found.gap[row] / found.amplitude[row]
        return Start(x, slope)
