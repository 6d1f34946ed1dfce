"""The summary's field, currents, voltages and power, beside a record of 1 MHz."""

import math

import numpy as np
import pytest

from free_shapes import KNOTS, shaped
from stickslip import Coils, Drive, Scenario, State, Waveform, simulate, simulate_batch

RATE = 1e6  # Hz
# Part of the largest field or current. A record misses of a smooth extreme half a sample squared
# times half its curvature: of one that follows coils of 1 ms (1e-6 / 1e-3)^2 / 8, far below.
ENOUGH = 1e-6
# T: by what an impact may lift the field above both samples beside it. It changes the robot's
# velocity by some 0.1 m/s in a gradient of some 0.03 T/m.
KINK = 0.03 * 0.1 / RATE
UNEQUAL = {
    "coil.xm.inductance": 0.12, "coil.xm.turns": 430.0, "coil.clamp.resistance": 14.0,
    "coil.clamp.inductance": 0.03, "coil.yp.inductance": 0.05, "coil.ym.inductance": 0.05,
    "effects.mutual_inductance.coupling": 0.15,
}  # fmt: skip
STEADY = {"coil.yp.inductance": 0.07, "coil.ym.inductance": 0.07}


def random_program(seed, in_plane):
    """Ramps and jumps between random voltages, with breakpoints on the samples of the record."""
    random = np.random.default_rng(seed)
    times, rows = [0.0], [np.zeros(5)]

    def row():
        ahead = random.uniform(-25.0, 25.0) if in_plane else random.uniform(14.0, 25.0)
        across = 0.0 if in_plane else random.uniform(-4.0, 4.0)
        volts = np.array([ahead, random.uniform(-6.0, 6.0), across, 0.0, random.uniform(-20, 10)])
        return volts * (random.uniform(size=5) > 0.2) if in_plane else volts

    for _ in range(random.integers(3, 7)):
        if random.uniform() < 0.4:
            times.append(times[-1])
            rows.append(row())
        times.append(times[-1] + 1e-6 * random.integers(500, 12_000))
        rows.append(rows[-1] if random.uniform() < 0.3 else row())
    return Waveform.from_points(times, rows)


def scenario(seed, in_plane=True):
    random = np.random.default_rng([seed, 1])
    changes = {**UNEQUAL, **(STEADY if in_plane else {})}
    changes["effects.eddy_lag.time"] = float(10.0 ** random.uniform(-4.5, -2.7))
    changes["effects.ambient_field.Bz"] = float(random.uniform(-1e-4, 1e-4))
    drive = Drive(mode="program", program=random_program(seed, in_plane))
    return Scenario(drive=drive).replace(changes)


def squares(run):
    return run.bx**2 + run.by**2 + run.bz**2


def least_between(values):
    """The least of a smooth curve through samples, which may lie between them.

    A parabola leaves out the third derivative; near a zero of the field that is seen.
    """
    k = int(np.argmin(values))
    if not 2 <= k < len(values) - 2:
        return values[k]
    fit = np.polynomial.Polynomial.fit(np.arange(-2.0, 3.0), values[k - 2 : k + 3], 4)
    turns = [each.real for each in fit.deriv().roots() if abs(each.imag) < 1e-9]
    inner = [fit(each) for each in turns if abs(each) <= 1.0]
    return max(min([values[k], *inner]), 0.0)


def check(run):
    """The summary of a run that was recorded is that of its record."""
    summary = run.summary()
    fields = squares(run)
    start, end = run.scenario.window
    measured = fields[(run.t >= start - 1e-12) & (run.t <= end + 1e-12)]
    largest = np.sqrt(fields.max())
    assert -ENOUGH * largest < summary["field_max"] - largest < ENOUGH * largest + KINK
    assert summary["current_max"] == pytest.approx(np.abs(run.current).max(), rel=ENOUGH)
    if np.isnan(summary["field_min"]):
        assert not run.ok
        return
    # Of squares: near zero the field is less smooth than its square.
    least, slack = least_between(measured), ENOUGH * largest
    missed = summary["field_min"] ** 2 - least
    assert missed < slack * (2.0 * np.sqrt(least) + slack)
    assert -missed < (slack + KINK) * (2.0 * np.sqrt(least) + slack + KINK)


def check_random(seeds, in_plane):
    many = [scenario(seed, in_plane) for seed in seeds]
    recorded = [each.replace({"record.rate": RATE}) for each in many]
    alone = [simulate(each) for each in recorded]
    for run in alone:
        check(run)
    assert sum(run.ok for run in alone) > 0.7 * len(alone)
    for one, run in zip(simulate_batch(many, threads=2), alone, strict=True):
        np.testing.assert_equal(one.summary(), run.summary())


@pytest.mark.parametrize("in_plane", [True, False])
def test_extremes_of_random_programs_are_those_of_a_dense_record(in_plane):
    check_random(range(10), in_plane)


@pytest.mark.nightly
@pytest.mark.parametrize("in_plane", [True, False])
@pytest.mark.parametrize("first", range(10, 110, 20))
def test_extremes_of_many_random_programs(first, in_plane):
    check_random(range(first, first + 20), in_plane)


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("heading", [0.0, 0.5])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"drive.base": -1.5e-3, "drive.peak": 1.5e-3, "drive.hold": 0.2e-3},  # through zero
        {"drive.mode": "OPP", "drive.edge": "fall", "drive.edge_time": 2e-3},
        {"drive.frequency": 17.0, "effects.eddy_lag.time": 1e-3},
        {"drive.frequency": 160.0, "effects.mutual_inductance.coupling": 0.2},
        {**shaped("free_field_time", KNOTS), **shaped("free_field_amplitude", KNOTS)},
        {"drive.ramp": 0.0, "contact.restitution": 0.6},
    ],
)
def test_extremes_of_sawtooths(changes, heading, direction):
    drive = Drive(base=0.5e-3, pulses=5, direction=direction, heading=heading, ramp=0.01)
    if heading and changes.get("drive.base", 0.0) < 0.0:
        return  # there the heading is lost where the field along the surface is zero
    run = simulate(Scenario(drive=drive).replace({"record.rate": RATE, **changes}))
    assert run.ok
    check(run)


def test_a_field_that_reverses_within_a_stretch_goes_through_zero():
    # The xp coil alone, which is turned from +25 to -25 V: its current is zero on the way, and so
    # is the field wherever the robot is.
    volts = [[25.0, 0, 0, 0, 0], [25.0, 0, 0, 0, 0], [-25.0, 0, 0, 0, 0], [-25.0, 0, 0, 0, 0]]
    program = Waveform.from_points([0.0, 0.03, 0.03, 0.06], volts)
    started = State(current_xp=2.5)
    run = simulate(Scenario(drive=Drive(mode="program", program=program), initial=started))
    assert run.summary()["field_min"] < ENOUGH * run.summary()["field_max"]


def test_the_start_of_the_window_and_of_the_run_count():
    # At rest under a field that grows, the least one is the first: in the run at its start, where
    # the initial current is; in the window of a sawtooth, which begins after three pulses, there.
    held = Waveform.from_points([0.0, 0.02], [[10.0, 0, 0, 0, 0], [10.0, 0, 0, 0, 0]])
    started = State(current_xp=0.2)
    rest = Scenario(drive=Drive(mode="program", program=held), initial=started)
    still = rest.replace({"robot.magnetization": 1.0, "record.rate": 1e4})
    run = simulate(still)
    assert run.summary()["field_min"] == pytest.approx(np.sqrt(squares(run)[0]), rel=1e-12)
    assert run.summary()["field_max"] == pytest.approx(np.sqrt(squares(run)[-1]), rel=1e-12)

    falling = held.turned()  # the current goes from 0.2 A to below zero
    run = simulate(still.replace({"drive.program": falling}))
    assert run.summary()["current_max"] == pytest.approx(np.abs(run.current).max(), rel=1e-12)


def test_a_run_that_is_stopped_counts_what_was_played():
    program = random_program(4, True)
    whole = scenario(4).replace({"record.rate": RATE})
    for stop in (0.3, 0.6):
        # A sample is there at the stop, which rounding may put before it.
        time = round(stop * program.duration, 6) + 1e-12
        run = simulate(whole, until=f"time >= {time!r}")
        played = run.t <= time
        summary = run.summary()
        largest = np.sqrt(squares(run)[played].max())
        assert summary["field_max"] == pytest.approx(largest, rel=ENOUGH)
        assert summary["current_max"] == pytest.approx(np.abs(run.current).max(), rel=ENOUGH)
        assert summary["field_min"] ** 2 == pytest.approx(
            least_between(squares(run)[played]), abs=2.0 * ENOUGH * largest**2
        )
    rising = Scenario(drive=Drive(base=2e-3, peak=2e-3, ramp=0.05))
    volts, tipped = (simulate(rising, until=end).summary() for end in (None, "theta >= 0.01"))
    part = tipped["simulated_time"] / 0.05
    assert part < 1.0
    assert tipped["voltage_max"] == pytest.approx(part * volts["voltage_max"], rel=1e-12)


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
