"""Which experiment would tell the leading candidates apart best."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.equal_numbers import are_equal
from stickslip.diagnosis.data.conditions import in_words
from stickslip.diagnosis.inference.discrimination import TRIALS, separate
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Predict
from stickslip.facts import Code, Fact
from stickslip.scenario.keys import Value

PROPOSED = 3
"""How many experiments are proposed if nothing else is asked for. Chosen."""

DECISIVE = 4.0
"""Expected chi-square that tells two candidates apart: two standard deviations."""

CHOICES: dict[str, tuple[Value, ...]] = {
    "drive.mode": ("IPP", "OPP"),
    "drive.direction": ("+x", "-x"),
    "drive.frequency": (0.5, 1.0, 1.5),
    "drive.peak": (0.7, 1.0, 1.2),
    "drive.hold": (0.7, 1.0, 1.3),
    "drive.edge": ("rise", "fall"),
}
"""Values of the drive's settings that are proposed: words as they are, numbers as multiples of the
middle of what was measured. Chosen."""

_ROUNDING = 0.005
"""Part of a number by which three digits may change it."""

# What one measurement beside the drive would settle, for the causes that it sees.
_LOOKS = {
    Code.LOOK_AT_CURRENTS: (
        "coil_heating", "amplifier_limit", "sample_hold", "edge_time", "mutual_inductance"
    ),
    Code.LOOK_AT_FIELD: ("field_gain", "ambient_field"),
    Code.LOOK_AT_TILT: ("surface_tilt",),
    Code.LOOK_AT_SCALE: ("length_scale",),
    Code.LOOK_AT_CLOCK: ("clock_scale",),
    Code.LOOK_AT_REST: ("angle_offset",),
    Code.LOOK_AT_STATIC_TILT: ("misalignment", "magnetization_scale"),
}  # fmt: skip


@dataclass(frozen=True)
class Experiment:
    """A condition that was not measured yet; ``str()`` gives it in words, and what it is for.

    Attributes
    ----------
    drive : dict
        Settings of ``[drive]`` by bare name.
    why : Fact
    separation : float
        Expected chi-square between the two candidates that it separates best, three trials.
    predictions : dict
        For each candidate its velocity and standard deviation, m/s.
    """

    drive: Mapping[str, Value]
    why: Fact
    separation: float
    predictions: Mapping[str, Mapping[str, float]]

    def __str__(self) -> str:
        settings = {f"drive.{key}": value for key, value in self.drive.items()}
        return f"{in_words(settings, list(CHOICES))}. {self.why}"

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
    level = found.predicted
    chosen: list[Experiment] = []
    kinds: list[tuple[Value, ...]] = []
    taken: list[int] = []
    for index in np.argsort(-found.chi2, kind="stable").tolist():
        drive, chi2 = proposals[index], float(found.chi2[index])
        kind = (drive["drive.mode"], drive["drive.direction"], drive["drive.frequency"])
        mirrored = any(np.allclose(level[:, index], -level[:, k], rtol=1e-6) for k in taken)
        if kind in kinds or mirrored or chi2 <= 0.0:
            continue
        kinds.append(kind)
        taken.append(index)
        first, second = (found.candidates[k].name for k in found.pair[index])
        predictions = {
            fit.name: {"velocity": float(value), "sd": float(sd)}
            for fit, value, sd in zip(
                found.candidates, level[:, index], found.sd[:, index], strict=True
            )
        }
        settings = {key.split(".")[1]: value for key, value in drive.items()}
        chosen.append(Experiment(settings, _worth(first, second, chi2), chi2, predictions))
        if len(chosen) >= count:
            break
    return chosen


def _worth(first: str, second: str, chi2: float) -> Fact:
    """Whether an experiment is expected to tell two candidates apart."""
    code = Code.SEPARATES if chi2 > DECISIVE else Code.SEPARATES_TOO_LITTLE
    two = {"first": first, "second": second}
    return Fact(code, {**two, "chi2": chi2, "trials": TRIALS, "needed": DECISIVE})


def undecided(experiments: Sequence[Experiment]) -> Fact | None:
    """That none of them tells the leading candidates apart, if it is so."""
    if not experiments or any(each.decides for each in experiments):
        return None
    return Fact(Code.NONE_SEPARATES, {"trials": TRIALS})


def advice(found: Findings) -> list[Fact]:
    """What to measure beside the drive, to tell the causes of a set apart."""
    names = set(found.verdict.causes) if found.verdict.kind == "ambiguous" else set()
    said = []
    for code, looked_at in _LOOKS.items():
        seen, unseen = sorted(names & set(looked_at)), sorted(names - set(looked_at))
        if seen and unseen:
            said.append(Fact(code, {"seen": seen, "unseen": unseen}))
    return said


def _middle(conditions: Sequence[Mapping[str, Value]], key: str) -> float:
    return float(np.median([float(each[f"drive.{key}"]) for each in conditions]))


def _proposals(conditions: Sequence[Mapping[str, Value]]) -> list[dict[str, Value]]:
    """Variations of the measured conditions, none of which was measured."""
    by_mode: dict[Value, dict[str, Value]] = {}
    for mode in CHOICES["drive.mode"]:
        # A mode that was not measured has what the others had.
        mine = [each for each in conditions if each["drive.mode"] == mode] or conditions
        middles = {f"drive.{key}": _middle(mine, key) for key in ("base", "hold")}
        by_mode[mode] = {**mine[0], **middles}
    frequency, peak = _middle(conditions, "frequency"), _middle(conditions, "peak")
    found: dict[tuple[tuple[str, Value], ...], dict[str, Value]] = {}
    for mode, direction, pace, field, clamp, edge in itertools.product(*CHOICES.values()):
        drive = dict(by_mode[mode])
        top = _rounded(peak * float(field))
        drive |= {
            "drive.mode": mode,
            "drive.direction": direction,
            "drive.edge": edge,
            "drive.frequency": _rounded(frequency * float(pace)),
            "drive.peak": max(top, float(drive["drive.base"])),
            "drive.hold": _rounded(float(drive["drive.hold"]) * float(clamp)),
        }
        if not any(_alike(drive, each) for each in conditions):
            found[tuple(sorted(drive.items()))] = drive
    return list(found.values())


def _rounded(value: float) -> float:
    """A setting to three digits, as a person would state it."""
    return float(f"{value:.3g}")


def _alike(one: Mapping[str, Value], other: Mapping[str, Value]) -> bool:
    """Whether two drives are the same but for the rounding of a proposal to three digits."""
    return all(
        are_equal(value, float(other[key]), _ROUNDING)
        if isinstance(value, float)
        else value == other[key]
        for key, value in one.items()
    )
