"""Formulas of a law: forms fitted to the curve that the data have drawn."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2

from stickslip._util.numbers import Array
from stickslip.diagnosis.terms.curve import Curve
from stickslip.diagnosis.terms.parameter import Parameter

TIE = 4.0
"""Difference of two BIC at which data do not decide: twice a log-likelihood of 2."""

_ADEQUATE = 0.01  # smallest p-value of a form that follows the curve
_NEAREST, _FARTHEST = 1.0 / 16.0, 4.0
"""Places of a form, in spans of the argument. Chosen: beyond them it is another form."""

_BETWEEN_KNOTS = 0.02
"""Distance of a curve from the form that made its data, in the range of the curve. Chosen: what
five knots leave of most of the forms below."""

_SEEN = 0.3
"""A peak is seen if a law falls by this share of its range beyond it, and a level if the slope has
fallen to this share of the largest. Chosen."""

_POINTS = 61  # of a range, to see how a form looks there
_INSIDE = 1e-3  # distance of the logarithm of a place from the ends of its range
_SCANNED = 15  # places that are looked at, evenly in their logarithm: the fit begins at the best


class _Form(NamedTuple):
    """``a shape(u, b, c)``, and how it looks far out."""

    text: str
    looks: str
    shape: Callable[..., Array]
    places: int = 0  # how many of b and c it has
    power: float = 0.0  # of the argument, if it is one
    of_angles: bool = False
    even: bool = False  # of its own only where u has both signs; a sine stands for it over angles


# A form and a level less that form look alike, as the level of most laws is free.
_FORMS = (
    _Form("a", "level", lambda u: np.ones_like(u)),
    _Form("a u", "grows", lambda u: u, power=1.0),
    _Form("a |u|", "grows", np.abs, power=1.0, even=True),
    _Form("a u^2", "grows", lambda u: u**2, power=2.0),
    _Form("a sqrt(|u|)", "grows", lambda u: np.sqrt(np.abs(u)), power=0.5),
    _Form("a ln(1 + |u| / b)", "grows", lambda u, b: np.log1p(np.abs(u) / b), 1),
    _Form("a |sin(u)|", "grows", lambda u: np.abs(np.sin(u)), of_angles=True),
    _Form("a sin(u)^2", "grows", lambda u: np.sin(u) ** 2, of_angles=True),
    _Form("a cos(u)^2", "grows", lambda u: np.cos(u) ** 2, of_angles=True),
    _Form("a u / (b + |u|)", "levels off", lambda u, b: u / (b + np.abs(u)), 1),
    _Form("a exp(-|u| / b)", "levels off", lambda u, b: np.exp(-np.abs(u) / b), 1),
    _Form("a exp(-(u / b)^2)", "levels off", lambda u, b: np.exp(-((u / b) ** 2)), 1),
    _Form("a (1 - exp(-|u| / b))", "levels off", lambda u, b: 1.0 - np.exp(-np.abs(u) / b), 1),
    _Form("a (1 - exp(-(u / b)^2))", "levels off", lambda u, b: 1.0 - np.exp(-((u / b) ** 2)), 1),
    _Form("a (u / b) exp(1 - |u| / b)", "peaks", lambda u, b: u / b * np.exp(1 - np.abs(u) / b), 1),
    _Form(
        "a exp(-((|u| - b) / c)^2)",
        "peaks",
        lambda u, b, c: np.exp(-(((np.abs(u) - b) / c) ** 2)),
        2,
    ),
)


@dataclass(frozen=True)
class Formula:
    """A formula f(u) in the place of a curve.

    Attributes
    ----------
    text : str
        With `u` for the argument less its `origin`, and `a`, `b` and `c`.
    parameters : dict
        ``{"a": (value, sd), ...}``: `a` in the unit of f, or in that over a power of the
        argument's; `b` and `c` in the argument's.
    origin : float
        Argument from which `u` is counted, in its unit.
    without : float
        The law without f, fitted with the formula; see `Curve`.
    p_value : float
        Of a curve as far from the formula.
    others : tuple of str
        Other forms that tie with it, and look like it.
    """

    text: str
    parameters: dict[str, tuple[float, float]]
    origin: float
    without: float
    p_value: float
    others: tuple[str, ...]

    def at(self, argument: Array) -> Array:
        """f at arguments in their unit."""
        a, *places = (value for value, _ in self.parameters.values())
        form = next(each for each in _FORMS if each.text == self.text)
        return np.asarray(a * form.shape(argument - self.origin, *places))

    def in_words(self, curve: Curve) -> str:
        """The law of a curve by this formula: ``friction = 0.3 (1 + a u) with a = ...``."""
        power = next(each.power for each in _FORMS if each.text == self.text)
        own = "" if curve.law_unit == "-" else f" {curve.law_unit}"
        to = "" if power == 1.0 else f"^{power:g}"
        base = f"({curve.unit})" if to and "/" in curve.unit else curve.unit
        units = dict.fromkeys("bc", "" if curve.unit == "-" else f" {curve.unit}")
        per = f" per {base}{to}" if power and curve.unit != "-" else ""
        units["a"] = per if curve.relative else own + per
        numbers = ", ".join(
            f"{name} = {value:.3g} ± {sd:.2g}{units[name]}"
            for name, (value, sd) in self.parameters.items()
        )
        if curve.relative:
            return f"{curve.law} = {self.without:.3g}{own} (1 + {self.text}) with {numbers}"
        return f"f of {curve.law} = {self.text} with {numbers}"


def formula(
    argument: Array,
    mean: Array,
    covariance: Array,
    curve: Curve,
    constant: Parameter | None = None,
) -> Formula | None:
    """The formula that follows a curve best, by Bayes' information criterion (BIC).

    None where no form follows it (p < 0.01), and where two that look different, such as one that
    grows and one that levels off, tie.

    Parameters
    ----------
    argument : ndarray, shape (k,)
    mean, covariance : ndarray, shapes (k,) and (k, k)
        Of f over the draws of the curve; beside a constant, with its own mean, variance and
        covariances behind those of f.
    curve : Curve
    constant : Parameter, optional
        The constant that the law is a factor of.
    """
    without, with_constant = curve.stated, np.zeros_like(argument)
    if constant is not None:
        # The law has freed it. With a formula it counts as stated, or every form had a free level.
        low, stated, high = constant.value(np.array([-0.5, 0.0, 0.5])).tolist()
        gain = covariance[:, -1] / (covariance[-1, -1] + (high - low) ** 2)
        mean = mean + gain * (stated - mean[-1])
        covariance = covariance - np.outer(gain, covariance[-1])
        without, with_constant = float(mean[-1]), covariance[-1, :-1]
        mean, covariance = mean[:-1], covariance[:-1, :-1]
    u = argument - curve.origin
    angles, both_signs = curve.unit == "rad", float(u.min()) < 0.0 < float(u.max())
    whiten = _whitening(mean, covariance)
    target = whiten @ mean
    found = []
    for form in _FORMS:
        count = 1 + form.places
        allowed = angles if form.of_angles else not form.even or (both_signs and not angles)
        if allowed and count < len(target):
            values, sd, left = _fitted(form, u, whiten, target)
            p_value, looks = float(chi2.sf(left, len(target) - count)), _looks(form, u, values)
            if sd is not None and p_value >= _ADEQUATE:
                bic = left + count * math.log(len(target))
                found.append((bic, looks, form, values, sd, p_value))
    best = min((each[0] for each in found), default=0.0)
    tied = [each for each in found if each[0] < best + TIE]
    if len({looks for _, looks, *_ in tied}) != 1:
        return None
    # First what is seen whole: a root before the rise to a peak that lies beyond the range.
    tied.sort(key=lambda each: (each[1] != each[2].looks, each[0]))
    _, _, form, values, sd, p_value = tied[0]
    off = values[0] * form.shape(u, *values[1:]) - mean
    without += float(with_constant @ np.linalg.pinv(covariance, 1e-8, hermitian=True) @ off)
    return Formula(
        text=form.text,
        parameters={k: (float(v), float(s)) for k, v, s in zip("abc", values, sd, strict=False)},
        origin=curve.origin,
        without=without,
        p_value=p_value,
        others=tuple(other.text for _, _, other, *_ in tied[1:]),
    )


def _looks(form: _Form, u: Array, values: Array) -> str:
    """How a form looks within the range, where it may not be seen to turn or to level off."""
    law = form.shape(np.linspace(np.min(np.abs(u)), np.max(np.abs(u)), _POINTS), *values[1:])
    slopes = np.abs(np.diff(law))
    looks = form.looks
    if looks == "peaks" and np.max(law) - law[-1] < _SEEN * np.ptp(law):
        looks = "levels off"
    if looks == "levels off" and slopes[-1] > _SEEN * np.max(slopes):
        looks = "grows"
    return looks


def _whitening(mean: Array, covariance: Array) -> Array:
    """Takes curves to the few numbers that their knots leave free, with errors of size 1.

    They are of what is known best, so that a form meets the curve where the data are.
    """
    sd = np.sqrt(np.diag(covariance))
    # No place counts ten times more than the middle one, or the form would be met nowhere else.
    scale = 1.0 / np.maximum(sd, 0.1 * np.median(sd))
    sizes, vectors = np.linalg.eigh(covariance * np.outer(scale, scale))
    kept = sizes > 1e-6 * sizes[-1]
    rows = vectors[:, kept].T * scale
    # As many independent errors as the curve has numbers, in place of one a point.
    between = (_BETWEEN_KNOTS * np.ptp(mean)) ** 2 * len(mean) / np.count_nonzero(kept)
    errors = np.diag(sizes[kept]) + between * rows @ rows.T
    return np.asarray(np.linalg.solve(np.linalg.cholesky(errors), rows))


def _fitted(
    form: _Form, u: Array, whiten: Array, target: Array
) -> tuple[Array, Array | None, float]:
    """Values of a, b and c, their errors, and chi-square.

    Without errors where a place is at the end of its range, or two places say the same.
    """
    span = float(np.max(np.abs(u)))

    def factor(logs: Array) -> tuple[float, Array]:
        """The best `a`, in which a form is linear, and what is left."""
        column = whiten @ form.shape(u, *span * np.exp(logs))
        a = float(column @ target) / max(float(column @ column), 1e-300)
        return a, target - a * column

    low, high = math.log(_NEAREST), math.log(_FARTHEST)
    grid = itertools.product(np.linspace(low, high, _SCANNED), repeat=form.places)
    best = min(map(np.array, grid), key=lambda logs: float(np.sum(factor(logs)[1] ** 2)))
    if form.places:
        best = least_squares(lambda logs: factor(logs)[1], best, bounds=(low, high)).x
    a, left = factor(best)
    places = span * np.exp(best)
    values = np.array([a, *places])
    columns = [a * form.shape(u, *places)]
    for k in range(form.places):
        up, down = (span * np.exp(best + aside * np.eye(form.places)[k]) for aside in (1e-4, -1e-4))
        columns.append(a * (form.shape(u, *up) - form.shape(u, *down)) / 2e-4)
    # By the logarithms of a, b and c.
    jacobian = whiten @ np.stack(columns, axis=1)
    inside = bool(np.all((best > low + _INSIDE) & (best < high - _INSIDE)))
    if not inside or not np.linalg.cond(jacobian) < 1.0 / _INSIDE:
        return values, None, float(left @ left)
    relative = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    return values, relative * np.abs(values), float(left @ left)
