"""The measurement file that names a table: what somebody needs who has a table alone."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from stickslip._util.cells import INSTRUMENTS_PAGE
from stickslip._util.columns import Source
from stickslip._util.text import literal, printable
from stickslip._util.units import split_unit
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys
from stickslip.walker.read_velocity import settings, velocities

_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".xlsx")
"""Names of tables; a file with another one is a table if its columns are those of one."""

_FEW = 12  # columns that an error names; chosen

_HEAD = """\
stickslip_measurement = 1
scenario = "scenario.toml"  # your robot; "stickslip init scenario.toml" writes one to change

# What is not known exactly, such as:
# [uncertain]
# "{key}" = {{ mean = {mean}, sd = {sd:.1g} }}

"""

_MORE = {
    "velocity": "# velocity_sd = 0.05  # relative error of one trial, where none is repeated\n",
    "tracking": """\
# drive = { mode = "IPP", frequency = 30.0 }  # of this film, where the scenario has another
# exposure = 1e-3  # s
""",
}


class TableGiven(ScenarioError):
    """A table of data in place of a measurement file; `lines` are the file that it needs."""

    def __init__(self, lines: str, observable: str) -> None:
        self.lines = lines
        super().__init__(
            f"is a table for [[{observable}]] of a measurement, which is a TOML file; "
            '"stickslip diagnose" prints its lines, and writes them with --write'
        )


def refuse_table(path: Path, required: Mapping[str, Collection[str]]) -> None:
    """Raise a TableGiven for a table of data; nothing if the file is none.

    `required` has the columns of each observable without which there is none. A ScenarioError names
    the columns of a table that has those of none.
    """
    known = [*known_keys(), *(name for names in required.values() for name in names)]
    try:
        header = Source(path).csv(known).header
    except ScenarioError:
        return
    there = [split_unit(heading)[0] for heading in header]
    for observable, names in required.items():
        if {*names} <= {*there}:
            raise TableGiven(_lines(path, observable, there), observable)
    if path.suffix.lower() in _SUFFIXES:
        wanted = "; ".join(", ".join(names) for names in required.values())
        names = ", ".join(there[:_FEW]) + (", ..." if len(there) > _FEW else "")
        raise ScenarioError(
            f"is a table of data with the columns {printable(names)}: allowed are {wanted}; "
            f"{INSTRUMENTS_PAGE} makes them of others, velocity_of_track a velocity of t and x; "
            "a log of another system needs --model"
        )


def _lines(path: Path, observable: str, columns: Collection[str]) -> str:
    """The text of the file."""
    key = known_keys()["contact.kinetic_friction"]
    mean = float(key.default)
    lines = _HEAD.format(key=key.name, mean=mean, sd=0.07 * mean)
    lines += f"[[{observable}]]\nfile = {literal(path.name)}\n{_MORE.get(observable, '')}"
    if observable == "velocity":
        names = velocities().names
        keys = [names[name] for name in columns if names.get(name) in settings()]
        lines += f"# Of the drive the table has {', '.join(keys) or 'nothing'}; the scenario has "
        lines += "the rest.\n"
    return lines
