"""The way from data to a verdict, for any forward model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from stickslip.diagnosis.data.data_quality import find_data_problem, uneven_setups
from stickslip.diagnosis.data.noise import NoiseModel, fit_noise, whitener
from stickslip.diagnosis.fit.baseline import recalibrate
from stickslip.diagnosis.fit.fit_result import Fit, Ranking, Start
from stickslip.diagnosis.fit.least_squares import fit_candidates
from stickslip.diagnosis.fit.profile_likelihood import Profile, moved_to_profile_minimum, profile
from stickslip.diagnosis.fit.sensitivity import (
    distinguishability,
    indistinguishable_causes,
    linear_evidence,
)
from stickslip.diagnosis.fit.single_cause import refit_null
from stickslip.diagnosis.inference.cross_validation import (
    folds,
    measure_gain,
    predictive_gain,
    split,
)
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.model_comparison import (
    Progress,
    assess_baseline,
    compare_candidates,
)
from stickslip.diagnosis.inference.smooth_residual import Settings, smooth_residual_bound
from stickslip.diagnosis.inference.upper_bounds import upper_bounds
from stickslip.diagnosis.inference.verdict import (
    Table,
    Verdict,
    checked_on_training_subset,
    decide,
    prior_probabilities,
)
from stickslip.diagnosis.model.prediction_cache import PredictionCache
from stickslip.diagnosis.model.problem import AuxiliaryData, Cause, Predict, Problem, Uncertain
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]


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
    singleton_condition: int | None = None,
    auxiliary: AuxiliaryData | None = None,
    low_fidelity: Predict | None = None,
    settings: Settings | None = None,
    source: Sequence[str] = (),
    data_problem: Fact | str | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Findings:
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
        Of all random draws.
    progress : callable, optional
        ``progress(fraction, stage)`` is told the fraction that is done and what comes next.

    Returns
    -------
    Findings

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
    say = progress or (lambda fraction, stage: None)
    values, index, blocks = _checked(observed, condition, block)
    _check_lengths(
        values, index, order, group, source, 0 if auxiliary is None else len(auxiliary.observed)
    )
    _check_names(uncertain, causes)
    noise, known = _noise(values, index, blocks, relative_sd, sd)
    suspects = tuple(
        Cause(each.name, (), f"{each.name} is other than stated", relaxes_prior=each.name)
        for each in uncertain
        if each.suspect and each.prior.has_middle
    )
    covariance = noise.covariance if known is None else known
    level, dof = noise.mean, noise.dof if noise.dof > 0 else math.inf
    if auxiliary is not None:
        covariance = np.asarray(block_diag(covariance, auxiliary.covariance), dtype=float)
        level = np.concatenate([level, auxiliary.observed])
        # Only the trials' share of the misfit is judged by an estimated noise.
        dof *= (len(level) / len(noise.mean)) ** 2
    problem = Problem(
        PredictionCache(predict, len(level)),
        conditions,
        level,
        whitener(covariance),
        dof,
        tuple(uncertain),
        (*causes, *suspects),
        low_fidelity=None if low_fidelity is None else PredictionCache(low_fidelity, len(level)),
    )
    if data_problem is None and not np.any(
        np.isfinite(problem.predicted(np.zeros((1, problem.size))))
    ):
        raise ScenarioError("predict: with the stated parameters it computes no observable")
    say(0.0, "recalibrating")
    held_out = split(len(noise.mean), seed, group, singleton_condition)
    found = recalibrate(problem, seed)
    null = found.null
    if noise.between > 0.0 or noise.between_gain > 0.0:
        m = len(noise.mean)
        predicted = problem.predicted(null.x[None, :])[0, :m]
        covariance[:m, :m] = noise.covariance_at(
            np.where(np.isfinite(predicted), predicted, noise.mean)
        )
        problem = replace(problem, whiten=whitener(covariance))
        again = fit_candidates(problem, [null.candidate], [[Start.of(null)]], 6)[0]
        null = replace(again, converged=null.converged, starts=null.starts)
    say(0.1, "testing")
    base = assess_baseline(problem, covariance, null, seed)
    notes = list(noise.notes)
    uneven = uneven_setups(values, index, noise, blocks)
    notes += [] if uneven is None else [uneven]
    if isinstance(data_problem, str):
        data_problem = Fact(Code.STATED_PROBLEM, {"problem": data_problem})
    trouble = data_problem or find_data_problem(
        values, index, noise, order, blocks, auxiliary is None
    )
    ranking = Ranking(base.null, (), ())
    if trouble is None and base.detection.found:
        say(0.2, "fitting causes")
        base, ranking = compare_candidates(base, covariance, found, seed, say)
    problem, covariance, roughness = base.problem, base.covariance, base.roughness
    null, detection, sensitivities = base.null, base.detection, base.sensitivities
    say(0.85, "verdict and gain")
    cosines = distinguishability(problem, sensitivities, null.residual)
    parts = folds(len(noise.mean), group)

    def improves_prediction(fit: Fit) -> bool:
        return not parts or predictive_gain(problem, covariance, null, fit, parts) > 0.0

    screened = linear_evidence(problem, sensitivities, null.residual)
    tables = _tables(source, len(noise.mean), noise.dof if noise.dof > 0 else math.inf)
    smooth_bound = None
    if settings is not None and trouble is None and detection.found:
        smooth_bound = smooth_residual_bound(problem, null, settings)
    verdict = decide(
        problem,
        detection,
        ranking,
        cosines,
        screened,
        improves_prediction,
        smooth_bound,
        tables,
    )
    if trouble is not None:
        verdict = Verdict("data-problem", (), None, (trouble,), prior_probabilities(problem))
    profiles: list[Profile] = []
    if verdict.fit is not None and verdict.word in ("named", "pair"):
        leader, profiles = moved_to_profile_minimum(problem, verdict.fit)
        if leader is not verdict.fit:
            # What leads elsewhere has to meet the rules there.
            null = refit_null(problem, null, [leader])
            ranking = replace(ranking.replaced(verdict.fit, leader), null=null)
            verdict = decide(
                problem,
                detection,
                ranking,
                cosines,
                screened,
                improves_prediction,
                smooth_bound,
                tables,
            )
            leads = verdict.fit is leader
            profiles = profiles if leads or verdict.fit is None else profile(problem, verdict.fit)
    elif verdict.fit is not None:
        # The members of a set stay as they were compared.
        profiles = profile(problem, verdict.fit)
    profiles = [] if verdict.fit is None else profiles
    gain = None
    if verdict.fit is not None:
        others = [*ranking.singles[:4], *ranking.pairs[:2]]
        gain = measure_gain(problem, covariance, held_out, null, verdict.fit, others, seed)
    if gain is not None:
        verdict = checked_on_training_subset(verdict, ranking, gain.choice)
    bounds = upper_bounds(problem, sensitivities, null.residual) if verdict.word == "none" else {}
    rough = int(
        np.sum(
            roughness[: len(noise.mean)]
            > np.sqrt(np.diag(covariance)[: len(noise.mean)] - roughness[: len(noise.mean)] ** 2)
        )
    )
    if rough:
        notes.append(Fact(Code.MODEL_JUMPS, {"count": rough}))
    alike = indistinguishable_causes(problem, cosines)
    say(1.0, "done")
    return Findings(
        problem, noise, roughness, null, detection, sensitivities, ranking, cosines,
        alike, verdict, bounds, smooth_bound, gain, tuple(profiles), tuple(notes), seed,
    )  # fmt: skip


def _checked(
    observed: ArrayLike, condition: ArrayLike | None, block: ArrayLike | None
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64] | None]:
    try:
        values = np.asarray(observed, dtype=float)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.ndim != 1 or not len(values) or not np.all(np.isfinite(values)):
        raise ScenarioError("observed: allowed is one row of finite numbers")
    index = np.arange(len(values)) if condition is None else np.asarray(condition, dtype=np.int64)
    if index.shape != values.shape or set(index.tolist()) != set(range(int(index.max()) + 1)):
        raise ScenarioError("condition: allowed is an index from 0 for each trial, none missing")
    blocks = None if block is None else np.asarray(block, dtype=np.int64)
    if blocks is not None and blocks.shape != values.shape:
        raise ScenarioError("block: allowed is an index for each trial")
    return values, index, blocks


def _check_lengths(
    values: Array,
    index: NDArray[np.int64],
    order: ArrayLike | None,
    group: ArrayLike | None,
    source: Sequence[str],
    beside: int,
) -> None:
    count = int(index.max()) + 1
    if order is not None and np.shape(order) != values.shape:
        raise ScenarioError("order: allowed is a number for each trial")
    if group is not None and np.shape(group) != (count,):
        raise ScenarioError("group: allowed is an index for each condition")
    if len(source) not in (0, count + beside):
        raise ScenarioError("source: allowed is a name for each observable")


def _check_names(uncertain: Sequence[Uncertain], causes: Sequence[Cause]) -> None:
    for key, kind, given in (("uncertain", Uncertain, uncertain), ("causes", Cause, causes)):
        if not isinstance(given, Sequence) or not all(isinstance(each, kind) for each in given):
            raise ScenarioError(f"{key}: allowed is a list of {kind.__name__}")
        names = [each.name for each in given]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ScenarioError(f"{key}: {', '.join(twice)} comes twice; allowed is once")
    constants = {each.name for each in uncertain}
    taken = constants | {"none", "unknown"}
    parameters: set[str] = set()
    for cause in causes:
        if cause.name in taken:
            said = "allowed is a name that is no uncertain parameter's, nor none or unknown"
            raise ScenarioError(f"cause {cause.name}: {said}")
        if cause.relaxes_prior is not None and cause.relaxes_prior not in constants:
            said = "allowed is the name of an uncertain parameter"
            raise ScenarioError(
                f"cause {cause.name}: relaxes_prior = {cause.relaxes_prior}: {said}"
            )
        for each in cause.parameters:
            if each.name in parameters:
                raise ScenarioError(f"parameter {each.name} of two causes: allowed is one")
            parameters.add(each.name)


def _tables(source: Sequence[str], measured: int, dof: float) -> list[Table]:
    """Rows of each kind; only the noise of the trials, the first rows, was estimated."""
    kind = np.array(list(source))
    tables = []
    for name in dict.fromkeys(source):
        rows = np.flatnonzero(kind == name)
        tables.append(Table(name, rows, dof if rows[0] < measured else math.inf))
    return tables


def _noise(
    values: Array,
    index: NDArray[np.int64],
    blocks: NDArray[np.int64] | None,
    relative_sd: float,
    sd: ArrayLike | None,
) -> tuple[NoiseModel, Array | None]:
    """Noise, and the covariance of the means where it was given."""
    if sd is None:
        return fit_noise(values, index, blocks, relative_sd), None
    count = np.bincount(index)
    stated = np.asarray(sd, dtype=float)
    if stated.ndim == 2:
        if stated.shape != (len(count), len(count)) or not np.all(np.isfinite(stated)):
            raise ScenarioError("sd: allowed is a covariance of one row a condition")
        covariance = stated
    else:
        if stated.shape not in ((), count.shape):
            raise ScenarioError("sd: allowed is a standard deviation for each condition")
        covariance = np.diag(np.broadcast_to(stated, count.shape) ** 2)
    variance = np.diag(covariance)
    sound = np.all(stated > 0.0) if stated.ndim < 2 else np.all(variance > 0.0)
    if not (sound and np.all(np.isfinite(variance))):
        raise ScenarioError("sd: allowed are finite numbers above 0")
    known = np.sqrt(variance)
    mean = np.bincount(index, values) / count
    none = np.zeros((len(count), 0))
    noise = NoiseModel(mean, known * np.sqrt(count), count, 0.0, 0.0, 0.0, 0.0, math.inf, none, ())
    return noise, covariance
