"""The laboratory of the study: the reference simulator of the tests, and a measurement chain.

Shares no code with the core: its own field integral, waveform and time stepping.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from blind.truth import Drive, Truth
from reference import simulate_reference

Array = NDArray[np.float64]

PULSES = 8
COUNTED = 5  # those after the third
STEP = 1e-6  # s, of the reference simulator; tests/test_blind_study.py shows that it suffices
RESOLUTION = 0.2e-6  # m, of a position between pixels
SCATTER = 0.03  # of a trial, relative
FLOOR = 1e-5  # m/s, of a trial: about 1 % of the usual velocity
TRIALS = 3


def velocities(truth: Truth, drives: Sequence[Drive]) -> Array:
    """Mean velocities without noise, m/s, as a perfect camera would read them."""
    return np.array([_velocity(truth, drive) for drive in drives])


def _velocity(truth: Truth, drive: Drive) -> float:
    effects = {name: each for name, each in truth.effects.items()
               if name not in ("edge_time", "field_gain")}  # fmt: skip
    gain = truth.effects.get("field_gain", {})
    along = 1.0 + float(gain.get("in_plane", 0.0))
    clamp = 1.0 + float(gain.get("clamp", 0.0))
    in_plane, hold = (along, clamp) if drive["mode"] == "IPP" else (clamp, along)
    settings = {
        **drive,
        "peak": float(drive["peak"]) * in_plane,
        "base": float(drive["base"]) * in_plane,
        "hold": float(drive["hold"]) * hold,
        "edge_time": float(truth.effects.get("edge_time", {}).get("time", 0.0)),
        "pulses": PULSES,
    }
    run = simulate_reference(
        settings,
        contact={key: truth.constants[key] for key in ("kinetic_friction", "adhesion")},
        drag={key: truth.constants[key] for key in ("linear", "rotational")},
        effects=effects,
        dt=STEP,
    )
    amplitude, period, phase = truth.ripple
    # A resonance of the frame that moves the stage, for instance.
    place = np.log(float(drive["frequency"])) / period
    wave = 1.0 + amplitude * np.sin(2.0 * np.pi * place + phase)
    return float(run.mean_velocity) * (1.0 + truth.length_scale) * wave


def read(
    level: Array, drives: Sequence[Drive], random: np.random.Generator, hard: bool
) -> tuple[Array, NDArray[np.int64]]:
    """Trials as a camera reads them, shape (drives, trials), and the set-up of each.

    Hard: noise of Student's law with four degrees of freedom, set-ups that differ by half the
    noise, by a shift of one sign or by being faster or slower, and one wild trial.
    """
    shape = (len(drives), TRIALS)
    draws = random.standard_normal(shape)
    setup = np.tile(np.arange(TRIALS), (len(drives), 1))
    if hard:
        draws = random.standard_t(4, shape) / np.sqrt(2.0)
        sign = np.sign(level)[:, None] if random.random() < 0.5 else 1.0
        draws += 0.5 * random.standard_normal(TRIALS)[setup] * sign
    trials = level[:, None] + np.hypot(SCATTER * level, FLOOR)[:, None] * draws
    if hard:
        trials[random.integers(len(drives)), random.integers(TRIALS)] *= random.choice([0.5, 1.6])
    seconds = COUNTED / np.array([float(drive["frequency"]) for drive in drives])[:, None]
    begin = random.uniform(0.0, 1e-4, shape)
    steps = np.round((begin + trials * seconds) / RESOLUTION) - np.round(begin / RESOLUTION)
    return steps * RESOLUTION / seconds, setup
