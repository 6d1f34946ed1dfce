"""The turned robot: what is not fixed to the world mirrors exactly."""

import numpy as np
import pytest

from helpers import program, run, volts
from stickslip import Waveform

DRIVES = [
    {"mode": "IPP", "base": 0.5e-3},
    {"mode": "OPP", "base": 0.0, "hold": 2.5e-3, "edge": "fall"},
    {"mode": "IPP", "clamp": "up", "frequency": 30.0, "edge": "fall", "base": 0.5e-3},
    {"mode": "IPP", "base": 0.0},  # stands on end
    {"mode": "OPP", "clamp": "up", "hold": 2.5e-3, "edge_time": 1e-3, "ramp_down": 0.02},
]
# Keys of a world and of its mirror image.
WORLDS = [
    ({}, {}),
    ({"effects.surface_tilt.angle": 0.07}, {"effects.surface_tilt.angle": -0.07}),
    (
        {"effects.ambient_field.Bx": 2e-4, "effects.ambient_field.Bz": -1e-4},
        {"effects.ambient_field.Bx": -2e-4, "effects.ambient_field.Bz": -1e-4},
    ),
    ({"effects.misalignment.angle": 0.1, "contact.restitution": 0.5},) * 2,
]
SAME = ("t", "z", "theta", "vz", "omega", "normal_force", "bz")
NEGATED = ("x", "vx", "friction_force", "contact_x", "slip_velocity", "bx")
# Codes of the contact with forward and backward exchanged.
TURNED_CONTACT = np.array([0, 1, 3, 2, 4, 6, 5])


def assert_mirrored(one, other):
    for name in SAME:
        assert np.array_equal(getattr(other, name), getattr(one, name)), name
    for name in NEGATED:
        assert np.array_equal(getattr(other, name), -getattr(one, name), equal_nan=True), name
    assert np.array_equal(other.contact, TURNED_CONTACT[one.contact])
    assert np.array_equal(other.current, one.current[:, [1, 0, 3, 2, 4]] * [-1, -1, -1, -1, 1])
    a, b = one.summary(), other.summary()
    for name in ("mean_velocity", "slip_up", "slip_down", "slip_flat"):
        assert np.array_equal(b.pop(name), -a.pop(name), equal_nan=True), name
    assert a == b


@pytest.mark.parametrize("rate", ["events", 2000.0])
@pytest.mark.parametrize("worlds", WORLDS, ids=["plain", "tilt", "ambient", "misaligned"])
@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: "-".join(map(str, drive.values())))
def test_turned_robot_moves_to_the_other_side(drive, worlds, rate):
    one = run(worlds[0], rate=rate, direction="+x", pulses=8, **drive)
    other = run(worlds[1], rate=rate, direction="-x", pulses=8, **drive)
    assert abs(one.mean_velocity) > 1e-6
    assert_mirrored(one, other)


def test_turned_voltages_drive_the_turned_robot_alike():
    tooth = Waveform.sawtooth(0.01, volts(0.5e-3, -1e-3), volts(2.5e-3, -1e-3))
    waveform = Waveform.ramp(0.05, volts(0.5e-3, -1e-3)) + 6 * tooth
    one = run(program(waveform), rate=2000.0)
    other = run(program(waveform.turned()), rate=2000.0, direction="-x")
    assert_mirrored(one, other)


@pytest.mark.parametrize("key", ["effects.surface_tilt.angle", "effects.ambient_field.Bx"])
def test_what_is_fixed_to_the_world_does_not_turn_with_the_robot(key):
    value = {key: 0.05 if "tilt" in key else 3e-4}
    one = run(value, base=0.5e-3, pulses=8)
    other = run(value, base=0.5e-3, pulses=8, direction="-x")
    assert abs(other.mean_velocity + one.mean_velocity) > 0.05 * abs(one.mean_velocity)
