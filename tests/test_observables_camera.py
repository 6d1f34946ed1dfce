"""The camera: sampling, blur, synchronisation, and what the core has done to a recording before."""

import numpy as np
import pytest

from stickslip import Scenario
from stickslip.diagnosis.observables.tracking.camera import Camera, record, recording_rate

RATE = 1e4  # Hz, of the recordings that are made up here


def rocking(frequency, duration=0.5, height=0.1):
    """A recording of a body that rocks harmonically and walks at 1 mm/s."""
    t = np.arange(int(duration * RATE) + 1) / RATE
    turn = 2 * np.pi * frequency
    return {
        "t": t,
        "theta": height * np.sin(turn * t),
        "omega": height * turn * np.cos(turn * t),
        "x": 1e-3 * t,
        "vx": np.full(len(t), 1e-3),
    }


def hermite_error(frequency, height):
    """Largest error of cubic Hermite interpolation of a sine: its fourth derivative h^4 / 384."""
    return height * (2 * np.pi * frequency / RATE) ** 4 / 384


def test_a_frame_shows_the_mean_over_its_exposure():
    frequency, exposure, height = 421.0, 1e-3, 0.1
    times = np.arange(0.01, 0.48, 1 / 997.0)
    frames = Camera(exposure).frames(rocking(frequency, height=height), times)
    # The mean of a sine over an interval is the sine in its middle times sinc.
    blurred = height * np.sinc(frequency * exposure) * np.sin(2 * np.pi * frequency * times)
    assert np.max(np.abs(frames["theta"] - blurred)) < 2 * hermite_error(frequency, height)
    assert np.max(np.abs(frames["x"] - 1e-3 * times)) < 1e-15


def test_trigger_offset_and_scale_act_as_they_are_defined():
    motion, times = rocking(30.0), np.arange(0.01, 0.48, 1e-3)
    frames = Camera(0.0, trigger=2e-3, angle_offset=0.02, angle_scale=1.1).frames(motion, times)
    late = Camera().frames(motion, times + 2e-3)
    assert np.array_equal(frames["x"], late["x"])
    assert np.allclose(frames["theta"], 1.1 * late["theta"] + 0.02, rtol=0, atol=1e-15)


def test_slow_frames_alias_a_fast_rocking():
    frames = Camera().frames(rocking(421.0), np.arange(100) / 200.0)["theta"]
    power = np.abs(np.fft.rfft(frames)) ** 2
    # 421 = 2 * 200 + 21 Hz; the bins are 2 Hz apart, so it is the nearest two.
    assert abs(np.fft.rfftfreq(100, 1 / 200.0)[np.argmax(power)] - 21.0) <= 1.0


def test_before_and_after_the_recording_the_robot_rests():
    motion = rocking(30.0)
    frames = Camera(1e-3).frames(motion, np.array([-0.1, 0.7]))
    assert frames["theta"] == pytest.approx([motion["theta"][0], motion["theta"][-1]])


SCENARIO = Scenario().replace(
    {"drive.pulses": 4, "drive.base": 0.5e-3, "drive.frequency": 30.0, "drive.ramp": 0.05}
)


def motion(changes, rate=None):
    keys = list(changes)
    values = np.array([[changes[key] for key in keys]]).reshape(1, len(keys))
    return next(record(SCENARIO, keys, values, rate or recording_rate(SCENARIO), 1))


def test_scales_and_offsets_of_the_core_are_not_applied_twice():
    length, clock, turn = 0.03, 0.02, 0.05
    plain = Camera(4e-4).frames(motion({}), times := np.arange(0.0, 0.15, 1e-3))
    read = Camera(4e-4 * (1 + clock)).frames(
        motion(
            {
                "effects.length_scale.fraction": length,
                "effects.clock_scale.fraction": clock,
                "effects.angle_offset.angle": turn,
            }
        ),
        times * (1 + clock),
    )
    assert np.allclose(read["x"], plain["x"] * (1 + length), rtol=0, atol=1e-14)
    assert np.allclose(read["theta"], plain["theta"] + turn, rtol=0, atol=1e-12)


def test_the_recording_rate_is_fine_enough_and_meets_the_edges():
    rate = recording_rate(SCENARIO)
    for edge in 0.05 + np.arange(4) / 30.0:
        assert edge * rate == pytest.approx(round(edge * rate), abs=1e-6)
    times = np.arange(0.0, 0.18, 7e-4)
    coarse, fine = (
        Camera(3e-4).frames(motion({}, each), times, ("x", "theta", "current_x"))
        for each in (rate, 20 * rate)
    )
    # Against pixels of a tenth of a micrometre, a fifth of a degree and a milliampere.
    for name, noise in (("x", 1e-7), ("theta", 3.5e-3), ("current_x", 1e-3)):
        assert np.max(np.abs(coarse[name] - fine[name])) < noise / 5


def test_recordings_do_not_depend_on_threads_and_fail_singly():
    values = np.array([[0.14], [0.5], [0.16]])  # the second exceeds static friction
    found = [
        list(record(SCENARIO, ["contact.kinetic_friction"], values, 5e3, threads))
        for threads in (1, 3)
    ]
    assert found[0][1] is None
    assert found[1][1] is None
    for k in (0, 2):
        assert np.array_equal(found[0][k]["x"], found[1][k]["x"])
