"""Mean velocities from a tracked centre: beside the summary of the same run.

Noise is 2 um a frame. The expected error of the fit is that of a line through n independent
readings over a window of the duration T, s sqrt(12 / n) / T.
"""

import functools
import warnings

import numpy as np
import pandas as pd
import pytest

from stickslip import (
    Drive,
    Measurement,
    Record,
    Scenario,
    ScenarioError,
    simulate,
    velocity_of_track,
)

NOISE = 2e-6  # m
IPP = Drive(mode="IPP", frequency=30.0, base=0.5e-3, pulses=30)
OPP = Drive(mode="OPP", frequency=100.0, hold=2.5e-3, edge="fall", pulses=60)
SETTLING = 1e-3
"""Part of the velocity: what the start leaves after the third pulse is no part of the fit."""


@functools.cache
def run_of(drive):
    return simulate(Scenario(drive=drive, record=Record(rate=20e3)))


def film(drive, rate, random, noise=NOISE):
    """Times and noisy places of frames whose first one is anywhere in a frame's time."""
    run = run_of(drive)
    t = np.arange(random.uniform(0.0, 1.0 / rate), run.t[-1], 1.0 / rate)
    return t, np.interp(t, run.t, run.x) + noise * random.standard_normal(len(t))


@pytest.mark.parametrize("rate", [100.0, 237.0, 1000.0])
@pytest.mark.parametrize("drive", [IPP, OPP], ids=["IPP", "OPP"])
def test_noisy_frames_give_the_velocity_of_the_run_with_the_error_that_is_stated(drive, rate):
    random, scenario, films = np.random.default_rng(2), Scenario(drive=drive), 80
    truth = run_of(drive).mean_velocity
    found = pd.DataFrame(
        [velocity_of_track(*film(drive, rate, random), drive) for _ in range(films)]
    )
    velocity, error = found["velocity"].to_numpy(), found["standard_error"].to_numpy()
    stated = np.sqrt(np.mean(error**2))
    # 80 films tell a standard deviation to 8 %, and the mean to 11 % of it: three of each.
    assert velocity.std() == pytest.approx(stated, rel=0.24)
    assert abs(velocity.mean() - truth) < 0.33 * stated + SETTLING * truth
    start, end = scenario.window
    line = NOISE * np.sqrt(12.0 / ((end - start) * rate)) / (end - start)
    assert 0.9 * line < stated
    if rate == 1000.0:  # the motion within a pulse is resolved, and costs nothing
        assert stated < 1.1 * line


@pytest.mark.parametrize("beat", [0.0, 0.3, 1.0])
def test_frames_that_nearly_keep_step_with_the_pulses_have_a_larger_error_that_holds(beat):
    # The centre sways by some 10 um in a pulse. At a beat of 1 Hz this is seen as a motion of half
    # a second, much of the window, and taken alone for a velocity of some ten um/s.
    random, scenario = np.random.default_rng(4), Scenario(drive=OPP)
    truth = run_of(OPP).mean_velocity
    rate = OPP.frequency + beat
    found = pd.DataFrame([velocity_of_track(*film(OPP, rate, random), OPP) for _ in range(60)])
    velocity, error = found["velocity"].to_numpy(), found["standard_error"].to_numpy()
    off = np.sqrt(np.mean((velocity - truth) ** 2))
    assert off < 1.2 * np.sqrt(np.mean(error**2)) + SETTLING * truth
    start, end = scenario.window
    line = NOISE * np.sqrt(12.0 / ((end - start) * rate)) / (end - start)
    # In step all frames have one phase, and nothing is mistaken.
    assert error.max() < 2.0 * line if beat == 0.0 else error.min() > 5.0 * line


def test_without_noise_neither_phase_nor_gaps_nor_order_matter():
    random = np.random.default_rng(5)
    t, x = film(IPP, 500.0, random, noise=0.0)
    truth = run_of(IPP).mean_velocity
    assert velocity_of_track(t, x, IPP)["velocity"] == pytest.approx(truth, rel=SETTLING)
    kept = random.permutation(len(t))[: len(t) // 2]
    lost = np.where(np.arange(len(kept)) % 7 == 0, np.nan, x[kept])
    assert velocity_of_track(t[kept], lost, IPP)["velocity"] == pytest.approx(truth, rel=SETTLING)


def test_rows_are_a_table_that_the_reader_takes_with_all_settings():
    random = np.random.default_rng(6)
    drives = [IPP, OPP]
    films = [film(each, 400.0, random) for each in drives]
    rows = [velocity_of_track(*seen, each) for seen, each in zip(films, drives, strict=True)]
    assert rows[0] == velocity_of_track(*films[0], Scenario(drive=IPP))
    table = pd.DataFrame(rows)
    (data,) = Measurement.from_dataframe(table, Scenario()).velocity
    np.testing.assert_array_equal(data.velocity, table["velocity"])
    for condition, drive in zip(data.conditions, drives, strict=True):
        assert Scenario().replace(dict(condition)).drive == drive


# Place of a walk at u, from 0 at the start of the track to 1 at its end, in its own time.
UNSTEADY = {
    "filmed before the drive": lambda u: np.maximum(u - 0.25, 0.0),
    "rests before": lambda u: np.maximum(u - 0.3, 0.0) / 0.7,
    "rests in the middle": lambda u: np.where(u < 0.4, u, np.maximum(u - 0.2, 0.4)),
    "rests after": lambda u: np.minimum(u, 0.75),
    "rests twice": lambda u: np.clip(u, 0.0, 0.3) + np.clip(u - 0.4, 0.0, 0.3)
    + np.maximum(u - 0.8, 0.0),
    "stops soon": lambda u: np.minimum(u, 0.4),
    "twice as fast from the middle": lambda u: u + np.maximum(u - 0.5, 0.0),
    "twice as fast late": lambda u: u + np.maximum(u - 0.75, 0.0),
    "half as fast early": lambda u: u - 0.5 * np.minimum(u, 0.3),
    "turns back in the middle": lambda u: 0.5 - np.abs(u - 0.5),
    "turns back late": lambda u: 0.8 - np.abs(u - 0.8),
    "goes to and fro": lambda u: u + 0.1 * np.sin(9.0 * u),
    "the camera jumps ahead": lambda u: u + 0.12 * (u > 0.37),
    "the camera jumps back": lambda u: u - 0.12 * (u > 0.62),
    "the camera is pushed and put back": lambda u: u + 0.1 * (np.abs(u - 0.5) < 0.15),
}  # fmt: skip


def judged(t, x, drive, truth):
    """Standard errors by which a velocity is off, and whether there was a warning or refusal."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            row = velocity_of_track(t, x, drive)
        except ScenarioError:
            return np.inf, True
    return abs(row["velocity"] - truth) / row["standard_error"], bool(said)


@pytest.mark.parametrize("noise", [NOISE, 10.0 * NOISE])
@pytest.mark.parametrize("kind", UNSTEADY)
@pytest.mark.parametrize("drive", [IPP, OPP], ids=["IPP", "OPP"])
def test_a_track_that_is_no_steady_walk_is_told_or_right_within_its_error(drive, kind, noise):
    random, run = np.random.default_rng(7), run_of(drive)
    start, end = Scenario(drive=drive).window
    for rate in (100.0, 237.0, 1000.0):
        t, walked = film(drive, rate, random, noise)
        shift, before, after = (
            run.x[-1] * (UNSTEADY[kind](at / run.t[-1]) - at / run.t[-1])
            for at in (t, np.array(start), np.array(end))
        )
        whole = run.mean_velocity + (after - before) / (end - start)
        off, told = judged(t, walked + shift, drive, whole)
        assert off < 5.0 or told, rate
    # The hard case is told, not just right: all frames of a long film with little noise.
    assert told or noise > NOISE


def test_sound_tracks_get_no_warning():
    random, told, far = np.random.default_rng(8), 0, 0
    for k in range(200):
        # Steps of a frame in two pulses and more; velocities that change by up to 30 %.
        drive, rate = (IPP, OPP)[k % 2], (20.0, 45.0, 100.0, 237.0, 700.0)[k % 5]
        t, x = film(drive, rate, random, 10.0 ** random.uniform(-7.0, -4.5))
        start, end = Scenario(drive=drive).window
        run, change = run_of(drive), random.uniform(-0.15, 0.15) * (k % 3 > 0)
        x = x + change * run.x[-1] * (t / end) ** 2
        more = change * run.x[-1] * (1.0 - (start / end) ** 2) / (end - start)
        off, said = judged(t, x, drive, run.mean_velocity + more)
        told, far = told + said, far + (off > 5.0)
    assert told <= 2
    assert far <= 2


@pytest.mark.parametrize("how", ["each frame three times", "filled in by lines"])
def test_frames_that_a_camera_did_not_take_are_left_out(how):
    t, x = film(IPP, 100.0, np.random.default_rng(4))
    fine = np.arange(3 * len(t) - 2) / 3.0
    place = x[fine.astype(int)] if "each" in how else np.interp(fine, np.arange(len(t)), x)
    plain = velocity_of_track(t, x, IPP)
    with pytest.warns(UserWarning, match="frames are repeats, lines between others"):
        found = velocity_of_track(np.interp(fine, np.arange(len(t)), t), place, IPP)
    assert found["velocity"] == pytest.approx(plain["velocity"], rel=1e-3)
    assert found["standard_error"] == pytest.approx(plain["standard_error"], rel=0.05)
