"""Drives to measure, before there are data and after a diagnosis."""

import math

import numpy as np
import pandas as pd
import pytest

from made_measurement import few_causes
from stickslip import (
    Drive,
    Measurement,
    Prior,
    Scenario,
    ScenarioError,
    diagnose,
    propose_experiments,
    simulate,
)
from stickslip.diagnosis.terms.words import Vocabulary, Words
from stickslip.walker import problem as measured
from stickslip.walker.drives import choose
from stickslip.walker.experiments import tabulate

PRIORS = {
    "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
    "drag.linear": Prior("log-uniform", 3e-6, 3e-5),
}
NOMINAL = Scenario(drive=Drive(base=0.5e-3, pulses=6))
BELIEVED = NOMINAL.with_uncertain(PRIORS)
SETTINGS = ["direction", "edge", "frequency", "hold", "mode", "peak"]
NOISE = 0.02


@pytest.fixture
def few(monkeypatch):
    """Causes that are quick to simulate."""
    few_causes(monkeypatch, ("friction_anisotropy", "surface_tilt"))


@pytest.fixture
def twins(monkeypatch):
    """A wrong zero and a wrong scale of the camera, which one velocity alone cannot tell apart."""
    few_causes(monkeypatch, ())
    every = measured.tables_of

    def two(*given):
        (table,) = every(*given)
        names = "velocity_offset", "length_scale"
        table.instruments = tuple(one for one in table.instruments if one.name in names)
        return [table]

    monkeypatch.setattr(measured, "tables_of", two)


def test_a_zero_and_a_scale_are_separated_by_a_drive_and_its_reverse(twins):
    table = propose_experiments(NOMINAL, 2, noise=NOISE, threads=1)
    v = table["expected_stated"].to_numpy()
    first, second = table[SETTINGS].to_dict("records")
    # In one direction both change the speed alike, in the other one not.
    assert {**first, "direction": second["direction"]} == second
    assert v[1] == pytest.approx(-v[0], rel=1e-6)
    # Of the scale, 0.03 (v, -v), no zero (z, z) takes anything, as they are at right angles. The
    # zero alone adds at most 1 to the chi-square, as it is as uncertain as it is large.
    chi2, least = np.sum(table["separation"] ** 2), 3.0 * (0.03 * math.sqrt(2) / NOISE) ** 2
    assert 0.99 * least < chi2 < least + 1.0
    assert table.attrs["confounded"] == []


def measure(truth, table, seed=3, trials=3):
    """Trials of each row of settings, with the noise of a trial."""
    random = np.random.default_rng(seed)
    rows = table.loc[table.index.repeat(trials), SETTINGS].reset_index(drop=True)
    drives = [{f"drive.{name}": row[name] for name in SETTINGS} for row in rows.to_dict("records")]
    level = np.array([simulate(truth.replace(drive)).mean_velocity for drive in drives])
    return rows.assign(velocity=level * (1.0 + NOISE * random.standard_normal(len(rows))))


def test_a_table_before_data_has_settings_and_what_the_stated_model_expects(few, tmp_path):
    table = propose_experiments(BELIEVED, 6, noise=NOISE, threads=1)
    assert {*table} == {*SETTINGS, "why", "separation", "expected_stated", "sd_stated"}
    assert len(table) == 6 == len(table[["mode", "direction", "frequency"]].drop_duplicates())
    drive = {f"drive.{name}": table.loc[0, name] for name in SETTINGS}
    expected = simulate(NOMINAL.replace(drive)).mean_velocity
    assert table.loc[0, "expected_stated"] == pytest.approx(expected, rel=1e-3)
    # A scale and a clock of a camera both multiply every velocity.
    assert ("length_scale", "clock_scale") in table.attrs["confounded"]
    assert "with 3 trials" in table.loc[0, "why"]
    # Of noise there is less in more trials.
    rough, finer = (
        propose_experiments(BELIEVED, 6, noise=0.5, trials=n, threads=1) for n in (3, 1875)
    )
    assert len(rough.attrs["confounded"]) > len(table.attrs["confounded"])
    assert finer[SETTINGS].equals(table[SETTINGS])
    # It is filled in as it is.
    table.assign(velocity=1e-3).to_csv(tmp_path / "next.csv", index=False)
    data = Measurement.from_dataframe(table[SETTINGS].assign(velocity=2e-3), NOMINAL, PRIORS)
    (_, new) = data.with_velocities(tmp_path / "next.csv").velocity
    assert len(new.conditions) == 6


def test_a_robot_that_stands_still_has_no_drives_to_propose(few):
    still = Scenario(drive=Drive(base=0.5e-3, peak=0.5e-3, pulses=6))
    with pytest.raises(ScenarioError, match="stands still"):
        propose_experiments(still, 3, threads=1)


def test_every_row_has_what_differs_in_some_row(tmp_path):
    """Drives of two modes with other numbers of pulses are measured as they are proposed."""
    stated = NOMINAL.replace({"drive.mode": "OPP", "drive.pulses": 5})
    paces = pd.DataFrame({"mode": ["IPP", "OPP"] * 4, "pulses": [6, 5] * 4, "frequency": [
        20.0, 20.0, 40.0, 40.0, 60.0, 60.0, 80.0, 80.0]})  # fmt: skip
    drives = [{f"drive.{name}": value for name, value in row.items()}
              for row in paces.to_dict("records")]  # fmt: skip
    level = [simulate(stated.replace(drive)).mean_velocity for drive in drives]
    data = Measurement.from_dataframe(paces.assign(velocity=level), stated, PRIORS)
    measured = data.velocity[0].conditions
    chosen, _ = choose(
        [dict(each) for each in measured], ["a", "b"],
        (np.vstack([level[: len(measured)], np.zeros(len(measured))]),
         np.zeros((2, len(measured), len(measured))), np.full(len(measured), 1e-10)),
        [(0, 1)], 6,
    )  # fmt: skip
    table = tabulate(chosen, Words(Vocabulary()), stated)
    assert len(set(table["pulses"])) == 2
    assert not table["pulses"].isna().any()


def test_a_constant_that_cannot_be_off_so_far_is_a_cause_all_the_same(few):
    # Three errors more are above the static friction, which is 0.2.
    wide = NOMINAL.with_uncertain({"contact.kinetic_friction": {"mean": 0.17, "sd": 0.03}})
    table = propose_experiments(wide, 6, noise=NOISE, threads=1)
    assert table["why"].str.contains("kinetic friction").any()


@pytest.mark.nightly
def test_a_hidden_cause_is_found_by_the_drives_that_were_proposed_before_data(few):
    table = propose_experiments(BELIEVED, 8, noise=NOISE)
    truth = NOMINAL.replace({"effects.friction_anisotropy.fraction": 0.2})
    data = Measurement.from_dataframe(measure(truth, table), BELIEVED)
    verdict = diagnose(data, threads=1).verdict
    assert (verdict.kind, verdict.causes) == ("named", ("friction_anisotropy",))


@pytest.mark.nightly
def test_near_twins_are_told_apart_by_the_drives_that_are_proposed_after_a_diagnosis(tmp_path):
    stated = NOMINAL.replace({"drive.mode": "OPP", "drive.pulses": 5})
    truth = stated.replace({"contact.kinetic_friction": 0.151, "effects.surface_tilt.angle": 0.04})
    middle = {name: stated.get(f"drive.{name}") for name in SETTINGS}
    paces = pd.DataFrame([{**middle, "frequency": f} for f in (20.0, 30.0, 40.0, 55.0, 75.0)])
    data = Measurement.from_dataframe(measure(truth, paces, 1), stated, PRIORS)
    result = diagnose(data)
    assert result.verdict.kind == "ambiguous"
    table = propose_experiments(result)
    models = [name for name in table if name.startswith("expected_")]
    assert len(models) >= 2
    assert len(table) == len(result.propose_experiments())
    assert table["separation"].tolist() == [
        each.separation**0.5 for each in result.propose_experiments()
    ]
    data = data.with_velocities(measure(truth, table, 2))
    verdict = diagnose(data).verdict
    assert verdict.kind in ("named", "dominant", "pair")
    assert "surface_tilt" in verdict.causes
