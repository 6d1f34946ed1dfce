"""Which experiment would tell the rivals apart best."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.engine import Diagnosis
from stickslip.diagnosis.fits import Fit
from stickslip.diagnosis.simulator import Examination
from stickslip.keys import Value

Array = NDArray[np.float64]

_KEPT = 3
_DECIDES = 4.0
_STEP = 0.1
_TRIALS = 3
_CHOICES: dict[str, tuple[Value, ...]] = {
    "drive.mode": ("IPP", "OPP"),
    "drive.direction": ("+x", "-x"),
    "drive.frequency": (0.5, 1.0, 1.5),
    "drive.peak": (0.7, 1.0, 1.2),
    "drive.hold": (0.7, 1.0, 1.3),
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
        ("field_gain", "ambient_field", "eddy_lag", "gradient_scale"),
    ),
    (
        "Tilt the stage by 2 degrees one way and the other: the velocities change alike about a "
        "surface that was level, which tells {seen} from {unseen}.",
        ("surface_tilt",),
    ),
    (
        "Film a scale and a clock: that shows {seen}, and nothing of {unseen}.",
        ("length_scale", "clock_scale", "angle_offset"),
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
        Expected chi-square between the two rivals that it separates best, three trials.
    predictions : dict
        For each rival its velocity and standard deviation, m/s.
    """

    drive: Mapping[str, Value]
    why: str
    separation: float
    predictions: Mapping[str, Mapping[str, float]]


def propose(examination: Examination) -> list[Experiment]:
    """The three conditions that separate the leading rivals best, each of another kind.

    What is named is to be told from the others, an ambiguous set's members from one another. Each
    rival is taken as fitted, with its own uncertainty at the new condition; where nothing was
    found, there is nothing to separate. Of a condition and its mirror image one is enough.
    """
    found = examination.found
    rivals = _rivals(found)
    leads = found.verdict.word in ("named", "pair")
    if len(rivals) < 2 or not examination.conditions:
        return []
    candidates = _candidates(examination.conditions)
    if not candidates:
        return []
    centre, spread = [], []
    for fit in rivals:
        free = fit.rival.free
        width = np.minimum(np.sqrt(np.diag(fit.covariance)), _STEP)
        points = [fit.x]
        for k, step in zip(free, width, strict=True):
            for sign in (1.0, -1.0):
                point = fit.x.copy()
                point[k] += sign * step
                points.append(point)
        physical = found.problem.physical(np.stack(points))
        shared = examination.combined.shared(physical)
        predicted = examination.simulator(candidates, shared)
        slope = (predicted[1::2] - predicted[2::2]) / (2.0 * width[:, None])
        centre.append(predicted[0])
        spread.append(np.einsum("kc,kl,lc->c", slope, fit.covariance, slope))
    level, variance = np.array(centre), np.array(spread)
    # A condition that one of the rivals cannot compute is no proposal.
    sound = np.all(np.isfinite(level) & np.isfinite(variance), axis=0)
    level, variance = np.where(sound, level, 0.0), np.where(sound, variance, 0.0)
    noise = (found.noise.floor**2 + (found.noise.relative * np.mean(level, axis=0)) ** 2) / _TRIALS
    noise += float(np.median(found.roughness[: len(examination.conditions)])) ** 2
    separation = np.zeros(len(candidates))
    pair = np.zeros((len(candidates), 2), dtype=int)
    for a, b in itertools.combinations(range(len(rivals)), 2):
        if leads and a > 0:
            continue
        gap = (level[a] - level[b]) ** 2 / (noise + variance[a] + variance[b])
        pair[gap > separation] = (a, b)
        separation = np.maximum(separation, gap)
    chosen: list[Experiment] = []
    kinds: list[tuple[Value, ...]] = []
    taken: list[int] = []
    for index in np.argsort(-separation, kind="stable"):
        drive = candidates[index]
        kind = (drive["drive.mode"], drive["drive.direction"], drive["drive.frequency"])
        mirrored = any(np.allclose(level[:, index], -level[:, k], rtol=1e-6) for k in taken)
        if kind in kinds or mirrored or separation[index] <= 0.0:
            continue
        kinds.append(kind)
        taken.append(int(index))
        first, second = (rivals[k].name for k in pair[index])
        chosen.append(
            Experiment(
                {key.split(".")[1]: value for key, value in drive.items()},
                f"separates {first} from {second}: expected chi-square {separation[index]:.1f} "
                f"with {_TRIALS} trials{'' if separation[index] > _DECIDES else ', too little'}",
                float(separation[index]),
                {
                    fit.name: {
                        "velocity": float(level[k, index]),
                        "sd": float(np.sqrt(variance[k, index])),
                    }
                    for k, fit in enumerate(rivals)
                },
            )
        )
        if len(chosen) == _KEPT:
            break
    return chosen


def advice(found: Diagnosis) -> list[str]:
    """What to look at beside the drive, to tell the causes of a set apart."""
    names = set(found.verdict.causes) if found.verdict.word == "ambiguous" else set()
    said = []
    for sentence, seen in _LOOKS:
        inside, outside = names & set(seen), names - set(seen)
        if inside and outside:
            said.append(sentence.format(seen=_listed(inside), unseen=_listed(outside)))
    return said


def _listed(names: set[str]) -> str:
    first, more = sorted(names)[:4], len(names) - 4
    return ", ".join(first) + (f" and {more} more" if more > 0 else "")


def _rivals(found: Diagnosis) -> list[Fit]:
    if not found.detection.found:
        return []
    fits = sorted([*found.ranking.singles, *found.ranking.pairs], key=lambda fit: -fit.log_evidence)
    chosen = found.verdict.fit
    if chosen is not None and found.verdict.word in ("named", "pair"):
        # What has the cause and one more says the same of it.
        own = set(chosen.rival.causes)
        fits = [chosen, *(fit for fit in fits if not own <= set(fit.rival.causes))]
    if found.verdict.word == "ambiguous" and chosen is not None:
        # Only those that the verdict cannot choose between.
        names, size = set(found.verdict.causes), len(chosen.rival.causes)
        undecided = [
            fit
            for fit in fits
            if len(fit.rival.causes) == size and {each.name for each in fit.rival.causes} <= names
        ]
        fits = undecided if len(undecided) > 1 else fits
    return fits[:_KEPT]


def _candidates(conditions: Sequence[Mapping[str, Value]]) -> list[dict[str, Value]]:
    """Variations of the measured conditions, none of which was measured."""
    measured = {tuple(sorted(each.items())) for each in conditions}
    by_mode: dict[Value, dict[str, Value]] = {}
    for each in conditions:
        by_mode.setdefault(each["drive.mode"], dict(each))
    middle = dict(conditions[len(conditions) // 2])
    frequency = float(np.median([float(each["drive.frequency"]) for each in conditions]))
    peak = float(np.median([float(each["drive.peak"]) for each in conditions]))
    found: dict[tuple[tuple[str, Value], ...], dict[str, Value]] = {}
    for mode, direction, pace, field, clamp in itertools.product(*_CHOICES.values()):
        drive = dict(by_mode.get(mode, middle))
        drive["drive.mode"], drive["drive.direction"] = mode, direction
        drive["drive.frequency"] = float(f"{frequency * float(pace):.3g}")
        top = float(f"{peak * float(field):.3g}")
        drive["drive.peak"] = max(top, float(drive["drive.base"]))
        drive["drive.hold"] = float(f"{float(drive['drive.hold']) * float(clamp):.3g}")
        key = tuple(sorted(drive.items()))
        if key not in measured:
            found[key] = drive
    return list(found.values())
