"""A film beside both models: the way of a pulse, the forces, and what two directions share."""

from __future__ import annotations

import math
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
        Of the run, as stated.
    advance : dict of float, optional
        Way of a pulse in the world, m: ``measured``, its error ``sd``, and what the models make of
        it, ``recalibrated`` and ``extended``; None where no two periods show it.
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


@dataclass(frozen=True)
class Directions:
    """What two runs that differ in their direction alone share, and what changes its sign.

    `forward` and `reverse` are the ways of a pulse in the world and `sd` the error of their sum, m.
    `world` and `robot` are force residuals while slipping, N, along the world's +x and turning with
    the robot, and `force_sd` the error of either; None where one of the runs shows none.
    """

    forward: float
    reverse: float
    sd: float
    world: float | None = None
    robot: float | None = None
    force_sd: float | None = None

    @property
    def total(self) -> float:
        """Sum of the ways of a pulse, m: zero if nothing is fixed to the world."""
        return self.forward + self.reverse


def opposite(one: FilmComparison, other: FilmComparison) -> bool:
    """Whether two runs differ in their direction alone."""
    turned = "+x" if one.scenario.drive.direction == "-x" else "-x"
    return one.scenario.replace({"drive.direction": turned}) == other.scenario


def compare_directions(one: FilmComparison, other: FilmComparison) -> Directions | None:
    """Compare two runs that are `opposite`; None where one does not show its advance."""
    if one.advance is None or other.advance is None:
        return None
    ways = one.advance["measured"], other.advance["measured"]
    sd = math.hypot(one.advance["sd"], other.advance["sd"])
    means = [
        each.view.slipping.slopes[0]
        for each in (one, other)
        if each.view is not None and each.view.slipping is not None
    ]
    if len(means) < 2:
        return Directions(*ways, sd)
    signs = [-1.0 if each.scenario.drive.direction == "-x" else 1.0 for each in (one, other)]
    world = 0.5 * sum(sign * each.value for sign, each in zip(signs, means, strict=True))
    robot = 0.5 * sum(each.value for each in means)
    return Directions(*ways, sd, world, robot, 0.5 * math.hypot(means[0].sd, means[1].sd))
