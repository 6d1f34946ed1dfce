"""The named extensions of the model, and their settings within a scenario."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from stickslip import _core
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import (
    Key,
    checked,
    find_key,
    known_keys,
    refuse,
    shown,
    suggestion,
    until_registration,
)

PREFIX = "effects."


@dataclass(frozen=True)
class Effect:
    """A named extension of the model.

    Attributes
    ----------
    name : str
        Name of its section: ``[effects.<name>]``.
    meaning : str
        What it adds, in a sentence.
    source : str
        Where its equation is from.
    parameters : tuple of Key
        Its parameters with units and ranges. The extension is absent while all of them have their
        default.
    """

    name: str
    meaning: str
    source: str
    parameters: tuple[Key, ...]


@until_registration
def effects() -> tuple[Effect, ...]:
    """All named extensions of the model, and after them those of `register_effect`.

    Returns
    -------
    tuple of Effect

    Examples
    --------
    >>> tilt = next(effect for effect in effects() if effect.name == "surface_tilt")
    >>> [key.name for key in tilt.parameters]
    ['effects.surface_tilt.angle']
    """
    return tuple(
        Effect(
            row["name"],
            row["meaning"],
            row["source"],
            tuple(k for k in known_keys().values() if k.section == PREFIX + row["name"]),
        )
        for row in _core.effects()
    )


class EffectSettings(Mapping[str, Mapping[str, float]]):
    """Immutable settings of the named extensions: ``{name: {parameter: value}}``.

    A parameter at its default is left out, and so is an extension without any: an extension that
    does nothing and none at all are the same settings.
    """

    __slots__ = ("_values",)

    def __init__(self, settings: Mapping[str, Mapping[str, float]] | None = None) -> None:
        values: dict[str, dict[str, float]] = {}
        if not isinstance(settings, Mapping | None):
            refuse("effects", settings, "a table [effects.<name>] for each extension")
        names = [effect.name for effect in effects()]
        for name, parameters in (settings or {}).items():
            if name not in names:
                hint = suggestion(str(name), names)
                raise ScenarioError(
                    f"effects.{name} = {shown(parameters)}: there is no such extension; {hint}; "
                    "one of your own has to be registered first"
                )
            if not isinstance(parameters, Mapping):
                refuse(f"effects.{name}", parameters, f"a table [effects.{name}]")
            for parameter, value in parameters.items():
                key = find_key(f"{PREFIX}{name}.{parameter}", value)
                number = float(checked(key.name, value))
                if number != key.default:
                    values.setdefault(name, {})[str(parameter)] = number
        self._values: tuple[tuple[str, tuple[tuple[str, float], ...]], ...] = tuple(
            sorted((name, tuple(sorted(each.items()))) for name, each in values.items())
        )

    def __getitem__(self, name: str) -> Mapping[str, float]:
        for known, parameters in self._values:
            if known == name:
                return dict(parameters)
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (name for name, _ in self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __hash__(self) -> int:
        return hash(self._values)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, EffectSettings):
            return self._values == other._values
        return dict(self.items()) == other

    def __repr__(self) -> str:
        return repr(dict(self.items()))

    def __reduce__(self) -> tuple[Any, ...]:
        return EffectSettings, (dict(self.items()),)

    def with_values(self, values: Mapping[str, float]) -> EffectSettings:
        """A copy with other values, by ``name.parameter``, that are checked already."""
        settings = {f"{PREFIX}{key}": value for key, value in values.items()}
        settings = {**self.flat(), **settings}
        grouped: dict[str, list[tuple[str, float]]] = {}
        for key, value in sorted(settings.items()):
            if value != known_keys()[key].default:
                _, name, parameter = key.split(".", 2)
                grouped.setdefault(name, []).append((parameter, value))
        made = object.__new__(EffectSettings)
        made._values = tuple((name, tuple(each)) for name, each in grouped.items())
        return made

    def flat(self) -> dict[str, float]:
        """The settings by dotted key, such as ``"effects.surface_tilt.angle"``."""
        return {
            f"{PREFIX}{name}.{parameter}": value
            for name, parameters in self._values
            for parameter, value in parameters
        }
