"""Every kind of CSV file that is read: comment lines, the byte order mark, line numbers, quotes."""

import codecs
import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from asking_results import measurement
from command_line import check, stickslip
from stickslip import FieldMap, Scenario, ScenarioError, Waveform
from stickslip.facts import Code
from stickslip.measurement.tables import read_numbers, read_rows
from stickslip.measurement.velocity import read_velocity, velocity_units
from stickslip.reproduction.curves import read_measured
from stickslip.scenario.sections import COIL_NAMES

FRAMES = {"t": "s", "x": "m", "theta": "rad"}
ANGLES = {"Bx": "T", "Bz": "T", "theta": "rad"}
FIELDS = {
    **dict.fromkeys(("xp", "xm", "yp", "ym", "clamp"), "A"),
    **dict.fromkeys("xyz", "m"),
    **dict.fromkeys(("Bx", "By", "Bz"), "T"),
}


def voltages(path):
    return tuple(map(np.ndarray.tolist, Waveform.from_csv(path).points())), ()


def velocities(path):
    data, left_out = read_velocity(
        path, read_rows(path, velocity_units()), Scenario(), float("nan")
    )
    return (data.conditions, data.velocity.tolist()), left_out


def new_trials(path):
    data = measurement().with_velocities(path)
    return data.velocity[-1].velocity.tolist(), ()


def numbers_of(columns):
    def read(path):
        table, left_out = read_numbers(path, columns)
        return {name: column.tolist() for name, column in table.items()}, left_out

    return read


def numbers_text(columns):
    rows = [",".join(f"{row}.{k}" for k in range(len(columns))) for row in range(3)]
    return [",".join(columns), *rows, ",".join(["lost"] * len(columns))]


# A box of points, in which no coil makes a field.
BOX = [
    ",".join([*(str(each) for each in place), coil, "0,0,0"])
    for coil in COIL_NAMES
    for place in itertools.product((-1e-3, 1e-3), repeat=3)
]

MEASURED = ("velocities", "tracking", "angle", "field")
"""Kinds of tables that say what was left out of them."""

# Each with its reader, and its lines; the last one is wrong.
FILES = {
    "voltages": (voltages, ["t,xp,xm,yp,ym,clamp", "0,0,0,0,0,0", "1,5,0,0,0,-10", "2,0,x,0,0,0"]),
    "velocities": (velocities, ["frequency,velocity", "30,1e-3", "40,2e-3", "50,lost"]),
    "new trials": (new_trials, ["frequency,velocity", "30,1e-3", "41,2e-3", "52,lost"]),
    "tracking": (numbers_of(FRAMES), numbers_text(FRAMES)),
    "angle": (numbers_of(ANGLES), numbers_text(ANGLES)),
    "field": (numbers_of(FIELDS), numbers_text(FIELDS)),
    "map": (
        lambda path: (FieldMap.from_file(path), ()),
        ["x,y,z,coil,Bx,By,Bz", *BOX, "1e-3,1e-3,1e-3,zp,0,0,0"],
    ),
    "digitised points": (
        lambda path: (read_measured(path), ()),
        ["figure,mode,x,y", "fig12,IPP,10,1e-3", "fig13,OPP,10,1e-3", "fig12,IPP,20,lost"],
    ),
}

# Where no byte order mark is, and where one is; ends of lines of three systems.
FORMS = [(b"", "\n"), (codecs.BOM_UTF8, "\r\n"), (b"", "\r")]


def commented(lines):
    """The lines with comments, one of which has a quote, and empty lines among them."""
    return ['# the robot "A", 5" tube', "", *lines[:1], "  # a remark in µm", *lines[1:]]


def write(path, lines, mark=b"", end="\n"):
    path.write_bytes(mark + (end.join(lines) + end).encode())
    return path


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", FILES)
def test_comments_and_the_mark_change_nothing(tmp_path, kind, form):
    read, lines = FILES[kind]
    plain, nothing = read(write(tmp_path / "a.csv", lines[:-1]))
    found, left_out = read(write(tmp_path / "a.csv", commented(lines[:-1]), *form))
    assert found == plain
    assert list(nothing) == []
    assert [(fact.code, fact.fields["count"]) for fact in left_out] == (
        [(Code.COMMENTS, 1)] if kind in MEASURED else []
    )


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", FILES)
def test_a_wrong_row_is_named_by_its_line_in_the_file(tmp_path, kind, form):
    read, lines = FILES[kind]
    path = write(tmp_path / "a.csv", commented(lines), *form)
    wrong = commented(lines).index(lines[-1]) + 1
    try:
        _, left_out = read(path)
    except ScenarioError as error:
        (named,) = re.findall(r"(?:row|line) (\d+)", str(error))
        assert int(named) == wrong
    else:
        assert [fact.fields["lines"] for fact in left_out if "lines" in fact.fields] == [[wrong]]


@pytest.mark.parametrize("kind", FILES)
def test_a_quote_without_a_partner_is_refused_with_its_line(tmp_path, kind):
    read, lines = FILES[kind]
    above = commented(lines[:-2])
    path = write(tmp_path / "a.csv", [*above, '"' + lines[-2], lines[-2]])
    with pytest.raises(ScenarioError, match=f"line {len(above) + 1}: a quoted cell goes over"):
        read(path)


@pytest.mark.parametrize("kind", FILES)
def test_a_byte_that_is_no_text_is_named(tmp_path, kind):
    read, lines = FILES[kind]
    # More than what is decoded at a time comes before it.
    text = codecs.BOM_UTF8 + "\n".join(["#" * 9999, *lines[:-1]]).encode() + b"\n"
    (tmp_path / "a.csv").write_bytes(text + b"\xff")
    with pytest.raises(ScenarioError, match=f"byte {len(text) + 1} is not UTF-8"):
        read(tmp_path / "a.csv")


def test_a_wrong_heading_of_voltages_is_named_by_its_line(tmp_path):
    _, lines = FILES["voltages"]
    path = write(tmp_path / "a.csv", commented([lines[0].replace("clamp", "zp"), *lines[1:]]))
    with pytest.raises(ScenarioError, match="row 3: the column clamp is missing"):
        Waveform.from_csv(path)


def test_a_column_in_other_case_is_named(tmp_path):
    (tmp_path / "s.toml").write_text("stickslip = 1\n[drive]\n")
    write(tmp_path / "v.csv", ["frequency,Velocity", "30,1e-3"])
    write(
        tmp_path / "m.toml",
        ["stickslip_measurement = 1", 'scenario = "s.toml"', "[[velocity]]", 'file = "v.csv"'],
    )
    done = stickslip("diagnose", "m.toml", cwd=tmp_path)
    check(done, 'column "velocity" is missing', '"Velocity" may be meant')
    assert not Path(tmp_path / "diagnosis").exists()
