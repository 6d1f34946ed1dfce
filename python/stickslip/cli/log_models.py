"""The models of logs that ``--model`` names, and the files that keep how a log is read."""

from __future__ import annotations

import json
import os
import runpy
import sys
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stickslip import models
from stickslip._util.columns import Source
from stickslip._util.messages import check_kind, known_arguments, meant
from stickslip._util.prior import Prior
from stickslip._util.text import quoted
from stickslip._util.units import Units
from stickslip.errors import ScenarioError, prefixed
from stickslip.models.kinds import KINDS
from stickslip.models.log import read_in
from stickslip.models.model import Model
from stickslip.models.scalar import Own
from stickslip.scenario.toml_file import read_document

_VERSION = "stickslip_log"
_ALLOWED = f"allowed is {', '.join(KINDS)} or FILE.py:NAME"


def load_model(text: str, given: Mapping[str, Any], logs: Sequence[Source]) -> Any:
    """The model that ``--model`` names, with what ``--set`` says of it.

    A ready-made one reads the first of its columns that the first log has, where that is not set.
    """
    if text in KINDS:
        make = getattr(models, text)
        several = list(KINDS[text].reads)
        reads = None
        if "reads" not in given and len(several) > 1:
            reads = read_in(logs[0], several)
        try:
            return make(**({} if reads is None else {"reads": reads}), **given)
        except ScenarioError as error:
            raise ScenarioError(
                f"{error}; --set NAME=VALUE, NAME=VALUE,ERROR or NAME=LOW:HIGH states it, and "
                f'"stickslip read LOG --model {text} --write FILE.toml" lists all of them'
            ) from None
    file, colon, name = text.rpartition(":")
    if not colon or not file.endswith(".py"):
        raise ScenarioError(f"--model {text}: {_ALLOWED}{meant(text, KINDS)}")
    if given:
        raise ScenarioError(f"--set: {file} says what is known of its model: change it there")
    return _of_file(Path(file), name)


def _of_file(path: Path, name: str) -> Any:
    """The object of a name in a Python file."""
    if not path.is_file():
        raise ScenarioError(f"--model: {path}: there is no such file")
    sys.path.insert(0, str(path.resolve().parent))  # as of a script
    try:
        variables = runpy.run_path(str(path))
    except Exception as error:  # whatever a file of a user does
        is_refusal = isinstance(error, ScenarioError)
        text = str(error) if is_refusal else f"{type(error).__name__}: {error}"
        raise ScenarioError(f"{path}{_line_of(str(path), error)}: {text}") from None
    finally:
        del sys.path[0]
    there = [key for key, value in variables.items() if isinstance(value, Model | Own)]
    if name not in there:
        allowed = ", ".join(there) or "a model of stickslip.models, such as own(...) makes"
        raise ScenarioError(f"{path}: there is no model {name}; allowed is {allowed}")
    return variables[name]


def _line_of(path: str, error: Exception) -> str:
    """The last line of a file that led to an error."""
    frames = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
              if frame.filename == path]  # fmt: skip
    if isinstance(error, SyntaxError) and error.filename == path:
        frames = [error.lineno]
    return f": line {frames[-1]}" if frames else ""


@known_arguments
@dataclass(frozen=True)
class LogFile:
    """A TOML file of ``read --write``: a log, its model, what is `set` of that, and units."""

    file: Path
    model: str
    units: Units = None
    set: Mapping[str, Any] = field(default_factory=dict)

    @staticmethod
    def of(path: Path) -> LogFile | None:
        """That of a path, from whose folder its paths begin; None of any other file."""
        with prefixed(path):
            document = read_document(path, "recipe", _VERSION) if path.suffix == ".toml" else {}
            if document.pop(_VERSION, None) is None:
                return None
            made = LogFile(**document)
            for name, kind in {"file": str, "model": str, "set": Mapping}.items():
                check_kind(name, getattr(made, name), kind)
        given = {name: tuple(each) if isinstance(each, list) and name != "without" else each
                 for name, each in made.set.items()}  # fmt: skip
        own = path.parent / made.model if ":" in made.model else made.model
        return LogFile(path.parent / made.file, str(own), made.units, given)

    def text(self, folder: Path) -> str:
        """The text of its file in a folder, with all terms that are not stated as comments."""
        model = os.path.relpath(self.model, folder) if ":" in self.model else self.model
        top = {_VERSION: 1, "file": os.path.relpath(self.file, folder), "model": model}
        top |= {} if self.units is None else {"units": self.units}
        lines = [*(f"{name} = {_toml(each)}" for name, each in top.items()),
                 "", "[set]  # SI units: a value, [value, standard deviation], or a range",
                 *(f"{name} = {_toml(each)}" for name, each in self.set.items())]  # fmt: skip
        if kind := KINDS.get(self.model):
            lines += [f"# {term.name} = [1.0, 0.1]  # {term.unit}: {term.meaning}"
                      for term in kind.every.values() if term.name not in self.set]  # fmt: skip
            causes = [*(term.name for term in kind.terms if term.size),
                      *dict.fromkeys(sensor.name for sensor in kind.sensors)]  # fmt: skip
            lines += [f"# reads = {' or '.join(map(quoted, kind.reads))}",
                      f"# without = {_toml(causes)}  # causes that are left out"]  # fmt: skip
        return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, Prior):
        return _toml({name: float(number) for name, number in value.table.items()})
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{quoted(k)} = {_toml(each)}' for k, each in value.items())} }}"
    return quoted(value) if isinstance(value, str) else json.dumps(value)
