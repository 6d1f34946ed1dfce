"""The objects that a scenario holds beside its numbers and words, each described once.

A further one is a row of `HELD`, and a class with the methods that `Held` names.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from stickslip._util.messages import refuse, shown
from stickslip._util.text import printable
from stickslip.errors import ScenarioError


@dataclass(frozen=True)
class Held:
    """One kind of object.

    With a file, its class has ``to_core``, ``write(path)``, ``to_json`` and ``from_json(text)``,
    and the core's scenario a ``set_`` of its name. Without one, a section of the scenario's file
    states it, and the class has ``of_table(table)`` and ``lines``.

    Attributes
    ----------
    key : str
        Its dotted key in Python; without a file, its section.
    maker : str
        Module, and what reads its file or section.
    file : str
        The key that holds its path in a scenario's file and with ``--set``.
    ending : str
        How its file beside that of a scenario is named.
    attribute : str
        Its name in `Scenario.document`.
    meaning : str
        What it is, for the section's documentation.
    about : str
        What its file or section is, for who asks for the keys.
    """

    key: str
    maker: str
    file: str = ""
    ending: str = ""
    attribute: str = ""
    meaning: str = ""
    about: str = ""

    @property
    def section(self) -> str:
        """The section of its key."""
        return self.key.rpartition(".")[0]

    @property
    def field(self) -> str:
        """Its name in the section."""
        return self.key.rpartition(".")[2]

    @property
    def class_name(self) -> str:
        """The name of its class."""
        return self.maker.partition(":")[2].partition(".")[0]

    @cached_property
    def kind(self) -> type[Any]:
        """The class; imported now, as keys are listed without it."""
        module = importlib.import_module(self.maker.partition(":")[0])
        found: type[Any] = getattr(module, self.class_name)
        return found

    @property
    def hint(self) -> str:
        """Python's object in place of a path."""
        name, maker = self.class_name, self.maker.partition(":")[2]
        article = "an" if name[0] in "AEIO" else "a"
        return f"in Python, {self.key} takes {article} {name}, such as {maker}(path)"

    def read(self, given: Any) -> Any:
        """The object of a file, or of a section's table."""
        return getattr(self.kind, self.maker.rpartition(".")[2])(given)

    def put(self, given: object, core: Any, held: dict[str, Any]) -> None:
        """Set it in the core's scenario and among the objects of a scenario; None removes it."""
        if given is not None and not isinstance(given, self.kind):
            refuse(self.key, given, f"a path in a file or with --set, {self.file}; {self.hint}")
        self.to_core(given, core)
        held.pop(self.key, None)
        if given is not None:
            held[self.key] = given

    def to_core(self, given: Any, core: Any) -> None:
        """Set it in the core's scenario."""
        getattr(core, f"set_{self.field}")(None if given is None else given.to_core())


_SCENARIO = "stickslip.scenario"

HELD = {
    held.key: held
    for held in (
        Held(
            "drive.program", f"{_SCENARIO}.waveform:Waveform.from_csv", "drive.file",
            "voltages.csv", "voltage_blocks",
            'Voltages of the five coils; with ``mode="program"`` only, and then required. What is '
            "a pulsed drive's then has its default: all but `direction`.",
            'file = "voltages.csv": voltages, with mode = "program" and of the others direction '
            "alone; columns t (s), xp, xm, yp, ym, clamp (V), straight lines between the rows, a "
            "repeated t is a jump",
        ),
        Held(
            "coil.map", "stickslip.field.field_map:FieldMap.from_file", "coil.map",
            "map.json", "coil_map",
            "Measured field of the five coils, in place of that of `side`, `distance` and `turns`, "
            "which then have their defaults.",
            'map = "map.csv": the measured field per ampere, in place of that of side, distance '
            "and turns; columns x, y, z (m), coil, Bx, By, Bz (T/A)",
        ),
        Held(
            "shake.accelerations", f"{_SCENARIO}.played_rows:Accelerations.from_csv", "shake.file",
            "accelerations.csv", "accelerations",
            "Those of the surface, in place of sines, whose keys then have their defaults.",
            'file = "accelerations.csv": those of the surface in place of sines, over a period; '
            "columns t (s), ax, az (m/s^2)",
        ),
        Held(
            "inner.forces", f"{_SCENARIO}.played_rows:Forces.from_csv", "inner.file",
            "forces.csv", "forces",
            "Those on the mass, in place of sines and pulses, whose keys then have their defaults.",
            'file = "forces.csv": those on the mass in place of sines and pulses, over a period; '
            "columns t (s), force (N)",
        ),
        Held(
            "fluid", f"{_SCENARIO}.matter:Fluid.of_table",
            about='a section with name = "water", or density (kg/m^3) and viscosity (Pa s), and '
            "wall; it gives drag and buoyancy; in Python Scenario.in_fluid",
        ),
    )
}  # fmt: skip
"""By key, in the order of a file."""

OBJECTS = {held.key: held for held in HELD.values() if held.file}
"""Those that are the value of a key in Python, and have a file."""

PATHS = {held.file: held for held in OBJECTS.values()}
"""The same by the key that holds a path in a scenario's file and with --set."""

TABLES = {key: held for key, held in HELD.items() if not held.file}
"""Those that a section of the scenario's file states."""


def with_files(changes: dict[str, Any], folder: Path) -> list[Path]:
    """Put in place of each path among changes, relative to `folder`, its object; give the paths."""
    files = []
    for held in OBJECTS.values():
        if held.file in changes:
            file = changes.pop(held.file)
            changes[held.key] = _read(held, file, folder)
            files.append(folder / file)
    return files


def _read(held: Held, file: object, folder: Path) -> Any:
    if not isinstance(file, str | Path) or not str(file):
        refuse(held.file, file, "the path of a file")
    path = folder / file
    try:
        return held.read(path)
    except ScenarioError as error:
        reason = str(error).removeprefix(printable(f"{path}: "))
        raise ScenarioError(f"{held.file} = {shown(str(file))}: {reason}") from None
