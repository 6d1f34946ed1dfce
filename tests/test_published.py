"""Velocities that others published, of systems with all parameters stated."""

import numpy as np
import pytest

from helpers import friction
from stickslip import Accelerations, Scenario, simulate

GRAVITY = 9.81  # m/s^2

# Neither drag nor adhesion; so flat that nothing tips it.
BLOCK = {
    "drive.mode": "none",
    "robot.length": 0.1, "robot.width": 0.1, "robot.height": 1e-4,
    "drag.linear": 0.0, "drag.rotational": 0.0,
    "contact.adhesion": 0.0,
}  # fmt: skip


def run(*changes):
    keys = {key: value for change in (BLOCK, *changes) for key, value in change.items()}
    found = simulate(Scenario().replace(keys))
    assert found.ok, found.message
    return found


# A capsule robot whose inner body is pushed against its spring for the first part of each period:
# A. Nunuparov and others, github.com/xxFirefly/mpc_rl_capsubot, commit 6a744c1,
# force_investigation/modelWithDimVarsAndJustPWM.ipynb; velocity of the common centre of mass over
# 200 periods from rest. Their friction is FRICTION 2/pi arctan(v / 1 um/s). Solved to 1e-7, those
# three of their runs that differ most from ours give what they print within 0.011 %, and with a
# friction ten times as steep what Coulomb's gives within 0.06 %.
HOUSING, INNER, SPRING, PUSH, FRICTION = 0.193, 0.074, 256.23, 1.25, 0.71  # kg, kg, N/m, N, N
PERIODS = 200
PRINTED = {  # period, s: mm/s, at duties of 0.05, 0.1 and so on
    0.066: [-0.468723, -1.989582, -4.525120, -7.739702, -11.177107,
            -13.330747, -12.118979, -7.849258, -3.758203, 0.199291],
    0.1: [6.094550, 15.385157, 10.813736, 7.103623, 5.092592,
          3.741507, 2.629237, 1.649463, 0.758823, -0.082849],
}  # fmt: skip


@pytest.mark.parametrize("period", PRINTED)
def test_a_capsule_moves_as_fast_as_was_printed(period):
    whole = HOUSING + INNER
    for duty, printed in zip(np.arange(1, 11) / 20, PRINTED[period], strict=True):
        found = run(
            {"robot.mass": HOUSING, "inner.mass": INNER, "inner.stiffness": SPRING},
            {"inner.amplitude": PUSH, "inner.duty": duty, "inner.frequency": 1.0 / period},
            friction(FRICTION / (whole * GRAVITY)),
            {"drive.pulses": PERIODS, "record.rate": 1.0 / period},
        )
        centre = found.x + INNER / whole * found.inner_place
        velocity = 1e3 * (centre[-1] - centre[0]) / (found.t[-1] - found.t[0])
        assert velocity == pytest.approx(printed, rel=3e-3, abs=1e-3), duty


# A part that two accelerations in turn drive up a vertical surface, to which it is pressed: C. L.
# Yako, S. Yuan, K. Salisbury, Two Degree-of-Freedom Vibratory Transport in a Grasp,
# arXiv:2605.30780; formula, friction, frequencies (Hz) and accelerations (g) from
# www.connoryako.com/projects/vibrating-parallel-gripper/theory. Of their forces the smallest, on
# the 0.358 kg of their program (github.com/clyako/2-DoF-vibrational-transport).
STATIC, KINETIC, PRESSED = 0.44, 0.34, 30.0 / 0.358
LIFTED = [(20.0, 0.7, most) for most in (5.0, 10.0, 15.0, 20.0)]
LIFTED += [(15.0, slow, 10.0) for slow in (0.4, 0.6, 0.8, 1.0)]


@pytest.mark.parametrize(("frequency", "slow", "most"), LIFTED)
def test_a_part_climbs_as_the_closed_form_says(frequency, slow, most):
    slow, most, period = slow * GRAVITY, most * GRAVITY, 1.0 / frequency
    turn = period * most / (2.0 * (slow + most))
    jump = 1e-9  # s
    times = [0.0, turn, turn + jump, period - turn, period - turn + jump, period]
    along = [slow, slow, -most, -most, slow, slow]
    mass, angle = 3.58e-3, 1.5  # kg, rad; a steeper surface is not allowed, so gravity makes it up
    found = run(
        {"shake.accelerations": Accelerations(np.c_[times, along, np.zeros(6)])},
        friction(STATIC, KINETIC),
        {"environment.gravity": GRAVITY / np.sin(angle), "effects.surface_tilt.angle": -angle},
        {"robot.mass": mass, "contact.adhesion": mass * (PRESSED - GRAVITY / np.tan(angle))},
        {"drive.pulses": 6},
    )
    slip = KINETIC * PRESSED + GRAVITY
    expected = slow / (2.0 * frequency) * (1.0 / (1.0 + slow / most) - 1.0 / (1.0 + slow / slip))
    assert found.mean_velocity == pytest.approx(expected, abs=jump * most)
