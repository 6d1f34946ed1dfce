"""Laws of a free shape as causes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from stickslip._util.arrays import Array
from stickslip._util.messages import check_whole, meant, refuse, shown
from stickslip._util.prior import Prior
from stickslip._util.text import is_number
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import CURVE, NEAREST, SHAPES, Curve
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError

_LARGEST = 10.0
"""Largest value at a knot, in its usual size. Chosen: three times a law beside a third of it."""

_FEWEST = 3
"""Knots: with fewer nothing bends, and a parabola gives the slopes at the ends."""


def free_law(
    law: str, argument: str, unit: str, low: float, high: float, size: float = 0.3,
    law_unit: str = "-", largest: float | None = None, factor_of: str | None = None, knots: int = 5,
) -> Cause:  # fmt: skip
    """A place in a model of one's own where a law may have another shape.

    A curve f of one argument acts there, by its values at knots that lie evenly between two ends.
    Between them f is the cubic Hermite interpolant with slopes by central differences (at the ends
    those of the parabola through three knots), beyond them it is constant. What f does, such as a
    factor 1 + f or a force f, is up to the model, which finds it in `Curves` under the law's name.
    Where the law explains the data, its forms, such as a line or a saturation, compete with the
    curve.

    Parameters
    ----------
    law, argument : str
        In words: ``friction`` and ``speed`` make the name ``friction over speed``.
    unit : str
        Of the argument.
    low, high : float
        Argument of the first and the last knot: about what the data reach.
    size : float
        Size of f that would not surprise, above 0, in `law_unit`.
    law_unit : str
        Of f; beside `factor_of` only "-".
    largest : float, optional
        Largest size of f at a knot; ten times `size`, if not given.
    factor_of : str, optional
        The uncertain constant that the model multiplies by 1 + f. It is fitted with the law, whose
        drawing is their product: data often tell that better than each of them.
    knots : int
        3 or more. A law that bends within half their distance is missed.

    Raises
    ------
    ScenarioError
        If a value is not allowed.
    """
    texts = {"law": law, "argument": argument, "unit": unit, "law_unit": law_unit}
    for word, text in texts.items():
        if not isinstance(text, str) or not text:
            refuse(f"{word} of a free law", text, "a text")
    name = f"{law} over {argument}"
    at = f"free law {name}: "
    if not all(is_number(end) and np.isfinite(end) for end in (low, high)) or not low < high:
        refuse(f"{at}low = {shown(low)}, high", high, "numbers with low < high")
    if factor_of is not None and law_unit != "-":
        refuse(f"{at}law_unit", law_unit, '"-" beside factor_of, as 1 + f is a factor')
    check_whole(f"{at}knots", knots, _FEWEST)
    end = _LARGEST * size if largest is None and is_number(size) else largest
    for what, value in {"size": size, "largest": end}.items():
        if not is_number(value) or not 0.0 < float(value) < np.inf:
            refuse(at + what, value, "a number above 0")
    assert end is not None
    places = np.linspace(low, high, knots)
    # The curves of each knot at 1 and all others at 0.
    slopes = np.gradient(np.eye(knots), places, axis=0, edge_order=2)
    columns = CubicHermiteSpline(places, np.eye(knots), slopes, axis=0)
    curve = Curve(
        law, argument, unit, law_unit, float(low), float(high), places,
        design=partial(_within, columns, low, high), constant=factor_of,
        stated=0.0 if factor_of is None else 1.0, relative=factor_of is not None,
    )  # fmt: skip
    keys = [f"{name}.knot_{k}" for k in range(1, knots + 1)]
    return made_law(name, curve, keys, law_unit, size, -float(end), float(end))


def made_law(
    name: str, curve: Curve, keys: Sequence[str], unit: str, size: float, low: float, high: float,
    odds: float = 1.0,
) -> Cause:  # fmt: skip
    """The cause of a curve whose knots have these keys, a usual size and these ends."""
    # No shapes, which would end at a few sizes: a law may be far from what was expected.
    knots = [Parameter(key, Prior("normal", 0.0, size), unit, low, high) for key in keys]
    meaning = f"{curve.name} has another shape"
    return Cause(name, tuple(knots), meaning, frees=curve.constant, curve=curve, odds=odds)


def forms(law: Cause) -> dict[str, Cause]:
    """The law by its other forms, of an amplitude and a scale in place of its knots."""
    curve, knot = law.curve, law.parameters[0]
    assert curve is not None
    assert knot.prior is not None
    stated, others = curve.statement, dict[str, Cause]()
    for form in SHAPES if stated is None else stated.forms:
        farthest = SHAPES[form].farthest
        section, statement = f"{law.name}.{form}", None
        if stated is not None:
            statement = stated.in_form(form, None if farthest else curve.reach)
            section = statement.section
        amplitude = "fraction" if curve.relative else "amount"
        numbers = [
            Parameter(f"{section}.{amplitude}", unit=knot.unit, size=knot.prior.second,
                      low=knot.low, high=knot.high)
        ]  # fmt: skip
        if farthest:
            prior = Prior("log-uniform", NEAREST * curve.reach, farthest * curve.reach)
            numbers.append(Parameter(f"{section}.scale", prior, curve.unit, cause=False))
        other = replace(curve, form=form, statement=statement)
        others[form] = replace(law, parameters=tuple(numbers), curve=other)
    return others


def beside_constants(causes: Iterable[Cause], constants: Sequence[Parameter]) -> list[Cause]:
    """The same causes; free laws get the unit and the stated value of their constant.

    A ScenarioError is raised if a law is a factor of what is no uncertain constant of the model.
    """
    known = {constant.name: constant for constant in constants}
    made = []
    for cause in causes:
        curve = cause.curve
        if curve is not None and curve.constant is not None:
            if curve.constant not in known:
                hint = meant(curve.constant, known)
                refuse(f"free law {cause.name}: factor_of", curve.constant,
                       f"an uncertain constant{hint}")  # fmt: skip
            one = known[curve.constant]
            cause = replace(cause, curve=replace(curve, law_unit=one.unit, stated=one.middle))
        made.append(cause)
    return made


class Curves(dict[str, Callable[[ArrayLike], Array]]):
    """The curves of the free laws of a model, by their names, for some vectors of its parameters.

    ``curves["friction over speed"](u)`` has the shape (vectors, ...): `u` has the shape (m,) or
    (vectors, ...), a single row stands for all vectors. It is zero where the law is not in the
    model.

    Parameters
    ----------
    causes : iterable of Cause
        Those without a curve are passed over.
    values : mapping
        Values by name of a parameter, each of shape (vectors,), (vectors, 1) or a number. Knots
        that it lacks are zero.
    """

    def __init__(self, causes: Iterable[Cause], values: Mapping[str, ArrayLike]) -> None:
        super().__init__()
        self.causes = list(causes)
        vectors = max((np.size(value) for value in values.values()), default=1)
        pairs: dict[str, list[tuple[Curve, Array]]] = {}
        for cause in self.causes:
            if cause.curve is not None:
                values_of = [np.ravel(values.get(p.name, 0.0)) for p in cause.parameters]
                columns = [np.broadcast_to(value, (vectors,)) for value in values_of]
                pair = cause.curve, np.stack(columns, axis=1)
                pairs.setdefault(cause.name, []).append(pair)
        self |= {name: partial(_law_at, parts) for name, parts in pairs.items()}

    def __missing__(self, name: str) -> NoReturn:
        raise ScenarioError(f"curves: there is no free law {shown(name)}{meant(name, self)}")


def _within(columns: CubicHermiteSpline, low: float, high: float, u: Array) -> Array:
    """Columns of a curve at arguments, the ends of its range beyond them."""
    return np.asarray(columns(np.clip(u, low, high)), dtype=float)


def _law_at(forms: Sequence[tuple[Curve, Array]], argument: ArrayLike) -> Array:
    """A law in whichever of its forms it is."""
    u = np.atleast_2d(np.asarray(argument, dtype=float))
    f = np.where(np.isnan(u), np.nan, np.zeros((len(forms[0][1]), *u.shape[1:])))
    for curve, values in forms:
        # Without its amplitude a form is absent, whatever its scale.
        if (values if curve.form == CURVE else values[:, 0]).any():
            f = f + curve.at(u, values)
    return f
