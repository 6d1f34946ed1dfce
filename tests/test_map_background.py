"""A field map with the field of its surroundings has a note, and others have none."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from measured_maps import formula_fields, formula_map, grid
from stickslip import COIL_NAMES, Coil, FieldMap, Scenario
from stickslip.simulation.map_background import background
from stickslip.simulation.notes import CODES, scenario_notes

EARTH = np.array([20e-6, 0.0, -45e-6])  # T


def of_map(points, fields):
    return background(FieldMap.from_points(points, fields))


@pytest.mark.parametrize("current", [1.0, 2.0])
def test_a_background_that_was_not_subtracted_gets_one_note(current):
    points = grid()
    random = np.random.default_rng(2)
    noise = 5e-6 * random.standard_normal((len(points), len(COIL_NAMES), 3))  # 0.5 % of the field
    measured = FieldMap.from_points(points, formula_fields(points) + EARTH / current + noise)
    note, of_file = scenario_notes(Scenario(coil=Coil(map=measured)))
    assert (note.code, of_file.code) == ("map-background", "map")
    assert note.code in CODES
    # The mean of 225 points and of three or four coils.
    assert note.value == pytest.approx(np.linalg.norm(EARTH) / current, abs=1e-6)
    assert "subtract what the probe reads without current" in note.text


def test_coils_that_are_turned_have_no_common_background():
    points = grid((8e-3, 3e-3, 3e-3), (5, 3, 3))
    fields = formula_fields(points)
    random = np.random.default_rng(5)
    frame = Rotation.from_rotvec([0.05, 0.03, -0.06])
    assert of_map(points, frame.apply(fields.reshape(-1, 3)).reshape(fields.shape)) == []
    for _ in range(50):
        # Of such sets 3 in 10 000 look as if they had one: with this seed none of 50 does.
        turned = [Rotation.from_rotvec(np.radians(2.0) * random.standard_normal(3)).apply(one)
                  for one in fields.transpose(1, 0, 2)]  # fmt: skip
        assert of_map(points, np.stack(turned, axis=1)) == []
    assert background(formula_map(noise=0.01)) == []


def test_coils_that_are_not_there_show_no_background():
    points = grid()
    fields = formula_fields(points)
    fields[:, 2:4] = 0.0
    assert of_map(points, fields) == []
