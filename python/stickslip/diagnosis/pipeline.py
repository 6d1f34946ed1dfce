"""The steps of a diagnosis by name, for any forward model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag

from stickslip.diagnosis.data.data_quality import find_data_problem, uneven_setups
from stickslip.diagnosis.data.error_correlation import (
    as_correlated_as_possible,
    with_correlation,
)
from stickslip.diagnosis.data.trial_noise import NoiseModel, fit_noise, stated_noise, whitener
from stickslip.diagnosis.data.trials import Trials
from stickslip.diagnosis.fit.baseline import Recalibration, recalibrate
from stickslip.diagnosis.fit.distinguishability import distinguishability, indistinguishable_causes
from stickslip.diagnosis.fit.fit_result import Fit, Ranking
from stickslip.diagnosis.fit.multistart import refit_keeping_starts
from stickslip.diagnosis.fit.profile_likelihood import Profile, moved_to_profile_minimum, profile
from stickslip.diagnosis.fit.sensitivity import linear_evidence
from stickslip.diagnosis.inference import cross_validation
from stickslip.diagnosis.inference.claim_checks import (
    CorrelatedLead,
    checked_on_training_subset,
    checked_with_correlation,
)
from stickslip.diagnosis.inference.cross_validation import Gain, measure_gain
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.model_comparison import (
    AssessedBaseline,
    Progress,
    assess_baseline,
    compare_candidates,
    explore,
)
from stickslip.diagnosis.inference.probabilities import prior_probabilities
from stickslip.diagnosis.inference.smooth_residual import smooth_residual_bound
from stickslip.diagnosis.inference.upper_bounds import upper_bounds
from stickslip.diagnosis.inference.verdict import Table, Verdict, decide
from stickslip.diagnosis.input_checks import check_inputs
from stickslip.diagnosis.model.prediction_cache import PredictionCache
from stickslip.diagnosis.model.problem import Array, Cause, Predict, Problem, Uncertain
from stickslip.diagnosis.options import Options
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact


class State:
    """What one diagnosis knows so far. Each step reads what those before it have set."""

    noise: NoiseModel
    # Of the data alone, shape (m, m).
    covariance: Array
    # With the errors of `covariance`; `base` has the model's own scatter besides.
    problem: Problem
    recalibration: Recalibration
    # The candidates and the profiles may lead to a better one.
    base: AssessedBaseline
    data_problem: Fact | None
    ranking: Ranking
    # How alike the causes' effects are, shape (causes, causes).
    cosines: Array
    # Log-evidence of each cause by linear screening.
    screened: dict[str, float]
    # Chi-square that a smooth function would take.
    smooth_bound: float | None = None
    verdict: Verdict
    profiles: Sequence[Profile] = ()
    gain: Gain | None = None

    def __init__(self, options: Options, trials: Trials) -> None:
        self.options = options
        self.trials = trials
        self.notes: list[Fact] = []

    @property
    def dof(self) -> float:
        """Degrees of freedom of the trials' noise; infinity where it is stated or not known."""
        return self.noise.dof if self.noise.dof > 0 else math.inf

    @property
    def tables(self) -> tuple[Table, ...]:
        """Kinds of data, where `Options.source` tells them."""
        count, kinds = len(self.noise.mean), np.array(list(self.options.source))
        rows = [np.flatnonzero(kinds == kind) for kind in dict.fromkeys(self.options.source)]
        # Only the noise of the trials, the first rows, was estimated.
        return tuple(
            Table(str(kinds[each[0]]), each, self.dof if each[0] < count else math.inf)
            for each in rows
        )

    @property
    def compared(self) -> bool:
        """Whether there is reason to look for a cause."""
        return self.data_problem is None and self.base.detection.found


def run_steps(
    predict: Predict,
    conditions: Any,
    observed: ArrayLike,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause],
    options: Options,
) -> Findings:
    """All steps, one after another; see `diagnose_model` for the parameters."""
    say = options.progress or (lambda fraction, stage: None)
    state = State(options, check_inputs(observed, uncertain, causes, options))
    estimate_noise(state)
    pose(state, predict, conditions, uncertain, causes)
    say(0.0, "recalibrating")
    fit_baseline(state)
    say(0.1, "testing")
    detect_departure(state)
    compare_causes(state, say)
    say(0.85, "verdict and gain")
    compare_effects(state)
    decide_verdict(state)
    find_profiles(state)
    measure_improvement(state)
    note_roughness(state)
    note_causes_without_response(state)
    say(1.0, "done")
    return _findings(state)


def estimate_noise(state: State) -> None:
    """The noise of the trials, or what is stated of it."""
    trials, options = state.trials, state.options
    if options.sd is None:
        noise = fit_noise(trials.value, trials.condition, trials.block, options.relative_sd)
        state.covariance = noise.covariance
    else:
        noise, state.covariance = stated_noise(trials.value, trials.condition, options.sd)
    # A stated covariance holds the correlation already.
    complete = options.sd is not None and np.ndim(options.sd) == 2
    state.noise = noise if complete else with_correlation(noise, trials)
    if state.noise.runs is not None:
        state.covariance = state.noise.covariance
    state.notes += state.noise.notes


def pose(
    state: State,
    predict: Predict,
    conditions: Any,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause],
) -> None:
    """The problem: the means with their errors, the constants, and the causes.

    A suspect is added for every constant whose prior is not a mere range.

    Raises
    ------
    ScenarioError
        If the model computes nothing with the stated constants.
    """
    options, level, dof = state.options, state.noise.mean, state.dof
    suspects = tuple(
        Cause(each.name, (), f"{each.name} is other than stated", relaxes_prior=each.name)
        for each in uncertain
        if each.suspect and each.prior.has_middle
    )
    if options.auxiliary is not None:
        blocks = block_diag(state.covariance, options.auxiliary.covariance)
        state.covariance = np.asarray(blocks, dtype=float)
        level = np.concatenate([level, options.auxiliary.observed])
        # Only the trials' share of the misfit is judged by an estimated noise.
        dof *= (len(level) / len(state.noise.mean)) ** 2
    cheaper = options.low_fidelity
    problem = state.problem = Problem(
        PredictionCache(predict, len(level)),
        conditions,
        level,
        whitener(state.covariance),
        dof,
        tuple(uncertain),
        (*causes, *suspects),
        low_fidelity=None if cheaper is None else PredictionCache(cheaper, len(level)),
    )
    if options.data_problem is None and not np.any(
        np.isfinite(problem.predicted(np.zeros((1, problem.size))))
    ):
        raise ScenarioError("predict: with the stated parameters it computes no observable")


def fit_baseline(state: State) -> None:
    """The constants within their priors; errors that are shared follow the model that is fitted.

    An error that many conditions share must not follow what was measured, see `NoiseModel`.
    """
    state.recalibration = recalibrate(state.problem, state.options.seed)
    null, noise = state.recalibration.null, state.noise
    if noise.shared:
        m = len(noise.mean)
        predicted = state.problem.predicted(null.x[None, :])[0, :m]
        level = np.where(np.isfinite(predicted), predicted, noise.mean)
        state.covariance[:m, :m] = noise.covariance_at(level)
        state.problem = replace(state.problem, whiten=whitener(state.covariance))
        (null,) = refit_keeping_starts(state.problem, [null])
        state.recalibration = replace(state.recalibration, null=null)


def detect_departure(state: State) -> None:
    """Is anything left beyond the recalibrated model, and can the data be judged at all?"""
    trials, options, noise = state.trials, state.options, state.noise
    null = state.recalibration.null
    state.base = assess_baseline(state.problem, state.covariance, null, options.seed)
    uneven = uneven_setups(trials.value, trials.condition, noise, trials.block)
    state.notes += [] if uneven is None else [uneven]
    stated = options.data_problem
    if isinstance(stated, str):
        stated = Fact(Code.STATED_PROBLEM, {"problem": stated}) if stated else None
    alone = options.auxiliary is None
    state.data_problem = stated or find_data_problem(
        trials.value, trials.condition, noise, options.order, trials.block, alone
    )


def compare_causes(state: State, say: Progress) -> None:
    """Fits of all causes, where something is left and the data can be judged."""
    state.ranking = Ranking(state.base.null, (), ())
    if state.compared:
        say(0.2, "fitting causes")
        state.base, state.ranking = compare_candidates(
            state.base, state.covariance, state.recalibration, state.options.seed, say
        )


def compare_effects(state: State) -> None:
    """What the recalibrated model's responses to all causes say, fitted or not."""
    problem, null, sensitivities = state.base.problem, state.base.null, state.base.sensitivities
    state.cosines = distinguishability(problem, sensitivities, null.residual)
    state.screened = linear_evidence(problem, sensitivities, null.residual)
    state.smooth_bound = None
    if state.options.settings is not None and state.compared:
        state.smooth_bound = smooth_residual_bound(problem, null, state.options.settings)


def decide_verdict(state: State) -> None:
    """The verdict by the rules, for the fits as they are now."""
    base, options, count = state.base, state.options, len(state.noise.mean)
    if state.data_problem is not None:
        chance = prior_probabilities(base.problem)
        state.verdict = Verdict("data-problem", (), None, (state.data_problem,), chance)
        return
    parts = cross_validation.folds(count, options.group)

    def improves_prediction(fit: Fit) -> bool:
        gain = cross_validation.predictive_gain
        return not parts or gain(base.problem, base.covariance, base.null, fit, parts) > 0.0

    state.verdict = decide(
        base.problem,
        base.detection,
        state.ranking,
        state.cosines,
        state.screened,
        improves_prediction,
        state.smooth_bound,
        state.tables,
    )
    if state.verdict.kind in ("named", "pair"):
        state.verdict = checked_with_correlation(state.verdict, _led_if_correlated(state))


def _led_if_correlated(state: State) -> CorrelatedLead | None:
    """What is claimed beside its rival, with errors as correlated as repeats leave it open.

    None where the errors are taken as correlated already, or nothing is known of it.
    """
    noise, base = as_correlated_as_possible(state.noise, state.trials), state.base
    fit = state.verdict.fit
    if noise is None or fit is None:
        return None
    m = len(noise.mean)
    level = base.problem.predicted(base.null.x[None, :])[0, :m]
    level = np.where(np.isfinite(level), level, noise.mean)
    covariance = base.covariance.copy()
    covariance[:m, :m] += noise.covariance_at(level) - state.noise.covariance_at(level)
    problem = replace(base.problem, whiten=whitener(covariance))
    rival = base.null if state.verdict.kind == "named" else state.ranking.singles[0]
    behind, ahead = refit_keeping_starts(problem, [rival, fit])
    assert noise.correlation is not None
    return CorrelatedLead(noise.correlation.high, ahead.log_evidence - behind.log_evidence)


def find_profiles(state: State) -> None:
    """Profile likelihoods of the verdict's fit, which is judged again where they lead elsewhere."""
    problem, fit = state.base.problem, state.verdict.fit
    if fit is None:
        return
    if state.verdict.kind not in ("named", "pair"):
        # The members of a set stay as they were compared.
        state.profiles = profile(problem, fit)
        return
    leader, state.profiles = moved_to_profile_minimum(problem, fit)
    if leader is fit:
        return
    # A fit that has moved has to meet the rules there, beside its rivals at its constants and with
    # a recalibrated model that begins there too.
    others = [each for each in (*state.ranking.singles, *state.ranking.pairs) if each is not fit]
    state.base, fits = explore(
        state.base, state.covariance, [leader, *others], [leader], state.options.seed
    )
    state.ranking = Ranking.of(state.base.null, fits)
    compare_effects(state)
    decide_verdict(state)
    if state.verdict.fit is not leader:
        problem, fit = state.base.problem, state.verdict.fit
        state.profiles = [] if fit is None else profile(problem, fit)


def measure_improvement(state: State) -> None:
    """How much better the extended model predicts conditions that its fit has not seen.

    A cause that another one clearly leads on the training subset is not named.
    """
    base, options, fit = state.base, state.options, state.verdict.fit
    if fit is None:
        return
    held_out = cross_validation.split(
        len(state.noise.mean), options.seed, options.group, options.singleton_condition
    )
    # It takes all conditions to tell how many causes there are. Three others are chosen: without a
    # few conditions, farther candidates would hardly lead.
    pairs = len(fit.candidate.causes) > 1
    others = [
        each
        for each in (state.ranking.pairs if pairs else state.ranking.singles)
        if each.name != fit.name
    ][:3]
    state.gain = measure_gain(
        base.problem, base.covariance, held_out, base.null, fit, others, options.seed
    )
    if state.gain is not None:
        first = state.gain.choice, state.gain.lead
        state.verdict = checked_on_training_subset(
            base.problem, state.verdict, state.ranking, state.cosines, *first
        )


def note_roughness(state: State) -> None:
    """A note, if the model itself jumps by more than the noise."""
    count = len(state.noise.mean)
    roughness = state.base.roughness[:count]
    measured = np.sqrt(np.diag(state.base.covariance)[:count] - roughness**2)
    rough = int(np.sum(roughness > measured))
    if rough:
        state.notes.append(Fact(Code.MODEL_JUMPS, {"count": rough}))


def note_causes_without_response(state: State) -> None:
    """A note of the causes that change no prediction, such as one that `predict` does not read."""
    if state.data_problem is not None:
        return
    size = np.max(np.abs(state.base.sensitivities.raw), axis=1, initial=0.0)
    responds = set(state.base.sensitivities.cause[size > 0.0])
    silent = [each.name for k, each in enumerate(state.base.problem.causes) if k not in responds]
    if silent:
        state.notes.append(Fact(Code.NO_RESPONSE, {"causes": silent}))


def _findings(state: State) -> Findings:
    """What is handed on, with upper bounds of all causes where none is seen."""
    base = state.base
    bounds = {}
    if state.verdict.kind == "none":
        bounds = upper_bounds(base.problem, base.sensitivities, base.null.residual)
    return Findings(
        problem=base.problem,
        noise=state.noise,
        roughness=base.roughness,
        null=base.null,
        detection=base.detection,
        sensitivities=base.sensitivities,
        ranking=state.ranking,
        cosines=state.cosines,
        indistinguishable_causes=indistinguishable_causes(base.problem, state.cosines),
        verdict=state.verdict,
        bounds=bounds,
        smooth_bound=state.smooth_bound,
        gain=state.gain,
        profiles=tuple(state.profiles),
        notes=tuple(state.notes),
        seed=state.options.seed,
        tables=state.tables,
    )
