"""The search: known optima of plain functions, ranks, restarts, seeds, interrupts."""

import numpy as np
import pytest

from stickslip.design.search import search

CENTRE = 0.3


def distance(rows):
    """Squared distance from a point; worse by the arm's index."""
    return (np.sum((rows[:, 1:] - CENTRE) ** 2, axis=1) + rows[:, 0])[:, None]


def found(evaluate, starts, budget, seed=0):
    """All candidates and their keys, and how many of the last are centres."""
    seen, keys = [], []

    def kept(rows):
        seen.append(rows)
        keys.append(evaluate(rows))
        return keys[-1]

    centres = search(np.array(starts, dtype=float), kept, budget, seed)
    return np.concatenate(seen), np.concatenate(keys), centres


def best(rows, keys):
    return rows[np.lexsort(keys.T[::-1])[0]]


@pytest.mark.parametrize("dimensions", [1, 2, 6])
def test_the_optimum_of_a_smooth_function_is_found(dimensions):
    rows, keys, centres = found(distance, [[0.9] * dimensions], 300 * dimensions)
    # The step at which a strategy has converged, and begins again, is 1e-3 of the range.
    assert best(rows, keys)[1:] == pytest.approx(CENTRE, abs=1e-2)
    assert rows[-centres, 1:] == pytest.approx(CENTRE, abs=1e-2)


def test_only_ranks_count():
    rows, _, _ = found(distance, [[0.9] * 3], 300)
    bent, _, _ = found(lambda rows: 1e9 * np.sqrt(distance(rows)) - 7.0, [[0.9] * 3], 300)
    assert np.array_equal(rows, bent)


def test_a_limit_is_met_before_the_score_counts():
    # The largest sum of two coordinates whose squares sum to 0.5 at most is one, at 0.5 and 0.5.
    def evaluate(rows):
        over = np.maximum(np.sum(rows[:, 1:] ** 2, axis=1) - 0.5, 0.0)
        return np.column_stack([over, np.where(over > 0.0, 0.0, -rows[:, 1:].sum(axis=1))])

    rows, keys, _ = found(evaluate, [[0.9, 0.9]], 2000, seed=1)
    over, score = evaluate(best(rows, keys)[None])[0]
    assert over == 0.0
    # Along the circle the sum falls with the square of the way: a step of 1e-2 costs 1e-4.
    assert -score == pytest.approx(1.0, abs=1e-3)


def test_the_best_arm_is_found_and_gets_most_of_the_budget():
    rows, keys, _ = found(distance, [[0.9] * 3] * 4, 800)
    assert best(rows, keys)[0] == 0
    assert np.sum(rows[:, 0] == 0) > 0.5 * len(rows)
    assert len(rows) == pytest.approx(800, abs=40)  # the last generations of four arms


def test_arms_without_numbers_are_compared_once():
    rows, _, centres = found(distance, np.empty((3, 0)), 100)
    assert rows.tolist() == [[0.0], [1.0], [2.0]]
    assert centres == 0


def test_a_seed_gives_one_result_and_leaves_the_state_of_numpy_alone():
    before = np.random.get_state()[1].tobytes()  # noqa: NPY002 - this state is what is meant
    first, again, other = (found(distance, [[0.9] * 3], 200, seed)[0] for seed in (5, 5, 6))
    assert np.array_equal(first, again)
    assert not np.array_equal(first[:20], other[:20])
    assert np.random.get_state()[1].tobytes() == before  # noqa: NPY002


def test_a_strategy_that_has_converged_begins_again_elsewhere():
    # Two hollows, of which the one at the start is the shallower.
    def hollows(rows):
        near, far = (np.sum((rows[:, 1:] - place) ** 2, axis=1) for place in (0.1, 0.9))
        return np.minimum(near + 0.01, far)[:, None]

    sizes = []
    rows, keys, centres = found(
        lambda rows: sizes.append(len(rows)) or hollows(rows), [[0.1, 0.1]], 4000
    )
    assert best(rows, keys)[1:] == pytest.approx(0.9, abs=1e-2)
    assert centres > 1
    # Each begins with twice as many a generation; the start and the centres stand about them.
    assert list(dict.fromkeys(sizes[1:-1])) == [sizes[1] * 2**k for k in range(centres)]


def test_an_interrupt_passes_through():
    calls = []

    def interrupted(rows):
        calls.append(rows)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return distance(rows)

    with pytest.raises(KeyboardInterrupt):
        search(np.full((1, 3), 0.9), interrupted, 1000, 0)
    assert len(calls) == 4
