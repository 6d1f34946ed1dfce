"""Types and options of the commands."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, TypeVar

import click
from click.shell_completion import CompletionItem

from stickslip._util.messages import MOST_VALUES, shown
from stickslip._util.units import SI, Units
from stickslip.scenario.held import PATHS
from stickslip.scenario.keys import Value, full_name, known_keys

_F = TypeVar("_F", bound=Callable[..., Any])

_WITH_UNIT = re.compile(r"[-+]?\.?\d[\d.eE+-]*\s*([^\W\d]|[°%])")
_QUOTES = "'\""


def key_names(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """The keys of a scenario that begin as a word does, for a shell."""
    keys = known_keys().values()
    return [CompletionItem(k.name, help=k.meaning) for k in keys if k.name.startswith(incomplete)]


class KeyValue(click.ParamType[Any]):
    """``KEY=VALUE`` as a pair; `parse` makes the value of the key and its text."""

    name = "pair"

    def __init__(self, example: str, parse: Callable[[str, str], Any]) -> None:
        self.example = example
        self.parse = parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The pair, or a usage error."""
        key, equals, text = (part.strip() for part in value.partition("="))
        if not equals or not key or not text:
            self.fail(f"{shown(value)}: allowed is {self.example}", param, ctx)
        try:
            return full_name(key), self.parse(key, text)  # so that two options of one key are found
        except ValueError as error:
            self.fail(f"{shown(value)}: {error}", param, ctx)


def number_or_word(text: str) -> Value:
    """A number if it reads as one, else a word, with or without quotes around it."""
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    if _WITH_UNIT.match(text):
        raise ValueError("allowed is a number in SI units without its unit: 2.5 mT is 2.5e-3")
    return text.strip(_QUOTES)


def number(key: str, text: str) -> float:
    """A number."""
    value = number_or_word(text)
    if isinstance(value, str):
        raise ValueError("allowed is a number, in SI units")
    return float(value)


def stated(key: str, text: str) -> Any:
    """A term of a model by ``--set``: a value, with its error, the ends of a range, words."""
    if re.fullmatch(r"[+-]?(0,\d+|\d+,0\d+)", text):  # a decimal comma
        raise ValueError(
            f"write {text.replace(',', '.')} with a decimal point, or VALUE,ERROR with a point in "
            "both"
        )
    if re.fullmatch(r"[^:a-z]*\d[^:]*:[^:]*", text):
        from stickslip._util.prior import Prior  # and NumPy, which most commands start without

        low, high = (number(key, part.strip()) for part in text.split(":", 1))
        return Prior("log-uniform" if low > 0.0 else "uniform", low, high)
    values = [number_or_word(part.strip()) for part in text.split(",")]
    if key == "without":
        return [str(value) for value in values]
    if values[0] in ("true", "false"):
        return values[0] == "true"
    return tuple(values) if len(values) > 1 else values[0]


def _column_units(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> Units:
    """Units by column of ``COLUMN=UNIT,COLUMN=UNIT``, or ``si`` itself."""
    if [*texts] == [SI] or not texts:
        return SI if texts else None
    pairs = [part.rpartition("=")[::2] for text in texts for part in text.split(",")]
    units = {name.strip(): unit.strip() for name, unit in pairs}
    if not all(name and unit for name, unit in units.items()):
        text = f"allowed is COLUMN=UNIT, such as speed=deg/s, or {SI}"
        raise click.BadParameter(text, ctx, param)
    return units


MODEL = click.option(
    "--model",
    metavar="NAME",
    help="Of logs: a ready-made model, such as joint or servo, or FILE.py:NAME. Each log is a "
    "record of its own.",
)
UNITS = click.option(
    "--units",
    multiple=True,
    metavar="COLUMN=UNIT",
    callback=_column_units,
    help="Unit of a column of logs whose heading states none, such as speed=deg/s; several after "
    f"commas, or repeated; {SI} if all of these are in SI units.",
)


def range_or_words(key: str, text: str) -> list[Value]:
    """The ends of ``low:high``, or the words of ``a,b``."""
    values = _list(text, ":" if ":" in text else ",")
    is_range = not any(isinstance(value, str) for value in values)
    if is_range != (":" in text) or (is_range and len(values) != 2):
        raise ValueError("allowed is key=low:high with two numbers, or key=word,word")
    return values


def _list(text: str, separator: str) -> list[Value]:
    return [number_or_word(part.strip()) for part in text.split(separator)]


def _values(key: str, text: str) -> list[Value]:
    """The values of ``start:stop:count``, with both ends, in steps or ratios, or of ``a,b,c``."""
    if ":" not in text:
        return _list(text, ",")
    text, log, more = text.partition(":log")
    try:
        first, last, number = text.split(":")
        # Decimals, so that 0.1:0.5:5 gives 0.3 and not the sum of rounded steps.
        start, stop, count = Decimal(first.strip()), Decimal(last.strip()), int(number)
        step = (stop - start) / max(count - 1, 1)
        allowed = step.is_finite() and 1 <= count <= MOST_VALUES and not more
        allowed &= not log or min(start, stop) > 0
    except (ArithmeticError, ValueError):
        allowed = False
    if not allowed or (count == 1) != (start == stop):
        raise ValueError(
            "allowed is start:stop:count with two numbers, and a whole number of values from 2 to "
            f"{MOST_VALUES}, or start:stop:count:log with numbers above 0"
        )
    if log:
        ratio = (stop / start).ln() / max(count - 1, 1)
        return [float(start), *(float(start * (k * ratio).exp()) for k in range(1, count))]
    return [float(start + k * step) for k in range(count)]


def _once(ctx: click.Context, param: click.Parameter, pairs: Any) -> dict[str, Any]:
    """The values by key."""
    table = dict[str, Any]()
    for key, values in pairs:
        if key in table:
            raise click.BadParameter(f"{key} is there twice: allowed is one", ctx, param)
        table[key] = values
    return table


def pairs(
    name: str, parse: Callable[[str, str], Any], example: str, help: str, **more: Any
) -> Callable[[_F], _F]:
    """A repeatable option of pairs, which a command gets as a dict."""
    how: dict[str, Any] = {"metavar": "KEY=VALUES", "callback": _once, "multiple": True, **more}
    return click.option(name, type=KeyValue(example, parse), help=f"{help}; repeatable.", **how)


SET_OF_MODEL = pairs(
    "--set",
    stated,
    "NAME=VALUE, NAME=VALUE,ERROR or NAME=LOW:HIGH, such as inertia=0.1,0.002",
    "What is known of a ready-made model, in SI units, temperatures in K if those of the log are, "
    "else in degC: a value, a value and its standard deviation, or the ends of a range, "
    "log-uniform if above zero; also reads=NAME, smooth=yes and without=NAME,NAME",
    metavar="NAME=VALUE",
)


KEYS: dict[str, Any] = {
    "shell_complete": lambda *about: [
        CompletionItem(f"{item.value}=", help=item.help) for item in key_names(*about)
    ]
}

SET = pairs(
    "--set",
    lambda key, text: Path(text.strip(_QUOTES)) if key in PATHS else number_or_word(text),
    "key=value, such as drive.frequency=30",
    "Change a key, in SI units without their names; the last of a key counts",
    metavar="KEY=VALUE",
    callback=lambda ctx, param, pairs: dict(pairs),
    **KEYS,
)


def vary_option(required: bool) -> Callable[[_F], _F]:
    """``--vary``, of which a sweep needs one."""
    return pairs(
        "--vary",
        _values,
        "key=start:stop:count or key=a,b,c, such as drive.frequency=5:200:40",
        "A key and its values, start:stop:count with both ends, the same with :log for equal "
        "ratios, or a,b,c",
        required=required,
        **KEYS,
    )


def check_drawable(plot: Path | None, vary: Mapping[str, list[Any]], most: int) -> None:
    """Refuse, before the work, what lines, or with two numbers at `most` a map, cannot show."""
    kinds = [isinstance(values[0], str) for values in vary.values() if len(values) > 1]
    numbers = kinds.count(False)
    if plot and not (numbers == 1 or (numbers == 2 == most and True not in kinds)):
        several = ", or with two of numbers" if most == 2 else ""
        raise click.UsageError(
            f"--plot: allowed with one --vary of numbers, and others of words{several}"
        )


PATH = click.Path(path_type=Path)


def plot_option(drawn: str) -> Callable[[_F], _F]:
    """Make ``--plot``, which draws something."""
    return click.option("--plot", type=PATH, help=f"Draw {drawn}: .png, .pdf, .svg and others.")


FOLDER = click.Path(path_type=Path, file_okay=False)
UNCERTAIN = click.option(
    "--uncertain",
    type=PATH,
    help="A TOML file whose [uncertain] takes the place of the scenario's: a measurement, another "
    "scenario, or the extended.toml of a diagnosis.",
)
SEED = click.option("--seed", type=click.IntRange(0), default=0, help="Seed of all draws.")
THREADS = click.option(
    "--threads",
    "--jobs",
    "threads",
    type=click.IntRange(1),
    help="Simulations at a time; default: processors.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
