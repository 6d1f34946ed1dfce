"""The models of logs that ``--model`` names, and the files that ``init --model`` writes."""

from __future__ import annotations

import runpy
import shlex
import sys
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip import models
from stickslip._util.columns import Source
from stickslip._util.messages import meant
from stickslip._util.text import printable
from stickslip.errors import ScenarioError
from stickslip.models.kinds import KINDS
from stickslip.models.log import read_in
from stickslip.models.model import Model
from stickslip.models.scalar import Own

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
    terms = list(kind.every.values())
    constants = [term for term in terms if term.absent is None]
    model = getattr(models, name)(**{term.name: (1.0, 0.1) for term in constants})
    effects = [term for term in terms if term.size]
    others = [term for term in terms if term not in constants and term not in effects]
    sensors = ", ".join(dict.fromkeys(sensor.name for sensor in kind.sensors))
    reads = " or ".join(f'"{quantity}"' for quantity in kind.reads if quantity != model.reads)
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
        "# What is known of it, in SI units and radians:",
        f"model = models.{name}(",
        "    # Constants: a value, or (value, standard deviation). Change these numbers.",
        *(_term(term.name, "(1.0, 0.1)", term.unit, term.meaning) for term in constants),
        "    # Effects. One that is stated is known; the others are causes that may be named.",
        *(f"    # {_term(term.name, '(0.1, 0.01)', term.unit, term.meaning).strip()}"
          for term in effects),
        "    # What has a usual value, or is found where it is not stated.",
        *(f"    # {_term(term.name, repr(term.absent or 0.1), term.unit, term.meaning).strip()}"
          for term in others),
        *([f'    reads="{model.reads}",  # or {reads}'] if len(kind.reads) > 1 else []),
        "    smooth=False,  # whether inputs change evenly between two readings, or are held",
        f"    without=[],  # causes that are left out: effects above; {sensors}",
        ")",
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _term(name: str, value: str, unit: str, meaning: str) -> str:
    return f"    {name}={value},  # {'' if unit == '-' else f'{unit}: '}{meaning}"
