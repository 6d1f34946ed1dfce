"""Figures of the drive in a run's summary: field, current, voltage and power of the coils."""

import math

import numpy as np
import pytest

from stickslip import Coils, Drive, Scenario, Waveform, simulate

RECORDED = {"record.rate": 1e5}


def held(voltages, duration=0.1, **changes):
    program = Waveform.hold(duration, voltages)
    return Scenario(drive=Drive(mode="program", program=program)).replace(changes)


def test_a_held_voltage_has_the_analytic_current_and_power():
    # Eq. (1): I = U/R (1 - exp(-t/T)), and the integral of R I^2 over its rise.
    run = simulate(held({"clamp": -12.0}))
    coil = run.scenario.coil
    steady, lag = 12.0 / coil.resistance, coil.inductance / coil.resistance
    d = 0.1
    squares = d - 2.0 * lag * (1 - math.exp(-d / lag)) + lag / 2 * (1 - math.exp(-2 * d / lag))
    summary = run.summary()
    assert summary["voltage_max"] == 12.0
    assert summary["current_max"] == pytest.approx(steady * (1 - math.exp(-d / lag)), rel=1e-12)
    power = coil.resistance * steady**2 * squares / d
    assert summary["power_mean"] == pytest.approx(power, rel=1e-12)
    # The current is largest at the end: the field of the current there.
    at = [run.final_state.x, 0.0, run.final_state.z]
    field = np.linalg.norm(Coils().field([at], [0, 0, 0, 0, 1.0])[0])
    # The local expansion is within 1e-9 of the full sum.
    expected = summary["current_max"] * field
    assert summary["field_max"] == pytest.approx(expected, rel=1e-8)


def test_the_figures_are_those_of_the_record():
    scenario = Scenario(drive=Drive(base=-0.5e-3, frequency=60.0, pulses=8)).replace(RECORDED)
    run = simulate(scenario)
    start, end = scenario.window
    size = np.hypot(run.bx, run.bz)
    measured = (run.t >= start) & (run.t <= end)
    summary = run.summary()
    # Between two samples the current changes by 1e-5 s over a lag of 7 ms, 0.15 % of its swing, and
    # a robot that moves 0.1 mm in a stretch sees 1e-5 T less.
    assert summary["field_max"] == pytest.approx(size.max(), rel=1e-2)
    assert summary["field_min"] == pytest.approx(size[measured].min(), abs=2e-5)
    assert summary["current_max"] == pytest.approx(np.abs(run.current).max(), rel=2e-3)
    power = scenario.coil.resistance * np.mean(np.sum(run.current[measured] ** 2, axis=1))
    # The mean over samples of a periodic curve errs by one sample of 13 000, times its range.
    assert summary["power_mean"] == pytest.approx(power, rel=1e-3)


TURNING_BACK = Waveform.from_points(
    [0.0, 0.05, 0.1], [[20.0, 0, 0.1, 0, -8.0], [-20.0, 0, 0.1, 0, -8.0], [20.0, 0, 0, 0, -8.0]]
)
LONG = Waveform.from_points([0.0, 0.5], [[20.0, 0, 0, 0, -8.0], [25.0, 0, 0, 0, -8.0]])


@pytest.mark.parametrize(
    ("program", "changes", "status"),
    [
        (TURNING_BACK, {}, "heading_lost"),
        (LONG, {"solver.max_steps": 300}, "too_many_steps"),
    ],
)
def test_a_run_that_ends_within_a_stretch_has_the_figures_up_to_there(program, changes, status):
    scenario = Scenario(drive=Drive(mode="program", program=program)).replace(changes)
    run = simulate(scenario.replace({"record.rate": 1e6}))
    summary = run.summary()
    assert run.status == status
    assert 0.0 < summary["simulated_time"] < program.duration
    # Within a sample of 1 us a current of some A changes by 1e-4 of itself.
    assert summary["current_max"] == pytest.approx(np.abs(run.current).max(), rel=1e-3)
    size = np.sqrt(run.bx**2 + run.by**2 + run.bz**2)
    assert summary["field_max"] == pytest.approx(size.max(), rel=1e-3)


def test_the_field_across_is_recorded():
    run = simulate(held({"yp": 10.0}, **RECORDED))
    at = [[run.final_state.x, run.final_state.y, run.final_state.z]]
    expected = Coils().field(at, [0, 0, 1.0, 0, 0])[0, 1] * run.current[-1, 2]
    assert run.by[-1] == pytest.approx(expected, rel=1e-9)
    assert not simulate(held({"xp": 10.0}, **RECORDED)).by.any()


def test_the_power_of_a_run_that_ends_between_stretches_is_that_of_its_window():
    # A held field: after its rise the power is constant, and a stop must not count a stretch twice.
    scenario = Scenario(drive=Drive(mode="IPP", frequency=40.0, pulses=20))
    stop = scenario.window[0] + 5.0 / 40.0
    short = simulate(scenario.replace({"drive.pulses": 8}))
    ended = simulate(scenario, until=f"time >= {stop!r}")
    assert ended.summary()["power_mean"] == pytest.approx(short.summary()["power_mean"], rel=1e-9)
