"""What a person gets from a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from stickslip._util.html_table import ShownBySummary
from stickslip._util.plain_text import printable
from stickslip.diagnosis import tables
from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.discrimination import TRIALS, Separation, separate
from stickslip.diagnosis.inference.experiment_design import PROPOSED, Experiment, propose
from stickslip.diagnosis.inference.extended_model import extended_scenario, extended_values
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.next_step import next_step, worth_measuring
from stickslip.diagnosis.inference.open_set import OpenSet
from stickslip.diagnosis.inference.verdict import Verdict
from stickslip.diagnosis.new_drives import drive_settings
from stickslip.diagnosis.next_trials import trial_table
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.messages import no_gain_lines, set_lines, table_lines, verdict_lines
from stickslip.diagnosis.report.plots import OWN_LABELS, Plots, refuse_own
from stickslip.errors import ScenarioError
from stickslip.facts import Fact
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value, check_whole, refuse
from stickslip.scenario.scenario import Scenario

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Diagnosis", "Plots"]

_OWN_UNIT = "SI"
"""Unit of the observable of a model of one's own, if it is not said."""

_MOST_ROWS = 12
"""Rows of a table in the summary. Chosen: two tables and the verdict fit on one screen."""


@dataclass(frozen=True, repr=False, eq=False)
class Diagnosis(ShownBySummary):
    """Result of a diagnosis of a measurement, or of data with a model of one's own.

    The *recalibrated* model has its constants fitted within their priors. The *extended* model has
    the claimed cause besides; there is one for the verdicts named, pair and ambiguous.

    Attributes
    ----------
    findings : Findings
        Everything that was fitted.
    posed : PosedProblem
        What the rows of the problem stand for.
    measurement : Measurement, optional
        What was diagnosed; none for a model of one's own.
    """

    findings: Findings
    posed: PosedProblem
    measurement: Measurement | None

    def __repr__(self) -> str:
        found = self.findings
        causes = [*self.verdict.causes[:3], "..."][: len(self.verdict.causes)]
        said = f"{self.verdict.kind} {printable(', '.join(causes))}".strip()
        if self.verdict.kind != "data-problem":
            said += f", p = {found.detection.p_value:.2g}"
        return f"<Diagnosis of {len(found.problem.observed)} observables: {said}>"

    def summary(self) -> str:
        """The verdict, the parameters and the leading candidates as text for one screen.

        Of a set, a line says which of its members the parameters are of; without a gain, a line
        says why there is none.
        """
        lines = [*self.verdict_lines(), *no_gain_lines(self.findings), *set_lines(self.findings)]
        for table, most in ((self.params, _MOST_ROWS), (self.compare(), _MOST_ROWS // 2)):
            if len(table):
                lines += ["", *table_lines(table, most)]
        return "\n".join(lines)

    def verdict_lines(self) -> list[str]:
        """The verdict in one sentence, and below it the reasons, notes and what was left out."""
        measured = () if self.measurement is None else self.measurement.left_out
        return verdict_lines(self.findings, self.posed, [*measured, *self.posed.left_out])

    @property
    def verdict(self) -> Verdict:
        """What is said: its `kind`, the `causes`, the `reasons` and all `probabilities`."""
        return self.findings.verdict

    @property
    def open_set(self) -> OpenSet | None:
        """Curves of a free shape at the laws of the model: which law, its curve, a formula.

        Where no single cause explains the data, or if asked for; of a model of one's own where it
        has `free_terms`. If one is accepted and no cause is claimed, the extended model has it.
        """
        return self.findings.open_set

    @property
    def gain(self) -> Gain | None:
        """Error on held-out conditions, recalibrated and extended.

        None if no cause is claimed, which is so for the verdicts none, unexplained and
        data-problem, or if the conditions are too few to hold some out. A law's is in `open_set`.
        """
        return self.findings.gain

    @property
    def params(self) -> DataFrame:
        """Fitted parameters, a row for each constant and each parameter of the claimed cause.

        Rows have full names, such as ``effects.surface_tilt.angle``, which the short ones of texts
        and pictures leave out. Columns: `value` and `sd` in the column `unit`, where the sd of the
        strength of a claimed cause is that of the profile likelihood, if it is larger than that of
        the curvature at the fit; `prior`, what was known before the data;
        `pull`, how many standard deviations of its prior the value lies from the prior's middle. Of
        the extended model, with the knots of an accepted law of a free shape, or the recalibrated
        one if there is no other; of the verdict ambiguous, where the extended model is that of the
        first member of the set, of this one alone. Empty for the verdict data-problem.
        """
        return tables.parameter_table(self.findings)

    def conf_int(self, level: float = 0.95) -> DataFrame:
        """Confidence intervals of `params`, columns `low`, `high` and `unit`.

        From the profile likelihood where there is one, which is for the strength of a claimed
        cause; else from the covariance of the fit, without a profile's view of other minima.

        Parameters
        ----------
        level : float
            Above 0, at most 0.9973, where profiles end.

        Raises
        ------
        ScenarioError
            If the level is another one.
        """
        return tables.interval_table(self.findings, level)

    @property
    def covariance(self) -> DataFrame:
        """Covariance of `params` by the curvature at the fit, in products of their units.

        The roots of its diagonal may be smaller than the `sd` of `params`, which is that of the
        profile likelihood where this is wider.
        """
        return tables.covariance_table(self.findings)

    def compare(self) -> DataFrame:
        """All candidates that were fitted, best first; ``none`` is the recalibrated model.

        Empty for the verdict data-problem.

        Columns: `log_evidence` above that of none, less the price of a second cause; `delta`, how
        far behind the first; `chi2` of data and priors; `p`, of the lack of fit; `converged`,
        whether fits from several starts agree: "yes", "no", or "not checked" where a candidate is
        so far behind that it was fitted from one start only.
        """
        return tables.candidate_table(self.findings)

    def predict(self, conditions: Any) -> DataFrame:
        """Predictions of the fitted models at new conditions.

        Of the verdict ambiguous the extended model is that of the first member of the set.

        Parameters
        ----------
        conditions : DataFrame or sequence of dict, or whatever the own model takes
            Of a measurement drive settings by name, such as ``frequency``; what is not given is as
            in the scenario, and what a table of trials has besides, such as `velocity`, is ignored.
            For a model of one's own they are handed to it as they are.

        Returns
        -------
        DataFrame
            A row for each condition: the settings that were given, then `recalibrated` and
            `recalibrated_sd` and, where there is an extended model, `extended` and `extended_sd`.
            In m/s or the own observable's unit; the errors are those of the fitted parameters and
            hold no noise of a trial. NaN where a model computes nothing.

        Raises
        ------
        ScenarioError
            If the data allow no diagnosis, or a setting is not one that a drive can have.
        """
        if self.verdict.kind == "data-problem":
            raise ScenarioError("predict: the data allow no diagnosis, so no model was fitted")
        at, settings = self._conditions(conditions)
        return tables.prediction_table(self.findings, self.posed, at, settings)

    @property
    def plot(self) -> Plots:
        """Pictures: `fit`, `residuals`, `ranking` and `profile`, each a matplotlib figure."""
        return Plots(self.findings, self.posed)

    def propose_experiments(self, count: int = PROPOSED) -> list[Experiment]:
        """The drives that would tell the leading candidates apart best, each of another kind.

        Parameters
        ----------
        count : int
            How many at most, from 0. There are none where nothing was found or no velocity was
            measured.

        Raises
        ------
        ScenarioError
            If `count` is not allowed; and for a model of one's own, of which no other conditions
            are known; see `separate`.
        """
        if self.measurement is None:
            raise ScenarioError(
                "propose_experiments: which conditions a model of one's own can have is not known; "
                "separate(conditions) compares those that you give"
            )
        check_whole("count", count)
        # The first ones are the same, however many are asked for.
        return self._experiments[:count] if count <= PROPOSED else self._proposed(count)

    @property
    def next_step(self) -> Fact:
        """Whether what is claimed is safe (the code ``name-safe``), or why it is not."""
        return next_step(self.findings)

    def next_trials(self, count: int = PROPOSED) -> DataFrame:
        """The drives to measure next, a row for each trial, with an empty column `velocity`.

        When that is filled in, `Measurement.with_velocities` takes the table. Of the drives of
        `propose_experiments`, whose parameter and errors these are, it has those that can decide
        something; none where `next_step` needs none.
        """
        experiments = worth_measuring(self.next_step, self.propose_experiments(count))
        assert self.measurement is not None  # for a model of one's own none are proposed
        return trial_table(experiments, self.measurement)

    def separate(self, conditions: Any, trials: int = TRIALS) -> Separation | None:
        """How well the leading candidates could be told apart at conditions not measured yet.

        Parameters
        ----------
        conditions : DataFrame or sequence of dict, or whatever the own model takes
            As for `predict`.
        trials : int
            Trials of each new condition, with the noise of the others.

        Returns
        -------
        Separation, optional
            None where nothing was found, so that there is nothing to separate.
        """
        at, _ = self._conditions(conditions)
        return separate(self.findings, self.posed.model.velocities, at, trials)

    @property
    def extended(self) -> Scenario | dict[str, float]:
        """The model with recalibrated constants and, where there is one, the claimed cause.

        Of the verdict ambiguous with the first member of the set. Of a measurement a scenario; of a
        model of one's own the values of its parameters by name. From data that allow no diagnosis
        nothing is learnt: the scenario is as it was given. Uncertain in it is what was fitted, with
        `covariance`, if fits from several starts agree; `stickslip.predict` draws
        from that.

        Raises
        ------
        ScenarioError
            If the fitted values are none that a scenario can have together.
        """
        if self.measurement is None:
            return extended_values(self.findings)
        return extended_scenario(self.findings, self.measurement.scenario)

    def as_dict(self) -> dict[str, Any]:
        """What ``stickslip diagnose --json`` prints: the keys are those of the reference."""
        from stickslip.diagnosis.report.json_keys import OwnData, summary

        source = self.measurement or OwnData("")
        return summary(self.findings, self.posed, source, self._experiments)

    def save_report(
        self,
        folder: str | PathLike[str],
        *,
        title: str | None = None,
        place: ArrayLike | None = None,
        labels: tuple[str, str] = OWN_LABELS,
        unit: str = _OWN_UNIT,
    ) -> None:
        """Write the report into a folder, which is made.

        That is report.html, one page with all figures, and report.json with its numbers; of a
        measurement also extended.toml, a scenario with what was found.

        Parameters
        ----------
        folder : str or path-like
        title : str, optional
            Of the page of a model of one's own; a measurement has its name.
        place, labels : optional
            For a model of one's own, as in `plot.fit`.
        unit : str
            For a model of one's own: of the observable.

        Raises
        ------
        ScenarioError
            If `folder` is no path, an argument has no meaning for a measurement, `place` has
            another length or is not finite, or the extended model makes no scenario.
        OSError
            If a file cannot be written.
        """
        from stickslip.diagnosis.report.saving import save_of_measurement, save_of_own_model

        if not isinstance(folder, str | PathLike):
            refuse("folder", folder, "a path")
        if self.measurement is None:
            own = (title, place, labels, unit)
            save_of_own_model(folder, self.findings, self.posed, *own)
            return
        changed = (
            title is not None,
            place is not None,
            labels != OWN_LABELS,
            unit != _OWN_UNIT,
        )
        refuse_own("save_report", ("title", "place", "labels", "unit"), changed)
        given = (self.measurement, self._experiments)
        save_of_measurement(folder, self.findings, self.posed, *given)

    def _conditions(self, given: Any) -> tuple[Any, list[dict[str, Value]] | None]:
        """What the model takes, and the settings in a table where they have names."""
        if self.measurement is None:
            return given, None
        return drive_settings(given, self.measurement.scenario)

    @cached_property
    def _experiments(self) -> list[Experiment]:
        return [] if self.measurement is None else self._proposed(PROPOSED)

    def _proposed(self, count: int) -> list[Experiment]:
        return propose(self.findings, self.posed.model.velocities, self.posed.conditions, count)
