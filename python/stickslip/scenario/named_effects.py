"""The named extensions of the model, and their settings within a scenario."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
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
    ['effects.surface_tilt.angle', 'effects.surface_tilt.azimuth']
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


def is_free_shape(name: str) -> bool:
    """Whether the model's own extension `name` is a curve of free shape at a place of the model.

    Its parameters are a ``span`` and the knots ``knot_1`` to ``knot_5``; see `theory/effects.md`.
    """
    return name.startswith("free_") and f"{PREFIX}{name}.knot_1" in known_keys()


def suggested_effect(name: str, others: Iterable[str] = ()) -> str:
    """Which extension `name` was probably meant to be, or all that could have been.

    Those of a free shape are many and alike, and are not listed. `others` are words that may be
    meant too.
    """
    names = [effect.name for effect in effects()]
    listed = [each for each in names if not is_free_shape(each)]
    return suggestion(name, [*names, *others], listed)


class EffectSettings(Mapping[str, Mapping[str, float]]):
    """Immutable settings of the named extensions: ``{name: {parameter: value}}``.

    A parameter at its default is left out, and so is an extension without any: an extension that
    does nothing and none at all are the same settings.
    """

    __slots__ = ("_flat",)

    def __init__(self, settings: Mapping[str, Mapping[str, float]] | None = None) -> None:
        values: dict[str, float] = {}
        if not isinstance(settings, Mapping | None):
            refuse("effects", settings, "a table [effects.<name>] for each extension")
        names = [effect.name for effect in effects()]
        for name, parameters in (settings or {}).items():
            if name not in names:
                hint = suggested_effect(str(name))
                raise ScenarioError(
                    f"effects.{name} = {shown(parameters)}: there is no such extension; {hint}; "
                    "one of your own has to be registered first"
                )
            if not isinstance(parameters, Mapping):
                refuse(f"effects.{name}", parameters, f"a table [effects.{name}]")
            for parameter, value in parameters.items():
                key = find_key(f"{PREFIX}{name}.{parameter}", value)
                values[key.name] = float(checked(key.name, value))
        self._flat = _without_defaults(values)

    def __getitem__(self, name: str) -> Mapping[str, float]:
        start = f"{PREFIX}{name}."
        found = {k.removeprefix(start): v for k, v in self._flat.items() if k.startswith(start)}
        if not found:
            raise KeyError(name)
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(key.split(".")[1] for key in self._flat))

    def __len__(self) -> int:
        return len(list(iter(self)))

    def __hash__(self) -> int:
        return hash(tuple(self._flat.items()))

    def __eq__(self, other: object) -> bool:
        if isinstance(other, EffectSettings):
            return self._flat == other._flat
        return dict(self.items()) == other

    def __repr__(self) -> str:
        return repr(dict(self.items()))

    def __reduce__(self) -> tuple[Any, ...]:
        return EffectSettings, (dict(self.items()),)

    def with_values(self, values: Mapping[str, float]) -> EffectSettings:
        """A copy with other values, by ``name.parameter``, that are checked already."""
        made = object.__new__(EffectSettings)
        changes = {f"{PREFIX}{key}": value for key, value in values.items()}
        made._flat = _without_defaults({**self._flat, **changes})
        return made

    def flat(self) -> dict[str, float]:
        """The settings by dotted key, such as ``"effects.surface_tilt.angle"``."""
        return dict(self._flat)


def _without_defaults(values: Mapping[str, float]) -> dict[str, float]:
    return {key: values[key] for key in sorted(values) if values[key] != known_keys()[key].default}
