"""The laboratory of the study: what perfect instruments would read, by the reference simulator.

Shares no code with the core: its own field integral, waveform and time stepping. Distortions of the
instruments that belong to the truth are in these readings; random errors are not.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from blind.model_errors import MODEL_ERRORS
from blind.settings import (
    EXPOSURE,
    FLOOR,
    FRAME_RATE,
    PULSES,
    SCATTER,
    Drive,
    films,
    held_fields,
    probes,
)
from blind.truth import Truth
from reference import coil_field, simulate_reference, static_tilt_reference

Array = NDArray[np.float64]

STEP = 1e-6  # s, of the reference simulator; tests/test_blind_study.py shows that it suffices
_SAMPLING = 2e4  # Hz, of a motion that is filmed; frames are read by linear interpolation
_MEASURED = ("length_scale", "clock_scale", "angle_offset")  # in readings, not in the motion
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True)
class Readings:
    """Noiseless readings of all tables; those that a data set lacks are empty.

    velocity (drives,) m/s; angle (n,) rad; field (n, 3) T; films: columns t, x, theta of each.
    """

    velocity: Array = field(default_factory=lambda: np.zeros(0))
    angle: Array = field(default_factory=lambda: np.zeros(0))
    field: Array = field(default_factory=lambda: np.zeros((0, 3)))
    films: tuple[dict[str, Array], ...] = ()


def readings(
    truth: Truth, drives: Sequence[Drive], tables: Sequence[str], step: float = STEP
) -> Readings:
    """Readings of a truth; `step`, s, is that of the runs behind the velocities."""
    return Readings(
        velocities(truth, drives, step) if "velocity" in tables else np.zeros(0),
        _angles(truth) if "angle" in tables else np.zeros(0),
        _fields(truth) if "field" in tables else np.zeros((0, 3)),
        _films(truth) if "film" in tables else (),
    )


def _section(truth: Truth, section: str) -> dict[str, float]:
    """Constants of a section of the scenario."""
    return {
        key.partition(".")[2]: value
        for key, value in truth.constants.items()
        if key.startswith(section + ".")
    }


def _simulate(truth: Truth, drive: Drive, step: float, rate: float | None = None):  # type: ignore[no-untyped-def]
    effects = {name: each for name, each in truth.effects.items() if name not in _MEASURED}
    return simulate_reference(
        dict(drive), _section(truth, "robot"), _section(truth, "contact"), _section(truth, "drag"),
        effects, step, rate,
    )  # fmt: skip


def velocities(truth: Truth, drives: Sequence[Drive], step: float = STEP) -> Array:
    """Mean velocities, m/s."""
    level = np.array(
        [_simulate(truth, {**each, "pulses": PULSES}, step).mean_velocity for each in drives]
    )
    ripple = truth.hidden.get("ripple")
    if ripple is not None:
        place = np.log([float(each["frequency"]) for each in drives]) / float(ripple.base["period"])
        phase = 2.0 * np.pi * place + float(ripple.base["phase"])
        level = level * (1.0 + ripple.amount * np.sin(phase))
    # In units of a trial's errors and along the walk, as an error of its model would be.
    unit = np.sign(level) * np.hypot(SCATTER * level, FLOOR)
    for name in MODEL_ERRORS.keys() & truth.hidden.keys():
        error = truth.hidden[name]
        level = level + error.amount * unit * MODEL_ERRORS[name](drives, int(error.base["number"]))
    level = level * (1.0 + truth.amount("length_scale", "fraction"))
    level = level / (1.0 + truth.amount("clock_scale", "fraction"))
    level = level + truth.amount("velocity_offset", "offset")
    return _clipped(level, truth.amount("velocity_clipping", "share"))


def _clipped(level: Array, share: float) -> Array:
    """Sizes cut at the largest less a share of it."""
    top = (1.0 - share) * float(np.max(np.abs(level)))
    return np.clip(level, -top, top)


def _angles(truth: Truth) -> Array:
    effects = {name: each for name, each in truth.effects.items() if name not in _MEASURED}
    robot, contact = _section(truth, "robot"), _section(truth, "contact")
    theta: Array = static_tilt_reference(held_fields(), robot, contact, effects)  # type: ignore
    theta = theta * (1.0 + truth.amount("angle_scale", "fraction"))
    theta = theta + truth.amount("angle_offset", "angle")
    return _clipped(theta, truth.amount("angle_clipping", "share"))


def _fields(truth: Truth) -> Array:
    gain = {name: 1.0 + truth.amount("field_gain", name) for name in ("in_plane", "clamp")}
    result = []
    for *amperes, x, y, z in probes():
        field_here = np.zeros(3)
        for name, current in zip(("xp", "xm", "yp", "ym", "clamp"), amperes, strict=True):
            unit = coil_field(name, (x, y, z), **_section(truth, "coil"))
            field_here += current * gain["clamp" if name == "clamp" else "in_plane"] * unit
        field_here[0] += truth.amount("ambient_field", "Bx")
        field_here[2] += truth.amount("ambient_field", "Bz")
        result.append(field_here)
    # The probe is turned about y against the coils.
    turn = truth.amount("probe_turned", "angle")
    c, s = np.cos(turn), np.sin(turn)
    seen = np.array(result) @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return _clipped(seen, truth.amount("probe_clipping", "share"))


def _films(truth: Truth) -> tuple[dict[str, Array], ...]:
    """Films by one camera, which cuts all of them off at the same angle."""
    seen = [_film(truth, drive) for drive in films()]
    every = np.concatenate([each["theta"] for each in seen])
    clipped = _clipped(every, truth.amount("film_clipping", "share"))
    ends = np.cumsum([len(each["theta"]) for each in seen])[:-1]
    parts = np.split(clipped, ends)
    return tuple({**each, "theta": part} for each, part in zip(seen, parts, strict=True))


def _film(truth: Truth, drive: Drive) -> dict[str, Array]:
    run = _simulate(truth, drive, STEP, _SAMPLING)
    along, above = (truth.amount("marker_place", key) for key in ("along", "above"))
    facing = -1.0 if drive["direction"] == "-x" else 1.0
    # A marker beside the centre of mass moves to and fro with the tilt.
    x = run.x + facing * (along * np.cos(run.theta) + above * np.sin(run.theta))
    clock = 1.0 + truth.amount("clock_scale", "fraction")
    # The clock of the camera counts what the drive does in its own time.
    times = np.arange(0.0, clock * run.t[-1], 1.0 / FRAME_RATE)
    true = times / clock + truth.amount("film_delay", "time")
    exposed = true[:, None] + 0.5 * EXPOSURE * _NODES
    x_seen = np.interp(exposed, run.t, x) @ (0.5 * _WEIGHTS)
    theta = np.interp(exposed, run.t, run.theta) @ (0.5 * _WEIGHTS)
    theta = theta + truth.amount("angle_offset", "angle")
    return {
        "t": times,
        "x": x_seen * (1.0 + truth.amount("length_scale", "fraction")),
        "theta": theta,
    }
