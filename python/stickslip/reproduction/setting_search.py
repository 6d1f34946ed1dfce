"""The pair of settings for which the most of the paper's statements hold, searched continuously.

The study's grid fixes what no sawtooth needs: a sudden edge of no duration, one ramp, and the
damping that the paper's authors "adjusted to match". Here all of these are free as well.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from stickslip._util.numbers import worker_count
from stickslip.design.design_space import DesignSpace
from stickslip.design.search import Key, search
from stickslip.reproduction.criteria import MOTION, NAMES, WORST, all_margins
from stickslip.reproduction.points import Array
from stickslip.reproduction.settings import (
    AXES,
    MODES,
    WORDS,
    Grid,
    Mode,
    Setting,
    pair_of,
    values_of,
)
from stickslip.reproduction.statements import NO_PAIR
from stickslip.reproduction.survey import Behaviour, Flags, all_pairs, paired, survey, working_pairs
from stickslip.reproduction.tables import table
from stickslip.scenario.keys import check_whole
from stickslip.scenario.scenario import Scenario

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


class StatementScore(NamedTuple):
    """One statement among all pairs for which S1 to S4 hold."""

    name: str
    pairs: int  # for which it holds
    margin: float  # the greatest; below zero where it never holds
    most: int  # statements that hold together with it, itself included; 0 where it never holds


class Conflict(NamedTuple):
    """Two statements that hold with S1 to S4, but not both."""

    first: str
    second: str
    first_margin: float  # the greatest of the first where the second holds
    second_margin: float  # and the other way round


class Evidence(NamedTuple):
    """What all pairs say that were simulated and keep S1 to S4."""

    kept: int  # such pairs
    most: int  # statements that hold together
    failing: Mapping[tuple[str, ...], int]  # what fails where the most hold, and for how many pairs
    scores: list[StatementScore]
    conflicts: list[Conflict]


@dataclass(frozen=True, eq=False)
class SettingSearch:
    """What the search found.

    Attributes
    ----------
    best : dict of Setting
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

    best: dict[Mode, Setting]
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
            **said._asdict(),
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
    then ``stickslip.design.search``. Pairs are compared by how far they are from S1 to S4, then by
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
    first = survey(
        (grid or Grid()).settings(),
        _VARIATIONS,
        threads,
        lambda done, _: report(_GRID * done, "grid"),
    )
    of_grid = all_pairs(first)
    works, margins = working_pairs(of_grid), all_margins(of_grid)
    starts = _starts(of_grid, margins, works)
    arms = tuple({word: start[word] for word in WORDS} for start in starts)
    space = DesignSpace(Scenario(), AXES, arms, None)
    points = [
        np.array([axis.coordinate(float(start[axis.name])) for axis in AXES]) for start in starts
    ]
    trials = _Trials(space, threads, report, pairs)
    found = search(points, trials.compared, pairs, seed, _STEP)
    best = found.leaders[0]
    tried = trials.table()
    grid_margins = margins[:, works].T
    walking = tried.loc[tried["works"], list(NAMES)].to_numpy()
    return SettingSearch(
        best=pair_of(space.values(best.arm, best.point)),
        margins=dict(zip(NAMES, best.known.tolist(), strict=True)),
        grid_most=evidence(grid_margins).most,
        evidence=evidence(np.concatenate([grid_margins, walking])),
        points=tried,
        tried=found.count,
        seed=seed,
        interrupted=found.interrupted,
    )


def evidence(margins: Array) -> Evidence:
    """From the margins of all statements, shape (pairs, 14)."""
    kept = margins[(margins[:, :MOTION] >= 0.0).all(axis=1)]
    holds = kept >= 0.0
    counts = holds.sum(axis=1)
    most = int(counts.max(initial=0))
    failing = Counter(tuple(itertools.compress(NAMES, ~row)) for row in holds[counts == most])
    trends = range(MOTION, len(NAMES))
    scores = [
        StatementScore(
            NAMES[k],
            int(holds[:, k].sum()),
            float(kept[:, k].max(initial=-np.inf)),
            int(counts[holds[:, k]].max(initial=0)),
        )
        for k in trends
    ]
    conflicts = [
        Conflict(
            NAMES[a], NAMES[b], float(kept[holds[:, b], a].max()), float(kept[holds[:, a], b].max())
        )
        for a, b in itertools.combinations(trends, 2)
        if holds[:, a].any() and holds[:, b].any() and not (holds[:, a] & holds[:, b]).any()
    ]
    return Evidence(len(kept), most, failing, scores, conflicts)


def _key(margins: Array, shortfall: float) -> Key:
    """By what lacks to walk, to S1 to S4, and to the others: how many fail, then by how much.

    Of those that fail the nearest counts first: it is the next that could hold.
    """
    lacking = np.maximum(-margins, 0.0)
    # Each adds less than one, so that a margin that is far off does not hide the others.
    depth = lacking / (1.0 + lacking)
    failing = depth[MOTION:][margins[MOTION:] < 0.0]
    nearest = float(failing.min(initial=1.0))
    motion, trends = float(depth[:MOTION].sum()), float(failing.sum())
    return shortfall, motion, float(len(failing)), nearest, trends


def _starts(pairs: Behaviour, margins: Array, works: Flags) -> list[dict[str, Any]]:
    """Values of the best pair in the grid for each combination of words, the best first."""
    starts: dict[tuple[tuple[str, str], ...], dict[str, Any]] = {}
    keys = {(i, j): _key(margins[:, i, j], 0.0) for i, j in np.argwhere(works).tolist()}
    for i, j in sorted(keys, key=lambda pair: keys[pair]):
        pair = pairs.settings[:, i, j].tolist()
        words = tuple((each.edge, each.clamp) for each in pair)
        if words not in starts:
            starts[words] = values_of(pair)
    if not starts:
        raise ValueError(NO_PAIR)
    return list(starts.values())[:_ARMS]


class _Trials:
    """Pairs that the search tries, and their margins."""

    def __init__(self, space: DesignSpace, threads: int, report: Progress, pairs: int) -> None:
        self._rows: list[dict[str, Any]] = []
        self._space, self._threads, self._report, self._most = space, threads, report, pairs

    def compared(self, candidates: Sequence[tuple[int, Array]]) -> list[tuple[Key, Array]]:
        """As `search` wants them, with the margins of all statements."""
        rows = [self._space.values(arm, point) for arm, point in candidates]
        pairs = [pair_of(row) for row in rows]

        def report(part: float, _: str) -> None:
            fraction = min((len(self._rows) + part * len(rows)) / self._most, 1.0)
            self._report(_GRID + (1.0 - _GRID) * fraction, "searching")

        settings = {mode: [pair[mode] for pair in pairs] for mode in MODES}
        found = survey(settings, _VARIATIONS, self._threads, report)
        tried = paired(found["IPP"], found["OPP"])
        margins = all_margins(tried).T
        works = working_pairs(tried)
        short = -np.nan_to_num(tried.works_margin, nan=WORST)
        shortfall = np.where(works, 0.0, 1.0 + np.maximum(short, 0.0).sum(axis=0)).tolist()
        for row, does, own in zip(rows, works.tolist(), margins.tolist(), strict=True):
            self._rows.append({**row, "works": does, **dict(zip(NAMES, own, strict=True))})
        return [(_key(*each), each[0]) for each in zip(margins, shortfall, strict=True)]

    def table(self) -> pd.DataFrame:
        """A row for each pair."""
        units = {axis.name: axis.unit for axis in AXES} | dict.fromkeys(NAMES, "1")
        columns = (*WORDS, *(axis.name for axis in AXES), "works", *NAMES)
        frame = pd.DataFrame(self._rows, columns=columns)
        return table(frame, dict.fromkeys(columns, "") | units)
