"""Scenario files: TOML."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from stickslip import _core
from stickslip._util.files import read_bytes, text_writer, write_together
from stickslip._util.messages import refuse, shown, suggestion
from stickslip._util.text import printable, quoted
from stickslip._util.toml import parse_toml
from stickslip.errors import ScenarioError
from stickslip.field.field_map import FieldMap
from stickslip.scenario.effects import flat_effects
from stickslip.scenario.keys import (
    ACCELERATIONS,
    COIL_MAP,
    FILE,
    FORCES,
    IDLE,
    INNER_FILE,
    PATHS,
    PROGRAM,
    PROGRAM_HINT,
    SHAKE_FILE,
    Key,
    Value,
    find_key,
    is_of_one_coil,
    known_keys,
)
from stickslip.scenario.law import flat_laws, law_lines, laws_of
from stickslip.scenario.matter import Fluid, fluid_of_table
from stickslip.scenario.played_rows import Accelerations, Forces
from stickslip.scenario.sections import SECTIONS
from stickslip.scenario.uncertain import JointPrior
from stickslip.scenario.waveform import Waveform

FORMAT_VERSION = 1

# Chosen: a scenario is a page of text; what is longer is another file, or a device without end.
_MOST_BYTES = 1 << 20

_T = TypeVar("_T", Waveform, FieldMap, Accelerations, Forces)


class Content(NamedTuple):
    """What the file of a scenario states."""

    core: _core.Scenario
    program: Waveform | None
    field_map: FieldMap | None
    accelerations: Accelerations | None
    forces: Forces | None
    fluid: Fluid | None
    uncertain: JointPrior | None


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


def changes_of(
    document: Mapping[str, Any], folder: Path | None
) -> tuple[dict[str, Any], Any, Fluid | None]:
    """Values by dotted key, as `Scenario.replace` takes them, ``[uncertain]``, and the fluid.

    Files that the document names are relative to `folder`; without it they are not read.
    """
    _check_version(document)
    known = [*SECTIONS, "effects", "laws", "fluid", "uncertain"]
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
        elif name not in ("fluid", "uncertain"):
            _flatten(name, content, changes)
    if "drive" not in document:
        raise ScenarioError("[drive] is missing: it is required, if only as an empty section")
    if PROGRAM in changes:
        value = changes[PROGRAM]
        raise ScenarioError(f"{PROGRAM} = {shown(value)}: there is no such key; {PROGRAM_HINT}")
    if folder is None:
        changes = {key: value for key, value in changes.items() if key not in PATHS}
    elif FILE in changes:
        changes[PROGRAM] = _read(FILE, changes.pop(FILE), folder, Waveform.from_csv)
    if folder is not None and COIL_MAP in changes:
        changes[COIL_MAP] = _read(COIL_MAP, changes[COIL_MAP], folder, FieldMap.from_file)
    if folder is not None and SHAKE_FILE in changes:
        file = changes.pop(SHAKE_FILE)
        changes[ACCELERATIONS] = _read(SHAKE_FILE, file, folder, Accelerations.from_csv)
    if folder is not None and INNER_FILE in changes:
        changes[FORCES] = _read(INNER_FILE, changes.pop(INNER_FILE), folder, Forces.from_csv)
    fluid = fluid_of_table(document["fluid"]) if "fluid" in document else None
    return changes, document.get("uncertain"), fluid


def _flatten(section: str, table: Mapping[str, Any], changes: dict[str, Any]) -> None:
    """Add the values of a section and its tables by dotted key; refuse unknown keys."""
    sections = {key.section for key in known_keys().values()}
    for name, value in table.items():
        key = f"{section}.{name}"
        if key in sections:
            if not isinstance(value, dict):
                refuse(key, value, f"a table [{key}]")
            _flatten(key, value, changes)
        elif key in PATHS or key == PROGRAM:
            changes[key] = value
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


def _read(key: str, file: object, folder: Path, read: Callable[[Path], _T]) -> _T:
    if not isinstance(file, str) or not file:
        refuse(key, file, "the path of a file")
    path = folder / file
    try:
        return read(path)
    except ScenarioError as error:
        reason = str(error).removeprefix(printable(f"{path}: "))
        raise ScenarioError(f"{key} = {shown(file)}: {reason}") from None


def named_files(path: Path) -> dict[str, Path]:
    """The files that an ordinary scenario file takes voltages or a map from, by key."""
    try:
        document = read_document(path) if path.is_file() else {}
    except ScenarioError:
        return {}
    files = {}
    for key in PATHS:
        section, name = key.split(".")
        values = document.get(section)
        file = values.get(name) if isinstance(values, dict) else None
        if isinstance(file, str):
            files[key] = path.parent / file
    return files


_BESIDE = ("voltages.csv", "map.json", "accelerations.csv", "forces.csv")


def held_writers(content: Content, names: Sequence[Path]) -> dict[Path, Callable[[Path], object]]:
    """What writes the objects that a scenario has to `names`, which are those of `_BESIDE`."""
    program, field_map = content.program, content.field_map
    shaken, forces = content.accelerations, content.forces
    writers = (
        None if program is None else program.write,
        None if field_map is None else text_writer(field_map.to_json()),
        None if shaken is None else shaken.write,
        None if forces is None else forces.write,
    )
    return {name: writer for name, writer in zip(names, writers, strict=True) if writer is not None}


def files_beside(path: Path) -> tuple[Path, ...]:
    """Where the objects of a scenario that is written to `path` go, see `held_writers`."""
    return tuple(path.with_name(f"{path.stem}.{ending}") for ending in _BESIDE)


def write_scenario(content: Content, path: Path, comments: Sequence[str] = ()) -> str:
    """Write the scenario's file, and its voltages and map beside it; return the text.

    `comments` are lines at its top, without their ``#``.
    """
    text, writers = scenario_writers(content, path, comments)
    write_together(writers)
    return text


def scenario_writers(
    content: Content, path: Path, comments: Sequence[str] = ()
) -> tuple[str, dict[Path, Callable[[Path], object]]]:
    """The text of a scenario's file, and what `write_together` needs for all its files."""
    beside = files_beside(path)
    text = "".join(f"# {printable(line)}\n" for line in comments)
    text += scenario_text(content, *(file.name for file in beside))
    return text, {path: text_writer(text), **held_writers(content, beside)}


def scenario_text(
    content: Content,
    voltages: str = _BESIDE[0],
    field_map: str = _BESIDE[1],
    accelerations: str = _BESIDE[2],
    forces: str = _BESIDE[3],
) -> str:
    """The TOML text, with the files that the objects of the scenario are in."""
    core, fluid = content.core, content.fluid
    changed = core.changed()
    given = {key.partition(".")[0] for key in changed}
    given |= {"shake"} if content.accelerations is not None else set()
    given |= {"inner"} if content.forces is not None else set()
    left_out = {"initial", "inner", "shake"} - given
    idle = IDLE.get(str(core.get("drive.mode")), ())
    lines = [f"stickslip = {FORMAT_VERSION}"]
    for section in dict.fromkeys(key.section for key in known_keys().values()):
        keys = [key for key in known_keys().values() if key.section == section]
        if section.startswith("effects.") or is_of_one_coil(keys[0].name):
            keys = [key for key in keys if key.name in changed]
        if section in left_out or not keys:
            continue
        lines += ["", f"[{section}]"]
        lines += [_line(key, core.get(key.name)) for key in keys if key.name not in idle]
        if section == "drive" and content.program is not None:
            lines.append(f"file = {quoted(voltages)}")
        if section == "coil" and content.field_map is not None:
            lines.append(f"map = {quoted(field_map)}")
        if section == "shake" and content.accelerations is not None:
            lines.append(f"file = {quoted(accelerations)}")
        if section == "inner" and content.forces is not None:
            lines.append(f"file = {quoted(forces)}")
    for name, law in laws_of(core):
        lines += law_lines(name, law)
    if fluid is not None:
        wall = "false" if fluid.gap is None else repr(fluid.gap)
        lines += ["", "[fluid]  # for its note: what it sets stands above"]
        lines += [f"density = {fluid.density!r}  # kg/m^3"]
        lines += [f"viscosity = {fluid.viscosity!r}  # Pa s", f"wall = {wall}  # m"]
    if content.uncertain is not None:
        lines += _uncertain_lines(content.uncertain)
    return "\n".join(lines) + "\n"


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


def _line(key: Key, value: Value) -> str:
    text = quoted(value) if isinstance(value, str) else repr(value)
    comment = "" if key.unit == "-" or isinstance(value, str) else f"  # {key.unit}"
    return f"{key.name.rpartition('.')[2]} = {text}{comment}"
