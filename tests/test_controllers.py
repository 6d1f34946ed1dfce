"""The example of two controllers, on a few robots."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "examples"))

import controllers
from controllers import ENOUGH, SURE, TOLERANCE, Coarse, Fine, drawn, judged

from stickslip.control import Camera, Film

COUNT = 12
STILL = 0.1e-6  # m; what may still rock when a look begins, see `SETTLE`


@pytest.fixture(scope="module")
def tables():
    learned = drawn(24, seed=1)
    return Coarse.simulated(learned), Fine.simulated(learned)


@pytest.fixture(scope="module")
def outcomes(tables):
    return judged(drawn(COUNT, seed=2), *tables)


def test_the_tables_can_be_read_backwards(tables):
    coarse, fine = tables
    assert (np.diff(fine.heights) > 0.0).all()
    assert (np.diff(fine.steps) > 0.0).all()
    assert (fine.steps[fine.heights < 0.0] < 0.0).all()
    # The tolerance is within reach: some step is shorter.
    assert np.abs(fine.steps).min() < TOLERANCE
    assert (coarse.low <= coarse.median).all()
    assert (coarse.median <= coarse.high).all()
    near, far = coarse.choose(np.array([0.0, 1e-3]))
    assert near == coarse.slowest
    assert far == np.argmax(coarse.low)


def test_robots_come_within_two_micrometres_of_the_goal(outcomes):
    exact = outcomes["exact state, coarse and fine"]
    # Done is who is seen within ENOUGH.
    assert np.abs(exact.error).max() <= ENOUGH + STILL
    assert exact.within == 1.0
    seen = outcomes["camera, coarse and fine"]
    # The mean of the images is within ENOUGH, and has the deviation SURE: beyond 4 of them are
    # 6 in 1e5. At worst all means are at the edge, and then 5 % of the robots are 1.7 deviations
    # beyond it, which is the tolerance: of twelve 3 or more with a probability of 2 %.
    assert np.isfinite(seen.time).all()
    assert np.abs(seen.error).max() <= ENOUGH + 4.0 * SURE + STILL
    assert seen.within >= (COUNT - 2) / COUNT


def test_the_fine_controller_gains_what_the_coarse_one_leaves(outcomes):
    for seen in ("exact state", "camera"):
        alone, both = outcomes[f"{seen}, coarse"], outcomes[f"{seen}, coarse and fine"]
        assert np.median(np.abs(alone.error)) > 2.0 * np.median(np.abs(both.error))
        # A pulse goes at most 35 um, and the coarse controller leaves less than some hundred.
        assert np.abs(alone.error).max() < 1e-4
        assert both.pulses.min() >= 1


def test_the_table_has_a_row_for_each(tables, outcomes, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["controllers.py", "--robots", str(COUNT)])
    monkeypatch.setattr(controllers, "judged", lambda *_: outcomes)
    monkeypatch.setattr(Coarse, "simulated", lambda _: tables[0])
    monkeypatch.setattr(Fine, "simulated", lambda _: tables[1])
    controllers.main()
    rows = capsys.readouterr().out.splitlines()[2:]
    assert [each.split(" | ")[0] for each in rows] == [f"| {name}" for name in outcomes]


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
