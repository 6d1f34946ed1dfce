"""Tables of static tilt in the diagnosis: what is found, what is left out, what is refused."""

import json
import math

import numpy as np
import pytest

from command_line import stickslip
from stickslip import Scenario, _core, simulate_batch
from stickslip.diagnosis.api import diagnose
from stickslip.diagnosis.observables import find_observables
from stickslip.diagnosis.observables.angle import READING
from stickslip.diagnosis.observables.reading_noise import (
    merge,
    noise_of_curve,
    order_along,
    widening,
)
from stickslip.diagnosis.report.html import report_sections
from stickslip.diagnosis.report.parameters import extended_parameters
from stickslip.facts import Code
from stickslip.measurement import read_measurement

MEASUREMENT = """stickslip_measurement = 1
name = "tilts"
scenario = "nominal.toml"

[uncertain]
"robot.magnetization" = { mean = 5e5, sd = 2e4 }

[[angle]]
file = "angle.csv"
"""

DEGREE = math.radians(1.0)

# Without field the robot lies flat: only there an offset of the camera is not a tilt.
FIELDS = 1e-3 * np.array(
    [[0, 0], [0.02, 0], [0, 0.02], [0, -0.02]]
    + [[2, z] for z in (-3, -2.5, -2, -1.6, -1.3, -1, -0.7, 0.7, 1, 1.3, 1.6, 2, 2.5, 3)]
)


def angles(changes, fields):
    core = Scenario().replace(changes).to_core()
    return _core.static_tilts(core, [], np.zeros((1, 0)), np.atleast_2d(fields))[0]


def write(folder, rows, text=MEASUREMENT, header="Bx,Bz,theta"):
    (folder / "nominal.toml").write_text("stickslip = 1\n\n[drive]\nbase = 0.5e-3\npulses = 6\n")
    (folder / "m.toml").write_text(text)
    lines = [",".join(str(cell) for cell in row) for row in rows]
    (folder / "angle.csv").write_text("\n".join([header, *lines]) + "\n")
    return folder / "m.toml"


def laboratory(folder, changes, seed, repeats=2, noise=DEGREE):
    """A table that a robot with `changes` gives, read with one degree of error."""
    random = np.random.default_rng(seed)
    truth = {"robot.magnetization": 5e5 + 2e4 * random.standard_normal(), **changes}
    fields = np.repeat(FIELDS, repeats, axis=0)
    theta = angles(truth, fields) + noise * random.standard_normal(len(fields))
    rows = zip(*fields.T.tolist(), theta.tolist(), strict=True)
    return write(folder, rows)


def observable(path):
    (found,) = find_observables(read_measurement(path), 1)
    return found


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("repeats", [1, 3])
def test_a_misaligned_magnet_is_named(tmp_path, seed, repeats):
    path = laboratory(tmp_path, {"effects.misalignment.angle": 0.1}, seed, repeats)
    result = diagnose(read_measurement(path), seed=seed)
    found = result.findings
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("misalignment",))
    angle = extended_parameters(found)["effects.misalignment.angle"]
    assert abs(angle["value"] - 0.1) < 3 * angle["sd"]
    # Fourteen fields tilt it. Curvature makes the noise look larger where nothing was repeated.
    assert angle["sd"] < DEGREE * (2.5 / math.sqrt(14) if repeats == 3 else 1.0)
    assert found.gain.mae_after < found.gain.mae_before
    (report_section,) = report_sections(result.posed.comparisons(result.findings))
    assert (
        np.flatnonzero(report_section.numbers["held_out"]).tolist() == found.gain.held_out.tolist()
    )


def test_nothing_is_found_where_nothing_is(tmp_path):
    words = []
    for seed in range(12):
        path = laboratory(tmp_path, {}, seed, repeats=1 + seed % 2)
        words.append(diagnose(read_measurement(path), seed=seed).findings.verdict.kind)
    # At a rate of 5 % two or more of twelve have a chance of 12 %, three or more of 2 %.
    assert words.count("none") >= 10


def test_an_ambiguous_set_has_the_indistinguishable_causes(tmp_path):
    # Without a reading in no field, a turned camera is much like a misaligned magnet.
    random = np.random.default_rng(1)
    fields = FIELDS[4:]
    theta = angles({"effects.misalignment.angle": 0.1}, fields)
    theta += DEGREE * random.standard_normal(len(fields))
    path = write(tmp_path, zip(*fields.T.tolist(), theta.tolist(), strict=True))
    result = diagnose(read_measurement(path))
    assert result.findings.verdict.kind == "ambiguous"
    assert {"misalignment", "angle_offset"} <= set(result.findings.verdict.causes)
    (report_section,) = report_sections(result.posed.comparisons(result.findings))
    assert report_section.lines[-1].code is Code.NO_ANGLE_WITHOUT_FIELD


@pytest.mark.nightly
def test_velocities_and_angles_together(tmp_path):
    # Velocities see the misalignment too, but here the angles say how large it is.
    hidden = {"effects.misalignment.angle": 0.1}
    random = np.random.default_rng(2)
    theta = angles(hidden, FIELDS) + DEGREE * random.standard_normal(len(FIELDS))
    text = MEASUREMENT + '\n[[velocity]]\nfile = "velocity.csv"\n'
    path = write(tmp_path, zip(*FIELDS.T.tolist(), theta.tolist(), strict=True), text)
    base = Scenario.from_toml(tmp_path / "nominal.toml").replace(hidden)
    drives = [(mode, f) for mode in ("IPP", "OPP") for f in (30.0, 60.0, 90.0)]
    runs = simulate_batch(
        [base.replace({"drive.mode": mode, "drive.frequency": f}) for mode, f in drives]
    )
    lines = ["mode,frequency,trial,velocity"]
    for (mode, f), run in zip(drives, runs, strict=True):
        for trial in range(2):
            velocity = run.mean_velocity * (1 + 0.02 * random.standard_normal())
            lines.append(f"{mode},{f},{trial},{velocity!r}")
    (tmp_path / "velocity.csv").write_text("\n".join(lines) + "\n")
    result = diagnose(read_measurement(path))
    found = result.findings
    assert len(result.posed.conditions) == 6
    assert len(found.problem.observed) == 6 + len(FIELDS)
    assert "misalignment" in found.verdict.causes
    angle = extended_parameters(found)["effects.misalignment.angle"]
    assert abs(angle["value"] - 0.1) < 3 * angle["sd"]
    (report_section,) = report_sections(result.posed.comparisons(result.findings))
    assert (
        report_section.numbers["rms_extended"]
        < 2 * DEGREE
        < report_section.numbers["rms_recalibrated"]
    )
    assert not any(
        report_section.numbers["held_out"]
    )  # only conditions are, where there are velocities


def test_predictions_are_those_of_the_core_with_its_keys(tmp_path):
    found = observable(laboratory(tmp_path, {}, 0))
    keys = ["effects.angle_offset.angle", "drag.linear", "effects.misalignment.angle"]
    values = np.array([[0.0, 1e-5, 0.0], [0.1, 1e-4, 0.2]])
    predicted = found.predict(keys, values)
    assert predicted[0] == pytest.approx(angles({}, found.fields), abs=1e-14)
    changed = {"effects.angle_offset.angle": 0.1, "effects.misalignment.angle": 0.2}
    assert predicted[1] == pytest.approx(angles(changed, found.fields), abs=1e-14)


def test_repeats_are_one_condition_and_their_scatter_the_noise(tmp_path):
    found = observable(laboratory(tmp_path, {}, 3, repeats=3))
    assert len(found.observed) == len(FIELDS)
    # 36 degrees of freedom: the sd is known to 12 %, and widened a little for that.
    single = found.sd * math.sqrt(3)
    assert np.ptp(single) < 1e-12
    assert 0.7 * DEGREE < single[0] < 1.6 * DEGREE
    (note,) = found.notes
    assert (note.code, note.fields["origin"]) == (Code.READING_NOISE, "repeats")
    assert found.group.tolist() == list(range(len(FIELDS)))


def test_the_noise_of_a_smooth_curve_is_estimated():
    random = np.random.default_rng(4)
    x = np.stack([np.zeros(40), np.linspace(0.0, 1.0, 40)], axis=1)
    curve = np.sin(2 * x[:, 1])
    found = [noise_of_curve(x, curve + 0.02 * random.standard_normal(40)) for _ in range(200)]
    sd, dof = np.array(found).T
    assert np.mean(sd) == pytest.approx(0.02, rel=0.05)
    # The scatter of the estimate is that of its degrees of freedom, sd/sqrt(2 dof).
    assert np.std(sd) == pytest.approx(0.02 / math.sqrt(2 * np.mean(dof)), rel=0.25)


def test_a_jump_of_a_curve_does_not_count_as_noise():
    random = np.random.default_rng(5)
    x = np.stack([np.zeros(40), np.linspace(0.0, 1.0, 40)], axis=1)
    curve = np.where(x[:, 1] > 0.5, -1.5, 0.0)
    sd, _ = noise_of_curve(x, curve + 0.02 * random.standard_normal(40))
    assert sd < 0.03


def test_without_scatter_a_reading_has_the_least_error(tmp_path):
    found = observable(laboratory(tmp_path, {}, 0, repeats=1, noise=0.0))
    assert np.all(found.sd >= READING)
    exact = observable(laboratory(tmp_path, {}, 0, repeats=3, noise=0.0))
    assert exact.sd * math.sqrt(3) == pytest.approx(READING)
    (note,) = exact.notes
    assert (note.code, note.fields["taken"]) == (Code.READING_NOISE_SMALL, READING)


def test_widening_keeps_the_size_of_a_test():
    random = np.random.default_rng(6)
    m, dof, draws = 15, 8, 20000
    estimate = np.sqrt(random.chisquare(dof, draws) / dof) * widening(m, dof)
    chi2 = random.chisquare(m, draws) / estimate**2
    # The 97.5 % point of chi-square with 15 degrees of freedom.
    assert np.mean(chi2 > 27.488) == pytest.approx(0.025, abs=4 * math.sqrt(0.025 / draws))


def test_rows_are_put_in_the_order_of_the_field():
    grid = np.array([[x, z] for x in (0.0, 5.0) for z in np.linspace(0, 1, 6)])
    shuffled = grid[np.random.default_rng(7).permutation(len(grid))]
    assert np.array_equal(shuffled[order_along(shuffled)], grid)


def test_pooling_rows():
    merged = merge(np.array([[1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]), np.array([[3.0], [5.0], [4.0]]))
    assert merged.settings.tolist() == [[0.0, 0.0], [1.0, 0.0]]
    assert merged.mean.tolist() == [[5.0], [3.5]]
    assert (merged.count.tolist(), merged.dof) == ([1, 2], 1)
    assert merged.sd == pytest.approx(math.sqrt(0.5))


def good_rows():
    random = np.random.default_rng(8)
    theta = angles({}, FIELDS) + 0.3 * DEGREE * random.standard_normal(len(FIELDS))
    return [list(row) for row in zip(*FIELDS.T.tolist(), theta.tolist(), strict=True)]


def test_a_table_with_invalid_rows_gives_the_same_verdict(tmp_path):
    rows = good_rows()
    rows[3][2] = "nan"
    rows[9] = [rows[9][0], "", rows[9][2]]
    rows[12][2] = 55.0  # a slip of the pen, or degrees
    rows[7][2] += 1.2
    turned = [[row[2], row[0], row[1]] for row in rows]
    path = write(tmp_path, turned, header="theta,Bx,Bz")
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["verdict"] == "none"
    facts = json.loads((tmp_path / "found" / "report.json").read_text())["facts"]["left_out"]
    codes = [each["code"] for each in facts]
    assert codes == [Code.BAD_CELLS, Code.ANGLE_BEYOND_TURN, Code.LONELY_ANGLE]
    assert (facts[0]["fields"]["count"], facts[0]["fields"]["rows"]) == (2, 18)
    assert len(said["left_out"]) == len(facts)


def test_a_table_in_degrees_is_refused_with_the_reason(tmp_path):
    rows = [[bx, bz, math.degrees(theta)] for bx, bz, theta in good_rows()]
    refused(stickslip("diagnose", write(tmp_path, rows)), "degrees", "pi/180")


def test_fields_in_millitesla_are_refused_with_the_reason(tmp_path):
    rows = [[bx * 1e3, bz * 1e3, theta] for bx, bz, theta in good_rows()]
    refused(stickslip("diagnose", write(tmp_path, rows)), "mT")


@pytest.mark.parametrize(
    ("header", "cells", "said"),
    [
        ("Bx,theta", "1e-3,0.1", '"Bz" is missing'),
        ("Bx,Bz,theta", "nan,0,0.1", "no row is sound"),
        ("Bx,Bz,theta", "1e-3,0,up", "no row is sound"),
    ],
)
def test_a_table_without_what_it_needs_is_refused(tmp_path, header, cells, said):
    path = write(tmp_path, [cells.split(",")], header=header)
    refused(stickslip("diagnose", path), said)


def refused(done, *words):
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    for word in words:
        assert word in done.stderr


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([[1e-3, -1e-3, 0.5]], "too few"),
        ([[1e-3, -1e-3, 0.5]] * 5, "too few"),
        ([[1e-3, z * 1e-3, 0.0] for z in range(8)], "nothing moved"),
    ],
)
def test_a_table_without_information_is_a_problem_of_the_data(tmp_path, rows, said):
    path = write(tmp_path, rows)
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["verdict"] == "data-problem"
    assert said in (tmp_path / "found" / "report.html").read_text()


def test_two_tables_are_two_parts_of_the_report(tmp_path):
    path = laboratory(tmp_path, {}, 0)
    (tmp_path / "second.csv").write_text((tmp_path / "angle.csv").read_text())
    path.write_text(path.read_text() + '\n[[angle]]\nfile = "second.csv"\n')
    result = diagnose(read_measurement(path))
    titles = [each.title for each in report_sections(result.posed.comparisons(result.findings))]
    assert titles == ["Static tilt, [[angle]] 1", "Static tilt, [[angle]] 2"]
    assert len(result.findings.problem.observed) == 2 * len(FIELDS)
