"""Films: the camera, the fold, the errors of frames and the observables."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2 as chi2_law
from scipy.stats import f as f_law
from scipy.stats import norm

from films import NOISE, ROBOT, TRUE, film, noisy, tracking_run
from stickslip import Scenario, Waveform
from stickslip.walker.exposure import CameraModel, record, recording_rate
from stickslip.walker.film import FilmTable
from stickslip.walker.folding import fold
from stickslip.walker.read_tracking import TrackingRun

NAMES, VALUES = list(TRUE), np.array([list(TRUE.values())])


def misfit(table, names=NAMES, values=VALUES):
    """Chi-square per row of a model, and its p-value; of the true one, if not given."""
    left = table.mean - table.predict(names, values)[0]
    chi2, m, dof = (
        left @ np.linalg.solve(table.errors.covariance, left),
        len(left),
        table.errors.dof,
    )
    return chi2 / m, f_law.sf(chi2 / m, m, dof) if dof < 1e6 else chi2_law.sf(chi2, m)


def with_errors(run, errors, seed):
    """A run whose frames have further errors, of the size of the noise: phi, size by period."""
    phi, size = errors
    random = np.random.default_rng([seed, 7])
    start, pace = run.scenario.window[0], run.scenario.drive.frequency
    cycle = np.maximum(np.floor((run.columns["t"] - start) * pace + 1e-9).astype(int), -1) + 1
    columns = dict(run.columns)
    for name in ("x", "theta"):
        draws = random.standard_normal(len(cycle))
        for k in range(1, len(draws)):
            draws[k] = phi * draws[k - 1] + np.sqrt(1.0 - phi**2) * draws[k]
        own = size * random.standard_normal(cycle.max() + 1)
        own[: 1 if name == "theta" else 2] = 0.0
        shared = np.cumsum(own) if name == "x" else own
        columns[name] = columns[name] + NOISE[name] * (draws + shared[cycle])
    return replace(run, columns=columns)


# The camera.


def rocking(frequency, height=0.1, rate=1e4):
    """A recording of a body that rocks harmonically and walks at 1 mm/s."""
    t, turn = np.arange(int(0.5 * rate) + 1) / rate, 2 * np.pi * frequency
    return {
        "t": t, "theta": height * np.sin(turn * t), "omega": height * turn * np.cos(turn * t),
        "x": 1e-3 * t, "vx": np.full(len(t), 1e-3), "z": np.full(len(t), 1e-4),
        "vz": np.zeros(len(t)),
    }  # fmt: skip


def test_a_frame_shows_the_mean_over_its_exposure():
    frequency, exposure, height = 421.0, 1e-3, 0.1
    times = np.arange(0.01, 0.48, 1 / 997.0)
    frames = CameraModel(exposure).frames(rocking(frequency, height), times)
    # The mean of a sine over an interval is the sine in its middle times sinc; cubic interpolation
    # errs by its fourth derivative, h^4 / 384.
    blurred = height * np.sinc(frequency * exposure) * np.sin(2 * np.pi * frequency * times)
    error = height * (2 * np.pi * frequency / 1e4) ** 4 / 384
    assert np.max(np.abs(frames["theta"] - blurred)) < 2 * error
    assert np.max(np.abs(frames["x"] - 1e-3 * times)) < 1e-15


def test_trigger_zero_scale_limit_and_marker_act_as_they_are_defined():
    motion, times = rocking(30.0, 0.5), np.arange(0.01, 0.48, 1e-3)
    late = CameraModel().frames(motion, times + 2e-3, ("x", "z", "theta"))
    theta = late["theta"]
    camera = CameraModel(0.0, 2e-3, 0.02, 1.1, angle_limit=0.3, marker_along=2e-5,
                         marker_across=5e-6, facing=-1.0)  # fmt: skip
    seen = camera.frames(motion, times, ("x", "z", "theta"))
    assert seen["theta"] == pytest.approx(np.clip(1.1 * theta + 0.02, -0.3, 0.3), abs=1e-12)
    # In -x the front lies behind in x; nose-down, which is positive, lowers what is ahead.
    x = late["x"] - 2e-5 * np.cos(theta) - 5e-6 * np.sin(theta)
    z = late["z"] - 2e-5 * np.sin(theta) + 5e-6 * np.cos(theta)
    assert seen["x"] == pytest.approx(x, abs=1e-15)
    assert seen["z"] == pytest.approx(z, abs=1e-15)
    # Before and after the recording the robot rests.
    ends = CameraModel(1e-3).frames(motion, np.array([-0.1, 0.7]))["theta"]
    assert ends == pytest.approx([motion["theta"][0], motion["theta"][-1]])


SCENARIO = ROBOT.replace({"drive.pulses": 4, "drive.ramp": 0.05})


def motion(changes, rate=None):
    values = np.array([list(changes.values())])
    return next(record(SCENARIO, list(changes), values, rate or recording_rate(SCENARIO), 1))


def test_scales_of_length_and_clock_are_on_all_that_is_read():
    length, clock = 0.03, 0.02
    times, names = np.arange(0.0, 0.15, 1e-3), ("x", "z", "theta", "current_x")
    plain = CameraModel(4e-4, marker_along=2e-5).frames(motion({}), times, names)
    camera = CameraModel(
        4e-4 * (1 + clock), length_scale=length, clock_scale=clock, marker_along=2e-5
    )
    read = camera.frames(motion({}), times * (1 + clock), names)
    for name in names:
        scale = 1 + length if name in ("x", "z") else 1
        assert np.allclose(read[name], plain[name] * scale, rtol=1e-12, atol=1e-14), name


def test_what_films_have_alike_is_read_by_the_camera():
    run = tracking_run({}, 500.0, 0)
    table = FilmTable(run)
    shared = [each.name for cause in table.instruments for each in cause.parameters]
    scales = {"length_scale.fraction": 0.03, "clock_scale.fraction": 0.02}
    assert scales.keys() | {"angle_offset.angle"} <= set(shared)
    plain, read = table.predict([*NAMES, *scales], np.vstack(
        [np.r_[VALUES[0], 0.0, 0.0], np.r_[VALUES[0], 0.03, 0.0]]))  # fmt: skip
    along = table.settings["column"] == "x"
    assert read[along] == pytest.approx(1.03 * plain[along], rel=1e-12)
    assert np.array_equal(read[~along], plain[~along])
    turned = table.predict([*NAMES, "angle_offset.angle"], np.c_[VALUES, [0.02]])
    own = table.predict([*NAMES, "tracking.1.angle_offset"], np.c_[VALUES, [0.02]])
    assert np.array_equal(turned, own)


def test_the_recording_rate_is_fine_enough_and_meets_the_edges():
    rate = recording_rate(SCENARIO)
    for edge in 0.05 + np.arange(4) / 30.0:
        assert edge * rate == pytest.approx(round(edge * rate), abs=1e-6)
    times = np.arange(0.0, 0.18, 7e-4)
    coarse, fine = (
        CameraModel(3e-4).frames(motion({}, each), times, ("x", "theta", "current_x"))
        for each in (rate, 20 * rate)
    )
    # Against pixels of a tenth of a micrometre, a fifth of a degree and a milliampere.
    for name, noise in (("x", 1e-7), ("theta", 3.5e-3), ("current_x", 1e-3)):
        assert np.max(np.abs(coarse[name] - fine[name])) < noise / 5


# Errors and observables.


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("rate", "stated", "errors"),
    [
        (500.0, True, (0.0, 0.0)),  # 50 phases, each seen three times
        (500.0, False, (0.0, 0.0)),
        (937.0, False, (0.0, 0.0)),  # no phase seen twice
        (200.0, True, (0.0, 0.0)),  # 20 phases; the rocking is aliased
        (500.0, True, (0.9, 0.0)),
        (500.0, False, (0.6, 0.0)),
        (1000.0, False, (0.7, 0.0)),
    ],
)
def test_the_true_model_fits_as_well_as_the_errors_say(rate, stated, errors):
    found = []
    for seed in range(20):
        run = tracking_run({}, rate, seed, stated=stated, noise={} if any(errors) else NOISE)
        table = FilmTable(with_errors(run, errors, seed) if any(errors) else run)
        found.append(misfit(table))
    chi2, p = np.array(found).T
    # Errors that are not known may count as larger, by up to a tenth.
    # A chi-square per row has variance 2 / rows and the share of its errors' size.
    band = norm.ppf(0.995) * np.sqrt((2.0 / len(table.mean) + 2.0 / table.errors.dof) / 20)
    assert 0.9 - band < np.mean(chi2) < 1.0 + band
    # At a rate of 5 % four or more of twenty have a chance of 1.6 %.
    assert np.sum(p < 0.05) <= 3


def test_correlation_and_scatter_of_periods_are_found_and_told():
    run = tracking_run({}, 1000.0, 0, noise={})
    table = FilmTable(with_errors(run, (0.7, 2.0), 0))
    told = table.errors.sizes
    for name in ("theta", "x"):
        # Some 300 frames less 100 phases: the standard error of phi is below 0.05.
        assert told[f"{name}.phi"] == pytest.approx(0.7, abs=0.15)
        # Eight or nine periods tell a scatter to a quarter.
        assert 0.5 < told[f"{name}.shared"] / (2.0 * NOISE[name]) < 1.75
    assert {each.code for each in table.notes} >= {"frames-correlated", "periods-differ"}
    # The advance is as uncertain as nine random steps make it.
    row = np.flatnonzero(table.settings["column"] == "x")[0]
    assert 0.5 < table.errors.sd[row] / (2.0 * NOISE["x"] / 3.0) < 1.75


def test_a_stated_noise_is_used_unless_the_frames_scatter_more():
    run = tracking_run({}, 500.0, 1)
    assert FilmTable(run).errors.sizes["x.sd"] == pytest.approx(NOISE["x"])
    small = FilmTable(replace(run, noise={"x": 0.3 * NOISE["x"], "theta": 2.0 * NOISE["theta"]}))
    assert [each.code for each in small.notes] == ["frame-noise-above-stated"]
    # 100 degrees of freedom tell a scatter to 7 %.
    assert small.errors.sizes["x.sd"] == pytest.approx(NOISE["x"], rel=0.25)
    assert small.errors.sizes["theta.sd"] == pytest.approx(2.0 * NOISE["theta"])
    large = FilmTable(replace(run, noise={"x": 30.0 * NOISE["x"], "theta": NOISE["theta"]}))
    assert [each.code for each in large.notes] == ["frame-noise-below-stated"]


def test_camera_parameters_belong_to_one_film():
    own = [f"tracking.2.{key}" for key in ("angle_offset", "angle_scale", "trigger")]
    camera = CameraModel(3e-4, trigger=3e-4, angle_offset=0.02, angle_scale=1.02)
    run = TrackingRun("a.csv", film(TRUE, camera, 500.0, 0), ROBOT, 3e-4, NOISE)
    table = FilmTable(run, 2)
    assert (table.name, [each.name for each in table.nuisance]) == ("tracking.2", own)
    assert not any(each.cause for each in table.nuisance)
    told = np.hstack([VALUES, [[0.02, 1.02, 3e-4]]])
    assert misfit(table, [*NAMES, *own], told)[1] > 0.001
    assert misfit(table)[1] < 1e-9
    # A delay of all films is a trigger of one.
    late = np.hstack([VALUES, [[0.02, 1.02, 1e-4, 2e-4]]])
    both = table.predict([*NAMES, *own, "film_delay.time"], late)
    assert both[0] == pytest.approx(table.predict([*NAMES, *own], told)[0], rel=1e-9, abs=1e-15)


@pytest.mark.nightly
def test_predictions_come_row_by_row_for_any_number_of_threads():
    run = tracking_run({}, 500.0, 0)
    names = [*NAMES, "tracking.1.trigger"]
    rows = np.array([[0.15, 1e-5, 0.0], [0.15, 1e-5, 2e-4], [0.3, 1e-5, 0.0], [0.14, 2e-5, 0.0]])
    one, three = (FilmTable(run, 1, threads).predict(names, rows) for threads in (1, 3))
    assert np.array_equal(one, three, equal_nan=True)
    assert np.all(np.isnan(one[2]))  # kinetic above static friction
    assert not np.array_equal(one[0], one[1])
    assert np.array_equal(one[3], FilmTable(run).predict(names, rows[3:])[0])


def test_currents_see_the_drive_alone():
    names = ("x", "theta", "z", "current_x", "current_clamp")
    table = FilmTable(tracking_run({}, 500.0, 0, names=names))
    column = table.settings["column"]
    assert list(dict.fromkeys(column)) == ["theta", "x", "z", "current_x", "current_clamp"]
    assert table.nuisance[-1].name == "tracking.1.current_scale"
    keys = ["effects.coil_heating.coefficient", "contact.kinetic_friction"]
    plain, heated, rough = table.predict(keys, np.array([[0, 0.15], [2e-3, 0.15], [0, 0.16]]))
    current = column == "current_x"
    assert np.array_equal(plain[current], rough[current])
    assert np.all(heated[current] < plain[current] + 1e-12)
    assert not np.array_equal(plain[~current], rough[~current])


def test_wild_frames_are_left_out_and_rounding_is_an_error():
    run = tracking_run({}, 1000.0, 3)
    columns = {name: each.copy() for name, each in run.columns.items()}
    columns["theta"][[200, 331]] += 1.5
    columns["x"] = 5e-6 * np.round(columns["x"] / 5e-6)
    table = FilmTable(replace(run, columns=columns))
    assert [(each.code, each.value) for each in table.left_out] == [("wild-frames", 2)]
    assert table.columns["x"][0].sum() == np.sum(run.columns["t"] >= ROBOT.drive.ramp)
    # Steps of ten times the noise scatter by at least a twelfth of their square.
    x = table.settings["column"] == "x"
    assert np.min(table.errors.sd[x][1:]) > 5e-6 / np.sqrt(12.0) / np.sqrt(16.0)
    assert misfit(table)[0] < 1.5


def test_the_drive_is_folded_from_the_end_of_the_third_pulse():
    folded = fold(np.arange(0.0, 0.2, 1e-3), ROBOT)
    assert folded.steady.tolist() == [False] * 150 + [True] * 50
    assert folded.cycle[150:].tolist() == [0] * 34 + [1] * 16
    assert folded.bin[150] == len(np.unique(folded.bin[~folded.steady]))


def test_a_program_of_voltages_is_binned_in_time():
    program = Waveform.ipp(base=0.5e-3, frequency=30.0, pulses=5)
    scenario = Scenario().replace({"drive.mode": "program", "drive.program": program})
    times = np.arange(0.0, scenario.window[1], 1e-3)
    shown = next(record(scenario.replace(TRUE), [], np.zeros((1, 0)), 9e4, 1))
    frames = noisy(CameraModel(3e-4).frames(shown, times), NOISE, np.random.default_rng(2))
    run = TrackingRun("a.csv", {"t": times, **frames}, scenario, 3e-4, NOISE)
    table = FilmTable(run)
    assert len(table.mean) == 24 + 23  # levels of theta; of x all but the origin
    assert misfit(table)[1] > 0.001
    assert table.over_phase(NAMES, VALUES[0]) is None
    unknown = FilmTable(replace(run, noise={}))
    assert [each.code for each in unknown.notes] == ["frame-noise-unknown"] * 2


@pytest.mark.parametrize(("rate", "frames"), [(1000.0, slice(150, 175)), (70.0, slice(None))])
def test_a_short_or_slow_film_is_used_for_what_it_shows(rate, frames):
    run = tracking_run({}, rate, 1)
    table = FilmTable(replace(run, columns={k: v[frames] for k, v in run.columns.items()}))
    assert misfit(table)[1] > 0.001
    times = run.columns["t"][frames]
    assert fold(times, run.scenario).advances == (rate == 70.0)  # 25 ms are less than a period


def test_frames_lie_on_the_true_model_over_the_phase():
    tilt = "effects.surface_tilt.angle"
    table = FilmTable(tracking_run({tilt: 0.06}, 1000.0, 0))
    true, plain = (table.over_phase([*NAMES, tilt], np.append(VALUES[0], k)) for k in (0.06, 0.0))
    assert np.all(np.diff(true["phase"]) >= 0.0)
    # The origins of pixels and of the model are no part of it.
    assert [np.mean(true[key]) for key in ("x", "x_model")] == pytest.approx([0.0, 0.0], abs=1e-15)
    for name in ("theta", "x"):
        error = np.std(true[name] - true[f"{name}_model"]) / NOISE[name]
        # 300 frames tell a standard deviation to 4 %; the median advance adds a little.
        assert error == pytest.approx(1.0, abs=0.2)
    assert np.std(plain["x"] - plain["x_model"]) > 2.0 * NOISE["x"]
