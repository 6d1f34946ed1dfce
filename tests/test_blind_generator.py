"""The generator of the blind study: its truths, its noise, its plan, and what it writes."""

import functools
import itertools
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from blind import settings
from blind.catalogue import CAUSES, HIDING, INSTRUMENTS, LAWS, entry
from blind.generator import make
from blind.kinds import KINDS, Noise, plan
from blind.model_errors import MODEL_ERRORS
from blind.noise import noisy_tables, trials
from blind.readings import Readings, readings, velocities
from blind.settings import FIELD_SD, FILM_SD, conditions, curves, priors
from blind.strength import Absorber, Draft
from blind.truth import Hidden, Truth
from blind.writing import write_case

from stickslip import Coils, Scenario, _core, simulate
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.instruments import read_by
from stickslip.walker import read_measurement
from stickslip.walker.exposure import CameraModel, record
from stickslip.walker.instruments import of_angles, of_velocities

# A condition in which every cause of a moving robot does something.
DRIVES = [
    {"mode": "OPP", "frequency": 90.0, "peak": 2.5e-3, "base": 0.5e-3, "hold": 1.8e-3,
     "direction": "-x"},
]  # fmt: skip
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
    hidden = {name: Hidden(amount, {**own.fixed, **middle, **sizes})}
    return replace(PLAIN, hidden=hidden)


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


def tables_of(name):
    """Tables in which it is seen."""
    if name.startswith(("film", "marker")):
        return ("film",)
    at_rest = ("angle_offset", "angle_scale", "angle_clipping")
    return ("field",) if name.startswith("probe") else ("angle" if name in at_rest else "velocity",)


@functools.cache
def arrays(name, amount, tables):
    """All numbers that are read, of no cause if there is no name."""
    seen = readings(truth_with(name, amount) if name else PLAIN, DRIVES, tables)
    films = (film[key] for film in seen.films for key in film)
    return [seen.velocity, seen.angle, seen.field, *films]


@pytest.mark.parametrize("name", [*CAUSES, *LAWS, *INSTRUMENTS])
@pytest.mark.nightly
def test_nothing_of_a_truth_changes_nothing_and_some_of_it_does(name):
    tables = tables_of(name)
    plain, none, some = (arrays(*each, tables) for each in (("", 0), (name, 0.0), (name, 1.0)))
    assert all(map(np.array_equal, plain, none))
    assert not all(map(np.array_equal, plain, some))


@pytest.mark.parametrize("name", [each for each in CAUSES if not CAUSES[each].fixed])
@pytest.mark.nightly
def test_a_truth_of_the_librarys_form_is_what_the_core_has(name):
    truth = truth_with(name, 1.0)
    shared = {key: value for key, value in MIDDLE.items() if key.startswith(("contact", "drag"))}
    scenario = core(truth, name, DRIVES[0], **shared, **{"drive.pulses": settings.PULSES})
    (mine,) = velocities(truth, DRIVES)
    sd = np.hypot(settings.SCATTER * mine, settings.FLOOR) / np.sqrt(settings.TRIALS)
    true = np.array([simulate(scenario).mean_velocity])
    (theirs,) = read(truth, name, true, of_velocities(true))
    assert abs(theirs - mine) < sd / 5


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


def test_trials_are_correlated_along_the_frequencies_of_a_curve_alone():
    drives = conditions("none", ("velocity",))
    level = np.full(len(drives), 2e-3)
    sd = np.hypot(settings.SCATTER * 2e-3, settings.FLOOR)
    made = [
        trials(level, drives, Noise(correlated=(0.7, 0.7)), 0.7, np.random.default_rng(seed))
        for seed in range(400)
    ]
    draws = np.array([(values - 2e-3) / sd for values, _ in made])
    assert made[0][1].shape == (len(drives), settings.TRIALS)
    curve = max(curves(drives), key=len)
    frequencies = [drives[k]["frequency"] for k in curve]
    assert frequencies == sorted(frequencies)
    assert len({drives[k]["mode"] for k in curve}) == 1
    band = 5 / np.sqrt(draws[:, 0].size)
    for one, two in itertools.pairwise(curve):
        assert np.mean(draws[:, one] * draws[:, two]) == pytest.approx(0.7, abs=1.5 * band)
    first, other = curves(drives)[:2]
    assert abs(np.mean(draws[:, first[0]] * draws[:, other[0]])) < band
    # Trials of one condition are independent.
    assert abs(np.mean(draws[:, :, 0] * draws[:, :, 1])) < band


@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.9])
def test_frames_of_a_film_are_correlated(correlation):
    count = 40_000
    still = {"t": np.arange(count) / 500.0, "x": np.zeros(count), "theta": np.zeros(count)}
    level = Readings(films=(still,))
    (film,) = noisy_tables(level, correlation, np.random.default_rng(3)).films
    # Five errors of the mean of products of normal numbers, as many as are independent.
    band = 5 * np.sqrt(2.0 / count * (1.0 + correlation**2) / (1.0 - correlation**2))
    for name, sd in FILM_SD.items():
        left = (film[name] - np.mean(film[name])) / sd
        for k in range(4):
            assert np.mean(left[k:] * left[: count - k]) == pytest.approx(correlation**k, abs=band)


def test_the_plan_has_all_that_can_be_hidden_and_enough_of_each_family():
    alone = {name for each in KINDS.values() for names in each.hidden[: each.count]
             if len(names) == 1 for name in names}  # fmt: skip
    assert alone >= {*CAUSES, *LAWS, *INSTRUMENTS}
    assert {name for names in HIDING for name in names} <= set(CAUSES)
    # A study that is cut short has all kinds: each comes before any is half through.
    rows = list(plan(0, 1000, list(KINDS)))
    assert len(set(rows)) == sum(each.count for each in KINDS.values())
    assert {name for name, _ in rows[: len(rows) // 2]} == set(KINDS)
    assert len(list(plan(0, 3, ["none", "weak"]))) == 6
    found = Counter(KINDS[name].family for name, _ in rows)
    assert min(found[each] for each in {kind.family for kind in KINDS.values()}) >= 10
    # Each cause stands beside a model error, and every data set has another one.
    errors = [each for each in KINDS.values() if each.error]
    causes = [each.hidden[k][0] for each in errors for k in range(25000, 25000 + each.count)
              for k in [k % len(each.hidden)]]  # fmt: skip
    assert len(set(causes)) == len(causes)


@pytest.mark.parametrize("kind", ["single, angles", "instrument, fields"])
def test_what_is_hidden_is_as_strong_as_asked_for(kind):
    for seed in range(3):
        made = make(kind, seed)
        assert list(made.truth.hidden) == list(KINDS[kind].hidden[seed % len(KINDS[kind].hidden)])
        assert KINDS[kind].wanted[0] <= made.strength <= KINDS[kind].wanted[1]
        assert Truth.of(made.truth.as_record()) == made.truth


@pytest.mark.parametrize("name", MODEL_ERRORS)
@pytest.mark.nightly
def test_errors_of_the_model_are_of_size_one_and_the_same_for_every_trial(name):
    drives = conditions("none", ("velocity",))
    count = 300
    several = np.array([MODEL_ERRORS[name](drives, number) for number in range(count)])
    # A mean of squares of as many numbers, if they were normal.
    assert np.mean(several**2, axis=0) == pytest.approx(1.0, abs=5 * np.sqrt(2.0 / count))
    assert np.array_equal(several[3], MODEL_ERRORS[name](drives, 3))
    # Of fewer conditions they are the same.
    assert np.array_equal(several[3][::2], MODEL_ERRORS[name](drives[::2], 3))
    (curve, *_) = sorted(curves(drives), key=len, reverse=True)
    near, far = several[:, curve[0]] * several[:, curve[1]], several[:, curve[0]] * several[:, 15]
    assert np.mean(near) > 0.3
    if name == "correlated_error":
        assert abs(np.mean(far)) < 5 / np.sqrt(count)
    # They change velocities in proportion.
    none, one, two = (
        velocities(replace(PLAIN, hidden={name: Hidden(size, {"number": 5.0})}), DRIVES)
        for size in (0.0, 1.0, 2.0)
    )
    assert two - none == pytest.approx(2.0 * (one - none), rel=1e-9)
    assert np.all(one != none)


def test_a_strength_is_what_the_constants_cannot_undo():
    prior = priors(("field",))["coil.side"]
    moved = [
        replace(PLAIN, constants={"coil.side": prior.value(step)}) for step in (0.0, 0.5, -0.5)
    ]
    truth = replace(truth_with("ambient_field", 3.0), constants=moved[0].constants)
    base, above, below, level = (
        readings(each, [], ("field",)).field.ravel() / FIELD_SD for each in (*moved, truth)
    )
    slope, effect = above - below, level - base
    # With a normal prior the errors and the constant are one normal error of this covariance.
    covariance = np.eye(len(slope)) + np.outer(slope, slope)
    expected = np.sqrt(effect @ np.linalg.solve(covariance, effect))
    draft = Draft(moved[0], [], ("field",))
    absorber = Absorber(draft, moved[0])
    assert absorber.strength(level) == pytest.approx(expected, rel=1e-6)
    assert absorber.searched(level) == pytest.approx(expected, rel=1e-3)
    # Beside itself nothing of it is left.
    assert Absorber(draft, moved[0], "ambient_field").strength(level) < 1e-6


@pytest.mark.nightly
def test_constants_that_are_far_may_undo_more_than_slopes_say():
    # Rotational drag of a quarter or four times the size hides what a straight line does not.
    constants = {
        "contact.kinetic_friction": 0.155, "contact.adhesion": 2.26e-7, "drag.linear": 2.8e-5,
        "drag.rotational": 2.4e-16,
    }  # fmt: skip
    plain = Truth("single", (), constants)
    truth = replace(plain, hidden={"angle_drag": Hidden(2.0, {"amplitude": 3.0, "power": 1.0})})
    draft = Draft(plain, conditions("single", ("velocity",)), ("velocity",))
    absorber = Absorber(draft, plain)
    assert absorber.searched(draft(truth)) < 0.6 * absorber.strength(draft(truth))


def test_the_same_cause_has_a_cosine_of_one():
    constants = {"coil.side": priors(("field",))["coil.side"].value(0.0)}
    plain = Truth("single, fields", (), constants)
    hidden = {"field_gain": Hidden(2.0, {"in_plane": 0.05})}
    draft = Draft(plain, [], ("field",))
    cosines = Absorber(draft, plain).cosines(draft(replace(plain, hidden=hidden)), CAUSES)
    assert cosines["field_gain"] == pytest.approx(1.0, abs=1e-6)
    # A coil's side changes all fields nearly in proportion, a field of the room none of them.
    assert cosines["ambient_field"] < 0.5
    assert max(cosines[name] for name in cosines if name != "field_gain") < 1.0


@pytest.mark.nightly
def test_nothing_of_the_package_decides_about_a_data_set():
    program = (
        "import sys, blind.writing\n"
        "for name in sys.modules:\n"
        "    if name.startswith(('stickslip', 'reference.', 'blind.')): print(name)"
    )
    bench = str(Path(__file__).resolve().parents[1] / "bench")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                          check=True, env={"PYTHONPATH": bench})  # fmt: skip
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert loaded == {"blind", "reference"}


@pytest.mark.nightly
def test_a_data_set_is_written_as_a_measurement(tmp_path):
    a, b, c = (tmp_path / name for name in "abc")
    answer = write_case(a, "none, all tables", 3)
    assert answer["answer"] == ()
    measurement = read_measurement(a / "measurement.toml")
    assert len(measurement.velocity) == 1
    assert set(measurement.uncertain) == set(priors(("velocity",)))
    names = ["angle.csv", "field.csv", "measurement.toml", "nominal.toml", "velocity.csv"]
    assert sorted(path.name for path in a.iterdir()) == names
    write_case(b, "none, film", 3)
    tracked = read_measurement(b / "measurement.toml").tracking
    assert [run.scenario.get("drive.direction") for run in tracked] == ["+x", "-x"]
    write_case(c, "single, angles", 3)
    text = "".join(path.read_text() for path in c.iterdir())
    assert not any(name in text for name in CAUSES)
