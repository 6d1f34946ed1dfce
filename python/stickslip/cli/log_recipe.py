"""The recipe of a log: a TOML file that keeps how it is read, for ``stickslip diagnose``."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from stickslip._util.messages import refuse, suggestion
from stickslip._util.prior import Prior
from stickslip._util.text import quoted
from stickslip._util.units import Units
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.toml_file import read_document

_VERSION = "stickslip_log"
_OF_MODEL = {"reads": str, "without": list, "smooth": bool}
_KINDS = {_VERSION: int, "file": str, "model": str, "units": (str, dict), "constants": dict}
_KINDS |= _OF_MODEL


class Kept(NamedTuple):
    """A log and how it is read: its model, what is known of that, and the units of columns."""

    log: Path
    model: str
    known: Mapping[str, Any]
    units: Units

    @staticmethod
    def of_file(path: Path) -> Kept | None:
        """The recipe in a file; None of a file that is none. Paths in it begin at its folder."""
        if path.suffix.lower() != ".toml":
            return None
        with prefixed(path):
            document = read_document(path, "recipe of a log", f'"{_VERSION} = 1"')
            if _VERSION not in document:
                return None
            for key, value in document.items():
                if key not in _KINDS:
                    raise ScenarioError(f"{key}: there is no such key; {suggestion(key, _KINDS)}")
                if not isinstance(value, _KINDS[key]):
                    refuse(key, value, "as stickslip read --write writes it")
            for key in ("file", "model"):
                if key not in document:
                    raise ScenarioError(f"{key} is missing")
        known = {name: tuple(value) if isinstance(value, list) else value
                 for name, value in document.get("constants", {}).items()}  # fmt: skip
        known |= {key: document[key] for key in _OF_MODEL if key in document}
        model = document["model"]
        own = str(path.parent / model) if ":" in model else model
        return Kept(path.parent / document["file"], own, known, document.get("units"))

    def text(self, folder: Path) -> str:
        """The text of its file in a folder."""
        log, model = (os.path.relpath(each, folder) for each in (self.log, self.model))
        lines = [f"{_VERSION} = 1", f"file = {quoted(log)}"]
        lines.append(f"model = {quoted(model if ':' in self.model else self.model)}")
        lines += [] if self.units is None else [f"units = {_toml(self.units)}"]
        lines += [f"{name} = {_toml(self.known[name])}" for name in _OF_MODEL if name in self.known]
        constants = {name: each for name, each in self.known.items() if name not in _OF_MODEL}
        lines += ["", "[constants]"] if constants else []
        return "\n".join([*lines, *(f"{name} = {_toml(each)}" for name, each in constants.items())])


def _toml(value: Any) -> str:
    if isinstance(value, Prior):
        return _toml({name: float(number) for name, number in value.table.items()})
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{quoted(k)} = {_toml(each)}' for k, each in value.items())} }}"
    return quoted(value) if isinstance(value, str) else json.dumps(value)
