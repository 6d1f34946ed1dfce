"""A measurement as a problem: its tables, its uncertain constants, and what may be wrong."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip._util.toml import own_text
from stickslip.diagnosis.change import SIDES, posed_change
from stickslip.diagnosis.decision.experiments import TRIALS, Experiment
from stickslip.diagnosis.fitting.problem import Cached, Problem
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.model import posed
from stickslip.diagnosis.report.files import FILES
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.laws import Curves
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.words import Vocabulary
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import is_of_one_coil, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import files_of, scenario_writers
from stickslip.scenario.uncertain import JointPrior, refuse_geometry_beside_a_map
from stickslip.simulation.notes import peak_voltages
from stickslip.walker.angle import AngleTable
from stickslip.walker.drives import choose, proposals
from stickslip.walker.field import FieldTable
from stickslip.walker.film import FilmTable
from stickslip.walker.laws import find_spans, fixed_numbers, laws
from stickslip.walker.library import known, library
from stickslip.walker.reading import Measurement
from stickslip.walker.simulated import SimulatedTable
from stickslip.walker.velocity import VelocityTable, drive_settings

if TYPE_CHECKING:
    from pandas import DataFrame

EXTENDED = "extended.toml"
"""The file that states the extended scenario."""


def tables_of(measurement: Measurement, threads: int, seed: int) -> list[SimulatedTable]:
    """All tables of a measurement: velocities, films, angles, fields.

    A ScenarioError is raised if nothing was measured that the diagnosis can use.
    """
    tables: list[SimulatedTable] = []
    if any(len(data.velocity) for data in measurement.velocity):
        tables.append(VelocityTable(measurement, threads=threads, seed=seed))
    tables += [
        FilmTable(run, number, threads) for number, run in enumerate(measurement.tracking, start=1)
    ]
    scenario = measurement.scenario
    try:
        for kind, several in ((AngleTable, measurement.angle), (FieldTable, measurement.field)):
            first = 0 if len(several) == 1 else 1  # a single one needs no number
            tables += [kind(table, scenario, k) for k, table in enumerate(several, start=first)]
    except ScenarioError as error:
        raise ScenarioError(f"{measurement.path}: {error}") from None
    if not tables:
        raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")
    return tables


def posed_by(
    measurement: Measurement, threads: int = 1, seed: int = 0, file: str = EXTENDED
) -> Problem:
    """The problem that a measurement poses, in SI units; `file` states its extended scenario.

    A ScenarioError is raised if nothing was measured that the diagnosis can use.
    """
    scenario, keys = measurement.scenario, known_keys()
    if scenario.coil.map is not None:
        refuse_geometry_beside_a_map(measurement.uncertain)
    _refuse_turns(measurement)
    tables = tables_of(measurement, threads, seed)
    constants = [
        Parameter(key, prior, keys[key].unit) for key, prior in measurement.uncertain.items()
    ]
    constants += [parameter for table in tables for parameter in table.nuisance]
    driven = _driven(measurement)
    volts = max(max(peak_voltages(one).values()) for one in driven)
    settled = {*measurement.uncertain}
    if any(one.drive.edge_time != scenario.drive.edge_time for one in driven):
        settled.add("drive.edge_time")
    effects = library(scenario, settled, volts)
    # Tables of one kind share instruments: that of the widest readings stands for all, as a limit
    # may lie anywhere below them.
    every = [instrument for table in tables for instrument in table.instruments]
    every.sort(key=lambda instrument: instrument.parameters[0].high)
    # Each table has its own read them.
    instruments = {one.name: replace(one, read=None, table=None) for one in every}
    simulated = Simulated(tables)
    return posed(
        tables, simulated, constants, (*effects, *instruments.values()),
        low_fidelity=simulated.cheap, laws=partial(_laws, measurement), words=vocabulary(),
        rivals=Drives(measurement, tables, file),
    )  # fmt: skip


def posed_against(
    measurement: Measurement, other: Measurement, threads: int, seed: int
) -> tuple[Problem, list[Problem]]:
    """The problem of what changed since another measurement, and those of both.

    A ScenarioError is raised if they state other constants.
    """
    if measurement.uncertain != other.uncertain:
        raise ScenarioError(
            f"{other.path}: [uncertain]: allowed are the constants and errors of {measurement.path}"
        )
    problems = [posed_by(one, threads, seed, f"{side}.toml")
                for side, one in zip(SIDES, (other, measurement), strict=True)]  # fmt: skip
    alike = measurement.scenario == other.scenario
    change = posed_change(problems, measurement.uncertain, seed, vocabulary(), alike)
    return change, problems


class Simulated:
    """Predictions of tables, each kept by the columns that count for it."""

    jumps = True

    def __init__(self, tables: Sequence[SimulatedTable]) -> None:
        self._tables = tables
        self._kept: dict[tuple[int, tuple[str, ...], bool], Cached] = {}

    def __call__(self, table: SimulatedTable, p: Mapping[str, Array], curves: Curves) -> Array:
        """Readings of all conditions, (vectors, m)."""
        return self._rows(table, p, curves, False)

    def cheap(self, table: SimulatedTable, p: Mapping[str, Array], curves: Curves) -> Array:
        """The same at a lower cost, where the table has a way; else once for both."""
        way = type(table).low_fidelity is not SimulatedTable.low_fidelity
        return self._rows(table, p, curves, way)

    def _rows(
        self, table: SimulatedTable, p: Mapping[str, Array], curves: Curves, cheap: bool
    ) -> Array:
        fixed = fixed_numbers(curves.causes)
        given = [*p, *fixed]
        names = [given[k] for k in table.own_columns(given)]
        vectors = max((len(values) for values in p.values()), default=1)
        columns = [p[name] if name in p else np.full((vectors, 1), fixed[name]) for name in names]
        values = np.hstack(columns) if columns else np.zeros((vectors, 0))
        rows = table.low_fidelity if cheap else table.predict
        place = next((k for k, each in enumerate(self._tables) if each is table), None)
        if place is None:  # of drives that were not measured
            return rows(names, values)
        key = place, tuple(names), cheap
        if key not in self._kept:
            self._kept[key] = Cached(partial(rows, names))
        return self._kept[key](values)


class Drives(Rivals):
    """Drives that were not measured yet, and the scenario of the extended model."""

    proposes = True

    def __init__(
        self, measurement: Measurement, tables: Sequence[SimulatedTable], file: str = EXTENDED
    ) -> None:
        self._measurement, self._tables, self._file = measurement, tables, file

    @property
    def table(self) -> int:
        for k, table in enumerate(self._tables):
            if isinstance(table, VelocityTable):
                return k
        raise ScenarioError(
            "there are no velocities in this measurement; stickslip.predict(result.extended, ...) "
            "predicts those of any drive"
        )

    @property
    def _velocity(self) -> VelocityTable:
        return cast(VelocityTable, self._tables[self.table])

    def conditions(self, given: Any) -> tuple[VelocityTable, dict[str, list[Any]]]:
        scenario = self._measurement.scenario
        drives = drive_settings(given, scenario)
        keys = dict.fromkeys(key for drive in drives for key in drive)
        columns = {key: [row.get(key, scenario.get(key)) for row in drives] for key in keys}
        return self._velocity.at_drives(drives), columns

    def proposals(self) -> VelocityTable | None:
        if not any(len(data.conditions) for data in self._measurement.velocity):
            return None
        return self._velocity.at_drives(proposals(self._velocity.conditions))

    def chosen(
        self, proposals: VelocityTable, names: Sequence[str], predicted: tuple[Array, Array, Array],
        pairs: Sequence[tuple[int, int]], count: int,
    ) -> list[Experiment]:  # fmt: skip
        return choose(proposals.conditions, names, predicted, pairs, count)[0]

    def unvaried(self) -> list[str]:
        drives = [drive for table in self._measurement.velocity for drive in table.conditions]
        keys = ("direction", "frequency", "mode", "peak")
        return [key for key in keys if len({drive[f"drive.{key}"] for drive in drives}) == 1]

    def advice(self, names: Mapping[str, str], experiments: Sequence[Experiment]) -> list[Note]:
        notes = []
        if experiments and not any(experiment.decides for experiment in experiments):
            text = f"No drive that was tried tells the candidates apart with {TRIALS} trials."
            notes.append(Note("none-separates", text))
        rows = known()["causes"]
        shown_by = {name: rows.get(name, {}).get("shown_by") for name in names}
        for look, text in known()["looks"].items():
            seen = [word for name, word in names.items() if shown_by[name] == look]
            if 0 < len(seen) < len(names):
                text = f"{text}. This shows {' and '.join(seen)} alone."
                notes.append(Note(f"look-at-{look}", text))
        return notes

    def extended(self, values: Mapping[str, Any], covariance: DataFrame | None) -> Scenario:
        keys = known_keys()
        changes = {name: value for name, value in values.items() if name in keys}
        try:
            changed = self._measurement.scenario.replace(changes)
            return changed.with_uncertain(_uncertain(changes, covariance))
        except ScenarioError as error:
            raise ScenarioError(f"the extended model makes no scenario: {error}") from None

    def writers(
        self, folder: Path, told: str, causes: str, extended: Scenario
    ) -> dict[Path, Callable[[Path], object]]:
        lines = _comments(self._measurement, told, causes, extended)
        return scenario_writers(extended, folder / self._file, lines)


def _uncertain(changes: Mapping[str, float], matrix: DataFrame | None) -> JointPrior | None:
    """The covariance of fitted keys; one that is pushed against its end is taken as known."""
    if matrix is None:
        return None
    names = [name for name in matrix.columns if name in changes and matrix.loc[name, name] > 0]
    if not names:
        return None
    rows = matrix.loc[names, names].to_numpy().tolist()
    return JointPrior({}, tuple(names), tuple(map(tuple, rows)))


def report_files(*scenarios: Scenario) -> tuple[str, ...]:
    """Names of the files of a report: with those that state the scenario, or that of each side."""
    names = [EXTENDED] if len(scenarios) == 1 else [f"{side}.toml" for side in SIDES]
    held = (files_of(one, Path(name)).values()
            for name, one in zip(names, scenarios, strict=True))  # fmt: skip
    return (*FILES, *names, *(file for each in held for file in each))


def _comments(measurement: Measurement, told: str, first: str, extended: Scenario) -> list[str]:
    """Where an extended scenario is from, and what it has changed."""
    lines = [f"stickslip diagnose {measurement.path.name}: {told}".rstrip()]
    if first:
        lines.append(f"here: {first}, the first of the set")
    changed = [
        f"{key}: {measurement.scenario.get(key):.6g} -> {extended.get(key):.6g}"
        for key, known in known_keys().items()
        if known.kind == "real"
        and not (is_of_one_coil(key) and key not in extended.coil.own_values())
        and extended.get(key) != measurement.scenario.get(key)
    ]
    drive = "[drive] is that of the scenario as it was given"
    differs = sorted({
        key.removeprefix("drive.") for data in measurement.velocity for drive in data.conditions
        for key, value in drive.items() if value != measurement.scenario.get(key)
    })  # fmt: skip
    if differs:
        drive += f"; the measurements set {', '.join(differs)}"
    return [*lines, *(changed or ["nothing is changed"]), drive]


@functools.cache
def vocabulary() -> Vocabulary:
    """The words of causes.toml, and the drawings beside it."""
    words = known()
    return Vocabulary(
        causes=words["causes"],
        constants=words["constants"],
        units=words["units"],
        problems=words["problems"],
        drawing=drawing,
        is_handy=_is_handy,
        nouns=False,
        files=words["files"],
    )


def drawing(name: str, way: str = "") -> str:
    """The drawing of a cause as SVG; `way`, the word for its sign, turns its arrow.

    Empty where there is none of that name.
    """
    symbols = own_text("walker/drawings.svg")
    parts = dict(re.findall(r'<g id="([\w-]+)">(.*?)</g>\n', symbols))
    for key in (f"{name} {way}", name):
        match = re.search(
            rf'<symbol id="{re.escape(key)}" viewBox="(.*?)"><title>(.*?)</title>(.*?)</symbol>',
            symbols, re.S,
        )  # fmt: skip
        if match:
            box, title, inside = match.groups()
            shown = re.sub(r'<use href="#([\w-]+)"/>', lambda use: parts[use[1]], inside.strip())
            return (
                f'<svg class="drawing" viewBox="{box}" role="img" aria-label="{title}">'
                f"<title>{title}</title>{shown}</svg>"
            )
    return ""


def _is_handy(name: str) -> bool:
    return name in known_keys() or name.startswith("tracking.")


def _laws(measurement: Measurement, problem: Problem, x: Array) -> tuple[Cause, ...]:
    """The simulator's laws of a free shape at recalibrated constants; none without velocities."""
    table = problem.tables[0]
    if not isinstance(table, VelocityTable):
        return ()
    values = problem.physical(x[None, :])[0].tolist()
    constants = {
        constant.name: value
        for constant, value in zip(problem.constants, values, strict=False)
        if constant.name in known_keys()
    }
    scenario = measurement.scenario.replace(constants)
    spans = find_spans([scenario.replace(drive) for drive in table.conditions], table.threads)
    stated = {key.split(".")[1] for key in constants if key.startswith("effects.")}
    # What a diagnosis has found before may be stated, in whichever form.
    stated |= {f"free_{name.rpartition('_')[0]}" for name in scenario.laws}
    spans = {name: span for name, span in spans.items()
             if name not in {*scenario.effects, *scenario.laws, *stated}}  # fmt: skip
    return laws(scenario, measurement.uncertain, spans)


def _driven(measurement: Measurement) -> list[Scenario]:
    """The scenario of each drive that was measured; the stated one if there is none."""
    stated = measurement.scenario
    drives = [
        stated.replace({"drive.program": None, **drive})
        for data in measurement.velocity
        for drive in data.conditions
    ]
    return [*drives, *(run.scenario for run in measurement.tracking)] or [stated]


def _refuse_turns(measurement: Measurement) -> None:
    """Refuse drives that turn the robot: velocities and films are compared along x."""
    for driven in _driven(measurement):
        if driven.whole_plane and driven.coil.map is None:
            raise ScenarioError(
                f"{measurement.path}: with drive.heading = {driven.drive.heading:g} or what else "
                "pushes it across the robot leaves its plane; allowed in a diagnosis are robots "
                "that walk along x"
            )
