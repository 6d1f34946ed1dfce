"""What is optional in a diagnosis, in one place."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.number_text import is_number
from stickslip._util.one_line import OneLine
from stickslip.diagnosis.inference.model_comparison import Progress
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.model.problem import AuxiliaryData, Predict
from stickslip.errors import ScenarioError
from stickslip.facts import Fact
from stickslip.scenario.keys import check_whole, refuse, suggestion


@dataclass(frozen=True, repr=False, eq=False)
class Options(OneLine):
    """What is optional in a diagnosis of n trials at m conditions.

    Attributes
    ----------
    condition : array_like of int, shape (n,), optional
        Index of each trial's condition; without it every trial is a condition of its own.
    block, order : array_like, shape (n,), optional
        Index of each trial's set-up (-1: not known), and its place in time, a number.
    run : array_like of int, shape (n,), optional
        Index of the run in which each trial was read (-1: not known), such as a sweep over a curve
        or a film. Errors of readings that follow each other in a run may be correlated; in the
        order of `order` where all trials of a run have one, else in that of the rows. Without it
        errors are taken as independent, but for those that set-ups share.
    relative_sd : float
        Relative error of one trial, above 0, used where repeats are too few; NaN if not known.
    sd : array_like, shape (m,) or (m, m), optional
        Standard deviation of the mean of each condition in the observable's unit, or their
        covariance, if it is known otherwise; no noise is estimated then. A covariance is used as it
        is; to standard deviations the correlation within runs is added.
    group : array_like of int, shape (m,), optional
        Conditions that are held out together, numbered from 0; each by itself if not given.
    singleton_condition : int, optional
        A condition that is like no other; it is held out too.
    auxiliary : AuxiliaryData, optional
        Further observables, whose errors are known; `predict` returns them after the conditions.
    low_fidelity : callable, optional
        A cheaper `predict` for the search from afar, where errors are taken as too large: by three
        times and more.
    settings : Settings, optional
        Where the conditions lie. With them, a cause is only named that takes at least 70 % of what
        a smooth function would take from the misfit.
    source : sequence of str, length m and that of `auxiliary`, optional
        What kind of table each observable is from. A cause is not named against one of them.
    data_problem : Fact or str, optional
        What makes the data suspect, if that is known before; the verdict is data-problem then.
    seed : int
        From 0. Of the scans of the recalibration, the draws of the tests and the choice of what is
        held out. The further starts of a fit and of a profile are drawn from fixed generators, the
        same for every seed.
    progress : callable, optional
        ``progress(fraction, stage)`` is told the fraction that is done and what comes next.

    Raises
    ------
    ScenarioError
        If a number is not allowed, or what should be an index is no whole number.
    """

    condition: ArrayLike | None = None
    block: ArrayLike | None = None
    order: ArrayLike | None = None
    run: ArrayLike | None = None
    relative_sd: float = math.nan
    sd: ArrayLike | None = None
    group: ArrayLike | None = None
    singleton_condition: int | None = None
    auxiliary: AuxiliaryData | None = None
    low_fidelity: Predict | None = None
    settings: Settings | None = None
    source: Sequence[str] = ()
    data_problem: Fact | str | None = None
    seed: int = 0
    progress: Progress | None = None

    def __post_init__(self) -> None:
        sd = self.relative_sd
        if not is_number(sd) or sd <= 0.0 or math.isinf(sd):
            refuse("relative_sd", sd, "a number above 0, or NaN")
        check_whole("seed", self.seed)
        object.__setattr__(self, "seed", int(self.seed))  # of numpy's numbers too
        if self.singleton_condition is not None:
            check_whole("singleton_condition", self.singleton_condition)
        for name in ("condition", "block", "run", "group"):
            if getattr(self, name) is not None:
                _check_indices(name, getattr(self, name))


def _check_indices(name: str, values: ArrayLike) -> None:
    """Refuse what an array of indices would cut off."""
    try:
        given = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        given = np.array(math.nan)
    if not np.all(np.isfinite(given) & (given == np.round(given))):
        raise ScenarioError(f"{name}: allowed are whole numbers")


def changed(options: Options | None, changes: Mapping[str, Any]) -> Options:
    """Options, the default ones if there are none, with some of them changed.

    Raises
    ------
    TypeError
        If `options` is not an Options, or there is no option of a name; the nearest one is named.
    """
    options = Options() if options is None else options
    if not isinstance(options, Options):
        raise TypeError(f"options = {options!r}: allowed is an Options")
    known = [each.name for each in fields(Options)]
    for name in changes:
        if name not in known:
            raise TypeError(f"there is no option {name}; {suggestion(name, known)}")
    return replace(options, **changes)
