"""The camera between a robot and its controller."""

import math

import numpy as np
import pytest

from stickslip.control import Camera, Film


def test_frames_come_at_their_rate_and_late():
    camera = Camera(frame_rate=100.0, latency=0.025)
    film = Film(camera, 1e-3, np.zeros(2))
    random = np.random.default_rng(0)
    for k in range(1, 101):
        time = 1e-3 * k
        pose, age = film.watch(time, np.array([time, 0.0]), random)
        if time >= 0.045:
            # The newest frame is at most one period older than the latency.
            assert camera.latency - 1e-9 <= age <= camera.latency + 0.01 + 1e-9
            assert pose[0] == pytest.approx(time - age, abs=1e-12)


def test_an_exposure_averages_and_noise_has_its_size():
    camera = Camera(frame_rate=100.0, exposure=5e-3, noise_x=2e-6)
    film = Film(camera, 1e-3, np.zeros(2))
    random = np.random.default_rng(0)
    errors = []
    for k in range(1, 20_001):
        time = 1e-3 * k
        pose, age = film.watch(time, np.array([time, 0.0]), random)
        if age == 0.0:
            # The mean of five samples, the last of them now.
            errors.append(pose[0] - (time - 2e-3))
    # 2000 normal draws: the mean within 4 sd / sqrt(n), the sd within 4 / sqrt(2 n) of itself.
    count = len(errors) - 1
    assert abs(np.mean(errors[1:])) < 4 * 2e-6 / math.sqrt(count)
    assert np.std(errors[1:]) == pytest.approx(2e-6, rel=4 / math.sqrt(2 * count))


def test_frames_are_dropped_as_often_as_said():
    film = Film(Camera(frame_rate=1000.0, dropped=0.3), 1e-3, np.zeros(2))
    random = np.random.default_rng(0)
    count = 4000
    new = sum(film.watch(1e-3 * k, np.zeros(2), random)[1] == 0.0 for k in range(1, count + 1))
    # A binomial number, within four deviations.
    assert new / count == pytest.approx(0.7, abs=4 * math.sqrt(0.3 * 0.7 / count))


def test_a_camera_sees_the_plane_with_noise_of_every_kind():
    camera = Camera(frame_rate=1000.0, noise_x=2e-6, noise_theta=0.01, noise_heading=0.03)
    still = np.array([1e-3, -2e-3, 0.5, 1.0])
    film, random = Film(camera, 1e-3, still), np.random.default_rng(0)
    seen = np.array([film.watch(1e-3 * k, still, random)[0] for k in range(1, 2001)])
    # The mean within 4 sd / sqrt(n), the sd within 4 / sqrt(2 n) of itself.
    sd, count = np.array([2e-6, 2e-6, 0.01, 0.03]), len(seen)
    assert (np.abs(seen.mean(axis=0) - still) < 4 * sd / math.sqrt(count)).all()
    assert seen.std(axis=0) == pytest.approx(sd, rel=4 / math.sqrt(2 * count))


def test_both_places_have_the_quantum_of_a_pixel():
    film = Film(Camera(frame_rate=1000.0, pixel=5e-6), 1e-3, np.zeros(4))
    pose, _ = film.watch(1e-3, np.array([12e-6, -13e-6, 0.3, 0.7]), np.random.default_rng(0))
    assert pose == pytest.approx([10e-6, -15e-6, 0.3, 0.7])


def test_headings_about_half_a_turn_are_averaged_as_directions():
    # 3.1 and -3.1 lie on both sides of the -x direction, whose heading is pi or -pi.
    film = Film(Camera(frame_rate=500.0, exposure=2e-3), 1e-3, np.zeros(4))
    random = np.random.default_rng(0)
    for time, heading in ((1e-3, 3.1), (2e-3, -3.1)):
        pose, _ = film.watch(time, np.array([0.0, 0.0, 0.0, heading]), random)
    assert math.cos(pose[3]) == pytest.approx(-1.0, abs=1e-12)


def test_a_film_of_many_robots_is_a_film_of_each():
    camera = Camera(frame_rate=60.0, exposure=4e-3, latency=0.02, pixel=1e-6)
    random = np.random.default_rng(0)
    poses = random.normal(0.0, 1e-5, (200, 3, 2)).cumsum(axis=0)
    together = Film(camera, 1e-3, np.zeros((3, 2)))
    each = [Film(camera, 1e-3, np.zeros(2)) for _ in range(3)]
    for k, pose in enumerate(poses, start=1):
        seen, age = together.watch(1e-3 * k, pose, random)
        for film, own, shown in zip(each, pose, seen, strict=True):
            alone, own_age = film.watch(1e-3 * k, own, random)
            assert np.array_equal(alone, shown)
            assert own_age == age
