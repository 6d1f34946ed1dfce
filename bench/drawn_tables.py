"""Drawn tables of velocities, films and field maps with a known truth, as instruments write them.

A table is a list of columns, each with its name, its unit and its numbers in SI. Laboratories and
programs change how it is written: other names and units, a preamble, a row of units, commas for
points, an index, a column beside, gaps and sums below. None of this shares code with a
reader. Each table is right, noted, refused, or silently wrong.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from stickslip import COIL_NAMES, Coil, Coils, FieldMap, Scenario, ScenarioError
from stickslip._util.columns import read_table
from stickslip.walker.read_tracking import read_tracking
from stickslip.walker.read_velocity import read_velocity, velocities

Random = np.random.Generator
SCENARIO = Scenario().replace({"drive.base": 0.5e-3, "drive.frequency": 30.0, "drive.pulses": 12})
CLOSE = 1e-3  # of the size of a column; more digits are not written


class Written(NamedTuple):
    """A column: its name, the unit that its heading states, if it does, and its cells."""

    name: str
    unit: str
    cells: list[str]


def _cells(values: Sequence[float]) -> list[str]:
    return [f"{value:.9g}" for value in values]


# ----------------------------------------------------------------------------- how a column is told
UNITS = {
    "Hz": {"Hz": 1.0, "kHz": 1e-3, "1/s": 1.0, "hertz": 1.0, "mHz": 1e3},
    "T": {"T": 1.0, "mT": 1e3, "G": 1e4, "µT": 1e6, "Gauss": 1e4, "gauss": 1e4, "kG": 10.0},
    "m/s": {"m/s": 1.0, "mm/s": 1e3, "um/s": 1e6, "µm/s": 1e6, "mm s^-1": 1e3, "cm/s": 100.0,
            "mm/min": 6e4, "m s-1": 1.0},
    "s": {"s": 1.0, "ms": 1e3, "sec": 1.0, "us": 1e6, "min": 1 / 60},
    "m": {"m": 1.0, "mm": 1e3, "um": 1e6, "µm": 1e6, "cm": 100.0, "inch": 1 / 0.0254},
    "rad": {"rad": 1.0, "deg": 180 / math.pi, "°": 180 / math.pi, "mrad": 1e3,
            "degrees": 180 / math.pi},
    "T/A": {"T/A": 1.0, "mT/A": 1e3, "G/A": 1e4, "gauss/A": 1e4, "µT/A": 1e6, "mT A^-1": 1e3},
}  # fmt: skip
"""Units as they are written, and how many are one SI unit."""
WRONG = {
    "frequency": ("rpm", "rad/s", "pulses/min"), "peak": ("A", "V", "A/m"),
    "velocity": ("mm", "BL/s"),
    "t": ("frames", "px"), "x": ("px", "s", "BL"), "theta": ("px", "T"), "Bx": ("T", "mT", "A/m"),
    "Bz": ("G", "V"),
}  # fmt: skip
"""Units that are none of the quantity, or not known."""
CALLED = {
    "frequency": ("Frequency", "freq", "f", "Pulse frequency", "rate", "Freq.", "drive.frequency"),
    "peak": ("Peak", "amplitude", "B", "Bpeak", "B_max", "field", "Peak field", "drive.peak",
             "Flux density", "coil field", "b peak"),
    "mode": ("Mode", "drive.mode", "plane", "type", "gait"),
    "velocity": ("Velocity", "speed", "v", "mean velocity", "v_mean", "vel"),
    "t": ("Time", "time", "frame", "T", "timestamp"), "x": ("X", "x position", "pos", "x_c"),
    "theta": ("Theta", "angle", "tilt", "phi"), "coil": ("Coil", "channel", "source"),
    "Bx": ("BX", "bx", "B_x", "x-field"), "y": ("Y", "posY"), "Bz": ("B_z", "bz", "z-field"),
}  # fmt: skip
"""Other names of columns that people and programs use."""
FORMS = (
    "{} ({})", "{} [{}]", "{} / {}", "{}[{}]", "{}({})", "{}, {}", "{}_{}", "{} in {}", "{} {}",
)  # fmt: skip


def told(random: Random, how: str, name: str, si: str, values: Sequence[float]) -> Written:
    """A column of numbers in some unit, which its heading states or not."""
    units = UNITS[si]
    unit = str(random.choice(list(units)))
    if how == "no units" or random.random() < 0.2:
        unit = si
    cells = _cells([each * units[unit] for each in values])
    bare = how == "no units" or (unit == si and random.random() < 0.3)
    return Written(name, "" if bare else unit, cells)


# ------------------------------------------------------------------------------- how a file is laid
def laid(random: Random, how: str, columns: list[Written]) -> str:
    """The text of a file of columns; `how` says what is odd of it."""
    separator = str(random.choice([",", ";", "\t"]))
    comma = how == "decimal commas"
    if comma:
        separator = str(random.choice([";", "\t"]))
        columns = [Written(n, u, [_comma(cell) for cell in cells]) for n, u, cells in columns]
    form = str(random.choice(FORMS))
    heads = [form.format(n, u) if u and how != "row of units" else n for n, u, _ in columns]
    rows = [list(row) for row in zip(*(cells for *_, cells in columns), strict=True)]
    above: list[str] = []
    if how == "row of units":
        rows.insert(0, [random.choice(["{}", "({})", "[{}]"]).format(u) if u else ""
                        for _, u, _ in columns])  # fmt: skip
    elif how == "preamble":
        above = [f"Gaussmeter GM-08 s/n {random.integers(9999)}", f"Date{separator}2026-05-01",
                 "", f"Operator{separator}A. N."][: int(random.integers(1, 5))]  # fmt: skip
    elif how == "comments":
        above = ["# made by a script, v1.2", f"# seed = {random.integers(99)}"]
    elif how == "three rows of heads":  # as plotting programs export: names, units, remarks
        rows.insert(0, [u for _, u, _ in columns])
        rows.insert(1, ["first day" if k == 0 else "" for k in range(len(columns))])
        heads = [n for n, *_ in columns]
    elif how == "index":
        heads = ["", *heads]
        rows = [[str(k), *row] for k, row in enumerate(rows)]
    elif how == "empty columns":
        heads, rows = [*heads, "", ""], [[*row, "", ""] for row in rows]
    elif how == "head again":  # a logger that began anew
        rows.insert(len(rows) // 2, list(heads))
    elif how == "sums below":
        sums = [f"{np.mean([float(c) for c in cells]):.6g}" if _is_number(cells[0]) else "mean"
                for *_, cells in columns]  # fmt: skip
        rows += [[""] * len(columns), sums]
    elif how == "thousands":
        rows = [[f"{float(c):,.1f}" if _is_number(c) and abs(float(c)) >= 1e3 else c for c in row]
                for row in rows]  # fmt: skip
    elif how == "cut off":
        rows[-1] = rows[-1][: max(1, len(rows[-1]) // 2)]
    lines = [_joined(heads, separator), *(_joined(row, separator) for row in rows)]
    if how == "separator told":
        above = [f"sep={separator}"]
    if how == "savetxt":
        lines[0] = f"# {lines[0]}"
    end = str(random.choice(["\n", "\r\n"]))
    return ("\ufeff" if random.random() < 0.2 else "") + end.join([*above, *lines]) + end


HOW = ("plain", "no units", "wrong unit", "other name", "decimal commas",
       "row of units", "preamble", "comments", "three rows of heads", "index", "empty columns",
       "head again", "sums below", "thousands", "cut off", "separator told", "savetxt", "beside",
       "gap", "unit in a cell", "twice", "shuffled")  # fmt: skip


def _comma(cell: str) -> str:
    return cell.replace(".", ",") if _is_number(cell) else cell


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


def _joined(cells: Sequence[str], separator: str) -> str:
    return separator.join(f'"{cell}"' if separator in cell else cell for cell in cells)


BESIDE = (
    ("temperature", "degC", 21.0, 0.1),
    ("battery", "V", 3.7, 0.01),
    ("quality", "", 0.9, 0.01),
    ("comment", "", None, 0.0),
    ("operator", "", None, 0.0),
    ("humidity", "%", 41.0, 0.5),
)


def spoiled(random: Random, how: str, columns: list[Written]) -> list[Written]:
    """Columns with what is odd of their names and cells."""
    columns = [Written(n, u, list(c)) for n, u, c in columns]
    numeric = [k for k, each in enumerate(columns) if _is_number(each.cells[0])]
    k = int(random.choice(numeric))
    name, unit, cells = columns[k]
    row = int(random.integers(len(cells)))
    if how == "wrong unit":
        columns[k] = Written(name, str(random.choice(WRONG.get(name, WRONG["x"]))), cells)
    elif how == "other name":
        k = int(random.choice([i for i, each in enumerate(columns) if each.name in CALLED]))
        other = str(random.choice(CALLED[columns[k].name]))
        columns[k] = columns[k]._replace(name=other)
    elif how == "gap":
        cells[row] = str(random.choice(["", "nan", "NaN", "-", "n/a", "ERR", "#DIV/0!", "--", "OL",
                                        "---", "NULL", "inf", "1.23(4)", "<0.1"]))  # fmt: skip
    elif how == "unit in a cell":
        columns[k] = columns[k]._replace(cells=[f"{cell} {unit or 'mm'}" for cell in cells])
    elif how == "twice":
        columns.append(Written(name, unit, [f"{1.01 * float(cell):.6g}" for cell in cells]))
    elif how == "beside":
        label, of, middle, spread = BESIDE[int(random.integers(len(BESIDE)))]
        made = ["ok, as before" if middle is None else f"{middle + spread * each:.3f}"
                for each in random.standard_normal(len(cells))]  # fmt: skip
        columns.insert(int(random.integers(len(columns) + 1)), Written(label, of, made))
    elif how == "shuffled":
        order = random.permutation(len(columns[0].cells))
        columns = [Written(n, u, [c[at] for at in order]) for n, u, c in columns]
    return columns


# ------------------------------------------------------------------------------------- three tables
def of_velocities(random: Random, how: str, path: Path) -> str:
    """Trials of drives with a mode, a frequency and a field."""
    drives = [(mode, f, p) for mode in ("IPP", "OPP") for f in (20.0, 35.0)
              for p in (2.0e-3, 2.5e-3, 3.0e-3)]  # fmt: skip
    drives = [drives[k] for k in random.permutation(len(drives))][: int(random.integers(5, 13))]
    times = int(random.integers(2, 4))
    drives = [each for each in drives for _ in range(times)]
    speed = [(1e-3 + 0.3 * p) * (1.0 + 0.01 * random.standard_normal()) for _, _, p in drives]
    columns = [
        Written("mode", "", [mode for mode, *_ in drives]),
        told(random, how, "frequency", "Hz", [f for _, f, _ in drives]),
        told(random, how, "peak", "T", [p for *_, p in drives]),
        told(random, how, "velocity", "m/s", speed),
    ]
    if random.random() < 0.4:
        columns.insert(0, Written("trial", "", [str(1 + k % times) for k in range(len(drives))]))
    _write(path, laid(random, how, spoiled(random, how, columns)))
    data, notes = read_velocity(read_table(path, velocities()), SCENARIO, math.nan)
    found = [
        (c["drive.mode"], c["drive.frequency"], c["drive.peak"], v)
        for c, v in zip([data.conditions[k] for k in data.condition], data.velocity, strict=True)
    ]
    left = [(*drive, v) for drive, v in zip(drives, speed, strict=True)]
    for mode, *numbers in found:
        match = next((each for each in left if each[0] == mode and np.allclose(
            each[1:], numbers, rtol=CLOSE, atol=0.0)), None)  # fmt: skip
        if match is None:
            return "WRONG"
        left.remove(match)
    return _judged(not left, [note.code for note in notes])


def of_films(random: Random, how: str, path: Path) -> str:
    """Frames of a robot that walks."""
    rate, end = float(random.choice([200.0, 500.0, 1000.0])), SCENARIO.window[1]
    t = np.arange(0.0, 1.05 * end, 1.0 / rate)
    x = 1e-4 + 3e-3 * t + 5e-7 * random.standard_normal(len(t))
    theta = 0.3 * np.abs(np.sin(30.0 * math.pi * t)) + 5e-3 * random.standard_normal(len(t))
    columns = [told(random, how, "t", "s", t.tolist()), told(random, how, "x", "m", x.tolist()),
               told(random, how, "theta", "rad", theta.tolist())]  # fmt: skip
    _write(path, laid(random, how, spoiled(random, how, columns)))
    run, notes = read_tracking(path, {}, SCENARIO)
    if run is None:
        return "refused"
    walking = run.columns["t"] >= 0.0
    rows = np.rint(run.columns["t"][walking] * rate).astype(int)
    for name, truth in (("t", t), ("x", x), ("theta", theta)):
        away = run.columns[name][walking] - truth[np.minimum(rows, len(t) - 1)]
        if np.max(np.abs(away)) > 5e-3 * float(np.ptp(truth)):
            return "WRONG"
    whole = len(rows) >= np.sum(t < end - 1e-6)
    return _judged(
        whole, {note.code for note in notes} - ({"frames-after-drive"} if whole else set())
    )


def of_maps(random: Random, how: str, path: Path) -> str:
    """The field of five coils on a grid."""
    coils = Coils(random.uniform(0.05, 0.2, 5), random.uniform(0.05, 0.12, 5),
                  random.uniform(50, 800, 5))  # fmt: skip
    half = random.uniform(3e-3, 9e-3, 3)
    axes = [np.linspace(-each, each, int(random.integers(3, 5))) for each in half]
    places = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
    fields = np.stack([coils.field(places, one) for one in np.eye(5)], axis=1)
    names = [name for _ in places for name in COIL_NAMES]
    five = np.repeat(places, 5, axis=0)
    flat = fields.reshape(-1, 3)
    columns = [told(random, how, name, "m", five[:, k].tolist()) for k, name in enumerate("xyz")]
    columns.append(Written("coil", "", names))
    columns += [told(random, how, name, "T/A", flat[:, k].tolist())
                for k, name in enumerate(("Bx", "By", "Bz"))]  # fmt: skip
    if how == "twice":  # of a map: two columns in each other's place
        one, two = random.choice([0, 1, 2, 4, 5, 6], 2, replace=False)
        cells = [columns[one].cells, columns[two].cells]
        columns[one], columns[two] = (columns[one]._replace(cells=cells[1]),
                                      columns[two]._replace(cells=cells[0]))  # fmt: skip
    columns = columns if how == "twice" else spoiled(random, how, columns)
    _write(path, laid(random, how, columns))
    found = FieldMap.from_file(path)
    if not np.allclose([*found.low, *found.high], [*-half, *half], rtol=1e-3):
        return "WRONG"
    own = Coils.of(Scenario(coil=Coil(map=found)))
    at = random.uniform(-0.8, 0.8, (8, 3)) * half
    for one in np.eye(5):
        truth = coils.field(at, one)
        seen = np.array([own.field(place, one) for place in at])
        if np.max(np.abs(seen - truth)) > 0.03 * np.max(np.abs(truth)):
            return "WRONG"
    return "right"


def _judged(whole: bool, codes: Sequence[str] | set[str]) -> str:
    """Whether a table of right numbers is whole, or a note tells what is not there."""
    told_of = {*codes} - {"converted", "columns-not-used"}
    return "noted" if told_of else "right" if whole else "WRONG"


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="")


TABLES: dict[str, Callable[[Random, str, Path], str]] = {
    "velocities": of_velocities, "film": of_films, "map": of_maps,
}  # fmt: skip


def outcome(seed: int, folder: Path) -> tuple[str, str]:
    """The kind of a drawn table, and ``right``, ``noted``, ``refused`` or ``WRONG``."""
    random = np.random.default_rng([seed, 80])
    table, how = str(random.choice(list(TABLES))), str(random.choice(HOW))
    try:
        what = TABLES[table](random, how, folder / "table.csv")
    except ScenarioError:
        what = "refused"
    return f"{table}, {how}", what
