"""Mean velocities from a tracked centre: beside the summary of the same run.

Noise is 2 um a frame. The expected error of the fit is that of a line through n independent
readings over a window of the duration T, s sqrt(12 / n) / T.
"""

import functools

import numpy as np
import pandas as pd
import pytest

from stickslip import Drive, Measurement, Record, Scenario, simulate, velocity_of_track

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
