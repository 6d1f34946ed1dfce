"""Refusals of measurements, their tables and tracks: name, call, error, words."""

from functools import partial

import numpy as np
import pandas as pd

from made_measurement import write_files
from stickslip import Drive, Measurement, Prior, Scenario, velocity_of_track
from stickslip.errors import ScenarioError
from stickslip.walker import read_measurement

NOMINAL = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 8\n"
TOML = """stickslip_measurement = 1
name = "wafer"
scenario = "nominal.toml"

[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"drag.linear" = { low = 1e-6, high = 1e-4 }
"drag.rotational" = { median = 9e-17, factor = 2 }

[[velocity]]
file = "velocity.csv"
"""
FILMED = """stickslip_measurement = 1
scenario = "nominal.toml"

[[tracking]]
file = "a.csv"
frame_rate = 1000.0
exposure = 3e-4
drive = { frequency = 100.0 }
"""
ROWS = "frequency,velocity\n30,6e-4\n50,1e-3\n"
FRAMES = "t,theta,x\n" + "".join(f"{k}e-3,{k}e-3,{k}e-6\n" for k in range(120))
TABLE = pd.DataFrame({"mode": "IPP", "frequency": [30.0, 50.0], "velocity": [6e-4, 1e-3]})
IPP = Drive(mode="IPP", frequency=30.0, base=0.5e-3, pulses=30)
T = np.arange(0.0, 1.05, 0.01)  # the window of IPP is 0.15 to 1.05 s


def read(folder, old=TOML, new=TOML, toml=TOML, rows=ROWS):
    text = toml.replace(old, new)
    return read_measurement(write_files(folder, NOMINAL, text, velocity=rows, a=FRAMES))


def in_memory(table=TABLE, uncertain=None, **more):
    scenario = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 8})
    return Measurement.from_dataframe(table, scenario, uncertain or {}, **more)


FILE, HEADER = 'file = "velocity.csv"', "stickslip_measurement = 1"
FRICTION, STATED = '"contact.kinetic_friction"', "drive = { frequency = 100.0 }"
FILES = [
    (HEADER, "stickslip_measurement = 2", "allowed is 1"),
    (HEADER, "stickslip = 1", "a scenario, not a measurement"),
    ('name = "wafer"', 'nme = "wafer"', 'did you mean "name"'),
    ("sd = 0.01", "sd = 0.0", "above 0"),
    ("sd = 0.01", "std = 0.01", "{ mean = 0.145, std = 0.01 }: allowed is { mean, sd }"),
    (FRICTION, '"contact.friction"', "no such key"),
    (FRICTION, "contact.kinetic_friction", "quotation marks"),
    (FRICTION, '"drive.peak"', "outside [drive]"),
    (FILE, 'file = "absent.csv"', "cannot be read"),
    (FILE, f"{FILE}\nvelocity_sd = 2", "velocity_sd"),
    (FILE, f'{FILE}\n[[velocity]]\nfile = "./velocity.csv"', '"./velocity.csv" is there twice'),
    (FILE, "", "[[velocity]] file is missing"),
    ('scenario = "nominal.toml"', "scenario = 3", "scenario = 3"),
    ("[[velocity]]", "[[speed]]", "[[speed]]: there is no such entry"),
    (TOML, " ", 'is empty; a measurement has "stickslip_measurement = 1" and "scenario"'),
]
FILMS = [
    (STATED, "drive = { frequency = -3 }", "a.csv: drive.frequency = -3"),
    (STATED, "drive = { frequenzy = 3 }", 'did you mean "drive.frequency"'),
    (STATED, "drive = 3", "a.csv: drive = 3"),
    (STATED, 'drive = { file = "v.csv" }', "drive.file"),
    ("frame_rate = 1000.0", "frame_rate = 0", "a.csv: frame_rate = 0"),
    ("exposure = 3e-4", "exposure = -1", "exposure = -1"),
    ("exposure = 3e-4", "noise_theta = nan", "noise_theta"),
    ("exposure = 3e-4", "noise_theta = 1.0", "above 0 and below 0.5 rad"),
    ("exposure = 3e-4", "noise_x = 1.0", "above 0 and below 0.00025 m"),
    ("exposure", "exposures", 'did you mean "exposure"'),
]
TABLES = [
    ("frequency\n30\n", '"velocity" is missing'),
    ("velocity,frequenzy\n0.1,30\n", 'did you mean "frequency"'),
    ("velocity\n", "no row of data"),
    ("velocity,velocity\n1,1\n", "twice"),
    ("velocity,order\n1e-3,23:50\n1e-3,00:10\n", "in column order are more than 12 h apart"),
    *(
        (
            f"velocity,{key}\n1,30\n",
            [
                "velocity.csv: ",
                f'column "{key}" is a key of the scenario: allowed are those of [drive]',
            ],
        )
        for key in (
            "coil.resistance",
            "surface_tilt.angle",
            "surface_tilt_angle",
            "robot_mass (kg)",
            "effects.surface_tilt.angle",
        )
    ),
    ("velocity,frequency\nnan,30\nfast,30\n", "no row is sound"),
]
NORMAL = Prior("normal", 1e-5, 1e-6)
GIVEN = [
    ("no velocity", {"table": TABLE.rename(columns={"velocity": "v"})},
     'column "velocity" is missing; there are'),
    ("twice", {"table": pd.concat([TABLE, TABLE[["mode"]]], axis=1)},
     'column "mode" is there twice'),
    ("list", {"table": [1.0]}, "allowed is a DataFrame"),
    ("empty", {"table": TABLE.iloc[:0]}, "DataFrame: is empty: there is no row of data"),
    ("error", {"velocity_sd": 2.0}, "velocity_sd = 2.0: allowed is a number above 0"),
    ("typo", {"uncertain": {"drag.liner": NORMAL}}, "drag.linear"),
    ("no sd", {"uncertain": {"drag.linear": {"mean": 1.0}}}, "allowed is { mean, sd }"),
    ("both names",
     {"uncertain": {"surface_tilt.angle": NORMAL, "effects.surface_tilt.angle": NORMAL}},
     "is there twice"),
    ("above the static friction",
     {"uncertain": {"contact.kinetic_friction": Prior("normal", 0.5, 0.01)}},
     ['[uncertain] "contact.kinetic_friction" = normal(', ": allowed"]),
    ("mass", {"uncertain": {"robot.mass": Prior("normal", -1.0, 0.1)}},
     ['[uncertain] "robot.mass" = normal(', ": allowed"]),
]  # fmt: skip
TRACKS = [
    (T, T[1:], "x: 104 values; allowed are 105"),
    (T + np.nan, T, "no frame has both"),
    (T[:12], 1e-3 * T[:12], ["t = 0 to 0.11: 0 frames are in ", "0.15 to 1.05 s"]),
    (T[::15], 1e-3 * T[::15], ["5 frames are in ", "8 frames or more"]),
]
REFUSALS = [
    *((f"file: {new or old}", partial(read, old=old, new=new), ScenarioError, words)
      for old, new, words in FILES),
    *((f"film: {new}", partial(read, old=old, new=new, toml=FILMED), ScenarioError, words)
      for old, new, words in FILMS),
    *((f"table: {rows}", partial(read, rows=rows), ScenarioError, words) for rows, words in TABLES),
    *((f"in memory: {name}", lambda _, given=given: in_memory(**given), ScenarioError, words)
      for name, given, words in GIVEN),
    *((f"Prior{given}", lambda _, given=given: Prior(*given), ScenarioError, ": allowed is")
      for given in ((0.145, 0.01), ({"mean": 1.0},), ("normal", 0.145), ("normal",))),
    *((f"track: {words}", lambda _, t=t, x=x: velocity_of_track(t, x, IPP), ScenarioError, words)
      for t, x, words in TRACKS),
]  # fmt: skip
