"""The keys of a scenario, from the core's table, and setting them in the core's scenario."""

from __future__ import annotations

import functools
import keyword
import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, ParamSpec, TypeVar

from stickslip import _core
from stickslip._util.messages import meant, nearest, refuse, shown, suggestion
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError
from stickslip.scenario.held import PATHS, TABLES

Value = float | int | str
"""The types of a key's value."""

RECORD_RATE = "record.rate"

PREFIX = "effects."

LAWS = "laws."

COIL_NAMES = _core.coil_names
"""Order of the coils in every array of currents or voltages: +x, -x, +y, -y, and below (-z)."""

GEOMETRY = ("side", "distance", "turns")
"""Dimensions of a coil that only its field depends on, so that a map takes their place."""

PROGRAM, FILE = "drive.program", "drive.file"
"""The waveform of a drive, and its path in a file and with --set."""

COIL_MAP = "coil.map"
"""The measured field of the coils."""

SECTIONS_BESIDE = {
    **{key: held.about for key, held in TABLES.items()},
    "uncertain": 'a section of priors, one line a key, such as "drag.linear" = { mean = 1e-5, sd = '
    "1e-6 }; in Python Scenario.with_uncertain; predict also takes --uncertain FILE",
}
"""What sections without keys of a scenario are."""

ROUND_HINT = (
    "coils are square; a round one of radius R is close to side = 1.77 R, a square of the same area"
)
"""For who asks for a radius. At R = 40 mm, 60 mm away, such a square has 1.4 % less field and 0.2 %
less gradient over field than a circle, whose field is known in closed form."""

MEASURED = {"radius": "side = 1.77 radius", "rise_time": "inductance = resistance * rise_time"}
"""Words of `Coil.of`, and what a coil has in their place whose turns are known."""

_RANGES = (
    (0.5, 5e3, "Hz", "drive.frequency"),
    (0.0, 0.1, "T", "drive.peak drive.base drive.hold"),
    (1e-7, 3.0, "s", "drive.ramp drive.ramp_down drive.edge_time drive.latency"),
    (1e-2, 1e4, "ohm", "coil.resistance"),
    (1e-7, 2.0, "H", "coil.inductance"),
    (1e-9, 0.1, "F", "coil.capacitance"),
    (1e-3, 1.0, "m", "coil.side coil.distance"),
    (1e-6, 0.1, "m", "robot.length robot.width robot.height"),
    (1e-13, 0.3, "kg", "robot.mass inner.mass"),
    (1e3, 2e6, "A/m", "robot.magnetization"),
    (1e-13, 0.05, "N", "contact.adhesion"),
    (0.1, 100.0, "m/s^2", "environment.gravity"),
    (1e-5, 100.0, "Pa s", "fluid.viscosity"),
    (1.0, 1.4e4, "kg/m^3", "fluid.density"),
    (1e-9, 1e-2, "m", "shake.amplitude_x shake.amplitude_z"),
    (2.0, 1e6, "Hz", "shake.frequency inner.frequency"),
    (1e-11, 100.0, "N", "inner.amplitude"),
    (0.0, 0.2, "m", "inner.stop_low inner.stop_high initial.x initial.y initial.z"),
    (0.0, 0.03, "T", "effects.ambient_field.Bx effects.ambient_field.By effects.ambient_field.Bz"),
    (0.0, 5e-2, "s", "effects.eddy_lag.time effects.sample_hold.period"),
)
USUAL = {name: row[:3] for row in _RANGES for name in row[3].split()}
"""Magnitudes, from and to, that keys and what a fluid or a table of a period gives usually have,
and their unit. Chosen: what is known of small robots, with a decade to spare; other units, by a
thousand, are mostly beyond. Zero, and each default, is usual too."""

_P = ParamSpec("_P")
_R = TypeVar("_R")


def until_registration(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Cache a function of the keys until an effect is registered, which adds keys."""
    cached = functools.lru_cache(maxsize=256)(
        lambda _registrations, *args, **named: function(*args, **named)
    )

    @functools.wraps(function)
    def kept(*args: _P.args, **named: _P.kwargs) -> _R:
        return cached(_core.registrations(), *args, **named)  # type: ignore[arg-type]

    return kept


@dataclass(frozen=True)
class Key:
    """One key of a scenario that holds a number or a word.

    Attributes
    ----------
    name : str
        Dotted key, such as ``"drive.frequency"``.
    kind : {"real", "whole", "word", "rate", "fields"}
        What it holds; ``"rate"`` is a number or a word, ``"fields"`` names of recorded quantities.
    allowed : str
        The range or the words, for a reader.
    default : float, int or str
        Value that a scenario has where none is given.
    meaning : str
        What it is, in a phrase.
    unit : str
        SI unit; ``"-"`` for none.
    low, high : float
        Range of a number; NaN for a word.
    words : tuple of str
        The words that it takes; of ``"fields"``, one or more of them.
    """

    name: str
    kind: Literal["real", "whole", "word", "rate", "fields"]
    allowed: str
    default: Value
    meaning: str
    unit: str = "-"
    low: float = math.nan
    high: float = math.nan
    words: tuple[str, ...] = ()

    @property
    def section(self) -> str:
        """Everything before the last dot."""
        return self.name.rpartition(".")[0]

    @property
    def field(self) -> str:
        """The name in Python: ``from`` is a word of the language."""
        name = self.name.rpartition(".")[2]
        return f"{name}_" if keyword.iskeyword(name) else name

    @property
    def usual(self) -> tuple[float, float, str] | None:
        """Magnitudes that it usually has, from and to, and their unit; None where all are usual."""
        return USUAL.get(re.sub(rf"^coil\.({'|'.join(COIL_NAMES)})\.", "coil.", self.name))


class KnownKeys(dict[str, Key]):
    """The keys that every scenario has, by name; those of laws, whatever theirs, are found too."""

    def __missing__(self, name: str) -> Key:
        key = _law_key(name)
        if key is None:
            raise KeyError(name)
        return key

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (isinstance(name, str) and _law_key(name) is not None)


@functools.lru_cache(maxsize=256)
def _law_key(name: str) -> Key | None:
    row = _core.law_key(name) if name.startswith(LAWS) else None
    return None if row is None else Key(**row)


@until_registration
def known_keys() -> KnownKeys:
    """All keys by name, section by section."""
    return KnownKeys((row["name"], Key(**row)) for row in _core.key_table())


@until_registration
def keys_of(section: str) -> tuple[Key, ...]:
    """The keys of a section itself."""
    return tuple(key for key in known_keys().values() if key.section == section)


SAWTOOTH = tuple(
    key.name
    for key in keys_of("drive")
    if key.name not in ("drive.mode", "drive.direction", "drive.latency")
)
"""Keys of a pulsed drive, which a program of voltages does not use."""

IDLE = {
    "program": SAWTOOTH,
    "none": (
        *(key for key in SAWTOOTH if key not in ("drive.frequency", "drive.pulses")),
        "drive.latency",
    ),
}
"""Those that a mode of the drive does not use."""


def refuse_sawtooth(mode: object, given: Iterable[str]) -> None:
    """Refuse the first key of the sawtooth that is given with a mode that does not use it."""
    key = next((key for key in given if key in IDLE.get(str(mode), ())), None)
    if mode == "none" and key is not None:
        raise ScenarioError(
            f'{key}: not allowed with drive.mode = "none", where nothing drives the coils; '
            "leave it out"
        )
    if key is not None:
        raise ScenarioError(
            f'{key}: not allowed with drive.mode = "program", whose voltages ({FILE}, or {PROGRAM} '
            "in Python) say it all; leave it out"
        )


def in_allowed_case(key: Key, word: str) -> str:
    """A word as the key allows it: an apparatus may write "ipp", "+X", "x" or another minus."""
    word = word.replace("\N{MINUS SIGN}", "-")
    spelt = (word, word.upper(), word.lower(), f"+{word.lower()}")
    return next((form for form in spelt if form in key.words), word)


def key_hint(name: str, others: Iterable[str] = ()) -> str:
    """The key that was probably meant, by its whole name or its last word, or its section.

    `others` are names of another kind that may be meant too.
    """
    keys = known_keys()
    if of_round_coil(name):
        return ROUND_HINT
    section = name.rpartition(".")[0]
    if name.startswith(LAWS):
        return _law_hint(name)
    if name in SECTIONS_BESIDE:
        return f"it is {SECTIONS_BESIDE[name]}"
    inside = next((key for key in (*keys, f"{LAWS}NAME") if key.startswith(f"{name}.")), None)
    if inside is not None:
        return f"it is a section: change its keys one by one, such as {inside}"
    of_coil = f"{name.removesuffix('s')}_{COIL_NAMES[0]}"
    if of_coil in keys:
        return f"give {of_coil} = 1.0, one key a coil"
    siblings = [key.name for key in keys_of(section)]
    siblings += [key for key in PATHS if siblings and key.startswith(f"{section}.") and key != name]
    if siblings:
        return suggestion(name, siblings)
    last = {} if section else {key.rpartition(".")[2]: key for key in reversed(keys)}
    near = nearest(name, [*keys, *last, *others])
    if near is not None:
        return f'did you mean "{last.get(near, near)}"?'
    sections = dict.fromkeys([*(key.section for key in keys.values()), LAWS[:-1]])
    return suggestion(section, sections, dict.fromkeys(name.partition(".")[0] for name in sections))


def _law_hint(name: str) -> str:
    law, _, last = name.rpartition(".")
    if law == LAWS[:-1]:  # without a key
        law, last = name, ""
    if not re.fullmatch(r"[A-Za-z_]\w*", law.removeprefix(LAWS), re.ASCII):
        return 'the name of a law has letters, digits and "_", and no digit first'
    if last == "knots":
        return f"knots are one by one here, {law}.knot_1 to {law}.knot_5"
    return suggestion(name if last else "", [f"{law}.{key}" for key in _core.law_keys])


def of_round_coil(key: str) -> bool:
    """Whether a key that is none would be the radius or diameter of a coil."""
    return re.fullmatch(r"coil\.(.*_)?(radius|diameter)", key.casefold()) is not None


def full_name(name: str) -> str:
    """The dotted key of a parameter of an effect that is named without ``effects.``."""
    keys = known_keys()
    return f"{PREFIX}{name}" if name not in keys and f"{PREFIX}{name}" in keys else name


def is_of_one_coil(key: str) -> bool:
    """Whether a key is of a single coil, such as ``coil.xp.turns``."""
    return key.startswith("coil.") and key.count(".") > 1


def check_word(key: object) -> None:
    """Refuse what is no word, and so no key."""
    if not isinstance(key, str):
        raise ScenarioError(f"key {shown(key)}: allowed is a word such as drive.frequency")


def find_key(name: str, *value: object) -> Key:
    """The key of that name, or an error that names the nearest one, and the value if there is."""
    check_word(name)
    keys = known_keys()
    if name in keys:
        return keys[name]
    given = " = ".join([name, *map(shown, value)])
    hint = f" here; {PATHS[name].hint}" if name in PATHS else f"; {key_hint(name)}"
    raise ScenarioError(f"{given}: there is no such key{hint}") from None


def set_value(core: _core.Scenario, name: str, value: object) -> None:
    """Set a key in the core's scenario, which decides what is allowed.

    Added here: the type of the value before it became a number or a word, and an error that
    suggests the intended name or unit.
    """
    try:
        core.set(name, value)  # type: ignore[arg-type]
        return
    except (ValueError, TypeError, OverflowError):
        key = find_key(name, value)
    if key.kind == "fields" and isinstance(value, list | tuple) and value:
        given: object = ", ".join(map(str, value))
    elif is_number(value) and not isinstance(value, int | float):
        given = float(value)
    else:
        given = None
    try:
        core.set(name, given)  # type: ignore[arg-type]
    except (ValueError, TypeError, OverflowError):
        words = [word.strip() for word in value.split(",")] if isinstance(value, str) else []
        wrong = next((word for word in words if word not in key.words), None)
        near = meant(wrong and in_allowed_case(key, wrong), key.words)
        refuse(name, value, key.allowed + near)


def checked(name: str, value: object) -> Value:
    """The value of a key as a scenario would hold it: a float, int or str, if it is allowed."""
    core = _core.Scenario()
    set_value(core, name, value)
    return core.get(name)


def coil_places(coils: object) -> list[int]:
    """Find where in `COIL_NAMES` the named coils stand, each once; else refuse them."""
    names = list(coils) if isinstance(coils, Sequence) and not isinstance(coils, str) else []
    unknown = [name for name in names if name not in COIL_NAMES]
    if unknown or not names or len(set(names)) < len(names):
        hint = meant(unknown[0], COIL_NAMES) if unknown else ""
        refuse("coils", coils, f"a list of some of {', '.join(COIL_NAMES)}, each coil once{hint}")
    return [COIL_NAMES.index(name) for name in names]
