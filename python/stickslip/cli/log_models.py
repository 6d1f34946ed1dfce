"""The models of logs that ``--model`` names, and files that keep them."""

from __future__ import annotations

import contextlib
import os
import runpy
import shlex
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip import models
from stickslip._util.columns import Source
from stickslip._util.messages import check_kind, meant, suggestion
from stickslip._util.prior import Prior
from stickslip._util.text import literal, printable, quoted
from stickslip._util.units import Units
from stickslip.errors import ScenarioError, prefixed
from stickslip.models.kinds import KINDS
from stickslip.models.log import read_in
from stickslip.models.model import Kind, Model
from stickslip.models.scalar import Own
from stickslip.scenario.toml_file import read_document

_CONSTANT = (1.0, 0.1)
_VERSION = "stickslip_log"
_KEYS = {_VERSION: int, "log": str, "model": str, "units": list, "set": list}
_ALLOWED = f"allowed is {', '.join(KINDS)} or FILE.py:NAME"


def load_model(text: str, given: Mapping[str, Any], logs: Sequence[Source]) -> Any:
    """The model that ``--model`` names, with what ``--set`` says of it.

    A ready-made one reads the first of its columns that the first log has, where that is not set.
    """
    if text in KINDS:
        make = getattr(models, text)
        several = list(KINDS[text].reads)
        reads = read_in(logs[0], several) if len(several) > 1 else None
        try:
            return make(**{**({"reads": reads} if reads else {}), **given})
        except ScenarioError as error:
            raise ScenarioError(
                f"{error}; --set NAME=VALUE, NAME=VALUE,ERROR or NAME=LOW:HIGH states it, and "
                f'"stickslip init --model {text}" writes a file with all of them'
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


def model_file(name: str, file: Path) -> str:
    """The text of a file with a ready-made model, whose numbers are to be changed."""
    kind = KINDS[name]
    terms = kind.every.values()
    known: dict[str, Any] = {term.name: _CONSTANT for term in terms if term.absent is None}
    model = getattr(models, name)(**known)
    known |= {"reads": model.reads, "smooth": False, "without": []}
    about = str(getattr(models, name).__doc__).split("\n", 1)[0]
    lines = [
        f'"""{about}',
        "",
        f"It takes the columns {model.columns} of a log.",
        '"""',
        "",
        f"# stickslip diagnose LOG.csv --model {shlex.quote(printable(file))}:model",
        "from stickslip import models",
        "",
        "# SI units and radians: a value, or (value, standard deviation). An effect that is stated",
        "# is known; the others are causes that may be named.",
        f"model = models.{name}(",
        *(f"    {line}" for line in _listed(kind, known, "{}={!r},".format)),
        ")",
    ]
    return "\n".join(lines) + "\n"


def _listed(kind: Kind, known: Mapping[str, Any], line: Callable[[str, Any], str]) -> list[str]:
    """List all that may be stated of a ready-made model; what is not `known` is a comment."""
    rows = dict[str, tuple[Any, str]]()
    for term in kind.every.values():
        usual = _CONSTANT if term.absent is None else (0.1, 0.01) if term.size else term.value
        rows[term.name] = usual or 0.1, f"{term.unit}: {term.meaning}".removeprefix("-: ")
    if len(kind.reads) > 1:
        rows["reads"] = next(iter(kind.reads)), f"or another of {', '.join(kind.reads)}"
    sensors = ", ".join(dict.fromkeys(sensor.name for sensor in kind.sensors))
    rows["smooth"] = True, "whether inputs change evenly between two readings, or are held"
    rows["without"] = [], f"causes that are left out: effects above; {sensors}"
    texts = ((name, f"{line(name, known.get(name, usual))}  # {about}")
             for name, (usual, about) in rows.items())  # fmt: skip
    return [text if name in known else f"# {text}" for name, text in texts]


def format_recipe(log: Path, model: str, units: Units, known: Mapping[str, Any], to: Path) -> str:
    """Return the text of a recipe in the folder `to`: a log with what is stated of it."""
    named = [f"{name}={unit}" for name, unit in units.items()] if isinstance(units, Mapping) else []
    terms = _listed(KINDS[model], known, _argument) if model in KINDS else []
    lines = [
        f"{_VERSION} = 1",
        f"log = {quoted(os.path.relpath(log, to))}",
        f"model = {quoted(os.path.relpath(model, to) if ':' in model else model)}",
        f"units = {literal(named or ([] if units is None else [units]))}",
        "set = [  # SI units and radians: VALUE, VALUE,ERROR or LOW:HIGH",
        *(f"  {line}" for line in terms),
        "]",
    ]
    return "\n".join(lines) + "\n"


def _argument(name: str, value: Any) -> str:
    """Return what ``--set`` takes as a text of a list."""
    value = f"{value.first!r}:{value.second!r}" if isinstance(value, Prior) else value
    said = ",".join(map(str, value)) if isinstance(value, list | tuple) else str(value).lower()
    return f'"{name}={said}",'


def expand_recipes(arguments: Sequence[str]) -> list[str]:
    """Replace recipes by the arguments that they keep, whose paths begin at their folders."""
    made: list[str] = []
    for before, argument in zip(("", *arguments), arguments, strict=False):
        path, document = Path(argument), dict[str, Any]()
        with contextlib.suppress(ScenarioError):  # who reads it as something else says why
            is_read = path.suffix == ".toml" and before != "--write"
            document = read_document(path) if is_read else {}
        if _VERSION not in document:
            made.append(argument)
            continue
        with prefixed(path):
            for name, value in document.items():
                if name not in _KEYS:
                    raise ScenarioError(f"there is no {name}; {suggestion(name, _KEYS)}")
                check_kind(name, value, _KEYS[name])
            if not {"log", "model"} <= document.keys() or document[_VERSION] != 1:
                raise ScenarioError(f"allowed is {_VERSION} = 1, with a log and a model")
        model = document["model"]
        made.append(str(path.parent / document["log"]))
        document["model"] = [str(path.parent / model) if ":" in model else model]
        options = (f"--{name}={each}" for name in ("model", "units", "set")
                   for each in document.get(name, ()))  # fmt: skip
        made += [option for option in options if option not in made]
    return made
