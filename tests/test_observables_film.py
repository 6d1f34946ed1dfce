"""Films: observables and their errors, and what `diagnose` makes of them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from command_line import stickslip
from films import NOISE, ROBOT, TRUE, film, noisy, tracking_run, write_films
from reference import simulate_reference
from report_page import without_pictures
from stickslip import Scenario, Waveform, simulate_batch
from stickslip.diagnosis import measurement_problem
from stickslip.diagnosis.api import diagnose
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.observables.tracking.camera import Camera, record
from stickslip.diagnosis.observables.tracking.film import FilmObservable
from stickslip.diagnosis.observables.tracking.folding import fold
from stickslip.diagnosis.observables.tracking.smoothed_motion import smoothed_motion
from stickslip.diagnosis.report.film_figure import traces
from stickslip.diagnosis.report.film_section import drift_lines
from stickslip.diagnosis.report.html import report_sections
from stickslip.diagnosis.report.parameters import extended_parameters
from stickslip.facts import Code
from stickslip.measurement import read_measurement
from stickslip.measurement.tracking import TrackingRun

NAMES = list(TRUE)
VALUES = np.array([list(TRUE.values())])


def whitened(observable, names=NAMES, values=VALUES):
    left = observable.observed - observable.predict(names, values)[0]
    return np.linalg.solve(np.linalg.cholesky(observable.covariance), left)


@pytest.mark.parametrize(
    ("rate", "exposure", "drive"),
    [
        (1000.0, 3e-4, {}),  # 100 phases, each seen three times
        (937.0, 3e-4, {"drive.direction": "-x"}),  # no phase seen twice
        (200.0, 1e-3, {}),  # 20 phases; the rocking is aliased
    ],
)
def test_residuals_of_the_true_model_are_standard_normal(rate, exposure, drive):
    scores = []
    for seed in range(40):
        run = tracking_run({}, rate, seed, exposure, drive=drive)
        scores.append(np.mean(whitened(observable := FilmObservable(run)) ** 2))
    # A chi-square per row has variance 2 / rows; its mean over 40 films is all but normal.
    band = norm.ppf(0.995) * np.sqrt(2.0 / len(observable.observed) / 40)
    assert abs(np.mean(scores) - 1.0) < band


def test_unstated_noise_is_found_and_rather_too_large():
    scores, sizes = [], []
    for seed in range(40):
        observable = FilmObservable(tracking_run({}, 500.0, seed, stated=False))
        scores.append(np.mean(whitened(observable) ** 2))
        sizes += [each.sd / NOISE[each.name] for each in observable.quantities]
    # One standard deviation of the estimate is added: 1 / sqrt(2 * 99) of it, 99 repeats being
    # 150 frames at 50 phases less the advance. The mean over films errs far less.
    expected = 1.0 + 1.0 / np.sqrt(2 * 99)
    assert np.mean(sizes) == pytest.approx(expected, abs=0.02)
    assert np.mean(scores) == pytest.approx(expected**-2, abs=0.05)


def test_camera_parameters_are_nuisance_parameters_and_not_causes():
    observable = FilmObservable(tracking_run({}, 500.0, 0), 2)
    assert observable.name == "tracking.2"
    assert [each.name for each in observable.nuisance] == [
        "tracking.2.angle_offset", "tracking.2.angle_scale", "tracking.2.trigger",
    ]  # fmt: skip
    assert not any(each.suspect for each in observable.nuisance)
    own = [each.name for each in observable.nuisance]
    camera = Camera(3e-4, trigger=3e-4, angle_offset=0.02, angle_scale=1.02)
    run = TrackingRun("a.csv", film(TRUE, camera, 500.0, 0), ROBOT, 500.0, 3e-4, NOISE)
    told = np.hstack([VALUES, [[0.02, 1.02, 3e-4]]])
    free = FilmObservable(run, 2)
    assert np.mean(whitened(free, [*NAMES, *own], told) ** 2) < 1.6
    assert np.mean(whitened(free) ** 2) > 5.0


def test_predictions_come_row_by_row_for_any_number_of_threads():
    run = tracking_run({}, 500.0, 0)
    names = [*NAMES, "tracking.1.trigger"]
    rows = np.array([[0.15, 1e-5, 0.0], [0.15, 1e-5, 2e-4], [0.3, 1e-5, 0.0], [0.14, 2e-5, 0.0]])
    one, three = (FilmObservable(run, 1, threads).predict(names, rows) for threads in (1, 3))
    assert np.array_equal(one, three, equal_nan=True)
    assert np.all(np.isnan(one[2]))  # kinetic above static friction
    assert not np.array_equal(one[0], one[1])
    assert np.array_equal(one[3], FilmObservable(run).predict(names, rows[3:])[0])


def test_currents_see_the_drive_alone():
    names = ("x", "theta", "current_x", "current_clamp")
    run = tracking_run({}, 500.0, 0, names=names)
    observable = FilmObservable(run)
    plain, heated, rough = observable.predict(
        ["effects.coil_heating.coefficient", "contact.kinetic_friction"],
        np.array([[0.0, 0.15], [2e-3, 0.15], [0.0, 0.16]]),
    )
    sizes = [len(each.observed) for each in observable.quantities]
    places = np.split(np.arange(sum(sizes)), np.cumsum(sizes)[:-1])
    names = [each.name for each in observable.quantities]
    current = places[names.index("current_x")]
    assert np.array_equal(plain[current], rough[current])
    assert np.all(heated[current] < plain[current] + 1e-12)
    assert not np.array_equal(plain[places[0]], rough[places[0]])


def test_frames_far_from_their_phase_are_left_out():
    run = tracking_run({}, 1000.0, 3)
    wild = dict(run.columns)
    wild["theta"] = wild["theta"].copy()
    wild["theta"][[200, 331]] += 1.5
    observable = FilmObservable(
        TrackingRun(run.file, wild, run.scenario, run.frame_rate, run.exposure, run.noise)
    )
    wild = [each.fields["count"] for each in observable.left_out if each.code is Code.WILD_FRAMES]
    assert wild == [2]
    assert np.mean(whitened(observable) ** 2) < 1.4


@pytest.mark.nightly
def test_a_film_of_the_independent_simulator_fits_the_true_model():
    contact = {"kinetic_friction": TRUE["contact.kinetic_friction"]}
    drive = {"mode": "IPP", "frequency": 30.0, "base": 0.5e-3, "hold": 1e-3, "pulses": 12}
    other = simulate_reference(
        drive, contact=contact, drag={"linear": TRUE["drag.linear"]}, dt=2e-7, rate=2e4
    )
    motion = {name: getattr(other, name) for name in ("t", "x", "theta", "vx", "omega")}
    times = np.arange(0.0, 0.449, 1e-3)
    frames = noisy(Camera(3e-4).frames(motion, times), NOISE, np.random.default_rng(5))
    run = TrackingRun("a.csv", {"t": times, **frames}, ROBOT, 1000.0, 3e-4, NOISE)
    left = whitened(FilmObservable(run))
    # 99.9 % of chi-squares per row lie below this; the two simulators differ by far less.
    assert np.mean(left**2) < 1.0 + norm.ppf(0.999) * np.sqrt(2.0 / len(left))


def test_the_drive_is_folded_from_the_end_of_the_third_pulse():
    folded = fold(np.arange(0.0, 0.2, 1e-3), ROBOT)
    assert folded.steady.tolist() == [False] * 150 + [True] * 50
    assert folded.distinct() == 50
    assert folded.first_steady == len(np.unique(folded.bin[~folded.steady]))


def test_a_program_of_voltages_is_binned_in_time():
    program = Waveform.ipp(base=0.5e-3, frequency=30.0, pulses=5)
    scenario = Scenario().replace({"drive.mode": "program", "drive.program": program})
    times = np.arange(0.0, scenario.window[1], 1e-3)
    values = dict(zip(NAMES, VALUES[0], strict=True))
    motion = next(record(scenario.replace(values), [], np.zeros((1, 0)), 9e4, 1))
    frames = noisy(Camera(3e-4).frames(motion, times), NOISE, np.random.default_rng(2))
    observable = FilmObservable(
        TrackingRun("a.csv", {"t": times, **frames}, scenario, 1000.0, 3e-4, NOISE)
    )
    left = whitened(observable)
    assert len(left) == 24 + 23  # levels of theta; of x all but the origin
    assert np.mean(left**2) < 1.0 + norm.ppf(0.999) * np.sqrt(2.0 / len(left))
    assert smoothed_motion(observable, NAMES, VALUES[0]) is None


@pytest.mark.parametrize(("rate", "frames"), [(1000.0, slice(150, 175)), (70.0, slice(None))])
def test_a_short_or_slow_film_is_used_for_what_it_shows(rate, frames):
    run = tracking_run({}, rate, 1)
    columns = {name: column[frames] for name, column in run.columns.items()}
    observable = FilmObservable(TrackingRun("a.csv", columns, ROBOT, rate, 3e-4, NOISE))
    left = whitened(observable)
    assert np.mean(left**2) < 1.0 + norm.ppf(0.999) * np.sqrt(2.0 / len(left))
    assert (observable.advance is None) == (rate == 1000.0)  # 25 ms are less than a period
    held_out = np.zeros(len(observable.observed), dtype=bool)
    comparison = observable.comparison(NAMES, VALUES[0], None, held_out)
    assert report_sections([comparison])[0].lines


# The motion over a pulse, as the report shows it.


def test_nothing_drifts_where_the_model_is_true():
    drifts = []
    for seed in range(6):
        seen = smoothed_motion(FilmObservable(tracking_run({}, 1000.0, seed)), NAMES, VALUES[0])
        assert [each.code for each in drift_lines(seen)] == [Code.NO_DRIFT_OF_PERIODS]
        drifts += [value / sd for value, sd in (seen.drift_theta, seen.drift_advance)]
    # Twelve numbers of variance one: the mean square is within 1 +- 3.3 sqrt(2 / 12).
    assert np.mean(np.square(drifts)) < 1.0 + 3.3 * np.sqrt(2 / 12)


def test_a_tilt_that_grows_from_period_to_period_drifts():
    run = tracking_run({}, 1000.0, 0)
    rate = 2e-3
    theta = run.columns["theta"] + rate * ROBOT.drive.frequency * run.columns["t"]
    grown = replace(run, columns={**run.columns, "theta": theta})
    seen = smoothed_motion(FilmObservable(grown), NAMES, VALUES[0])
    value, sd = seen.drift_theta
    assert abs(value - rate) < 3.5 * sd
    assert [each.code for each in drift_lines(seen)] == [Code.DRIFT_OF_TILT]


def test_the_drawn_motion_lies_on_the_readings_if_the_cause_is_right():
    tilt = "effects.surface_tilt.angle"
    observable = FilmObservable(tracking_run({tilt: 0.06}, 1000.0, 0))
    before = smoothed_motion(observable, NAMES, VALUES[0])
    after = smoothed_motion(observable, [*NAMES, tilt], np.append(VALUES[0], 0.06))
    place = traces(before, after)[1]
    # A fit of 2 n + 1 harmonics to so many frames of this noise.
    frames = 1000.0 * 9 / 30.0  # nine periods: three of twelve settle
    noise = 1e6 * NOISE["x"] * np.sqrt((2 * before.orders + 1) / frames)
    error = {
        stage: np.std(place.measured - getattr(place, stage))
        for stage in ("recalibrated", "extended")
    }
    # An rms of 2 n + 1 numbers is within a quarter of its mean; a half for what the cause's own
    # error adds. What the tilt does not do is many times the noise.
    assert error["extended"] < 1.5 * noise
    assert error["recalibrated"] > 3.0 * noise


def test_the_camera_of_another_model_moves_no_drawn_curve():
    before = smoothed_motion(FilmObservable(tracking_run({}, 1000.0, 0)), NAMES, VALUES[0])
    moved = {"theta": 0.02, "theta_model": 0.02, "place": 3e-6, "place_model": 3e-6}
    after = replace(before, **{key: getattr(before, key) + by for key, by in moved.items()})
    for trace in traces(before, after):
        np.testing.assert_allclose(trace.extended, trace.recalibrated, atol=1e-12)


# From films to a verdict.


@pytest.mark.nightly
def test_a_tilt_is_found_in_films_of_both_directions(tmp_path):
    path = write_films(tmp_path, {"effects.surface_tilt.angle": 0.03}, 500.0, seed=4)
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["verdict"] in ("named", "ambiguous")
    assert "surface_tilt" in said["cause"]
    angle = said["parameters"]["surface_tilt.angle"]
    assert abs(angle["value"] - 0.03) < max(3 * angle["sd"], 0.0015)
    full = json.loads((tmp_path / "found" / "report.json").read_text())
    titles = list(full["channels"])
    assert titles[:2] == ["Tracking of run0.csv", "Tracking of run1.csv"]
    assert [full["channels"][title]["held_out"] for title in titles[:2]] == [False, True]
    both = full["channels"]["run0.csv and run1.csv: forward and reversed"]
    assert both["advance_sum"] > 10 * both["advance_sum_sd"]
    advance = full["channels"][titles[0]]["advance"]
    assert abs(advance["extended"] - advance["measured"]) < 4 * advance["sd"]
    assert abs(advance["recalibrated"] - advance["measured"]) > 10 * advance["sd"]
    page = without_pictures(tmp_path / "found" / "report.html")
    assert "do not cancel" in page
    assert "A pulse moves the robot by" in page
    assert "http" not in page


def test_aliased_films_without_a_cause_name_nothing(tmp_path):
    measurement = read_measurement(write_films(tmp_path, {}, 200.0, seed=1, exposure=1e-3))
    found = diagnose(measurement).findings
    assert found.verdict.kind == "none"
    assert found.detection.p_value > 0.05


@pytest.mark.nightly
def test_a_film_and_velocities_of_opposite_directions_are_diagnosed_together(tmp_path, monkeypatch):
    # What helps the robot one way hinders it the other; of either alone the constants can make up
    # for most. Three causes are enough to choose from.
    some = ("surface_tilt", "friction_anisotropy", "field_gain")
    monkeypatch.setattr(
        measurement_problem,
        "library",
        lambda *a: tuple(each for each in library(*a) if each.name in some),
    )
    hidden = {"effects.surface_tilt.angle": 0.04}
    path = write_films(tmp_path, hidden, 300.0, seed=4, ways=["+x"])
    robot = ROBOT.replace({**TRUE, **hidden, "drive.direction": "-x"})
    paces = (30.0, 40.0, 50.0, 60.0)
    runs = simulate_batch([robot.replace({"drive.frequency": f}) for f in paces])
    random = np.random.default_rng(4)
    lines = ["direction,frequency,trial,velocity"]
    for f, run in zip(paces, runs, strict=True):
        for trial in range(3):
            velocity = run.mean_velocity * (1 + 0.02 * random.standard_normal())
            lines.append(f"-x,{f},{trial},{velocity!r}")
    (tmp_path / "velocity.csv").write_text("\n".join(lines) + "\n")
    film = path.read_text()
    head, _, _ = film.partition("[[tracking]]")
    table = '\n[[velocity]]\nfile = "velocity.csv"\n'

    def found(text):
        path.write_text(text)
        return diagnose(read_measurement(path)).findings

    for text in (film, head + table):
        assert found(text).verdict.kind != "named"
    both = found(film + table)
    assert (both.verdict.kind, both.verdict.causes) == ("named", ("surface_tilt",))
    angle = extended_parameters(both)["effects.surface_tilt.angle"]
    assert abs(angle["value"] - 0.04) < 3 * angle["sd"] < 0.01
    # Velocities are held out, and the frames are none of them.
    assert len(both.noise.mean) == len(paces)
    assert len(both.problem.observed) > len(paces) + 20
