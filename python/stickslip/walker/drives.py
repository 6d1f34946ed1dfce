"""Drives that were not measured yet, and the choice of those that separate candidates best."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import logsumexp

from stickslip._util.arrays import Array
from stickslip.diagnosis.decision import experiments as design
from stickslip.diagnosis.decision.experiments import TRIALS, Experiment
from stickslip.scenario.keys import Value
from stickslip.walker.velocity import settings_of

Drive = Mapping[str, Value]
"""Settings of ``[drive]`` by dotted key."""

CHOICES: dict[str, tuple[Value, ...]] = {
    "drive.mode": ("IPP", "OPP"),
    "drive.direction": ("+x", "-x"),
    "drive.frequency": (0.5, 1.0, 1.5),
    "drive.peak": (0.7, 1.0, 1.2),
    "drive.hold": (0.7, 1.0, 1.3),
    "drive.edge": ("rise", "fall"),
}
"""Settings that proposals vary: words as they are, numbers as multiples of the middle of what was
measured. Chosen."""

_NOTHING = 1e-6  # chi-square that is no more than rounding; chosen


def proposals(conditions: Sequence[Drive]) -> list[dict[str, Value]]:
    """Vary the measured drives; propose none that was measured, and none without any."""
    measured = {tuple(_rounded(drive[key]) for key in CHOICES) for drive in conditions}
    drives: dict[tuple[Value, ...], dict[str, Value]] = {}

    def scaled(key: str, factor: Value, among: Sequence[Drive] = conditions) -> Value:
        return _rounded(float(factor) * float(np.median([drive[key] for drive in among])))

    for choice in itertools.product(*CHOICES.values()) if conditions else ():
        new: dict[str, Value] = dict(zip(CHOICES, choice, strict=True))
        # A mode that was not measured has what the others had.
        mine = [one for one in conditions if one["drive.mode"] == new["drive.mode"]] or conditions
        base = float(np.median([drive["drive.base"] for drive in mine]))
        new["drive.frequency"] = scaled("drive.frequency", new["drive.frequency"])
        new["drive.peak"] = max(scaled("drive.peak", new["drive.peak"]), base)
        new["drive.hold"] = scaled("drive.hold", new["drive.hold"], mine)
        drives[tuple(new.values())] = {**mine[0], "drive.base": base, **new}
    return [drive for values, drive in drives.items() if values not in measured]


def _rounded(value: Value) -> Value:
    """A number to three digits, as a person would state it."""
    return float(f"{value:.3g}") if isinstance(value, float) else value


def choose(
    drives: Sequence[Drive], names: Sequence[str], predicted: tuple[Array, Array, Array],
    pairs: Sequence[tuple[int, int]], count: int, trials: int = TRIALS,
) -> tuple[list[Experiment], Array]:  # fmt: skip
    """Choose the drives that leave the least odds of taking one candidate for another.

    The odds of a pair are exp(-chi2 / 2), of its mean log-evidence; those of all `pairs` are added.
    Each drive is the best with those before it, and of another mode, direction or frequency.
    `names` are those of the candidates, `predicted` the arrays of `expected_chi2`, in m/s. Return
    the chi2 of each pair by all drives, too.
    """
    reached, chosen, experiments = np.zeros(len(pairs)), list[int](), list[Experiment]()
    if not pairs or not drives:
        return experiments, reached
    (level, covariance, _), (first, second) = predicted, np.transpose(pairs)
    kinds = np.array([str([drive[key] for key in [*CHOICES][:3]]) for drive in drives])
    left = np.ones(len(drives), dtype=bool)
    while len(chosen) < count and np.any(left):
        chi2 = design.expected_chi2(*predicted, chosen)[first, second]
        k = int(np.argmin(np.where(left, logsumexp(-0.5 * chi2, axis=0), np.inf)))
        close = reached <= design.DECISIVE  # these first
        gains = np.where(close | ~np.any(close), chi2[:, k] - reached, 0.0)
        best, sd = int(np.argmax(gains)), np.sqrt(covariance[:, k, k])
        two, gain = (names[first[best]], names[second[best]]), float(gains[best])
        beside = ", beside the drives before it" if chosen else ""
        if not gain > _NOTHING:
            break
        experiments.append(Experiment(
            {key.removeprefix("drive."): value for key, value in drives[k].items()},
            drive_in_words(drives[k]), design.separates(*two, gain, trials, beside), gain,
            {name: {"velocity": float(level[c, k]), "sd": float(sd[c])}
             for c, name in enumerate(names)},
        ))  # fmt: skip
        mirrored = np.all(np.isclose(level, -level[:, [k]], rtol=1e-6, atol=0.0), axis=0)
        left &= ~mirrored & (kinds != kinds[k])
        chosen, reached = [*chosen, k], chi2[:, k]
    return experiments, reached


def drive_in_words(drive: Drive) -> str:
    """A drive by the settings that proposals vary."""
    settings = settings_of([drive])
    words = [settings.text(key.removeprefix("drive."), drive[key]) for key in CHOICES]
    return ", ".join(words).replace("edge ", "sudden edge: ")
