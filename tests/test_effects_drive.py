"""Causes in the drive: what they do to currents and field, from the circuit equations.

Expected currents come from numerical integration of L dI/dt = V - R I in this file; the solver has
them in closed form.
"""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fixed_point

from helpers import BUSY, HELD, program, run
from stickslip import Coils, Waveform

RESISTANCE, INDUCTANCE = 10.0, 70e-3  # ohm, H
SLOW = INDUCTANCE / RESISTANCE  # s


def pieces_of(waveform):
    """Linear pieces (start, end, volts at start, volts at end); jumps have none."""
    t, v = waveform.points()
    return [(t[i], t[i + 1], v[i], v[i + 1]) for i in np.flatnonzero(np.diff(t) > 1e-12)]


def held_pieces(waveform, period):
    """The staircase of a controller that reads the voltages at multiples of `period`.

    At a jump it reads what comes after it, as `Waveform.voltages` does; a nanosecond puts times on
    that side whatever their rounding, and moves a slope of 1 V/ms by 1e-6 V.
    """
    starts = period * np.arange(int(np.ceil(waveform.duration / period - 1e-9)))
    ends = np.append(starts[1:], waveform.duration)
    t = waveform.points()[0]
    jumps = t[1:][np.diff(t) < 1e-12]
    meets = np.any(np.abs(starts[:, None] - jumps) < 1e-9, axis=1)
    levels = waveform.voltages(starts + 1e-9 * meets)
    return [(*step, level, level) for *step, level in zip(starts, ends, levels, strict=True)]


# Signs of the mutual inductances, and 1 with itself: the dipole field of one coil at another, by
# 3 (m.r)(n.r) for coils on different axes, is along its axis if just one is on a positive side.
SIDE = np.array([1.0, -1.0, 1.0, -1.0, -1.0])
AXIS = np.array([0, 0, 1, 1, 2])
LINKED = np.where(AXIS[:, None] == AXIS, 1.0, -np.outer(SIDE, SIDE))


def integrated(pieces, at, resistance=RESISTANCE, coupling=0.0, lag=0.0, limit=np.inf):
    """Lagging currents, which make the field, at times `at` (A, shape (n, 5)), and mean I^2."""
    inverse = np.linalg.inv(INDUCTANCE * (coupling * LINKED + (1.0 - coupling) * np.eye(5)))

    def rates(t, y, start, end, first, last):
        voltage = np.clip(first + (t - start) / (end - start) * (last - first), -limit, limit)
        current, effective = y[:5], y[5:10]
        change = inverse @ (voltage - resistance * current)
        behind = (current - effective) / lag if lag else change
        return np.concatenate([change, behind, current**2])

    y, result = np.zeros(15), np.zeros((len(at), 5))
    for start, end, first, last in pieces:
        # Where a voltage is clipped its slope jumps: no step may go over that.
        cuts = {start, end}
        for bound in (-limit, limit) if np.isfinite(limit) else ():
            with np.errstate(divide="ignore", invalid="ignore"):
                parts = (bound - first) / (last - first)
            cuts |= {start + part * (end - start) for part in parts if 0.0 < part < 1.0}
        cuts = sorted(cuts)
        for begin, stop in itertools.pairwise(cuts):
            inside = (at >= begin - 1e-12) & (at < stop - 1e-12)
            t_eval = np.append(np.clip(at[inside], begin, stop), stop)
            found = solve_ivp(
                rates, (begin, stop), y, "DOP853", t_eval, args=(start, end, first, last),
                rtol=1e-12, atol=1e-13,
            )  # fmt: skip
            result[inside] = found.y[5:10, :-1].T
            y = found.y[:, -1]
    result[at >= pieces[-1][1] - 1e-12] = y[5:10]
    return result, y[10:] / pieces[-1][1]


def heated(mean_square_at, coefficient):
    """Resistances R = R0 (1 + k R <I^2>), with the mean square <I^2> (A^2) as a function of R."""
    return fixed_point(
        lambda r: RESISTANCE * (1.0 + coefficient * r * mean_square_at(r)),
        np.full(5, RESISTANCE), xtol=1e-10,
    )  # fmt: skip


@pytest.mark.parametrize("coupling", [0.0, 0.2, -0.15])
@pytest.mark.parametrize("heating", [0.0, 0.05])
@pytest.mark.parametrize("lag", [0.0, 3e-3, SLOW])
def test_currents_with_lag_heating_and_coupling_are_those_of_the_circuit(lag, heating, coupling):
    keys = {
        "effects.eddy_lag.time": lag,
        "effects.coil_heating.coefficient": heating,
        "effects.mutual_inductance.coupling": coupling,
    }
    waveform = 4 * BUSY
    of = run(HELD, keys, program(waveform), rate=2e3)
    resistance = heated(lambda r: integrated(pieces_of(waveform), of.t, r, coupling)[1], heating)
    currents, _ = integrated(pieces_of(waveform), of.t, resistance, coupling)
    lagging, _ = integrated(pieces_of(waveform), of.t, resistance, coupling, lag)
    # A lag of just L/R is moved by 1e-6 of itself: t/T exp(-t/T) then changes by 1e-6 at most.
    slack = 2e-6 if lag == SLOW and coupling == 0.0 and heating == 0.0 else 1e-8
    assert of.current == pytest.approx(currents, abs=1e-8)
    assert np.abs(lagging).max() > 0.2
    at = np.stack([of.x, np.zeros_like(of.x), of.z], axis=-1)
    field = Coils().field(at, lagging)
    assert of.bx == pytest.approx(field[:, 0], abs=1e-3 * slack)  # 0.96 mT for an ampere
    assert of.bz == pytest.approx(field[:, 2], abs=1e-3 * slack)


@pytest.mark.parametrize(("frequency", "pulses"), [(2.0, 3), (100.0, 30), (400.0, 40)])
@pytest.mark.daily("2.0")
def test_pulsed_coils_are_heated_by_all_their_pulses(frequency, pulses):
    drive = {"frequency": frequency, "pulses": pulses, "hold": 2e-3, "ramp": 0.01}
    waveform = Waveform.ipp(**drive)
    keys = {"effects.coil_heating.coefficient": 0.03}
    of = run(HELD, keys, mode="IPP", rate=500.0, **drive)
    warm = heated(lambda r: integrated(pieces_of(waveform), of.t, r)[1], 0.03)
    expected, _ = integrated(pieces_of(waveform), of.t, warm)
    assert of.current == pytest.approx(expected, abs=3e-5)  # 1e-5 of the largest, 2.6 A


def test_amplifier_clips_inside_a_ramp_from_side_to_side():
    # xp meets the limit at 1/4 and 3/4 of the ramp, clamp at 5/16 and 11/16, ym never.
    waveform = Waveform.ramp(
        0.02, {"xp": -30, "clamp": 40, "ym": 14}, {"xp": 30, "clamp": -40, "ym": -14}
    )
    waveform = waveform + Waveform.hold(0.2, {"xp": -30, "clamp": 40, "ym": 14})
    of = run(HELD, {"effects.amplifier_limit.voltage": 15.0}, program(waveform), rate=2e3)
    expected, _ = integrated(pieces_of(waveform), of.t, limit=15.0)
    assert of.current == pytest.approx(expected, abs=1e-8)
    # 200 ms after the ramp, e^-28 of the way to the limit over the resistance is left.
    assert of.current[-1] == pytest.approx([-1.5, 0.0, 0.0, 1.4, 1.5], abs=1e-10)


def test_amplifier_that_is_never_at_its_limit_changes_nothing():
    drive = {"mode": "OPP", "hold": 2.5e-3, "pulses": 6}
    plain = run(rate=2e3, **drive)
    limited = run({"effects.amplifier_limit.voltage": 26.0}, rate=2e3, **drive)
    assert np.array_equal(limited.current, plain.current)
    assert np.array_equal(limited.x, plain.x)


@pytest.mark.parametrize("edge", ["rise", "fall"])
@pytest.mark.parametrize(
    ("period", "drive", "close"),
    [
        *((period, {"base": 0.5e-3, "pulses": 6, "ramp_down": 0.013}, 1e-8)
          for period in (1.7e-3, 7.3e-3, 23e-3)),
        # 1 ms divides the pulses, so every pulse has to be held at the same ten voltages, at jumps
        # those after them. The oracle reads a jump 1 ns late, on a slope of 2.6 V/ms.
        *((1e-3, {"pulses": 20, "ramp": ramp}, 1e-6) for ramp in (0.0, 0.05)),
    ],
)  # fmt: skip
def test_held_output_is_a_staircase_of_the_voltages(period, drive, close, edge):
    waveform = Waveform.ipp(edge=edge, **drive)
    of = run(HELD, {"effects.sample_hold.period": period}, mode="IPP", rate=2e3, edge=edge, **drive)
    expected, _ = integrated(held_pieces(waveform, period), of.t)
    assert of.current == pytest.approx(expected, abs=close)


@pytest.mark.parametrize("period", [0.9e-3, 1.7e-3, 13e-3])
@pytest.mark.parametrize("ramp_down", [0.0, 0.02])
def test_mean_velocity_of_a_held_output_is_over_the_same_window(period, ramp_down):
    # From the end of the third pulse to that of the last, which no period here meets.
    drive = {"mode": "IPP", "base": 0.5e-3, "pulses": 10, "ramp_down": ramp_down}
    of = run({"effects.sample_hold.period": period}, rate=1e3, **drive)
    first, last = np.interp([0.08, 0.15], of.t, of.x)
    assert np.isclose(of.t, 0.08, rtol=0, atol=1e-12).any()
    assert of.mean_velocity == pytest.approx((last - first) / 0.07, rel=1e-9)
    assert of.mean_velocity > 1e-4
