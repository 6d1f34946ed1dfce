"""The example that places robots: those that differ come to their goal."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "examples"))

import controllers
from controllers import CAMERAS, SCENARIO, TOLERANCE, Placer

COUNT = 12
# Of the tolerance: done is a mean of images within half of it, whose deviation is 0.3 of it.
ENOUGH, SURE, STILL = 0.5 * TOLERANCE, 0.3 * TOLERANCE, 0.1e-6


@pytest.fixture(scope="module")
def placer():
    return Placer(SCENARIO, CAMERAS["exact state"], draws=16, seed=1)


def test_the_tables_can_be_read_backwards(placer):
    assert (np.diff(placer.steps) > 0.0).all()
    assert placer.steps[0] < 0.0 < placer.steps[-1]
    assert np.abs(placer.steps[placer.steps != 0.0]).min() < TOLERANCE
    assert (placer.low > 0.0).all()


@pytest.mark.parametrize(("name", "deviations", "wrong"), [("exact state", 0, 0), ("camera", 4, 2)])
def test_robots_come_within_two_micrometres_of_the_goal(placer, name, deviations, wrong):
    # Beyond 4 deviations of a mean are 6 in 1e5; at worst 5 % of the robots are 1.7 of them beyond
    # ENOUGH, which is the tolerance: of twelve 3 or more with a probability of 2 %.
    placer.camera = CAMERAS[name]
    time, error, pulses = placer.put(SCENARIO.draws(COUNT, seed=2), 3e-3)
    assert np.isfinite(time).all()
    assert np.abs(error).max() <= ENOUGH + deviations * SURE + STILL
    assert np.sum(np.abs(error) > TOLERANCE) <= wrong
    assert pulses.min() >= 1


def test_a_robot_whose_simulation_fails_is_never_there(placer):
    ice = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0, "drag.linear": 0.0}
    sound = SCENARIO.with_uncertain(None)
    placer.camera = CAMERAS["exact state"]
    time, *_ = placer.put([sound, sound.replace(ice)], 0.5e-3, limit=3.0)
    assert np.isfinite(time).tolist() == [True, False]


def test_the_example_prints_a_row_for_each_camera(placer, monkeypatch, capsys):
    monkeypatch.setattr(controllers, "Placer", lambda *_, **__: placer)
    monkeypatch.setattr(controllers, "CAMERAS", {"exact state": CAMERAS["exact state"]})
    controllers.main(2)
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 3
    assert rows[-1].startswith("| exact state |")
    assert "| 100.0 % |" in rows[-1]
