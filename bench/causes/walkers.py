"""Walkers among the sets: tables of velocities from the reference simulator of the tests."""

from __future__ import annotations

import zlib
from dataclasses import replace
from typing import Any

import numpy as np
from blind.catalogue import entry
from blind.readings import velocities
from blind.settings import PULSES, Drive, priors
from blind.truth import Hidden, Truth

from causes.make import ERROR, FIRST, STRENGTH, Array, write

HIDDEN = ("surface_tilt", "misalignment", "friction_anisotropy", "eddy_lag", "gradient_scale",
          "ambient_field", "mutual_inductance")  # fmt: skip
COUNT = 8
TRIALS = 3
SCATTER, FLOOR = 0.03, 1e-5  # of a trial: relative, and in m/s
STEP = 2e-6  # s, of the simulator; velocities to 1e-4 of themselves
MOST = 8  # simulations of all drives by which a cause gets its strength
STATED = priors(("velocity",))


def drives() -> list[Drive]:
    """Six in each mode, among them one backwards, one with another hold and one weaker."""
    usual: Drive = {"base": 5e-4, "hold": 1e-3, "peak": 2.5e-3, "frequency": 45.0}
    changes: list[Drive] = [
        *({"frequency": each} for each in (20.0, 45.0, 90.0)),
        {"frequency": 50.0, "direction": "-x"}, {"frequency": 55.0, "hold": 1.8e-3},
        {"peak": 1.5e-3},
    ]  # fmt: skip
    return [
        {"mode": mode, "direction": "+x", **usual, **each}
        for mode in ("IPP", "OPP") for each in changes
    ]  # fmt: skip


def _strength(plain: Array, level: Array) -> float:
    """Root mean square of a change in errors of a trial."""
    return float(np.sqrt(np.mean(((level - plain) / np.hypot(SCATTER * plain, FLOOR)) ** 2)))


def made(number: int) -> tuple[dict[str, str], dict[str, Any]]:
    """Files of a set by name, and what is not told."""
    random, driven = np.random.default_rng([FIRST + number, zlib.crc32(b"walker")]), drives()

    def seen(truth: Truth) -> Array:
        return velocities(truth, driven, STEP)

    drawn = {name: each.value(float(random.standard_normal())) for name, each in STATED.items()}
    plain = seen(Truth("walker", (), drawn))
    cause, level, error = "", plain, number % 4 == 1
    if number % 4:  # a quarter hides nothing
        cause, wanted = HIDDEN[number % len(HIDDEN)], random.uniform(*STRENGTH)
        own = entry(cause)
        base = {**own.fixed, **own.sizes[int(random.integers(len(own.sizes)))]}
        sign = float(random.choice([-1.0, 1.0])) if own.least < 0.0 else 1.0
        truth = Truth("walker", (cause,), drawn, {cause: Hidden(sign, base)})
        for _ in range(MOST):
            level = seen(truth)
            found = _strength(plain, level)
            if abs(found / wanted - 1.0) < 0.1:
                break
            truth = truth.scaled(float(np.clip(wanted / max(found, 1e-3), 0.5, 2.0)) ** 0.7)
        if error:
            wrong = Hidden(1.0, {"number": float(random.integers(2**31))})
            bent = seen(replace(truth, hidden={**truth.hidden, "smooth_error": wrong}))
            level = level + ERROR * found / _strength(level, bent) * (bent - level)
    trial = np.hypot(SCATTER * level, FLOOR) * random.standard_normal((TRIALS, len(level)))
    columns = ["velocity", "trial", *driven[0]]
    rows = [
        [f"{value:.7g}", str(k), *(str(each) for each in drive.values())]
        for k, values in enumerate(level + trial)
        for value, drive in zip(values, driven, strict=True)
    ]
    return files_of([columns, *rows]), {"cause": cause, "model_error": error}


def files_of(rows: list[list[str]]) -> dict[str, str]:
    """Files of a measurement by name, of a log's heads and rows."""
    stated = "\n".join(f'"{name}" = {each.stated}' for name, each in STATED.items())
    return {
        "log.csv": "\n".join(",".join(row) for row in rows) + "\n",
        "nominal.toml": f"stickslip = 1\n\n[drive]\npulses = {PULSES}\n",
        "measurement.toml": 'stickslip_measurement = 1\nname = "walker"\n'
        f'scenario = "nominal.toml"\n\n[uncertain]\n{stated}\n\n[[velocity]]\nfile = "log.csv"\n',
    }


def make() -> None:
    """Write them."""
    for number in range(COUNT):
        files, truth = made(number)
        write(f"walker-{number:02}", files, {"kind": "walker", "without": []}, truth)
