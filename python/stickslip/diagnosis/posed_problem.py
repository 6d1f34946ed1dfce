"""A problem with what its rows stand for: drives, tables, and what the stated model gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Array, Indices
from stickslip.diagnosis.model.simulator import Simulator
from stickslip.diagnosis.observables import Combined, Comparison
from stickslip.diagnosis.observables.tracking.film import FilmComparison
from stickslip.facts import Fact
from stickslip.scenario.keys import Value


@dataclass(frozen=True, repr=False, eq=False)
class PosedProblem(OneLine):
    """What the rows of a problem stand for.

    Attributes
    ----------
    model : Combined
        The forward model of all rows, at any conditions; the rows of its observables follow those
        of the conditions.
    conditions : list of dict
        Drive settings by dotted key, of the first rows; none for a model of the user's own.
    simulator : Simulator, optional
        Simulator of mean velocities; a user's own model has none.
    given : ndarray, shape (conditions,)
        Velocities of the scenario as it was given, m/s; NaN where it has none.
    left_out : tuple of Fact
        Sound rows that could not be used, and why.
    bent : Combined, optional
        The forward model with laws of a free shape, where these were looked at.
    """

    model: Combined
    conditions: list[dict[str, Value]]
    simulator: Simulator | None
    given: Array
    left_out: tuple[Fact, ...]
    bent: Combined | None = None

    def extended_model(self, found: Findings) -> Combined:
        """The forward model of `Findings.extended`."""
        return self.model if self.bent is None or found.free_shape is None else self.bent

    def parts(self) -> dict[str, Indices]:
        """Conditions in complementary parts: modes, directions, low and high frequency and peak."""
        result: dict[str, Indices] = {}
        for key in ("drive.mode", "drive.direction"):
            words = np.array([str(each[key]) for each in self.conditions])
            found = sorted(set(words.tolist()))
            if len(found) == 2:
                result |= {word: np.flatnonzero(words == word) for word in found}
        for key in ("drive.frequency", "drive.peak"):
            values = np.array([float(each[key]) for each in self.conditions])
            middle = float(np.median(values)) if len(values) else 0.0
            below, above = np.flatnonzero(values < middle), np.flatnonzero(values >= middle)
            if len(below) and len(above):
                name = key.split(".")[1]
                result |= {f"low {name}": below, f"high {name}": above}
        return result

    def comparisons(self, found: Findings) -> list[Comparison | FilmComparison]:
        """What each observable shows beside the models: see `Observable.comparison`."""
        problem, fit = found.extended or (found.problem, None)
        model = self.extended_model(found)
        point = np.zeros(problem.size)  # where all causes are absent
        point[: problem.base_count] = found.null.x[: problem.base_count]
        null = problem.physical(point[None, :])[0]
        extended = None if fit is None else problem.physical(fit.x[None, :])[0]
        end = len(self.conditions)
        result: list[Comparison | FilmComparison] = []
        for observable in self.model.observables:
            start, end = end, end + len(observable.observed)
            names, before = model.arguments(observable, null)
            after = None if extended is None else model.arguments(observable, extended)[1]
            result.append(observable.comparison(names, before, after, found.held_out[start:end]))
        return result
