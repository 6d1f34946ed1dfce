"""What --set replaces in a file is never judged: for every key, by every command that has it."""

import click
import pytest

from command_line import check, stickslip
from stickslip import Scenario, ScenarioError
from stickslip.cli.commands import COMMANDS
from stickslip.cli.commands import stickslip as group
from stickslip.cli.settings import read_with

HEAD = "stickslip = 1\n[drive]\n"
VOLTAGES = "t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n0.02,5,0,0,0,-10\n"

SHORT = ["--set", "drive.pulses=4", "--set", "drive.base=0"]

# What a command needs beside the scenario; the numbers make it short.
COMMANDS_WITH_SET = {
    "run": [],
    "sweep": ["--vary", "drag.linear=1e-6,2e-6"],
    "predict": ["--uncertain", "u.toml", "--draws", "2", "--vary", "drag.linear=1e-6,2e-6"],
    "optimise": [
        *("--maximise", "mean_velocity", "--limit", "voltage_max=40", "--allow-flight"),
        *("--free", "drag.linear=1e-6:2e-6", "--evaluations", "4", "--fresh", "1"),
    ],
}

# Text of the file, and what replaces the part that is wrong in it.
REPLACED = {
    "number": ("frequency = -3\n", ["drive.frequency=100"]),
    "number as word": ('peak = "high"\n', ["drive.peak=2.5e-3"]),
    "word": ('mode = "IPPP"\n', ["drive.mode=IPP"]),
    "table": ("hold = { a = 1 }\n", ["drive.hold=1e-3"]),
    "other section": ("[robot]\nmass = 0\n", ["robot.mass=25e-9"]),
    "two that must agree": (
        "[contact]\nstatic_friction = 0.1\nkinetic_friction = 0.3\n",
        ["contact.static_friction=0.4"],
    ),
    "effect": ("[effects.surface_tilt]\nangle = 9\n", ["effects.surface_tilt.angle=0.01"]),
    "record": ('[record]\nrate = "all"\n', ["record.rate=none"]),
    "initial": ("[initial]\ntheta = nan\n", ["initial.theta=0"]),
    "solver": ('[solver]\nmethod = "euler"\n', ["solver.method=tsit5"]),
    "missing voltages": ('mode = "program"\nfile = "no.csv"\n', ["drive.mode=IPP"]),
}


def test_all_commands_that_have_the_option_are_tried():
    context = click.Context(group)
    having = [
        name
        for name in COMMANDS
        if any("--set" in each.opts for each in group.get_command(context, name).params)
    ]
    assert sorted(COMMANDS_WITH_SET) == having


@pytest.fixture(autouse=True)
def uncertain(tmp_path):
    """What is uncertain, in a file."""
    (tmp_path / "u.toml").write_text(
        '[uncertain]\n"contact.adhesion" = { mean = 0.22e-6, sd = 0.01e-6 }\n'
    )


# All cases with the command that takes least time.
PAIRS = [("run", case) for case in REPLACED] + [
    (command, case)
    for command in COMMANDS_WITH_SET
    for case in ("number", "two that must agree", "missing voltages")
    if command != "run"
]


@pytest.mark.parametrize(("command", "case"), PAIRS)
def test_a_command_takes_a_file_whose_wrong_value_is_replaced(tmp_path, command, case):
    text, settings = REPLACED[case]
    (tmp_path / "s.toml").write_text(HEAD + text)
    options = [*COMMANDS_WITH_SET[command], *SHORT, "--json"]
    # Without what replaces it, the value is refused.
    check(stickslip(command, "s.toml", *options, cwd=tmp_path), "s.toml")
    options += [f"--set={each}" for each in settings]
    done = stickslip(command, "s.toml", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("command", sorted({*COMMANDS_WITH_SET} - {"optimise"}))
def test_voltages_replace_the_drive_of_the_file(tmp_path, command):
    (tmp_path / "v.csv").write_text(VOLTAGES)
    (tmp_path / "s.toml").write_text(f"{HEAD}frequency = -3\n")
    options = [*COMMANDS_WITH_SET[command], "--set=drive.file=v.csv", "--json"]
    done = stickslip(command, "s.toml", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("wrong", ['"wrong"', "[1]", "nan"])
def test_the_value_of_every_key_can_be_replaced(tmp_path, wrong):
    path = tmp_path / "s.toml"
    refused = 0
    for key in Scenario.keys():  # noqa: SIM118
        section, _, name = key.rpartition(".")
        path.write_text(
            HEAD + (f"[{section}]\n" if section != "drive" else "") + f"{name} = {wrong}"
        )
        with pytest.raises(ScenarioError):
            read_with(path, [])
        refused += 1
        value = Scenario().get(key)
        assert read_with(path, [f"{key}={value}"]).get(key) == value
    assert refused == len(list(Scenario.keys()))
