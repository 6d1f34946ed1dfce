"""The base of a scenario's sections: values, names and texts from the core's table."""

from __future__ import annotations

import functools
import inspect
import textwrap
from collections.abc import Mapping
from typing import Any, ClassVar, TypeVar

from stickslip import _core
from stickslip._util.messages import known_arguments, shown, suggestion
from stickslip.errors import ScenarioError
from stickslip.scenario.changes import Changes
from stickslip.scenario.held import OBJECTS, Held
from stickslip.scenario.keys import ROUND_HINT, Key, keys_of, of_round_coil

_S = TypeVar("_S", bound="Section")


class Section:
    """A section of a scenario: read-only values, whose names are the core's keys.

    Made from values by name, with defaults for the others, or the view of a scenario. Sections are
    equal if their values are.
    """

    __slots__ = ("_core", "_held")

    _name: ClassVar[str]
    _keys: ClassVar[dict[str, str]]
    """The dotted key of each field that is one."""

    _fields: ClassVar[tuple[str, ...]]

    _core: Any
    """Where the values are: a scenario of the core, shared and never changed, or a state."""

    _held: dict[str, Any]
    """Objects by their keys: those of the section, and of others in the view of a scenario."""

    def __init_subclass__(cls, key: str, **others: str) -> None:
        keys = keys_of(key)
        objects = [held for held in OBJECTS.values() if held.section == key]
        cls._name, cls._keys = key, {entry.field: entry.name for entry in keys}
        cls._keys |= {held.field: held.key for held in objects}
        kinds = {each.field: f"{each.class_name}, optional: {each.meaning}" for each in objects}
        others = {**kinds, **others}
        cls._fields = tuple(dict.fromkeys((*cls._keys, *others)))
        for entry in keys:
            setattr(cls, entry.field, _property(entry))
        for held in objects:
            setattr(cls, held.field, _held_property(held))
        cls.__doc__ = "\n".join([_core.sections[key], *_documentation(keys, others)])
        cls.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [_parameter(k.field, k.default) for k in keys] + [_parameter(n, None) for n in others]
        )
        known_arguments(cls)

    def __init__(self, **values: object) -> None:
        self._core, self._held = _core.Scenario(), {}
        changes = [self._changes(field, value) for field, value in values.items()]
        Changes(*changes).apply(self._core, self._held)

    def _changes(self, field: str, value: Any) -> dict[str, Any]:
        """The changes that the value of a field makes, by dotted key."""
        if field not in self._fields:
            given = f"{self._name}.{field} = {shown(value)}"
            round_one = of_round_coil(f"{self._name}.{field}")
            hint = ROUND_HINT if round_one else suggestion(field, self._fields)
            raise ScenarioError(f"{given}: there is no such key; {hint}")
        return {self._keys[field]: value}

    @classmethod
    def view(cls: type[_S], core: Any, held: Mapping[str, Any] | None = None) -> _S:
        """The section of a scenario of the core, which nobody may change from then on."""
        made = object.__new__(cls)
        made._core, made._held = core, dict(held or {})
        return made

    @property
    def objects(self) -> dict[str, Any]:
        """The objects of this section by their keys."""
        return {key: value for key, value in self._held.items() if key in self._keys.values()}

    def as_dict(self) -> dict[str, Any]:
        """The values by name."""
        return {field: getattr(self, field) for field in self._fields}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.as_dict() == other.as_dict()

    def __hash__(self) -> int:
        return hash(tuple(self.as_dict().items()))

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value!r}" for name, value in self.as_dict().items())
        return f"{type(self).__name__}({values})"

    def __reduce__(self) -> tuple[Any, ...]:
        return functools.partial(type(self), **self.as_dict()), ()


def _property(key: Key) -> property:
    return property(lambda self: self._core.get(key.name), doc=_meaning(key))


def _held_property(held: Held) -> property:
    return property(lambda self: self._held.get(held.key), doc=f"{held.meaning} None without.")


def _meaning(key: Key) -> str:
    unit = "" if key.unit == "-" else f", {key.unit}"
    return f"{key.meaning[:1].upper()}{key.meaning[1:]}{unit}; by default {shown(key.default)}."


def kind_of(key: Key) -> str:
    """The type of a key's values, as a docstring has it."""
    if key.kind in ("real", "whole"):
        return "float" if key.kind == "real" else "int"
    words = "{" + ", ".join(f'"{word}"' for word in key.words) + "}"
    return {"rate": f"float or {words}", "fields": "str or sequence of str"}.get(key.kind, words)


def _documentation(keys: tuple[Key, ...], others: dict[str, str]) -> list[str]:
    lines = ["", "Parameters", "----------"]
    for key in keys:
        lines += [f"{key.field} : {kind_of(key)}", *_indented(_meaning(key))]
    for name, text in others.items():
        kind, _, meaning = text.partition(": ")
        lines += [f"{name} : {kind}", *_indented(meaning)]
    return lines


def _indented(text: str) -> list[str]:
    return textwrap.wrap(text, 96, initial_indent="    ", subsequent_indent="    ")


def _parameter(name: str, default: object) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default)
