"""First measurements, before there are data: the drives that tell most causes apart."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask, worker_count
from stickslip._util.files import text_writer, write_together
from stickslip._util.messages import check_kind, check_whole, refuse
from stickslip._util.text import is_number
from stickslip.diagnosis.decision.experiments import DECISIVE, TRIALS
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.terms.words import Words
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.walker.experiments import CHOICES, Drive, advice, proposals
from stickslip.walker.problem import posed_by
from stickslip.walker.reading import Measurement
from stickslip.walker.velocity import VelocityTable, settings_of

if TYPE_CHECKING:
    from pandas import DataFrame

FILES = "measurement.toml", "scenario.toml", "velocity.csv", "protocol.md"
"""Files of `Plan.save`."""

NOISE = 0.05
"""Relative standard deviation of one trial if nothing is said; as in the measured tables."""

_PULSES = 12  # of a prediction at most; chosen: the mean of nine
_FLOOR = 0.5  # of the median speed, below which the noise falls no more; chosen: a slow robot too
_ROUGH, _DRAWS = (
    0.1,
    12,
)  # errors of the constants, and draws, that show how rough a drive is; chosen
_OFF = 3.0  # stated errors by which a constant is off as a cause; chosen: it surprises
# Factors that are tried of a change that cannot be simulated. Chosen: the largest first.
_OTHERS = -1.0, 0.5, -0.5, 0.25, -0.25
_LOST = 0.5  # share of the drives; a change that loses more of them is not used; chosen
_PASSES = 3  # of exchanging one drive for a better one; chosen: the second changes little


@dataclass(frozen=True, repr=False)
class Plan:
    """Drives to measure, and which causes they would tell apart.

    Attributes
    ----------
    scenario : Scenario
    drives : list of dict
        Settings of ``[drive]`` by dotted key.
    expected : ndarray, shape (drives,)
        Velocity of the scenario as it is stated, m/s.
    noise : float
        Relative standard deviation of one trial.
    trials, seed : int
        Trials of each drive, one in each block, and seed of their order.
    causes : list of str
    left_out : list of str
        Causes that cannot be simulated at their usual sizes, nor at a quarter of them.
    seen : ndarray of bool, shape (causes,)
        Whether a cause of its usual size would be told from none.
    apart : ndarray of bool, shape (causes, causes)
        Whether two would be told from each other, whatever their sizes.
    words : dict
        How each cause is said.
    """

    scenario: Scenario
    drives: list[Drive]
    expected: Array
    noise: float
    trials: int
    seed: int
    causes: list[str]
    left_out: list[str]
    seen: Mask
    apart: Mask
    words: Mapping[str, str]

    @property
    def alike(self) -> list[tuple[str, str]]:
        """Pairs of causes that would be seen, but not told from each other."""
        pairs = itertools.combinations(np.flatnonzero(self.seen).tolist(), 2)
        return [(self.causes[i], self.causes[j]) for i, j in pairs if not self.apart[i, j]]

    def table(self) -> DataFrame:
        """A row for each trial, in the order in which they are to be measured; `velocity` is empty.

        Each block has every drive once, in an order of its own.
        """
        import pandas as pd

        random, names = np.random.default_rng(self.seed), [key.partition(".")[2] for key in CHOICES]
        rows: list[dict[str, Any]] = []
        for block in range(1, self.trials + 1):
            for at in random.permutation(len(self.drives)):
                settings = {name: self.drives[at][f"drive.{name}"] for name in names}
                labels = {"trial": block, "block": f"block-{block}", "order": len(rows) + 1}
                rows.append({**settings, **labels, "velocity": np.nan})
        return pd.DataFrame(rows)

    def protocol(self) -> str:
        """The plan on a page."""
        words = settings_of(self.drives).words
        seen = [self.words[name] for name, can in zip(self.causes, self.seen, strict=True) if can]
        unseen = [self.words[name] for name in self.causes if self.words[name] not in seen]
        alike = [f"- {self.words[one]} and {self.words[other]}" for one, other in self.alike]
        pairs = [advice({name: self.words[name] for name in pair}, []) for pair in self.alike]
        beside = [f"- {note}" for note in dict.fromkeys(itertools.chain(*pairs))]
        trial = f"{100.0 * self.noise:g} % for one trial"
        lines = [
            "# What to measure",
            "",
            f"{len(self.drives)} drives, each once in each of {self.trials} blocks.",
            "",
            "1. Before a block: put the robot down anew, and do to the surface what you always do.",
            "2. Go through the rows of `velocity.csv` by `order`. What a row does not say is as in "
            "`scenario.toml`.",
            f"3. Let the robot walk for {self.scenario.drive.pulses} pulses. Measure x from the "
            "end of the third to the end of the last, and write the velocity in m/s, with its "
            "sign, +x of the world positive, into `velocity`.",
            "4. What went wrong stays empty. Do not drop what only looks wrong.",
            "5. `stickslip diagnose measurement.toml --next 3`",
            "",
            f"| | drive | the stated model, with {trial} (mm/s) |",
            "| --- | --- | --- |",
            *(
                f"| {k} | {drive} | {1e3 * v:+.2f} |"
                for k, (drive, v) in enumerate(zip(words, self.expected, strict=True), start=1)
            ),
            "",
            "## What it would tell",
            "",
            f"At their usual sizes these would be seen ({len(seen)} of {len(self.causes)}): "
            f"{', '.join(seen) or 'none'}.",
        ]
        if unseen:
            lines += ["", f"Too small to be seen, or without effect: {', '.join(unseen)}."]
        if self.left_out:
            lost = ", ".join(self.words[name] for name in self.left_out)
            lines += ["", f"Left out, as a quarter of the usual size cannot be simulated: {lost}."]
        if alike:
            lines += ["", "Not told from each other:", "", *alike]
        if beside:
            lines += ["", "Beside the drive:", "", *beside]
        return "\n".join([*lines, ""])

    def save(self, folder: Path) -> None:
        """Write measurement, scenario, table and protocol, and the coils' map if there is one."""
        folder.mkdir(parents=True, exist_ok=True)
        self.scenario.to_toml(folder / FILES[1])
        texts = {
            FILES[0]: 'stickslip_measurement = 1\nscenario = "scenario.toml"\n\n[[velocity]]\n'
            'file = "velocity.csv"\n',
            FILES[2]: self.table().to_csv(index=False),
            FILES[3]: self.protocol(),
        }
        write_together({folder / name: text_writer(text) for name, text in texts.items()})


def plan(
    scenario: Scenario,
    count: int = 12,
    *,
    noise: float = NOISE,
    trials: int = TRIALS,
    seed: int = 0,
    threads: int | None = None,
) -> Plan:
    """The drives that tell most causes apart, to first order in what is uncertain.

    Of a proposal and a cause of its usual size the change of the velocity is simulated. Two causes
    are told apart if no size of the one makes the changes of the other, within noise and the
    scenario's uncertain parameters: two standard errors. Drives are added one by one, each where it
    tells most pairs apart, and then exchanged while that is better.

    Parameters
    ----------
    scenario : Scenario
        The robot as it is believed, a drive near which it can be driven, and what is uncertain.
    count : int
        Drives, from 2.
    noise : float
        Relative standard deviation of one trial.
    trials, seed : int
        Of each drive; of the order in which they are measured.
    threads : int, optional
        Simulations at a time.

    Raises
    ------
    ScenarioError
        If an argument is not allowed, the scenario has a program of voltages or no walk along x, or
        there are fewer proposals.
    """
    check_kind("scenario", scenario, Scenario)
    check_whole("count", count, 2)
    check_whole("trials", trials, 1)
    check_whole("seed", seed)
    if not (is_number(noise) and 0.0 < noise < 1.0):
        refuse("noise", noise, "a number above 0 and below 1")
    if scenario.drive.kind != "sawtooth":
        allowed = "IPP and OPP, whose settings vary"
        raise ScenarioError(f'drive.mode = "{scenario.drive.mode}": allowed are {allowed}')
    problem, table, base = _posed(scenario, noise, worker_count(threads, "threads"))
    drives = [base, *proposals([base])]
    if count > len(drives):
        raise ScenarioError(f"count = {count}: allowed are at most {len(drives)} drives")
    level, slopes, gaps, rough = _predicted(problem, table, drives)
    known: Mask = np.any(np.isfinite(gaps), axis=1)
    causes, gaps = [*itertools.compress(problem.causes, known)], gaps[known]
    sound = np.flatnonzero(np.isfinite(np.vstack([level, slopes, gaps, rough])).all(axis=0))
    speed = np.abs(level)
    if not np.nanmax(speed) > 0.0:
        raise ScenarioError("the stated scenario does not move at any proposed drive")
    if count > len(sound):
        raise ScenarioError(
            f"count = {count}: allowed are at most {len(sound)} drives; at the other "
            f"{len(drives) - len(sound)} the scenario cannot be simulated with all its causes"
        )
    floor = _FLOOR * float(np.median(speed[sound]))
    variance = (noise * np.maximum(speed, floor)) ** 2 / trials + rough**2
    chosen = _chosen(slopes, gaps, variance, sound.tolist(), count)
    apart, seen = _distances(*(array[..., chosen] for array in (slopes, gaps, variance)))
    names, words = [cause.name for cause in causes], Words(problem.words, problem.causes)
    left_out = [cause.name for cause in itertools.compress(problem.causes, ~known)]
    return Plan(
        scenario, [drives[k] for k in chosen], level[chosen], noise, trials, seed, names, left_out,
        seen > DECISIVE, apart > DECISIVE, {name: words.title(name) for name in names + left_out},
    )  # fmt: skip


def _posed(
    scenario: Scenario, noise: float, threads: int
) -> tuple[Problem, VelocityTable, dict[str, Any]]:
    """The problem that measured velocities of this scenario pose, and its drive."""
    import pandas as pd

    drive = scenario.drive
    short = scenario.replace({"drive.pulses": min(drive.pulses, _PULSES)})
    frequencies = [0.5 * drive.frequency, drive.frequency, 1.5 * drive.frequency]
    rows = {"frequency": frequencies, "velocity": [1e-3] * 3}  # of which nothing is used
    data = Measurement.from_dataframe(pd.DataFrame(rows), short, velocity_sd=noise)
    problem = posed_by(data, threads)
    table = problem.tables[0]
    assert isinstance(table, VelocityTable)
    at = [condition["drive.frequency"] for condition in table.conditions]
    if drive.frequency not in at:
        raise ScenarioError("the scenario's own drive cannot be simulated")
    return problem, table, dict(table.conditions[at.index(drive.frequency)])


def _predicted(
    problem: Problem, table: VelocityTable, drives: Sequence[Drive]
) -> tuple[Array, Array, Array, Array]:
    """Velocities as stated, changes by one error of each constant and by each cause, roughness.

    Shapes (drives,), (constants, drives), (causes, drives) and (drives,), m/s; NaN where there is
    none, and of a cause that cannot be. The roughness is how far velocities are from a plane, for
    one error of the constants.
    """
    constants = len(problem.constants)
    points, velocities = _possible(problem, table, drives, _changes(problem))
    ends = slice(1, 1 + 2 * constants)
    steps = np.sum(points[ends][1::2] - points[ends][::2], axis=1)
    for constant, step in zip(problem.constants, steps.tolist(), strict=True):
        if step == 0.0:
            raise ScenarioError(
                f"{constant.name}: an eighth of its stated error either way cannot be simulated: "
                "allowed is a smaller one"
            )
    slopes = (velocities[ends][1::2] - velocities[ends][::2]) / steps[:, None]
    gaps = velocities[1 + 2 * constants : -_DRAWS] - velocities[0]
    missed = velocities[-_DRAWS:] - velocities[0] - points[-_DRAWS:, :constants] @ slopes
    missed = missed[np.isfinite(missed).any(axis=1)]
    return velocities[0], slopes, gaps, np.sqrt(np.mean(missed**2, axis=0)) / _ROUGH


def _changes(problem: Problem) -> Array:
    """Coordinates as stated, of two ends of each constant, of each cause, and of draws."""
    constants = [constant.name for constant in problem.constants]
    low, high = problem.limits
    random = np.random.default_rng(0)
    points = np.zeros((1 + 2 * len(constants) + len(problem.causes) + _DRAWS, problem.size))
    points[-_DRAWS:, : len(constants)] = _ROUGH * random.standard_normal((_DRAWS, len(constants)))
    for k in range(len(constants)):
        points[1 + 2 * k, k], points[2 + 2 * k, k] = -0.5, 0.5
    for at, cause in enumerate(problem.causes, start=1 + 2 * len(constants)):
        if cause.frees is not None:
            points[at, constants.index(cause.frees)] = _OFF
        for k in problem.columns([cause]).tolist():
            if problem.parameters[k].is_amplitude:
                points[at, k] = 1.0 if high[k] > 0.0 else max(-1.0, low[k])
    return points


def _possible(
    problem: Problem, table: VelocityTable, drives: Sequence[Drive], changes: Array
) -> tuple[Array, Array]:
    """Changes, smaller or reversed where they cannot be, and their velocities, (changes, drives).

    An end that cannot be is where the scenario is; velocities of what else cannot be are NaN.
    """
    names = problem.names
    columns, table = table.own_columns(names), table.at_drives(drives)

    def made(points: Array) -> Array:
        values = problem.physical(points)[:, columns]
        return table.predict([names[k] for k in columns], values)

    points, velocities = changes.copy(), made(changes)
    if not np.isfinite(velocities[0]).any():
        raise ScenarioError("the stated scenario cannot be simulated at any proposed drive")

    is_end = np.isin(np.arange(len(points)), np.arange(1, 1 + 2 * len(problem.constants)))
    for factor in _OTHERS:
        rows = _lost(velocities)
        factors = np.where(is_end[rows], abs(factor), factor)[:, None]
        moved = np.clip(factors * changes[rows], *problem.limits)
        new = moved.any(axis=1) & np.any(moved != points[rows], axis=1)
        rows, moved = rows[new], moved[new]
        if len(rows):
            points[rows], velocities[rows] = moved, made(moved)
    velocities[_lost(velocities)] = np.nan
    ends = np.flatnonzero(is_end & np.isnan(velocities).all(axis=1))
    points[ends], velocities[ends] = 0.0, velocities[0]
    return points, velocities


def _lost(velocities: Array) -> Indices:
    """Rows with which too many drives cannot be simulated that the first row can."""
    sound = np.isfinite(velocities[:, np.isfinite(velocities[0])])
    return np.flatnonzero(sound.mean(axis=1) < 1.0 - _LOST)


def _distances(slopes: Array, gaps: Array, variance: Array) -> tuple[Array, Array]:
    """Squared standard errors between any two causes, and of each from none.

    The other cause has the size that is nearest, and the constants move within their priors.
    """
    errors = slopes.T @ slopes + np.diag(variance)
    inner = gaps @ np.linalg.solve(errors, gaps.T)
    alone = np.maximum(np.diag(inner), 1e-300)
    left = alone[:, None] - inner**2 / alone
    return np.minimum(left, left.T), alone


def _chosen(
    slopes: Array, gaps: Array, variance: Array, sound: Sequence[int], count: int
) -> list[int]:
    """Drives that tell most pairs apart, and of equally many those that do so best."""
    pairs = np.triu_indices(len(gaps), 1)

    def worth(rows: list[int]) -> float:
        apart, seen = _distances(slopes[:, rows], gaps[:, rows], variance[rows])
        chi2 = np.concatenate([seen, apart[pairs]])
        return float(np.sum(chi2 > DECISIVE) + np.mean(np.minimum(chi2 / DECISIVE, 1.0)))

    chosen: list[int] = []
    while len(chosen) < min(count, len(sound)):
        chosen.append(max((k for k in sound if k not in chosen), key=lambda k: worth([*chosen, k])))
    for _ in range(_PASSES):
        before = worth(chosen)
        for k in range(len(chosen)):
            others = chosen[:k] + chosen[k + 1 :]
            best = max((k for k in sound if k not in others), key=lambda k: worth([*others, k]))
            if worth([*others, best]) > worth(chosen):
                chosen = [*others, best]
        if worth(chosen) <= before:
            break
    return chosen
