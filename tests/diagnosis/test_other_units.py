"""A unit that nobody stated is found, and no constant or cause is named for it."""

import numpy as np
import pytest
from causes.make import simulated

from stickslip import Series, Table, diagnose_model, models
from stickslip._util.units import mistaken
from stickslip.diagnosis.data.table import READINGS
from stickslip.diagnosis.model import posed

J, B, STEP = 0.012, 0.02, 0.01
T = STEP * np.arange(150)
TORQUE = 0.3 * np.sign(np.sin(4.4 * T)) * (0.6 + 0.4 * np.sin(0.8 * T))
RPM = 30.0 / np.pi
COLUMNS = {"time": T, "torque": TORQUE}
# Causes that take long.
LESS = ["backlash", "compliance", "stribeck", "slow torque", "late torque", "slow sensor",
        "viscous_asymmetry", "asymmetry", "quadratic", "gravity", "load"]  # fmt: skip
# What a heading says, and how many of its unit are one SI unit; "" states none.
BARE = {"time": "", "torque": "", "speed": ""}


def speeds(inertia=J, viscous=B, seed=1):
    """Held torques move a joint exactly; readings have errors of 0.02 rad/s."""
    speed = [0.0]
    for each in TORQUE[:-1]:
        end = each / viscous
        speed.append(end + (speed[-1] - end) * np.exp(-viscous / inertia * STEP))
    return np.array(speed) + 0.02 * np.random.default_rng(seed).standard_normal(len(T))


def log_of(tmp_path, joint, times, headings, **truth):
    """A file whose columns are so many times what they are in SI, under headings."""
    columns = {**COLUMNS, "speed": speeds(**truth), "sd": np.full(len(T), 0.02)}
    times = {"sd": times.get("speed", 1.0), **times}
    names = [f"{name} ({unit})" if unit else name for name, unit in {**BARE, **headings}.items()]
    rows = np.stack([columns[name] * times.get(name, 1.0) for name in (*BARE, "sd")], axis=1)
    np.savetxt(tmp_path / "log.csv", rows, "%.9g", ",", header=",".join([*names, "sd"]),
               comments="")  # fmt: skip
    return models.read_log(tmp_path / "log.csv", joint)


def found(log, inertia=J, viscous=B):
    joint = models.joint(inertia=(inertia, 0.04 * inertia), viscous=(viscous, 0.1 * viscous),
                         without=LESS)  # fmt: skip
    return diagnose_model(joint, log)


JOINT = models.joint(inertia=J, viscous=B)


@pytest.mark.parametrize(
    ("times", "words"),
    [
        ({"time": 1e3}, 'time were in ms: write "time (ms)"'),
        ({"time": 1.0 / 60.0}, 'time were in min: write "time (min)"'),
        ({"speed": RPM}, 'speed were in rpm: write "speed (rpm)"'),
        ({"torque": 1e3}, 'torque were in mN m: write "torque (mN m)"'),
    ],
)
@pytest.mark.daily("times2")
def test_a_column_without_a_unit_is_told_in_which_it_may_be(times, words, tmp_path):
    verdict = found(log_of(tmp_path, JOINT, times, {})).verdict
    assert (verdict.kind, verdict.reasons[0].code) == ("data-problem", "other-unit")
    assert words in verdict.reasons[0].text


def test_a_unit_is_told_beside_a_constant_that_is_off(tmp_path):
    verdict = found(log_of(tmp_path, JOINT, {"speed": RPM}, {}, viscous=2.0 * B)).verdict
    assert (verdict.kind, verdict.reasons[0].code) == ("data-problem", "other-unit")
    assert 'write "speed (rpm)"' in verdict.reasons[0].text


@pytest.mark.nightly
def test_a_constant_in_another_unit_is_told(tmp_path):
    verdict = found(log_of(tmp_path, JOINT, {}, {}), inertia=1e7 * J).verdict
    assert verdict.kind == "data-problem"
    assert "inertia were 1/1e+07 times what is stated" in verdict.reasons[0].text


def test_a_constant_is_told_where_an_oscillation_is_out_of_phase():
    # With the other constants at their middles no stiffness is like the readings.
    t = 0.03 * np.arange(150)
    force = 3.0 * np.sign(np.sin(2.9 * t + 5.5)) * (0.6 + 0.4 * np.sin(0.67 * t))
    true = {"mass": 0.68, "stiffness": 70.0, "viscous": 0.58, "start": 0.02}
    y = simulated("oscillator", true, t, force)
    y = y + 0.002 * np.random.default_rng(0).standard_normal(len(t))
    known = {"mass": (0.69, 0.014), "stiffness": (0.0594, 0.0059), "viscous": (0.57, 0.03)}
    log = Series(t, y, {"force": force}, unit="m")
    verdict = diagnose_model(models.oscillator(**known), log).verdict
    assert verdict.kind == "data-problem"
    assert "stiffness were 1000 times what is stated" in verdict.reasons[0].text


@pytest.mark.parametrize(("gear", "said"), [(10.0, True), (0.1, True), (6.0, False)])
@pytest.mark.daily("0.1")
def test_a_constant_that_is_tenfold_off_is_named(gear, said, tmp_path):
    result = found(log_of(tmp_path, JOINT, {}, {}, inertia=gear * J))
    assert (result.verdict.kind, result.verdict.causes) == ("named", ("inertia",))
    assert ("look at its unit" in result.summary()) == said


def test_units_that_are_stated_are_not_doubted(tmp_path):
    headings = {"time": "s", "torque": "N m", "speed": "rad/s"}
    log = log_of(tmp_path, JOINT, {"speed": RPM}, headings)
    assert not log.unstated
    assert found(log).verdict.kind != "data-problem"
    stated = Series((1e3 * T).astype("m8[ms]"), T, {"torque": T}, unit="rad/s")
    assert stated.unstated == ["torque"]
    assert Table({"t": (1e3 * T).astype("m8[ms]"), "x": T}, T, unit="m").unstated == ["x"]


@pytest.mark.nightly
def test_a_model_of_ones_own_and_arrays_are_asked_the_same(tmp_path):
    joint = models.joint(inertia=(J, 0.04 * J), viscous=(B, 0.1 * B), without=LESS)
    log = Series(T, RPM * speeds(), {"torque": TORQUE}, RPM * 0.02)
    uncertain, causes = joint.terms(log)
    verdict = diagnose_model(lambda table, p: joint(table, p), log, uncertain, causes).verdict
    assert verdict.kind == "data-problem"
    assert "the readings were 1/9.549297 times as large" in verdict.reasons[0].text


@pytest.mark.parametrize(
    ("ratio", "words"),
    [(9.5, "9.549297, as of rpm for rad/s"), (1.0 / 60.5, "1/60, as of min for s"), (10.02, "10:"),
     (7.0, ""), (1.8, "")],
)  # fmt: skip
def test_a_factor_of_two_units_has_its_words(ratio, words):
    said = mistaken(ratio, 0.02)
    assert words in said if words else not said


@pytest.mark.parametrize("sd", [None, 0.1], ids=["told by a curve", "stated"])
def test_errors_follow_readings_that_were_in_another_unit(sd):
    t = 0.02 * np.arange(200)
    noise = 0.1 * np.random.default_rng(0).standard_normal(200)
    record = Series(t, np.sin(3.0 * t) + noise, {"torque": np.cos(t)}, sd=sd)
    model = models.joint(inertia=0.1)
    in_degrees, plain = (
        posed(each, model, *model.terms(each)).sd
        for each in (record.converted(READINGS, 57.3), record)
    )
    np.testing.assert_allclose(in_degrees, plain / 57.3, rtol=1e-9)
