"""Every kind of CSV file that is read: comment lines, the byte order mark, line numbers, quotes."""

import codecs
import itertools
import math
import re
import zipfile
from collections.abc import Mapping

import numpy as np
import pandas as pd
import pytest

from stickslip import FieldMap, Measurement, Scenario, ScenarioError, Waveform, models
from stickslip._util.arrays import to_si
from stickslip._util.columns import read_table, sound_numbers
from stickslip._util.recipes import Recipe
from stickslip._util.units import per_si
from stickslip.scenario.keys import COIL_NAMES
from stickslip.walker.read_velocity import read_velocity
from stickslip.walker.read_velocity import velocities as of_velocities

FRAMES = {"t": "s", "x": "m", "theta": "rad"}


def voltages(path):
    return tuple(map(np.ndarray.tolist, Waveform.from_csv(path).points())), ()


def velocities(path):
    data, left_out = read_velocity(read_table(path, of_velocities()), Scenario(), float("nan"))
    return (data.conditions, data.velocity.tolist()), left_out


def numbers_of(columns):
    def read(path):
        recipe = Recipe.of(columns, columns)
        table, left_out = sound_numbers(path, recipe)
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

MEASURED = ("velocities", "tracking")
"""Kinds of tables that say what was left out of them."""

# Each with its reader, and its lines; the last one is wrong.
FILES = {
    "voltages": (voltages, ["t,xp,xm,yp,ym,clamp", "0,0,0,0,0,0", "1,5,0,0,0,-10", "2,0,x,0,0,0"]),
    "velocities": (velocities, ["frequency,velocity", "30,1e-3", "40,2e-3", "50,lost"]),
    "tracking": (numbers_of(FRAMES), numbers_text(FRAMES)),
    "map": (
        lambda path: (FieldMap.from_file(path), ()),
        ["x,y,z,coil,Bx,By,Bz", *BOX, "1e-3,1e-3,1e-3,zp,0,0,0"],
    ),
}

# Where no byte order mark is, and where one is; ends of lines of three systems.
FORMS = [(b"", "\n"), (codecs.BOM_UTF8, "\r\n"), (b"", "\r")]


def commented(lines):
    """The lines with comments, one of which has a quote, and empty lines among them."""
    return ['# the robot "A", 5" tube', "", *lines[:1], "  # a remark in µm", *lines[1:]]


def float_or_word(cell):
    """Whether a cell is a number."""
    return re.fullmatch(r"[-+.\de]+", cell) is not None


def numbers_in(found):
    """All numbers that a reader gave, in order."""
    if isinstance(found, FieldMap):
        return [*found.low, *found.high]
    if isinstance(found, Mapping):
        return numbers_in(list(found.values()))
    if isinstance(found, list | tuple):
        return [number for each in found for number in numbers_in(each)]
    return [found] if isinstance(found, float) else []


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
    assert [(each.code, each.value) for each in left_out] == (
        [("comments", 1)] if kind in MEASURED else []
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
        assert any(f"a.csv line {wrong}: " in each.text for each in left_out)
        assert not any("a.csv lines" in each.text for each in left_out)


@pytest.mark.parametrize("kind", FILES)
def test_a_quote_without_a_partner_is_refused_with_its_line(tmp_path, kind):
    read, lines = FILES[kind]
    above = commented(lines[:-2])
    path = write(tmp_path / "a.csv", [*above, '"' + lines[-2], lines[-2]])
    with pytest.raises(ScenarioError, match=f"(?:row|line) {len(above) + 1}.* quote"):
        read(path)


@pytest.mark.parametrize("kind", FILES)
def test_a_byte_that_is_no_text_is_named(tmp_path, kind):
    read, lines = FILES[kind]
    # More than what is decoded at a time comes before it.
    text = codecs.BOM_UTF8 + "\n".join(["#" * 9999, *lines[:-1]]).encode() + b"\n"
    (tmp_path / "a.csv").write_bytes(text + b"\xff")
    with pytest.raises(ScenarioError, match=f"byte {len(text) + 1} is not UTF-8"):
        read(tmp_path / "a.csv")


# Each as it comes from a program, and the lines of commas and points that mean the same.
DIALECTS = {
    "semicolons": lambda lines: [each.replace(",", ";") for each in lines],
    "tabs": lambda lines: [each.replace(",", "\t") for each in lines],
    "decimal commas": lambda lines: [each.replace(",", ";").replace(".", ",") for each in lines],
    "tabs, decimal commas": lambda lines: [
        each.replace(",", "\t").replace(".", ",") for each in lines
    ],
    "Excel": lambda lines: ["sep=;", *(each.replace(",", ";") for each in lines)],
    "quotes": lambda lines: [",".join(f'"{cell}"' for cell in each.split(",")) for each in lines],
    "quotes behind spaces": lambda lines: [
        ", ".join(f'"{cell}"' for cell in each.split(",")) for each in lines
    ],
    "savetxt": lambda lines: ["# of Monday", f"# {lines[0]}", *lines[1:]],
    "header and comment": lambda lines: [f"# {','.join('abcdefghijk')}", *lines],
    "commas at the end": lambda lines: [f"{each},," for each in lines],
    "commas after the names": lambda lines: [f"{lines[0]},,", *lines[1:]],
    "savetxt, commas": lambda lines: [f"# {lines[0]},,", *(f"{each},," for each in lines[1:])],
    "commas after the rows": lambda lines: [lines[0], *(f"{each}," for each in lines[1:])],
    "blank cells": lambda lines: [*lines, "," * lines[0].count(",")],
    "a number of commas": lambda lines: [*lines, "", ",,", ""],
}


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("kind", FILES)
def test_what_programs_write_is_read(tmp_path, kind, dialect):
    read, lines = FILES[kind]
    plain, _ = read(write(tmp_path / "a.csv", lines[:-1]))
    found, left_out = read(write(tmp_path / "a.csv", DIALECTS[dialect](lines[:-1])))
    assert found == plain
    empty = {"commas at the end": 2, "commas after the names": 2, "savetxt, commas": 2,
             "commas after the rows": 1}.get(dialect)  # fmt: skip
    assert [(each.code, each.value) for each in left_out] == (
        [("empty-columns", empty)] if empty and kind in MEASURED else []
    )


# What a cell may be, in every kind of table: the same number, a gap, or refused.
NUMBERS = {
    "\u22121e-3": "-1e-3", "1D-03": "1e-3", "+1d-3": "1e-3", "\u22121D\u22123": "-1e-3",
    "True": "1", "FALSE": "0", "1E-3": "1e-3", ".001": "0.001",
}  # fmt: skip
GAPS = ("", "nan", "-nan", "NA", "#N/A", "null", "-", "\u2013", "--.--", "ERR", "#DIV/0!", "1.#IND",
        "OVLD", "OL", "inf", "<25.0", "no data")  # fmt: skip
WORDS = ("1/2", "--5", "fast", "1_000", "0x10", "5f", "1e400", "1e61", "1 008", "1'008.5", "0.1 m",
         "1.0085k", "1.008.5", "12:00:01")  # fmt: skip
JOINT = models.joint(inertia=0.1)


def log(path):
    read = models.read_log(path, JOINT, "si")
    return {"t": read.t.tolist(), "y": read.y.tolist(), "u": read["torque"].tolist()}, read.notes


LOG = ["t,speed,torque", *(f"{k},0.{k},0.5" for k in range(4))]
# By kind its reader, its lines, the column whose cell is changed in the second of the rows, and
# whether it may be a gap.
CELLS = {
    "log": (log, LOG, "speed", True),
    "input of a log": (log, LOG, "torque", False),
    "velocities": (velocities, ["frequency,velocity", *(f"{k},2e-3" for k in (30, 40, 50, 60))],
                   "velocity", True),
    "tracking": (*FILES["tracking"], "x", True),
    "field": (numbers_of({"zp": "A", "x": "m", "Bx": "T"}),
              ["zp,x,Bx", "1,0,1e-3", "1,1e-3,1e-3", "1,2e-3,1e-3", "1,3e-3,1e-3"], "Bx", True),
    "voltages": (*FILES["voltages"], "xp", False),
    "map": (*FILES["map"], "x", False),
}  # fmt: skip


@pytest.mark.parametrize("separator", [",", ";"])
@pytest.mark.parametrize("kind", CELLS)
def test_a_cell_is_a_number_or_a_gap_or_refused_in_all_tables(tmp_path, kind, separator):
    read, lines, column, may_be_gap = CELLS[kind]
    at = lines[0].split(",").index(column)

    def with_cell(cell):
        rows = [line.split(",") for line in lines[: -1 if len(lines[-1].split(",")) > 2 else None]]
        rows[2][at] = cell
        return read(write(tmp_path / "a.csv", [separator.join(row) for row in rows]))

    for cell, plain in NUMBERS.items() if kind != "map" else list(NUMBERS.items())[:2]:
        assert numbers_in(with_cell(cell)[0]) == numbers_in(with_cell(plain)[0]), cell
    named = rf"a\.csv: (?:line|row) 3, column {column} = "
    for cell in GAPS:
        if not may_be_gap:
            with pytest.raises(ScenarioError, match=named):
                with_cell(cell)
            continue
        found, notes = with_cell(cell)
        whole, _ = with_cell("1e-3")
        assert len(numbers_in(found)) < len(numbers_in(whole)), cell
        assert notes[0].code in ("many-gaps", "rows-left-out"), cell
        assert any("a.csv line 3" in str(note) for note in notes), cell
    for cell in WORDS:
        with pytest.raises(ScenarioError, match=named) as error:
            with_cell(cell)
        assert f'"{cell}": allowed is a finite number' in str(error.value)


def workbook(path, **sheets):
    book = pytest.importorskip("openpyxl").Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


@pytest.mark.parametrize("kind", FILES)
def test_a_workbook_is_read_as_the_table_that_it_holds(tmp_path, kind):
    read, lines = FILES[kind]
    rows = [line.split(",") for line in lines[:-1]]
    rows = [[float(c) if float_or_word(c) else c for c in row] for row in rows]
    assert read(workbook(tmp_path / "a.xlsx", empty=[], one=[[], *rows]))[0] == read(
        write(tmp_path / "a.csv", lines[:-1]))[0]  # fmt: skip
    with pytest.raises(ScenarioError, match='sheets "one", "two" have data: allowed is one'):
        read(workbook(tmp_path / "b.xlsx", one=rows, two=[[1]]))
    (tmp_path / "c.xlsx").write_bytes((tmp_path / "a.xlsx").read_bytes()[:-40])
    with pytest.raises(ScenarioError, match=r"c\.xlsx: is a .*damaged workbook"):
        read(tmp_path / "c.xlsx")


def test_a_workbook_that_unpacks_to_too_much_is_not_opened(tmp_path):
    path = workbook(tmp_path / "a.xlsx", one=[["t", "x"], [0.0, 1.0]])
    with (
        zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("xl/more.xml", "w") as file,
    ):
        for _ in range(513):
            file.write(bytes(1 << 20))
    with pytest.raises(ScenarioError, match=r"unpacks to 513 MiB: allowed are 512 MiB"):
        read_table(path, Recipe.of(FRAMES))


def test_a_workbook_has_times_texts_and_errors_of_its_own(tmp_path):
    begin = pd.Timestamp("2026-05-01 12:00:00.25")
    heads = ["Time", "speed\n(deg/s)", "torque (N m)", "ok"]
    rows = [[(begin + pd.Timedelta(0.5 * k, "s")).to_pydatetime(), 10 * k, 0.1, True]
            for k in range(9)]  # fmt: skip
    rows[2][1], rows[4][1], rows[5][3] = None, "#DIV/0!", False
    read = models.read_log(workbook(tmp_path / "a.xlsx", log=[["of; Monday"], heads, *rows]), JOINT)
    kept = [0, 1, 3, 6, 7, 8]
    assert read.t == pytest.approx(0.5 * np.array(kept), abs=1e-6)
    assert read.y == pytest.approx(np.radians(10.0 * np.array(kept)))
    rows[3][1] = "3 deg/s"
    with pytest.raises(ScenarioError, match='line 6, column speed = "3 deg/s": allowed is'):
        models.read_log(workbook(tmp_path / "b.xlsx", log=[["of; Monday"], heads, *rows]), JOINT)


@pytest.mark.parametrize("mark", [codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE])
def test_utf_16_is_read(tmp_path, mark):
    read, lines = FILES["velocities"]
    plain = read(write(tmp_path / "a.csv", lines[:-1]))
    code = "utf-16-le" if mark == codecs.BOM_UTF16_LE else "utf-16-be"
    (tmp_path / "a.csv").write_bytes(mark + "\r\n".join(lines[:-1]).encode(code))
    assert read(tmp_path / "a.csv") == plain


@pytest.mark.parametrize("cell", ["#N/A", "#VALUE!", "#REF!", "#1"])
@pytest.mark.parametrize("header", [True, False])
@pytest.mark.parametrize("kind", FILES)
def test_a_row_that_begins_with_a_hash_is_not_lost(tmp_path, kind, header, cell):
    """Below a header of its own or in a comment; first of all rows, which is the hardest place."""
    read, lines = FILES[kind]
    names, first, *others = lines[:-1]
    bad = ",".join([cell, *first.split(",")[1:]])
    head = names if header else f"# {names}"
    path = write(tmp_path / "a.csv", [head, bad, first, *others])
    if kind in MEASURED and cell != "#1":
        _, left_out = read(path)
        assert any("a.csv line 2: " in each.text for each in left_out)
        return
    with pytest.raises(ScenarioError, match=r"(?:row|line) 2\b"):
        read(path)


def test_a_wrong_cell_far_below_is_named_by_its_line(tmp_path):
    rows = [f"{k},0.5,0.5" for k in range(9000)]
    rows[8500] = "8500,fast,0.5"
    with pytest.raises(ScenarioError, match='line 8502, column speed = "fast"'):
        log(write(tmp_path / "a.csv", [LOG[0], *rows]))


def test_a_label_may_begin_with_a_hash(tmp_path):
    lines = ["block,frequency,velocity", "#1,20,1e-3", "# a remark", "#2,20,2e-3"]
    path = write(tmp_path / "a.csv", lines)
    data, left_out = read_velocity(read_table(path, of_velocities()), Scenario(), 0.01)
    assert data.block.tolist() == [0, 1]
    assert [each.code for each in left_out] == ["comments"]


# Of each kind a column, one that is n times larger in another unit, and one of another quantity.
UNITS = {
    "voltages": ("t", "t (ms)", 1e3, "t (mV)", "ms"),
    "velocities": ("velocity", "velocity [mm/s]", 1e3, "velocity (mm)", "mm/s"),
    "tracking": ("theta", "theta (deg)", 180.0 / math.pi, "theta (m)", "deg"),
    "map": ("x", "x (mm)", 1e3, "x (T/A)", "mm"),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_column_in_another_unit_is_converted(tmp_path, kind):
    read, lines = FILES[kind]
    name, heading, n, wrong, allowed = UNITS[kind]
    names = lines[0].split(",")
    at = names.index(name)

    def with_column(heading, n, *below):
        rows = [each.split(",") for each in lines[1:-1]]
        changed = [
            [repr(float(c) * n) if k == at and float_or_word(c) else c for k, c in enumerate(row)]
            for row in rows
        ]
        head = ",".join([*names[:at], heading, *names[at + 1 :]])
        return write(tmp_path / "a.csv", [head, *below, *map(",".join, changed)])

    plain, _ = read(with_column(name, 1.0))
    found, left_out = read(with_column(heading, n))
    # A decimal number times n and over n again is rounded twice, by half a last bit each.
    assert numbers_in(found) == pytest.approx(numbers_in(plain), rel=4e-16, abs=0.0)
    assert [each.code for each in left_out] == (["converted"] if kind in MEASURED else [])
    for unit in (allowed, f"[{allowed}]"):
        units = ",".join(unit if k == at else "" for k in range(len(names)))
        below, _ = read(with_column(name, n, units))
        assert numbers_in(below) == numbers_in(found)
    for parted in (" / ", "/") if len(name) < 3 else (" / ",):
        assert numbers_in(read(with_column(name + parted + allowed, n))[0]) == numbers_in(found)
    with pytest.raises(ScenarioError, match="is no unit of it; allowed are") as error:
        read(with_column(wrong, 1.0))
    assert allowed in str(error.value).split("allowed are ")[1].split(", ")
    with pytest.raises(ScenarioError, match=f'"?{name}"?:? is there twice'):
        read(write(tmp_path / "a.csv", [f"{lines[0]},{heading}", *(f"{e},1" for e in lines[1:])]))


def test_numbers_in_other_units_are_those_of_the_text():
    """20 times a power of ten is exact, so the double next to the decimal number is met."""
    cells = [f"{digits}e{power}" for digits in (1, 3, 7, 9.3, 123.4567) for power in (0, 1, 2)]
    for unit, power in {"mm": -3, "um": -6, "cm": -2, "km": 3}.items():
        n = per_si(unit, "m")
        whole = [cell for cell in cells if float(cell) == int(float(cell))]
        assert [to_si(float(c), n) for c in whole] == [
            float(f"{int(float(c))}e{power}") for c in whole
        ]


@pytest.mark.parametrize("kind", MEASURED)
def test_information_is_named(tmp_path, kind):
    read, lines = FILES[kind]
    plain, _ = read(write(tmp_path / "a.csv", lines[:-1]))
    beside = ["date,temperature (C)", *["2024-05-01,21.5"] * (len(lines) - 2)]
    wide = [f"{a},{b}" for a, b in zip(lines[:-1], beside, strict=True)]
    found, left_out = read(write(tmp_path / "a.csv", wide))
    assert found == plain
    assert [str(each) for each in left_out] == [
        "a.csv: columns that are information only: date and temperature (C)."
    ]


@pytest.mark.parametrize("words", [("valid", "1", "0"), ("OK", "yes", "No")])
@pytest.mark.parametrize("kind", MEASURED)
def test_rows_that_are_not_valid_are_left_out(tmp_path, kind, words):
    read, lines = FILES[kind]
    name, yes, no = words
    plain, _ = read(write(tmp_path / "a.csv", lines[:-1]))
    told = [f"{lines[0]},{name}", f"{lines[1]},{no}", *(f"{each},{yes}" for each in lines[1:-1])]
    found, left_out = read(write(tmp_path / "a.csv", told))
    assert found == plain
    assert [str(each) for each in left_out] == [f"a.csv: 1 row left out by column {name}."]
    with pytest.raises(ScenarioError, match=rf'line 2, column {name} = "so": allowed are 1, 1\.0'):
        read(write(tmp_path / "a.csv", [told[0], f"{lines[1]},so"]))
    with pytest.raises(ScenarioError, match="no row is sound"):
        read(write(tmp_path / "a.csv", told[:2]))


def test_a_table_in_memory_has_units_and_information_too():
    table = pd.DataFrame(
        {
            "frequency (kHz)": [0.02, 0.03],
            "velocity (mm/s)": [1.0, 2.0],
            "day": pd.to_datetime(["2024-05-01", None]),
            "order": pd.to_datetime(["2024-05-01 10:01", "2024-05-01 10:00"]),
        }
    )
    found = Measurement.from_dataframe(table, Scenario())
    (data,) = found.velocity
    assert data.velocity.tolist() == [1e-3, 2e-3]
    assert [each["drive.frequency"] for each in data.conditions] == [20.0, 30.0]
    assert data.order.tolist() == [60.0, 0.0]
    assert [each.code for each in found.left_out] == ["converted", "columns-not-used"]


REFUSED = {
    "blanks": (b"frequency velocity\n20 1e-3\n", "no comma, semicolon or tab"),
    "savetxt without a delimiter": (b"# frequency velocity\n2e+01 1e-03\n", "delimiter="),
    "decimal commas between commas": (b"frequency,velocity\n20,5,0,001\n", "by semicolons"),
    "one decimal comma": (b"frequency,velocity\n20,0,001\n", "by semicolons"),
    "both marks": (b"frequency;velocity\n20,5;0.001\n", 'line 2: "0.001" has a decimal point'),
    "thousands": (b'frequency,velocity\n"1,234.5",1e-3\n', "without separators of thousands"),
    "commas of thousands or decimals": (
        b"frequency;velocity\n20;999\n30;1,234\n",
        'line 3: "1,234" may be 1234 or 1.234, as "999" in line 2',
    ),
    "too few cells": (b"frequency,velocity,no\n20,1e-3\n", "no row is sound"),
    "python's number": (b"frequency,velocity\n20,1_0e-4\n", '"1_0e-4": allowed is a finite number'),
    "archive": (b"PK\x03\x04\x14\x00", r"another ZIP archive.*examples/read_instruments\.py"),
    "old workbook": (b"\xd0\xcf\x11\xe0\xa1\xb1", "an Excel workbook"),
    "MATLAB": (b"MATLAB 5.0 MAT-file, Platform: GLNXA64", "a MATLAB file"),
    "MATLAB 7.3": (b"\x89HDF\r\n\x1a\n\x00", "MATLAB 7.3"),
    "XML": (codecs.BOM_UTF8 + b"\n<?xml version='1.0'?>\n<TrackMate>", "an XML file"),
    "UTF-16 without its mark": ("a,b\n1,2\n".encode("utf-16-le"), "byte 2 is NUL .UTF-16"),
    "half of UTF-16": (codecs.BOM_UTF16_LE + b"a\x00b", "damaged UTF-16"),
    "header only": (b"frequency,velocity\n", "no row of data"),
    "header in a comment only": (b"# frequency,velocity\n", "no row of data"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_told_as_what_it_is(tmp_path, case):
    data, said = REFUSED[case]
    (tmp_path / "a.csv").write_bytes(data)
    with pytest.raises(ScenarioError, match=said) as error:
        FILES["velocities"][0](tmp_path / "a.csv")
    assert str(tmp_path / "a.csv") in str(error.value)
    assert "\n" not in str(error.value)


def test_a_column_of_voltages_or_fields_without_a_name_has_to_be_empty(tmp_path):
    for kind in ("voltages", "map"):
        read, lines = FILES[kind]
        path = write(tmp_path / "a.csv", [f"{each}," for each in lines[:-2]] + [f"{lines[-2]},7"])
        with pytest.raises(ScenarioError, match=f"row {len(lines) - 1} has"):
            read(path)


def test_a_wrong_heading_of_voltages_is_named_of_a_file_and_of_a_frame(tmp_path):
    _, lines = FILES["voltages"]
    path = write(tmp_path / "a.csv", commented([lines[0].replace("clamp", "clmp"), *lines[1:-1]]))
    for given in (path, pd.read_csv(path, comment="#")):
        with pytest.raises(ScenarioError, match='"clmp" may be meant as it'):
            Waveform.from_csv(given)
