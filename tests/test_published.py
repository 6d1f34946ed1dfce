"""Velocities that others published, of systems with all parameters stated."""

import numpy as np
import pytest

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
        {"contact.static_friction": STATIC, "contact.kinetic_friction": KINETIC},
        {"environment.gravity": GRAVITY / np.sin(angle), "effects.surface_tilt.angle": -angle},
        {"robot.mass": mass, "contact.adhesion": mass * (PRESSED - GRAVITY / np.tan(angle))},
        {"drive.pulses": 6},
    )
    slip = KINETIC * PRESSED + GRAVITY
    expected = slow / (2.0 * frequency) * (1.0 / (1.0 + slow / most) - 1.0 / (1.0 + slow / slip))
    assert found.mean_velocity == pytest.approx(expected, abs=jump * most)
