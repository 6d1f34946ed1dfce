"""Makes the stubs of names, sections and runs from tables: ``python tests/sections_stub.py``."""

from __future__ import annotations

import argparse
from pathlib import Path

from stickslip import _HOMES, COIL_NAMES, _core
from stickslip.scenario.keys import Key, keys_of
from stickslip.scenario.sections import SECTIONS

PACKAGE = Path(__file__).parents[1] / "python" / "stickslip"
FILE = PACKAGE / "scenario" / "sections.pyi"
NAMES_FILE = PACKAGE / "__init__.pyi"
RUN_FILE = PACKAGE / "simulation" / "recorded.pyi"

HEAD = """\
# Made by tests/sections_stub.py from the core's table of keys.
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple

from stickslip.field.field_map import FieldMap
from stickslip.scenario.played_rows import Accelerations, Forces
from stickslip.scenario.section import Section
from stickslip.scenario.waveform import Waveform

STATE_COLUMNS: tuple[str, ...]
CONTACT_WORDS: tuple[str, ...]
SECTIONS: dict[str, type[Any]]
"""

BY_HAND = {
    "Drive": """\
    @property
    def program(self) -> Waveform | None: ...
    @property
    def kind(self) -> Literal["sawtooth", "program", "none"]: ...
    @property
    def facing(self) -> float: ...
""",
    "Coil": """\
    @property
    def map(self) -> FieldMap | None: ...
    def own_values(self) -> dict[str, float]: ...
    @staticmethod
    def of(
        *,
        field_per_ampere: float,
        distance: float,
        side: float | None = None,
        radius: float | None = None,
        resistance: float,
        inductance: float | None = None,
        rise_time: float | None = None,
        capacitance: float = 0.0,
    ) -> Coil: ...
"""
    + "".join(f"    @property\n    def {name}(self) -> OneCoil: ...\n" for name in COIL_NAMES),
    "Robot": """\
    @staticmethod
    def of(
        length: float,
        width: float,
        height: float,
        *,
        material: str | None = None,
        density: float | None = None,
        magnetization: float | None = None,
    ) -> Robot: ...
""",
    "Inner": """\
    @property
    def forces(self) -> Forces | None: ...
""",
    "Shake": """\
    @property
    def accelerations(self) -> Accelerations | None: ...
""",
    "State": """\
    @property
    def row(self) -> list[float]: ...
    @staticmethod
    def from_row(row: Any) -> State: ...
""",
}
"""Members of the classes beside the keys of the table."""

ARGUMENTS = {
    "Drive": ["program: Waveform | None = None"],
    "Inner": ["forces: Forces | None = None"],
    "Shake": ["accelerations: Accelerations | None = None"],
    "Coil": [
        "map: FieldMap | None = None",
        *(f"{name}: Mapping[str, float] | OneCoil | None = None" for name in COIL_NAMES),
    ],
}


def annotation(key: Key) -> str:
    """The type of the values of a key."""
    words = "Literal[" + ", ".join(f'"{word}"' for word in key.words) + "]"
    return {"real": "float", "whole": "int", "rate": f"float | {words}", "fields": "str"}.get(
        key.kind, words
    )


def class_text(name: str) -> str:
    """The stub of one class."""
    kind = SECTIONS[name]
    keys = keys_of(name)
    arguments = []
    for key in keys:
        more = " | Sequence[str]" if key.kind == "fields" else ""
        arguments.append(f"{key.field}: {annotation(key)}{more} = {default(key)}")
    arguments += ARGUMENTS.get(kind.__name__, [])
    lines = [f'class {kind.__name__}(Section, key="{name}"):', "    def __init__(", "        self,"]
    lines += ["        *,", *(f"        {each}," for each in arguments), "    ) -> None: ..."]
    for key in keys:
        lines += ["    @property", f"    def {key.field}(self) -> {annotation(key)}: ..."]
    return "\n".join(lines) + "\n" + BY_HAND.get(kind.__name__, "")


def default(key: Key) -> str:
    """The default value of a key."""
    return f'"{key.default}"' if isinstance(key.default, str) else repr(key.default)


def stub_text() -> str:
    """The whole file."""
    values = "".join(f"    {key.field}: float\n" for key in keys_of("coil.xp"))
    classes = [f"class OneCoil(NamedTuple):\n{values}", *map(class_text, SECTIONS)]
    return "\n".join([HEAD, *classes])


def names_stub_text() -> str:
    """The stub of the public names, in which type checkers take none that is not named twice."""
    lines = [f"from {home} import {name} as {name}" for name, home in _HOMES.items()]
    return "\n".join(
        ["# Made by tests/sections_stub.py from the table in __init__.py.", *lines, ""]
    )


def run_stub_text() -> str:
    """The stub of the numbers and recorded quantities of a run."""
    return "\n".join(
        [
            "# Made by tests/sections_stub.py from the core's tables of a run's quantities.",
            "from abc import ABC, abstractmethod",
            "from typing import Any",
            "",
            "from numpy.typing import NDArray",
            "",
            "class Recorded(ABC):",
            "    @abstractmethod",
            "    def _number(self, name: str) -> float: ...",
            "    @abstractmethod",
            "    def _recorded(self, name: str) -> NDArray[Any]: ...",
            *(f"    {name}: float" for name in _core.summary_numbers),
            *(f"    {name}: NDArray[Any]" for name in _core.record_columns),
            "",
        ]
    )


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__).parse_args()
    NAMES_FILE.write_text(names_stub_text())
    FILE.write_text(stub_text())
    RUN_FILE.write_text(run_stub_text())
