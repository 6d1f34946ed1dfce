"""A film beside both models: the advance per pulse, and the forces."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.diagnosis.observables.tracking.force_residuals import ForceView
from stickslip.scenario.scenario import Scenario


@dataclass(frozen=True)
class FilmComparison:
    """One run beside both models.

    Attributes
    ----------
    file : str
    scenario : Scenario
        Scenario of the run, as stated.
    advance : dict of float, optional
        Advance per pulse in the world, m: ``measured``, its error ``sd``, and what the models make
        of it, ``recalibrated`` and ``extended``; None where no two periods show it.
    view, after : ForceView, optional
        With the recalibrated and with the extended model; None where there is none.
    held_out : bool
    """

    file: str
    scenario: Scenario
    advance: dict[str, float] | None
    view: ForceView | None
    after: ForceView | None
    held_out: bool
