"""Tables of the coils' field in the diagnosis: what is found, what is left out, what is refused."""

import json

import numpy as np
import pytest

from command_line import stickslip
from stickslip import COIL_NAMES, Coils, Scenario, Waveform, simulate, volts_per_tesla
from stickslip.diagnosis.api import diagnose
from stickslip.diagnosis.observables import find_observables
from stickslip.diagnosis.report.html import report_sections
from stickslip.diagnosis.report.parameters import extended_parameters
from stickslip.errors import ScenarioError
from stickslip.facts import Code
from stickslip.measurement import read_measurement

MEASUREMENT = """stickslip_measurement = 1
name = "probe"
scenario = "nominal.toml"

[uncertain]
"coil.side" = { mean = 0.1385, sd = 5e-4 }

[[field]]
file = "field.csv"
"""

COLUMNS = ("xp", "xm", "yp", "ym", "clamp", "x", "y", "z", "Bx", "By", "Bz")
NOISE = 5e-6  # T

# Each coil by itself at four currents, and no current, at the centre and beside it.
CURRENTS = np.vstack([*(i * np.eye(5) for i in (-2.0, -1.0, 1.0, 2.0)), np.zeros((1, 5))])
PLACES = np.array([[0.0, 0.0, 0.0], [2e-3, 1e-3, -1e-3]])
ROWS = np.array([[*amperes, *place] for amperes in CURRENTS for place in PLACES])


def probed(in_plane=0.0, clamp=0.0, ambient=(0.0, 0.0), seed=0, repeats=1, noise=NOISE, **coils):
    """Rows of a table: each coil's gain and a uniform field, by superposition."""
    random = np.random.default_rng(seed)
    gain = 1.0 + np.array([in_plane] * 4 + [clamp])
    rows = np.repeat(ROWS, repeats, axis=0)
    field = Coils(**coils).field(rows[:, 5:], rows[:, :5] * gain)
    field += [ambient[0], 0.0, ambient[1]] + noise * random.standard_normal(field.shape)
    return np.hstack([rows, field])


def write(folder, rows, columns=COLUMNS, text=MEASUREMENT):
    (folder / "nominal.toml").write_text("stickslip = 1\n\n[drive]\n")
    (folder / "m.toml").write_text(text)
    lines = [",".join(str(cell) for cell in row) for row in np.asarray(rows).tolist()]
    (folder / "field.csv").write_text("\n".join([",".join(columns), *lines]) + "\n")
    return folder / "m.toml"


def observable(path):
    (found,) = find_observables(read_measurement(path), 1)
    return found


@pytest.mark.parametrize("seed", range(3))
def test_a_clamp_that_is_stronger_than_thought_is_named(tmp_path, seed):
    path = write(tmp_path, probed(clamp=0.08, seed=seed))
    result = diagnose(read_measurement(path), seed=seed)
    found = result.findings
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("field_gain",))
    gain = extended_parameters(found)
    assert (
        abs(gain["effects.field_gain.clamp"]["value"] - 0.08)
        < 3 * (gain["effects.field_gain.clamp"]["sd"])
    )
    assert (
        abs(gain["effects.field_gain.in_plane"]["value"])
        < 3 * (gain["effects.field_gain.in_plane"]["sd"])
    )
    (report_section,) = report_sections(result.posed.comparisons(result.findings))
    assert (
        report_section.numbers["rms_extended"]
        < 1.2 * NOISE
        < report_section.numbers["rms_recalibrated"]
    )
    assert found.gain.mae_after < found.gain.mae_before
    # Of each reading that is held out all three components are.
    held_out = np.repeat(report_section.numbers["held_out"], 3)
    assert np.flatnonzero(held_out).tolist() == found.gain.held_out.tolist()


def test_a_field_that_no_coil_makes_is_named(tmp_path):
    path = write(tmp_path, probed(ambient=(2e-5, -4e-5), repeats=2))
    found = diagnose(read_measurement(path)).findings
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("ambient_field",))
    value = extended_parameters(found)
    for name, truth in (("Bx", 2e-5), ("Bz", -4e-5)):
        each = value[f"effects.ambient_field.{name}"]
        assert abs(each["value"] - truth) < 3 * each["sd"]


def test_nothing_is_found_where_nothing_is(tmp_path):
    words = []
    for seed in range(12):
        path = write(tmp_path, probed(seed=seed, repeats=1 + seed % 2, side=0.1387))
        words.append(diagnose(read_measurement(path), seed=seed).findings.verdict.kind)
    # At a rate of 5 % two or more of twelve have a chance of 12 %, three or more of 2 %.
    assert words.count("none") >= 10


def test_a_table_may_have_no_uncertain_parameter(tmp_path):
    text = MEASUREMENT.replace('"coil.side" = { mean = 0.1385, sd = 5e-4 }', "")
    found = diagnose(read_measurement(write(tmp_path, probed(clamp=0.08), text=text))).findings
    assert "field_gain" in found.verdict.causes


def test_predictions_are_the_field_that_a_simulated_robot_sees(tmp_path):
    # The field beside the robot's place as it was recorded, with every effect that changes it.
    V = volts_per_tesla()
    held = Waveform.hold(0.03, {"xp": 1e-3 * V, "xm": 2e-3 * V, "clamp": -1e-3 * V})
    keys = {
        "effects.field_gain.in_plane": 0.05,
        "effects.field_gain.clamp": -0.1,
        "effects.ambient_field.Bx": 3e-5,
        "effects.ambient_field.Bz": -4e-5,
        "coil.side": 0.13,
        "coil.distance": 0.1,
        "coil.turns": 480.0,
    }
    no_effect = {
        "effects.gradient_scale.fraction": 0.4,
        "effects.eddy_lag.time": 0.0,
        "coil.resistance": 12.0,
    }
    drive = {"drive.mode": "program", "drive.program": held, "record.rate": 1e3}
    run = simulate(Scenario().replace({**drive, **keys, **no_effect}))
    assert run.ok
    shown = run.t > 5e-3
    place = np.stack([run.x, np.zeros_like(run.x), run.z], axis=1)[shown]
    field = np.stack([run.bx, np.zeros_like(run.bx), run.bz], axis=1)[shown]
    found = observable(write(tmp_path, np.hstack([run.current[shown], place, field])))
    order = np.lexsort(np.hstack([run.current[shown], place])[:, ::-1].T)
    changed = {**keys, **no_effect}
    predicted = found.predict(list(changed), np.array([list(changed.values())]))
    expected = field[order]
    got = predicted.reshape(-1, 3)
    # The core expands the field about the robot to within 1e-9 of it (test_local_field.cpp).
    assert np.abs(got[:, [0, 2]] - expected[:, [0, 2]]).max() < 1e-8 * np.abs(field).max()
    assert np.abs(got[:, 1]).max() < 1e-15


def test_gains_and_geometry_have_their_analytic_consequences(tmp_path):
    found = observable(write(tmp_path, probed()))
    names = ["effects.field_gain.clamp", "effects.ambient_field.Bz", "coil.turns", "drag.linear"]
    values = np.array([[0, 0, 510, 1e-5], [0.5, 0, 510, 1e-3], [0, 1e-5, 1020, 1e-5]])
    plain, clamp, doubled = found.predict(names, values).reshape(3, -1, 3)
    assert plain == pytest.approx(Coils().field(found.points, found.currents), rel=1e-12, abs=1e-18)
    driven = found.currents[:, 4] != 0.0
    assert clamp[driven] == pytest.approx(1.5 * plain[driven], rel=1e-12)
    assert np.array_equal(clamp[~driven], plain[~driven])
    assert doubled == pytest.approx(2.0 * plain + [0, 0, 1e-5], rel=1e-12, abs=1e-18)


def test_a_geometry_that_puts_a_wire_on_a_probe_has_no_prediction(tmp_path):
    found = observable(write(tmp_path, [[1, 0, 0, 0, 0, 0.05, 0.05, 0.05, 1e-3, 0, 0]] * 2))
    values = np.array([[0.099, 0.1385], [0.05, 0.1]])
    predicted = found.predict(["coil.distance", "coil.side"], values)
    assert np.all(np.isfinite(predicted[0]))
    assert np.all(np.isnan(predicted[1]))


def test_the_noise_is_found_from_repeats_or_from_a_free_fit(tmp_path):
    repeated = observable(write(tmp_path, probed(repeats=3)))
    assert repeated.notes[0].fields["origin"] == "repeats"
    single = observable(write(tmp_path, probed(repeats=1, clamp=0.3, ambient=(1e-4, 0.0))))
    assert single.notes[0].fields["origin"] == "free-fit"
    # Each is known to some 7 % from 120 and more degrees of freedom, and widened for that.
    assert 0.8 * NOISE < repeated.sd.max() * np.sqrt(3) < 1.5 * NOISE
    assert 0.8 * NOISE < single.sd.max() < 1.5 * NOISE


def test_a_table_without_scatter_has_the_least_error(tmp_path):
    found = observable(write(tmp_path, probed(noise=0.0)))
    size = np.sqrt(np.mean(found.observed**2))
    assert found.notes[0].code is Code.READING_NOISE_SMALL
    assert found.sd.max() == pytest.approx(1e-3 * size)


def test_components_of_a_row_are_held_out_together(tmp_path):
    found = observable(write(tmp_path, probed()))
    assert np.array_equal(found.group, np.repeat(np.arange(len(found.fields)), 3))


def test_a_table_with_invalid_rows_gives_the_same_verdict(tmp_path):
    rows = probed(seed=4, repeats=2).astype(object)
    rows[3, 8] = "nan"
    rows[10, 2] = ""
    rows[20, 10] = 0.5  # a slip of the point
    rows[30, 5:8] = 0.099, 0.06925, 0.0  # on the wire of the coil that has current
    rows[30, :5] = 1.0, 0.0, 0.0, 0.0, 0.0
    turned = list(range(len(COLUMNS)))[::-1]
    path = write(tmp_path, rows[:, turned], [COLUMNS[k] for k in turned])
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["verdict"] == "none"
    facts = json.loads((tmp_path / "found" / "report.json").read_text())["facts"]["left_out"]
    codes = [each["code"] for each in facts]
    assert codes == [Code.BAD_CELLS, Code.PROBES_ON_WIRE, Code.FAR_FIELD]
    assert [each["fields"].get("count") for each in facts] == [2, 1, None]
    assert facts[0]["fields"]["rows"] == 84


@pytest.mark.parametrize(
    ("column", "factor", "said"),
    [
        ("Bx", 1e4, "mT"),
        ("x", 1e3, "mm"),
        ("z", 1e6, "mm"),
        ("clamp", 1e3, "2000 A in column clamp"),
    ],
)
def test_a_table_in_other_units_is_refused_with_the_reason(tmp_path, column, factor, said):
    rows = probed()
    rows[:, COLUMNS.index(column)] *= factor
    refused(stickslip("diagnose", write(tmp_path, rows)), said)


@pytest.mark.parametrize(
    ("columns", "factor", "said"),
    [
        (("xp",), 1e3, "2000 A in column xp"),
        (("clamp",), 1e3, "2000 A in column clamp"),
        (("ym", "clamp"), 1e3, "2000 A in column"),
        (COIL_NAMES, 1e3, "2000 A in column"),
        (COIL_NAMES, 1e-3, "0.002 A in column"),
    ],
)
def test_currents_in_a_unit_that_is_wrong_by_1000_are_refused(tmp_path, columns, factor, said):
    rows = probed(in_plane=-0.2, clamp=0.3, ambient=(5e-5, 0.0))
    rows[:, [COLUMNS.index(name) for name in columns]] *= factor
    with pytest.raises(ScenarioError, match=f"{said}.*; allowed is .*wrong by 1000$"):
        observable(write(tmp_path, rows))


@pytest.mark.parametrize(
    "coils",
    [
        {"in_plane": -2.0, "clamp": -0.5},  # reversed, and half as strong
        {"clamp": -1.0},  # a coil that is not connected
        {"ambient": (2e-3, 1e-3)},  # as strong as the coils
    ],
)
def test_odd_coils_are_not_taken_for_a_wrong_unit(tmp_path, coils):
    assert len(observable(write(tmp_path, probed(**coils))).fields) == len(ROWS)


@pytest.mark.parametrize("mismatch", [0.0, 0.1])
def test_coils_that_work_against_each_other_are_not_taken_for_a_wrong_unit(tmp_path, mismatch):
    # 0.1 mm from the centre opposed coils leave 0.4 % of each field.
    currents = np.outer(np.linspace(-2.0, 2.0, 9), [1.0, -1.0, 0.0, 0.0, 0.0])
    place = np.tile([1e-4, 0.0, 0.0], (len(currents), 1))
    field = Coils().field(place, currents * [1.0 + mismatch, 1.0, 1.0, 1.0, 1.0])
    assert len(observable(write(tmp_path, np.hstack([currents, place, field]))).fields) == 9


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        (COLUMNS[:-1], '"Bz" is missing'),
        ((*COLUMNS[:-1], "B_z"), '"Bz" is missing'),
    ],
)
def test_a_table_without_what_it_needs_is_refused(tmp_path, columns, said):
    rows = np.ones((3, len(columns)))
    refused(stickslip("diagnose", write(tmp_path, rows, columns)), said)


def test_probes_on_wires_only_are_refused(tmp_path):
    row = [1, 0, 0, 0, 0, 0.099, 0.06925, 0.0, 1e-3, 0, 0]
    refused(stickslip("diagnose", write(tmp_path, [row] * 3)), "wire")


def refused(done, *words):
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    for word in words:
        assert word in done.stderr


def test_a_single_row_is_too_little(tmp_path):
    path = write(tmp_path, probed()[:1])
    done = stickslip("diagnose", path, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["verdict"] == "data-problem"
