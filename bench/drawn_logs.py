"""Drawn logs and tables with a known truth, and what the reader makes of each.

Half of them are of names, units and cells as the pages say; the others are written line by line as
loggers, oscilloscopes, spreadsheets and controllers do, by code that shares nothing with readers.
``python -m bench drawn --first 0 --count 2000`` counts all by kind, with as many tables of
`drawn_tables`.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import drawn_tables
import numpy as np
from scores import interval

from stickslip import ScenarioError, models

OUTCOMES = "right", "noted", "refused", "WRONG"
JOINT = models.joint(inertia=0.1, viscous=0.2)
TURNS, RADIANS = 60.0 / (2.0 * np.pi), 180.0 / np.pi
Truth = dict[str, np.ndarray]
Writer = Callable[[np.random.Generator, Truth], str]


def truth(random: np.random.Generator) -> Truth:
    """Times, s, torques, N m, and speeds, rad/s, of a joint."""
    n, step = int(random.integers(60, 200)), float(random.choice([0.005, 0.01, 0.02, 0.1]))
    t = step * np.arange(n)
    torque = np.where(np.sin(random.uniform(1.0, 5.0) * t) > 0.0, 0.5, -0.5)
    speed = np.cumsum(torque) * step / 0.1 + 0.01 * random.standard_normal(n)
    return {"t": t, "torque": torque, "speed": speed}


# -------------------------------------------------------------------------- as the pages say
NAMES = {"t": ("t", "time", "Time", "timestamp"), "torque": ("torque", "Torque", "TORQUE"),
         "speed": ("speed", "Speed", "SPEED")}  # fmt: skip
UNITS = {
    "t": {"s": 1.0, "ms": 1e3, "us": 1e6, "min": 1 / 60, "sec": 1.0, "seconds": 1.0, "h": 1 / 3600},
    "torque": {"N m": 1.0, "Nm": 1.0, "mN m": 1e3, "Ncm": 1e2, "N·m": 1.0, "kgf cm": 1e2 / 9.80665},
    "speed": {"rad/s": 1.0, "rpm": TURNS, "deg/s": RADIANS, "r/min": TURNS, "rev/s": TURNS / 60},
}
FORMS = ("{} ({})", "{} [{}]", "{} / {}")


def stated(random: np.random.Generator, of: Truth) -> tuple[str, str]:
    """A log of names and units, and the kind that it is."""
    kind = str(random.choice(["units", "no units", "wrong unit", "error", "gap", "twice"]))
    order = random.permutation(list(of))
    separator = str(random.choice([",", ";", "\t"]))
    heads, cells = [], []
    for name in order:
        unit, per = list(UNITS[name].items())[random.integers(len(UNITS[name]))]
        if kind == "no units":
            unit, per = "", 1.0
        head = str(random.choice(NAMES[name]))
        heads.append(str(random.choice(FORMS)).format(head, unit) if unit else head)
        values = of[name] * per
        cells.append([f"{each:.12g}" for each in values])
    if kind == "wrong unit":
        heads[int(random.integers(3))] = f"{random.choice(list(NAMES))} (kg)"
    if kind == "error":
        heads.append("error")
        cells.append([f"{each:.4g}" for each in 0.3 + random.random(len(of["t"]))])
    if kind == "gap":
        place = list(order).index("speed")
        cells[place][len(of["t"]) // 2] = str(random.choice(["", "nan", "-9999", "ERR", "<0.1"]))
    if kind == "twice":
        heads.append("speed actual (rad/s)")
        cells.append([f"{each:.6g}" for each in of["speed"] + 1.0])
    rows = [separator.join(row) for row in zip(*cells, strict=True)]
    return "\n".join([separator.join(heads), *rows]) + "\n", f"stated, {kind}"


# --------------------------------------------------------------------- as instruments write
def _oscilloscope(random: np.random.Generator, of: Truth) -> str:
    head = (f"Model,DSO{random.integers(1000, 9999)}\r\nRecord Length,{len(of['t'])}\r\n"
            "Vertical Units,V,V\r\n\r\nTime,Torque,Speed\r\n(ms),(mN m),(rpm)\r\n")  # fmt: skip
    return head + "".join(
        f"{1e3 * a:.6f},{1e3 * b:.5e},{c * TURNS:.6e}\r\n" for a, b, c in _rows(of)
    )


def _spreadsheet(random: np.random.Generator, of: Truth) -> str:
    lines = ["sep=;", "Zeit;;", '"time (s)";"torque (Nm)";"speed (rad/s)"']
    lines += [f"{a:.4f};{b:.4f};{c:.6f}".replace(".", ",") for a, b, c in _rows(of)]
    return "\ufeff" + "\r\n".join(lines) + "\r\n"


def _logger(random: np.random.Generator, of: Truth) -> str:
    begin = datetime(2026, int(random.integers(1, 13)), int(random.integers(1, 28)), 10, 0, 0)
    lines = [f"# Logger {random.integers(99)}", "# Interval: as set", ""]
    lines.append("datetime,speed (deg/s),torque (Ncm)")
    lines += [f"{(begin + timedelta(seconds=float(a))).isoformat(sep=' ', timespec='microseconds')}"
              f",{c * RADIANS:.7g},{b * 100:.6g}" for a, b, c in _rows(of)]  # fmt: skip
    return "\n".join(lines) + "\n"


def _controller(random: np.random.Generator, of: Truth) -> str:
    """Whole microseconds, tab-separated, with a set point."""
    first = int(random.integers(2**31, 2**32))
    lines = ["time_us\ttorque_Nm\tspeed_rpm\tsetpoint_rpm"]
    lines += [f"{first + round(1e6 * a)}\t{b:.6f}\t{c * TURNS:.6f}\t{c * TURNS + 9:.3f}"
              for a, b, c in _rows(of)]  # fmt: skip
    return "\n".join(lines) + "\n"


def _plc(random: np.random.Generator, of: Truth) -> str:
    """Clocks past midnight."""
    begin = datetime(2026, 3, 3, 23, 59, 59) - timedelta(seconds=float(of["t"][-1]) / 2)
    lines = ["Clock;Speed [1/min];Torque [Nm];ok"]
    lines += [f"{(begin + timedelta(seconds=float(a))).time().isoformat('microseconds')};"
              f"{c * TURNS:.6f};{b:.5f};{0 if k == 7 else 1}"
              for k, (a, b, c) in enumerate(_rows(of))]  # fmt: skip
    return "\r\n".join(lines)


def _arduino(random: np.random.Generator, of: Truth) -> str:
    """``micros()``, ``millis()`` or seconds without a word on it."""
    size = float(random.choice([1.0, 1e3, 1e6]))
    lines = ["time,torque,speed"]
    lines += [f"{round(size * a) if size > 1 else a},{b:.3f},{c:.5f}" for a, b, c in _rows(of)]
    return "\n".join(lines) + "\n"


def _unix(random: np.random.Generator, of: Truth) -> str:
    power = int(random.integers(4))
    first = 1_790_000_000 + int(random.integers(10**6))
    unit = ("s", "ms", "us", "ns")[power]
    lines = [f"timestamp ({unit}),torque (N m),speed (rad/s),error"]
    for a, b, c in _rows(of):
        stamp = (
            f"{first + a:.6f}" if power == 0 else f"{first * 1000**power + round(a * 1e3**power)}"
        )
        lines.append(f"{stamp},{b:.4f},{c:.6f},{0.3 - c:.4f}")
    return "\n".join(lines) + "\n"


def _plain(head: str, row: Callable[[float, float, float], str]) -> Writer:
    """Rows of time, torque and speed below a heading."""
    return lambda random, of: "\n".join([head, *(row(*each) for each in _rows(of))]) + "\n"


WRITERS: dict[str, Writer] = {
    "oscilloscope": _oscilloscope, "spreadsheet": _spreadsheet, "logger": _logger,
    "controller": _controller, "plc": _plc,
    # Speeds of 16 bits, in tenths of rpm, without a sign.
    "encoder": _plain("t [s],torque [N m],speed [rpm]", lambda a, b, c:
                      f"{a:.4f},{b:.4f},{(round(c * TURNS * 10) % 65536) / 10:.1f}"),
    "arduino": _arduino, "unix": _unix,
    "days": _plain("Date (d),Torque (Nm),Speed (rad/s)", lambda a, b, c:
                   f"{46143.4 + a / 86400:.12f},{b:.4f},{c:.6f}"),
    "stopwatch": _plain("time (mm:ss),torque (N m),speed (rad/s)", lambda a, b, c:
                        f"{int(60 + a) // 60:02}:{(60 + a) % 60:07.4f},{b:.4f},{c:.6f}"),
}  # fmt: skip


def _rows(of: Truth) -> list[tuple[float, float, float]]:
    return list(zip(of["t"].tolist(), of["torque"].tolist(), of["speed"].tolist(), strict=True))


def outcome(seed: int, folder: Path) -> tuple[str, str]:
    """The kind of a drawn log, and ``right``, ``noted``, ``refused`` or ``WRONG``."""
    random = np.random.default_rng([seed, 79])
    of = truth(random)
    if seed % 2:
        text, kind = stated(random, of)
    else:
        name = str(random.choice(list(WRITERS)))
        text, kind = WRITERS[name](random, of), f"instrument, {name}"
    path = folder / "log.csv"
    path.write_text(text, encoding="utf-8", newline="")
    try:
        log = models.read_log(path, JOINT)
    except ScenarioError:
        return kind, "refused"
    expected = {name: values[log.rows] for name, values in of.items()}
    found = {"t": log.t - log.t[0] + expected["t"][0], "torque": log.inputs.get("torque"),
             "speed": log.y}  # fmt: skip
    for name, values in found.items():
        size = float(np.ptp(expected[name]))
        if values is None or np.max(np.abs(values - expected[name])) > 5e-3 * size:
            return kind, "WRONG"
    told = {note.code for note in log.own_notes} - {"converted"}
    return kind, "noted" if told else "right"


Outcome = Callable[[int, Path], tuple[str, str]]


def counts(seeds: range, of: Outcome = outcome) -> Counter[tuple[str, str]]:
    """Drawn logs, or tables, by kind and outcome."""
    with tempfile.TemporaryDirectory() as folder:
        return Counter(of(seed, Path(folder)) for seed in seeds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--count", type=int, default=2000, help="of logs, and of tables")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.count)
    for of in (outcome, drawn_tables.outcome):
        found = counts(seeds, of)
        for (kind, what), count in sorted(found.items()):
            print(f"{kind:32}{what:10}{count:6}")
        for what in OUTCOMES:
            count = sum(number for (_, each), number in found.items() if each == what)
            low, high = interval(count, options.count)
            print(f"{what:10}{count:6} of {options.count} ({low:.2%} to {high:.2%})")


if __name__ == "__main__":
    main()
