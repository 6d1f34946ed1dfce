"""A part of the search of `python -m bench fuzz` with fixed seeds; its checks on false records."""

import dataclasses
import os
import signal
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from stickslip import Scenario

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

from fuzz import balances, contact_laws
from fuzz.__main__ import main
from fuzz.checks import CHECKS
from fuzz.files import KINDS, Outcome, check_file, command, wrong
from fuzz.originals import originals
from fuzz.processes import run_all
from fuzz.record import CORNER_STICK, FLIGHT, recorded
from fuzz.scenarios import POPULATIONS, Identity, scenario


@pytest.mark.parametrize("population", POPULATIONS)
def test_a_scenario_is_determined_by_its_name(population):
    names = [Identity(population, seed, number) for seed in (0, 1) for number in range(3)]
    texts = [scenario(Identity.parse(str(name))).to_toml() for name in names]
    assert texts == [scenario(name).to_toml() for name in names]
    assert len(set(texts)) == len(texts)


# Newton's restitution can add energy to an oblique impact with friction, as it does in wild:1:9.
NUMBERS = {"paper": range(6), "wild": [*range(9), *range(10, 16)]}


@pytest.mark.parametrize("population", NUMBERS)
@pytest.mark.parametrize("check", ["status", "invariants"])
def test_nothing_is_found_in_random_scenarios(population, check):
    names = [Identity(population, 1, number) for number in NUMBERS[population]]
    found = {str(name): CHECKS[check](name) for name in names}
    assert {name: each["failures"] for name, each in found.items() if each["failures"]} == {}
    if check == "invariants":
        assert sum(each["kind"] == "balanced" for each in found.values()) > 0.7 * len(names)


def test_velocities_at_the_default_tolerance_and_of_both_integrators_agree():
    for number in NUMBERS["paper"]:
        for check in ("tolerance", "integrators"):
            found = CHECKS[check](Identity("paper", 1, number))
            assert found["kind"] == "close", (check, number, found)


HOPPING = {
    "drive.mode": "OPP",
    "drive.hold": 2.5e-3,
    "drive.edge": "fall",
    "drive.frequency": 30.0,
    "drive.pulses": 3,
    "contact.restitution": 0.3,
}


@pytest.fixture(scope="module")
def record():
    made, run = recorded(Scenario().replace(HOPPING), 1e-10)
    assert run.ok
    assert made.fine
    assert set(made.contact) >= {FLIGHT, CORNER_STICK}
    assert np.any(made.slips)
    assert contact_laws.violations(made) == []
    assert balances.violations(made) == []
    return made


def _in_mode(record, mode):
    """A sample in the middle of the longest stretch in a mode."""
    longest = max(
        (ends for ends in balances.stretches(record) if record.contact[ends[0]] in mode),
        key=lambda ends: ends[1] - ends[0],
    )
    return sum(longest) // 2


# What is done to one sample of the record: the column, in which modes, by how much.
FALSE = {
    "a corner is below the surface": ("z", (FLIGHT,), lambda r, i: -r.z[i]),
    "what touches is not at the surface": ("z", (CORNER_STICK,), lambda r, i: 1e-3 * r.radius),
    "the surface pulls": ("normal", (2, 3), lambda r, i: -r.normal[i] - 0.01 * r.force),
    "there is a force in flight": ("normal", (FLIGHT,), lambda r, i: 1e-15),
    "a stick is outside the friction cone": (
        "friction",
        (CORNER_STICK,),
        lambda r, i: 0.5 * r.force,
    ),
    "a stick slips": ("slip", (CORNER_STICK,), lambda r, i: 1e-12),
    "a stick drifts": ("contact_x", (CORNER_STICK,), lambda r, i: 1e-15),
    "friction of a slip is not kinetic": ("friction", (2, 3), lambda r, i: 1e-2 * r.force),
    "a slip runs against its mode": ("slip", (2, 3), lambda r, i: -r.slips[i] - r.slip[i]),
    "the contact does not move with the body": (
        "vx",
        (CORNER_STICK,),
        lambda r, i: 1e-6 * r.fastest,
    ),
    "the position jumps": ("x", (FLIGHT,), lambda r, i: 0.2 * r.radius),
    "the field is not that of the currents": ("bx", (0, 1, 2, 3), lambda r, i: 1e-9),
    "is not finite": ("omega", (CORNER_STICK,), lambda r, i: np.nan),
}


@pytest.mark.parametrize("said", FALSE)
def test_a_false_sample_is_found(record, said):
    column, modes, change = FALSE[said]
    values = getattr(record, column).copy()
    where = _in_mode(record, modes)
    # The field is looked at in some of the samples.
    some = slice(None) if column == "bx" else where
    values[some] += change(record, where)
    found = contact_laws.violations(dataclasses.replace(record, **{column: values}))
    assert any(said in line for line in found), found


@pytest.mark.parametrize(
    ("key", "factor", "said"),
    [
        ("drag.linear", 1.1, "momentum along x"),
        ("environment.gravity", 1.001, "momentum across"),
        ("robot.magnetization", 1.001, "spin"),
        ("drag.rotational", 1.5, "energy is not balanced"),
    ],
)
def test_a_motion_under_other_forces_is_found(record, key, factor, said):
    other = record.scenario.replace({key: factor * record.scenario.get(key)})
    found = balances.violations(dataclasses.replace(record, scenario=other))
    assert any(said in line for line in found), found


def test_energy_that_an_impact_adds_is_found(record):
    # Just after the fastest event, an impact that takes a part of the energy, all is faster.
    speed = np.hypot(record.vx, record.vz) + record.radius * np.abs(record.omega)
    where = np.argmax(np.where(record.after_event, speed, 0.0))
    faster = {column: getattr(record, column).copy() for column in ("vx", "vz", "omega")}
    for values in faster.values():
        values[where] *= 1.1
    faster = dataclasses.replace(record, **faster)
    for found in (balances.violations(faster), balances.gained(faster)):
        assert any("gained across an event" in line for line in found), found
    assert balances.gained(record) == []


@pytest.mark.parametrize(
    "outcome",
    [
        Outcome(-9, "", "", 8.0),
        Outcome(-11, "", "", 0.1),
        Outcome(1, "", "Traceback (most recent call last):\nValueError: no", 0.1),
        Outcome(2, "", "stickslip: one\nstickslip: two\n", 0.1),
        Outcome(2, "half a result", "stickslip: one\n", 0.1),
        Outcome(3, "", "", 0.1),
    ],
)
def test_a_command_that_ends_badly_is_found(outcome):
    assert wrong(outcome)
    assert not wrong(Outcome(2, "", "stickslip: drive.peak = nan: allowed is ...\n", 0.1))


def test_files_are_sound_until_they_are_damaged(tmp_path):
    for kind, original in originals().items():
        folder = tmp_path / kind
        folder.mkdir()
        for name, content in original.files.items():
            (folder / name).write_bytes(content)
        # A diagnosis that goes on is interrupted: what matters is that it has read its files.
        assert command(folder, original.command).code in (0, 130), kind


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_file_is_read_or_refused_in_one_line(kind):
    assert check_file(f"{kind}:0:0")["failures"] == []


def test_a_process_that_hangs_or_crashes_is_ended_and_the_search_continues():
    def deaf():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        time.sleep(60)

    work = [
        ("deaf", deaf),
        ("slow", partial(time.sleep, 60)),
        ("crash", partial(os._exit, 3)),
        ("sound", lambda: {"a": 1}),
    ]
    ends = dict(run_all(work, jobs=4, seconds=0.5, until=time.monotonic() + 60))
    assert {name: end.how for name, end in ends.items()} == {
        "deaf": "hang",
        "slow": "slow",
        "crash": "crash",
        "sound": "done",
    }
    assert ends["sound"].result == {"a": 1}


def test_an_interrupted_search_is_continued(tmp_path, capsys):
    common = ["--check", "status", "--population", "paper,wild", "--out", str(tmp_path)]
    assert main([*common, "--count", "1", "--jobs", "2"]) == 0
    first = (tmp_path / "found.jsonl").read_text()
    assert len(first.splitlines()) == 2
    assert main([*common, "--count", "2", "--jobs", "2", "--resume"]) == 0
    whole = (tmp_path / "found.jsonl").read_text()
    assert whole.startswith(first)
    assert len(whole.splitlines()) == 4
    assert (tmp_path / "summary.json").exists()
    assert "status       paper" in capsys.readouterr().out
