"""Coils with a capacitor in series, beside the exponential of their matrix."""

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.linalg import expm

from steps import named
from stickslip import COIL_NAMES, Drive, Scenario, Simulator, Waveform, simulate

OHM, HENRY = 10.0, 0.07  # Table I
CRITICAL = 4.0 * HENRY / OHM**2
LAG = 2e-3
# Rings, almost and at the limit, just and far beyond it.
CAPACITANCES = [2e-5, CRITICAL * (1 - 1e-9), CRITICAL, CRITICAL * (1 + 1e-7), 1e-2, 0.5]
# Heavy, so that it stays.
HELD = {"contact.adhesion": 1e-3}


def played(state, first, last, span, farads, lag=0.0):
    """Current (A), capacitor (V) and current of the field (A) after a voltage from first to last.

    The voltage and its rise are states of the system too, so that its matrix says it all.
    """
    matrix = np.zeros((5, 5))
    matrix[0, [0, 1, 3]] = [-OHM / HENRY, -1.0 / HENRY, 1.0 / HENRY]
    matrix[1, 0] = 1.0 / farads
    matrix[3, 4] = 1.0 / span
    if lag:
        matrix[2, [0, 2]] = [1.0 / lag, -1.0 / lag]
    after = expm(matrix * span) @ [*state, first, last - first]
    return after[:3] if lag else np.array([*after[:2], after[0]])


@pytest.mark.parametrize("lag", [0.0, LAG])
@pytest.mark.parametrize("farads", CAPACITANCES)
def test_steps_of_a_ringing_coil_are_those_of_scipy(farads, lag):
    random = np.random.default_rng(5)
    keys = {**HELD, "coil.capacitance": farads, "effects.eddy_lag.time": lag}
    sim = Simulator(Scenario().replace(keys))
    states, before = np.zeros((5, 3)), np.zeros(5)
    for _ in range(12):
        volts, span = random.uniform(-30.0, 30.0, 5), 10.0 ** random.uniform(-4.0, -1.0)
        volts[[2, 3]] = 0.0
        kind = str(random.choice(["constant", "linear"]))
        begin = before if kind == "linear" else volts
        found = sim.step(named(volts), span, kind)
        for k, name in enumerate(COIL_NAMES):
            states[k] = played(states[k], begin[k], volts[k], span, farads, lag)
            current = getattr(found, f"current_{name}")
            # A steep voltage charges 0.5 F by 3e5 A less what swings, 1e-10 A of rounding.
            assert current == pytest.approx(states[k, 0], rel=1e-9, abs=3e-10)
            charged = getattr(found, f"capacitor_{name}")
            assert charged == pytest.approx(states[k, 1], rel=1e-9, abs=1e-9)
            field = current + getattr(found, f"field_lag_{name}")
            assert field == pytest.approx(states[k, 2], rel=1e-9, abs=3e-10)
        before = volts


def ringing(**keys):
    """A coil of each kind, after a jump and a ramp."""
    points = [[0, 0, 0, 0, 0], [20, -15, 0, 0, 10], [8, -15, 0, 0, -10], [-5, 2, 0, 0, 4]]
    program = Waveform.from_points([0.0, 0.0, 0.03, 0.1], points)
    coil = {"coil.capacitance": 1e-2, "coil.xp.capacitance": 2e-5, "coil.xm.capacitance": CRITICAL}
    drive = Drive(mode="program", program=program)
    return Scenario(drive=drive).replace({**HELD, **coil, **keys})


def test_extremes_and_power_are_those_of_a_fine_record():
    run = simulate(ringing(**{"record.rate": 1e5}))
    found = run.summary()
    power = OHM * (run.current**2).sum(axis=1)
    mean = trapezoid(power, run.t) / (run.t[-1] - run.t[0])
    assert found["power_mean"] == pytest.approx(mean, rel=1e-5)
    largest = np.abs(run.current).max()
    # But for rounding: the instant of the largest may be one of the record.
    assert largest * (1.0 - 1e-14) <= found["current_max"] <= largest * (1.0 + 1e-5)
    field = np.sqrt(run.bx**2 + run.by**2 + run.bz**2)
    assert field.max() <= found["field_max"] <= field.max() * (1.0 + 1e-5)
    assert found["field_min"] <= field.min() + 1e-9
    # By energy: what the source gives and no resistor takes is in coils and capacitors.
    end, volts = run.final_state, np.zeros((len(run.t), 5))
    corners = ringing().drive.program.blocks[0]
    for k in range(5):
        volts[:, k] = np.interp(run.t, corners[0][1:], corners[1][1:, k])
    given = trapezoid((volts * run.current).sum(axis=1), run.t)
    kept = sum(
        0.5 * HENRY * getattr(end, f"current_{name}") ** 2
        + 0.5 * getattr(ringing().coil, name).capacitance * getattr(end, f"capacitor_{name}") ** 2
        for name in COIL_NAMES
    )
    assert found["power_mean"] * run.t[-1] == pytest.approx(given - kept, rel=1e-4)


def test_a_run_goes_on_from_the_charge_that_another_left():
    sim = Simulator(ringing())
    rows = [(np.array([20.0, -15.0, 0, 0, 10.0]), 0.01), (np.array([-5.0, 2.0, 0, 0, 4.0]), 0.02)]
    middle = sim.step(named(rows[0][0]), rows[0][1])
    whole = sim.step(named(rows[1][0]), rows[1][1])
    again = Simulator(ringing(), middle).step(named(rows[1][0]), rows[1][1])
    assert again.row == pytest.approx(whole.row, rel=1e-12, abs=1e-13)


def test_warm_coils_with_a_capacitor_have_the_resistance_of_their_power():
    run = simulate(ringing(**{"effects.coil_heating.coefficient": 0.05, "record.rate": 1e5}))
    squares = trapezoid(run.current**2, run.t, axis=0) / run.t[-1]
    # R = 10 (1 + 0.05 R <I^2>) of each coil.
    warm = OHM / (1.0 - 0.05 * OHM * squares)
    assert run.summary()["power_mean"] == pytest.approx(float(warm @ squares), rel=1e-5)
    assert warm.max() > 1.1 * OHM


@pytest.mark.timeout(60)
@pytest.mark.parametrize("farad", [5e-324, pytest.param(1e-15, marks=pytest.mark.nightly), 1e-12])
def test_a_swing_that_is_far_too_fast_ends(farad):
    run = simulate(Scenario().replace({"coil.xp.capacitance": farad, "drive.pulses": 2}))
    assert run.status in ("ok", "step_underflow", "max_steps"), run.message
