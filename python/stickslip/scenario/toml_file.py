"""Scenario files: TOML."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from stickslip import _core
from stickslip._util.files import read_bytes, text_writer, write_together
from stickslip._util.messages import refuse, shown, suggestion
from stickslip._util.text import literal, printable
from stickslip._util.toml import parse_toml
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.effects import flat_effects
from stickslip.scenario.held import OBJECTS, PATHS, TABLES, with_files
from stickslip.scenario.keys import (
    IDLE,
    MEASURED,
    PROGRAM,
    Key,
    Value,
    find_key,
    is_of_one_coil,
    keys_of,
    known_keys,
)
from stickslip.scenario.law import flat_laws, law_lines, laws_of
from stickslip.scenario.sections import SECTIONS, Coil, Robot
from stickslip.scenario.uncertain import JointPrior

FORMAT_VERSION = 1

# Chosen: a scenario is a page of text; what is longer is another file, or a device without end.
_MOST_BYTES = 1 << 20


class Written(Protocol):
    """A scenario, as its file needs it: `Scenario` imports this module, hence a protocol."""

    def to_core(self) -> _core.Scenario: ...
    @property
    def held(self) -> Mapping[str, Any]: ...
    @property
    def uncertain(self) -> JointPrior | None: ...


class Stated(NamedTuple):
    """A scenario's file as it was read."""

    changes: dict[str, Any]  # by dotted key, as `Scenario.replace` takes them
    held: dict[str, Any]  # objects that a section states, by their keys
    uncertain: Any  # the section
    files: list[Path]  # that it names


def read_document(
    path: Path, kind: str = "scenario", has: str = '"stickslip = 1" and a section [drive]'
) -> dict[str, Any]:
    """The TOML of a file; `kind` and `has` are words of its errors, which do not name the file."""
    data = read_bytes(path, _MOST_BYTES, f"{kind} file")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(
            f"is no text: byte {error.start + 1} is not UTF-8; a {kind} is a TOML file"
        ) from None
    if not text.strip():
        raise ScenarioError(f"is empty; a {kind} has {has}")
    return parse_toml(text)


def stated(document: Mapping[str, Any], folder: Path | None) -> Stated:
    """The scenario of a document; without a folder, for its paths, no file is read."""
    _check_version(document)
    known = [*SECTIONS, "effects", "laws", *TABLES, "uncertain"]
    changes: dict[str, Any] = {}
    for name, content in document.items():
        if name == "stickslip":
            continue
        if name not in known:
            raise ScenarioError(
                f"[{name}] = {shown(content)}: there is no such section; {suggestion(name, known)}"
            )
        if not isinstance(content, dict):
            raise ScenarioError(f"{name} = {shown(content)}: allowed is a section [{name}]")
        if name == "effects":
            changes |= flat_effects(content)
        elif name == "laws":
            changes |= flat_laws(content)
        elif name not in (*TABLES, "uncertain"):
            _flatten(name, _made(name, content), changes)
    if "drive" not in document:
        raise ScenarioError("[drive] is missing: it is required, if only as an empty section")
    if folder is None:
        changes = {key: value for key, value in changes.items() if key not in PATHS}
    files = [] if folder is None else with_files(changes, folder)
    held = {key: each.read(document[key]) for key, each in TABLES.items() if key in document}
    return Stated(changes, held, document.get("uncertain"), files)


def _made(section: str, table: Mapping[str, Any]) -> Mapping[str, Any]:
    """The keys of a section that has words of `Robot.of` or `Coil.of`; others count as they are."""
    make: Any = {"coil": Coil.of, "robot": Robot.of}.get(section)
    if make is None:
        return table
    words = inspect.signature(make).parameters
    keys = [key.name.rpartition(".")[2] for key in keys_of(section)]
    first = next((name for name in table if name in words and name not in keys), None)
    if first is None:
        return table
    if first in MEASURED and "field_per_ampere" not in table:
        allowed = f"{MEASURED[first]} in its place, or coil.field_per_ampere beside it"
        refuse(f"coil.{first}", table[first], allowed)
    if section == "coil" and "turns" in table:
        refuse("coil.turns", table["turns"], "none beside coil.field_per_ampere, which gives it")
    others = {name: value for name, value in table.items() if name not in words}
    with prefixed(f"[{section}]"):
        made = make(**{name: table[name] for name in words if name in table})
    return {key: getattr(made, key) for key in keys} | others


def _flatten(section: str, table: Mapping[str, Any], changes: dict[str, Any]) -> None:
    """Add the values of a section and its tables by dotted key; refuse unknown keys."""
    for name, value in table.items():
        key = f"{section}.{name}"
        if keys_of(key):
            if not isinstance(value, dict):
                refuse(key, value, f"a table [{key}]")
            _flatten(key, value, changes)
        elif key in PATHS:
            changes[key] = value
        elif key in OBJECTS:
            held = OBJECTS[key]
            raise ScenarioError(
                f"{key} = {shown(value)}: there is no such key but {held.file}; {held.about}"
            )
        else:
            changes[find_key(key, value).name] = value


def _check_version(document: Mapping[str, Any]) -> None:
    if "stickslip" not in document and "stickslip_measurement" in document:
        raise ScenarioError(
            "is a measurement and no scenario; predict takes its uncertain parameters with "
            "--uncertain FILE"
        )
    if "stickslip" not in document:
        raise ScenarioError(f'stickslip is missing: a scenario has "stickslip = {FORMAT_VERSION}"')
    version = document["stickslip"]
    if isinstance(version, bool) or not isinstance(version, int) or version != FORMAT_VERSION:
        refuse("stickslip", version, f"{FORMAT_VERSION}, the version of the format")


def files_of(scenario: Written, path: Path | None, voltages: str | None = None) -> dict[str, str]:
    """Names of the files of a scenario's objects beside its own at `path`, by the objects' keys.

    `voltages` is another ending for those of a drive.
    """
    stem = "" if path is None else f"{path.stem}."
    endings = {key: held.ending for key, held in OBJECTS.items() if key in scenario.held}
    if voltages is not None and PROGRAM in endings:
        endings[PROGRAM] = voltages
    return {key: f"{stem}{ending}" for key, ending in endings.items()}


def write_scenario(scenario: Written, path: Path, comments: Sequence[str] = ()) -> str:
    """Write the scenario's file, and its objects' beside it; return the text.

    `comments` are lines at its top, without their ``#``.
    """
    write_together(scenario_writers(scenario, path, comments))
    return scenario_text(scenario, files_of(scenario, path), comments)


def scenario_writers(
    scenario: Written, path: Path, comments: Sequence[str] = (), voltages: str | None = None
) -> dict[Path, Callable[[Path], object]]:
    """Writers of all files of a scenario, for `write_together`; see `files_of`."""
    files = files_of(scenario, path, voltages)
    return {
        path: text_writer(scenario_text(scenario, files, comments)),
        **{path.with_name(file): scenario.held[key].write for key, file in files.items()},
    }


def scenario_text(scenario: Written, files: Mapping[str, str], comments: Sequence[str] = ()) -> str:
    """The TOML text, with the files that its objects are in by their keys."""
    core = scenario.to_core()
    changed = core.changed()
    given = {key.partition(".")[0] for key in (*changed, *files)}
    left_out = {"initial", "inner", "shake"} - given
    idle = IDLE.get(str(core.get("drive.mode")), ())
    lines = [*(f"# {printable(line)}" for line in comments), f"stickslip = {FORMAT_VERSION}"]
    for section in dict.fromkeys(key.section for key in known_keys().values()):
        keys = list(keys_of(section))
        if section.startswith("effects.") or is_of_one_coil(keys[0].name):
            keys = [key for key in keys if key.name in changed]
        if section in left_out or not keys:
            continue
        lines += ["", f"[{section}]"]
        lines += [_line(key, core.get(key.name)) for key in keys if key.name not in idle]
        for key, file in files.items():
            if OBJECTS[key].section == section:
                lines.append(f"{OBJECTS[key].file.partition('.')[2]} = {literal(file)}")
    for name, law in laws_of(core):
        lines += law_lines(name, law)
    for key, held in scenario.held.items():
        lines += [] if key in OBJECTS else ["", *held.lines]
    if scenario.uncertain is not None:
        lines += _uncertain_lines(scenario.uncertain)
    return "\n".join(lines) + "\n"


def _uncertain_lines(uncertain: JointPrior) -> list[str]:
    lines = ["", "[uncertain]"]
    for key, prior in uncertain.priors.items():
        numbers = ", ".join(f"{of} = {literal(float(one))}" for of, one in prior.table.items())
        lines.append(f"{literal(key)} = {{ {numbers} }}")
    if uncertain.keys:
        lines += ["", "[uncertain.covariance]", "keys = ["]
        lines += [f"    {literal(key)}," for key in uncertain.keys]
        lines += ["]", "matrix = ["]
        lines += [f"    {literal(row)}," for row in uncertain.matrix]
        lines.append("]")
    return lines


def _line(key: Key, value: Value) -> str:
    comment = "" if key.unit == "-" or isinstance(value, str) else f"  # {key.unit}"
    return f"{key.name.rpartition('.')[2]} = {literal(value)}{comment}"
