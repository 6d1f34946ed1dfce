"""Measurement files: what is read, what is left out and why, and what is refused."""

import math

import numpy as np
import pytest

from stickslip.errors import ScenarioError
from stickslip.measurement import Prior, read_measurement
from stickslip.measurement.tables import read_rows
from stickslip.measurement.velocity import read_velocity, velocity_units
from stickslip.scenario.scenario import Scenario

TOML = """stickslip_measurement = 1
name = "wafer"
scenario = "nominal.toml"

[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"drag.linear" = { low = 1e-6, high = 1e-4 }
"drag.rotational" = { median = 9e-17, factor = 2 }

[[velocity]]
file = "velocity.csv"
"""

ROWS = "velocity,trial,mode,frequency,block,order\n" + "".join(
    f"{1e-3 * (f / 50) * (1 + 0.01 * (k - 1))!r},{k},IPP,{f},day{k},{3 * n + k}\n"
    for n, f in enumerate((30, 50, 70, 90))
    for k in range(3)
)


def _write(folder, rows=ROWS, toml=TOML, **files):
    (folder / "nominal.toml").write_text("stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 8\n")
    (folder / "velocity.csv").write_text(rows)
    (folder / "m.toml").write_text(toml)
    for name, text in files.items():
        (folder / f"{name}.csv").write_text(text)
    return folder / "m.toml"


def test_trials_are_grouped_into_conditions(tmp_path):
    found = read_measurement(_write(tmp_path))
    (data,) = found.velocity
    assert found.left_out == ()
    assert [each["drive.frequency"] for each in data.conditions] == [30, 50, 70, 90]
    assert {each["drive.base"] for each in data.conditions} == {0.5e-3}
    assert data.condition.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3]
    assert data.block.tolist() == [0, 1, 2] * 4
    assert data.order.tolist() == list(range(12))
    assert found.uncertain["drag.linear"] == Prior("log-uniform", 1e-6, 1e-4)


def test_invalid_rows_are_left_out_and_reported(tmp_path):
    lines = ROWS.splitlines()
    lines[2] = lines[2].replace("0.0006", "nan")
    lines.insert(4, lines[3])
    lines.append("0.5,3,IPP,30,day3,40")
    lines.append("0.001,3,IPP,fast,day3,41")
    lines.append("0.001,3,IPP")
    found = read_measurement(_write(tmp_path, "\n".join(lines)))
    said = [
        (each.code, each.text.removeprefix("velocity.csv"), each.value) for each in found.left_out
    ]
    assert said == [
        ("rows-left-out", ": 4 of 16 rows were left out.", 4),
        ("not-a-number", ' line 3: velocity "nan" is not a number.', 1),
        ("repeated-row", " line 5: the row repeats an earlier one.", 1),
        ("not-a-number", ' line 16: frequency "fast" is not a number.', 1),
        ("cell-count", " line 17: a row of 3 cells is not used, as the header names 6 columns.", 1),
        # The two trials at 30 Hz that are left beside it are of 0.594 and 0.606 mm/s.
        ("outlier", ": a trial of 0.5 m/s is far from the others of its condition, which are near "
         "0.000606 m/s.", 0.5),
    ]  # fmt: skip
    assert len(found.velocity[0].velocity) == 11


def test_a_single_wrong_unit_is_named_as_such(tmp_path):
    rows = ROWS + "0.6,3,IPP,30,day3,40\n"
    found = read_measurement(_write(tmp_path, rows))
    (note,) = found.left_out
    assert (note.code, note.value) == ("outlier", 0.6)
    assert note.text.endswith("; the factor of 1000 is that of a wrong unit.")


def test_slow_conditions_scatter_by_more_than_their_share(tmp_path):
    # An error of 10 um/s that does not fall with the velocity, and one of 3 %. Of 1800 normal
    # draws none is eight standard deviations away; a trial that is 20 away is no draw of theirs.
    random = np.random.default_rng(4)
    frequency = np.arange(20) + 20
    level = np.geomspace(5e-6, 2e-3, len(frequency))
    for number in range(30):
        trials = level + np.hypot(0.03 * level, 1e-5) * random.standard_normal((3, len(level)))
        if number == 0:
            trials[1, 2] += 2e-4
        rows = [
            f"{value!r},{trial},IPP,{pace}"
            for trial, row in enumerate(trials.tolist())
            for pace, value in zip(frequency, row, strict=True)
        ]
        text = "velocity,trial,mode,frequency\n" + "\n".join(rows) + "\n"
        left_out = read_measurement(_write(tmp_path, text)).left_out
        assert len(left_out) == (1 if number == 0 else 0), left_out


def test_a_table_in_the_wrong_unit_is_refused_with_the_reason(tmp_path):
    rows = "velocity,frequency\n" + "".join(f"{900 + f},{f}\n" for f in (10, 20, 30))
    with pytest.raises(ScenarioError, match="if they are in um/s, divide"):
        read_measurement(_write(tmp_path, rows))


def test_columns_may_stand_in_another_order(tmp_path):
    table = [line.split(",") for line in ROWS.splitlines()]
    turned = "\n".join(",".join(reversed(row)) for row in table)
    first = read_measurement(_write(tmp_path)).velocity[0]
    second = read_measurement(_write(tmp_path, turned)).velocity[0]
    assert np.array_equal(first.velocity, second.velocity)
    assert first.conditions == second.conditions


def test_frames_are_sorted_and_each_time_counts_once(tmp_path):
    toml = TOML.split("[[velocity]]")[0] + '[[tracking]]\nfile = "frames.csv"\n'
    # The scenario's pulses go from 50 to 130 ms.
    rows = [f"{k}e-3,{k}e-3,{k}e-6" for k in range(120)]
    rows[3], rows[4] = rows[4], rows[3]
    frames = "\n".join(["t,theta,x", *rows, "50e-3,9,9", "0.125,,3", "0.2,0,0"])
    found = read_measurement(_write(tmp_path, toml=toml, frames=frames))
    (run,) = found.tracking
    assert np.allclose(run.columns["t"], np.arange(120) * 1e-3)
    assert np.array_equal(run.columns["theta"], run.columns["t"])
    assert run.frame_rate == pytest.approx(1000.0)
    assert [each.code for each in found.left_out] == [
        "bad-cells", "frames-sorted", "repeated-times", "frames-after-drive"
    ]  # fmt: skip
    assert [each.value for each in found.left_out] == [1, None, 1, 1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("stickslip_measurement = 1", "stickslip_measurement = 2"), "allowed is 1"),
        (('name = "wafer"', 'nme = "wafer"'), 'did you mean "name"'),
        (("sd = 0.01", "sd = 0.0"), "above 0"),
        (("sd = 0.01", "spread = 0.01"), "allowed is { mean, sd }"),
        (("low = 1e-6", "low = 1e-3"), "low < high"),
        (('"contact.kinetic_friction"', '"contact.friction"'), "no such key"),
        (('"contact.kinetic_friction"', "contact.kinetic_friction"), "quotation marks"),
        (('file = "velocity.csv"', 'file = "absent.csv"'), "cannot be read"),
        (('file = "velocity.csv"', 'file = "velocity.csv"\nvelocity_sd = 2'), "velocity_sd"),
        (('scenario = "nominal.toml"', "scenario = 3"), "scenario = 3"),
        (("[[velocity]]", "[[speed]]"), "[[speed]]: there is no such entry"),
        (
            (
                'file = "velocity.csv"',
                'file = "velocity.csv"\n[[velocity]]\nfile = "./velocity.csv"',
            ),
            'file = "./velocity.csv" is there twice',
        ),
        ((TOML, " "), 'is empty; a measurement has "stickslip_measurement = 1" and "scenario"'),
        (("stickslip_measurement = 1", ""), "stickslip_measurement = 1 is missing"),
        (("stickslip_measurement = 1", "stickslip = 1"), "a scenario, not a measurement"),
        (("sd = 0.01", "std = 0.01"), "{ mean = 0.145, std = 0.01 }"),
        (('"contact.kinetic_friction"', '"drive.peak"'), "not in [drive]"),
        (('file = "velocity.csv"', ""), "[[velocity]] file is missing"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, change, said):
    path = _write(tmp_path, toml=TOML.replace(*change))
    with pytest.raises(ScenarioError) as error:
        read_measurement(path)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("frequency\n30\n", '"velocity" is missing'),
        ("velocity,frequenzy\n0.1,30\n", 'did you mean "frequency"'),
        ("velocity\n", "no row of data"),
        ("frequency,velocty\n30,0.1\n", '"velocty" may be meant'),
        ("frequency,hold,velocity\n30,0.6,1e-3\n", "line 2: hold of 0.6 T .* in mT"),
        ("frequency,velocity\n0.03,1e-3\n", "frequency of 0.03 Hz .* in kHz"),
        ("velocity,velocity\n1,1\n", "twice"),
        ("velocity,frequency\nnan,30\nfast,30\n", "no row is sound"),
    ],
)
def test_a_table_without_a_sound_row_is_refused(tmp_path, rows, said):
    with pytest.raises(ScenarioError, match=said):
        read_measurement(_write(tmp_path, rows))


@pytest.mark.parametrize(
    "prior",
    [
        Prior("normal", 0.2, 0.01),
        Prior("log-normal", 9e-17, 2.0),
        Prior("log-uniform", 1e-6, 1e-4),
    ],
)
def test_a_prior_and_its_coordinate_are_inverse(prior):
    for z in (-2.0, 0.0, 1.5):
        assert math.isclose(prior.coordinate(float(prior.value(z))), z, abs_tol=1e-9)


def test_a_range_bounds_its_parameter():
    prior = Prior("log-uniform", 1e-6, 1e-4)
    assert 1e-6 <= prior.value(-50.0) < 1.01e-6
    assert 0.99e-4 < prior.value(50.0) <= 1e-4
    assert math.isclose(float(prior.value(0.0)), 1e-5)


def test_lines_are_numbered_as_in_the_file_and_reasons_are_grouped(tmp_path):
    path = tmp_path / "velocity.csv"
    path.write_text(
        "# our robot\nmode,frequency,velocity\n\nIPP,30,1e-3\noop,30,1e-3\noop,40,1e-3\n"
        "# again\nIPP,50,lost\n"
    )
    data, left_out = read_velocity(read_rows(path, velocity_units()), Scenario(), float("nan"))
    assert len(data.velocity) == 1
    many, refused, lost, comments = map(str, left_out)
    assert many == "velocity.csv: 3 of 4 rows were left out."
    assert refused.startswith('velocity.csv lines 5, 6: drive.mode = "oop": allowed is ')
    assert lost == 'velocity.csv line 8: velocity "lost" is not a number.'
    assert comments == "velocity.csv: 1 line below the header skipped as a comment."


def test_of_many_lines_the_first_are_named(tmp_path):
    path = tmp_path / "velocity.csv"
    path.write_text("frequency,velocity\n30,1e-3\n" + "40,\n" * 6)
    _, left_out = read_velocity(read_rows(path, velocity_units()), Scenario(), float("nan"))
    assert left_out[-1].value == 6
    assert str(left_out[-1]) == "velocity.csv lines 3, 4, 5, 6, 7, ...: velocity is empty."


def test_one_field_in_another_unit_is_left_out(tmp_path):
    path = tmp_path / "velocity.csv"
    path.write_text("frequency,hold,velocity\n30,6e-4,1e-3\n40,6e-4,1e-3\n50,0.6,1e-3\n")
    data, left_out = read_velocity(read_rows(path, velocity_units()), Scenario(), float("nan"))
    assert len(data.velocity) == 2
    assert [str(each) for each in left_out if each.code == "setting-unit"] == [
        "velocity.csv line 4: hold of 0.6 T is above 0.1 T; if it is in mT, divide it by 1e3."
    ]


def test_a_prior_is_shown_in_a_few_characters():
    assert repr(Prior("normal", 0.145, 0.01)) == "normal(0.145, 0.01)"


@pytest.mark.parametrize("given", [(0.145, 0.01), ({"mean": 1.0},), ("normal", 0.145), ("normal",)])
def test_a_prior_that_is_none_is_refused_in_one_line(given):
    with pytest.raises(ScenarioError, match=": allowed is") as refusal:
        Prior(*given)
    assert "\n" not in str(refusal.value)
