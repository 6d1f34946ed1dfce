"""Scenario files: reading and writing TOML."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip._util.files import read_bytes, text_writer, write_together
from stickslip._util.text import printable, quoted
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import Value, field_of, known_keys, refuse, shown, suggestion
from stickslip.scenario.named_effects import PREFIX, EffectSettings
from stickslip.scenario.path_keys import COIL_MAP, FILE, PATHS, PROGRAM, PROGRAM_HINT
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.section_table import SECTIONS
from stickslip.scenario.sections import COIL_NAMES, SAWTOOTH, Coil, refuse_sawtooth
from stickslip.scenario.toml_text import parse_toml

if TYPE_CHECKING:
    from stickslip.field.field_map import FieldMap
    from stickslip.scenario.uncertain import JointPrior
    from stickslip.scenario.waveform import Waveform

FORMAT_VERSION = 1

# Chosen: a scenario is a page of text; what is longer is another file, or a device without end.
_MOST_BYTES = 1 << 20


def read_scenario(path: str | PathLike[str]) -> Scenario:
    """See `Scenario.from_toml`."""
    parts = read_parts(path, {})
    with prefixed(path):
        return Scenario(**parts)


def with_uncertain_of(scenario: Scenario, path: str | PathLike[str]) -> Scenario:
    """The scenario with what is uncertain in a file: a scenario, or any TOML with ``[uncertain]``.

    See `Scenario.with_uncertain`. A ScenarioError if the file has none, or cannot be read.
    """
    path = Path(path)
    with prefixed(path):
        document = read_document(path)
        if "uncertain" not in document:
            raise ScenarioError("there is no section [uncertain]")
        if "stickslip" in document:
            return scenario.with_uncertain(Scenario(**_parts(document, path.parent, {})))
        return scenario.with_uncertain(document["uncertain"])


def read_parts(path: str | PathLike[str], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The sections of a file as `Scenario` takes them, with other values.

    `changes` are values that are allowed, as `Scenario.replace` takes them. What the file has in
    their place is not checked: it is not simulated. Anything else there that is not allowed is a
    ScenarioError, and so is a file that cannot be read.
    """
    path = Path(path)
    with prefixed(path):
        return _parts(read_document(path), path.parent, changes)


def scenario_of(text: str, program: Waveform | None, field_map: FieldMap | None) -> Scenario:
    """The scenario of what `scenario_text` gave, whose voltages and map are apart from it."""
    changes: dict[str, Any] = {}
    if program is not None:
        changes |= {PROGRAM: program, "drive.mode": "program"}
    if field_map is not None:
        changes[COIL_MAP] = field_map
    return Scenario(**_parts(parse_toml(text), Path(), changes))


def named_files(path: Path) -> dict[str, Path]:
    """The files that an ordinary scenario file takes voltages or a map from, by key."""
    try:
        document = read_document(path) if path.is_file() else {}
    except ScenarioError:
        return {}
    found = {}
    for key in PATHS:
        section, name = key.split(".")
        values = document.get(section)
        file = values.get(name) if isinstance(values, dict) else None
        if isinstance(file, str):
            found[key] = path.parent / file
    return found


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


def _parts(document: dict[str, Any], folder: Path, changes: Mapping[str, Any]) -> dict[str, Any]:
    _check_version(document)
    known = [*SECTIONS, "effects", "uncertain"]
    for name, content in document.items():
        if name == "stickslip":
            continue
        if name not in known:
            raise ScenarioError(
                f"[{name}] = {shown(content)}: there is no such section; {suggestion(name, known)}"
            )
        if not isinstance(content, dict):
            raise ScenarioError(f"{name} = {shown(content)}: allowed is a section [{name}]")
    if "drive" not in document:
        raise ScenarioError("[drive] is missing: it is required, if only as an empty section")

    parts: dict[str, Any] = {}
    for name, section in SECTIONS.items():
        values = dict(document.get(name, {}))
        single = _single_coils(values) if name == "coil" else {}
        _check_fields(name, values)
        own = {key.partition(".")[2]: changes[key] for key in changes if key.startswith(f"{name}.")}
        if name == "drive":
            values = _drive(values, own, folder)
        if "map" in values and name == "coil":
            file = values.pop("map")
            if "map" not in own:
                values["map"] = _field_map(file, folder)
        if name == "coil":
            parts[name] = _coil(values, single, own)
            continue
        parts[name] = section(**{field_of(key): value for key, value in (values | own).items()})
    parts["effects"] = EffectSettings(_effects(document.get("effects"), changes))
    parts["uncertain"] = document.get("uncertain")
    return parts


def _drive(values: dict[str, Any], own: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The values of a file's [drive] except those in `own`, with its voltages as a program."""
    if own.get("program") is not None:
        return {field: value for field, value in values.items() if field == "direction"}
    left = {field: value for field, value in values.items() if field not in own}
    if "file" in left or "mode" not in own:
        refuse_sawtooth(own.get("mode", values.get("mode")), [f"drive.{field}" for field in left])
    if "file" in left:
        file = left.pop("file")
        if "program" not in own:
            left["program"] = _program(file, folder)
    return left


def _single_coils(values: dict[str, Any]) -> dict[str, Any]:
    """The tables [coil.xp] .., which are taken out of the values of [coil]."""
    single = {name: values.pop(name) for name in COIL_NAMES if name in values}
    for name, table in single.items():
        if not isinstance(table, dict):
            refuse(f"coil.{name}", table, f"a table [coil.{name}]")
        _check_fields(f"coil.{name}", table)
    return single


def _coil(values: dict[str, Any], single: dict[str, Any], own: Mapping[str, Any]) -> Coil:
    """The coils of a file with other values, in whose place those of the file are not checked."""
    left = {key: value for key, value in values.items() if key not in own}
    for name, table in single.items():
        given = {key: table[key] for key in table if not {key, f"{name}.{key}"} & own.keys()}
        left[name] = given
    changed = {key: value for key, value in own.items() if key != "map"}
    if "map" in own:
        left["map"] = own["map"]
    return Coil(**left).with_values(changed)


def _effects(table: Any, changes: Mapping[str, Any]) -> Any:
    """A file's effects with other values; what is not a table stays, and is refused later."""
    for key, value in changes.items():
        if not key.startswith(PREFIX) or not isinstance(table, dict | None):
            continue
        _, name, parameter = key.split(".", 2)
        settings = (table or {}).get(name, {})
        if isinstance(settings, dict):
            table = {**(table or {}), name: {**settings, parameter: value}}
    return table


def _check_version(document: dict[str, Any]) -> None:
    if "stickslip" not in document and "stickslip_measurement" in document:
        raise ScenarioError(
            "is a measurement and no scenario; predict takes what is uncertain there from "
            "--uncertain FILE"
        )
    if "stickslip" not in document:
        raise ScenarioError(f'stickslip is missing: a scenario has "stickslip = {FORMAT_VERSION}"')
    version = document["stickslip"]
    if isinstance(version, bool) or not isinstance(version, int) or version != FORMAT_VERSION:
        refuse("stickslip", version, f"{FORMAT_VERSION}, the version of the format")


def _check_fields(section: str, values: Mapping[str, object]) -> None:
    known = [key.name for key in known_keys().values() if key.section == section]
    known += [key for key in PATHS if key.startswith(f"{section}.")]
    for field, value in values.items():
        key = f"{section}.{field}"
        if key not in known:
            hint = PROGRAM_HINT if key == PROGRAM else suggestion(key, known)
            raise ScenarioError(f"{key} = {shown(value)}: there is no such key; {hint}")


def _program(file: object, folder: Path) -> Waveform:
    from stickslip.scenario.waveform import Waveform

    if not isinstance(file, str) or not file:
        refuse(FILE, file, "the path of a CSV file")
    path = folder / file
    try:
        return Waveform.from_csv(path)
    except ScenarioError as error:
        reason = str(error).removeprefix(printable(f"{path}: "))
        raise ScenarioError(f"drive.file = {shown(file)}: {reason}") from None


def _field_map(file: object, folder: Path) -> FieldMap:
    from stickslip.field.field_map import FieldMap

    if not isinstance(file, str) or not file:
        refuse(COIL_MAP, file, "the path of a CSV or netCDF file")
    path = folder / file
    try:
        return FieldMap.from_file(path)
    except ScenarioError as error:
        reason = str(error).removeprefix(printable(f"{path}: "))
        raise ScenarioError(f"{COIL_MAP} = {shown(file)}: {reason}") from None


def write_scenario(
    scenario: Scenario, path: str | PathLike[str], comments: Sequence[str] = ()
) -> str:
    """Write the scenario's file, and its voltages and map beside it; return the text.

    `comments` are lines at its top, without their ``#``.
    """
    text, writers = scenario_writers(scenario, Path(path), comments)
    write_together(writers)
    return text


def files_beside(path: Path) -> tuple[Path, Path]:
    """Where the voltages and the map of a scenario that is written to `path` go."""
    return path.with_name(f"{path.stem}.voltages.csv"), path.with_name(f"{path.stem}.map.json")


def scenario_writers(
    scenario: Scenario, path: Path, comments: Sequence[str] = ()
) -> tuple[str, dict[Path, Callable[[Path], object]]]:
    """The text of a scenario's file, and what `write_together` needs for all its files."""
    voltages, field_map = files_beside(path)
    text = "".join(f"# {printable(line)}\n" for line in comments)
    text += scenario_text(scenario, voltages.name, field_map.name)
    writers = {path: text_writer(text)}
    if scenario.drive.program is not None:
        from stickslip.scenario.waveform_csv import write_rows

        writers[voltages] = functools.partial(write_rows, scenario.drive.program)
    if scenario.coil.map is not None:
        from stickslip.field.map_files import map_text

        writers[field_map] = text_writer(map_text(scenario.coil.map))
    return text, writers


def scenario_text(
    scenario: Scenario, voltages: str = "voltages.csv", field_map: str = "map.json"
) -> str:
    """The TOML text, with the files that a program's voltages and the coils' map are in."""
    lines = [f"stickslip = {FORMAT_VERSION}"]
    for section, kind in SECTIONS.items():
        if section == "initial" and scenario.initial == kind():
            continue
        lines += ["", f"[{section}]"]
        for field in dataclasses.fields(kind):
            name = field.name.removesuffix("_")
            key = f"{section}.{name}"
            idle = scenario.drive.mode == "program" and key in SAWTOOTH
            if key in known_keys() and not idle:
                lines.append(_line(name, scenario.get(key), known_keys()[key].unit))
        if section == "drive" and scenario.drive.program is not None:
            lines.append(_line("file", voltages, "-"))
        if section == "coil" and scenario.coil.map is not None:
            lines.append(_line("map", field_map, "-"))
        if section == "coil":
            lines += _lines_of_single_coils(scenario.coil)
    for name, parameters in scenario.effects.items():
        lines += ["", f"[effects.{name}]"]
        for parameter, value in parameters.items():
            unit = known_keys()[f"effects.{name}.{parameter}"].unit
            lines.append(_line(parameter, value, unit))
    if scenario.uncertain is not None:
        lines += _uncertain_lines(scenario.uncertain)
    return "\n".join(lines) + "\n"


def _lines_of_single_coils(coil: Coil) -> list[str]:
    lines = []
    own = coil.own_values()
    for name in dict.fromkeys(key.split(".")[1] for key in own):
        start = f"coil.{name}."
        lines += ["", f"[coil.{name}]"]
        lines += [
            _line(key.removeprefix(start), value, known_keys()[key].unit)
            for key, value in own.items()
            if key.startswith(start)
        ]
    return lines


def _uncertain_lines(uncertain: JointPrior) -> list[str]:
    lines = ["", "[uncertain]"]
    for key, prior in uncertain.priors.items():
        numbers = ", ".join(f"{name} = {float(value)!r}" for name, value in prior.table.items())
        lines.append(f"{quoted(key)} = {{ {numbers} }}")
    if uncertain.keys:
        lines += ["", "[uncertain.covariance]", "keys = ["]
        lines += [f"    {quoted(key)}," for key in uncertain.keys]
        lines += ["]", "matrix = ["]
        lines += [f"    {list(row)!r}," for row in uncertain.matrix]
        lines.append("]")
    return lines


def _line(name: str, value: Value, unit: str) -> str:
    text = quoted(value) if isinstance(value, str) else repr(value)
    comment = "" if unit == "-" or isinstance(value, str) else f"  # {unit}"
    return f"{name} = {text}{comment}"


def load(path: str | PathLike[str]) -> Scenario:
    """Read a scenario file; the same as `Scenario.from_toml`."""
    return Scenario.from_toml(path)
