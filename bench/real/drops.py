"""``python -m bench.real.drops FILE``: drops of a real square, fitted and predicted by the core.

Constants are fitted on one half of the drops and the other half is predicted from its free frames,
both ways; with --fit they come from all drops of another file. Prints tables, writes JSON.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import numpy as np
from bench.measure import machine

import stickslip

from .contacts import ContactGeometry, fit_contacts, single_impacts
from .flights import NOISE, Drops, find_flights, fit_flights, read_drops
from .prediction import (
    AFTER,
    UNIT,
    ImpactConstants,
    Model,
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
"""Constants of impact that are held, by the name of what is tried."""

FRAMES_NEEDED = 20
FEWEST = 20
_GROUPS = 5


@dataclass(frozen=True)
class Fit:
    """A model, and the standard deviations of its geometry."""

    model: Model
    geometry_sd: ContactGeometry


def fit(drops: Drops, held: dict[str, float] | None = None, tries: int = 150) -> Fit:
    """Free flights, then heights at contact, then the frames after it; no pose at rest."""
    flights = find_flights(drops)
    constants = fit_flights(drops, flights)
    geometry, deviation = fit_contacts(single_impacts(drops, flights, constants))
    return Fit(refit(drops, first_guess(constants, geometry), held or {}, tries), deviation)


def refit(drops: Drops, model: Model, held: dict[str, float], tries: int = 150) -> Model:
    """The model with constants of impact that suit these drops, but for those that are held."""
    model = replace(model, impact=replace(model.impact, **held))
    begin = starts(drops, find_flights(drops), model.flight, FRAMES_NEEDED)
    return fit_impacts(model, drops, begin, tuple(held), tries)


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
    begin = starts(drops, find_flights(drops), model.flight, FRAMES_NEEDED)
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
        begin = starts(drops, find_flights(drops), model.flight, FRAMES_NEEDED)
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


def from_noise(pairs: list[tuple[Drops, Model]], seed: int = 1) -> np.ndarray:
    """Changes of the predictions where the free frames are read once more, shape (n, 3)."""
    rng = np.random.default_rng(seed)
    changes = []
    for drops, model in pairs:
        flights = find_flights(drops)
        again = replace(drops, poses=drops.poses + NOISE * rng.standard_normal(drops.poses.shape))
        once, twice = (
            errors_at(model, drops, starts(each, flights, model.flight, FRAMES_NEEDED))
            for each in (drops, again)
        )
        changes.append(np.abs(twice - once))
    return np.concatenate(changes)


def line(name: str, error: np.ndarray) -> str:
    x, z, theta = np.median(error, axis=0)
    return f"{name:30s} {len(error):5d} {1e3 * x:8.2f} {1e3 * z:8.2f} {theta:8.3f}"


def study(drops: Drops, fitted: Drops | None = None) -> dict[str, object]:
    """Print what was found; the same as numbers for JSON."""
    basis = drops if fitted is None else fitted
    whole = fit(basis)
    spread = deviations(basis, whole.model)
    print("fitted on all                     value       sd")
    shown = {}
    for part, sd in ((whole.model.geometry, whole.geometry_sd), (whole.model.impact, spread)):
        for field in fields(part):
            shown[field.name] = (getattr(part, field.name), getattr(sd, field.name))
            print(f"{field.name:30s} {shown[field.name][0]:9.5f} {shown[field.name][1]:8.5f}")
    for name, value in asdict(whole.model.flight).items():
        print(f"{name:30s} {value:9.5f}")
    if fitted is None:
        found, pairs = held_out(drops)
    else:
        models = {name: refit(fitted, whole.model, held) for name, held in VARIANTS.items() if held}
        models = {"all constants": whole.model, **models}
        found = {name: errors(drops, model) for name, model in models.items()}
        pairs = [(drops, whole.model)]
    found |= {"of all constants: " + name: each for name, each in by_kind(pairs).items()}
    found["change by noise alone"] = from_noise(pairs)
    title = f"median error {1e3 * AFTER:.0f} ms after contact"
    print(f"\n{title:30s} drops   x (mm)   z (mm) theta (rad)")
    for name, error in found.items():
        print(line(name.removeprefix("of all constants: "), error))
    return {
        "constants": {name: {"value": v, "sd": sd} for name, (v, sd) in shown.items()},
        "flight": asdict(whole.model.flight),
        "errors": {
            name: {"drops": len(error), "median": np.median(error, axis=0).tolist()}
            for name, error in found.items()
        },
        "held_out": "the other half" if fitted is None else "another file",
    }


def main(arguments: list[str] | None = None) -> int:
    """Read, fit, predict; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m bench.real.drops", description=__doc__)
    parser.add_argument("file", type=Path, help="drops to predict, CSV, possibly compressed")
    parser.add_argument("--fit", type=Path, help="drops to fit; else the other half of FILE")
    parser.add_argument("--out", type=Path, default=Path("bench/results/drops.json"))
    options = parser.parse_args(arguments)
    try:
        read = [read_drops(path) for path in (options.file, options.fit) if path is not None]
        for path, drops in zip((options.file, options.fit), read, strict=False):
            if len(drops) < FEWEST:
                raise ValueError(f"{path}: {len(drops)} drops; at least {FEWEST} are needed")
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    result = study(*read)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    about = {"machine": machine(), "stickslip": stickslip.__version__, "file": options.file.name}
    options.out.write_text(json.dumps({**about, **result}, indent=2) + "\n")
    print(f"written: {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
