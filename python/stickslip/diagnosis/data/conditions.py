"""Drive settings of conditions, in words and in the units that a laboratory uses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from stickslip.scenario.keys import Value, known_keys

Conditions = Sequence[Mapping[str, Value]]
"""Drive settings by dotted key, of each condition."""

_SHOWN = {"T": ("mT", 1e3), "s": ("ms", 1e3)}
"""Units that a laboratory uses in place of SI units, and the factor to them."""


def varied(conditions: Conditions) -> list[str]:
    """Dotted keys of the settings that are not the same in all conditions."""
    if not conditions:
        return []
    present = [key for key in known_keys() if key in conditions[0]]
    return [key for key in present if len({each.get(key) for each in conditions}) > 1]


def find_singleton_condition(conditions: Conditions) -> int | None:
    """The first condition that alone has a mode, direction or other word, or alone differs in a
    setting that is the same in all others."""
    for key in varied(conditions):
        values = [each.get(key) for each in conditions]
        counts = Counter(values)
        if len(counts) == 2 or isinstance(values[0], str):
            for index, value in enumerate(values):
                if counts[value] == 1:
                    return index
    return None


def shown_unit(key: str) -> tuple[str, float]:
    """Unit in which a setting is shown, and the factor from SI to it."""
    return _SHOWN.get(known_keys()[key].unit, (known_keys()[key].unit, 1.0))


def shown_value(key: str, value: Value) -> str:
    """A setting's value as it is shown, without its unit."""
    if isinstance(value, (str, bool)):
        return str(value)
    return f"{float(value) * shown_unit(key)[1]:.5g}"


def panel(condition: Mapping[str, Value]) -> str:
    """Mode and direction, as in ``IPP +x``: what is drawn and counted together."""
    return f"{condition['drive.mode']} {condition['drive.direction']}"


def heading(key: str) -> str:
    """Name and unit of a setting, for a column."""
    return _with_unit(key, key.split(".")[1], "{} ({})")


def in_words(settings: Mapping[str, Value], keys: Sequence[str]) -> str:
    """Some settings of a condition, as in ``mode IPP, frequency 75 Hz, peak 3 mT``."""
    return ", ".join(
        _with_unit(key, f"{key.split('.')[1]} {shown_value(key, settings[key])}", "{} {}")
        for key in keys
    )


def named(condition: Mapping[str, Value], keys: Sequence[str]) -> dict[str, object]:
    """Fields of a fact about a condition: its name in words, and the same settings as data."""
    settings = {key.split(".")[1]: condition[key] for key in keys}
    return {"condition": in_words(condition, keys), "settings": settings}


def sorted_by_settings(
    conditions: Conditions, shown: Sequence[str], most: int
) -> dict[str, list[int]]:
    """Indices of the conditions of each kind, by the settings that `shown` does not hold, in words.

    The commonest come first; the others say what differs from them. More than `most` kinds become
    two: the commonest and all others.
    """
    keys = [key for key in varied(conditions) if key not in shown]
    settings = [tuple(each.get(key) for key in keys) for each in conditions]
    (usual, _), *others = Counter(settings).most_common()
    names = {usual: in_words(conditions[settings.index(usual)], keys)}
    for other, _ in others:
        differing = [key for key, a, b in zip(keys, other, usual, strict=True) if a != b]
        names[other] = in_words(conditions[settings.index(other)], differing)
        if len(others) >= most:
            names[other] = "other " + " or ".join(key.split(".")[1] for key in keys)
    result: dict[str, list[int]] = {name: [] for name in names.values()}
    for index, each in enumerate(settings):
        result[names[each]].append(index)
    return result


def _with_unit(key: str, text: str, form: str) -> str:
    unit = shown_unit(key)[0]
    return text if unit in ("", "-") else form.format(text, unit)


def changes(drive: Mapping[str, Value], conditions: Conditions) -> str:
    """The settings of a proposed experiment, bare names, that not all conditions have."""
    settings = {f"drive.{key}": value for key, value in drive.items()}
    among, first = varied(conditions), conditions[0]
    keys = [key for key in known_keys() if key in settings]
    return in_words(settings, [k for k in keys if k in among or first.get(k) != settings[k]])
