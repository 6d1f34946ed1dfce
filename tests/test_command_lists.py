"""What the command lists: keys, effects, commands and columns, by search and by what was meant."""

import json
import re

import click
import pytest

from command_line import check, stickslip
from stickslip import Scenario, effects
from stickslip.cli.commands import COMMANDS
from stickslip.cli.commands import stickslip as group
from stickslip.simulation.columns import NUMBERS

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 12\n"


def test_keys_lists_all_or_those_of_a_section():
    listed = json.loads(stickslip("keys", "--json").stdout, parse_constant=pytest.fail)["keys"]
    assert [each["key"] for each in listed] == list(Scenario.keys())
    for each in listed:
        assert each["default"] == Scenario().get(each["key"])
        assert each["meaning"]
        assert each["unit"]
    text = stickslip("keys", "drive").stdout
    assert "frequency = 100.0 Hz" in text
    assert "turns" not in text
    effects_text = stickslip("keys", "effects").stdout
    assert "[effects.surface_tilt]" in effects_text
    assert "[drive]" not in effects_text


def listed(kind, *words):
    """What a search prints as JSON; its text names the same, and nothing else."""
    done = stickslip(kind, *words, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout, parse_constant=pytest.fail)[kind]
    text = stickslip(kind, *words).stdout
    if kind == "effects":
        assert re.findall(r"^\[effects\.(.*)\]$", text, re.MULTILINE) == [
            each["name"] for each in found
        ]
    else:
        sections = dict.fromkeys(each["key"].rpartition(".")[0] for each in found)
        assert re.findall(r"^\[(.*)\]$", text, re.MULTILINE) == list(sections)
        assert len(re.findall(r"^    \w+ = ", text, re.MULTILINE)) == len(found)
    return found


def test_keys_are_found_by_a_word_of_their_name_or_meaning():
    everything = listed("keys")
    for word in ("friction", "Friction", "mass", "corner"):
        wanted = [
            each["key"]
            for each in everything
            if word.lower() in each["key"].lower() or word.lower() in each["meaning"].lower()
        ]
        assert len(wanted) > 1
        assert [each["key"] for each in listed("keys", word)] == wanted
    assert [each["key"] for each in listed("keys", "static friction")] == [
        "contact.static_friction"
    ]


@pytest.mark.parametrize(
    ("word", "key"),
    [
        ("drive.frequency", "drive.frequency"),
        ("surface_tilt.angle", "effects.surface_tilt.angle"),
        ("drive.file", "drive.mode"),  # beside which the file of voltages is explained
    ],
)
def test_one_key_can_be_listed(word, key):
    (found,) = listed("keys", word)
    assert (found["key"], found["default"]) == (key, Scenario().get(key))


def test_effects_are_found_by_a_word_of_their_name_or_meaning():
    names = [each["name"] for each in listed("effects", "drag")]
    assert names == ["angle_drag", "quadratic_drag", "rotational_drag"]
    wanted = [
        each.name
        for each in effects()
        if not each.name.startswith("free_") and "coil" in f"{each.name} {each.meaning}"
    ]
    assert [each["name"] for each in listed("effects", "coil")] == wanted
    # Laws of a free shape, where nothing else has the word.
    free = [each.name for each in effects() if each.name.startswith("free_")]
    assert [each["name"] for each in listed("effects", "free_")] == free
    assert [each["name"] for each in listed("effects", "effects.surface_tilt")] == ["surface_tilt"]


MEANT = {
    "command": (["rnu"], "run"),
    "option": (["run", "scenario.toml", "--sett", "drive.peak=0"], "--set"),
    "option of the group": (["--verison"], "--version"),
    "option with a value": (["sweep", "scenario.toml", "--var=drive.peak=0,1e-3"], "--vary"),
    "key": (["keys", "drive.frequncy"], "drive.frequency"),
    "last word of a key": (["keys", "frequncy"], "drive.frequency"),
    "section": (["keys", "drives"], "drive"),
    "word of names": (["keys", "fricton"], "friction"),
    "key in another case": (["run", "scenario.toml", "--set", "Drive.Peak=0"], "drive.peak"),
    "bare key": (["run", "scenario.toml", "--set", "mode=IPP"], "drive.mode"),
    "effect": (["effects", "surface_tlt"], "surface_tilt"),
    "word of effects": (["effects", "drg"], "drag"),
    "key of an effect": (
        ["run", "scenario.toml", "--set", "effects.surface_tlt.angle=0"],
        "effects.surface_tilt.angle",
    ),
    "word": (["run", "scenario.toml", "--set", "drive.mode=IPPP"], "IPP"),
    "word in another case": (["run", "scenario.toml", "--set", "drive.mode=opp"], "OPP"),
    "recorded rate": (["run", "scenario.toml", "--set", "record.rate=event"], "events"),
    "recorded type": (["run", "scenario.toml", "--set", "record.dtype=float46"], "float64"),
    "recorded field": (["run", "scenario.toml", "--set", "record.fields=thta"], "theta"),
    "varied word": (["sweep", "scenario.toml", "--vary", "drive.edge=rise,fal"], "fall"),
    "figure": (["optimise", "scenario.toml", "--maximise", "mean_velocty"], "mean_velocity"),
    "coil": (
        [
            *("optimise", "scenario.toml", "--maximise", "mean_velocity", "--knots", "4"),
            *("--limit", "voltage_max=9", "--coils", "clmap"),
        ],
        "clamp",
    ),
    "figure of the paper": (["reproduce", "--only", "fig88"], "fig8"),
}


@pytest.mark.parametrize("name", MEANT)
def test_what_was_meant_is_said(scenario, tmp_path, name):
    arguments, wanted = MEANT[name]
    check(stickslip(*arguments, cwd=tmp_path), f'did you mean "{wanted}"?')


def test_what_there_is_is_said_where_nothing_is_like_it():
    for name in COMMANDS:
        check(stickslip("wxyz"), f'"{name}"')
    check(stickslip("run", "s.toml", "--wxyz"), "stickslip run", '"--set"', '"--out"')
    check(stickslip("effects", "wxyz"), '"surface_tilt"')
    check(stickslip("keys", "wxyz"), '"drive"', '"effects"')


def test_one_effect_can_be_listed():
    text = stickslip("effects", "surface_tilt").stdout
    assert text.startswith("[effects.surface_tilt]\n")
    assert text.count("[effects.") == 1
    assert "default 0.0" in text
    (effect,) = (each for each in effects() if each.name == "surface_tilt")
    # Lines may break between words and at hyphens.
    assert "".join(text.split()).endswith("".join(f"source: {effect.source}".split()))


UNITS = {*(each.unit for each in NUMBERS.values()), "mm/s", "degrees", "%", "draws", "1", "-"}


@pytest.mark.parametrize(
    "arguments",
    [
        ["sweep", "scenario.toml"],
        ["predict", "scenario.toml", "--draws=2", "--uncertain=u.toml"],
    ],
)
def test_every_column_of_a_table_has_its_unit(scenario, tmp_path, arguments):
    (tmp_path / "u.toml").write_text('[uncertain]\n"drag.linear" = { low = 1e-6, high = 2e-6 }\n')
    keys = {
        "drive.peak": "2e-3,3e-3",
        "drive.pulses": "4,5",
        "drive.mode": "IPP,OPP",
        "contact.kinetic_friction": "0.1,0.12",
    }
    vary = [f"--vary={key}={values}" for key, values in keys.items()]
    done = stickslip(*arguments, *vary, cwd=tmp_path)
    assert done.returncode == 0
    heading, units, *_ = done.stdout.splitlines()
    # Columns have two spaces between them, and end below each other.
    names = [(each.group(), each.end()) for each in re.finditer(r"\S+(?: \S+)*", heading)]
    below = {each.end(): each.group() for each in re.finditer(r"\S+", units)}
    assert sorted(below) == [end for _, end in names]
    found = {name: below[end] for name, end in names}
    known = {each["key"]: each["unit"] for each in listed("keys")}
    assert set(found.values()) <= {*UNITS, *known.values()}
    assert found["peak"] == known["drive.peak"] == "T"
    assert (found["pulses"], found["kinetic_friction"], found["mode"]) == ("1", "1", "-")
    assert found["mean velocity"] == "mm/s"
    assert found["airborne"] == "%"


def test_effects_lists_every_extension():
    done = stickslip("effects")
    listed = json.loads(stickslip("effects", "--json").stdout, parse_constant=pytest.fail)
    assert done.returncode == 0
    assert [each["name"] for each in listed["effects"]] == [each.name for each in effects()]
    for each in listed["effects"]:
        assert f"[effects.{each['name']}]" in done.stdout
        assert each["source"]
        for parameter in each["parameters"]:
            assert {"key", "unit", "low", "high", "default", "meaning"} <= set(parameter)


def test_the_list_of_commands_has_a_whole_line_for_each(monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    lines = stickslip("--help").stdout.splitlines()
    assert max(map(len, lines)) <= 80
    first = lines.index("Commands:") + 1
    rows = [line.split(maxsplit=1) for line in lines[first : first + len(COMMANDS)]]
    assert dict(rows) == COMMANDS
    assert all(text.endswith(".") and not text.endswith("..") for text in COMMANDS.values())
    context = click.Context(group)
    assert group.list_commands(context) == sorted(COMMANDS)
    for name in COMMANDS:
        assert group.get_command(context, name).name == name


@pytest.mark.parametrize("command", [[], *([name] for name in COMMANDS)])
def test_help_has_an_example(command):
    done = stickslip(*command, "--help")
    assert done.returncode == 0
    assert re.search("Examples?:", done.stdout)
    assert "stickslip " + " ".join(command) in done.stdout


def test_version():
    assert stickslip("--version").stdout == f"stickslip {__import__('stickslip').__version__}\n"
