"""``python -m real.scoreboard``: measured sets, diagnosed and held against what is known of them.

Prints a Markdown table and writes JSON. The status is 1 where a cause is claimed that is wrong.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
from measure import machine

import stickslip
from stickslip.diagnosis.result import CLAIMS

from .flights import read_drops
from .impacts import diagnose_impacts, first_impacts, heights, velocities
from .rollers import diagnose_rollers
from .tumbler import diagnose_tumbler

DATA = Path(__file__).parents[2] / "tests" / "data"
DROPS = DATA / "square_drops.csv.gz"
ANGLE_AT_REST, ANGLE_AT_REST_SD = 33.4e-3, 1.3e-3
"""By how much the drops' angles are read too large, rad, in this project's sense of theta, and its
error: the mean over the four faces of the square in poses at rest, which no diagnosis here sees."""

_FAR = 3.0
"""Standard deviations. Chosen: an estimate farther from the truth than that is wrong."""
_MOST_SHOWN = 4
"""Causes of a set that are listed. Chosen: they fit in a table."""


@dataclass(frozen=True)
class Truth:
    """What is known of a set without the diagnosis.

    Attributes
    ----------
    text : str
    present, possible : tuple of str
        Causes that act for certain, and further ones of which it is not known whether they do.
    values : dict of tuple
        Parameters that are known, each by its value and standard deviation.
    certain : bool
        Whether it is known at all, or only what can be said from the same data.
    """

    text: str
    present: tuple[str, ...]
    possible: tuple[str, ...]
    values: dict[str, tuple[float, float]]
    certain: bool = True


@dataclass(frozen=True)
class Score:
    """A line of the table, as text."""

    set: str
    rows: int
    verdict: str
    found: str
    lead: str
    held_out: str
    truth: str
    judgement: str
    cpu_s: float


TUMBLER = Truth(
    "not known otherwise; a moment along the body cannot rest near 55 degrees",
    ("misalignment",),
    ("angle_offset", "surface_tilt", "ambient_field"),
    {},
    certain=False,
)
ROLLERS = Truth(
    "not known otherwise; every run peaks at 48 to 66 Hz as a rotor that steps out",
    ("step_out",),
    ("coil_lag", "offset"),
    {},
    certain=False,
)
HEIGHTS = Truth(
    "poses at rest: angle offset 33.4 mrad, slope 3.2 mrad, marker 0.5 mm off the middle",
    ("angle_offset", "marker_place"),
    ("rounding", "plate_slope"),
    {"angle_offset.angle": (ANGLE_AT_REST, ANGLE_AT_REST_SD)},
)
VELOCITIES = Truth(
    "poses at rest: angle offset 33.4 mrad, slope 3.2 mrad; friction falls with speed",
    ("angle_offset",),
    (
        *("rounding", "plate_slope", "tangential_restitution", "slippery_when_fast"),
        *("mass_place", "marker_place"),
    ),
    {"angle_offset.angle": (ANGLE_AT_REST, ANGLE_AT_REST_SD)},
)


def judged(result: stickslip.Diagnosis, truth: Truth) -> str:
    """What the verdict is worth: right or wrong where it claims a cause, else open.

    A claim is right that has a cause which is present, none that cannot be, and no parameter that
    lies far from what is known.
    """
    kind, causes = result.verdict.kind, set(result.verdict.causes)
    if kind in CLAIMS:
        strange = causes - {*truth.present, *truth.possible}
        off = _far_off(result, truth)
        right = causes & set(truth.present) and not strange and not off
        if right:
            return "right" if truth.certain else "not contradicted"
        return "wrong: " + ", ".join([*sorted(strange or causes), *off])
    inside = [name for name in truth.present if name in causes]
    if kind == "ambiguous":
        return "open, the truth in the set" if inside else "open, the truth not in the set"
    leader = result.verdict.leader
    there = leader is not None and leader.names & set(truth.present)
    return "open, the truth nearest" if there else "open"


def _far_off(result: stickslip.Diagnosis, truth: Truth) -> list[str]:
    """Parameters of what is claimed that lie far from what is known."""
    found = []
    for name, (value, sd) in truth.values.items():
        if name in result.params.index:
            row = result.params.loc[name]
            if abs(row["value"] - value) > _FAR * np.hypot(row["sd"], sd):
                found.append(f"{name} = {row['value']:.4f}")
    return found


def _found(result: stickslip.Diagnosis, truth: Truth) -> str:
    """What is claimed, or comes nearest, and the estimates of what is known."""
    causes, leader = result.verdict.causes, result.verdict.leader
    if not causes:
        return "-" if leader is None else f"nearest: {leader.name}"
    joined = (" + " if result.verdict.kind == "pair" else ", ").join(causes[:_MOST_SHOWN])
    joined += f" and {len(causes) - _MOST_SHOWN} more" if len(causes) > _MOST_SHOWN else ""
    for name in truth.values:
        if name in result.params.index:
            row = result.params.loc[name]
            joined += f"; {name} = {row['value']:.4f} +- {row['sd']:.4f} {row['unit']}"
    return joined


def _lead(result: stickslip.Diagnosis) -> str:
    """Logarithm of the probability of the first model over that of the best other one.

    Of a set the other one is no member of it.
    """
    models, (first, *others) = result.chance.models, result.chance.fits
    members = result.verdict.members if result.verdict.kind == "ambiguous" else (first,)
    inside = {each.name for each in members}
    second = next((each for each in others if each.name not in inside), None)
    if second is None:
        return "-"
    odds = math.log(models[first.name] / max(models[second.name], 1e-300))
    return f"{odds:.1f}: {first.name} over {second.name}"


def _held_out(result: stickslip.Diagnosis, unit: tuple[float, str]) -> str:
    """Errors of the recalibrated and the extended model, or of the leader, of each table."""
    gain, (factor, word) = result.gain, unit
    if gain is None:
        return "-"
    before, after = (
        ", ".join(f"{factor * each:.3g}" for each in part.values())
        for part in (gain.mae_before, gain.mae_after)
    )
    return f"{before} -> {after} {word}"


def score(
    name: str, unit: tuple[float, str], truth: Truth, diagnosed: Callable[[], stickslip.Diagnosis]
) -> Score:
    """A set, diagnosed; the factor of the unit takes errors from SI to it."""
    begin = time.process_time()
    result = diagnosed()
    used = time.process_time() - begin
    return Score(
        name,
        len(result.problem.y),
        result.verdict.kind,
        _found(result, truth),
        _lead(result),
        _held_out(result, unit),
        truth.text,
        judged(result, truth),
        round(used, 1),
    )


def scores(drops: Path = DROPS) -> list[Score]:
    """All sets."""
    impacts = first_impacts(read_drops(drops))
    return [
        score("tumbler, angles", (57.2958, "degrees"), TUMBLER, diagnose_tumbler),
        score(
            "rollers, speeds",
            (1e6, "um/s"),
            ROLLERS,
            lambda: diagnose_rollers(DATA / "roller_velocity.csv"),
        ),
        score(
            "drops, heights at contact",
            (1e3, "mm"),
            HEIGHTS,
            lambda: diagnose_impacts(heights, impacts),
        ),
        score(
            "drops, velocities after",
            (1e3, "mm/s"),
            VELOCITIES,
            lambda: diagnose_impacts(velocities, impacts),
        ),
    ]


def table(found: list[Score]) -> str:
    """The scores as Markdown."""
    heads = [each.name.replace("_", " ") for each in fields(Score)]
    rows = [heads, ["---"] * len(heads)]
    rows += [[str(value) for value in asdict(each).values()] for each in found]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def main(arguments: list[str] | None = None) -> int:
    """Diagnose, print and write; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m real.scoreboard", description=__doc__)
    parser.add_argument("--drops", type=Path, default=DROPS, help="CSV of drops")
    parser.add_argument("--out", type=Path, default=Path("bench/results/scoreboard.json"))
    options = parser.parse_args(arguments)
    try:
        found = scores(options.drops)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    print(table(found))
    options.out.parent.mkdir(parents=True, exist_ok=True)
    about = {"machine": machine(), "stickslip": stickslip.__version__, "drops": options.drops.name}
    written = {**about, "scores": [asdict(each) for each in found]}
    options.out.write_text(json.dumps(written, indent=2) + "\n")
    print(f"written: {options.out}")
    return int(any(each.judgement.startswith("wrong") for each in found))


if __name__ == "__main__":
    sys.exit(main())
