"""The pair of settings for which the most of the paper's statements hold, searched continuously.

The study's grid fixes what no sawtooth needs: a sudden edge of no duration, one ramp, and the
damping that the paper's authors "adjusted to match". Here all of these are free as well.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from stickslip._util.processor_count import worker_count
from stickslip.control.search import Key, search
from stickslip.reproduction.free_settings import (
    AXES,
    OWN,
    SHARED,
    WORDS,
    Array,
    Pair,
    Words,
    pair_at,
    point_of,
    words_of,
)
from stickslip.reproduction.reference import MOTION
from stickslip.reproduction.setting_evidence import NAMES, Evidence, evidence
from stickslip.reproduction.settings import MODES, Grid
from stickslip.reproduction.statements import CRITERIA
from stickslip.reproduction.survey import Flags, Survey, survey
from stickslip.reproduction.tables import table
from stickslip.scenario.keys import check_whole

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

PAIRS = 2400
"""Pairs that a search tries if no other number is given. Chosen: some six minutes on two
processors."""

POINTS = "search.csv"
"""The file of all pairs that were searched."""

_ARMS = 4  # combinations of words that are searched: those of the best pairs of the grid. Chosen
_VARIATIONS = 3  # small changes of each point, as the study has
_GRID = 0.1  # part of the time that the grid takes, roughly
_STEP = 0.1  # of the first generation; chosen: S1 to S4 hold in a small part of the ranges only
_WORST = -1e3  # in place of a margin that cannot be computed


@dataclass(frozen=True, eq=False)
class SettingSearch:
    """What the search found.

    Attributes
    ----------
    best : dict of FreeSetting
        The best pair, by mode.
    margins : dict of float
        Of each statement at it; below zero where it does not hold.
    grid_most : int
        Most statements that hold together with S1 to S4 in the grid.
    evidence : Evidence
        Of all pairs that walk, those of the grid included.
    points : pandas.DataFrame
        Every pair that was searched: words, numbers, and the margin of each statement.
    tried, seed : int
        Pairs in the search, and the seed of its draws.
    interrupted : bool
        Whether Ctrl-C ended it.
    """

    best: Pair
    margins: dict[str, float]
    grid_most: int
    evidence: Evidence
    points: pd.DataFrame
    tried: int
    seed: int
    interrupted: bool

    @property
    def holding(self) -> list[str]:
        """Statements that hold for the best pair."""
        return [name for name, margin in self.margins.items() if margin >= 0.0]

    def summary(self) -> str:
        """The best pair, and what speaks against a better one, in some lines."""
        said = self.evidence
        lines = [f"{mode}  {setting.text()}" for mode, setting in self.best.items()]
        lines += [
            "",
            f"{len(self.holding)} of {len(NAMES)} hold; in the grid at most {self.grid_most} with "
            f"S1 to S{MOTION}",
            "  " + ", ".join(f"{name} {margin:+.3f}" for name, margin in self.margins.items()),
            "",
            f"{said.kept} pairs keep S1 to S{MOTION}. Where the most statements hold, {said.most}, "
            "there fail:",
            *(f"  {', '.join(names)}: {count} pair(s)" for names, count in said.failing.items()),
            "",
            "with S1 to S4  pairs  best margin  most that hold with it",
            *(
                f"  {each.name:<13}{each.pairs:>5}  {each.margin:>+11.3f}  {each.most or 'never'}"
                for each in said.scores
            ),
            "",
            "never both with S1 to S4, with the best margin of each where the other holds:",
            *(
                f"  {each.first} {each.first_margin:+.3f}, {each.second} {each.second_margin:+.3f}"
                for each in said.conflicts
            ),
        ]
        return "\n".join(lines if said.conflicts else [*lines[:-1], "no two exclude each other"])

    def as_dict(self) -> dict[str, Any]:
        """The result without the points, of plain types."""
        said = self.evidence
        return {
            "best": {mode: setting.keys() for mode, setting in self.best.items()},
            "holding": self.holding,
            "margins": self.margins,
            "grid_most": self.grid_most,
            "kept": said.kept,
            "most": said.most,
            "failing": [{"statements": [*names], "pairs": n} for names, n in said.failing.items()],
            "scores": [each._asdict() for each in said.scores],
            "conflicts": [each._asdict() for each in said.conflicts],
            "tried": self.tried,
            "seed": self.seed,
            "interrupted": self.interrupted,
        }


def search_settings(
    pairs: int = PAIRS,
    *,
    grid: Grid | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> SettingSearch:
    """Look for the pair of settings that satisfies most of S5 to S14 with S1 to S4 kept.

    First the grid, whose best pairs are the starts, one for each combination of edges and clamps;
    then ``stickslip.control.search``. Pairs are compared by how far they are from S1 to S4, then by
    how many of S5 to S14 fail, then by how far the nearest of those is from holding. A pair in
    which a mode does not walk comes last.

    Parameters
    ----------
    pairs : int
        Pairs of settings that the search tries, beside the grid.
    grid : Grid, optional
    seed : int
    threads, progress
        As for `reproduce`.

    Returns
    -------
    SettingSearch
        Also after Ctrl-C in the search.
    """
    check_whole("pairs", pairs, 1)
    check_whole("seed", seed)
    threads = worker_count(threads, "threads")
    report = progress or (lambda fraction, stage: None)
    of_grid = grid or Grid()
    first = survey(
        {mode: of_grid.settings(mode) for mode in MODES},
        _VARIATIONS,
        threads,
        lambda done, _: report(_GRID * done, "grid"),
    )
    margins, works = _margins(first)
    starts = _starts(first, margins, works)
    trials = _Trials(list(starts), threads, report, pairs)
    found = search(list(starts.values()), trials.compared, pairs, seed, _STEP)
    best = found.leaders[0]
    searched = np.array(trials.margins)
    of_the_grid = margins[:, works].T
    return SettingSearch(
        best=pair_at(list(starts)[best.arm], best.point),
        margins=dict(zip(NAMES, map(float, best.known), strict=True)),
        grid_most=evidence(of_the_grid).most,
        evidence=evidence(np.concatenate([of_the_grid, searched[np.array(trials.works)]])),
        points=trials.table(),
        tried=found.count,
        seed=seed,
        interrupted=found.interrupted,
    )


def _margins(found: Survey) -> tuple[Array, Flags]:
    """Margins of all statements, shape (14, settings of IPP, of OPP), and which pairs work."""
    works = found.working_pairs()
    margins = [np.broadcast_to(each.evaluate(found).margin, works.shape) for each in CRITERIA]
    return np.maximum(np.nan_to_num(margins, nan=_WORST), _WORST), works


def _key(margins: Array, shortfall: float) -> Key:
    """By what lacks to walk, to S1 to S4, and to the others: how many fail, then by how much.

    Of those that fail the nearest counts first: it is the next that could hold.
    """
    lacking = np.maximum(-margins, 0.0)
    # Each adds less than one, so that a margin that is far off does not hide the others.
    depth = lacking / (1.0 + lacking)
    failing = depth[MOTION:][margins[MOTION:] < 0.0]
    nearest = float(failing.min(initial=1.0))
    return (
        shortfall,
        float(depth[:MOTION].sum()),
        float(len(failing)),
        nearest,
        float(failing.sum()),
    )


def _starts(found: Survey, margins: Array, works: Flags) -> dict[Words, Array]:
    """By the words of a pair the numbers of its best pair in the grid, the best words first."""
    best: dict[Words, tuple[Key, Array]] = {}
    for i, j in np.argwhere(works):
        pair = (found.settings["IPP"][i], found.settings["OPP"][j])
        words, key = words_of(pair), _key(margins[:, i, j], 0.0)
        if words not in best or key < best[words][0]:
            best[words] = (key, point_of(pair))
    if not best:
        raise ValueError("no setting of the grid walks forwards in both modes")
    chosen = sorted(best, key=lambda words: best[words][0])[:_ARMS]
    return {words: best[words][1] for words in chosen}


class _Trials:
    """Pairs that the search tries, and their margins."""

    def __init__(self, words: Sequence[Words], threads: int, report: Progress, pairs: int) -> None:
        self.margins: list[Array] = []
        self.works: list[bool] = []
        self._pairs: list[Pair] = []
        self._words, self._threads, self._report, self._most = words, threads, report, pairs

    def compared(self, candidates: Sequence[tuple[int, Array]]) -> list[tuple[Key, Array]]:
        """As `search` wants them, with the margins of all statements."""
        pairs = [pair_at(self._words[arm], point) for arm, point in candidates]
        done, share = len(self.margins), len(pairs)

        def report(part: float, _: str) -> None:
            fraction = min((done + part * share) / self._most, 1.0)
            self._report(_GRID + (1.0 - _GRID) * fraction, "searching")

        settings = {mode: [pair[mode] for pair in pairs] for mode in MODES}
        found = survey(settings, _VARIATIONS, self._threads, report)
        margins, works = _margins(found)
        lacking = np.sum(
            [
                np.maximum(-np.nan_to_num(found.works_margin(mode), nan=_WORST), 0.0)
                for mode in MODES
            ],
            axis=0,
        )
        result = []
        for place in range(len(pairs)):
            own = margins[:, place, place]
            does = bool(works[place, place])
            self.margins.append(own)
            self.works.append(does)
            result.append((_key(own, 0.0 if does else 1.0 + float(lacking[place])), own))
        self._pairs += pairs
        return result

    def table(self) -> pd.DataFrame:
        """A row for each pair."""
        columns: dict[str, Any] = {}
        units = {axis.name: axis.unit for axis in AXES}
        for mode, word in itertools.product(MODES, WORDS):
            columns[f"{mode} {word}"] = [getattr(pair[mode], word) for pair in self._pairs]
        for mode, name in itertools.product(MODES, OWN):
            columns[f"{mode} {name}"] = [getattr(pair[mode], name) for pair in self._pairs]
        for name in SHARED:
            columns[name] = [getattr(pair["IPP"], name) for pair in self._pairs]
        columns["works"] = self.works
        for place, name in enumerate(NAMES):
            columns[name] = [float(each[place]) for each in self.margins]
        return table(columns, {**dict.fromkeys(columns, ""), **units, **dict.fromkeys(NAMES, "1")})
