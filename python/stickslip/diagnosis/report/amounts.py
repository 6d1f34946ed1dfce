"""Words of causes, from causes.toml, and numbers as a reader sees them: rounded, in handy units."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from typing import Any

from stickslip._util.units import handy, unit_label
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.keys import known_keys

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_WORDS: Mapping[str, Mapping[str, Any]] = tomllib.loads(
    resources.files("stickslip").joinpath("diagnosis/report/causes.toml").read_text("utf-8")
)
_CAUSES: Mapping[str, Mapping[str, Any]] = {**_WORDS["effects"], **_WORDS["readings"]}

ROUTINE = (
    "no-block-column", "errors-correlated", "noise-repeats", "noise-free-fit", "frame-noise",
    "frames-correlated",
)  # fmt: skip
"""Codes of notes that nearly every measurement has: the page has them last, the command never."""

_NEW_WORDS = 3  # of a meaning that says more than the title
_PLAIN = 1e-3, 1e5  # sizes between which a number needs no power of ten
_DIGITS = 4  # of a setting
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Words:
    """What causes, parameters and their sizes are called.

    Those of the simulator have the words of causes.toml. A model of one's own has the words of its
    user, whatever names it shares with the simulator.
    """

    def __init__(self, own: bool) -> None:
        self._own = own
        self._causes: Mapping[str, Mapping[str, Any]] = {} if own else _CAUSES
        self._constants: Mapping[str, Mapping[str, Any]] = {} if own else _WORDS["constants"]

    def title(self, name: str, causes: Iterable[Cause] = ()) -> str:
        """A model in plain words that follow ``of``; `causes` are those of the problem.

        A cause of one's own is its meaning, or its name in quotes where it has none; so is an
        effect of one's own whose meaning has an article.
        """
        if name == "none":
            return "no cause"
        known = {each.name: each for each in causes}
        return " and ".join(self._title(each, known.get(each)) for each in name.split(" + "))

    def _title(self, name: str, cause: Cause | None = None) -> str:
        if name in self._causes:
            return str(self._causes[name]["name"])
        if cause is not None and cause.curve is not None:
            return f"a dependence of {cause.curve.law} on {cause.curve.argument}"
        constant = self._constants.get(name)
        if constant or (cause is not None and cause.frees == name):
            return f"another {constant['name'] if constant else name} than stated"
        meaning = "" if cause is None else cause.meaning.strip().rstrip(".")
        # A meaning of a user's effect of the robot may be a sentence.
        noun = meaning and (self._own or re.match(r"an? ", meaning))
        return meaning if noun else f"“{name}”"

    def parameter(self, name: str) -> str:
        """A parameter in plain words: of a cause, a constant, or its key where none are known."""
        cause, _, short = name.removeprefix("effects.").rpartition(".")
        if name in self._constants:
            return str(self._constants[name]["name"])
        return f"{self._title(cause)}: {short.replace('_', ' ')}" if cause in self._causes else name

    def in_titles(self, text: str, causes: Sequence[Cause]) -> str:
        """A sentence with causes in plain words in place of their names, and p as elsewhere."""
        text = re.sub(r"\bp = (\d\S*\d)", lambda each: p_text(float(each[1])), text)
        names = sorted((re.escape(each.name) for each in causes), key=len, reverse=True)
        if not names:
            return text
        found = rf"(?<![\w.])(?:{'|'.join(names)})(?![\w.])"
        text = re.sub(rf"({found}) \+ (?={found})", r"\1 and ", text)
        return re.sub(found, lambda each: self.title(each[0], causes), text)

    def shown_in(self, name: str, unit: str) -> tuple[float, str]:
        """Factor from the SI unit of a parameter to the one in which it is told, and its name."""
        cause, _, parameter = name.removeprefix("effects.").rpartition(".")
        size = self._causes.get(cause, {}).get("sizes", {}).get(parameter)
        if size is None and name in self._constants:
            size = self._constants[name]
        if size is None:
            known = name in known_keys() or name.startswith("tracking.")
            return handy(unit) if known and not self._own else (1.0, unit_label(unit))
        return float(_WORDS["units"][size["unit"]]), str(size["unit"])

    def told(self, cause: Cause, sizes: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
        """A cause in words: `title`, `meaning`, `finding`, `interval`, `remedy`, `drawing`, `way`.

        `sizes` are its parameters, or the constant that it frees, by full name, with `value`,
        `sd`, `low`, `high`, `unit` and, of a constant, what was `stated`. `way` is the word for the
        sign of the largest; `meaning` is empty where the title says as much.
        """
        name, meaning, known = cause.name, cause.meaning, self._causes.get(cause.name)
        said = {"name": name, "title": self.title(name, [cause]), "remedy": "", "way": ""}
        new = set(re.findall(r"\w+", meaning)) - set(re.findall(r"\w+", said["title"]))
        said["meaning"] = meaning if len(new) >= _NEW_WORDS else ""
        said["drawing"] = known["drawing"] if known else ""
        amounts: dict[str, str] = {}
        largest, intervals = -math.inf, []
        for full, each in sizes.items():
            factor, unit = self.shown_in(full, each["unit"])
            value, sd = each["value"] * factor, each["sd"] * factor
            short = full.rpartition(".")[2]
            words = known["sizes"].get(short, {}) if known else {}
            way = words.get("up" if value >= 0.0 else "down", "")
            amounts[short] = amount(abs(value) if way else value, sd, unit)
            amounts[f"{short}_way"] = way
            ends = each["low"], each["high"]
            if way and min(ends) * max(ends) > 0.0:
                ends = abs(ends[0]), abs(ends[1])
            intervals.append(self.between(full, *ends, each["unit"]))
            if abs(value) > largest:
                largest, said["way"] = abs(value), way
        said["interval"] = " and ".join(intervals)
        if known is not None:
            said |= {"finding": known["finding"].format(**amounts), "remedy": known["remedy"]}
            return said
        constant = self._constants.get(name)
        if not cause.parameters:
            what, size = constant["name"] if constant else name, sizes[name]
            stated = self.near(name, size["stated"], size["sd"], size["unit"])
            found = amounts[name.rpartition(".")[2]]
            said["finding"] = f"The {what} is {found}, and was stated as {stated}."
            said["remedy"] = "Measure it again"
            said["drawing"] = constant["drawing"] if constant else ""
            return said
        shorts = [each.rpartition(".")[2] for each in sizes]
        values = [f"{each} = {amounts[each]}" for each in shorts]
        what = said["title"]
        said["finding"] = f"{what[:1].upper()}{what[1:]}: {', '.join(values)}."
        return said

    def between(self, name: str, low: float, high: float, unit: str) -> str:
        """The ends of an interval of a parameter, with its unit: ``13.5 to 16.4 %``."""
        factor, shown = self.shown_in(name, unit)
        ends = sorted((low * factor, high * factor))
        return _joined(ends, (ends[1] - ends[0]) / 4.0, " to ", shown)

    def limit(self, name: str, value: float, unit: str, digits: int = 2) -> str:
        """A value in the unit of its parameter: ``2.1 degrees``."""
        factor, shown = self.shown_in(name, unit)
        return f"{number(value * factor, digits)} {shown}".rstrip()

    def near(self, name: str, value: float, sd: float, unit: str) -> str:
        """A value to the second digit of an error: ``9.810 m/s²``."""
        factor, shown = self.shown_in(name, unit)
        return _joined([value * factor], sd * factor, "", shown)

    def before(self, known: Parameter) -> str:
        """The prior of a parameter by its name, in the unit in which it is told."""
        name, unit, prior = known.name, known.unit, known.prior
        if prior is None:
            assert known.size is not None
            within = self.limit(name, known.size, unit)
            about = known.high if known.falls else known.absent
            shown = self.limit(name, about, unit) if about else "0"
            if known.falls or known.one_sided:
                way = "down" if known.falls else "on"
                return f"half-normal from {shown} {way}, 68 % within {within}"
            return f"normal about {shown}, 68 % within {within}"
        if prior.kind == "normal":
            return f"normal, {self.size(name, prior.first, prior.second, unit)}"
        if prior.kind == "log-normal":
            middle = self.limit(name, prior.first, unit, 4)
            return f"log-normal, {middle} to a factor of {prior.second:.3g}"
        low, high = (self.limit(name, each, unit) for each in (prior.first, prior.second))
        return f"log-uniform, {low} to {high}"

    def size(self, name: str, value: float, sd: float, unit: str) -> str:
        """A parameter with its error, in the unit in which it is told."""
        factor, shown = self.shown_in(name, unit)
        return amount(value * factor, sd * factor, shown)


def suspect(code: str, value: float | None) -> list[str]:
    """Of a check that data failed what it compares, how large the finding is, and what to do."""
    what, large, do = _WORDS["problems"].get(code, ["the data with what they can be", "", ""])
    size = "" if value is None else percent(value) if code == "drift" else number(value, 2)
    return [what, large.format(size), do]


def in_unit(value: float, unit: str, digits: int = 2, own: bool = False) -> str:
    """A number in the handy unit of an SI unit: ``0.095 mm/s``; an `own` unit stays."""
    factor, shown = (1.0, unit_label(unit)) if own else handy(unit)
    return f"{number(value * factor, digits)} {shown}".rstrip()


def times(ratio: float) -> str:
    """How many times as probable: ``2400 times``."""
    return "more than a million times" if ratio > 1e6 else f"{number(ratio, 2)} times"


def odds(ratio: float, short: bool = False) -> str:
    """Odds of one model against another: ``2400 to 1``."""
    if ratio > 1e6:
        return f"> {power(6)} to 1" if short else "more than a million to 1"
    return f"{number(ratio, 2)} to 1" if ratio >= 1.0 else f"1 to {number(1.0 / ratio, 2)}"


def joined_ends(low: float, high: float) -> str:
    """``0.13 to 0.16``."""
    return _joined([low, high], (high - low) / 4.0, " to ", "")


def amount(value: float, sd: float, unit: str = "") -> str:
    """``14.9 ± 0.8 %``: a value with its error, both to the error's second digit."""
    return _joined([value, sd], sd, " ± ", unit)


def _joined(values: list[float], step: float, by: str, unit: str) -> str:
    """Numbers to the second digit of a step, with one power of ten."""
    if not (all(map(math.isfinite, values)) and math.isfinite(step) and step > 0.0):
        return f"{number(values[0])} {unit}".rstrip()
    size = max(map(abs, (*values, step)))
    # Seconds since 1970 have more digits than a power of ten would save.
    plain = _PLAIN[0] <= size and (size < _PLAIN[1] or step < size / _PLAIN[1])
    ten = 0 if plain else math.floor(math.log10(size))
    values, step = [each / 10.0**ten for each in values], step / 10.0**ten
    places = 1 - math.floor(math.log10(step))
    if round(step, places) >= 9.5 * 10.0 ** (1 - places):
        places -= 1  # two digits just below a power of ten are one
    text = by.join(f"{round(each, places) + 0.0:.{max(places, 0)}f}" for each in values)
    return f"{text} {unit}".rstrip() if ten == 0 else f"({text})·{power(ten)} {unit}".rstrip()


def digits_for(values: Iterable[float]) -> int:
    """Digits that tell these numbers apart: four of their spread, and at least four."""
    known = [each for each in values if math.isfinite(each)]
    spread = max(known, default=0.0) - min(known, default=0.0)
    if not 0.0 < spread < math.inf:
        return _DIGITS
    size = max(map(abs, known))
    return _DIGITS + max(math.floor(math.log10(size)) - math.floor(math.log10(spread)), 0)


def number(value: float, digits: int = 3) -> str:
    """A number to some digits, with a power of ten where it is very large or small."""
    if not math.isfinite(value):
        return "not known" if math.isnan(value) else "∞"
    if value == 0.0 or _PLAIN[0] <= abs(value) < max(_PLAIN[1], 10.0**digits):
        return f"{float(f'{value:.{digits}g}'):.{max(digits, 12)}g}"
    first, _, ten = f"{value:.{digits - 1}e}".partition("e")
    return f"{first}·{power(int(ten))}"


def power(ten: int) -> str:
    """``10⁻⁵``."""
    return f"10{str(ten).translate(_SUPERSCRIPT)}"


def percent(share: float, short: bool = False) -> str:
    """A probability or a share: ``86 %``, ``more than 99.9 %``, ``less than 0.1 %``."""
    if share > 0.999:
        return "> 99.9 %" if short else "more than 99.9 %"
    if share < 0.001:
        return "< 0.1 %" if short else "less than 0.1 %"
    value = 100.0 * share
    return f"{value:.1f} %" if value < 1.0 or value > 99.0 else f"{value:.0f} %"


def p_text(p_value: float) -> str:
    """``p = 0.03``, or that it is below what can be told."""
    if p_value <= 1e-12:
        return f"p < {power(-12)}"
    return f"p = {number(p_value, 2).replace('.0·', '·')}"
