"""Measurements from files and from tables in memory: what is read, and what is left out."""

import math

import numpy as np
import pandas as pd
import pytest

from command_line import check, stickslip
from made_measurement import write_files
from refusals.measurement import FRAMES, NOMINAL, TOML, in_memory
from stickslip import Scenario, ScenarioError
from stickslip._util.columns import read_table
from stickslip.walker import Prior, read_measurement
from stickslip.walker.read_velocity import read_velocity, velocities
from stickslip.walker.velocity import VelocityTable

TABLE = pd.DataFrame(
    {
        "velocity": [
            1e-3 * (f / 50) * (1 + 0.01 * (k - 1)) for f in (30, 50, 70, 90) for k in range(3)
        ],
        "trial": np.tile([0, 1, 2], 4),
        "mode": "IPP",
        "frequency": np.repeat([30, 50, 70, 90], 3),
        "block": np.tile(["a", "b", None], 4),
        "order": np.arange(12),
    }
)
ROWS = TABLE.to_csv(index=False)


def read(folder, rows=ROWS):
    return read_measurement(write_files(folder, NOMINAL, TOML, velocity=rows))


# -------------------------------------------------------------------------- a table of data alone
COIL_ROW = "xp,xm,yp,ym,clamp,x,y,z,Bx (mT),By (mT),Bz (mT)\n" + 3 * "1,0,0,0,0,0,0,0,1,0,0\n"


@pytest.mark.parametrize(
    ("observable", "table"),
    {
        "velocity": "frequency;velocity (mm/s)\n30;0,6\n50;1,1\n",
        "tracking": FRAMES,
        "angle": "# a bench\nBx,Bz,theta (deg)\n1e-3,0,5\n2e-3,0,9\n",
        "field": COIL_ROW,
    }.items(),
)
def test_a_table_is_answered_with_the_measurement_that_fits_its_columns(
    tmp_path, observable, table
):
    (tmp_path / "scenario.toml").write_text(NOMINAL)
    (tmp_path / "my data.csv").write_text(table)
    done = stickslip("diagnose", "my data.csv", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert f"my data.csv: is a table for [[{observable}]]" in done.stderr
    wrote = stickslip("diagnose", "my data.csv", "--write", cwd=tmp_path)
    assert (wrote.returncode, wrote.stdout) == (0, "wrote my data.toml\n")
    assert (tmp_path / "my data.toml").read_text() == done.stdout
    assert len(getattr(read_measurement(tmp_path / "my data.toml"), observable)) == 1
    again = stickslip("diagnose", "my data.csv", "--write", cwd=tmp_path)
    check(again, "my data.toml already exists")
    with pytest.raises(ScenarioError, match="a table for"):
        read_measurement(tmp_path / "my data.csv")


# ------------------------------------------------------------------------------------- velocities
def test_trials_are_grouped_into_conditions_from_a_file_and_from_memory(tmp_path):
    found = read(tmp_path)
    (data,) = found.velocity
    assert found.left_out == ()
    assert [each["drive.frequency"] for each in data.conditions] == [30, 50, 70, 90]
    assert {each["drive.base"] for each in data.conditions} == {0.5e-3}
    assert data.condition.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3]
    assert data.block.tolist() == [0, 1, -1] * 4
    assert data.order.tolist() == list(range(12))
    uncertain = {
        "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
        "drag.linear": {"low": 1e-6, "high": 1e-4},
        "drag.rotational": {"median": 9e-17, "factor": 2},
    }
    same = in_memory(TABLE, uncertain)
    assert same.uncertain == found.uncertain
    assert found.uncertain["drag.linear"] == Prior("log-uniform", 1e-6, 1e-4)
    # Columns may stand in another order, and settings in the index.
    turned = in_memory(TABLE[TABLE.columns[::-1]])
    indexed = [in_memory(TABLE.set_index(each)) for each in (["frequency"], ["mode", "frequency"])]
    for other in (same, turned, *indexed):
        assert other.velocity[0].conditions == data.conditions
        for name in ("velocity", "condition", "block", "order"):
            np.testing.assert_array_equal(getattr(other.velocity[0], name), getattr(data, name))


@pytest.mark.parametrize("name", ["drive.{}", "drive_{}"])
def test_settings_have_their_full_names_too(tmp_path, name):
    (data,) = read(tmp_path).velocity
    table = TABLE.rename(columns={key: name.format(key) for key in ("mode", "frequency")})
    in_unit = table.to_csv(index=False).replace("frequency", "frequency (Hz)")
    for other in (in_memory(table), in_memory(table.set_index(name.format("mode"))),
                  read(tmp_path, in_unit)):  # fmt: skip
        assert other.velocity[0].conditions == data.conditions
        assert other.left_out == ()


@pytest.mark.parametrize("cell", ["25", "25.00", " 2.5e1"])
def test_a_repeated_line_is_told_by_its_numbers(tmp_path, cell):
    rows = f"frequency,velocity,trial\n25,1e-3,1\n{cell},1.0e-3,1\n30,2e-3,1\n"
    found = read(tmp_path, rows)
    assert [each.code for each in found.left_out] == ["rows-left-out", "repeated-row"]
    assert len(found.velocity[0].velocity) == 2


@pytest.mark.parametrize("repeats", [1, 3])
@pytest.mark.parametrize("times", [2, 3])
def test_a_table_that_was_put_in_twice_counts_once(repeats, times):
    rows = TABLE[TABLE.trial < repeats][["mode", "frequency", "velocity"]]
    once, twice = (in_memory(pd.concat([rows] * n, ignore_index=True)) for n in (1, times))
    assert twice.velocity[0].velocity.tolist() == once.velocity[0].velocity.tolist()
    assert [each.code for each in twice.left_out] == ["rows-left-out", "repeated-row"]
    # Some readings that are alike by chance are repeats.
    some = in_memory(pd.concat([rows, rows.iloc[:2]], ignore_index=True))
    assert len(some.velocity[0].velocity) == len(rows) + 2


@pytest.mark.parametrize("sd", [None, 0.05])
def test_trials_that_are_all_copies_tell_no_error(sd):
    rows = TABLE[TABLE.trial == 0][["mode", "frequency", "velocity"]]
    copied = pd.concat([rows, rows.iloc[:3]], ignore_index=True)
    once, found = (VelocityTable(in_memory(each, velocity_sd=sd)) for each in (rows, copied))
    np.testing.assert_array_equal(found.errors.sd, once.errors.sd)
    assert found.errors.dof == once.errors.dof
    assert "copies" in {each.code for each in found.errors.notes}


def test_invalid_rows_are_left_out_and_reported(tmp_path):
    lines = ROWS.splitlines()
    lines[2] = lines[2].replace("0.0006", "nan")
    lines.insert(4, lines[3])
    lines += ["0.5,3,IPP,30,day3,40", "0.001,3,IPP,n/a,day3,41", "0.001,3,IPP"]
    found = read(tmp_path, "\n".join(lines))
    said = [
        (each.code, each.text.removeprefix("velocity.csv"), each.value) for each in found.left_out
    ]
    assert said == [
        ("rows-left-out", ": 4 of 16 rows were left out.", 4),
        ("not-a-number", ' line 3: velocity "nan" is not a number.', 1),
        ("repeated-row", " line 5: the row repeats an earlier one.", 1),
        ("not-a-number", ' line 16: frequency "n/a" is not a number.', 1),
        ("cell-count", " line 17: 3 cells, and the header has 6: not used.", 1),
        # The two trials at 30 Hz that are left beside it are of 0.594 and 0.606 mm/s.
        ("outlier", ": a trial of 0.5 m/s is far from the others of its condition, which are near "
         "0.000606 m/s.", 0.5),
    ]  # fmt: skip
    assert len(found.velocity[0].velocity) == 11


def test_rows_in_memory_are_named_by_their_label():
    table = TABLE.astype({"velocity": object, "frequency": object})
    table.loc[1, "velocity"], table.loc[10, "velocity"] = None, np.nan
    table.loc[4, "velocity"] = "lost"
    table.loc[7, "frequency"] = -3.0
    # A level of the index with another name says what a row is called.
    names = pd.Index([f"film {k}" for k in range(12)], name="film")
    for given, labels in ((table, range(12)), (table.set_axis(names), names)):
        data = in_memory(given)
        assert len(data.velocity[0].velocity) == 8
        said = "\n".join(map(str, data.left_out))
        assert f"DataFrame rows {labels[1]}, {labels[10]}: velocity is empty." in said
        assert f'DataFrame row {labels[4]}: velocity "lost" is not a number.' in said
        assert f"DataFrame row {labels[7]}: drive.frequency = -3.0: allowed is" in said
        assert "DataFrame: 4 of 12 rows were left out" in said


def test_lines_are_numbered_as_in_the_file_and_reasons_are_grouped(tmp_path):
    path = tmp_path / "velocity.csv"
    path.write_text(
        "# our robot\nmode,frequency,hold,velocity\n\nIPP,30,6e-4,1e-3\noop,30,6e-4,1e-3\n"
        "oop,40,6e-4,1e-3\n# again\nIPP,50,6e-4,lost\nIPP,50,6e-4,no data\n" + "IPP,60,6e-4,\n" * 6
    )
    data, left_out = read_velocity(read_table(path, velocities()), Scenario(), math.nan)
    assert len(data.velocity) == 1
    said = [str(each) for each in left_out]
    (refused,) = (each for each in said if "oop" in each)
    assert refused.startswith('velocity.csv lines 5, 6: drive.mode = "oop": allowed is ')
    assert set(said) - {refused} == {
        "velocity.csv: 10 of 11 rows were left out.",
        'velocity.csv line 8: velocity "lost" is not a number.',
        'velocity.csv line 9: velocity "no data" is not a number.',
        "velocity.csv lines 10, 11, 12, 13, 14, ...: velocity is empty.",
        "velocity.csv: 1 line below the header skipped as a comment.",
    }


def test_slow_conditions_scatter_by_more_than_their_share():
    # An error of 10 um/s that does not fall with the velocity, and one of 3 %. Of 1800 normal
    # draws none is eight standard deviations away; a trial that is 20 away is no draw of theirs.
    random = np.random.default_rng(4)
    level = np.geomspace(5e-6, 2e-3, 20)
    settings = {"trial": np.repeat([0, 1, 2], 20), "frequency": np.tile(np.arange(20) + 20, 3)}
    for number in range(30):
        trials = level + np.hypot(0.03 * level, 1e-5) * random.standard_normal((3, 20))
        if number == 0:
            trials[1, 2] += 2e-4
        left_out = in_memory(pd.DataFrame({**settings, "velocity": trials.ravel()})).left_out
        assert len(left_out) == (1 if number == 0 else 0), left_out


def test_the_order_of_trials_is_a_number_or_a_date():
    dates = pd.Timestamp("2026-01-05") + pd.to_timedelta(np.arange(12) * 60.0, "s")
    data = in_memory(TABLE.assign(order=dates))
    assert data.velocity[0].order.tolist() == [60.0 * k for k in range(12)]
    data = in_memory(TABLE.assign(order=["na", *range(1, 11), None]))
    assert 'DataFrame row 0: order "na" is not a number.' in map(str, data.left_out)
    assert np.isnan(data.velocity[0].order[-1])  # not known


@pytest.mark.parametrize("written", ["2026-05-01 23:5{}", "2026-05-01T23:5{}:00Z", "23:5{}:00"])
def test_the_order_of_a_file_may_be_dates_or_clocks(tmp_path, written):
    table = TABLE.iloc[:9].assign(order=[written.format(k) for k in range(9)])
    found = read(tmp_path, table.to_csv(index=False))
    assert np.diff(found.velocity[0].order).tolist() == [60.0] * 8
    assert found.left_out == ()
    trials = VelocityTable(found)
    assert np.ptp(trials.sequence) == trials.sequence.max() == 480.0


# ----------------------------------------------------------------------------------------- priors
def test_an_uncertain_parameter_of_an_effect_has_a_short_name():
    prior = Prior("normal", 0.0, 0.01)
    data = in_memory(TABLE, {"surface_tilt.angle": prior})
    assert data.uncertain == {"effects.surface_tilt.angle": prior}


def test_a_prior_is_judged_beside_the_others():
    both = {
        "contact.kinetic_friction": Prior("normal", 0.5, 0.01),
        "contact.static_friction": Prior("normal", 0.6, 0.01),
    }
    assert len(in_memory(TABLE, both).uncertain) == 2


def test_a_prior_whose_middle_no_scenario_has_is_refused():
    # The middle of a log-uniform prior is the root of 0.15 * 0.3 = 0.045.
    name = "contact.kinetic_friction"
    with pytest.raises(ScenarioError, match=rf'\[uncertain\] "{name}" = .*: {name} = 0\.2121'):
        in_memory(TABLE, {name: Prior("log-uniform", 0.15, 0.3)})
    assert in_memory(TABLE, {name: Prior("log-uniform", 0.15, 0.19)}).uncertain


@pytest.mark.parametrize(
    ("prior", "middle"),
    [
        (Prior("normal", 0.2, 0.01), 0.2),
        (Prior("log-normal", 9e-17, 2.0), 9e-17),
        (Prior("log-uniform", 1e-6, 1e-4), 1e-5),
        (Prior("uniform", -1e-6, 3e-6), 1e-6),
    ],
)
def test_a_prior_and_its_coordinate_are_inverse(prior, middle):
    assert float(prior.value(0.0)) == pytest.approx(middle, rel=1e-12)
    for z in (-2.0, 0.0, 1.5):
        assert math.isclose(prior.coordinate(float(prior.value(z))), z, abs_tol=1e-9)
    if not prior.has_middle:
        near, low, high = 0.01 * abs(prior.first), prior.first, prior.second
        ends = [prior.coordinate(end) for end in (min(low - 1.0, -1.0), low, high)]
        assert ends == [-5.0, -5.0, 5.0]
        assert low <= prior.value(-50.0) < low + near
        assert high - near < prior.value(50.0) <= high
