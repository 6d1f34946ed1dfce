"""The pictures of a diagnosis, each as a matplotlib figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report import figures
from stickslip.diagnosis.report.parameters import short
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import suggestion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


OWN_LABELS = ("condition", "observable")
"""What is on the axes of data of a model of one's own, if it is not said."""


class Plots:
    """Pictures of a diagnosis, as ``Diagnosis.plot`` has them.

    Each method returns a matplotlib figure, which a notebook shows by itself and
    ``figure.savefig("name.png")`` writes.
    """

    def __init__(self, findings: Findings, posed: PosedProblem) -> None:
        self._findings = findings
        self._posed = posed

    def __repr__(self) -> str:
        return "<Plots: fit(), residuals(), ranking(), profile(name)>"

    def fit(
        self,
        place: ArrayLike | None = None,
        labels: tuple[str, str] = OWN_LABELS,
    ) -> Figure:
        """Data and fitted models; held-out readings are hollow.

        For a measurement these are velocities against frequency, with a column for each mode and
        direction, the scenario as it was given, and residuals below.

        Parameters
        ----------
        place : array_like, shape (m,), optional
            For a model of the user's own: the abscissa of each condition; its number, if not given.
        labels : tuple of str
            For a model of the user's own: labels of abscissa and ordinate, with units.

        Raises
        ------
        ScenarioError
            If a measurement has no velocities, or gets an argument that is not for it, or `place`
            has another length or is not finite.
        """
        if self._posed.simulator is None:
            at = abscissa(place, len(self._findings.noise.mean))
            return figures.own_model(self._findings, at, labels)
        refuse_own("plot.fit", ("place", "labels"), (place is not None, labels != OWN_LABELS))
        drawn = figures.velocities(self._findings, self._posed.conditions, self._posed.given)
        if drawn is None:
            raise ScenarioError("plot.fit: no velocity was measured; save_report draws other data")
        return drawn

    def residuals(self, place: ArrayLike | None = None, label: str | None = None) -> Figure:
        """Whitened residuals of the recalibrated and, if there is one, of the extended model.

        Two thirds of them lie between -1 and 1, and 95 % in the grey band, if the model is right.

        Parameters
        ----------
        place : array_like, shape (m,), optional
            Abscissa of each observable; its number, if not given.
        label : str, optional
            Of the abscissa, with its unit; not given, "condition" where all data are velocities,
            and "observable" elsewhere.
        """
        count = len(self._findings.problem.observed)
        if label is None:
            label = "condition" if len(self._posed.conditions) == count else "observable"
        return figures.residuals(self._findings, abscissa(place, count), label)

    def ranking(self) -> Figure:
        """Log-evidence of the leading candidates above no cause.

        Raises
        ------
        ScenarioError
            If no candidate was fitted, as nothing was detected.
        """
        drawn = figures.ranking(self._findings)
        if drawn is None:
            raise ScenarioError("plot.ranking: no candidate was fitted, as nothing was detected")
        return drawn

    def profile(self, name: str) -> Figure:
        """Chi-square along one parameter of the claimed cause, everything else fitted anew.

        Parameters
        ----------
        name : str
            Name of the parameter, such as ``effects.surface_tilt.angle`` or ``surface_tilt.angle``.

        Raises
        ------
        ScenarioError
            If there is no such profile; the nearest one is named.
        """
        profiles = {short(each.name): each for each in self._findings.profiles}
        if short(name) not in profiles:
            none = "there is none, as no cause is claimed"
            hint = suggestion(name, profiles) if profiles else none
            raise ScenarioError(f"plot.profile: {name}: there is no such profile; {hint}")
        return figures.profile(profiles[short(name)])


def refuse_own(where: str, names: Sequence[str], given: Sequence[bool]) -> None:
    """Refuse arguments that are for a model of one's own, of which some were `given`."""
    said = ", ".join(name for name, each in zip(names, given, strict=True) if each)
    if said:
        raise ScenarioError(f"{where}: {said}: allowed for a model of one's own only")


def abscissa(place: ArrayLike | None, count: int) -> Array:
    """Where each of `count` conditions is drawn: at its number, if `place` is not given.

    Raises
    ------
    ScenarioError
        If `place` has another length or is not finite.
    """
    at = np.arange(1.0, count + 1.0) if place is None else np.asarray(place, dtype=float)
    if at.shape != (count,) or not np.all(np.isfinite(at)):
        raise ScenarioError(f"place: allowed is a finite number for each of {count} conditions")
    return at
