"""Frozen runs keep their bits: ``python tests/frozen/freeze.py`` makes them again.

`frozen/freeze.py` says on which machines that means bits, and what it means on others.
"""

import math
import os
import subprocess
import sys

import pytest

from frozen import freeze
from frozen.scenarios import OWN_NAME, register_own_effect, scenarios
from own_effects import unregister


@pytest.fixture(scope="module", autouse=True)
def own_effect():
    """Some scenarios have an effect of the user."""
    register_own_effect()
    yield
    unregister(OWN_NAME)


@pytest.fixture(scope="module")
def chosen():
    return scenarios()


def changes(runs):
    made_on, expected = freeze.read()
    return freeze.changes(runs, expected, to_the_bit=made_on == freeze.machine())


def test_frozen_runs_are_what_they_were(chosen):
    assert changes(freeze.simulated(chosen)) == []


def test_the_file_has_the_scenarios_that_are_drawn_today(chosen):
    _, expected = freeze.read()
    assert list(expected) == list(chosen)


def test_a_changed_bit_is_found(chosen):
    """On any machine a run that answers to rounding by little cannot be another."""
    _, expected = freeze.read()
    name = next(n for n, run in expected.items() if run.status == "ok" and run.spread < 1e-9)
    run = expected[name]

    def moved(velocity):
        return {name: run._replace(numbers={**run.numbers, "mean_velocity": velocity})}

    velocity = run.numbers["mean_velocity"]
    by_a_bit, by_more = moved(math.nextafter(velocity, 1.0)), moved(velocity + 1e-12)
    assert len(freeze.changes(by_a_bit, expected, to_the_bit=True)) == 1
    assert freeze.changes(by_a_bit, expected, to_the_bit=False) == []
    assert len(freeze.changes(by_more, expected, to_the_bit=False)) == 1


@pytest.mark.nightly
@pytest.mark.parametrize("threads", [1, 2])
def test_frozen_runs_are_what_they_were_with_threads(threads, chosen):
    assert changes(freeze.simulated(chosen, threads)) == []


@pytest.mark.nightly
@pytest.mark.parametrize("width", ["1", "4", "8"])
def test_frozen_runs_have_their_bits_in_packs_of_any_width(width):
    """In a process of its own, which reads the width once."""
    done = subprocess.run(
        [sys.executable, freeze.__file__, "--check"],
        capture_output=True,
        text=True,
        env={**os.environ, "STICKSLIP_LANES": width},
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
