"""Which experiment would tell the leading candidates apart best."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.inference.discrimination import TRIALS, separate
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Predict
from stickslip.scenario.keys import Value

Array = NDArray[np.float64]

PROPOSED = 3
"""How many experiments are proposed if nothing else is asked for."""

DECISIVE = 4.0
"""Expected chi-square that tells two candidates apart: two standard deviations."""

_CHOICES: dict[str, tuple[Value, ...]] = {
    "drive.mode": ("IPP", "OPP"),
    "drive.direction": ("+x", "-x"),
    "drive.frequency": (0.5, 1.0, 1.5),
    "drive.peak": (0.7, 1.0, 1.2),
    "drive.hold": (0.7, 1.0, 1.3),
    "drive.edge": ("rise", "fall"),
}
# What one look beside the drive would settle, for the causes that it sees.
_LOOKS = (
    (
        "Log the coil currents: they show {seen} directly, and nothing of {unseen}.",
        ("coil_heating", "amplifier_limit", "sample_hold", "edge_time", "mutual_inductance"),
    ),
    (
        "Measure the field at the robot for known currents: it shows {seen}, and nothing of "
        "{unseen}.",
        ("field_gain", "ambient_field"),
    ),
    (
        "Tilt the stage by 2 degrees one way and the other: the velocities change alike about a "
        "surface that was level, which tells {seen} from {unseen}.",
        ("surface_tilt",),
    ),
    ("Film a scale: it shows {seen}, and nothing of {unseen}.", ("length_scale",)),
    ("Film a clock: it shows {seen}, and nothing of {unseen}.", ("clock_scale",)),
    (
        "Film the robot flat on the surface without a field: that shows {seen}, and nothing of "
        "{unseen}.",
        ("angle_offset",),
    ),
    (
        "Read the static tilt in held fields: it shows {seen}, and nothing of {unseen}.",
        ("misalignment", "magnetization_scale"),
    ),
)


@dataclass(frozen=True)
class Experiment:
    """A condition that was not measured yet.

    Attributes
    ----------
    drive : dict
        Settings of ``[drive]`` by bare name.
    why : str
    separation : float
        Expected chi-square between the two candidates that it separates best, three trials.
    predictions : dict
        For each candidate its velocity and standard deviation, m/s.
    """

    drive: Mapping[str, Value]
    why: str
    separation: float
    predictions: Mapping[str, Mapping[str, float]]

    @property
    def decides(self) -> bool:
        """Whether it is expected to tell them apart."""
        return self.separation > DECISIVE


def propose(
    findings: Findings,
    predict: Predict,
    conditions: Sequence[Mapping[str, Value]],
    count: int = PROPOSED,
) -> list[Experiment]:
    """The drives that separate the leading candidates best, each of another kind.

    Proposals are variations of what was measured; see `separate`. Of a condition and its mirror
    image one is enough.

    Parameters
    ----------
    findings : Findings
    predict : callable
        Velocities, m/s, shape (vectors, drives), of drive settings by dotted key and all parameters
        of the problem.
    conditions : sequence of dict
        What was measured; without any, nothing is proposed.
    count : int
        How many at most.
    """
    proposals = _proposals(conditions) if conditions else []
    found = separate(findings, predict, proposals) if proposals else None
    if found is None:
        return []
    chosen: list[Experiment] = []
    kinds: list[tuple[Value, ...]] = []
    taken: list[int] = []
    for index in np.argsort(-found.chi2, kind="stable"):
        drive = proposals[index]
        kind = (drive["drive.mode"], drive["drive.direction"], drive["drive.frequency"])
        level = found.predicted
        mirrored = any(np.allclose(level[:, index], -level[:, k], rtol=1e-6) for k in taken)
        if kind in kinds or mirrored or found.chi2[index] <= 0.0:
            continue
        kinds.append(kind)
        taken.append(int(index))
        first, second = (found.candidates[k].name for k in found.pair[index])
        chi2 = float(found.chi2[index])
        chosen.append(
            Experiment(
                {key.split(".")[1]: value for key, value in drive.items()},
                f"separates {first} from {second}: expected chi-square {chi2:.1f} "
                f"with {TRIALS} trials{'' if chi2 > DECISIVE else ', too little'}",
                chi2,
                {
                    fit.name: {
                        "velocity": float(level[k, index]),
                        "sd": float(found.sd[k, index]),
                    }
                    for k, fit in enumerate(found.candidates)
                },
            )
        )
        if len(chosen) >= count:
            break
    return chosen


def advice(found: Findings) -> list[str]:
    """What to look at beside the drive, to tell the causes of a set apart."""
    names = set(found.verdict.causes) if found.verdict.kind == "ambiguous" else set()
    said = []
    for sentence, seen in _LOOKS:
        inside, outside = names & set(seen), names - set(seen)
        if inside and outside:
            said.append(sentence.format(seen=_listed(inside), unseen=_listed(outside)))
    return said


def _listed(names: set[str]) -> str:
    first, more = sorted(names)[:4], len(names) - 4
    return ", ".join(first) + (f" and {more} more" if more > 0 else "")


def _middle(conditions: Sequence[Mapping[str, Value]], key: str) -> float:
    return float(np.median([float(each[f"drive.{key}"]) for each in conditions]))


def _proposals(conditions: Sequence[Mapping[str, Value]]) -> list[dict[str, Value]]:
    """Variations of the measured conditions, none of which was measured."""
    by_mode: dict[Value, dict[str, Value]] = {}
    for mode in _CHOICES["drive.mode"]:
        # A mode that was not measured has what the others had.
        mine = [each for each in conditions if each["drive.mode"] == mode] or conditions
        middles = {f"drive.{key}": _middle(mine, key) for key in ("base", "hold")}
        by_mode[mode] = {**mine[0], **middles}
    frequency, peak = _middle(conditions, "frequency"), _middle(conditions, "peak")
    found: dict[tuple[tuple[str, Value], ...], dict[str, Value]] = {}
    for mode, direction, pace, field, clamp, edge in itertools.product(*_CHOICES.values()):
        drive = dict(by_mode[mode])
        drive["drive.mode"], drive["drive.direction"], drive["drive.edge"] = mode, direction, edge
        drive["drive.frequency"] = float(f"{frequency * float(pace):.3g}")
        top = float(f"{peak * float(field):.3g}")
        drive["drive.peak"] = max(top, float(drive["drive.base"]))
        drive["drive.hold"] = float(f"{float(drive['drive.hold']) * float(clamp):.3g}")
        if not any(_alike(drive, each) for each in conditions):
            found[tuple(sorted(drive.items()))] = drive
    return list(found.values())


def _alike(one: Mapping[str, Value], other: Mapping[str, Value]) -> bool:
    """Whether two drives are the same but for the rounding of a proposal to three digits."""
    return all(
        math.isclose(value, float(other[key]), rel_tol=0.005)
        if isinstance(value, float)
        else value == other[key]
        for key, value in one.items()
    )
