"""The way into a diagnosis of a measurement."""

import numpy as np
import pytest

from made_velocities import drives, measurement, trials
from stickslip import Scenario, diagnose, propose_experiments
from stickslip.walker.library import library
from stickslip.walker.problem import posed_by


@pytest.fixture(scope="module")
def table():
    return trials()


@pytest.mark.nightly
def test_nothing_is_found_where_nothing_is_whatever_the_threads_and_little_by_the_seed(table):
    told = []
    result = diagnose(measurement(table), threads=1, progress=lambda *each: told.append(each))
    assert told[-1][0] == 1.0
    assert (result.verdict.kind, result.verdict.causes) == ("none", ())
    friction = result.params.loc["contact.kinetic_friction"]
    stated = Scenario().contact.kinetic_friction
    assert abs(friction["value"] - stated) < 4.0 * friction["sd"]
    assert result.extended.contact.kinetic_friction == friction["value"]
    assert result.extended.uncertain is not None
    assert len(propose_experiments(result)) == 0
    again = diagnose(measurement(table), threads=2)
    assert again.as_dict()["ranking"] == result.as_dict()["ranking"]
    assert np.array_equal(again.findings.models.null.x, result.findings.models.null.x)
    assert again.findings.test.p_value == result.findings.test.p_value
    other = diagnose(measurement(table), threads=2, seed=7)
    assert other.verdict.kind == "none"
    moved = (other.params["value"] - result.params["value"]).abs()
    assert (moved < 0.2 * result.params["sd"]).all()


# ---------------------------------------------------------------------------------- the problem
def test_a_measurement_poses_its_tables_constants_and_instruments(table):
    posed = posed_by(measurement(table), threads=1)
    assert [each.name for each in posed.tables] == ["velocity"]
    assert posed.constants[0].name == "contact.kinetic_friction"
    names = [each.name for each in posed.causes]
    assert len(names) == len(set(names))
    scenario = measurement(table).scenario
    effects = {each.name for each in library(scenario, {"contact.kinetic_friction": None}, 20.0)}
    assert effects <= set(names)
    # What reads the velocities, and what is other than stated.
    assert {"velocity_offset", "contact.kinetic_friction"} <= set(names)
    assert len(posed.y) == len(drives())


def test_the_stated_model_is_at_the_middle_of_the_coordinates(table):
    posed = posed_by(measurement(table), threads=1)
    x = np.zeros((1, posed.size))
    made = posed.model(posed.physical(x))[0]
    # Readings have an error of 2 %, of which three were taken.
    assert made == pytest.approx(posed.y, rel=0.1)
    # A limit of the velocities below half of the largest cuts these off, and nothing else.
    (clip,) = (each for each in posed.causes if each.name == "velocity_clipping")
    (column,) = posed.columns([clip])
    x[0, column] = 6.0
    limited = posed.model(posed.physical(x))[0]
    limit = float(posed.physical(x)[0, column])
    assert limited == pytest.approx(np.clip(made, -limit, limit), rel=1e-9)
    assert np.abs(limited - made).max() > 0.0
