"""Refusals of pictures: name, call in an empty folder, error, words."""

import functools
import math

import numpy as np

from measured_maps import formula_fields, grid
from pictures import recorded
from stickslip import COIL_NAMES, Coil, Drive, FieldMap, Scenario, ScenarioError, plot, simulate
from stickslip import sweep as swept

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=5))


@functools.cache
def by_mode():
    return swept(BASE, {"drive.frequency": [20.0, 50.0], "drive.mode": ["IPP", "OPP"]})


def part(**chosen):
    """A part of the sweep, by the last word of a dimension."""
    data = by_mode()
    names = {str(name).rpartition("_")[2]: name for name in data.mean_velocity.dims}
    return data.sel({names[word]: value for word, value in chosen.items()})


def nine_modes():
    data = by_mode()
    mode = data.mean_velocity.dims[1]
    return data.isel({mode: [0] * 9}).assign_coords({mode: list("abcdefghi")})


def twice():
    listed = swept(BASE, [{"drive.frequency": each} for each in (20.0, 50.0)])
    return listed.isel(point=[0, 0, 1])


def without_ym():
    points = grid(count=(3, 3, 3))
    fields = formula_fields(points)
    fields[:, COIL_NAMES.index("ym")] = 0.0
    return Scenario(coil=Coil(map=FieldMap.from_points(points, fields)))


def at_rate(rate):
    return simulate(BASE.replace({"record.rate": rate}))


def without_y():
    fields = "x, z, theta, omega, normal_force, slip_velocity, bx, by, bz, contact"
    keys = {"drive.heading": 0.5, "record.rate": 1e4, "record.fields": fields}
    return simulate(BASE.replace(keys))


def saved(name):
    return lambda folder: plot.save(plot.fields(recorded("walk")), folder / name)


def moved(*stretch, **how):
    return lambda folder: plot.animation(recorded("walk"), *stretch, **how)


def film(*times, **how):
    return lambda folder: plot.filmstrip(recorded("walk"), list(times), **how)


def along(path):
    return lambda folder: plot.path(recorded("a turn"), along=path)


REFUSALS = [
    ("no record", lambda _: plot.run(at_rate("none")), AttributeError, "set record.rate"),
    ("events", lambda _: plot.path(at_rate("events")), ValueError, "set record.rate"),
    ("not all recorded", lambda _: plot.path(without_y()), AttributeError, "did not record y"),
    ("a scenario as run", lambda _: plot.run(BASE), ScenarioError, "allowed is a Run"),
    ("a Dataset as run", lambda _: plot.fields(recorded("walk").to_xarray()), ScenarioError,
     "open_run(path)"),
    ("no samples", lambda _: plot.run(recorded("walk"), 0.2, 0.1), ValueError, "less than two"),
    ("a DataArray", lambda _: plot.velocity(by_mode().mean_velocity), ValueError,
     ["data = ", "what sweep or predict gave"]),
    ("a word as start", lambda _: plot.run(recorded("walk"), start="a"), ValueError,
     'start = "a": allowed is a time, s'),
    ("a word as stop", moved(stop="a"), ValueError, 'stop = "a": allowed is a time, s'),
    ("a word as slowdown", moved(slowdown="slow"), ValueError, 'slowdown = "slow": allowed'),
    ("a word as time", film("a"), ValueError, 'times = "a": allowed is a time, s'),
    ("a number as times", lambda _: plot.filmstrip(recorded("walk"), 0.1), ValueError,
     "times = 0.1: allowed is a list of times"),
    ("a number as labels", film(0.1, labels=3), ValueError, "labels = 3: allowed is one for each"),
    ("a number as axes", lambda _: plot.trajectory(recorded("walk"), ax=3), ValueError,
     "ax = 3: allowed is an Axes"),
    ("a number as axes from above", lambda _: plot.path(recorded("walk"), ax=3), ValueError,
     "ax = 3: allowed is an Axes"),
    ("a number as axes of a film", film(0.1, ax=[3]), ValueError, "ax = 3: allowed is an Axes"),
    ("a word as progress",
     lambda folder: plot.animation(recorded("walk"), 0.1, 0.11).save(folder / "a.gif", "yes"),
     ValueError, 'progress = "yes"'),
    ("a run as figure", lambda folder: plot.save(recorded("walk"), folder / "a.png"), ValueError,
     ["figure = ", "a Figure"]),
    ("no time", film(), ValueError, "a time or more"),
    ("a time outside", film(0.1, 9.0), ValueError, "9.0 s is outside the record"),
    ("labels", film(0.1, 0.2, labels=["a"]), ValueError, "labels has 1 entries: allowed are 2"),
    *(
        ("path", along(path), ScenarioError, "shape (k, 2) of corners, m")
        for path in ("L", [1.0, 2.0], [(0.0, 0.0), (math.nan, 0.0)])
    ),
    ("suffix", saved("a.docx"), ValueError, ".png"),
    ("folder", saved("missing/a.png"), OSError, "no folder"),
    ("moving suffix", lambda folder: moved(0.1, 0.11)(folder).save(folder / "a.png"), ValueError,
     ".gif, .webp, .mp4, .html"),
    ("infinite frames", moved(slowdown=1e308, frames_per_second=1e308), ValueError,
     "at most 2000"),
    *(
        (f"{name} {value}", moved(**{name: value}), ValueError, f"{name} = {value!r}: allowed")
        for name in ("slowdown", "frames_per_second")
        for value in (0.0, -1.0, math.inf, math.nan)
    ),
    ("no sweep", lambda _: plot.velocity(by_mode().drop_vars("mean_velocity")), ValueError,
     "not one of a sweep"),
    ("no velocity", lambda _: plot.velocity(by_mode() * np.nan), ValueError, "no point"),
    ("words alone", lambda _: plot.velocity(part(frequency=20.0)), ValueError, "take a part"),
    ("many lines", lambda _: plot.velocity(nine_modes()), ValueError, "9 lines: allowed are at"),
    ("a point twice", lambda _: plot.velocity(twice()), ValueError, "twice"),
    ("a file as scenario", lambda _: plot.coils("a.toml"), ScenarioError, "a Scenario"),
    *(
        ("currents", lambda _, given=given: plot.coils(BASE, given), ValueError, "five finite")
        for given in ([1.0], [np.nan, 0, 0, 0, 0], "a", [[1.0], [2.0, 3.0]])
    ),
    ("no current", lambda _: plot.coils(Scenario(drive=Drive(peak=0.0, hold=0.0))), ValueError,
     "no coil has a current"),
    ("a coil without field", lambda _: plot.coils(without_ym(), [0, 0, 0, 1, 0]), ValueError,
     "no coil has a current"),
]  # fmt: skip
