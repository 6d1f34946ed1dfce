"""Pulses that go on steadily are extrapolated where nothing is recorded, within a stated error."""

import numpy as np
import pytest

from stickslip import Drive, Scenario, simulate, sweep

FREQUENCIES = np.linspace(20.0, 90.0, 36).tolist()


def walking(**drive):
    return Scenario(drive=Drive(base=0.5e-3, pulses=60, **drive)).replace({"solver.rtol": 1e-7})


def displacements(scenario):
    """Of all pulses, m, from a record of the run."""
    frequency = scenario.drive.frequency
    run = simulate(scenario.replace({"record.rate": 256.0 * frequency}))
    ends = scenario.drive.ramp + np.arange(scenario.drive.pulses + 1) / frequency
    return np.diff(np.interp(ends, run.t, run.x))


@pytest.mark.parametrize("mode", ["IPP", "OPP"])
def test_extrapolated_velocities_are_within_the_stated_error(mode):
    base = walking(mode=mode)
    grid = {"drive.frequency": FREQUENCIES}
    whole = sweep(base, grid)
    error = 1e-3 * float(np.median(np.abs(whole.mean_velocity)))
    found = sweep(base.replace({"solver.velocity_error": error}), grid)
    off = np.abs((found.mean_velocity - whole.mean_velocity).values)
    # A robot that walks on may come to where its motion is of another kind, which pulses before
    # that do not tell: their displacements jump, by some thousandths.
    series = [displacements(base.replace({"drive.frequency": each})) for each in FREQUENCIES]
    jump = np.array([np.max(np.abs(np.diff(d[3:-1]))) / np.median(np.abs(d)) for d in series])
    smooth = jump < 1e-3
    assert np.count_nonzero(smooth) > len(smooth) / 2
    assert np.all(off[smooth] <= error)
    assert np.all(
        off <= 57.0 / 60.0 * jump * np.median(np.abs(series), axis=1) * FREQUENCIES + error
    )
    # No more is extrapolated than was simulated, and mostly about as much.
    spared = (found.simulated_time / whole.simulated_time).values
    assert np.all(spared > 0.5)
    assert np.median(spared) < 0.6


def test_a_run_says_what_it_has_extrapolated():
    scenario = walking().replace({"solver.velocity_error": 1e-5})
    run, whole = simulate(scenario), simulate(walking())
    finished = run.summary()["finished_pulses"]
    assert finished < 57 == whole.summary()["finished_pulses"]
    assert abs(run.mean_velocity - whole.mean_velocity) <= 1e-5
    (note,) = [each for each in run.notes if "extrapolated" in each]
    assert f"{finished} of the 57 pulses" in note
    assert not [each for each in whole.notes if "extrapolated" in each]


def test_a_run_that_is_recorded_or_has_a_condition_is_simulated_to_its_end():
    scenario = walking().replace({"solver.velocity_error": 1e-5})
    recorded = simulate(scenario.replace({"record.rate": "events"}))
    assert recorded.mean_velocity == simulate(walking()).mean_velocity
    assert recorded.summary()["finished_pulses"] == 57


def test_the_power_of_a_run_that_ends_between_stretches_is_that_of_its_window():
    # A held field: after its rise the power is constant, and a stop must not count a stretch twice.
    scenario = Scenario(drive=Drive(mode="IPP", frequency=40.0, pulses=20))
    stop = scenario.window[0] + 5.0 / 40.0
    short = simulate(scenario.replace({"drive.pulses": 8}))
    ended = simulate(scenario, until=f"time >= {stop!r}")
    assert ended.summary()["power_mean"] == pytest.approx(short.summary()["power_mean"], rel=1e-9)
