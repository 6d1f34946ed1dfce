"""What is no measured field of five coils, in a file or in Python: refused in one line."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray

from command_line import check, stickslip
from measured_maps import HALF, dataset, formula_fields, formula_map, grid
from own_effects import (
    nothing,
    nothing_stays,  # noqa: F401 (around every test here)
    parameter,
    register,
)
from stickslip import Coil, FieldMap, Scenario, ScenarioError
from stickslip.field.map_files import map_text

SMALL = (3, 3, 3)


@pytest.fixture(scope="module")
def field_map():
    return formula_map(count=SMALL)


@pytest.mark.parametrize(("name", "number"), [("points", "1e999"), ("residual", "1" + 400 * "0")])
def test_a_number_that_is_too_large_is_no_map(tmp_path, field_map, name, number):
    content = json.loads(map_text(field_map))
    content["coils"]["xp"][name] = "HERE"
    text = json.dumps(content).replace('"HERE"', number)
    (tmp_path / "a.json").write_text(text)
    (tmp_path / "s.toml").write_text('stickslip = 1\n[drive]\n[coil]\nmap = "a.json"\n')
    check(stickslip("run", tmp_path / "s.toml"), 'coil.map = "a.json"', "is no fitted map")


def test_a_unit_that_is_an_array_is_refused(tmp_path):
    data = dataset(formula_fields(grid(count=SMALL)), HALF, SMALL)
    data["Bz"].attrs["units"] = [1, 2]
    data.to_netcdf(tmp_path / "map.nc")
    with pytest.raises(ScenarioError, match=r'units of Bz = .*: allowed is "T/A"'):
        FieldMap.from_file(tmp_path / "map.nc")


@pytest.mark.parametrize("points", ["text", [[0, 0, 0], [1, 2]], [[10**400, 0, 0]], [[{}, 0, 0]]])
def test_points_that_are_no_numbers_are_refused(points):
    with pytest.raises(ScenarioError, match="points and fields: allowed are numbers of shapes"):
        FieldMap.from_points(points, np.zeros((2, 5, 3)))


@pytest.mark.parametrize("name", ["coefficients", "residual", "field", "points"])
def test_a_map_has_every_number_for_each_coil(field_map, name):
    for given in ((), getattr(field_map, name)[:4]):
        with pytest.raises(ScenarioError, match=f"{name} of {len(given)} coils: allowed is one"):
            replace(field_map, **{name: given})


def test_samples_are_of_five_coils():
    with pytest.raises(ScenarioError, match="samples of 0 coils: allowed is one for each of 5"):
        FieldMap.from_coils([])


@pytest.mark.parametrize("key", ["coil.turns", "coil.clamp.distance"])
def test_the_geometry_beside_a_map_is_not_uncertain(field_map, key):
    with pytest.raises(ScenarioError, match=rf"{key}: cannot be uncertain beside coil\.map"):
        Scenario(coil=Coil(map=field_map)).with_uncertain({key: {"mean": 0.1, "sd": 0.01}})


def test_an_effect_of_ones_own_beside_a_map_can_be_uncertain(field_map):
    register(nothing, parameter("distance"), name="recoil")
    uncertain = {"effects.recoil.distance": {"mean": 0.1, "sd": 0.01}}
    scenario = Scenario(coil=Coil(map=field_map)).with_uncertain(uncertain)
    assert scenario.uncertain.names == ("effects.recoil.distance",)


def test_a_netcdf_file_that_is_too_large_is_refused(tmp_path):
    count = (47, 47, 47)
    zeros = np.zeros((47**3, 5, 3), dtype=np.float32)
    dataset(zeros, HALF, count).to_netcdf(tmp_path / "map.nc")
    with pytest.raises(ScenarioError, match=r"has 47 x 47 x 47 x 5 values .* at most 500000"):
        FieldMap.from_file(tmp_path / "map.nc")


def test_a_want_of_memory_is_not_taken_for_another_file(tmp_path, monkeypatch):
    def open_dataset(path):
        raise MemoryError

    monkeypatch.setattr(xarray, "open_dataset", open_dataset)
    with pytest.raises(MemoryError):
        FieldMap.from_file(tmp_path / "map.nc")
