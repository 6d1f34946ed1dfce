"""``python -m bench drops FILE``: drops of a real square, fitted and predicted by the core.

Constants are fitted on one half of the drops and the other half is predicted from its free frames,
both ways; with --fit they come from all drops of another file. Prints tables, writes JSON.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np
from measure import saved

from .fits import (
    VARIANTS,
    by_kind,
    deviations,
    errors,
    fit,
    friction_by_speed,
    from_noise,
    held_out,
    judged_starts,
    refit,
)
from .flights import FRAME, Drops, read_drops
from .prediction import AFTER, Model, at_plate, measured

FEWEST = 20
"""Drops. Chosen: half of them have some 17 impacts that stand alone, for a geometry of six."""


def table(drops: Drops, model: Model) -> str:
    """Last free state of each drop and the pose `AFTER` it, CSV; of the centre of mass.

    In m, rad and s, above the plate and along it, without the offset and with the lean.
    """
    begin = judged_starts(drops, model)
    later = measured(drops, begin, round(AFTER / FRAME))[:, -1]
    later[:, :2] -= np.stack(model.flight.marker(later[:, 2]), axis=1)
    rows = np.concatenate(
        [
            drops.name[begin.drop, None],
            at_plate(model, begin.state)[:, :6],
            at_plate(model, np.pad(later, ((0, 0), (0, 3))))[:, :3],
        ],
        axis=1,
    )
    heads = "drop,x,z,theta,vx,vz,omega,later_x,later_z,later_theta"
    return "\n".join(
        [heads, *(",".join([f"{row[0]:.0f}", *(f"{v:.5f}" for v in row[1:])]) for row in rows)]
    )


def line(name: str, error: np.ndarray) -> str:
    x, z, theta = np.median(error, axis=0)
    return f"{name:30s} {len(error):5d} {1e3 * x:8.2f} {1e3 * z:8.2f} {theta:8.3f}"


def study(drops: Drops, fitted: Drops | None = None) -> tuple[dict[str, object], Model]:
    """Print what was found; the same as numbers for JSON, and the model of all drops."""
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
    friction = friction_by_speed(basis, whole.model)
    print("\nfriction where an impact slips  impacts   median")
    for name, (number, ratio) in friction.items():
        print(f"approach {name:21s} {number:8d} {ratio:8.3f}")
    title = f"median error {1e3 * AFTER:.0f} ms after contact"
    print(f"\n{title:30s} drops   x (mm)   z (mm) theta (rad)")
    for name, error in found.items():
        print(line(name.removeprefix("of all constants: "), error))
    numbers = {
        "constants": {name: {"value": v, "sd": sd} for name, (v, sd) in shown.items()},
        "flight": asdict(whole.model.flight),
        "friction by approach speed": friction,
        "errors": {
            name: {"drops": len(error), "median": np.median(error, axis=0).tolist()}
            for name, error in found.items()
        },
        "held_out": "the other half" if fitted is None else "another file",
    }
    return numbers, whole.model


def main(arguments: list[str] | None = None) -> int:
    """Read, fit, predict; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m bench drops", description=__doc__)
    parser.add_argument("file", type=Path, help="drops to predict, CSV, possibly compressed")
    parser.add_argument("--fit", type=Path, help="drops to fit; else the other half of FILE")
    parser.add_argument("--out", type=Path, default=Path("bench/results/drops.json"))
    parser.add_argument("--table", type=Path, help="also write last free states and later poses")
    options = parser.parse_args(arguments)
    try:
        read = [read_drops(path) for path in (options.file, options.fit) if path is not None]
        for path, drops in zip((options.file, options.fit), read, strict=False):
            if len(drops) < FEWEST:
                raise ValueError(f"{path}: {len(drops)} drops; at least {FEWEST} are needed")
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    result, model = study(*read)
    if options.table:
        options.table.write_text(table(read[0], model) + "\n")
    saved(options.out, "drops", {"file": options.file.name, **result})
    return 0


if __name__ == "__main__":
    sys.exit(main())
