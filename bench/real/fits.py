"""Fits of all constants to drops, and how far predictions by them are from other drops."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from itertools import pairwise

import numpy as np

from .contacts import ContactGeometry, fit_contacts, single_impacts, slipping_friction
from .flights import NOISE, Drops, find_flights, fit_flights
from .prediction import (
    UNIT,
    ImpactConstants,
    Model,
    Starts,
    errors_at,
    first_guess,
    fit_impacts,
    starts,
    tilt_at_contact,
    touch_downs,
)

VARIANTS: dict[str, dict[str, float]] = {
    "all constants": {},
    "no lean": {"lean": 0.0},
    "no tangential restitution": {"tangential_restitution": 0.0},
    "neither": {"lean": 0.0, "tangential_restitution": 0.0},
}
"""Constants of impact that are held, by the name of the trial."""

_FRAMES_NEEDED = 20
"""Frames after the last free one. Chosen: `errors_at` reads 17 of them, a few are to spare."""
_GROUPS = 5
"""Groups of drops for a jackknife. Chosen: each costs a fit of the impacts, the longest part."""


@dataclass(frozen=True)
class Fit:
    """A model, and the standard deviations of its geometry."""

    model: Model
    geometry_sd: ContactGeometry


def fit(drops: Drops, tries: int = 150) -> Fit:
    """Free flights, then heights at contact, then the frames after it; no pose at rest."""
    flights = find_flights(drops)
    constants = fit_flights(drops, flights)
    geometry, deviation = fit_contacts(single_impacts(drops, flights, constants))
    return Fit(refit(drops, first_guess(constants, geometry), {}, tries), deviation)


def refit(drops: Drops, model: Model, held: dict[str, float], tries: int = 150) -> Model:
    """The model with constants of impact that suit these drops, but for those that are held."""
    model = replace(model, impact=replace(model.impact, **held))
    return fit_impacts(model, drops, judged_starts(drops, model), tuple(held), tries)


def judged_starts(drops: Drops, model: Model) -> Starts:
    """Last free frames of the drops that can be judged."""
    return starts(drops, find_flights(drops), model.flight, _FRAMES_NEEDED)


def deviations(drops: Drops, model: Model, tries: int = 75) -> ImpactConstants:
    """Standard deviations of the constants of impact, by a jackknife over groups of drops.

    With the accuracy of the search: it ends within a fiftieth of the steps it begins with.
    """
    group = np.arange(len(drops)) % _GROUPS
    left = [refit(drops.some(group != each), model, {}, tries) for each in range(_GROUPS)]
    table = np.array([list(asdict(each.impact).values()) for each in left])
    spread = np.sqrt((_GROUPS - 1) * np.mean((table - table.mean(axis=0)) ** 2, axis=0))
    search = 0.02 * np.array(list(asdict(UNIT).values()))
    return ImpactConstants(*map(float, np.hypot(spread, search)))


def errors(drops: Drops, model: Model) -> np.ndarray:
    """Absolute errors of x, z (m) and theta (rad) at `AFTER`, a row a drop that can be judged."""
    begin = judged_starts(drops, model)
    return np.abs(errors_at(model, drops, begin))


def held_out(drops: Drops) -> tuple[dict[str, np.ndarray], list[tuple[Drops, Model]]]:
    """Errors of each variant on the half that was not fitted, and the halves with their models."""
    half = np.arange(len(drops)) % 2
    found: dict[str, list[np.ndarray]] = {name: [] for name in VARIANTS}
    pairs = []
    for one in (0, 1):
        fitted, other = drops.some(half == one), drops.some(half != one)
        model = fit(fitted).model
        pairs.append((other, model))
        for name, held in VARIANTS.items():
            each = refit(fitted, model, held) if held else model
            found[name].append(errors(other, each))
    return {name: np.concatenate(parts) for name, parts in found.items()}, pairs


def by_kind(pairs: list[tuple[Drops, Model]]) -> dict[str, np.ndarray]:
    """Errors by the number of touch-downs that are predicted, and by the tilt at the first."""
    error, count, tilt = [], [], []
    for drops, model in pairs:
        begin = judged_starts(drops, model)
        error.append(np.abs(errors_at(model, drops, begin)))
        count.append(touch_downs(model, begin))
        tilt.append(np.abs(tilt_at_contact(model, begin)))
    errors_, counts, tilts = (np.concatenate(each) for each in (error, count, tilt))
    kinds = {
        "one touch-down": counts <= 1,
        "two": counts == 2,
        "more": counts > 2,
        "tilted by less than 0.1 rad": tilts < 0.1,
        "0.1 to 0.2": (tilts >= 0.1) & (tilts < 0.2),
        "0.2 to 0.4": (tilts >= 0.2) & (tilts < 0.4),
        "0.4 and more": tilts >= 0.4,
    }
    return {name: errors_[which] for name, which in kinds.items() if which.any()}


def friction_by_speed(drops: Drops, model: Model) -> dict[str, tuple[int, float]]:
    """How many impacts slipped one way all along, and their median friction, by approach speed."""
    impacts = single_impacts(drops, find_flights(drops), model.flight)
    speed, ratio = slipping_friction(impacts, model.geometry)
    found = {}
    for low, high in pairwise((0.0, 0.5, 1.0, 2.0, np.inf)):
        some = ratio[(speed >= low) & (speed < high)]
        if len(some):
            found[f"{low:g} to {high:g} m/s"] = (len(some), float(np.median(some)))
    return found


def from_noise(pairs: list[tuple[Drops, Model]], seed: int = 1) -> np.ndarray:
    """Changes of the predictions where the free frames are read once more, shape (n, 3)."""
    rng = np.random.default_rng(seed)
    changes = []
    for drops, model in pairs:
        flights = find_flights(drops)
        again = replace(drops, poses=drops.poses + NOISE * rng.standard_normal(drops.poses.shape))
        once, twice = (
            errors_at(model, drops, starts(each, flights, model.flight, _FRAMES_NEEDED))
            for each in (drops, again)
        )
        changes.append(np.abs(twice - once))
    return np.concatenate(changes)
