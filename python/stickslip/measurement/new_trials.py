"""Trials that were measured after the others, in a table that a person has just filled in."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.errors import ScenarioError
from stickslip.measurement.read_table import Line, NothingSound, Rows, check_columns
from stickslip.measurement.read_velocity import VelocityData, read_velocity
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.note import Note

_OF_THE_WHOLE = (
    "rows-left-out",
    "equal-settings",
    "outlier",
    "comments",
    "empty-columns",
    "columns-not-used",
)
"""Codes of notes that blame no cell: how many rows are wrong, settings that count as one, a trial
that others contradict, what is beside the rows."""


def read_new_trials(
    table: Rows, scenario: Scenario, relative_sd: float, earlier: Sequence[VelocityData]
) -> tuple[VelocityData, list[Note]]:
    """The trials of a table of proposed drives, and which of them are left out as outliers.

    Rows without a velocity were not measured. All others have to be sound, as whoever has just
    filled them in can correct them: where a long table of old data is used as far as it goes, this
    one is refused. The arguments are those of `read_velocity`.

    Raises
    ------
    ScenarioError
        With the first row that is not sound, if none has a velocity, or if all trials are among the
        `earlier` ones.
    """
    path = table.path
    check_columns(path, table.header, ["velocity"])
    empty = set(unmeasured(table))
    filled = [(line, row) for line, row in table.rows if line not in empty]
    if not filled:
        raise ScenarioError(f"{path}: no row has a velocity; allowed is one or more")
    # Whoever filled it in has to find it, so notes name its whole path.
    whole = table._replace(rows=filled, name=str(path))
    try:
        data, left_out = read_velocity(whole, scenario, relative_sd, earlier)
    except NothingSound as error:
        raise _refused(error.why) from None
    for note in left_out:
        if note.code not in _OF_THE_WHOLE:
            raise _refused(note)
    known = {trial for old in earlier for trial in _trials(old)}
    if known.issuperset(_trials(data)):
        twice = "all its trials are in the measurement already"
        raise ScenarioError(f"{path}: {twice}: allowed is once, or they would count twice")
    return data, left_out


def unmeasured(table: Rows) -> list[Line]:
    """Lines of the rows whose velocity is empty."""
    at = table.header.index("velocity")
    return [line for line, row in table.rows if at < len(row) and not row[at]]


def _refused(note: Note) -> ScenarioError:
    hint = " Allowed are numbers; a velocity that was not measured stays empty."
    return ScenarioError(f"{note}{hint if note.code == 'not-a-number' else ''}")


def _trials(data: VelocityData) -> list[tuple[object, ...]]:
    """Each trial's settings and velocity."""
    settings = [tuple(sorted(condition.items())) for condition in data.conditions]
    pairs = zip(data.condition.tolist(), data.velocity.tolist(), strict=True)
    return [(settings[at], velocity) for at, velocity in pairs]
