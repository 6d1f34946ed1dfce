"""What is not known exactly of a scenario: priors of single keys, and a covariance of others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.numbers import Array
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import (
    check_whole,
    checked,
    find_key,
    full_name,
    known_keys,
    shown,
    suggestion,
)
from stickslip.scenario.priors import Prior, parse_prior

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

Matrix = tuple[tuple[float, ...], ...]

COVARIANCE = "covariance"
"""The section of ``[uncertain]`` that is no key."""

MOST_DRAWS = 100
"""Draws in succession that may make no scenario. Chosen: where one in twenty makes one, a hundred
fail once in 170 times; a prior of which less is allowed is a mistake."""

# Chosen: a covariance in a file may be rounded to ten digits.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class JointPrior:
    """What is not known exactly of a scenario, in a file its section ``[uncertain]``.

    A key has a prior of its own, or it stands in the covariance, never both. A prior says itself
    where it lies; the value of its key in the scenario, which `simulate` takes, has no influence
    on draws. The keys of the covariance are jointly normal about their values in the scenario.

    Parameters
    ----------
    priors : mapping
        By dotted key, of effects also by short name: a `Prior`, or a table such as
        ``{"mean": 0.145, "sd": 0.01}``, in the key's unit. Independent of each other and of the
        covariance.
    keys : sequence of str
        Keys of the covariance.
    matrix : array-like, shape (len(keys), len(keys))
        The covariance, in products of the keys' units; symmetric, and no eigenvalue is below zero.

    Raises
    ------
    ScenarioError
        If a key is unknown, given twice or no constant of the model, if a prior is none, or if the
        middle of a prior or the matrix is not allowed.

    Examples
    --------
    >>> prior = JointPrior({"drag.linear": {"median": 1e-5, "factor": 2.0}})
    >>> prior.names
    ('drag.linear',)
    """

    priors: Mapping[str, Prior] = field(default_factory=dict)
    keys: tuple[str, ...] = ()
    matrix: Matrix = ()

    def __post_init__(self) -> None:
        priors = parse_priors(self.priors)
        keys = _checked_keys(self.keys, priors)
        # In one order, as equal tables have equal draws.
        object.__setattr__(self, "priors", {key: priors[key] for key in sorted(priors)})
        object.__setattr__(self, "keys", keys)
        object.__setattr__(self, "matrix", _checked_matrix(self.matrix, keys))
        if not self.names:
            raise ScenarioError("[uncertain] is empty: allowed is a key with its prior, or more")

    def __hash__(self) -> int:
        return hash((tuple(self.priors.items()), self.keys, self.matrix))

    @property
    def names(self) -> tuple[str, ...]:
        """All keys that are uncertain."""
        return (*self.priors, *self.keys)

    @cached_property
    def _root(self) -> Array:
        """What takes independent standard normal numbers to those of the covariance.

        By the symmetric root of the correlations, as it is the only one of its kind: no choice of
        eigenvectors has an influence on the draws.
        """
        covariance = np.array(self.matrix, dtype=float).reshape(len(self.keys), len(self.keys))
        values, vectors = np.linalg.eigh(_correlation(covariance))
        root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
        return np.asarray(np.sqrt(np.diag(covariance))[:, None] * root)

    def draw(self, scenario: Scenario, random: np.random.Generator) -> Scenario:
        """The scenario with drawn values in place of what is uncertain.

        Values that make no scenario are drawn again, so that the distribution is cut off there.

        Raises
        ------
        ScenarioError
            If a hundred draws in succession make none.
        """
        return self.counted_draw(scenario, random)[0]

    def counted_draw(self, scenario: Scenario, random: np.random.Generator) -> tuple[Scenario, int]:
        """See `draw`; and how many draws before it made no scenario."""
        middle = np.array([scenario.get(key) for key in self.keys])
        for refused in range(MOST_DRAWS):
            z = random.standard_normal(len(self.names))
            single, joint = z[: len(self.priors)], z[len(self.priors) :]
            drawn = [prior.value(u) for prior, u in zip(self.priors.values(), single, strict=True)]
            values = map(float, [*drawn, *(middle + self._root @ joint)])
            try:
                return scenario.replace(dict(zip(self.names, values, strict=True))), refused
            except ScenarioError as error:
                last = error
        raise ScenarioError(
            f"[uncertain]: {MOST_DRAWS} draws in succession make no scenario, so hardly any is "
            f"allowed; the last: {last}"
        )


def as_joint_prior(given: object) -> JointPrior:
    """What `Scenario` takes as `uncertain`: a `JointPrior`, or the tables of ``[uncertain]``."""
    if isinstance(given, JointPrior):
        return given
    if not isinstance(given, Mapping):
        raise ScenarioError(f"uncertain = {shown(given)}: allowed is a section [uncertain]")
    priors = {key: each for key, each in given.items() if key != COVARIANCE}
    covariance = given.get(COVARIANCE, {"keys": (), "matrix": ()})
    section = f"[uncertain.{COVARIANCE}]"
    if not isinstance(covariance, Mapping):
        raise ScenarioError(f"{section} = {shown(covariance)}: allowed is a section {section}")
    for name in covariance:
        if name not in ("keys", "matrix"):
            hint = suggestion(str(name), ("keys", "matrix"))
            raise ScenarioError(f"{section} {name}: there is no such entry; {hint}")
    for name in ("keys", "matrix"):
        if name not in covariance:
            raise ScenarioError(f"{section} {name} is missing: it has keys and matrix")
    if not priors and COVARIANCE in given and covariance["keys"] in ([], ()):
        raise ScenarioError(f"{section} keys is empty: allowed is a key or more")
    return JointPrior(priors, covariance["keys"], covariance["matrix"])


def parse_priors(table: object) -> dict[str, Prior]:
    """Priors by dotted key, whose middles are allowed values of constants of the model."""
    if not isinstance(table, Mapping):
        raise ScenarioError(f"uncertain = {shown(table)}: allowed is a section [uncertain]")
    priors: dict[str, Prior] = {}
    for name, entry in table.items():
        for inner in entry if isinstance(entry, dict) else ():
            if f"{name}.{inner}" in known_keys():
                raise ScenarioError(
                    f"[uncertain] {name}.{inner}: a key with a dot is written in quotation marks, "
                    f'"{name}.{inner}" = ...'
                )
        if isinstance(entry, Mapping) and not {"keys", "matrix"}.isdisjoint(entry):
            hint = suggestion(str(name), [COVARIANCE])
            raise ScenarioError(f"[uncertain.{name}]: there is no such section; {hint}")
        with prefixed("[uncertain]"):
            name = _constant(name, entry)
        if name in priors:
            raise ScenarioError(f'[uncertain] "{name}" is there twice: allowed is once')
        prior = entry if isinstance(entry, Prior) else parse_prior(name, entry)
        with prefixed(f'[uncertain] "{name}" = {prior}'):
            checked(name, float(prior.value(0.0)))
        priors[name] = prior
    return priors


def counted_draws(scenario: Scenario, count: int, seed: int) -> tuple[list[Scenario], int]:
    """See `Scenario.draws`; and how many draws besides made no scenario."""
    check_whole("n", count, 1)
    check_whole("seed", seed)
    if scenario.uncertain is None:
        raise ScenarioError("uncertain: there is nothing to draw, as the scenario holds none")
    known = scenario.with_uncertain(None)
    found = [
        scenario.uncertain.counted_draw(known, np.random.default_rng([int(seed), number]))
        for number in range(count)
    ]
    return [each for each, _ in found], sum(refused for _, refused in found)


def _constant(name: str, *entry: object) -> str:
    """The full name of a key that may be uncertain."""
    name = full_name(name) if isinstance(name, str) else shown(name)
    key = find_key(name, *entry)
    if key.kind != "real" or name.startswith(("drive.", "solver.", "record.")):
        raise ScenarioError(
            f'"{name}": allowed is a constant of the model; what is a number there '
            "and not in [drive], [solver] or [record]"
        )
    return name


def _checked_keys(keys: object, priors: Mapping[str, Prior]) -> tuple[str, ...]:
    where = f"[uncertain.{COVARIANCE}] keys"
    if isinstance(keys, str | bytes | Mapping) or not isinstance(keys, Iterable):
        raise ScenarioError(f"{where} = {shown(keys)}: allowed is a list of keys")
    with prefixed(where):
        names = tuple(_constant(key) for key in keys)
    for place, name in enumerate(names):
        if name in names[:place]:
            raise ScenarioError(f'{where}: "{name}" is there twice; allowed is once')
        if name in priors:
            raise ScenarioError(
                f'{where}: "{name}" has a prior of its own too; allowed is one of the two'
            )
    return names


def _checked_matrix(given: object, keys: Sequence[str]) -> Matrix:
    """The covariance, if it is one of as many keys."""
    where = f"[uncertain.{COVARIANCE}] matrix"
    size = len(keys)
    rows: Any = given.tolist() if isinstance(given, np.ndarray) else given
    if not _is_list(rows) or len(rows) != size:
        found = f"{len(rows)} rows" if _is_list(rows) else shown(rows)
        raise ScenarioError(f"{where} = {found}: allowed are {size} rows, one for each key")
    for key, row in zip(keys, rows, strict=True):
        if not _is_list(row) or len(row) != size or not all(map(is_number, row)):
            allowed = f"{size} numbers, one for each key"
            raise ScenarioError(f'{where}, row of "{key}" = {shown(row)}: allowed are {allowed}')
    matrix = np.array(rows, dtype=float).reshape(size, size)
    if not np.isfinite(matrix).all():
        raise ScenarioError(f"{where}: allowed are finite numbers")
    variance = np.diag(matrix)
    for key, value in zip(keys, variance.tolist(), strict=True):
        if value < 0.0 or (value == 0.0 and matrix[keys.index(key)].any()):
            allowed = "a number above 0, or a row and a column of zeros"
            raise ScenarioError(
                f'{where}: the variance of "{key}" is {value:g}; allowed is {allowed}'
            )
    # In units of the standard deviations all entries of a covariance are within one.
    unit = np.outer(*2 * (np.sqrt(variance),))
    skew = np.argwhere(np.abs(matrix - matrix.T) > _ROUNDING * unit)
    if len(skew):
        i, j = skew[0].tolist()
        raise ScenarioError(
            f'{where} is not symmetric: {matrix[i, j]:g} of "{keys[i]}" with "{keys[j]}", and '
            f"{matrix[j, i]:g} the other way"
        )
    lowest = float(np.linalg.eigvalsh(_correlation(matrix)).min(initial=0.0))
    if lowest < -_ROUNDING * size:
        raise ScenarioError(
            f"{where} is no covariance: the least eigenvalue of its correlations is {lowest:.3g}; "
            "allowed is from 0"
        )
    return tuple(map(tuple, matrix.tolist()))


def _is_list(value: Any) -> bool:
    return isinstance(value, list | tuple)


def _correlation(covariance: Array) -> Array:
    """Correlations; of a key without variance, none."""
    sd = np.sqrt(np.diag(covariance))
    scale = np.divide(1.0, sd, out=np.zeros_like(sd), where=sd > 0.0)
    return np.asarray(covariance * np.outer(scale, scale))
