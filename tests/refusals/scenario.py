"""Refusals of a scenario, its files, its effects and a field map."""

import ctypes
import inspect
import math
from collections.abc import Mapping

import numpy as np
import pytest
from numba import cfunc

import stickslip
from measured_maps import formula_fields, formula_map, grid, write_csv
from stickslip import (
    Coil,
    Coils,
    Drive,
    EffectParameter,
    FieldMap,
    Scenario,
    ScenarioError,
    Waveform,
    control,
    load,
    register_effect,
)
from stickslip.scenario.scenario import with_uncertain_of

HEAD = "stickslip = 1\n[drive]\n"
CSV = "t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n1,1,0,0,0,0\n"
PROGRAM = HEAD + 'mode = "program"\nfile = "v.csv"\n'
ENDLESS = "1" + "0" * 5000


def named(beginning, read, path):
    """The error of a file, which begins with its name."""
    with pytest.raises(ScenarioError) as refusal:
        read(path)
    assert str(refusal.value).startswith(beginning)
    return str(refusal.value)


def of_file(folder, text):
    """A scenario's file, beside which there are voltages."""
    path = folder / "my scenario.toml"
    if isinstance(text, bytes):
        path.write_bytes(text)
    else:
        path.write_text(text)
    (folder / "v.csv").write_text(CSV)
    return named(f"{path}: ", load, path)


def of_voltages(folder, text):
    """The CSV file of a scenario."""
    (folder / "s.toml").write_text(PROGRAM)
    if text is not None:
        (folder / "v.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    return named(f'{folder / "s.toml"}: drive.file = "v.csv": ', load, folder / "s.toml")


def of_class(_, given):
    """A class of this package by its name, with its arguments."""
    name, arguments = given
    getattr(stickslip, name)(**arguments)


MADE = [
    "Diagnosis",
    "Followed",
    "Film",
    "Optimum",
    "Rollout",
    "Run",
    "ScenarioError",
    "SimulationError",
    "Snapshot",
]
"""Classes that functions make, or nobody."""

PUBLIC = {each: getattr(home, each) for home in (stickslip, control) for each in home.__all__}
KINDS = [kind for name, kind in PUBLIC.items() if inspect.isclass(kind) and name not in MADE]


def wrong_arguments(kind):
    """Arguments that a class does not have, has too many of, or lacks, and words of the refusal."""
    parameters = inspect.signature(kind).parameters
    known = f'known are "{next(iter(parameters))}"'
    yield (kind, (), {"foo": 1}), ["foo = 1: there is no such ", known]
    yield (kind, (None,) * 99, {}), [f"{kind.__name__}: too many positional arguments", known]
    if any(each.default is each.empty for each in parameters.values()):
        yield (kind, (), {}), [f"{kind.__name__}: missing a required ", known]


def of(make, **usual):
    """A way to give a function arguments, beside usual ones."""
    return lambda _, given: make(**{**usual, **given})


def of_waveform(_, given):
    """A constructor of waveforms by its name, with its arguments."""
    name, *arguments = given
    getattr(Waveform, name)(*arguments)


def of_hold(_, given):
    """A method of a waveform of one second."""
    name, argument = given
    getattr(Waveform.hold(1.0, {}), name)(argument)


def of_uncertain_file(folder, text):
    """A file with uncertain parameters."""
    (folder / "u.toml").write_text(text)
    with_uncertain_of(Scenario(), folder / "u.toml")


def of_effect(_, changes):
    """An effect of one's own."""
    given = {"name": "own", "function": lambda *_: None, "parameters": [PARAMETER], "meaning": "m"}
    given |= changes
    before = stickslip.effects()
    try:
        register_effect(given.pop("name"), given.pop("function"), given.pop("parameters"), **given)
    finally:
        assert stickslip.effects() == before


def of_map(folder, changes):
    """A field map of a small grid, of which some lines of the file are replaced."""
    points = grid(count=(3, 3, 3))
    path = write_csv(folder / "map.csv", points, formula_fields(points))
    lines = path.read_text().splitlines()
    for number, line in changes.items():
        lines[number - 1] = line
    path.write_text("\n".join(lines))
    return named(f"{path}: ", FieldMap.from_file, path)


def of_json(folder, text):
    """A fitted map in a scenario."""
    (folder / "map.json").write_text(text)
    (folder / "s.toml").write_text(f'{HEAD}[coil]\nmap = "map.json"\n')
    load(folder / "s.toml")


def of_points(_, change):
    """Measured fields in memory: what makes others of those of Table I's coils."""
    points = grid(count=(3, 3, 3))
    FieldMap.from_points(*change(points, formula_fields(points)))


def of_scenario_with_map(_, changes):
    """Keys beside a map."""
    with_map = Scenario(coil=Coil(map=formula_map(count=(3, 3, 3))))
    if isinstance(changes, Mapping):
        with_map.replace(changes)
    else:
        with_map.with_uncertain({changes: {"mean": 0.1, "sd": 0.01}})


def of_key(_, key):
    """A key that is read."""
    Scenario().get(key)


def of_changes(_, changes):
    """Values by key."""
    Scenario().replace(changes)


WAYS = {
    "file": of_file, "voltages": of_voltages, "class": of_class,
    "robot": of(stickslip.Robot.of, length=250e-6, width=130e-6, height=100e-6),
    "fluid": of(Scenario().in_fluid),
    "measured coil": of(Coil.of, field_per_ampere=1e-3, distance=0.1, resistance=8.0),
    "arguments": lambda _, given: given[0](*given[1], **given[2]),
    "waveform": of_waveform, "pulses": lambda _, mode: Waveform.ipp(mode=mode),
    "coils": lambda _, given: Coils.of(given), "hold": of_hold,
    "uncertain": lambda _, table: Scenario(uncertain=table),
    "uncertain file": of_uncertain_file, "effect": of_effect, "map": of_map, "json": of_json,
    "points": of_points, "with map": of_scenario_with_map, "key": of_key, "changes": of_changes,
}  # fmt: skip

PARAMETER = EffectParameter(name="k", unit="-", low=-1.0, high=1.0, meaning="of a test")


def parameter(**changes):
    """Parameters of an effect of which one is another."""
    values = {name: getattr(PARAMETER, name) for name in ("name", "unit", "low", "high", "meaning")}
    return {"parameters": [EffectParameter(**{**values, **changes})]}


@cfunc("float64(float64)")
def of_one_number(x):
    """A function that is no effect."""
    return x


TWO = ["drag.linear", "robot.mass"]


def covariance(matrix, keys=TWO):
    """The tables of a covariance."""
    return {"covariance": {"keys": keys, "matrix": matrix}}


REFUSALS = [
    ("file", "", ["is empty", "[drive]"]),
    ("file", HEAD + '[fluid]\nname = "watr"\n', 'did you mean "water"?'),
    ("file", HEAD + '[fluid]\nnam = "water"\n', 'fluid.nam = "water": there is no such key'),
    ("file", HEAD + "[fluid]\nviscosity = 1.0\n", "[fluid]: density is missing: give"),
    ("file", HEAD + 'direction = "x"\n', 'did you mean "+x"?'),
    ("file", HEAD + '[robot]\nmaterial = "gold"\n', "[robot]: length, width, height are missing"),
    ("file", HEAD + "[coil]\nradius = 0.04\n", "coil.radius = 0.04: allowed is side = 1.77"),
    ("file", HEAD + "[fluid]\ndensity = 9e3\nviscosity = 1.0\n", "it floats"),
    ("file", HEAD + "base = 0,5e-3\n", ["not valid TOML", "line 3", "decimal point"]),
    ("file", b"\x89PNG\r\n\x1a\n\xff\xfe" * 9, "is no text"),
    ("file", b"a" * (2 << 20), "is longer than"),
    ("file", f"{HEAD}frequency = {ENDLESS}\n", "not valid TOML"),
    ("file", f"{HEAD}x = {'[' * 9000}\n", "not valid TOML"),
    *(("file", f"{HEAD}{text}\n", "not valid TOML: a key in it has no end") for text in (
        "a" + ".a" * 300_000 + " = 1", f"[{'a.' * 300_000}a]", '"=#,"' + '."=#,"' * 90_000 + " = 1",
        'x = { b = """\n""", a' + ".a" * 300_000 + " = 1 }")),
    ("file", "\n" * 1_000_000 + "x", "not valid TOML"),
    ("file", "[drive]\n", '"stickslip = 1"'),
    ("file", "stickslip = true\n[drive]\n", "stickslip = true"),
    ("file", "stickslip_measurement = 1\n", "is a measurement"),
    ("file", "stickslip = 1\n", "[drive] is missing"),
    ("file", HEAD + "[contcat]\n", ["[contcat]", 'did you mean "contact"?']),
    ("file", "stickslip = 1\ndrive = 3\n", ["drive = 3", "[drive]"]),
    ("file", HEAD + "[effects.tilt_surface]\n", "effects.tilt_surface"),
    ("file", HEAD + "[effects]\neddy_lag = 3\n", "effects.eddy_lag = 3"),
    ("file", HEAD + "[contact]\nkinetic_friction = 0.5\n", "with contact.static_friction = 0.2"),
    ("file", HEAD + "base = 3e-3\n", ["drive.peak", "drive.base"]),
    ("file", HEAD + "edge_time = 0.01\n", ["drive.edge_time = 0.01", "period"]),
    ("file", HEAD + "[coil.xp]\ncapacitance = 1e-3\n[effects.mutual_inductance]\ncoupling = 0.1\n",
     ["coil.capacitance = 0.001", "effects.mutual_inductance.coupling = 0.1", "one of the two"]),
    ("file", HEAD + 'mode = "none"\nlatency = 0.1\n', ["drive.latency", '"none"']),
    ("file", HEAD + '[inner]\nmass = 1e-9\n[record]\npull_share = "yes"\n',
     ["record.pull_share", "[inner]"]),
    ("file", HEAD + "[record]\nrate = 1e9\n", ["record.rate = 1e+09", "1e9"]),
    ("file", HEAD + "[record]\nfrom = 2\n", ["record.from = 2", "the duration of the run"]),
    ("file", HEAD + '[record]\nfields = "x, tetha"\n', 'did you mean "theta"?'),
    ("file", HEAD + "[coil]\nxp = 3", "coil.xp = 3: allowed is a table [coil.xp]"),
    ("file", HEAD + "[coil.xp]\nturn = 3", "coil.xp.turn = 3: there is no such key; did you mean"),
    ("file", HEAD + "[coil]\nmap = 3", "coil.map = 3"),
    ("file", HEAD + 'mode = "program"\n', ["drive.mode", "drive.file"]),
    ("file", PROGRAM + "heading = 0.5\n", ["drive.heading", '"program"']),
    ("file", HEAD + 'file = "v.csv"\n', ['drive.mode = "IPP"', '"program"']),
    ("file", HEAD + 'program = "v.csv"\n', ["drive.program", "drive.file", '"program"']),
    ("file", PROGRAM.replace("v.csv", "v\\u0000"), ["v\\u0000", "NUL"]),
    ("file", PROGRAM.replace("v.csv", "/dev/zero"), ["/dev/zero", "device"]),
    ("file", HEAD + "[uncertain]\ndrag.linear = { mean = 1, sd = 1 }\n", "quotation marks"),
    ("voltages", "", "is empty"),
    ("voltages", "t,xp,xm,yp,ym,clamp\n", "no row of data"),
    ("voltages", "t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n",
     "voltages: 1 points; allowed are two or more"),
    ("voltages", "t,xp,xm,yp,ym\n0,0,0,0,0\n", ["row 1", 'column "clamp" is missing']),
    ("voltages", "0,0,0,0,0,0\n1,0,0,0,0,0\n", "first line is numbers"),
    ("voltages", "t,xp,xm,yp,ym,clamp,zp\n0,0,0,0,0,0,0\n", ["row 1", '"zp"', "no such"]),
    ("voltages", "t,xp,xm,yp,ym,clamp,xp\n0,0,0,0,0,0,0\n", ["row 1", "xp", "twice"]),
    ("voltages", CSV.replace("xp", "xp (mA)"), ["xp (mA)", "is no unit of it", "mV"]),
    ("voltages", CSV.replace(",", " "), ["line 1", "blanks do not separate columns"]),
    ("voltages", CSV + "0.5,0,0,0,0,0\n", ["row 4", "t = 0.5 s follows 1 s"]),
    ("voltages", CSV.replace("\n0,", "\n0.5,"), ["row 2", "t = 0.5", "0 s"]),
    ("voltages", CSV.replace("\n1,", "\n0,"), ["row 3", "t = 0: no duration", "above 0"]),
    ("voltages", CSV + "2,0,nan,0,0,0\n", ["row 4", "column xm", "nan", "finite", "V"]),
    ("voltages", CSV + "2,0,0\n", ["row 4", "3 cells", "6"]),
    ("voltages", CSV + '2,"a\nb",0,0,0,0\n', ["line 4", "a quoted cell goes over several lines"]),
    ("voltages", CSV + "1,2,0,0,0,0\n1,3,0,0,0,0\n", ["row 5", "third point at t = 1.0"]),
    ("voltages", b"\x89PNG\r\n\x1a\n\xff\xfe" * 9, "byte 1 is not UTF-8"),
    ("class", ("Drive", {"frequency": -1.0}), ["drive.frequency = -1.0", "from 1e-06"]),
    ("class", ("Drive", {"program": "file.csv"}), ["drive.program", "Waveform"]),
    ("class", ("Coil", {"outer_diameter": 0.08}), ["coil.outer_diameter", "side = 1.77 R"]),
    ("class", ("Coil", {"xp": 3}), "coil.xp = 3: allowed is a table"),
    ("class", ("Record", {"fields": ["x", 3]}), "record.fields"),
    ("class", ("Scenario", {"drive": {"frequency": 3.0}}), ["drive = ", "a Drive"]),
    ("class", ("Scenario", {"effects": {"surface_tlt": {}}}), 'did you mean "surface_tilt"?'),
    ("class", ("Scenario", {"effects": {"surface_tilt": 3}}), "effects.surface_tilt = 3"),
    ("class", ("Scenario", {"effects": []}), "effects = []"),
    ("class", ("Scenario", {"contcat": 1}), ["Scenario: contcat = 1", 'did you mean "contact"?']),
    *(("arguments", given, words) for kind in KINDS for given, words in wrong_arguments(kind)),
    ("pulses", "OPP", 'mode = "OPP": allowed is none, as the voltages are those of IPP'),
    *(("class", ("Waveform", {"blocks": [([0.0, 1.0], np.zeros((2, 5)), repeats)]}),
       ["repeats = ", "allowed is a whole number from 1"]) for repeats in (2.7, 0, True, None)),
    ("waveform", ("from_points", [0.0, 0.0], np.zeros((2, 5))), "no duration"),
    ("waveform", ("from_points", [0.1, 0.2], np.zeros((2, 5))), "has to be at 0"),
    ("waveform", ("from_points", [0, 2, 1], np.zeros((3, 5))), "must not fall"),
    ("waveform", ("from_points", [0, 1, 1, 1, 2], np.arange(25.0).reshape(5, 5)),
     "point 4: third point at t = 1.0: allowed are two, a jump"),
    ("waveform", ("from_points", [0, 1], {"xp": [1, 2]}), "voltages: no xm; allowed are all of xp"),
    ("waveform", ("from_points", [0, np.nan], np.zeros((2, 5))), "finite"),
    ("waveform", ("from_points", [0, 1], np.full((2, 5), np.inf)), "finite"),
    ("waveform", ("from_points", [0, 1], np.zeros((2, 4))), "shape (n, 5)"),
    ("waveform", ("hold", 1.0, {"clmap": 3.0}), ['voltages: "clmap"', 'did you mean "clamp"?']),
    ("waveform", ("hold", 1.0, [1.0, 2.0]), "of shape (2,): allowed is shape (5,)"),
    ("waveform", ("hold", 1.0, {"xp": "3"}), 'voltages: xp = "3": allowed is finite numbers'),
    ("waveform", ("hold", "1", {}), 'duration = "1": allowed is a finite number of s'),
    ("waveform", ("sawtooth", np.inf, {}, {}), "period = inf: allowed is a finite number"),
    ("waveform", ("sawtooth", 1.0, {}, {}, "up"), "edge"),
    ("waveform", ("sawtooth", 1.0, {}, {}, "rise", "a"), "edge_time = 'a': allowed is"),
    ("waveform", ("sawtooth", 1.0, {}, {}, "rise", 1.0), "edge_time"),
    ("hold", ("after", "0.1"), "t = '0.1': allowed is from 0"),
    ("hold", ("repeat", 0), "whole number"),
    ("hold", ("voltages", 1.5), "from 0 to 1 s"),
    ("hold", ("voltages", np.nan), "t = nan: allowed is finite"),
    ("uncertain", {}, "is empty"),
    ("uncertain", 3, "allowed is a section"),
    ("uncertain", {"drive.peak": {"mean": 1e-3, "sd": 1e-4}}, "constant of the model"),
    ("uncertain", {"drag.linear": {"mean": 1.0}}, "allowed is { mean, sd }"),
    ("uncertain", {"drag.linear": {"min": -1e308, "max": 1e308}}, "allowed is a finite width"),
    ("uncertain", {"drag.linear": {"low": 0.0, "high": 1.0}}, 'or Prior("uniform", min, max)'),
    ("uncertain", {"covariance": {"keys": TWO}}, "with keys and matrix"),
    ("uncertain", covariance([[1.0]], "drag.linear"), "a list of keys"),
    ("uncertain", covariance([[1.0]], ["drag.liner"]), 'mean "drag.linear"'),
    ("uncertain", covariance([[1.0, 0.0]]), "symmetric one of 2 x 2 numbers"),
    ("uncertain", covariance([[1.0, math.nan], [0.0, 1.0]]), "symmetric one of 2 x 2 numbers"),
    ("uncertain", covariance([[-1.0, 0.0], [0.0, 1.0]]), "without an eigenvalue below zero"),
    ("uncertain", covariance([[1.0, 0.2], [0.1, 1.0]]), "symmetric one of 2 x 2 numbers"),
    (
        "uncertain",
        {**covariance([[1e-12]], ["drag.linear"]), "drag.linear": {"mean": 1e-5, "sd": 1e-6}},
        "is there twice",
    ),
    ("uncertain file", "stickslip = 1\n[drive]\n", "u.toml: there is no section [uncertain]"),
    ("effect", {"name": "surface_tilt"}, "the model has one of this name itself"),
    ("effect", {"name": "my effect"}, "letters, digits and _"),
    ("effect", {"name": 3}, "allowed is a text"),
    ("effect", {"parameters": []}, "needs a parameter"),
    ("effect", {"parameters": 3}, "a list of EffectParameter"),
    ("effect", {"parameters": ["k"]}, "allowed is an EffectParameter"),
    ("effect", {"parameters": 2 * [PARAMETER]}, '"k": is given twice'),
    ("effect", parameter(name="a.b"), "letters, digits and _"),
    ("effect", parameter(high=math.inf), "finite ends"),
    ("effect", parameter(default=math.nan), "outside its range"),
    ("effect", parameter(low=False), "allowed is a number"),
    ("effect", parameter(unit=1), "unit = 1: allowed is a text"),
    ("effect", {"function": True}, "allowed is an address"),
    ("effect", {"function": 2**64}, "there can be no function"),
    ("effect", {"function": type("A", (), {"address": "here"})()}, "allowed is an address"),
    ("effect", {"function": ctypes.CFUNCTYPE(None, ctypes.c_void_p)(lambda *arguments: None)},
     "other arguments"),
    ("effect", {"function": of_one_number}, "other arguments"),
    ("map", {2: "0,0,0,zp,0,0,0"}, ["row 2, column coil", "one of xp, xm"]),
    ("map", {3: "0,0,lost,xp,0,0,0"}, ["row 3, column z", "lost", "finite number of m"]),
    ("map", {1: "x,y,z,coil,Bx,By"}, 'column "Bz" is missing'),
    ("map", {1: "x (mT),y,z,coil,Bx,By,Bz"}, "is no unit of it"),
    ("map", {2: "8,0,0,xp,0,0,0"}, ["row 2", "x = 8.0", "millimetres"]),
    ("map", {2: "0,0,0,xp,0.5,0,0"}, ["row 2", "Bx = 0.5", "mT/A"]),
    ("json", "{}", ["coil.map", "is no fitted map"]),
    ("json", "[" * 99_999, "is no fitted map"),
    ("points", lambda points, fields: ("text", fields), 'points = "text": allowed is'),
    ("points", lambda points, fields: ([[10**400, 0, 0]], fields), "allowed is finite numbers"),
    ("points", lambda points, fields: (points[:3], fields), "allowed is shape (3, 5, 3)"),
    ("points", lambda points, fields: (points[:7], fields[:7]), "7 points: allowed are 8 or more"),
    ("points", lambda points, fields: (points, -fields),
     ["coil xp: B = (-0.00096", "-Bx, -By, -Bz in place of Bx, By, Bz would fit"]),
    ("points", lambda points, fields: (points, fields[:, :, ::-1]),
     ["coil xp: the fit leaves", "Bz, Bx in place of Bx, Bz would fit"]),
    ("points", lambda points, fields: (points + np.array([0.1, 0, 0]), fields),
     "hold the place x = y = z"),
    ("points", lambda points, fields: (points * [1, 1, 0], fields), "z = 0.0 m at all points"),
    ("points", lambda points, fields: (points, fields + np.nan), "fields[0, 0, 0] = nan"),
    ("with map", {"coil.clamp.side": 0.1}, "coil.clamp.side = 0.1: allowed beside coil.map"),
    ("with map", {"coil.map": "map.csv"}, "FieldMap.from_file"),
    ("with map", "coil.side", "coil.side: cannot be uncertain beside coil.map"),
    ("key", "drive.mod", 'did you mean "drive.mode"?'),
    ("key", 3, "key 3: allowed is a word"),
    ("changes", 3, "changes = 3: allowed is a Mapping, such as a dict"),
    ("robot", {"material": ["SmCo5"]}, 'did you mean "SmCo5"?'),
    ("robot", {}, "density is missing: give density and magnetization, or name a material"),
    ("robot", {"material": "SmCo5", "density": -1.0}, "density = -1.0"),
    ("robot", {"material": "SmCo5", "length": 0.25}, "robot.length = 0.25: allowed is a number"),
    ("fluid", {"fluid": "Oil"}, ['mean "silicone oil 5 cSt" or ', 'oil 350 cSt" or ', '1000 cSt"']),
    ("robot", {"lenght": 1}, ["Robot.of has no such word", 'did you mean "length"?']),
    ("measured coil", {"turns": 200}, "turns = 200: allowed is Coil(turns=...), or Coil.of of fi"),
    ("fluid", {}, "density is missing: give density and viscosity, or name a fluid"),
    ("fluid", {"fluid": "water", "viscosity": math.inf}, "viscosity = inf"),
    ("fluid", {"fluid": "water", "wall": 0.0}, ["wall = 0.0", "true or false"]),
    ("fluid", {"density": 8e3, "viscosity": 1.0}, ["density = 8000.0", "it floats"]),
    ("measured coil", {"side": 0.1}, "inductance is missing: give inductance or rise_time"),
    ("measured coil", {"side": 0.1, "radius": 0.1, "inductance": 0.1}, "none beside radius"),
    ("measured coil", {"side": 0.1, "rise_time": -1.0}, "rise_time = -1.0: allowed is a finite"),
    ("coils", Drive(), ["scenario = Drive(", "a Scenario"]),
    ("changes", {"frequency": 3.0}, 'did you mean "drive.frequency"?'),
    ("changes", {"drive": 3}, ["drive = 3", "it is a section: change its", "such as drive.mode"]),
    ("changes", {"laws": {}}, ["it is a section", "such as laws.NAME"]),
    ("changes", {"fluid": "water"}, ["it is a section", "Scenario.in_fluid"]),
    ("changes", {"": 3}, "there is no such key"),
    ("changes", {3: 3}, "key 3: allowed is a word"),
    ("changes", {"drive.heading": 30}, "drive.heading = 30: allowed is a number from -6.3 to 6.3"),
    ("changes", {"drive.file": "v.csv"}, "Waveform.from_csv"),
    ("changes", {"effects.sample_hold.period": 1e-12}, "0 (none) or at"),
    ("changes", {"solver.max_step": 1e-12}, "0 (no limit) or at least"),
    ("changes", {"solver.max_step": 5e-5, "solver.max_steps": 1000}, "steps = 1000"),
    ("changes", {"drive.pulses": 10**9}, "drive.pulses = 1e+09: allowed is at most 5e+08"),
]  # fmt: skip
