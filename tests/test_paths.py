"""Paths along the surface."""

import math

import numpy as np
import pytest

from stickslip.control import Path, heading_voltages

EIGHT = Path.figure_of_eight(4e-3)


def test_a_path_is_known_by_its_length():
    path = Path([(0.0, 0.0), (3e-3, 0.0), (3e-3, 1e-3)])
    assert path.length == pytest.approx(4e-3)
    expected = [[0.0, 0.0], [2e-3, 0.0], [3e-3, 0.5e-3], [3e-3, 1e-3]]
    assert path.at([-1.0, 2e-3, 3.5e-3, 1.0]) == pytest.approx(np.array(expected))


def test_the_figure_of_eight_has_its_size():
    size = EIGHT.points.max(axis=0) - EIGHT.points.min(axis=0)
    assert size == pytest.approx([4e-3, 2e-3], rel=1e-4)
    assert EIGHT.length == pytest.approx(3.0487 * 4e-3, rel=1e-4)
    for progress in (0.0, EIGHT.length / 2, EIGHT.length):
        assert EIGHT.at(progress) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_places_beside_the_path_are_found_again_with_their_side():
    random = np.random.default_rng(0)
    progress = random.uniform(1e-4, EIGHT.length - 1e-4, 500)
    # Nearer than the least radius, 0.42 mm, the nearest point is the one that it was put beside.
    across = random.uniform(-0.1e-3, 0.1e-3, 500)
    along = EIGHT.at(progress + 1e-7) - EIGHT.at(progress - 1e-7)
    along /= np.hypot(*along.T)[:, None]
    places = EIGHT.at(progress) + across[:, None] * np.column_stack([-along[:, 1], along[:, 0]])
    before = progress + random.uniform(-0.3e-3, 0.1e-3, 500)
    found, off = EIGHT.project(places, np.clip(before, 0.0, EIGHT.length))
    # The corners of the polyline are 34 um apart: at one of them a place has two nearest points,
    # or none, over a stretch of its distance times the angle between the sides.
    angle = 34e-6 / 0.42e-3
    assert np.abs(found - progress).max() < angle * 0.1e-3
    assert np.abs(off - across).max() < 0.5 * angle**2 * 0.1e-3 + 1e-9


def test_a_crossing_is_passed_straight_on():
    # The figure crosses itself half way; from before it, no place on the other branch is taken.
    half = EIGHT.length / 2
    progress = half - 0.3e-3
    for ahead in np.linspace(-0.3e-3, 0.3e-3, 61):
        progress, off = EIGHT.project(EIGHT.at(half + ahead), progress)
        assert progress == pytest.approx(half + ahead, abs=1e-9)
        assert off == pytest.approx(0.0, abs=1e-9)


def test_what_lies_beyond_the_ends_belongs_to_them():
    path = Path([(0.0, 0.0), (1e-3, 0.0)])
    assert path.project([-0.1e-3, 0.0], 0.0) == pytest.approx((0.0, 0.1e-3))
    assert path.project([1.2e-3, 0.0], 1e-3) == pytest.approx((1e-3, 0.2e-3))


def test_a_heading_is_made_by_the_coils_that_lie_ahead():
    headings = np.radians([0.0, 45.0, 135.0, -135.0])
    root = math.sqrt(0.5)
    expected = [
        [20.0, 0.0, 0.0, 0.0, -10.0],
        [20.0 * root, 0.0, 20.0 * root, 0.0, -10.0],
        [0.0, -20.0 * root, 20.0 * root, 0.0, -10.0],
        [0.0, -20.0 * root, 0.0, -20.0 * root, -10.0],
    ]
    assert heading_voltages(headings, 20.0, -10.0) == pytest.approx(np.array(expected))
