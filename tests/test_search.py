"""The search: known optima of plain functions, ranks, restarts, seeds, interrupts."""

import os
import signal
import sys
import threading

import numpy as np
import pytest

from stickslip.design.search import search

CENTRE = 0.3


def distance(pairs):
    """Squared distance from a point; worse by the arm's index."""
    return [((float(np.sum((p - CENTRE) ** 2)) + arm,), None) for arm, p in pairs]


@pytest.mark.parametrize("dimensions", [1, 2, 6])
def test_the_optimum_of_a_smooth_function_is_found(dimensions):
    found = search([np.full(dimensions, 0.9)], distance, 300 * dimensions, 0)
    # The step at which a strategy has converged, and begins again, is 1e-3 of the range.
    assert found.leaders[0].point == pytest.approx(CENTRE, abs=1e-2)
    assert found.centres[0].point == pytest.approx(CENTRE, abs=1e-2)


def test_only_ranks_count():
    plain = search([np.full(3, 0.9)], distance, 300, 0)
    bent = search(
        [np.full(3, 0.9)],
        lambda pairs: [((1e9 * np.sqrt(key[0]) - 7.0,), None) for key, _ in distance(pairs)],
        300,
        0,
    )
    assert np.array_equal(plain.leaders[0].point, bent.leaders[0].point)


def test_a_limit_is_met_before_the_score_counts():
    # The largest sum of two coordinates whose squares sum to 0.5 at most is one, at 0.5 and 0.5.
    def evaluate(pairs):
        excess = [max(float(np.sum(p**2)) - 0.5, 0.0) for _, p in pairs]
        return [
            ((over, 0.0 if over else -float(np.sum(p))), None)
            for over, (_, p) in zip(excess, pairs, strict=True)
        ]

    best = search([np.full(2, 0.9)], evaluate, 2000, 1).leaders[0]
    assert best.key[0] == 0.0
    # Along the circle the sum falls with the square of the way: a step of 1e-2 costs 1e-4.
    assert -best.key[1] == pytest.approx(1.0, abs=1e-3)


def test_the_best_arm_is_found_and_gets_most_of_the_budget():
    counts = np.zeros(4, dtype=int)

    def counted(pairs):
        for arm, _ in pairs:
            counts[arm] += 1
        return distance(pairs)

    found = search([np.full(3, 0.9)] * 4, counted, 800, 0)
    assert found.leaders[0].arm == 0
    assert counts[0] > 0.5 * counts.sum()
    assert counts.sum() == found.count


def test_arms_without_numbers_are_compared_once():
    found = search([np.empty(0)] * 3, distance, 100, 0)
    assert (found.count, found.leaders[0].arm) == (3, 0)


def test_a_seed_gives_one_result_and_leaves_the_state_of_numpy_alone():
    before = np.random.get_state()[1].tobytes()  # noqa: NPY002 - this state is what is meant
    first, again, other = (search([np.full(3, 0.9)], distance, 200, seed) for seed in (5, 5, 6))
    assert np.array_equal(first.leaders[0].point, again.leaders[0].point)
    assert not np.array_equal(first.leaders[0].point, other.leaders[0].point)
    assert np.random.get_state()[1].tobytes() == before  # noqa: NPY002


def test_a_strategy_that_has_converged_begins_again_elsewhere():
    # Two hollows, of which the one at the start is the shallower.
    def hollows(pairs):
        return [
            ((min(float(np.sum((p - 0.1) ** 2)) + 0.01, float(np.sum((p - 0.9) ** 2))),), None)
            for _, p in pairs
        ]

    found = search([np.full(2, 0.1)], hollows, 4000, 0)
    assert found.leaders[0].point == pytest.approx(0.9, abs=1e-2)


def test_an_interrupt_keeps_what_was_found():
    calls = []

    def interrupted(pairs):
        calls.append(pairs)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return distance(pairs)

    found = search([np.full(3, 0.9)], interrupted, 1000, 0)
    assert found.interrupted
    assert found.count == sum(map(len, calls[:3]))
    assert found.leaders[0].key == min(key for each in calls[:3] for key, _ in distance(each))


def test_an_interrupt_before_anything_was_found_passes_through():
    def interrupted(pairs):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        search([np.full(3, 0.9)], interrupted, 1000, 0)


def test_an_interrupt_while_the_library_is_loaded_keeps_the_start_and_loads_all_of_it(
    tmp_path, monkeypatch
):
    (tmp_path / "cma.py").write_text("import time\ntime.sleep(0.5)\nwhole = True\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "cma", None)
    del sys.modules["cma"]
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    found = search([np.full(2, 0.9)], distance, 100, 0)
    assert found.interrupted
    assert [each.point.tolist() for each in found.leaders] == [[0.9, 0.9]]
    assert sys.modules["cma"].whole
