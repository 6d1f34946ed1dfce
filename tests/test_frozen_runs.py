"""Frozen runs keep their bits: ``python tests/frozen/freeze.py`` makes them again.

`frozen/freeze.py` says on which machines that means bits, and what it means on others.
"""

import math

import pytest

from frozen import freeze
from frozen.scenarios import scenarios
from stickslip.simulation.notes import scenario_notes


@pytest.mark.usefixtures("frozen_effect")
def test_frozen_runs_are_what_they_were():
    made_on, expected = freeze.read()
    chosen = scenarios()
    runs = freeze.simulated(chosen)
    assert [*freeze.changes(runs, expected, to_the_bit=made_on == freeze.machine())] == []
    assert list(expected) == list(chosen)


@pytest.mark.usefixtures("frozen_effect")
def test_frozen_scenarios_have_usual_values():
    for name, scenario in scenarios().items():
        assert "unusual" not in {note.code for note in scenario_notes(scenario)}, name


def test_a_changed_bit_is_found():
    """On any machine a run that answers to rounding by little cannot be another."""
    _, expected = freeze.read()
    name = next(n for n, run in expected.items() if run.status == "ok" and run.spread < 1e-9)
    run = expected[name]

    def moved(velocity):
        return {name: run._replace(numbers={**run.numbers, "mean_velocity": velocity})}

    velocity = run.numbers["mean_velocity"]
    by_a_bit, by_more = moved(math.nextafter(velocity, 1.0)), moved(velocity + 1e-12)
    assert len([*freeze.changes(by_a_bit, expected, to_the_bit=True)]) == 1
    assert [*freeze.changes(by_a_bit, expected, to_the_bit=False)] == []
    assert len([*freeze.changes(by_more, expected, to_the_bit=False)]) == 1
