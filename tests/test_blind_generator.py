"""The core and the instruments beside the simulator of the blind study, which knows neither."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from blind import settings
from blind.catalogue import CAUSES, entry
from blind.readings import readings, velocities
from blind.settings import FILM_SD, priors
from blind.truth import Hidden, Truth

from stickslip import Coils, Scenario, _core, simulate
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.instruments import read_by
from stickslip.walker.exposure import CameraModel, record
from stickslip.walker.instruments import of_angles, of_velocities

# A condition in which every cause of a moving robot does something.
DRIVE = {"mode": "OPP", "frequency": 90.0, "peak": 2.5e-3, "base": 0.5e-3, "hold": 1.8e-3,
         "direction": "-x"}  # fmt: skip
MIDDLE = {
    name: float(prior.value(0.0))
    for tables in (("velocity",), ("angle",), ("field",))
    for name, prior in priors(tables).items()
}
PLAIN = Truth("none", (), MIDDLE)


def truth_with(name, amount):
    own = entry(name)
    middle = {key: float(np.sqrt(low * high)) for key, (low, high) in own.drawn.items()}
    sizes = {key: value for each in own.sizes for key, value in each.items()}
    return replace(PLAIN, hidden={name: Hidden(amount, {**own.fixed, **middle, **sizes})})


# What a constant is in the core, by the library's word for it.
CONSTANTS = {
    "edge_time": ("drive.edge_time", lambda time: time),
    "magnetization_scale": ("robot.magnetization", lambda fraction: 5e5 * (1.0 + fraction)),
    "restitution": ("contact.restitution", lambda coefficient: coefficient),
}
MEASURED = ("length_scale", "clock_scale", "angle_offset")  # in readings, not in the core


def read(truth, name, true, causes):
    """Readings of true values by the diagnosis' instrument of that name, shape (n,)."""
    own = truth.parameters(name)
    keys, values = [f"{name}.{key}" for key in own], np.array([list(own.values())])
    return read_by(causes, keys, values, lambda *_: true[None], Table({}, true))[0]


def core(truth, name, drive=None, **more):
    """The scenario of the core that has what a truth hides."""
    keys = {f"effects.{name}.{key}": value for key, value in truth.parameters(name).items()}
    if name in MEASURED:
        keys = {}
    elif name in CONSTANTS:
        key, stated = CONSTANTS[name]
        keys = {key: stated(*truth.parameters(name).values())}
    return Scenario().replace(
        {**keys, **{f"drive.{k}": v for k, v in (drive or {}).items()}, **more}
    )


@pytest.mark.parametrize("name", [each for each in CAUSES if not CAUSES[each].fixed])
@pytest.mark.nightly
def test_a_truth_of_the_librarys_form_is_what_the_core_has(name):
    truth = truth_with(name, 1.0)
    shared = {key: value for key, value in MIDDLE.items() if key.startswith(("contact", "drag"))}
    scenario = core(truth, name, DRIVE, **shared, **{"drive.pulses": settings.PULSES})
    (mine,) = velocities(truth, [DRIVE])
    sd = np.hypot(settings.SCATTER * mine, settings.FLOOR) / np.sqrt(settings.TRIALS)
    true = np.array([simulate(scenario).mean_velocity])
    (theirs,) = read(truth, name, true, of_velocities(true))
    assert abs(theirs - mine) < sd / 5
    assert name in MEASURED or mine != velocities(PLAIN, [DRIVE])[0]


@pytest.mark.parametrize("name", ["angle_offset", "misalignment", "surface_tilt", "ambient_field"])
def test_angles_at_rest_are_those_of_the_core(name):
    truth, fields = truth_with(name, 2.0), settings.held_fields()
    true = _core.static_tilts(core(truth, name).to_core(), [], np.zeros((1, 0)), fields)[0]
    theirs = read(truth, name, true, of_angles(true))
    assert readings(truth, [], ("angle",)).angle == pytest.approx(theirs, abs=1e-10)


def test_fields_are_those_of_the_core():
    rows = settings.probes()
    gain = np.array([1.05] * 4 + [1.0])
    truth = replace(PLAIN, hidden={"field_gain": Hidden(1.0, {"in_plane": 0.05})})
    theirs = Coils().field(rows[:, 5:], rows[:, :5] * gain)
    assert readings(truth, [], ("field",)).field == pytest.approx(theirs, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("name", ["clock_scale", "surface_tilt"])
@pytest.mark.nightly
def test_frames_of_a_film_are_those_of_the_core(name):
    truth = truth_with(name, 1.0)
    seen = readings(truth, [], ("film",)).films
    for drive, film in zip(settings.films(), seen, strict=True):
        motion = next(record(core(truth, name, drive), [], np.zeros((1, 0)), 9e4, 1))
        clock = truth.amount("clock_scale", "fraction")
        frames = CameraModel(settings.EXPOSURE, clock_scale=clock).frames(motion, film["t"])
        gap = {quantity: film[quantity] - frames[quantity] for quantity in FILM_SD}
        # The first slips in the ramp are left out by the diagnosis.
        x = (gap["x"] - gap["x"][np.searchsorted(film["t"], 0.06)])[film["t"] > 0.06]
        assert np.sqrt(np.mean(x**2)) < FILM_SD["x"] / 5
        theta = gap["theta"][film["t"] < (1.0 + clock) * motion["t"][-1]]
        assert np.sqrt(np.mean(theta**2)) < FILM_SD["theta"] / 5


@pytest.mark.nightly
def test_nothing_of_the_package_decides_about_a_data_set():
    code = "import sys, blind.writing; print([m for m in sys.modules if m.startswith('stickslip')])"
    bench = str(Path(__file__).resolve().parents[1] / "bench")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          check=True, env={"PYTHONPATH": bench})  # fmt: skip
    assert done.stdout == "[]\n"
