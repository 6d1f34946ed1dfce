"""Terms of a free shape: what a search for another law needs of them, and those of one's own model.

Those of the simulator are in `free_shapes`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from stickslip._util.arrays import Array, Indices
from stickslip._util.number_text import is_number
from stickslip._util.one_line import OneLine
from stickslip.diagnosis.model.problem import Cause, CauseParameter, Predict, Uncertain
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import check_whole, meant, refuse, shown

KNOTS = 5

# Largest value at a knot that is searched, in sizes that would not surprise. Chosen: as for the
# laws of the simulator, three times a law beside a third of it.
_LARGEST = 10.0
# Fewest knots. Chosen: with fewer there is no bend, and a parabola gives the slopes at the ends.
_FEWEST = 3


@dataclass(frozen=True, repr=False, eq=False)
class Term(OneLine):
    """A curve f of one argument somewhere in a model, linear in its values at some knots.

    Attributes
    ----------
    law, argument : str
        What f changes and what it depends on, in words: ``friction`` and ``slip speed``.
    unit, law_unit : str
        Of the argument, and of the law as it is drawn.
    cause : Cause
        The term as a candidate, whose amplitudes are the knots.
    low, high : float
        Ends of the range of the argument over which the curve is drawn.
    places : ndarray, shape (knots,)
        Argument at each knot.
    design : callable
        ``design(argument)`` is what each knot adds to f, of the shape of `argument` and one
        more axis, the knots.
    constant : str, optional
        Parameter of the model that the law is times 1 + f, if it is one.
    stated : float
        The law without f: this parameter as it is stated, else a number.
    relative : bool
        Whether the law is that times 1 + f; else it is that and f added.
    cut : bool
        Whether 1 + f is cut off at zero.
    fixed : dict
        What the extended model has besides the knots, by name.
    """

    law: str
    argument: str
    unit: str
    law_unit: str
    cause: Cause
    low: float
    high: float
    places: Array
    design: Callable[[Array], Array]
    constant: str | None = None
    stated: float = 0.0
    relative: bool = False
    cut: bool = False
    fixed: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """``friction over slip speed``."""
        return f"{self.law} over {self.argument}"

    @property
    def effect(self) -> str:
        """Name of its cause."""
        return self.cause.name

    @property
    def knots(self) -> list[str]:
        """Names of the parameters that are its values at the knots."""
        return [each.name for each in self.cause.parameters]

    @property
    def origin(self) -> float:
        """From where formulas count the argument, in its unit.

        Zero, or the lower end where zero is farther from it than the range is wide.
        """
        return self.low if self.low > self.high - self.low else 0.0

    def without(self, values: Mapping[str, float]) -> float:
        """The law without f where the model's parameters have these values, by their names."""
        return self.stated if self.constant is None else values.get(self.constant, self.stated)

    @property
    def span(self) -> float:
        """How far its knots reach from zero, in the argument's unit."""
        return max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class FreeTerm:
    """A place in a model of one's own where a law may have another shape than the model says.

    There a curve f of one argument acts, given by its values at knots that lie evenly between two
    ends. Between them f is the cubic Hermite interpolant with slopes by central differences (at the
    ends those of the parabola through three knots), beyond them it is constant. What f does, a
    factor 1 + f or a force f, is the model's: see `diagnose_model`.

    Attributes
    ----------
    law, argument : str
        In words, such as ``friction`` and ``speed``.
    unit : str
        Of the argument.
    low, high : float
        Argument of the first and the last knot, in the unit: about what the measured conditions
        reach.
    size : float
        What would not surprise of f at a knot, above 0, in `law_unit`.
    law_unit : str
        Of f; beside `factor_of` only "-".
    largest : float, optional
        Largest value at a knot that is searched, to both sides; ten times the size, if not given.
    factor_of : str, optional
        The uncertain parameter that the model multiplies by 1 + f, if it does that. The law that is
        drawn is then their product, which data often tell better than each of them.
    count : int
        Number of knots, 3 or more. A law that bends within half the distance of two is missed. A
        term that takes most of the misfit, but leaves more than noise, is tried again with `finer`
        knots as long as there are three conditions for each.

    Raises
    ------
    ScenarioError
        If a value is not allowed.
    """

    law: str
    argument: str
    unit: str
    low: float
    high: float
    size: float = 0.3
    law_unit: str = "-"
    largest: float | None = None
    factor_of: str | None = None
    count: int = KNOTS

    def __post_init__(self) -> None:
        for name in ("law", "argument", "unit", "law_unit"):
            if not isinstance(getattr(self, name), str) or not getattr(self, name):
                refuse(name, getattr(self, name), "a text")
        ends = (self.low, self.high)
        if not all(is_number(end) and np.isfinite(end) for end in ends) or not ends[0] < ends[1]:
            said = f"low = {shown(self.low)}, high = {shown(self.high)}"
            raise ScenarioError(f"free term {self.name}: {said}: allowed are numbers, low < high")
        if self.factor_of is not None and self.law_unit != "-":
            refuse("law_unit", self.law_unit, '"-" beside factor_of, as 1 + f is a factor')
        check_whole(f"free term {self.name}: count", self.count, _FEWEST)
        for name in ("size", "largest"):
            value = getattr(self, name)
            known = is_number(value) and 0.0 < value < np.inf
            if not known and not (name == "largest" and value is None):
                refuse(f"free term {self.name}: {name}", value, "a number above 0")

    @property
    def name(self) -> str:
        """Under which `predict` gets the curve: ``friction over speed``."""
        return f"{self.law} over {self.argument}"

    @property
    def places(self) -> Array:
        """Argument of each knot, shape (count,)."""
        return np.linspace(self.low, self.high, self.count)

    @property
    def finer(self) -> FreeTerm:
        """The term with another knot between each two."""
        return replace(self, count=2 * self.count - 1)

    @property
    def knots(self) -> list[str]:
        """Names of the parameters: ``friction over speed.knot_1``."""
        return [f"{self.name}.knot_{k}" for k in range(1, self.count + 1)]

    @property
    def cause(self) -> Cause:
        """The term as a candidate, whose amplitudes are the knots."""
        end = _LARGEST * self.size if self.largest is None else self.largest
        parameters = tuple(
            CauseParameter(knot, self.law_unit, -end, end, self.size) for knot in self.knots
        )
        return Cause(self.name, parameters, f"{self.name} has another shape")

    def term(self, uncertain: Sequence[Uncertain]) -> Term:
        """What a search for another law needs of it, beside the model's uncertain parameters."""
        own = next((each for each in uncertain if each.name == self.factor_of), None)
        return Term(
            law=self.law,
            argument=self.argument,
            unit=self.unit,
            law_unit=self.law_unit if own is None else own.unit,
            cause=self.cause,
            low=float(self.low),
            high=float(self.high),
            places=self.places,
            design=self.design,
            constant=self.factor_of,
            stated=0.0 if own is None else float(own.prior.value(0.0)),
            relative=own is not None,
        )

    @cached_property
    def _columns(self) -> CubicHermiteSpline:
        """The curve of each knot at 1 and all others at 0."""
        one, places = np.eye(self.count), self.places
        slopes = np.gradient(one, places, axis=0, edge_order=2)
        return CubicHermiteSpline(places, one, slopes, axis=0)

    def design(self, argument: Array) -> Array:
        """What each knot adds to f, shape (*argument.shape, count)."""
        return np.asarray(self._columns(np.clip(argument, self.low, self.high)))

    def at(self, argument: ArrayLike, knots: ArrayLike) -> Array:
        """The curve with some values at its knots.

        Parameters
        ----------
        argument : array_like, shape (m,) or (vectors, ...)
            In `unit`; a row that is alone is the same for all vectors.
        knots : array_like, shape (vectors, count)

        Returns
        -------
        ndarray, shape (vectors, m) or (vectors, ...)
        """
        u, values = np.atleast_2d(np.asarray(argument, dtype=float)), np.atleast_2d(knots)
        values = np.asarray(values, dtype=float)
        return np.asarray(np.einsum("v...k,vk->v...", self.design(u), values))


class Curves(Mapping[str, Callable[[ArrayLike], Array]]):
    """The curves of some free terms, by their names, one for each vector of parameters.

    ``curves["friction over speed"](u)`` is ``FreeTerm.at`` the argument `u` for the vectors of a
    call of `predict`; where all knots are zero, it is zero.

    Parameters
    ----------
    terms : sequence of FreeTerm
    knots : ndarray, shape (vectors, knots of all terms)
    """

    def __init__(self, terms: Sequence[FreeTerm], knots: Array) -> None:
        self._terms, self.knots = tuple(terms), knots
        ends = np.cumsum([0, *(each.count for each in terms)]).tolist()
        self._parts = {
            each.name: (each, slice(*pair))
            for each, pair in zip(terms, itertools.pairwise(ends), strict=True)
        }

    def __getitem__(self, name: str) -> Callable[[ArrayLike], Array]:
        if name not in self._parts:
            hint = meant(str(name), self._parts)
            raise ScenarioError(f"curves: there is no free term {name}{hint}")
        term, part = self._parts[name]
        return lambda argument: term.at(argument, self.knots[:, part])

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    def rows(self, vectors: Indices) -> Curves:
        """Those of some vectors."""
        return Curves(self._terms, self.knots[vectors])


PredictWithCurves = Callable[..., Array]
"""``predict(conditions, parameters, curves)``: as `Predict`, with the `Curves` of free terms."""


def predicted_once(
    predict: PredictWithCurves, conditions: Any, parameters: Array, *curves: Curves
) -> Array:
    """Predictions, with or without curves, of which those of equal vectors are made once."""
    vectors = np.hstack([parameters, *(each.knots for each in curves)])
    _, first, at = np.unique(vectors, axis=0, return_index=True, return_inverse=True)
    given = [each.rows(first) for each in curves]
    predicted = np.asarray(predict(conditions, parameters[first], *given), dtype=float)
    return predicted[at.reshape(-1)]


def with_flat_curves(predict: PredictWithCurves, terms: Sequence[FreeTerm]) -> Predict:
    """The model without its terms, which takes the uncertain parameters and those of all causes."""
    count = sum(each.count for each in terms)

    def flat(conditions: Any, parameters: Array) -> Array:
        return predict(conditions, parameters, Curves(terms, np.zeros((len(parameters), count))))

    return flat


def with_curves(
    predict: PredictWithCurves, terms: Sequence[FreeTerm], causes: Sequence[Cause]
) -> Predict:
    """The model without its causes, which takes the uncertain parameters and all knots."""
    absent = np.array([p.value(np.zeros(1))[0] for each in causes for p in each.parameters])
    count = sum(each.count for each in terms)

    def bent(conditions: Any, parameters: Array) -> Array:
        base = parameters.shape[1] - count
        own, knots = parameters[:, :base], parameters[:, base:]
        without = np.broadcast_to(absent, (len(parameters), len(absent)))
        return predict(conditions, np.hstack([own, without]), Curves(terms, knots))

    return bent
