"""The way from data to a verdict, for any forward model."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from stickslip.diagnosis.checks import data_problem
from stickslip.diagnosis.detection import Detection, detect
from stickslip.diagnosis.fitting import Fit, fit_rivals, make_rival, scan
from stickslip.diagnosis.heldout import Gain, measure_gain, split
from stickslip.diagnosis.model import Cause, Predict, Problem, Uncertain
from stickslip.diagnosis.noise import NoiseModel, fit_noise, whitener
from stickslip.diagnosis.rivals import (
    COMFORTABLE,
    Ranking,
    adequacy,
    fit_pairs,
    fit_singles,
    refine,
)
from stickslip.diagnosis.signatures import (
    Signatures,
    classes,
    find_signatures,
    isolability,
    upper_bounds,
)
from stickslip.diagnosis.verdict import Verdict, decide
from stickslip.errors import ScenarioError

Array = NDArray[np.float64]

_SCAN = 256
_STARTS = 4
_ROUGH_STEP = 0.02
_ROUGH_DRAWS = 24

Report = Callable[[float], object]


@dataclass(frozen=True)
class Known:
    """Observables beside the trials, of another kind, whose errors are known.

    Attributes
    ----------
    observed : ndarray, shape (k,)
    covariance : ndarray, shape (k, k)
    group : ndarray of int, shape (k,)
        Observables that belong together, numbered from 0.
    """

    observed: Array
    covariance: Array
    group: NDArray[np.int64]


@dataclass(frozen=True)
class Diagnosis:
    """All that the engine found.

    Attributes
    ----------
    problem : Problem
    noise : NoiseModel
    roughness : ndarray, shape (m,)
        Scatter of the model itself under tiny changes of its parameters, in the observable's unit;
        part of the errors.
    null : Fit
        The recalibrated model.
    detection : Detection
    signatures : Signatures
    ranking : Ranking
    cosines : ndarray, shape (causes, causes)
    classes : list of tuple of str
        Causes that this data can hardly tell apart.
    verdict : Verdict
    bounds : dict
        95 % upper limits, filled for the verdict none.
    gain : Gain, optional
    notes : tuple of str
    seed : int
    """

    problem: Problem
    noise: NoiseModel
    roughness: Array
    null: Fit
    detection: Detection
    signatures: Signatures
    ranking: Ranking
    cosines: Array
    classes: list[tuple[str, ...]]
    verdict: Verdict
    bounds: dict[str, float]
    gain: Gain | None
    notes: tuple[str, ...]
    seed: int


def diagnose_model(
    predict: Predict,
    conditions: Any,
    observed: ArrayLike,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause] = (),
    *,
    condition: ArrayLike | None = None,
    block: ArrayLike | None = None,
    order: ArrayLike | None = None,
    relative_sd: float = math.nan,
    sd: ArrayLike | None = None,
    group: ArrayLike | None = None,
    also: Known | None = None,
    seed: int = 0,
    progress: Report | None = None,
) -> Diagnosis:
    """Diagnose measured data with a forward model of one's own.

    Parameters
    ----------
    predict : callable
        ``predict(conditions, parameters)`` takes parameters of shape (vectors, parameters), the
        uncertain ones and then those of all causes in their order and units, and returns
        observables of shape (vectors, m). What it cannot compute is NaN.
    conditions : Any
        Handed to `predict` as it is; m conditions.
    observed : array_like, shape (n,)
        Trials, in the observable's unit.
    uncertain : sequence of Uncertain
    causes : sequence of Cause
        To them a suspect is added for every uncertain parameter whose prior is not a mere range.
    condition : array_like of int, shape (n,), optional
        Index of each trial's condition; without it every trial is a condition of its own.
    block, order : array_like, shape (n,), optional
        Index of each trial's set-up (-1: not known), and its place in time.
    relative_sd : float
        Relative error of one trial, used where repeats are too few.
    sd : array_like, shape (m,) or (m, m), optional
        Standard deviation of the mean of each condition, or their covariance, if it is known
        otherwise; no noise is estimated then.
    group : array_like of int, shape (m,), optional
        Conditions that are held out together, numbered from 0; each by itself if not given.
    also : Known, optional
        Further observables, whose errors are known; `predict` returns them after the conditions.
    seed : int
        Of all random draws.
    progress : callable, optional
        Called with the fraction that is done.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ScenarioError
        If shapes do not fit or nothing finite was observed.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip.diagnosis import Cause, CauseParameter, Uncertain, diagnose_model
    >>> from stickslip.measurement import Prior
    >>> x = np.linspace(1.0, 3.0, 12)
    >>> def line(x, p):
    ...     return p[:, :1] * x + p[:, 1:2] * np.sin(5 * x)
    >>> slope = Uncertain("slope", Prior("normal", 1.0, 0.1))
    >>> wave = Cause("wave", (CauseParameter("wave.height", "-", -5, 5, 0.5),))
    >>> found = diagnose_model(line, x, x + np.sin(5 * x), [slope], [wave], sd=np.full(12, 0.1))
    >>> found.verdict.word, found.verdict.causes
    ('named', ('wave',))
    """
    say = progress or (lambda fraction: None)
    values, index, blocks = _checked(observed, condition, block)
    noise = _noise(values, index, blocks, relative_sd, sd)
    suspects = tuple(
        Cause(each.name, (), f"{each.name} is other than stated", frees=each.name)
        for each in uncertain
        if each.suspect and each.prior.kind != "log-uniform"
    )
    covariance, level, dof = noise.covariance, noise.mean, noise.dof if noise.dof > 0 else math.inf
    if also is not None:
        covariance = np.asarray(block_diag(covariance, also.covariance), dtype=float)
        level = np.concatenate([level, also.observed])
        # Only the trials' share of the misfit is judged by an estimated noise.
        dof *= (len(level) / len(noise.mean)) ** 2
    problem = Problem(
        predict,
        conditions,
        level,
        whitener(covariance),
        dof,
        tuple(uncertain),
        (*causes, *suspects),
    )
    held_out = split(len(noise.mean), seed, group)
    scanned, null = recalibrate(problem, seed)
    say(0.15)
    roughness = model_roughness(problem, null, seed)
    covariance = covariance + np.diag(roughness**2)
    problem = replace(problem, whiten=whitener(covariance))
    null = fit_rivals(problem, [null.rival], [[null.x, *scanned[:2]]], 6, clouds=3)[0]
    say(0.25)
    signatures = find_signatures(problem, null)
    detection = detect(problem, null, signatures, seed)
    say(0.35)
    notes = list(noise.notes)
    trouble = data_problem(values, index, noise, order)
    ranking = Ranking(null, (), ())
    if trouble is None and (detection.found or detection.p_value < 0.3):
        singles = fit_singles(problem, null, signatures)
        if singles:
            # The best rival may sit where the model jumps more than at the null; its scatter counts
            # for all alike. The quick fits are only starts after this.
            more = np.maximum(roughness, model_roughness(problem, singles[0], seed))
            covariance = covariance + np.diag(more**2 - roughness**2)
            roughness = more
            problem = replace(problem, whiten=whitener(covariance))
            known = [null, *singles]
            again = fit_rivals(problem, [fit.rival for fit in known], [[fit.x] for fit in known], 1)
            null, singles = again[0], refine(problem, again[1:], scanned[:8])
        ranking = Ranking(null, singles, ())
        say(0.7)
        # The best single of two effects is often neither, so adequacy decides and not the rank.
        sufficient = any(adequacy(problem, fit) >= COMFORTABLE for fit in singles[:3])
        if detection.found and singles and not sufficient:
            ranking = Ranking(null, singles, fit_pairs(problem, singles[:8], scanned))
    say(0.9)
    cosines = isolability(problem, signatures, null.residual)
    gains: dict[str, Gain | None] = {}

    def gain_of(fit: Fit) -> Gain | None:
        if fit.name not in gains:
            others = [*ranking.singles[:5], *ranking.pairs[:3]]
            gains[fit.name] = measure_gain(problem, covariance, held_out, null, fit, others, seed)
        return gains[fit.name]

    def helps(fit: Fit) -> bool:
        gain = gain_of(fit)
        return gain is None or gain.chi2_after < gain.chi2_before

    verdict = decide(problem, detection, ranking, cosines, helps)
    if trouble is not None:
        verdict = Verdict("data-problem", (), None, (trouble,), verdict.probabilities)
    gain = None if verdict.fit is None else gain_of(verdict.fit)
    bounds = upper_bounds(problem, signatures, null.residual) if verdict.word == "none" else {}
    rough = int(np.sum(roughness[: len(noise.mean)] > np.sqrt(np.diag(noise.covariance))))
    if rough:
        notes.append(
            f"at {rough} conditions the model itself jumps by more than the noise under tiny "
            "changes of its parameters; they count less"
        )
    say(1.0)
    return Diagnosis(
        problem, noise, roughness, null, detection, signatures, ranking, cosines,
        classes(problem, cosines), verdict, bounds, gain, tuple(notes), seed,
    )  # fmt: skip


def recalibrate(problem: Problem, seed: int) -> tuple[Array, Fit]:
    """Scan of the prior and the fit of the model without any cause, from several starts."""
    count = _SCAN if problem.base_count > 1 else 64
    scanned, _ = scan(problem, count, seed)
    starts = _apart(scanned, _STARTS)
    null = fit_rivals(problem, [make_rival(problem)], [starts], 10, clouds=2)[0]
    return scanned, null


def _apart(points: Array, count: int) -> list[Array]:
    """The best points that are not close to a better one."""
    chosen: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > 0.7 for other in chosen):
            chosen.append(point)
        if len(chosen) == count:
            break
    return chosen


def model_roughness(problem: Problem, null: Fit, seed: int) -> Array:
    """Scatter of the prediction about a plane under tiny changes of the uncertain parameters.

    Where the motion is sensitive, a prediction is no better than this, whatever the tolerance of
    the simulator.
    """
    p = problem.base_count
    random = np.random.default_rng([seed, 5])
    count = max(_ROUGH_DRAWS, 3 * p)
    move = random.standard_normal((count, p)) * _ROUGH_STEP
    x = np.tile(null.x, (count, 1))
    x[:, :p] += move
    predicted = problem.predicted(x)
    predicted = np.where(np.isfinite(predicted), predicted, np.nan)
    level = np.nanmean(np.where(np.isfinite(predicted).any(axis=0), predicted, 0.0), axis=0)
    filled = np.where(np.isfinite(predicted), predicted, level)
    design = np.hstack([np.ones((count, 1)), move / _ROUGH_STEP])
    left = filled - design @ np.linalg.lstsq(design, filled, rcond=None)[0]
    return np.asarray(np.sqrt(np.sum(left**2, axis=0) / max(count - p - 1, 1)))


def _checked(
    observed: ArrayLike, condition: ArrayLike | None, block: ArrayLike | None
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64] | None]:
    values = np.asarray(observed, dtype=float)
    if values.ndim != 1 or not len(values) or not np.all(np.isfinite(values)):
        raise ScenarioError("observed: allowed is one row of finite numbers")
    index = np.arange(len(values)) if condition is None else np.asarray(condition, dtype=np.int64)
    if index.shape != values.shape or set(index.tolist()) != set(range(int(index.max()) + 1)):
        raise ScenarioError("condition: allowed is an index from 0 for each trial, none missing")
    blocks = None if block is None else np.asarray(block, dtype=np.int64)
    if blocks is not None and blocks.shape != values.shape:
        raise ScenarioError("block: allowed is an index for each trial")
    return values, index, blocks


def _noise(
    values: Array,
    index: NDArray[np.int64],
    blocks: NDArray[np.int64] | None,
    relative_sd: float,
    sd: ArrayLike | None,
) -> NoiseModel:
    if sd is None:
        return fit_noise(values, index, blocks, relative_sd)
    count = np.bincount(index)
    stated = np.asarray(sd, dtype=float)
    if stated.ndim == 2:
        if stated.shape != (len(count), len(count)) or not np.all(np.isfinite(stated)):
            raise ScenarioError("sd: allowed is a covariance of one row a condition")
        covariance = stated
    else:
        covariance = np.diag(np.broadcast_to(stated, count.shape) ** 2)
    known = np.sqrt(np.diag(covariance))
    if not (np.all(np.isfinite(known)) and np.all(known > 0.0)):
        raise ScenarioError("sd: allowed are finite numbers above 0")
    mean = np.bincount(index, values) / count
    return NoiseModel(mean, known * np.sqrt(count), count, 0.0, 0.0, 0.0, math.inf, covariance, ())
