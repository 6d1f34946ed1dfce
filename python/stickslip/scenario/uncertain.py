"""Uncertain parameters of a scenario: priors of single keys, and a covariance of others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stickslip._util.arrays import Array, numbers
from stickslip._util.messages import known_arguments, shown
from stickslip._util.prior import Prior
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import COIL_MAP, GEOMETRY, checked, find_key, full_name, known_keys

_FORMS = "{ mean, sd }, { median, factor }, { min, max } (uniform) or { low, high } (log-uniform)"


def parse_prior(key: str, table: object) -> Prior:
    """The prior of one entry of ``[uncertain]``; a ScenarioError if it is none of the forms."""
    try:
        prior = Prior.of_table(table) if isinstance(table, Mapping) else None
    except ScenarioError as error:
        raise ScenarioError(f'[uncertain] "{key}" {error}') from None
    if prior is None:
        raise ScenarioError(f'[uncertain] "{key}" = {shown(table)}: allowed is {_FORMS}')
    return Prior(prior.kind, float(prior.first), float(prior.second))


Matrix = tuple[tuple[float, ...], ...]

COVARIANCE = "covariance"
"""The section of ``[uncertain]`` that is no key."""

# Chosen: a covariance in a file may be rounded to ten digits.
_ROUNDING = 1e-9


@known_arguments
@dataclass(frozen=True)
class JointPrior:
    """Priors of a scenario's uncertain parameters, in a file its section ``[uncertain]``.

    A key has a prior of its own, or it is in the covariance, never both. The value of a key with a
    prior, which `simulate` takes, has no influence on draws. The keys of the covariance are jointly
    normal about their values in the scenario.

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
        """The matrix from independent standard normal numbers to those of the covariance.

        The symmetric root of the correlations is unique: draws do not depend on a choice of
        eigenvectors.
        """
        covariance = np.array(self.matrix, dtype=float).reshape(len(self.keys), len(self.keys))
        values, vectors = np.linalg.eigh(_correlation(covariance))
        root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
        return np.asarray(np.sqrt(np.diag(covariance))[:, None] * root)

    def draw(self, middle: Mapping[str, float], random: np.random.Generator) -> dict[str, float]:
        """Drawn values of the uncertain parameters by key.

        `middle` has the values about which those of the covariance lie.
        """
        z = random.standard_normal(len(self.names))
        single, joint = z[: len(self.priors)], z[len(self.priors) :]
        drawn = [prior.value(u) for prior, u in zip(self.priors.values(), single, strict=True)]
        centre = np.array([middle[key] for key in self.keys])
        values = [*drawn, *(centre + self._root @ joint)]
        return dict(zip(self.names, map(float, values), strict=True))


def as_joint_prior(given: object) -> JointPrior:
    """The `uncertain` of a `Scenario`: the `JointPrior` given, or of tables of ``[uncertain]``."""
    if isinstance(given, JointPrior):
        return given
    if not isinstance(given, Mapping):
        raise ScenarioError(f"uncertain = {shown(given)}: allowed is a section [uncertain]")
    priors = {key: prior for key, prior in given.items() if key != COVARIANCE}
    covariance = given.get(COVARIANCE, {"keys": (), "matrix": ()})
    section = f"[uncertain.{COVARIANCE}]"
    if not isinstance(covariance, Mapping) or covariance.keys() != {"keys", "matrix"}:
        raise ScenarioError(
            f"{section} = {shown(covariance)}: allowed is a section {section} with keys and matrix"
        )
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
        with prefixed("[uncertain]"):
            name = _constant(name, entry)
        if name in priors:
            raise ScenarioError(f'[uncertain] "{name}" is there twice: allowed is once')
        prior = entry if isinstance(entry, Prior) else parse_prior(name, entry)
        with prefixed(f'[uncertain] "{name}" = {prior}'):
            checked(name, float(prior.value(0.0)))
        priors[name] = prior
    return priors


def refuse_geometry_beside_a_map(keys: Iterable[str]) -> None:
    """Refuse the first key of the coils' geometry, which has no effect beside a map."""
    for key in keys:
        if key.startswith("coil.") and key.rpartition(".")[2] in GEOMETRY:
            raise ScenarioError(
                f"{key}: cannot be uncertain beside {COIL_MAP}, which has the field of the coils; "
                "effects.field_gain.in_plane and effects.field_gain.clamp can"
            )


def _constant(name: str, *entry: object) -> str:
    """The full name of a key that may be uncertain."""
    name = full_name(name) if isinstance(name, str) else shown(name)
    key = find_key(name, *entry)
    if key.kind != "real" or name.startswith(("drive.", "solver.", "record.")):
        raise ScenarioError(
            f'"{name}": allowed is a constant of the model, a real number outside [drive], '
            "[solver] and [record]"
        )
    return name


def _checked_keys(keys: object, priors: Mapping[str, Prior]) -> tuple[str, ...]:
    where = f"[uncertain.{COVARIANCE}] keys"
    if isinstance(keys, str | bytes | Mapping) or not isinstance(keys, Iterable):
        raise ScenarioError(f"{where} = {shown(keys)}: allowed is a list of keys")
    with prefixed(where):
        names = tuple(_constant(key) for key in keys)
        twice = next((name for name in names if names.count(name) > 1 or name in priors), None)
        if twice is not None:
            raise ScenarioError(
                f'"{twice}" is there twice: allowed is once, or with a prior of its own'
            )
    return names


def _checked_matrix(given: object, keys: Sequence[str]) -> Matrix:
    """The covariance, if it is one of as many keys."""
    size = len(keys)
    try:
        matrix = numbers("matrix", given)
    except ScenarioError:
        matrix = np.empty(0)
    if matrix.size == 0 == size:
        return ()
    if matrix.shape != (size, size) or not _is_covariance(matrix):
        raise ScenarioError(
            f"[uncertain.{COVARIANCE}] matrix = {shown(given)}: allowed is a symmetric one of "
            f"{size} x {size} numbers, a row for each key, without an eigenvalue below zero"
        )
    return tuple(map(tuple, matrix.tolist()))


def _is_covariance(matrix: Array) -> bool:
    variance = np.diag(matrix)
    if not (np.isfinite(matrix).all() and (variance >= 0.0).all()):
        return False
    # In units of the standard deviations all entries of a covariance are within one.
    unit = np.sqrt(np.outer(variance, variance))
    if (np.abs(matrix - matrix.T) > _ROUNDING * unit).any() or (matrix[unit == 0.0] != 0.0).any():
        return False
    lowest = float(np.linalg.eigvalsh(_correlation(matrix)).min(initial=0.0))
    return lowest >= -_ROUNDING * len(matrix)


def _correlation(covariance: Array) -> Array:
    """Correlations; of a key without variance, none."""
    sd = np.sqrt(np.diag(covariance))
    scale = np.divide(1.0, sd, out=np.zeros_like(sd), where=sd > 0.0)
    return np.asarray(covariance * np.outer(scale, scale))
