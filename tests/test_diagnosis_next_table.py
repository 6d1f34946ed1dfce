"""The table of ``stickslip diagnose --next``: what is written, filled in, read and refused."""

import json

import pandas as pd
import pytest

from asking_results import SAFE, asking, measurement
from command_line import stickslip
from made_measurement import write
from stickslip import read_measurement
from stickslip.cli.next_table import PREDICTIONS, TABLE, with_measured
from stickslip.diagnosis.decision.experiments import LEAST_WORTH, next_step
from stickslip.errors import ScenarioError
from stickslip.measurement.tables import read_rows
from stickslip.measurement.velocity import velocity_units


@pytest.fixture
def folder(tmp_path):
    """A folder ``--out``, and a measurement."""
    return tmp_path, measurement()


def test_what_was_filled_in_stays_as_it_is_and_new_drives_come_below(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 2, 3)
    begun.write(asking(data))
    lines = (folder / TABLE).read_text().splitlines()
    assert len(lines) == 1 + 2 * 3
    predictions = pd.read_csv(folder / PREDICTIONS)
    assert predictions["candidate"].tolist() == ["a", "b"] * 2
    assert predictions["experiment"].tolist() == [1, 1, 2, 2]
    assert {"frequency", "velocity", "sd"} <= set(predictions)
    # A person fills in two trials of the first drive, as a person writes.
    noted = [lines[0], "# the second try", f"{lines[1]} 1.50e-3", *lines[2:3], f"{lines[3]}1.6e-3"]
    (folder / TABLE).write_text("\r\n".join([*noted, *lines[4:]]) + "\r\n", newline="")
    more, going = with_measured(data, folder, 2, 3)
    assert more.velocity[1].velocity.tolist() == [1.5e-3, 1.6e-3]
    assert (going.measured, going.trials) == (1, 2)
    going.write(asking(more))
    written = (folder / TABLE).read_text().splitlines()
    assert written[:4] == [*noted[:3], noted[4]]
    assert len(written) == 4 + 2 * 3


def test_a_table_that_a_spreadsheet_has_written_gets_new_drives_in_its_own_columns(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 2, 3)
    begun.write(asking(data))
    header, *rows = (folder / TABLE).read_text().splitlines()
    assert header.split(",")[-1] == "velocity"
    # With decimal commas, velocities in mm/s, a column for remarks and one that is empty.
    filled = [f'{rows[0]}1.5,"the; first",', *(f"{each},," for each in rows[1:])]
    written = [each.replace(",", ";").replace(".", ",") for each in filled]
    head = header.replace("velocity", "velocity (mm/s)").replace(",", ";")
    text = ["sep=;", "# by Ada", f"{head};operator;", *written]
    (folder / TABLE).write_bytes("\r\n".join(text).encode("utf-16"))
    more, going = with_measured(data, folder, 2, 3)
    assert more.velocity[1].velocity.tolist() == [1.5e-3]
    going.write(asking(more))
    found = read_rows(folder / TABLE, velocity_units())
    assert found.header == [*header.split(","), "operator"]
    assert found.rows[0][1] == [*rows[0].split(",")[:-1], "0.0015", "the; first"]
    assert [row for _, row in found.rows[1:]] == [[*each.split(","), ""] for each in rows]
    assert "# by Ada" in (folder / TABLE).read_text().splitlines()
    again, _ = with_measured(data, folder, 2, 3)
    assert again.velocity[1].velocity.tolist() == [1.5e-3]


def test_the_budget_is_counted_over_the_rounds_and_its_end_is_said(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 5, 2)
    assert len(begun.proposed(asking(data))) == 2
    begun.write(asking(data))
    table = pd.read_csv(folder / TABLE).assign(velocity=1e-3)
    table.to_csv(folder / TABLE, index=False)
    more, ended = with_measured(data, folder, 1, 2)
    assert ended.measured == 2
    assert ended.proposed(asking(more)) == []
    text = "\n".join(ended.lines(asking(more)))
    assert "the budget of 2 experiments is used up; --budget 3 allows more" in text
    before = (folder / TABLE).read_bytes()
    ended.write(asking(more))
    assert (folder / TABLE).read_bytes() == before
    _, going = with_measured(data, folder, 1, 3)
    assert going.as_dict(asking(more))["proposed"] == 1


def test_a_safe_name_is_said_to_be_safe_and_nothing_is_proposed(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 3, 3)
    begun.write(asking(data, SAFE))
    assert not (folder / TABLE).exists()
    assert begun.lines(asking(data, SAFE)) == [f"  {SAFE}"]
    said = begun.as_dict(asking(data, SAFE))
    assert (said["safe"], said["proposed"], said["table"]) == (True, 0, None)


def test_what_to_measure_is_said_with_what_each_candidate_predicts(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 1, 3)
    text = "\n".join(begun.lines(asking(data)))
    assert f"1 experiment, in {folder / TABLE}; 0 of at most 3 measured" in text
    assert "1. mode OPP, direction +x, frequency 50 Hz" in text
    assert "expected: 1.000 ± 0.010 mm/s with a; 1.000 ± 0.010 mm/s with b" in text


def test_where_no_drive_would_decide_none_is_written_and_this_is_said(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 2, 3)
    little = asking(data, separation=0.9 * LEAST_WORTH)
    begun.write(little)
    assert not (folder / TABLE).exists()
    text = "\n".join(begun.lines(little))
    assert f"no drive is in {folder / TABLE}: none that was tried would decide" in text
    assert begun.as_dict(little)["proposed"] == 0


def test_a_table_of_another_measurement_is_refused(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 1, 3)
    begun.write(asking(data))
    (folder / "report.json").write_text(json.dumps({"name": "glass"}))
    with pytest.raises(ScenarioError, match='is of another measurement, "glass"'):
        with_measured(data, folder, 1, 3)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("IPP,-x,50,2.5e-3,1e-3,rise,1,1.1 mm/s", 'next.csv line 2: velocity "1.1 mm/s" is not'),
        ("IPP,-x,fast,2.5e-3,1e-3,rise,1,1e-3", 'next.csv line 2: frequency "fast" is not'),
        ("IPP,z,50,2.5e-3,1e-3,rise,1,1e-3", r"next.csv line 2: drive.direction = \"z\": allowed"),
    ],
)
def test_bad_rows_of_the_table_are_one_line_and_exit_code_two(tmp_path, rows, said):
    path = write(tmp_path, {})
    (tmp_path / "found").mkdir()
    header = "mode,direction,frequency,peak,hold,edge,trial,velocity"
    (tmp_path / "found" / TABLE).write_text(f"{header}\n{rows}\n")
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--next", 1)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert said.replace("\\", "") in line


def test_a_column_that_was_taken_away_is_missed(tmp_path):
    data = read_measurement(write(tmp_path, {}))
    (tmp_path / TABLE).write_text("frequency,velocity\n50,1e-3\n")
    with pytest.raises(ScenarioError, match='column "mode" is missing'):
        with_measured(data, tmp_path, 1, 3)


def test_a_budget_without_next_is_refused():
    done = stickslip("diagnose", "m.toml", "--budget", 2)
    assert done.returncode == 2
    assert "--budget" in done.stderr


def test_without_a_finding_nothing_is_proposed(tmp_path):
    path, found = write(tmp_path, {}), tmp_path / "found"
    done = stickslip("diagnose", path, "--out", found, "--next", 2, "--seed", 3, "--json")
    said = json.loads(done.stdout)
    assert said["verdict"] == "none"
    assert said["next"] == {
        "safe": False, "why": str(next_step("none", [], 0.0)),
        "proposed": 0, "measured": 0, "budget": 3, "table": None,
    }  # fmt: skip
    assert not (found / TABLE).exists()


def test_a_table_that_is_not_read_is_mentioned(tmp_path):
    path, found = write(tmp_path, {}), tmp_path / "found"
    head, *rows = (tmp_path / "velocity.csv").read_text().splitlines()
    (tmp_path / "velocity.csv").write_text("\n".join([head, *rows[:3]]) + "\n")
    found.mkdir()
    (found / TABLE).write_text("never read")
    done = stickslip("diagnose", path, "--out", found)
    assert "Verdict: data-problem" in done.stdout
    assert f"{found / TABLE} is not read, as --next is not given" in done.stderr
