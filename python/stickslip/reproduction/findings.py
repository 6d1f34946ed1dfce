"""What the survey says beyond single statements, in sentences and in a table of settings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.reproduction.outcome import Flags, Outcome
from stickslip.reproduction.reference import working_pairs
from stickslip.reproduction.settings import MODES
from stickslip.reproduction.survey import Survey
from stickslip.reproduction.tables import Table

_MOTION = ("S1", "S2", "S3", "S4")


def findings(found: Survey, outcomes: Mapping[str, Outcome]) -> list[str]:
    """Sentences on how many settings work, and on what those have in common that match best."""
    works = working_pairs(found)
    counts = np.zeros(works.shape, dtype=np.int64)
    for outcome in outcomes.values():
        counts += np.broadcast_to(outcome.holds, works.shape)
    all_four = works.copy()
    for name in _MOTION:
        all_four &= outcomes[name].holds
    most = int(counts[works].max()) if works.any() else 0
    best = works & (counts == most)
    sentences = [
        f"{int(found.works(mode).sum())} of {len(found.settings[mode])} settings of {mode} work: "
        "the robot walks forwards at 30 Hz and at 100 Hz, with its tilt between flat and upright."
        for mode in MODES
    ]
    sentences.append(
        f"Of the {int(works.sum())} pairs of working settings, {int(all_four.sum())} have S1 to S4 "
        f"all hold; {_same_clamp(found, all_four)} of these have the same clamp polarity in both "
        "modes."
    )
    sentences.append(
        f"No pair has more than {most} of the {len(outcomes)} statements that depend on settings; "
        f"{int(best.sum())} {'has' if best.sum() == 1 else 'have'} as many."
    )
    return sentences


def _same_clamp(found: Survey, pairs: Flags) -> int:
    ipp, opp = (np.array([each.clamp for each in found.settings[mode]]) for mode in MODES)
    return int((pairs & (ipp[:, np.newaxis] == opp)).sum())


def settings_table(found: Survey) -> Table:
    """A row for every setting of the grid: what it is, and what it does."""
    rows: list[dict[str, Any]] = []
    for mode in MODES:
        works = found.works(mode)
        velocity = found.at(mode, "frequency", (30.0, 100.0))
        for k, setting in enumerate(found.settings[mode]):
            strokes = found.strokes[mode][k]
            rows.append(
                {
                    "mode": mode,
                    "edge": setting.edge,
                    "clamp": setting.clamp,
                    "base": setting.base,
                    "hold": setting.hold,
                    "works": bool(works[k]),
                    "velocity_30_hz": float(velocity[k, 0]),
                    "velocity_100_hz": float(velocity[k, 1]),
                    "still_tilt": float(found.still_tilt[mode][k]),
                    "mean_tilt": strokes.tilt if strokes else math.nan,
                    "slip_share_up": strokes.share_up if strokes else math.nan,
                    "normal_force_up": strokes.normal_up if strokes else math.nan,
                    "normal_force_down": strokes.normal_down if strokes else math.nan,
                }
            )
    units = dict.fromkeys(rows[0], "1") | {
        **dict.fromkeys(("mode", "edge", "clamp", "works"), ""),
        **dict.fromkeys(("base", "hold"), "T"),
        **dict.fromkeys(("velocity_30_hz", "velocity_100_hz"), "m/s"),
        **dict.fromkeys(("still_tilt", "mean_tilt"), "rad"),
    }
    return Table({name: [row[name] for row in rows] for name in rows[0]}, units)
