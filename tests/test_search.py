"""The search: known optima of plain functions, words, restarts, seeds, interrupts."""

import numpy as np
import pytest

from stickslip.design.search import search

CENTRE = 0.3


def distance(points):
    """Squared distance from a point, in which a word other than the first costs its place."""
    return np.sum((points[:, 1:] - CENTRE) ** 2, axis=1) + points[:, 0]


def found(costs, starts, budget, choices=1, seed=0):
    """All points, with a word first, and their costs."""
    seen, paid = [], []

    def kept(points):
        seen.append(points.copy())
        paid.append(costs(points))
        return paid[-1]

    numbers = len(starts[0]) - 1
    bounds = [(0.0, choices - 1.0)] + [(0.0, 1.0)] * numbers
    given = np.array(starts, dtype=float)
    spent = lambda: sum(map(len, seen)) / budget  # noqa: E731
    search(bounds, 1, given, (0.5, 0.15), kept, spent, budget, seed)
    return np.concatenate(seen), np.concatenate(paid)


@pytest.mark.parametrize(("numbers", "choices"), [(1, 1), (2, 4), (6, 2)])
def test_the_optimum_of_a_smooth_function_is_found(numbers, choices):
    points, costs = found(distance, [[choices - 1, *[0.9] * numbers]], 1500, choices)
    best = points[np.argmin(costs)]
    assert best[0] == 0
    assert best[1:] == pytest.approx(CENTRE, abs=0.02)
    assert {*points[:, 0]} == {*range(choices)}  # whole numbers, each of which is tried
    assert points[:, 1:].min() >= 0.0
    assert points[:, 1:].max() <= 1.0


def test_words_alone_are_tried_once_each():
    points, _ = found(lambda points: points[:, 0], [[0], [1], [2]], 100, 3)
    assert points.tolist() == [[0.0], [1.0], [2.0]]


def test_a_population_that_has_converged_begins_again_elsewhere():
    # Two hollows, of which the one at the start is wide and the other better.
    def hollows(points):
        near, far = (np.sum((points[:, 1:] - place) ** 2, axis=1) for place in (0.1, 0.9))
        return np.minimum(near + 0.02, 20.0 * far) + 1.0

    points, costs = found(hollows, [[0, 0.1, 0.1]], 6000)
    assert points[np.argmin(costs), 1:] == pytest.approx(0.9, abs=0.02)


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_an_error_passes_through(error):
    calls = []

    def interrupted(points):
        calls.append(points)
        if len(calls) == 4:
            raise error("from within")
        return distance(points)

    with pytest.raises(error, match="from within"):
        found(interrupted, [[0, 0.9, 0.9]], 1000)
    assert len(calls) == 4
