"""What the survey says beyond single statements, in sentences and in a table of settings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from stickslip.reproduction.criteria import Outcome
from stickslip.reproduction.reference import MOTION, count_of
from stickslip.reproduction.settings import FACTORS, MODES
from stickslip.reproduction.survey import WORKING_FREQUENCIES, Survey, pairwise
from stickslip.reproduction.tables import table

_UNITS = {
    "mode": "", "edge": "", "clamp": "", "base": "T", "hold": "T", "works": "",
    "velocity_30_hz": "m/s", "velocity_100_hz": "m/s", "still_tilt": "rad", "mean_tilt": "rad",
    "slip_share_up": "1", "normal_force_up": "1", "normal_force_down": "1",
}  # fmt: skip
"""Columns of the table of settings. Normal forces are over that at rest, as in `Strokes`."""


def findings(found: Survey, outcomes: Mapping[str, Outcome]) -> list[str]:
    """Sentences on how many settings work, and on what those have in common that match best."""
    works = found.working_pairs()
    holds = [outcome.holds for outcome in outcomes.values()]
    counts = count_of(holds, works)
    all_four = works & (count_of(holds[:MOTION], works) == MOTION)
    most = int(counts[works].max()) if works.any() else 0
    best = int((works & (counts == most)).sum())
    clamps = [
        pairwise(mode, np.array([each.clamp for each in found.settings[mode]])) for mode in MODES
    ]
    same_clamp = int((all_four & (clamps[0] == clamps[1])).sum())
    return [
        *(
            f"{int(found.works(mode).sum())} of {len(found.settings[mode])} settings of {mode} "
            "work: the robot walks forwards at 30 Hz and at 100 Hz, with its tilt between flat and "
            "upright."
            for mode in MODES
        ),
        f"Of the {int(works.sum())} pairs of working settings, {int(all_four.sum())} have S1 to S4 "
        f"all hold; {same_clamp} of these have the same clamp polarity in both modes.",
        f"No pair has more than {most} of the {len(outcomes)} statements that depend on settings; "
        f"{best} {'has' if best == 1 else 'have'} as many.",
    ]


def settings_table(found: Survey) -> pd.DataFrame:
    """A row for every setting of the grid: what it is, and what it does."""
    rows: list[list[Any]] = []
    for mode in MODES:
        works = found.works(mode).tolist()
        velocity = found.at(mode, "frequency", WORKING_FREQUENCIES).tolist()
        tilt = found.still_tilt[mode].tolist()
        for k, setting in enumerate(found.settings[mode]):
            strokes = found.strokes[mode][k]
            by_stroke = [math.nan] * 4
            if strokes:
                by_stroke = [strokes.tilt, strokes.share_up, strokes.normal_up, strokes.normal_down]
            what = [getattr(setting, factor) for factor in FACTORS]
            rows.append([mode, *what, works[k], *velocity[k], tilt[k], *by_stroke])
    return table(dict(zip(_UNITS, zip(*rows, strict=True), strict=True)), _UNITS)
