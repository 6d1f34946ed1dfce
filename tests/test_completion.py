"""What bash, zsh and fish complete, asked as their scripts ask."""

import os
import re
import shutil
import subprocess
import sys

import click
import pytest
from click.shell_completion import get_completion_class

import command_line
from stickslip import COIL_NAMES, Scenario, _core, effects
from stickslip.cli import COMPLETION
from stickslip.cli.commands import COMMANDS, stickslip
from stickslip.cli.completion import answer
from stickslip.simulation.columns import NUMBERS

SHELLS = ("bash", "zsh", "fish")
NAMES = list(Scenario.keys())
MODES = next(row["allowed"] for row in _core.choices() if row["key"] == "drive.mode")


def asked(shell, words):
    """The environment in which the script of a shell asks how the last of the words goes on."""
    if shell == "fish":  # which gives the line and its last word
        return {"COMP_WORDS": " ".join(words), "COMP_CWORD": words[-1]}
    if shell == "bash":  # which takes these signs for words of their own
        words = [part for word in words for part in re.split("([=:]+)", word) if part or not word]
    return {"COMP_WORDS": "\n".join(words), "COMP_CWORD": str(len(words) - 1)}


def answers(shell, words, monkeypatch):
    """What a shell is answered, as the whole last word: kind and text of each answer, sorted."""
    for name, value in asked(shell, words).items():
        monkeypatch.setenv(name, value)
    shell_class = get_completion_class(shell)
    lines = shell_class(stickslip, {}, "stickslip", COMPLETION).complete().splitlines()
    if shell == "zsh":
        return sorted(zip(lines[::3], lines[1::3], strict=True))
    before = ""
    if shell == "bash":  # which keeps what is before the last of its signs
        before = re.match("(?:.*[=:])?", words[-1]).group()
    pairs = [line.partition("\t")[0].partition(",")[::2] for line in lines]
    return sorted((kind, before + text if kind == "plain" else text) for kind, text in pairs)


def keys_with(start):
    return [name for name in NAMES if name.startswith(start)]


def plain(texts):
    return sorted(("plain", text) for text in texts)


CASES = {
    "commands": (["r"], [name for name in COMMANDS if name.startswith("r")]),
    "option": (["run", "s.toml", "--un"], ["--until"]),
    "key": (["run", "s.toml", "--set", "robot.m"], [f"{k}=" for k in keys_with("robot.m")]),
    "joined": (["run", "s.toml", "--set=robot.m"], [f"--set={k}=" for k in keys_with("robot.m")]),
    "word": (["run", "s.toml", "--set", "drive.mode="], [f"drive.mode={w}" for w in MODES]),
    "begun": (["run", "s.toml", "--set", "drive.mode=I"], ["drive.mode=IPP"]),
    "joined word": (["run", "s.toml", "--set=drive.mode=I"], ["--set=drive.mode=IPP"]),
    "number": (["run", "s.toml", "--set", "drive.peak="], []),
    "no key": (["run", "s.toml", "--set", "drive.moed="], []),
    "after others": (
        ["sweep", "s.toml", "--vary", "drive.peak=1e-3:2e-3:3", "--vary", "coil.t"],
        [f"{k}=" for k in keys_with("coil.t")],
    ),
    "first of a list": (["sweep", "s.toml", "--vary", "drive.edge=r"], ["drive.edge=rise"]),
    "rest of a list": (
        ["sweep", "s.toml", "--vary", "drive.mode=OPP,"],
        [f"drive.mode=OPP,{word}" for word in MODES if word != "OPP"],
    ),
    "recorded": (["run", "s.toml", "--set", "record.fields=x,omeg"], ["record.fields=x,omega"]),
    "free": (
        ["optimise", "s.toml", "--free", "drive.ed"],
        [f"{k}=" for k in keys_with("drive.ed")],
    ),
    "limit": (
        ["optimise", "s.toml", "--limit", "field"],
        [f"{name}=" for name in NUMBERS if name.startswith("field")],
    ),
    "figure": (["optimise", "s.toml", "--maximise", "power"], ["power_mean"]),
    "coil": (["optimise", "s.toml", "--coils", "clamp,x"], ["clamp,xm", "clamp,xp"]),
    "effect": (["effects", "s"], [each.name for each in effects() if each.name.startswith("s")]),
    "section": (["keys", "rob"], ["robot", *keys_with("robot.")]),
}


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.parametrize("case", CASES)
def test_words_are_completed(monkeypatch, shell, case):
    words, expected = CASES[case]
    assert {"clamp", "xm", "xp"} <= set(COIL_NAMES)
    assert answers(shell, ["stickslip", *words], monkeypatch) == plain(expected)


@pytest.mark.parametrize("shell", SHELLS)
def test_every_key_of_the_model_is_offered_but_laws_of_a_free_shape(monkeypatch, shell):
    found = answers(shell, ["stickslip", "run", "s.toml", "--set", ""], monkeypatch)
    hidden = [name for name in NAMES if name.startswith("effects.free_")]
    assert found == plain(f"{k}=" for k in ({"drive.file", "coil.map", *NAMES} - {*hidden}))
    found = answers(shell, ["stickslip", "run", "s.toml", "--set", "effects.free_d"], monkeypatch)
    assert found == plain(f"{k}=" for k in keys_with("effects.free_d"))
    found = answers(shell, ["stickslip", "sweep", "s.toml", "--vary", "drive.f"], monkeypatch)
    assert found == plain(f"{k}=" for k in keys_with("drive.f"))  # no voltages


@pytest.mark.parametrize("shell", SHELLS)
def test_files_and_folders_are_left_to_the_shell(monkeypatch, shell):
    for words, kind in (
        (["run", "s"], "file"),
        (["run", "s.toml", "--out", "a"], "file"),
        (["predict", "s.toml", "--uncertain", "m"], "file"),
        (["diagnose", "m.toml", "--out", "f"], "dir"),
    ):
        assert answers(shell, ["stickslip", *words], monkeypatch) == [(kind, words[-1])]


@pytest.mark.parametrize("shell", SHELLS)
def test_files_of_voltages_come_behind_their_key(monkeypatch, tmp_path, shell):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "volts").mkdir()
    for name in ("volts.csv", "volts.txt", "other.csv", "volts/two.csv"):
        (tmp_path / name).touch()
    for start, expected in (("v", ["volts.csv", "volts/"]), ("volts/", ["volts/two.csv"])):
        words = ["stickslip", "run", "s.toml", "--set", f"drive.file={start}"]
        expected = plain(f"drive.file={name}" for name in expected)
        assert answers(shell, words, monkeypatch) == expected


@pytest.mark.parametrize("shell", SHELLS)
def test_the_command_prints_the_script_of_a_shell_and_answers_it(monkeypatch, shell):
    monkeypatch.setenv(COMPLETION, f"{shell}_source")
    done = command_line.stickslip()
    assert (done.returncode, done.stderr) == (0, "")
    script = get_completion_class(shell)(stickslip, {}, "stickslip", COMPLETION).source()
    assert done.stdout == script
    for name, value in asked(shell, ["stickslip", "swe"]).items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv(COMPLETION, f"{shell}_complete")
    done = command_line.stickslip()
    assert (done.returncode, done.stderr) == (0, "")
    assert "sweep" in done.stdout
    assert "predict" not in done.stdout


def test_the_scripts_are_clicks_with_the_changes_for_key_and_value(monkeypatch):
    # They are changes of click's text, which another version of click may have in other words.
    changes = {"bash": "compopt -o nospace", "zsh": '-S ""', "fish": "--max 1"}
    for shell, change in changes.items():
        script = get_completion_class(shell)(stickslip, {}, "stickslip", COMPLETION).source()
        assert change in script


def test_an_unknown_instruction_is_a_failure():
    assert answer(click.Command("stickslip"), "sh_source") == 1


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_takes_the_answers(tmp_path):
    command = tmp_path / "stickslip"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m stickslip "$@"\n')
    command.chmod(0o755)
    script = (
        f'eval "$({COMPLETION}=bash_source stickslip)"\n'
        "COMP_WORDS=(stickslip keys drive.fre)\nCOMP_CWORD=2\n"
        '_stickslip_completion stickslip\necho "${COMPREPLY[*]}"\n'
    )
    done = subprocess.run(
        ["bash", "--norc", "-c", script],
        env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.stdout, done.stderr) == ("drive.frequency\n", "")
