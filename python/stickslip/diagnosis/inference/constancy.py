"""The uncertain constants fitted to parts of the data: one that changes points at the physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.fit.multistart import refit
from stickslip.diagnosis.inference.cross_validation import restricted
from stickslip.diagnosis.model.problem import Array, Indices, Problem
from stickslip.facts import Code, Fact

# Chosen: fewest conditions of a part, and standard deviations between two parts from which a
# constant changes; one in eighty does so by chance.
_FEWEST, _STRAINED = 4, 2.5


@dataclass(frozen=True, repr=False, eq=False)
class Part(OneLine):
    """Constants from one part of the conditions.

    Attributes
    ----------
    name : str
    count : int
        Number of conditions.
    x, sd : ndarray, shape (p,)
        Coordinates of the uncertain parameters and their standard deviations.
    """

    name: str
    count: int
    x: Array
    sd: Array


def refit_parts(problem: Problem, null: Fit, parts: Mapping[str, Indices]) -> list[Part]:
    """Fit the constants to each part by itself, from the common fit.

    Parameters
    ----------
    problem : Problem
    null : Fit
        Fit of all conditions.
    parts : dict
        Indices of the conditions of each part, complementary ones one after the other; where one of
        two has fewer than four, both are left out.

    Returns
    -------
    list of Part
    """
    covariance = np.asarray(np.linalg.inv(problem.whiten.T @ problem.whiten), dtype=float)
    names, found = list(parts), []
    for pair in zip(names[::2], names[1::2], strict=True):
        if min(len(parts[name]) for name in pair) < _FEWEST:
            continue
        for name in pair:
            rows = parts[name]
            (fit,) = refit(restricted(problem, rows, covariance), [null], rows=rows)
            sd = np.sqrt(np.diag(fit.covariance))
            found.append(Part(name, len(rows), fit.x[null.candidate.free], sd))
    return found


def changing(problem: Problem, parts: list[Part]) -> list[Fact]:
    """The constants that two complementary parts do not agree about."""
    said = []
    for first, second in zip(parts[::2], parts[1::2], strict=True):
        gap = np.abs(first.x - second.x) / np.hypot(first.sd, second.sd)
        for k in np.flatnonzero(gap > _STRAINED):
            between = {"first": first.name, "second": second.name}
            by = {"gap": float(gap[k]), "limit": _STRAINED}
            name = {"name": problem.uncertain[k].name}
            said.append(Fact(Code.CONSTANT_CHANGES, {**name, **between, **by}))
    return said
