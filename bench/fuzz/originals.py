"""Sound files of every kind that the program reads, small ones; what is damaged is a copy."""

from __future__ import annotations

import functools
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from stickslip import Coils, Scenario, simulate_batch

SCENARIO = """stickslip = 1

[drive]
mode = "IPP"      # in plane
frequency = 100
base = 0.5e-3
pulses = 4

[contact]
static_friction = 0.25
adhesion = 2.2e-7

[effects.surface_tilt]
angle = 0.02

[solver]
rtol = 1e-6
"""

_VOLTAGES = """t,xp,xm,yp,ym,clamp
0,0,0,0,0,0
0.02,5,0,0,0,-10
0.02,25,0,0,0,-10
0.03,5,0,0,0,-10
"""

_MEASUREMENT = """stickslip_measurement = 1
name = "a day in March"
scenario = "scenario.toml"

[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"drag.linear" = { low = 1e-6, high = 1e-4 }

"""

_TABLES = {
    "velocity": '[[velocity]]\nfile = "velocity.csv"\nvelocity_sd = 0.02\n',
    "tracking": '[[tracking]]\nfile = "tracking.csv"\nframe_rate = 2000.0\nnoise_x = 1e-6\n'
    "noise_theta = 1e-2\ndrive = { pulses = 8 }\n",
    "angle": '[[angle]]\nfile = "angle.csv"\n',
    "field": '[[field]]\nfile = "field.csv"\n',
}

SWEEP = ("sweep", "scenario.toml", "--vary", "drive.frequency=50:200:6", "--threads", "1")


class Original(NamedTuple):
    """A folder of files, the one of them to be damaged, and the command that reads it."""

    files: dict[str, bytes]
    damaged: str
    command: tuple[str, ...]


@functools.cache
def originals() -> dict[str, Original]:
    """By kind of file."""
    run = ("run", "scenario.toml", "--json")
    diagnose = ("diagnose", "measurement.toml", "--json", "--threads", "1")
    scenario = {"scenario.toml": SCENARIO.encode()}
    program = 'stickslip = 1\n[drive]\nmode = "program"\nfile = "voltages.csv"\n'
    found = {
        "scenario": Original(scenario, "scenario.toml", run),
        "voltages": Original(
            {"scenario.toml": program.encode(), "voltages.csv": _VOLTAGES.encode()},
            "voltages.csv",
            run,
        ),
        "sweep": Original(
            {**scenario, "sweep.nc": _sweep()},
            "sweep.nc",
            (*SWEEP, "--out", "sweep.nc", "--resume"),
        ),
    }
    tables = _tables()
    for kind, table in _TABLES.items():
        files = {
            **scenario,
            "measurement.toml": (_MEASUREMENT + table).encode(),
            f"{kind}.csv": tables[kind].encode(),
        }
        found[kind] = Original(files, f"{kind}.csv", diagnose)
    every = {**scenario, **{f"{kind}.csv": tables[kind].encode() for kind in _TABLES}}
    every["measurement.toml"] = (_MEASUREMENT + "\n".join(_TABLES.values())).encode()
    found["measurement"] = Original(every, "measurement.toml", diagnose)
    return found


def _sweep() -> bytes:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scenario.toml").write_text(SCENARIO)
        command = [sys.executable, "-m", "stickslip", *SWEEP, "--out", "sweep.nc"]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        return (folder / "sweep.nc").read_bytes()


def _table(header: str, rows: np.ndarray) -> str:
    return "\n".join([header, *(",".join(map(repr, row)) for row in rows.tolist())]) + "\n"


def _tables() -> dict[str, str]:
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "scenario.toml"
        path.write_text(SCENARIO)
        base = Scenario.from_toml(path)
    random = np.random.default_rng(0)
    frequencies = np.array([25.0, 50.0, 75.0, 100.0])
    runs = simulate_batch([base.replace({"drive.frequency": float(f)}) for f in frequencies])
    film = simulate_batch([base.replace({"record.rate": 2000.0, "drive.pulses": 8})])[0]
    currents = random.normal(0.0, 1.0, (12, 5))
    places = random.normal(0.0, 5e-3, (12, 3))
    field = Coils().field(places, currents)
    angles = np.array([[2e-3, -b, np.arctan2(b, 2e-3)] for b in np.linspace(1e-3, 3e-3, 6)])
    velocities = np.column_stack(
        [frequencies, np.arange(4.0), [run.mean_velocity * 1.01 for run in runs]]
    )
    return {
        "velocity": _table("frequency,trial,velocity", velocities),
        "tracking": _table("t,x,theta", np.column_stack([film.t, film.x, film.theta])),
        "angle": _table("Bx,Bz,theta", angles),
        "field": _table(
            "xp,xm,yp,ym,clamp,x,y,z,Bx,By,Bz", np.column_stack([currents, places, field])
        ),
    }
