"""Files of measured fields: what is read, refused, and written with a scenario or a run."""

import json
import pickle

import numpy as np
import pytest

from command_line import check, stickslip
from made_measurement import few_causes
from measured_maps import formula_fields, grid, with_map, write_csv
from stickslip import Coils, FieldMap, ScenarioError, diagnose, load, simulate, sweep
from stickslip.walker import read_measurement

HEAD = "stickslip = 1\n\n[drive]\nbase = 0.5e-3\npulses = 8\n"
SCENARIO = HEAD + '\n[coil]\nmap = "map.csv"\n'


@pytest.fixture(scope="module")
def fields():
    return formula_fields(grid())


@pytest.fixture(scope="module")
def file(tmp_path_factory, fields):
    return write_csv(tmp_path_factory.mktemp("maps") / "map.csv", grid(), fields)


@pytest.fixture
def folder(tmp_path, file):
    (tmp_path / "map.csv").write_text(file.read_text())
    (tmp_path / "s.toml").write_text(SCENARIO)
    return tmp_path


def test_rows_and_columns_stand_in_any_order(file, tmp_path, fields):
    expected = FieldMap.from_points(grid(), fields)
    assert FieldMap.from_file(file) == expected
    assert expected.points == (len(grid()),) * 5
    head, *rows = file.read_text().splitlines()
    turned = [",".join(reversed(row.split(","))) for row in (head, *rows)]
    other = tmp_path / "other.csv"
    other.write_text("\n".join(["# probe 3, 1 A", turned[0], *turned[1:]]) + "\n")
    assert FieldMap.from_file(other) == expected
    other.write_text("\n".join([head, *rows[::-1]]) + "\n")
    found, exact = (
        Coils.of(with_map(each)).field(grid(), np.ones(5))
        for each in (FieldMap.from_file(other), expected)
    )
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12 * np.abs(exact).max())


def test_a_scenario_with_a_map_is_written_and_read_to_the_last_bit(folder):
    scenario = load(folder / "s.toml")
    text = scenario.to_toml(folder / "again.toml")
    assert 'map = "again.map.json"' in text
    again = load(folder / "again.toml")
    assert again == scenario
    assert again.coil.map.residual == scenario.coil.map.residual
    assert pickle.loads(pickle.dumps(scenario)) == scenario
    assert simulate(again).summary() == simulate(scenario).summary()


def test_a_sweep_with_another_map_is_not_resumed(tmp_path, fields):
    values = {"drive.frequency": [50.0, 100.0]}
    base = with_map(FieldMap.from_points(grid(), fields), drive__pulses=4)
    sweep(base, values, out=tmp_path / "s.nc")
    other = base.replace({"coil.map": FieldMap.from_points(grid(), 1.01 * fields)})
    with pytest.raises(ScenarioError, match="it belongs to another sweep"):
        sweep(other, values, out=tmp_path / "s.nc", resume=True)
    kept = sweep(base, values, out=tmp_path / "s.nc", resume=True)
    assert kept.sizes["drive_frequency"] == 2


def test_a_sweep_whose_map_has_another_name_is_resumed(tmp_path, fields):
    values = {"drive.frequency": [50.0, 100.0]}
    base = with_map(FieldMap.from_points(grid(), fields, "map.csv"), drive__pulses=4)
    first = sweep(base, values, out=tmp_path / "s.nc")
    renamed = base.replace({"coil.map": FieldMap.from_points(grid(), fields, "coils.csv")})
    assert renamed == base
    again = sweep(renamed, values, out=tmp_path / "s.nc", resume=True)
    assert again["mean_velocity"].values.tolist() == first["mean_velocity"].values.tolist()


def test_the_command_takes_a_map_by_set(folder):
    (folder / "plain.toml").write_text(HEAD)
    with_file = json.loads(stickslip("run", "s.toml", "--json", cwd=folder).stdout)
    options = ["--set", 'coil.map="map.csv"', "--json"]
    assert json.loads(stickslip("run", "plain.toml", *options, cwd=folder).stdout) == with_file
    (folder / "map.csv").rename(folder / "other.csv")
    options = ["--set", "coil.map=other.csv", "--json"]
    assert json.loads(stickslip("run", "plain.toml", *options, cwd=folder).stdout) != with_file
    check(stickslip("run", "s.toml", cwd=folder), "s.toml", 'coil.map = "map.csv"', "No such file")
    options = ["--vary", "coil.map=a.csv,b.csv"]
    check(stickslip("sweep", "plain.toml", *options, cwd=folder), "coil.map", "voltages or maps")


@pytest.mark.parametrize("option", ["--out", "--plot"])
def test_a_map_is_not_overwritten(folder, option):
    check(stickslip("run", "s.toml", option, "map.csv", cwd=folder), option, "map.csv is read")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        # A point that is off; a field of the wrong sign, at which the fit leaves most.
        ((3, 0, 5.0), "coil xm, row {row}: x = 5.0: allowed are -1 to 1 m"),
        ((5, 4, -1.0), "coil xm: the fit leaves .*, most at row {row}: .* look for"),
    ],
)
def test_a_point_out_of_place_is_named_by_its_row(tmp_path, fields, change, said):
    point, column, value = change
    path = write_csv(tmp_path / "m.csv", grid(), fields)
    lines = path.read_text().splitlines()
    at = 1 + len(grid()) + point  # in the second coil, below the header
    cells = lines[at].split(",")
    cells[column] = repr(value if column == 0 else value * float(cells[column]))
    lines[at] = ",".join(cells)
    path.write_text("\n".join(["# of Monday", *lines]))
    with pytest.raises(ScenarioError, match=said.format(row=at + 2)):
        FieldMap.from_file(path)


def test_what_no_coil_makes_is_refused():
    points = grid()
    # Rows in a wrong order: over these 16 mm the field changes by 30 %.
    fields = np.random.default_rng(4).permutation(formula_fields(points))
    with pytest.raises(ScenarioError, match="coil xp: the fit leaves"):
        FieldMap.from_points(points, fields)


def measured(folder, rows, uncertain=""):
    """A measurement of fields with the scenario s.toml."""
    text = 'stickslip_measurement = 1\nscenario = "s.toml"\n[uncertain]\n' + uncertain
    (folder / "m.toml").write_text(text + '\n[[field]]\nfile = "field.csv"\n')
    columns = "xp,xm,yp,ym,clamp,x,y,z,Bx,By,Bz"
    lines = [",".join(map(str, row)) for row in rows]
    (folder / "field.csv").write_text("\n".join([columns, *lines]) + "\n")
    return read_measurement(folder / "m.toml")


def test_a_diagnosis_has_the_map_as_its_model(folder, monkeypatch):
    few_causes(monkeypatch, ("field_gain", "ambient_field"))
    # Each coil by itself, all of them 4 % stronger in the plane than their map says.
    random = np.random.default_rng(5)
    places = random.uniform(-2e-3, 2e-3, (40, 3))
    currents = np.repeat(np.eye(5), 8, axis=0) * np.tile([-2.0, -1.0, 1.0, 2.0], 10)[:, None]
    gain = np.array([1.04, 1.04, 1.04, 1.04, 1.0])
    field = np.einsum("nk,nki->ni", currents * gain, formula_fields(places))
    field += 5e-6 * random.standard_normal(field.shape)
    rows = np.hstack([currents, places, field])
    found = diagnose(measured(folder, rows), seed=0)
    assert found.verdict.kind == "named"
    assert found.verdict.causes == ("field_gain",)
    assert found.extended.coil.map == load(folder / "s.toml").coil.map

    rows[3, 5] = 0.02
    with pytest.raises(ScenarioError, match=r"1 of 40 probes lie outside of coil\.map, the first"):
        diagnose(measured(folder, rows), seed=0)
    rows[3, 5] = 0.0
    uncertain = '"coil.distance" = { mean = 0.1, sd = 0.01 }\n'
    with pytest.raises(ScenarioError, match=r"coil\.distance.* beside coil\.map"):
        diagnose(measured(folder, rows, uncertain), seed=0)
