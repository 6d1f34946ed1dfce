"""Sentences of facts: the templates of two TOML files, and the functions that these name."""

from __future__ import annotations

import math
import string
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip._util.number_text import comma_hint
from stickslip._util.unit_factor import factor_text
from stickslip.facts.codes import Code
from stickslip.scenario.keys import shown

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Fields = Mapping[str, Any]

SENTENCES: Mapping[Code, str] = {
    Code(code): template
    for name in ("sentences.toml", "answers.toml")
    for code, template in tomllib.loads(
        Path(__file__).with_name(name).read_text(encoding="utf-8")
    ).items()
}
"""The template of each code."""

LINES = 5
"""Lines of a file that a sentence names; of more only the number is given. Chosen: one line."""

LIKELY, LITTLE = 0.75, 0.05
"""Probability from which on one of a set acts "probably", and up to which what is left over is not
told. Chosen."""

_ORIGINS = {
    "repeats": "the scatter of repeated readings",
    "smoothness": "how smoothly the readings follow the field",
    "free-fit": "what a free gain of each coil and a free uniform field leave over",
}


def mismatch(f: Fields, whose: str = "what the stated model gives") -> str:
    """A size that is far from the usual one, for what `magnitude_mismatch` found."""
    low, high = f["allowed"]
    text = (
        f"about {f['ratio']:.3g} times {whose} ({f['measured']:.3g} against {f['usual']:.3g} "
        f"{f['unit']}; allowed is {low:g} to {high:g} times)"
    )
    factor = f["unit_factor"]
    if factor is None:
        return text
    size = factor_text(max(factor, 1.0 / factor))
    return f"{text}, so a column may be in a unit that is wrong by {size}"


def _listed(names: Sequence[str], most: int = 4) -> str:
    """Names in a row, the first of them if they are many."""
    more = len(names) - most
    shown = list(names) if more <= 0 else [*names[:most], f"{more} more"]
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)


def _named_lines(f: Fields) -> str:
    """``line 3``; of a table in memory ``row 3``."""
    word = f.get("word", "line") + ("" if f["count"] == 1 else "s")
    more = ", ..." if f["count"] > LINES else ""
    return f"{word} " + ", ".join(map(str, f["lines"][:LINES])) + more


def _column_is(f: Fields) -> str:
    if not f["cell"]:
        return f"{f['column']} is empty"
    return f"{f['column']} {shown(f['cell'])} is not a number{comma_hint(f['cell'])}"


def _wrong_unit(f: Fields) -> str:
    factor = f["unit_factor"]
    if factor is None:
        return ""
    return f"; the factor of {factor_text(factor)} is that of a wrong unit"


def _to_seconds(f: Fields) -> str:
    if f["factor"] is None:
        return "divide ms by 1000, numbers of frames by the frame rate"
    return f"divide them by {f['factor']:.7g}"


def _first_conditions(f: Fields) -> str:
    more = f["count"] - len(f["conditions"])
    return "; ".join(f["conditions"]) + (f" and {more} more" if more > 0 else "")


def _reading(key: str) -> Callable[[Fields], str]:
    """A field that is an angle or a magnetic field, with its unit."""

    def text(f: Fields) -> str:
        angle = f["unit"] == "rad"
        return f"{math.degrees(f[key]):.2f} degrees" if angle else f"{f[key]:.2g} {f['unit']}"

    return text


def _uneven_parts(f: Fields) -> str:
    return " and ".join(
        f"in {each['part']} ({each['misfit']:.1f}, against {each['misfit_of_other']:.1f} in "
        f"{each['other']})"
        for each in f["parts"]
    )


def _extended(template: str) -> Callable[[Fields], str]:
    """What is said of the extended model, if there is one."""
    return lambda f: "" if f["extended"] is None else _FORMATTER.vformat(template, (), f)


def two_digits(value: float) -> str:
    """A number in two digits, or all that stand before its point."""
    return f"{value:.0f}" if 10.0 <= abs(value) < 1e6 else f"{value:.2g}"


def _percent(share: float) -> str:
    """A probability in per cent, without a false 0 or 100."""
    percent = 100.0 * share
    if percent < 0.1:
        return "less than 0.1 %"
    if percent > 99.9:
        return "more than 99.9 %"
    return f"{percent:.3g} %" if percent >= 99.0 else f"{two_digits(percent)} %"


def _odds(f: Fields) -> str:
    """``20 times`` of a lead in log-evidence."""
    if f["lead"] > math.log(1e6):
        return "more than a million times"
    ratio = float(f"{math.exp(f['lead']):.2g}")
    return f"{ratio:g} times" if ratio < 1e4 else f"{ratio:,.0f} times"


def _improvement(f: Fields) -> str:
    """How a headline ends: what was gained on held-out conditions, if that was tested."""
    if f["count"] is None:
        return ""
    where = f"errors on {f['count']} {f['thing']}s not used"
    change = f"from {f['before']} to {f['after']}"
    return {
        "falls": f": {where} fall {change}",
        "not sure": f"; {where}, too few to prove a gain, go {change}",
        "grows": f"; but {where} grow {change}",
    }[f["change"]]


def _counted(f: Fields) -> str:
    return f"{f['count']} {f['thing']}{'' if f['count'] == 1 else 's'}"


def _remedy_or_keep(f: Fields) -> str:
    """What to do about what was found."""
    keep = f"keep {'it' if f['causes'] == 1 else 'both'} in the model"
    if f["readings"]:
        return str(f["remedy"])  # the robot is as the model says, without them
    return f"{f['remedy']}, or {keep}" if f["remedy"] else keep.capitalize()


def _chances(f: Fields) -> str:
    """The probability of a cause, or those of several with their names."""
    if len(f["names"]) == 1:
        return _percent(f["probabilities"][0])
    each = zip(f["probabilities"], f["names"], strict=True)
    return ", ".join(f"{_percent(share)} for {name}" for share, name in each)


def _likely(f: Fields) -> str:
    """How a set begins: that one of it acts is likely, or is not."""
    return "Probably" if f["probability"] >= LIKELY else "Perhaps"


def _or_none(f: Fields) -> str:
    """The probability that none of a set acts, where it is more than a little."""
    none = 1.0 - f["probability"]
    return f"With a probability of {_percent(none)} it is none of these. " if none > LITTLE else ""


def _moved_briefly(f: Fields) -> str:
    """The constants that have moved, with their values."""
    if not f["moved"]:
        return ", which are all near what was stated"
    each = [
        f"{c['name']} {c['after']:.3g}"
        + ("" if c["before"] is None else f" instead of {c['before']:.3g}")
        + _unit_after(c)
        for c in f["moved"]
    ]
    return f": {'; '.join(each)}"


def _moved_in_full(f: Fields) -> str:
    """The same, with how far that is beside what was stated."""
    said = []
    for c in f["moved"]:
        start = "" if c["before"] is None else f"from {c['before']:.3g} to "
        far = "within the range that was stated"
        if c["pull"] is not None:
            far = f"{abs(c['pull']):.1f} standard deviations of what was stated"
        said.append(f"{c['name']} {start}{c['after']:.3g}{_unit_after(c)} ({far})")
    moved = f"Its constants that moved most: {'; '.join(said)}"
    if any(c["pull"] is not None for c in f["moved"]):
        return moved
    near = "No constant is more than 1 standard deviation from the value that was stated for it"
    return f"{near}. Found in the data: {'; '.join(said)}" if said else near


def _unit_after(constant: Fields) -> str:
    return f" {constant['unit']}".rstrip()


def _by_leading(f: Fields) -> str:
    """Which of several candidates the extended model has, where there are several."""
    return f", with {f['leading']}, the leading one," if f.get("leading") else ""


def _predicted_velocities(f: Fields) -> str:
    """What each candidate predicts of a proposed experiment."""
    each = [f"{p['velocity'] * 1e3:.3g} mm/s with {p['name']}" for p in f["predicted"]]
    return f"Predicted is {', '.join(each)}. " if each else ""


def _why_nothing(f: Fields) -> str:
    """Why no condition can be simulated, and what to do."""
    if f.get("refusal") is None:
        return "look at its settings, and whether [uncertain] has values that it forbids"
    friction = "contact.static_friction" in f["refusal"]
    settings = "raise contact.static_friction" if friction else "change the scenario"
    priors = "the prior of contact.kinetic_friction" if friction else "the priors"
    return f"{f['refusal']}; {settings}, or narrow {priors} in [uncertain]"


def _tried_in_vain(f: Fields) -> str:
    """How many causes explain nothing, alone or two together."""
    if f["count"] == 1:
        return "the one cause that was tried does not explain it"
    tried = f"none of the {f['count']} causes that were tried, nor any two of them together,"
    return f"{tried} explains it"


def _told_of_curve(f: Fields) -> str:
    """Where the data say something of a law of a free shape."""
    if f["told"] is None:
        return "At no u alone do these data say much of f(u), so that the curve is a guess"
    low, high = f["told"]
    return f"It is known for u from {low:.3g} to {high:.3g} {f['unit']}; elsewhere it is a guess"


_COMPUTED: Mapping[str, Callable[[Fields], str]] = {
    "at": lambda f: f"{f['table']} {_named_lines(f)}",
    "column_is": _column_is,
    "named_lines": _named_lines,
    "mismatch": mismatch,
    "mismatch_of_fastest": lambda f: mismatch(f, "the stated model's fastest"),
    "wrong_unit": _wrong_unit,
    "to_seconds": _to_seconds,
    "stated_problem": lambda f: str(f["problem"].rstrip(".")),
    "conditions_are": lambda f: "condition is" if f["count"] == 1 else "conditions are",
    "first_conditions": _first_conditions,
    "sd_of_reading": _reading("sd"),
    "taken_of_reading": _reading("taken"),
    "origin_in_words": lambda f: _ORIGINS[f["origin"]],
    "uneven_parts": _uneven_parts,
    "with_this": lambda f: "With both" if f.get("causes") == 2 else "With this cause",
    "faster_and_slower": lambda f: " and ".join(
        f"{how} in {_listed(f[how])}" for how in ("faster", "slower") if f[how]
    ),
    "extended_angle": _extended(", and the extended model by {extended!d:.2f} degrees"),
    "extended_field": _extended(", and the extended model by {extended!u:.3g} uT"),
    "extended_advance": _extended(", and the extended model by {extended!u:.5g} um"),
    "told_of_curve": _told_of_curve,
    "lead_in_words": lambda f: f"{abs(f['lead']):.1f} {'below' if f['lead'] < 0.0 else 'above'}",
    "why_nothing": _why_nothing,
    "tried_in_vain": _tried_in_vain,
    "origin_of_u": lambda f: f" less {f['origin']:g} {f['unit']}" if f["origin"] else "",
    "also": lambda f: f"; nearly as likely: {_listed(f['others'])}" if f["others"] else "",
    "gain_certainty": lambda f: "" if f["certain"] else "; its interval includes no gain",
    "in_own_unit": lambda f: "" if f["own"] == "-" else f" in {f['own']}",
    "improvement": _improvement,
    "in_unit": lambda f: "" if f["unit"] == "-" else f" {f['unit']}",
    "remedy_or_keep": _remedy_or_keep,
    "chances": _chances,
    "share_of_other": lambda f: _percent(f["other"]),
    "percents_before": lambda f: _percent(f["before"]),
    "percents": lambda f: _percent(f["probability"]),
    "chance": lambda f: f"{f['p_value']:.2g}" if f["p_value"] > 1e-12 else "less than 1e-12",
    "odds": _odds,
    "counted": _counted,
    "by_leading": _by_leading,
    "likely": _likely,
    "or_none": _or_none,
    "moved_briefly": _moved_briefly,
    "moved_in_full": _moved_in_full,
    "predicted_velocities": _predicted_velocities,
    "meaning_of": lambda f: f": {f['meaning']}" if f["meaning"] else "",
    "go_on": lambda f: "Go on" if f["first"] else "Or go on",
    "distance": lambda f: f"{abs(f['lead']):.1f} {'behind' if f['lead'] >= 0.0 else 'ahead'}",
}
"""What a template can name beside the fields."""


class _Counted(int):
    """A number before a thing: ``{count!n:frame}`` gives ``1 frame`` or ``3 frames``."""

    def __format__(self, thing: str) -> str:
        return f"{int(self)} {thing}{'' if self == 1 else 's'}"


_CONVERSIONS: Mapping[str, Callable[[Any], Any]] = {
    "c": lambda name: "no cause at all" if name == "none" else name,  # of a candidate
    "d": lambda angle: angle * math.degrees(1.0),
    "j": "; ".join,
    "l": _listed,
    "m": lambda value: value * 1e3,  # to milli
    "n": _Counted,
    "q": math.sqrt,  # of a chi-square
    "t": lambda values: "(" + ", ".join(f"{value:.3g}" for value in values) + ")",
    "u": lambda value: value * 1e6,  # to micro
    "v": shown,  # as a file has it
}
"""What stands after the exclamation mark of a name in a template."""


class _Formatter(string.Formatter):
    """`str.format` with the computed names and the conversions above."""

    def get_value(self, key: int | str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        return _COMPUTED[str(key)](kwargs) if key not in kwargs else kwargs[str(key)]

    def convert_field(self, value: Any, conversion: str | None) -> Any:
        return value if conversion is None else _CONVERSIONS[conversion](value)


_FORMATTER = _Formatter()


def sentence(code: Code, fields: Fields) -> str:
    """The sentence of a fact; fields that it does not name are ignored."""
    return _FORMATTER.vformat(SENTENCES[code], (), fields)
