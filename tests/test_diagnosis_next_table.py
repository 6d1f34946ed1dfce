"""The table of ``stickslip diagnose --next``: what is written, filled in and read."""

import json

import pandas as pd
import pytest

from asking_results import SAFE, asking, measurement
from command_line import stickslip
from made_measurement import few_causes, write
from stickslip._util.columns import read_table
from stickslip.diagnosis.decision.experiments import LEAST_WORTH
from stickslip.walker.next_table import PREDICTIONS, TABLE, with_measured
from stickslip.walker.read_velocity import velocities


@pytest.fixture
def begun(tmp_path):
    """A folder ``--out``, a measurement, and rounds of two experiments of at most three."""
    data = measurement()
    return tmp_path, data, with_measured(data, tmp_path, 2, 3)[1]


def test_what_was_filled_in_stays_as_it_is_and_new_drives_come_below(begun):
    folder, data, rounds = begun
    rounds.write(asking(data))
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


def test_a_table_that_a_spreadsheet_has_written_gets_new_drives_in_its_own_columns(begun):
    folder, data, rounds = begun
    rounds.write(asking(data))
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
    found = read_table(folder / TABLE, velocities())
    assert list(found.columns) == [*header.split(","), "operator"]
    lines = (folder / TABLE).read_text().splitlines()[-1 - len(rows) :]
    assert lines[0] == ",".join([*rows[0].split(",")[:-1], "0.0015", "the; first"])
    assert lines[1:] == [f"{each}," for each in rows]
    assert "# by Ada" in (folder / TABLE).read_text().splitlines()
    again, _ = with_measured(data, folder, 2, 3)
    assert again.velocity[1].velocity.tolist() == [1.5e-3]


def test_the_budget_is_counted_over_the_rounds_and_its_end_is_said(begun):
    folder, data, _ = begun
    _, rounds = with_measured(data, folder, 5, 2)
    assert len(rounds.proposed(asking(data))) == 2
    rounds.write(asking(data))
    pd.read_csv(folder / TABLE).assign(velocity=1e-3).to_csv(folder / TABLE, index=False)
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


def test_what_to_measure_is_said_with_what_each_candidate_predicts(begun):
    folder, data, rounds = begun
    text = "\n".join(rounds.lines(asking(data)))
    assert f"2 experiments, in {folder / TABLE}; 0 of at most 3 measured" in text
    assert "1. mode OPP, direction +x, frequency 50 Hz" in text
    assert "expected: 1.000 ± 0.010 mm/s with “a”; 1.000 ± 0.010 mm/s with “b”" in text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"said": SAFE}, str(SAFE)),
        ({"separation": 0.9 * LEAST_WORTH}, "none that was tried would decide"),
    ],
)
def test_where_nothing_is_worth_measuring_no_table_is_written(begun, options, said):
    folder, data, rounds = begun
    result = asking(data, **options)
    rounds.write(result)
    assert not (folder / TABLE).exists()
    assert said in "\n".join(rounds.lines(result))
    told = rounds.as_dict(result)
    assert (told["safe"], told["proposed"], told["table"]) == ("said" in options, 0, None)


@pytest.mark.nightly
def test_without_a_finding_nothing_is_proposed(tmp_path, monkeypatch):
    few_causes(monkeypatch, ("surface_tilt",))
    path, found = write(tmp_path, {}), tmp_path / "found"
    done = stickslip("diagnose", path, "--out", found, "--next", 2, "--seed", 3, "--json")
    said = json.loads(done.stdout)
    assert said["verdict"] == "none"
    assert said["left"] == pytest.approx(1.0 - said["probabilities"]["none"])
    assert said["next"] == {
        "safe": False, "why": said["next"]["why"],
        "proposed": 0, "measured": 0, "budget": 3, "table": None,
    }  # fmt: skip
    assert not (found / TABLE).exists()


def test_a_table_that_is_not_read_is_mentioned(tmp_path):
    path = write(tmp_path, {}, change=lambda lines: lines[:4])
    found = tmp_path / "found"
    found.mkdir()
    (found / TABLE).write_text("never read")
    done = stickslip("diagnose", path, "--out", found)
    assert "Verdict: data-problem" in done.stdout
    assert f"{found / TABLE} is not read, as --next is not given" in done.stderr
