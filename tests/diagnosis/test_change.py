"""Changes between two logs, or two measurements of a walker."""

import json

import numpy as np
import pandas as pd
import pytest

from command_line import stickslip
from made_measurement import few_causes, write
from stickslip import (
    Cause,
    Parameter,
    Prior,
    ScenarioError,
    Series,
    Table,
    diagnose,
    diagnose_change,
    events,
    instruments,
    load,
    models,
    read_measurement,
)

T = 0.01 * np.arange(120)
TORQUE, OTHER = (np.repeat(np.random.default_rng(k).uniform(-0.5, 0.5, 12), 10) for k in (1, 2))
FEW = ["stribeck", "load", "quadratic", "backlash", "compliance", "gravity", "viscous_asymmetry",
       "asymmetry", "late torque"]  # fmt: skip
JOINT = models.joint(
    inertia=(0.012, 6e-4),
    viscous=(0.05, 5e-3),
    without=[*FEW, "scale", "slow torque", "slow sensor"],
)
TRUE = models.joint(inertia=0.0123, viscous=(0.05, 0.01), coulomb=(0.0, 0.1), load=(0.0, 0.1))
ROOM = models.thermal(
    capacity=(400.0, 20.0),
    loss=(1.5, 0.08),
    ambient=0.0,
    without=["heater_capacity", "slow thermometer", "late power"],
)


def log(seed, torque=TORQUE, more=0.0, **values):
    """Speeds with an error of 2 %, and what no model has."""
    seen = TRUE.simulate(T, {"torque": torque}, **values) + more
    noise = 0.05 * np.random.default_rng(seed).normal(size=len(T))
    return Series(T, seen + noise, {"torque": torque}, sd=0.05, unit="rad/s")


def room(seed, more=0.0, **values):
    t = 5.0 * np.arange(120)
    power = np.repeat(np.random.default_rng(3).uniform(0.0, 60.0, 8), 15)
    model = models.thermal(capacity=400.0, loss=(1.5, 0.1), ambient=0.0, loss_growth=(0.0, 0.1))
    seen = model.simulate(t, {"power": power}, **values) + more
    noise = 0.05 * np.random.default_rng(seed).normal(size=len(t))
    return Series(t, seen + noise, {"power": power}, sd=0.05, unit="K")


WAVE = 0.3 * np.sin(9.0 * T) * T  # of both sides, or of one
# What is before and after, the verdict, its causes, and the sign of the first size.
CASES = {
    "a constant": (log(1), log(2, viscous=0.06), "named", ("viscous[after]",), 1),
    "the other way, beside an error of the model": (
        log(1, more=WAVE, viscous=0.06), log(2, more=WAVE), "named", ("viscous[after]",), -1),
    "an effect that has come": (log(1), log(2, coulomb=0.02), "named", ("coulomb[after]",), 1),
    "an effect that has gone": (log(1, coulomb=0.02), log(2), "named", ("coulomb[before]",), 1),
    "other inputs": (
        log(1), log(2, OTHER, viscous=0.06), "named", ("viscous[after]",), 1),
    "an effect of both": (
        log(1, coulomb=0.02), log(2, OTHER, coulomb=0.02), "named", ("coulomb",), 1),
    "nothing": (log(1), log(2), "none", (), 0),
    "nothing, beside an error of the model": (log(1, more=WAVE), log(2, more=WAVE), "none", (), 0),
    "nothing, beside an error of the model at other inputs": (
        log(1, more=WAVE), log(2, OTHER, more=WAVE), "unexplained", (), 0),
    "what nobody lists, at other inputs": (
        log(1), log(2, OTHER, more=WAVE), "unexplained", (), 0),
    "one log twice": (log(1), log(1), "none", (), 0),
    "what nobody lists": (log(1), log(2, more=WAVE), "unexplained", (), 0),
}  # fmt: skip


NIGHTLY = ("a constant", "what nobody lists", "an effect that has gone", "an effect of both",
           "other inputs", "the other way, beside an error of the model",
           "nothing, beside an error of the model", "what nobody lists, at other inputs",
           "nothing, beside an error of the model at other inputs")  # fmt: skip


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=[pytest.mark.nightly] * (one in NIGHTLY)) for one in CASES]
)
def test_a_difference_is_told_by_name_and_sign(name):
    before, after, kind, causes, sign = CASES[name]
    result = diagnose_change(JOINT, before, after)
    assert (result.verdict.kind, result.verdict.causes) == (kind, causes)
    twice = name == "one log twice"
    assert ("same-readings" in {note["code"] for note in result.as_dict()["notes"]}) == twice
    if twice:  # the bound is no part of a usual change
        assert result.cannot_tell.limits["inertia[after]"].value < 0.002 * 0.012
    if sign:
        first = result.verdict.fit.causes[0].parameters[0].name
        assert np.sign(result.params["value"][first]) == sign
        told = result.as_dict()["sides"]
        base, _, side = first.partition("[")
        true = {"coulomb": 0.02, "viscous": 0.01}[base]
        apart = told["after"][base] - told["before"][base]
        wanted = {"after]": sign, "before]": -1, "": 0}[side] * true
        assert apart == pytest.approx(wanted, abs=4.0 * result.params["sd"][first])


def test_what_is_late_on_the_earlier_side_is_no_early_one_of_the_later():
    without = [*FEW[:-1], "coulomb", "slow torque", "slow sensor"]
    model = models.joint(inertia=(0.012, 6e-4), viscous=(0.05, 5e-3), without=without)
    seen = log(1, np.concatenate([np.zeros(3), TORQUE[:-3]]))
    result = diagnose_change(model, Series(T, seen.y, {"torque": TORQUE}, sd=0.05, unit="rad/s"),
                             log(2))  # fmt: skip
    assert (result.verdict.kind, result.verdict.causes) == ("named", ("late torque[before]",))
    assert result.params["value"]["late torque.time[before]"] == pytest.approx(0.03, abs=3e-3)
    # What adds has one sign on either side.
    offered = {cause.name for cause in result.problem.causes}
    assert "scale[after]" in offered
    assert "scale[before]" not in offered


@pytest.mark.nightly
def test_twins_are_a_set():
    twins = diagnose_change(ROOM, room(1), room(2, loss=1.52))
    assert twins.verdict.kind == "ambiguous"
    assert "loss[after]" in twins.verdict.causes


@pytest.mark.nightly
def test_an_instrument_is_named():
    moved = diagnose_change(ROOM, room(1), room(2, more=0.3))
    assert (moved.verdict.kind, moved.verdict.causes) == ("named", ("zero[after]",))


def test_several_tables_of_a_side_are_paired_by_their_settings():
    x = np.linspace(1.0, 3.0, 8)

    def line(table, p):
        return p["slope"] * table["x"] + p["bend"] * table["x"] ** 2

    def tables(slope, noise):
        random = np.random.default_rng(noise)
        made = []
        for name, shift in (("a", 0.0), ("b", 9.0)):
            at = random.permutation(x) + shift
            y = slope * at + np.sin(7.0 * at) + 0.02 * random.normal(size=8)
            made.append(Table({"x": at}, y, sd=0.02, name=name))
        return made

    bend = Cause("bend", Parameter("bend", size=0.1, low=-3.0, high=3.0))
    slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    of_one = instruments.offset("-", 0.1, table="a")
    causes = [bend, of_one]
    result = diagnose_change(line, tables(1.0, 1), tables(1.2, 2)[::-1], [slope], causes)
    assert result.verdict.causes == ("slope[after]",)
    assert [len(table.mean) for table in result.problem.tables] == [8, 8]
    assert "offset[after]" in result.verdict.probabilities
    assert result.params["value"]["slope[after]"] == pytest.approx(0.2, abs=0.03)


@pytest.mark.nightly
def test_an_event_of_one_side_is_named():
    push = np.where(T > 0.8, 0.5, 0.0)
    step = events.step(0.2, 0.1, 1.5, unit="rad/s")
    result = diagnose_change(JOINT, log(1), log(2, more=push), causes=[step])
    assert result.verdict.causes == ("step[after]",)


@pytest.mark.nightly
def test_a_walker_on_another_surface(tmp_path, monkeypatch):
    few_causes(monkeypatch, ["surface_tilt", "angle_drag"])
    monkeypatch.setattr("stickslip.walker.velocity.of_velocities", lambda mean: ())
    folders = [tmp_path / side for side in ("before", "after")]
    for folder in folders:
        folder.mkdir()
    before, after = (
        read_measurement(write(folder, {"contact.kinetic_friction": friction}, seed))
        for folder, friction, seed in zip(folders, (0.145, 0.185), (1, 2), strict=True)
    )
    result = diagnose(after, against=before)
    assert result.verdict.causes == ("contact.kinetic_friction[after]",)
    result.save_report(tmp_path / "found")
    stated = [load(tmp_path / "found" / f"{side}.toml") for side in ("before", "after")]
    change = result.params.loc["contact.kinetic_friction[after]"]
    apart = np.diff([scenario.contact.kinetic_friction for scenario in stated])[0]
    assert apart == pytest.approx(change["value"], rel=1e-6)
    assert change["value"] == pytest.approx(0.04, abs=4.0 * change["sd"])
    page = (tmp_path / "found" / "report.html").read_text()
    assert "kinetic friction coefficient rose from" in page
    numbers = json.loads((tmp_path / "found" / "report.json").read_text())
    assert numbers["paired"]


def test_logs_of_both_sides_make_a_report(tmp_path):
    for name, record in {"before": log(1), "after": log(2, viscous=0.06)}.items():
        columns = {"t (s)": record.t, "torque (N m)": record["torque"], "speed (rad/s)": record.y}
        pd.DataFrame(columns).to_csv(tmp_path / f"{name}.csv", index=False)
    known = ["--set", "inertia=0.012,0.0006", "--set", "viscous=0.05,0.005"]
    known += ["--set", "without=" + ",".join([*FEW, "coulomb", "slow torque", "slow sensor"])]
    against = ["--against", "before.csv", "--model", "joint", *known, "--json", "--out", "found"]
    done = stickslip("diagnose", "after.csv", *against, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    numbers = json.loads(done.stdout)
    assert numbers["cause"] == "viscous[after]"
    assert "nothing else has to differ" in numbers["headline"]
    assert [row.get("changes") for row in numbers["bounds"].values()].count("inertia") == 1
    assert sorted(path.name for path in (tmp_path / "found").iterdir()) == [
        "report.html", "report.json"]  # fmt: skip


def test_what_is_no_side_is_refused(tmp_path):
    walker = read_measurement(write(tmp_path, {}))
    other = type(walker)(**{**vars(walker), "uncertain": {}})
    with pytest.raises(ScenarioError, match=r"\[uncertain\]: allowed"):
        diagnose(walker, against=other)
    with pytest.raises(ScenarioError, match="before = 3: allowed"):
        diagnose_change(JOINT, 3, log(1))
    with pytest.raises(ScenarioError, match=r"after = \[\]: allowed"):
        diagnose_change(JOINT, log(1), [])
