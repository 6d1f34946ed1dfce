"""Measurement files from the reference simulator of the tests, which shares no code with the core.

Its causes have other functional forms than the library: friction falls as 1/(1 + (v/vs)^2), drag
goes with |cos theta|. The true baseline is drawn from the priors. Velocities are read from a start
and an end position in whole pixels, three trials each with 3 % scatter.
"""

from __future__ import annotations

import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from reference import simulate_reference

KINDS = ("none", "constant", "single", "twins", "pair", "unknown", "shuffled")

PULSES = 12
STEP = 2e-7  # s, of the reference simulator
PIXEL = 1e-6  # m, after the usual interpolation between pixels
SCATTER = 0.03
TRIALS = 3

UNCERTAIN = """
[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"contact.adhesion" = { mean = 0.22e-6, sd = 0.03e-6 }
"drag.linear" = { low = 1e-6, high = 1e-4 }
"drag.rotational" = { median = 9e-17, factor = 2 }
"""

NOMINAL = """stickslip = 1

[drive]
pulses = 12

[solver]
rtol = 1e-6
"""

SINGLES = ("surface_tilt", "misalignment", "stribeck_friction", "angle_drag", "eddy_lag")


@dataclass
class Truth:
    """What is behind one data set. `effects` has the reference simulator's forms and names."""

    kind: str
    answer: list[str]
    constants: dict[str, float]
    effects: dict[str, dict[str, float | str]] = field(default_factory=dict)
    length_scale: float = 0.0
    ripple: float = 0.0


def conditions(kind: str) -> list[dict[str, float | str]]:
    """Settings of the drive; near twins are measured in one direction of one mode alone."""
    ipp = {"mode": "IPP", "base": 0.5e-3, "hold": 1.0e-3}
    opp = {"mode": "OPP", "base": 0.5e-3, "hold": 2.5e-3}
    rows: list[dict[str, float | str]] = []
    for mode in (opp,) if kind == "twins" else (ipp, opp):
        for frequency in (10.0, 20.0, 30.0, 45.0, 60.0, 75.0, 90.0, 110.0):
            rows.append({**mode, "frequency": frequency, "peak": 2.5e-3, "direction": "+x"})
        for peak in (1.5e-3, 2.0e-3, 3.0e-3):
            rows.append({**mode, "frequency": 40.0, "peak": peak, "direction": "+x"})
        if kind != "twins":
            for frequency in (30.0, 70.0):
                rows.append({**mode, "frequency": frequency, "peak": 2.5e-3, "direction": "-x"})
    return rows


def draw(kind: str, random: np.random.Generator) -> Truth:
    """The truth of a data set."""
    constants = {
        "kinetic_friction": min(0.145 + 0.01 * random.standard_normal(), 0.2),
        "adhesion": max(0.22e-6 + 0.03e-6 * random.standard_normal(), 0.0),
        "linear": float(np.exp(random.uniform(np.log(1e-6), np.log(1e-4)))),
        "rotational": 9e-17 * 2.0 ** random.standard_normal(),
    }
    truth = Truth(kind, [], constants)
    if kind == "constant":
        name = str(random.choice(["kinetic_friction", "adhesion"]))
        mean, sd = (0.145, 0.01) if name == "kinetic_friction" else (0.22e-6, 0.03e-6)
        # Static friction of 0.2 leaves kinetic friction room to one side only.
        sign = -1.0 if name == "kinetic_friction" else float(random.choice([-1.0, 1.0]))
        constants[name] = mean + 5.0 * sign * sd
        truth.answer = [f"contact.{name}"]
    elif kind in ("single", "shuffled"):
        truth.answer = [str(random.choice(SINGLES))]
    elif kind == "pair":
        truth.answer = [str(each) for each in random.choice(SINGLES, 2, replace=False)]
    elif kind == "twins":
        truth.answer = [str(random.choice(["surface_tilt", "length_scale"]))]
    elif kind == "unknown":
        truth.ripple = float(random.uniform(0.2, 0.4))
    for name in truth.answer:
        if name == "length_scale":
            truth.length_scale = float(random.choice([-1.0, 1.0]) * random.uniform(0.08, 0.15))
        elif not name.startswith("contact."):
            truth.effects[name] = _effect(name, random)
    return truth


def _effect(name: str, random: np.random.Generator) -> dict[str, float | str]:
    sign = float(random.choice([-1.0, 1.0]))
    size = float(random.uniform(1.0, 2.0))
    if name == "surface_tilt":
        return {"angle": 0.015 * sign * size}
    if name == "misalignment":
        return {"angle": 0.05 * sign * size}
    if name == "stribeck_friction":
        return {"speed": 4e-3 * size, "form": "rational"}
    if name == "angle_drag":
        return {"amplitude": 1.5 * size, "power": 1}
    return {"time": 3e-4 * size}


def _velocity(job: tuple[Truth, dict[str, float | str]]) -> float:
    truth, drive = job
    contact = {key: truth.constants[key] for key in ("kinetic_friction", "adhesion")}
    drag = {key: truth.constants[key] for key in ("linear", "rotational")}
    run = simulate_reference(
        {**drive, "pulses": PULSES}, contact=contact, drag=drag, effects=truth.effects, dt=STEP
    )
    return float(run.mean_velocity)


def write_case(
    folder: Path, kind: str, seed: int, pool: ProcessPoolExecutor
) -> tuple[Path, dict[str, object]]:
    """Write one data set into `folder`; return the measurement's path and the answer."""
    random = np.random.default_rng([seed, KINDS.index(kind)])
    truth, drives = draw(kind, random), conditions(kind)
    velocity = np.array(list(pool.map(_velocity, [(truth, drive) for drive in drives])))
    frequency = np.array([float(drive["frequency"]) for drive in drives])
    velocity = velocity * (1.0 + truth.length_scale)
    velocity = velocity * (1.0 + truth.ripple * np.sin(2 * np.pi * frequency / 27.0))
    seconds = (PULSES - 3) / frequency
    trials = velocity[:, None] * (1.0 + SCATTER * random.standard_normal((len(drives), TRIALS)))
    begin = random.uniform(0.0, 1e-4, trials.shape)
    end = begin + trials * seconds[:, None]
    read = (np.round(end / PIXEL) - np.round(begin / PIXEL)) * PIXEL / seconds[:, None]
    if kind == "shuffled":
        read = random.permutation(read.ravel()).reshape(read.shape)
    folder.mkdir(parents=True, exist_ok=True)
    keys = ["mode", "frequency", "peak", "base", "hold", "direction"]
    lines = [",".join(["velocity", "trial", *keys])]
    for drive, row in zip(drives, read, strict=True):
        for number, value in enumerate(row):
            lines.append(
                ",".join([repr(float(value)), str(number), *(str(drive[k]) for k in keys)])
            )
    (folder / "velocity.csv").write_text("\n".join(lines) + "\n")
    (folder / "nominal.toml").write_text(NOMINAL)
    path = folder / "measurement.toml"
    path.write_text(
        'stickslip_measurement = 1\nname = "study"\nscenario = "nominal.toml"\n'
        + UNCERTAIN
        + '\n[[velocity]]\nfile = "velocity.csv"\n'
    )
    answer = {
        "kind": kind,
        "seed": seed,
        "answer": truth.answer,
        "constants": truth.constants,
        "effects": truth.effects,
        "length_scale": truth.length_scale,
        "ripple": truth.ripple,
    }
    return path, json.loads(json.dumps(answer))
