"""Findings of a diagnosis: the value that results and reports are made of."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.messages import check_whole, meant, refuse
from stickslip._util.note import Note
from stickslip._util.text import OneLine, is_number, printable
from stickslip.diagnosis.decision import experiments as design
from stickslip.diagnosis.decision.candidate import Candidate, frame, spread_of
from stickslip.diagnosis.decision.cannot_tell import CannotTell, cannot_tell
from stickslip.diagnosis.decision.gain import Gain
from stickslip.diagnosis.decision.misfit_test import MisfitTest, goodness_of_fit
from stickslip.diagnosis.decision.posterior import Posterior, posterior
from stickslip.diagnosis.decision.verdict import Verdict
from stickslip.diagnosis.fitting.problem import LOST, Problem
from stickslip.diagnosis.fitting.responses import Response
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.terms.words import Words
from stickslip.errors import ScenarioError

if TYPE_CHECKING:
    from pandas import DataFrame


class Measurement(Protocol):
    """Measured files as a report has them; `left_out` are sentences on rows that are not used."""

    @property
    def name(self) -> str: ...
    @property
    def files(self) -> Sequence[Path]: ...
    @property
    def left_out(self) -> Sequence[object]: ...


# Models to tell apart, and the odds below which one is no rival beside the first. Chosen.
_COMPARED, _RIVAL = 3, 1e-3


@dataclass(frozen=True, repr=False, eq=False)
class Findings(OneLine):
    """Results of the steps.

    Attributes
    ----------
    models : Models
        All fits; `models.problem` has the errors that they were compared with.
    test : MisfitTest
    responses : list of Response
        Of every cause about the recalibrated model, that of the largest gain first.
    verdict : Verdict
    seed : int
    """

    models: Models
    test: MisfitTest
    responses: list[Response]
    verdict: Verdict
    seed: int

    @property
    def problem(self) -> Problem:
        return self.models.problem


@dataclass(frozen=True, repr=False, eq=False)
class Facts:
    """Findings with their data, and all that follows from them; see `Diagnosis`."""

    findings: Findings
    measurement: Measurement | None = None
    notes: tuple[Note, ...] = ()

    @property
    def problem(self) -> Problem:
        """The fitted problem, with the errors that models were compared with."""
        return self.findings.problem

    @property
    def fitted(self) -> bool:
        """Whether the data allow a diagnosis, so that there are models."""
        return self.verdict.kind != "data-problem"

    @property
    def verdict(self) -> Verdict:
        """The verdict: its `kind`, the `causes`, the `reasons` and all `probabilities`."""
        return self.findings.verdict

    @property
    def gain(self) -> Gain | None:
        """Error on held-out readings, recalibrated and extended, or of the leading model.

        None where no model has a cause, or if there are too few readings to hold some out.
        """
        return self.verdict.gain

    @cached_property
    def words(self) -> Words:
        """Names of causes and parameters in words."""
        return Words(self.problem.words, self.problem.causes)

    @property
    def rivals(self) -> Rivals:
        """Further measurements, and statements of the extended model."""
        return self.problem.rivals

    @cached_property
    def chance(self) -> Posterior:
        """Probabilities of all fitted models."""
        return posterior(self.findings.models)

    def probability_of(self, names: Collection[str]) -> float:
        """Probability that all of these causes are in the model, whatever is beside them."""
        models = (fit for fit in self.chance.fits if fit.names.issuperset(names))
        return min(1.0, math.fsum(self.chance.models[fit.name] for fit in models))

    def candidate(self, name: str) -> Candidate:
        """A model that was fitted: ``none``, the name of a cause, or a pair as ``"a + b"``.

        With the form of the discrepancy that is claimed, or else has the largest probability.

        Raises
        ------
        ScenarioError
            If no such model was fitted.
        """
        self._refuse_without_models("candidate")
        names = frozenset(word.strip() for word in str(name).split("+")) - {"none"}
        for fit in (self.verdict.fit, *self.chance.fits):
            if fit and fit.names == names:
                return Candidate(fit, self.findings.models)
        hint = meant(name, [fit.name for fit in self.chance.fits])
        text = f"candidate({printable(repr(name))}): no such model was fitted; compare() has all"
        raise ScenarioError(text + hint)

    @property
    def recalibrated(self) -> Candidate:
        """The model without a cause: with the discrepancy of the extended one, if there is one."""
        models, fit = self.findings.models, self.verdict.fit
        null = None if fit is None else models.get((), fit.form)
        best = next((fit for fit in self.chance.fits if not fit.causes), models.null)
        return Candidate(null or (models.null if fit else best), models)

    @property
    def best(self) -> Candidate:
        """The extended model, or the recalibrated one if there is none."""
        fit = self.verdict.fit
        return self.recalibrated if fit is None else Candidate(fit, self.findings.models)

    @property
    def subject(self) -> Candidate:
        """The model that is told, or what comes nearest; the recalibrated one if there is none."""
        fit = self.verdict.subject
        return self.recalibrated if fit is None else Candidate(fit, self.findings.models)

    @cached_property
    def cannot_tell(self) -> CannotTell:
        """Limits of these data beside the model that is told."""
        self._refuse_without_models("cannot_tell")
        fits, effects = self.chance.fits, self.findings.responses
        return cannot_tell(self.subject, self.recalibrated, effects, fits)

    @property
    def candidates(self) -> dict[str, Candidate]:
        """`recalibrated` and, where there is one, `extended`; none for the verdict data-problem."""
        models = {"recalibrated": self.recalibrated} if self.fitted else {}
        return models if self.verdict.fit is None else models | {"extended": self.best}

    @property
    def params(self) -> DataFrame:
        """Parameters of the extended model, or the recalibrated one; see `Candidate.params`.

        Empty for the verdict data-problem.
        """
        if not self.fitted:
            return frame("parameter", [], [], ["value", "sd", "unit", "prior", "pull"])
        return self.best.params

    def conf_int(self, level: float = 0.95) -> DataFrame:
        """Intervals of `params`, columns `low`, `high` and `unit`; see `Candidate.interval`.

        Raises
        ------
        ScenarioError
            If the level is not above 0 and below 1.
        """
        if not is_number(level) or not 0.0 < level < 1.0:
            refuse("level", level, "a number above 0 and below 1")
        if not self.fitted:
            return frame("parameter", [], [], ["low", "high", "unit"])
        return self.best.interval(level)

    @property
    def covariance(self) -> DataFrame:
        """Covariance of `params`, in products of their units."""
        return self.best.covariance if self.fitted else frame("parameter", [], [], [])

    def compare(self) -> DataFrame:
        """All models that were fitted, the most probable first.

        Columns: `log_evidence` above that of ``none``; `probability`; `chi2` of the data; `p` of
        the lack of fit without a discrepancy; `form` of the discrepancy and `share` of the
        model's error that the causes take. Empty for the verdict data-problem.
        """
        columns = ["log_evidence", "probability", "chi2", "p", "form", "share"]
        if not self.fitted:
            return frame("candidate", [], [], columns)
        models, fits = self.findings.models, self.chance.fits
        none = max(fit.log_evidence for fit in models.best.values() if not fit.causes)
        rows = []
        for fit in fits:
            plain = models.get(fit.names) or fit
            rows.append(
                (fit.log_evidence - none, self.chance.models[fit.name], plain.chi2,
                 goodness_of_fit(self.problem, plain), fit.form, Candidate(fit, models).share)
            )  # fmt: skip
        return frame("candidate", [fit.name for fit in fits], rows, columns)

    # ------------------------------------------------------------------ predictions
    @cached_property
    def places(self) -> list[dict[str, Any]]:
        """Which reading each row is: `table`, `number` in it from 1, and `where` in words."""
        return [
            {"table": one.name, "number": number, "where": where}
            for one in self.problem.parts
            for number, where in enumerate(one.table.named_settings.words, start=1)
        ]

    @cached_property
    def at_readings(self) -> dict[str, Array]:
        """All readings as the stated, the recalibrated and the extended model have them, (n,)."""
        if not self.fitted:
            return {}
        problem = self.problem
        left = problem.residuals(np.zeros((1, problem.size)))[0]
        stated = np.where(left == LOST * problem.sd, np.nan, problem.y - left)
        fitted = {name: problem.y - model.fit.residual for name, model in self.candidates.items()}
        return {"stated": stated, **fitted}

    def predict(self, conditions: Any) -> DataFrame:
        """Predictions of the fitted models at new conditions.

        Parameters
        ----------
        conditions : DataFrame or sequence of dict, or whatever the own model takes
            For a measurement, settings by name, such as ``frequency``. Those not given are the
            scenario's; further columns of a table of trials, such as readings, are ignored. For a
            ready-made model, a `Series` with its inputs, whose readings are ignored.

        Returns
        -------
        DataFrame
            A row for each condition: the settings that were given, then `recalibrated` and
            `recalibrated_sd` and, where there is an extended model, `extended` and `extended_sd`.
            In m/s, or in the unit of an own model's readings; `_sd` leaves out the noise of a
            reading. NaN where a model computes nothing.

        Raises
        ------
        ScenarioError
            If the data allow no diagnosis, a setting is not allowed, or the measurement has no
            readings of the kind that is predicted.
        """
        import pandas as pd

        self._refuse_without_models("predict")
        at, settings = self.rivals.conditions(conditions)
        for name, candidate in self.candidates.items():
            made = self._predicted(candidate, at)
            sd = np.sqrt(np.diag(spread_of(made)))
            settings |= {name: made[0].tolist(), f"{name}_sd": sd.tolist()}
        return pd.DataFrame(settings)

    def separate(self, conditions: Any) -> DataFrame | None:
        """How well the leading models could be told apart at conditions not measured yet.

        Parameters
        ----------
        conditions : as for `predict`

        Returns
        -------
        DataFrame, optional
            A row for each condition, the best first, with its place as index: the settings that
            have names, `separation`, the expected chi-square between the two models `first` and
            `second` that it tells apart best, by three readings with the noise of the others;
            `least`, that of the two that it tells apart worst; and of each model, of a set all
            members, a column with what it predicts and one with its sd. None where there is nothing
            to separate.
        """
        candidates, pairs = self._told_apart(True)
        if not pairs:
            return None
        import pandas as pd

        at, settings = self.rivals.conditions(conditions)
        level, covariance, noise = self._apart(candidates, at)
        chi2 = design.expected_chi2(level, covariance, noise)[tuple(np.transpose(pairs))]
        best = np.argmax(chi2, axis=0)
        settings |= {"separation": np.max(chi2, axis=0), "least": np.min(chi2, axis=0)}
        for k, word in enumerate(("first", "second")):
            settings[word] = [candidates[pairs[pair][k]].name for pair in best.tolist()]
        for k, candidate in enumerate(candidates):
            sd = np.sqrt(np.diagonal(covariance[k]))
            settings |= {candidate.name: level[k].tolist(), f"{candidate.name}_sd": sd.tolist()}
        return pd.DataFrame(settings).sort_values("separation", ascending=False, kind="stable")

    def propose_experiments(self, count: int = design.PROPOSED) -> list[design.Experiment]:
        """The conditions that would tell the leading models apart best, each of another kind.

        Raises
        ------
        ScenarioError
            If `count` is no whole number from 0; and for a model of one's own, of which no other
            conditions are known; see `separate`.
        """
        if not self.rivals.proposes:
            raise ScenarioError(
                "propose_experiments: which conditions a model of one's own can have is not known; "
                "separate(conditions) compares those that you give"
            )
        check_whole("count", count)
        made = self._proposals
        return self.rivals.chosen(*made, count) if made else []

    @cached_property
    def next_step(self) -> Note:
        """Whether what is claimed is safe (the code ``name-safe``), or why it is not."""
        verdict, causes = self.verdict, self.verdict.causes
        probability = 0.0 if verdict.fit is None else self.probability_of(verdict.fit.names)
        if verdict.kind == "none":
            # One that changes no reading of these data is as likely as it was before.
            acts = {each.cause.name for each in self.findings.responses
                    if each.cause.is_constant or each.gaps.any()}  # fmt: skip
            causes = tuple(name for name in self.chance.causes if name in acts)[:1]
            probability = 1.0 - self.chance.none
        names = [self.words.title(name) for name in causes]
        return design.next_step(verdict, names, probability, self.rivals.unvaried()[:2])

    @property
    def extended(self) -> Any:
        """The model with recalibrated constants and, where there is one, the claimed cause.

        Of a measurement a scenario; of a model of one's own the values of its parameters by name.
        Uncertain in the scenario is what was fitted, with `covariance`; `stickslip.predict` draws
        from that. From data that allow no diagnosis nothing is learnt: the scenario is as it was
        given. What only readings have, such as a wrong zero, is no part of it.

        Raises
        ------
        ScenarioError
            If the fitted values are none that a scenario can have together.
        """
        if not self.fitted:
            return self.rivals.extended({}, None)
        values: dict[str, Any] = self.best.params["value"].to_dict()
        for cause in self.best.fit.causes:
            if cause.curve is not None and cause.curve.statement is not None:
                values |= cause.curve.statement.fixed
        return self.rivals.extended(values, self.best.covariance)

    # ---------------------------------------------------------------------- helpers
    def _refuse_without_models(self, what: str) -> None:
        if not self.fitted:
            raise ScenarioError(f"{what}: the data allow no diagnosis, so no model was fitted")

    def _predicted(self, candidate: Candidate, at: Any) -> Array:
        """Readings at new conditions for the values of a candidate, (values, conditions)."""
        forward = self.problem.forward
        if forward is None:
            raise ScenarioError("predict: this model was given without a way to new conditions")
        return np.asarray(forward(at, candidate.values()))

    def _told_apart(self, every_member: bool) -> tuple[list[Candidate], list[tuple[int, int]]]:
        """Models to tell apart, and which of them from which.

        A claim from those that come next; the members of a set, perhaps all, from one another.
        """
        if self.verdict.kind in ("none", "data-problem"):
            return [], []
        fits = list(self.chance.fits)
        claim = self.verdict.fit if self.verdict.claims else None
        if claim is not None:
            # What has the claimed causes and more is no rival of the claim.
            fits = [claim, *(fit for fit in fits if not fit.names >= claim.names)]
        elif self.verdict.kind == "ambiguous":
            fits = list(self.verdict.members)
        # The first rival is told apart however small its probability is, others only beside it.
        if not every_member or self.verdict.kind != "ambiguous":
            least = self.chance.models[fits[min(1, len(fits) - 1)].name] * _RIVAL
            fits = [fit for fit in fits[:_COMPARED] if self.chance.models[fit.name] >= least]
        rivals = [Candidate(fit, self.findings.models) for fit in fits]
        pairs = itertools.combinations(range(len(rivals)), 2)
        return rivals, [pair for pair in pairs if claim is None or pair[0] == 0]

    def _apart(self, candidates: Sequence[Candidate], at: Any) -> tuple[Array, Array, Array]:
        """Level, covariance and variance of the noise, as `expected_chi2` takes them."""
        made = [self._predicted(candidate, at) for candidate in candidates]
        level = np.array([values[0] for values in made])
        covariance = np.array([spread_of(values) for values in made])
        first = self.rivals.table
        sd = self.problem.errors[first].of_reading(np.mean(level, axis=0))
        rough = self.problem.simulator_noise
        scatter = 0.0 if rough is None else float(np.median(rough[self.problem.rows[first]]))
        return level, covariance, sd**2 / design.TRIALS + scatter**2

    @cached_property
    def _proposals(
        self,
    ) -> tuple[Any, list[str], tuple[Array, Array, Array], list[tuple[int, int]]] | None:
        """Conditions that may be measured next, names of models, their arrays, and their pairs."""
        candidates, pairs = self._told_apart(False)
        proposals = self.rivals.proposals() if pairs else None
        if proposals is None:
            return None
        names = [candidate.name for candidate in candidates]
        return proposals, names, self._apart(candidates, proposals), pairs
