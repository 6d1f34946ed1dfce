"""Errors of the readings of a measurement, named beside the simulator's effects."""

import itertools

import numpy as np
import pandas as pd
import pytest

from films import write_films
from made_measurement import few_causes, write_files
from stickslip import Coils, Measurement, Prior, Scenario, _core, diagnose, simulate_batch
from stickslip.scenario.keys import COIL_NAMES
from stickslip.walker import read_measurement
from stickslip.walker.problem import posed_by

ANGLES = ["Bx", "Bz", "theta"]
FIELDS = 1e-3 * np.array([[2.0, z] for z in (-3, -2.5, -2, -1.6, -1.3, -1, 1, 1.3, 1.6, 2, 2.5, 3)])


NOMINAL = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 6\n"
HEAD = 'stickslip_measurement = 1\nscenario = "nominal.toml"\n[uncertain]\n'


def read(folder, kind, columns, **tables):
    """A measurement of tables of one kind, each as rows, in this order."""
    toml = HEAD + "".join(f'[[{kind}]]\nfile = "{name}.csv"\n' for name in tables)
    tables = {name: pd.DataFrame(rows, columns=columns) for name, rows in tables.items()}
    return read_measurement(write_files(folder, NOMINAL, toml, **tables))


def tilts(fields):
    core = Scenario().replace({"drive.base": 0.5e-3}).to_core()
    return _core.static_tilts(core, [], np.zeros((1, 0)), fields)[0]


@pytest.mark.parametrize("seed", range(2))
def test_angles_with_a_wrong_scale_are_not_blamed_on_the_robot(tmp_path, monkeypatch, seed):
    few_causes(monkeypatch, ("misalignment", "magnetization_scale", "surface_tilt"))
    random = np.random.default_rng(seed)
    fields = np.repeat(FIELDS, 3, axis=0)
    true = tilts(fields)
    theta = 1.15 * true + np.radians(1.0) * random.standard_normal(len(true))
    found = diagnose(read(tmp_path, "angle", ANGLES, a=np.column_stack([fields, theta])))
    assert "angle_scale" in found.verdict.causes
    row = found.candidate("angle_scale").params.loc["angle_scale.error"]
    assert abs(row["value"] - 0.15) < 3.0 * row["sd"] < 0.06
    # The robot does what the scenario says; the readings are no part of it.
    assert "angle_scale" not in found.extended.to_toml()


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.nightly)])
def test_a_turned_probe_is_named_without_repeats(tmp_path, seed):
    random = np.random.default_rng(seed)
    amperes = np.vstack([each * np.eye(5) for each in (-2.0, -1.0, 1.0, 2.0)])
    places = np.tile([[0.0, 0.0, 0.0], [2e-3, 1e-3, -1e-3]], (len(amperes), 1))
    amperes = np.repeat(amperes, 2, axis=0)
    field = Coils().field(places, amperes) + 5e-6 * random.standard_normal((len(places), 3))
    # Along the axes of a probe that is turned by 0.02 rad about y: its x axis points down a little.
    c, s = np.cos(0.02), np.sin(0.02)
    seen = field @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    columns = [*COIL_NAMES, "x", "y", "z", "Bx", "By", "Bz"]
    found = diagnose(read(tmp_path, "field", columns, a=np.hstack([amperes, places, seen])))
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("probe_turned",))
    row = found.params.loc["probe_turned.about_y"]
    assert abs(row["value"] - 0.02) < 4.0 * row["sd"] < 0.01


@pytest.mark.nightly
def test_velocities_with_a_wrong_zero_are_named_beside_a_slope(monkeypatch):
    few_causes(monkeypatch, ("surface_tilt", "friction_anisotropy", "field_gain", "edge_time"))
    base = Scenario().replace({"drive.base": 5e-4, "drive.pulses": 8})
    grid = itertools.product(("IPP", "OPP"), ("+x", "-x"), (20.0, 30.0, 45.0, 65.0, 90.0, 120.0))
    drives = pd.DataFrame(grid, columns=["mode", "direction", "frequency"])
    runs = simulate_batch(
        [base.replace(dict(zip("drive." + drives.columns, row, strict=True)))
         for row in drives.itertuples(index=False)]
    )  # fmt: skip
    level = np.repeat([run.mean_velocity for run in runs], 3)
    read = level * (1.0 + 0.02 * np.random.default_rng(3).standard_normal(len(level))) + 1.5e-4
    rows = drives.loc[drives.index.repeat(3)].assign(trial=[1, 2, 3] * len(drives), velocity=read)
    known = {"contact.kinetic_friction": Prior("normal", 0.15, 0.01)}
    found = diagnose(Measurement.from_dataframe(rows, base, uncertain=known))
    assert found.verdict.causes == ("velocity_offset",)
    row = found.params.loc["velocity_offset.shift"]
    assert abs(row["value"] - 1.5e-4) < 3.0 * row["sd"]
    # At new drives the readings are off too.
    predicted = found.predict([{"frequency": 50.0}])
    (run,) = simulate_batch([found.extended.replace({"drive.frequency": 50.0})])
    shift = float(predicted["extended"].iloc[0]) - run.mean_velocity
    assert shift == pytest.approx(row["value"], abs=0.1 * abs(row["value"]))


@pytest.mark.nightly
def test_a_marker_off_the_centre_of_mass_is_named(tmp_path, monkeypatch):
    few_causes(monkeypatch, ("surface_tilt", "angle_offset", "length_scale"))
    path = write_films(tmp_path, 400.0, seed=2, marker=3e-5)
    found = diagnose(read_measurement(path))
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("marker_place",))
    row = found.params.loc["marker_place.along"]
    assert abs(row["value"] - 3e-5) < 3.0 * row["sd"] < 1.5e-5


def test_a_limit_is_searched_below_the_widest_of_several_tables(tmp_path):
    theta = tilts(FIELDS)
    rows = np.column_stack([FIELDS, theta])
    few = rows[np.abs(theta) < np.median(np.abs(theta))]
    ends = []
    for tables in ({"flat": few, "a": rows}, {"a": rows, "flat": few}):
        posed = posed_by(read(tmp_path, "angle", ANGLES, **tables))
        causes = {each.name: each for each in posed.causes}
        ends.append(causes["angle_clipping"].parameters[0].high)
    assert ends[0] == ends[1] > np.max(np.abs(theta))
