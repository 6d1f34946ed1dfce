"""Draw tables and logs with a known truth, written as people and instruments write them.

A table is a list of columns, each with its name, its unit and its numbers in SI. Laboratories and
programs change how it is written: other names and units, a preamble, a row of units, commas for
points, an index, one more column, gaps and sums below. Other logs are written line by line
as oscilloscopes, spreadsheets and controllers do. None of this shares code with a reader.
``python -m bench drawn --first 0 --count 4000`` counts what the readers make of them.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scores import interval

from stickslip import COIL_NAMES, Coil, Coils, FieldMap, Scenario, ScenarioError, models
from stickslip._util.columns import read_table
from stickslip._util.note import Note
from stickslip.walker.read_tracking import read_tracking
from stickslip.walker.read_velocity import read_velocity, velocities

Random = np.random.Generator
Numbers = np.ndarray
OUTCOMES = "right", "noted", "refused", "WRONG"
SCENARIO = Scenario().replace({"drive.base": 0.5e-3, "drive.frequency": 30.0, "drive.pulses": 12})
JOINT = models.joint(inertia=0.1, viscous=0.2)
CLOSE = 5e-3  # of the range of a column; an encoder writes no more digits
QUIET = {"converted", "columns-not-used", "frames-after-drive"}
"""Codes of notes that leave nothing out."""


class Written(NamedTuple):
    """A column: its name, the unit in its heading if there is one, and its cells."""

    name: str
    unit: str
    cells: list[str]


# ------------------------------------------------------------------------------- names and units
RPM, DEGREE = 30.0 / math.pi, 180.0 / math.pi
UNITS = {
    "Hz": {"Hz": 1.0, "kHz": 1e-3, "1/s": 1.0, "hertz": 1.0, "mHz": 1e3},
    "T": {"T": 1.0, "mT": 1e3, "G": 1e4, "µT": 1e6, "Gauss": 1e4, "gauss": 1e4, "kG": 10.0},
    "m/s": {"m/s": 1.0, "mm/s": 1e3, "um/s": 1e6, "µm/s": 1e6, "mm s^-1": 1e3, "cm/s": 100.0,
            "mm/min": 6e4, "m s-1": 1.0},
    "s": {"s": 1.0, "ms": 1e3, "sec": 1.0, "us": 1e6, "min": 1 / 60, "seconds": 1.0, "h": 1 / 3600},
    "m": {"m": 1.0, "mm": 1e3, "um": 1e6, "µm": 1e6, "cm": 100.0, "inch": 1 / 0.0254},
    "rad": {"rad": 1.0, "deg": DEGREE, "°": DEGREE, "mrad": 1e3, "degrees": DEGREE},
    "T/A": {"T/A": 1.0, "mT/A": 1e3, "G/A": 1e4, "gauss/A": 1e4, "µT/A": 1e6, "mT A^-1": 1e3},
    "N m": {"N m": 1.0, "Nm": 1.0, "mN m": 1e3, "Ncm": 1e2, "N·m": 1.0, "kgf cm": 1e2 / 9.80665},
    "rad/s": {"rad/s": 1.0, "rpm": RPM, "deg/s": DEGREE, "r/min": RPM, "rev/s": RPM / 60},
}  # fmt: skip
"""Units as they are written, and how many are one SI unit."""
WRONG = {
    "frequency": ("rpm", "rad/s", "pulses/min"), "peak": ("A", "V", "A/m"),
    "velocity": ("mm", "BL/s"), "t": ("frames", "px", "kg"), "x": ("px", "s", "BL"),
    "theta": ("px", "T"), "Bx": ("T", "mT", "A/m"), "Bz": ("G", "V"),
}  # fmt: skip
"""Units that are none of the quantity, or not known; of other columns kg and px."""
NAMES = {
    "frequency": ("Frequency", "freq", "f", "Pulse frequency", "rate", "Freq.", "drive.frequency"),
    "peak": ("Peak", "amplitude", "B", "Bpeak", "B_max", "field", "Peak field", "drive.peak",
             "Flux density", "coil field", "b peak"),
    "mode": ("Mode", "drive.mode", "plane", "type", "gait"),
    "velocity": ("Velocity", "speed", "v", "mean velocity", "v_mean", "vel"),
    "t": ("Time", "time", "frame", "T", "timestamp"), "x": ("X", "x position", "pos", "x_c"),
    "theta": ("Theta", "angle", "tilt", "phi"), "coil": ("Coil", "channel", "source"),
    "Bx": ("BX", "bx", "B_x", "x-field"), "y": ("Y", "posY"), "Bz": ("B_z", "bz", "z-field"),
    "torque": ("Torque", "TORQUE", "tau"), "speed": ("Speed", "SPEED", "omega"),
}  # fmt: skip
"""Other names of columns that people and programs use."""
FORMS = (
    "{} ({})", "{} [{}]", "{} / {}", "{}[{}]", "{}({})", "{}, {}", "{}_{}", "{} in {}", "{} {}",
)  # fmt: skip
GAPS = ("", "nan", "NaN", "-", "n/a", "ERR", "#DIV/0!", "--", "OL", "---", "NULL", "inf",
        "1.23(4)", "<0.1")  # fmt: skip
"""What loggers and people write where there is no reading."""
MORE = (
    ("temperature", "degC", 21.0, 0.1), ("battery", "V", 3.7, 0.01), ("quality", "", 0.9, 0.01),
    ("humidity", "%", 41.0, 0.5), ("comment", "", None, 0.0), ("operator", "", None, 0.0),
)  # fmt: skip
"""Columns that no reader needs: name, unit, mean and spread."""
HOW = ("plain", "no units", "wrong unit", "other name", "decimal commas",
       "row of units", "preamble", "comments", "three rows of heads", "index", "empty columns",
       "head again", "sums below", "thousands", "cut off", "separator line", "savetxt",
       "one more column", "gap", "unit in a cell", "twice", "shuffled")  # fmt: skip


def draw_columns(random: Random, how: str, si: dict[str, str], true: Numbers) -> list[Written]:
    """Write columns, (n, k), by name and SI unit, each in some unit that its heading may state."""
    columns = []
    for (name, unit), values in zip(si.items(), true.T.tolist(), strict=True):
        units, bare = UNITS[unit], how == "unstated" and random.random() < 0.5
        is_si = how == "no units" or random.random() < 0.2
        if not is_si or bare:
            some = [each for each in units if not bare or not 0.5 < units[each] < 2.0]
            unit = str(random.choice(some))
        bare = bare or how == "no units" or (is_si and random.random() < 0.3)
        cells = [f"{value * units[unit]:.9g}" for value in values]
        columns.append(Written(name, "" if bare else unit, cells))
    return columns


# ---------------------------------------------------------------------------- a table and its file
def spoil(random: Random, how: str, columns: list[Written]) -> list[Written]:
    """Change names and cells of columns."""
    columns = [Written(n, u, list(c)) for n, u, c in columns]
    k = int(random.choice([k for k, each in enumerate(columns) if _is_number(each.cells[0])]))
    name, unit, cells = columns[k]
    if how == "wrong unit":
        columns[k] = Written(name, str(random.choice(WRONG.get(name, ("kg", "px")))), cells)
    elif how == "other name":
        k = int(random.choice([i for i, each in enumerate(columns) if each.name in NAMES]))
        columns[k] = columns[k]._replace(name=str(random.choice(NAMES[columns[k].name])))
    elif how == "gap":
        for at in random.integers(len(cells), size=int(random.integers(1, 3))).tolist():
            cells[at] = str(random.choice(GAPS))
    elif how == "unit in a cell":
        columns[k] = columns[k]._replace(cells=[f"{cell} {unit or 'mm'}" for cell in cells])
    elif how == "twice":
        columns.append(Written(name, unit, [f"{1.01 * float(cell):.6g}" for cell in cells]))
    elif how == "one more column":
        label, of, middle, spread = MORE[int(random.integers(len(MORE)))]
        made = ["ok, as before" if middle is None else f"{middle + spread * each:.3f}"
                for each in random.standard_normal(len(cells))]  # fmt: skip
        columns.insert(int(random.integers(len(columns) + 1)), Written(label, of, made))
    elif how == "shuffled":
        order = random.permutation(len(cells))
        columns = [Written(n, u, [c[at] for at in order]) for n, u, c in columns]
    return columns


def write(random: Random, how: str, columns: list[Written], path: Path) -> None:
    """Write a file of columns with a layout."""
    separator = str(random.choice([";", "\t"] if how == "decimal commas" else [",", ";", "\t"]))
    form, bracket = str(random.choice(FORMS)), str(random.choice(["{}", "({})", "[{}]"]))
    units_below = how in ("row of units", "three rows of heads")
    heads = [form.format(n, u) if u and not units_below else n for n, u, _ in columns]
    rows = [list(row) for row in zip(*(cells for *_, cells in columns), strict=True)]
    logger = [f"Gaussmeter GM-08 s/n {random.integers(9999)}", f"Date{separator}2026-05-01", "",
              f"Operator{separator}A. N."][: int(random.integers(1, 5))]  # fmt: skip
    above = {"preamble": logger, "comments": ["# made by a script, v1.2", "# seed = 7"],
             "separator line": [f"sep={separator}"]}.get(how, [])  # fmt: skip
    if how == "decimal commas":
        rows = [[c.replace(".", ",") if _is_number(c) else c for c in row] for row in rows]
    elif how == "index":
        heads, rows = ["", *heads], [[str(k), *row] for k, row in enumerate(rows)]
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
    elif how == "savetxt":
        heads[0] = f"# {heads[0]}"
    elif how == "three rows of heads":  # as plotting programs export: names, units, remarks
        rows.insert(0, ["first day", *[""] * (len(columns) - 1)])
        bracket = "{}"
    if units_below:
        rows.insert(0, [bracket.format(u) if u else "" for _, u, _ in columns])
    lines = [separator.join(f'"{c}"' if separator in c else c for c in row)
             for row in (heads, *rows)]  # fmt: skip
    _write_lines(random, [*above, *lines], path)


def _write_lines(random: Random, lines: Sequence[str], path: Path) -> None:
    end, mark = str(random.choice(["\n", "\r\n"])), "\ufeff" if random.random() < 0.2 else ""
    path.write_text(mark + "\n".join(lines) + "\n", encoding="utf-8", newline=end)


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


# ----------------------------------------------------------------------------- readers and truths
def judge(found: Numbers, true: Numbers, rows: Numbers, notes: Sequence[Note], fewest: int) -> str:
    """Compare columns that were read, (n, k), with those `rows` of the truth, (m, k).

    Fewer rows than `fewest` need a note.
    """
    size = np.ptp(true, axis=0)
    size[size == 0.0] = np.max(np.abs(true), axis=0)[size == 0.0]
    if not np.all(np.abs(found - true[rows]) <= CLOSE * size) or len({*rows.tolist()}) < len(found):
        return "WRONG"
    noted = {note.code for note in notes} - QUIET
    return "noted" if noted else "right" if len(found) >= fewest else "WRONG"


def of_velocities(random: Random, how: str, path: Path) -> str:
    """Write and read trials of drives with a mode, a frequency and a field."""
    modes = "IPP", "OPP"
    drives = np.array([(mode, f, p) for mode in (0, 1) for f in (20.0, 35.0)
                       for p in (2.0e-3, 2.5e-3, 3.0e-3)])  # fmt: skip
    times = int(random.integers(2, 4))
    drives = random.permutation(drives)[: int(random.integers(5, 13))].repeat(times, axis=0)
    speed = (1e-3 + 0.3 * drives[:, 2]) * (1.0 + 0.01 * random.standard_normal(len(drives)))
    true = np.column_stack([drives, speed])
    columns = [Written("mode", "", [modes[int(mode)] for mode in true[:, 0]])]
    units = {"frequency": "Hz", "peak": "T", "velocity": "m/s"}
    columns += draw_columns(random, how, units, true[:, 1:])
    if random.random() < 0.4:
        columns.insert(0, Written("trial", "", [str(1 + k % times) for k in range(len(drives))]))
    write(random, how, spoil(random, how, columns), path)
    data, notes = read_velocity(read_table(path, velocities()), SCENARIO, math.nan)
    conditions = [data.conditions[k] for k in data.condition]
    found = np.array([(modes.index(c["drive.mode"]), c["drive.frequency"], c["drive.peak"], v)
                      for c, v in zip(conditions, data.velocity, strict=True)])  # fmt: skip
    away = np.abs(found[:, None] - true) / (np.ptp(true, axis=0) + 1e-9)
    return judge(found, true, away.max(axis=2).argmin(axis=1), notes, len(true))


def of_films(random: Random, how: str, path: Path) -> str:
    """Write and read frames of a robot that walks."""
    rate, end = float(random.choice([200.0, 500.0, 1000.0])), SCENARIO.window[1]
    t = np.arange(0.0, 1.05 * end, 1.0 / rate)
    x = 1e-4 + 3e-3 * t + 5e-7 * random.standard_normal(len(t))
    theta = 0.3 * np.abs(np.sin(30.0 * math.pi * t)) + 5e-3 * random.standard_normal(len(t))
    true, units = np.column_stack([t, x, theta]), {"t": "s", "x": "m", "theta": "rad"}
    columns = draw_columns(random, how, units, true)
    write(random, how, spoil(random, how, columns), path)
    run, notes = read_tracking(path, {}, SCENARIO)
    if run is None:
        return "refused"
    found = np.column_stack([run.columns[name] for name in units])
    rows = np.clip(np.rint(found[:, 0] * rate).astype(int), 0, len(t) - 1)
    return judge(found, true, rows, notes, int(np.sum(t < end - 1e-6)))


def of_maps(random: Random, how: str, path: Path) -> str:
    """Write and read the field of five coils on a grid."""
    coils = Coils(random.uniform(0.05, 0.2, 5), random.uniform(0.05, 0.12, 5),
                  random.uniform(50, 800, 5))  # fmt: skip
    half = random.uniform(3e-3, 9e-3, 3)
    axes = [np.linspace(-each, each, int(random.integers(3, 5))) for each in half]
    places = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
    fields = np.stack([coils.field(places, one) for one in np.eye(5)], axis=1).reshape(-1, 3)
    columns = draw_columns(random, how, dict.fromkeys("xyz", "m"), places.repeat(5, axis=0))
    columns.append(Written("coil", "", list(COIL_NAMES) * len(places)))
    columns += draw_columns(random, how, dict.fromkeys(("Bx", "By", "Bz"), "T/A"), fields)
    if how == "twice":  # of a map: two columns in each other's place
        one, two = (columns[k].cells for k in random.choice([0, 1, 2, 4, 5, 6], 2, replace=False))
        one[:], two[:] = two[:], one[:]
    write(random, how, columns if how == "twice" else spoil(random, how, columns), path)
    found = FieldMap.from_file(path)
    own, at = Coils.of(Scenario(coil=Coil(map=found))), random.uniform(-0.8, 0.8, (8, 3)) * half
    seen, true = (np.array([each.field(at, one).ravel() for one in np.eye(5)])
                  for each in (own, coils))  # fmt: skip
    away = np.max(np.abs(seen - true), axis=1) / np.max(np.abs(true), axis=1)
    box = np.allclose([*found.low, *found.high], [*-half, *half], rtol=1e-3)
    return "right" if box and np.max(away) <= 0.03 else "WRONG"


def of_logs(random: Random, how: str, path: Path) -> str:
    """Write and read a log of a joint."""
    true = _draw_log(random)
    columns = draw_columns(random, how, {"t": "s", "torque": "N m", "speed": "rad/s"}, true)
    if how == "error":  # of a controller
        columns.append(Written("error", "", [f"{x:.4g}" for x in 0.3 + random.random(len(true))]))
    elif how == "actual":
        columns.append(Written("speed actual", "rad/s", [f"{x + 1:.6g}" for x in true[:, 2]]))
    columns = [columns[k] for k in random.permutation(len(columns))]
    write(random, how, spoil(random, how, columns), path)
    return _judge_log(path, true, None if how == "unstated" else "si")


def _draw_log(random: Random) -> Numbers:
    """Times, s, torques, N m, and speeds, rad/s, of a joint, shape (n, 3)."""
    n, step = int(random.integers(60, 200)), float(random.choice([0.005, 0.01, 0.02, 0.1]))
    t = step * np.arange(n)
    torque = np.where(np.sin(random.uniform(1.0, 5.0) * t) > 0.0, 0.5, -0.5)
    speed = np.cumsum(torque) * step / 0.1 + 0.01 * random.standard_normal(n)
    return np.column_stack([t, torque, speed])


def _judge_log(path: Path, true: Numbers, units: str | None = None) -> str:
    """Read a log; its clock may begin at any time."""
    log = models.read_log(path, JOINT, units)
    t = log.t - log.t[0] + true[log.rows[0], 0]
    found = np.column_stack([t, log.inputs.get("torque", math.nan * log.y), log.y])
    return judge(found, true, log.rows, log.own_notes, len(true))


# --------------------------------------------------------------------- logs as instruments write
Row = Callable[[float, float, float], str]


def instruments(random: Random) -> dict[str, tuple[str, Row]]:
    """Headings, and lines of a time t, s, a torque m, N m, and a speed w, rad/s."""
    number = int(random.integers(60, 200))
    day = datetime(2026, int(random.integers(1, 13)), int(random.integers(1, 28)), 10)
    evening = datetime(2026, 3, 3, 23, 59, 59, int(random.integers(750_000, 10**6)))
    counter, epoch = int(random.integers(2**31, 2**32)), 1_790_000_000 + int(random.integers(10**6))
    size, unit = list({1: "s", 10**3: "ms", 10**6: "us", 10**9: "ns"}.items())[random.integers(4)]

    def counted(t: float, first: int = 0) -> str:
        return f"{first + t:.6f}" if size == 1 else f"{first * size + round(t * size)}"

    def stamp(first: datetime, t: float) -> str:
        return (first + timedelta(seconds=t)).isoformat(" ", "microseconds")

    return {
        "oscilloscope": (
            f"Model,DSO{number}\nRecord Length,{number}\nVertical Units,V,V\n\nTime,Torque,Speed\n"
            "(ms),(mN m),(rpm)",
            lambda t, m, w: f"{1e3 * t:.6f},{1e3 * m:.5e},{w * RPM:.6e}"),
        "spreadsheet": (
            'sep=;\nZeit;;\n"time (s)";"torque (Nm)";"speed (rad/s)"',
            lambda t, m, w: f"{t:.4f};{m:.4f};{w:.6f}".replace(".", ",")),
        "logger": (
            f"# Logger {number}\n# Interval: as set\n\ndatetime,speed (deg/s),torque (Ncm)",
            lambda t, m, w: f"{stamp(day, t)},{w * DEGREE:.7g},{m * 100:.6g}"),
        "controller": (  # with a set point
            "time_us\ttorque_Nm\tspeed_rpm\tsetpoint_rpm",
            lambda t, m, w: f"{counter + round(1e6 * t)}\t{m:.6f}\t{w * RPM:.6f}"
                            f"\t{w * RPM + 9:.3f}"),
        "plc": (  # past midnight; the reading at 0.1 s is not valid
            "Clock;Speed [1/min];Torque [Nm];ok",
            lambda t, m, w: f"{stamp(evening, t)[11:]};{w * RPM:.6f};{m:.5f};{int(t != 0.1)}"),
        "encoder": (  # 16 bits, in tenths of rpm, without a sign
            "t [s],torque [N m],speed [rpm]",
            lambda t, m, w: f"{t:.4f},{m:.4f},{round(w * RPM * 10) % 65536 / 10:.1f}"),
        "arduino": (  # seconds, millis(), micros() or ns without a word on it
            "time,torque,speed", lambda t, m, w: f"{counted(t)},{m:.3f},{w:.5f}"),
        "unix": (
            f"timestamp ({unit}),torque (N m),speed (rad/s),error",
            lambda t, m, w: f"{counted(t, epoch)},{m:.4f},{w:.6f},{0.3 - w:.4f}"),
        "days": (
            "Date (d),Torque (Nm),Speed (rad/s)",
            lambda t, m, w: f"{46143.4 + t / 86400:.12f},{m:.4f},{w:.6f}"),
        "stopwatch": (
            "time (mm:ss),torque (N m),speed (rad/s)",
            lambda t, m, w: f"{int(60 + t) // 60:02}:{(60 + t) % 60:07.4f},{m:.4f},{w:.6f}"),
    }  # fmt: skip


def of_instruments(random: Random, how: str, path: Path) -> str:
    """Write and read a log of an instrument."""
    true = _draw_log(random)
    head, row = instruments(random)[how]
    _write_lines(random, [head, *(row(*each) for each in true.tolist())], path)
    return _judge_log(path, true)


# ----------------------------------------------------------------------------------------- counts
TABLES: dict[str, tuple[Callable[[Random, str, Path], str], Sequence[str]]] = {
    "velocities": (of_velocities, HOW), "film": (of_films, HOW), "map": (of_maps, HOW),
    "log": (of_logs, (*HOW, "unstated", "error", "actual")),
    "instrument": (of_instruments, tuple(instruments(np.random.default_rng(0)))),
}  # fmt: skip


def outcome(seed: int, folder: Path) -> tuple[str, str]:
    """Return the kind of a drawn table and its outcome, one of `OUTCOMES`."""
    random = np.random.default_rng([seed, 80])
    table = str(random.choice(list(TABLES)))
    read, ways = TABLES[table]
    how = str(random.choice(ways))
    try:
        what = read(random, how, folder / "table.csv")
    except ScenarioError:
        what = "refused"
    return f"{table}, {how}", what


def counts(seeds: range) -> Counter[tuple[str, str]]:
    """Count drawn tables by kind and outcome."""
    with tempfile.TemporaryDirectory() as folder:
        return Counter(outcome(seed, Path(folder)) for seed in seeds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--count", type=int, default=4000, help="of tables")
    options = parser.parse_args()
    found = counts(range(options.first, options.first + options.count))
    for (kind, what), count in sorted(found.items()):
        print(f"{kind:32}{what:10}{count:6}")
    for what in OUTCOMES:
        count = sum(number for (_, each), number in found.items() if each == what)
        low, high = interval(count, options.count)
        print(f"{what:10}{count:6} of {options.count} ({low:.2%} to {high:.2%})")


if __name__ == "__main__":
    main()
