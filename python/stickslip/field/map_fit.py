"""Solid harmonics fitted to the measured field of coils, by linear least squares."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, root_mean_square
from stickslip._util.messages import shown
from stickslip._util.text import counted
from stickslip.errors import ScenarioError

FEWEST = 8
"""Fewest points of a coil. Chosen: the corners of a box, whose 24 numbers determine the 8 harmonics
of degrees 1 and 2 three times over."""

_FARTHEST, _STRONGEST = 1.0, 0.3
"""Largest coordinate (m) and field (T/A) that are accepted. Chosen: coils of a thousand turns on a
centimetre make 0.1 T/A, and beyond these limits a unit is wrong."""

_LONG, _FLATTEST = 0.2, 50.0
"""Side of a box, m, from which on it is at most so many times another one. Chosen: a thin map of a
robot's place is within decimetres, and cm for m are 100 times."""

_ENTRIES = 20_000_000
"""Most numbers of the matrix of a fit, 160 MB; where points are many, the degree is limited."""

ROUNDING = 1e-6
"""Residual, of the field, below which nothing is told from another one."""

_SINGULAR = 1e-7
"""Part of a harmonic's field at the points that has to be none of the harmonics before it. Chosen:
what is less is rounding, as of high degrees on a grid of few planes."""

_UNDETERMINED = 1e-7
"""Determinant of a point's block of 1 - H at which a fit without the point is not determined. Its
eigenvalues are 0 to 1, so that the least is not below it. Chosen: they have errors of some 1e-15 by
rounding, so that the error at a point that is left out has seven digits and more."""


TURNS = np.array(
    [
        np.diag([1.0, *signs])[:, order]
        for order in itertools.permutations(range(3))
        for signs in itertools.product((1.0, -1.0), repeat=2)
    ]
)
"""The 24 arrangements of the components of a vector but for a common sign, shape (24, 3, 3); the
first is that as given. Of a source-free field no other is source-free."""


@dataclass(frozen=True)
class CoilFit:
    """The harmonics of one coil: `coefficients` (T/A), the residual and the measured field.

    `residual` and `field` are root mean squares of one component, T/A; `points` counts, and
    `farthest` is the index of the point with the largest residual, which is `odd` times the median
    (of 0 by rounding). `errors`, shape (24,), T/A, are
    those at points left out of the fit, for each of `TURNS`. `centre` and its standard deviations
    `centre_sd`, shape (6,), T/A, are Bx, By, Bz at x = y = z = 0, and dBx/dx, dBy/dy, dBz/dz there
    times the largest side of the box.
    """

    coefficients: Array
    residual: float
    field: float
    points: int
    farthest: int
    odd: float
    errors: Array
    centre: Array
    centre_sd: Array


def point_name(lines: Sequence[Sequence[int]] | None, coil: int, point: int) -> str:
    """The name of a point in messages: its row of the file, if `lines` has them."""
    return f"point {point + 1}" if lines is None else f"row {lines[coil][point]}"


def fit_coils(
    samples: Sequence[tuple[Array, Array]], lines: Sequence[Sequence[int]] | None = None
) -> tuple[Array, Array, list[CoilFit]]:
    """The box of all points, its low and high corner (m), and the fit of each coil.

    `samples` has points, shape (n, 3), m, and fields, shape (n, 3), T/A, of each coil, and
    `lines` where these stand in a file. A ScenarioError names the coil, the point or its line, the
    value and what is allowed.
    """
    for k, (points, fields) in enumerate(samples):
        _check(k, points, fields, lines)
    every = np.concatenate([points for points, _ in samples])
    low, high = every.min(axis=0), every.max(axis=0)
    _check_box(low, high)
    fits: list[CoilFit] = []
    basis: _Basis | None = None
    for points, fields in samples:
        # Mostly all coils were measured at the same points, and these are most of the work.
        if basis is None or not np.array_equal(points, basis.points):
            basis = _Basis(low, high, points)
        fits.append(basis.fit(fields))
    return low, high, fits


class _Basis:
    """Orthonormal combinations of the harmonics' fields at some points, by degree."""

    def __init__(self, low: Array, high: Array, points: Array) -> None:
        self.points = points
        numbers = points.size
        degree = _core.most_map_degree
        # Half as many harmonics as numbers at the most: what is left tells the noise.
        while degree > 1 and (2 * _count(degree) > numbers or _count(degree) * numbers > _ENTRIES):
            degree -= 1
        fields = _core.harmonic_fields(low, high, degree, points).reshape(numbers, -1)
        self._scale = np.linalg.norm(fields, axis=0)
        self._scale[self._scale == 0.0] = 1.0
        self._q, self._r = np.linalg.qr(fields / self._scale)
        known = np.abs(np.diag(self._r)) > _SINGULAR
        self._degree = degree
        while self._degree > 1 and not known[: _count(self._degree)].all():
            self._degree -= 1
        if self._degree < 2:
            raise ScenarioError(
                "the points do not determine the gradient of the field: allowed are points of a "
                "box, or of the plane y = 0, and not of a line"
            )
        # Bx, By, Bz and their growth at the centre, of each harmonic.
        step = 1e-3 * np.max(high - low)
        at = np.concatenate([np.zeros((1, 3)), step * np.eye(3), -step * np.eye(3)])
        centre = _core.harmonic_fields(low, high, degree, at)
        growth = [(centre[1 + k, k] - centre[4 + k, k]) / 2e-3 for k in range(3)]
        self._centre = np.vstack([centre[0], *growth]) / self._scale

    def fit(self, fields: Array) -> CoilFit:
        """The fit of the degree that best predicts points left out of it."""
        turned = np.einsum("tij,nj->nit", TURNS, fields).reshape(-1, len(TURNS))
        errors = self._prediction_errors(turned, self._q.T @ turned)
        degree = 1 + int(np.argmin(errors[:, 0]))
        values = fields.reshape(-1)
        count = _count(degree)
        q, r, centre = self._q[:, :count], self._r[:count, :count], self._centre[:, :count]
        shares = q.T @ values
        left = values - q @ shares
        solution = np.linalg.solve(r, shares)
        sizes = np.linalg.norm(left.reshape(-1, 3), axis=1)
        usual = max(float(np.median(sizes)), ROUNDING * root_mean_square(values))
        noise = np.linalg.norm(left) / np.sqrt(len(values) - count)
        return CoilFit(
            solution / self._scale[:count],
            root_mean_square(left),
            root_mean_square(values),
            len(fields),
            int(np.argmax(sizes)),
            float(np.max(sizes)) / usual if usual else 0.0,
            np.sqrt(errors.min(axis=0)),
            centre @ solution,
            noise * np.linalg.norm(np.linalg.solve(r.T, centre.T), axis=0),
        )

    def _prediction_errors(self, values: Array, shares: Array) -> Array:
        """Mean squared error at a point that is left out of the fit, for each degree from 1.

        `values` and `shares` have a column for each field, and so have the errors.

        Exact without another fit (Allen, Technometrics 16, 1974): what is left at a point, times
        the inverse of 1 - H with the point's three rows of the projection H.
        """
        count = len(self.points)
        left = values.copy()
        free = np.tile(np.eye(3), (count, 1, 1))
        errors = []
        for degree in range(1, self._degree + 1):
            new = slice(_count(degree - 1), _count(degree))
            q = self._q[:, new]
            left -= q @ shares[new]
            rows = q.reshape(count, 3, -1)
            free -= rows @ rows.transpose(0, 2, 1)
            # A point without which the fit is not determined has an error without bound.
            safe = np.linalg.det(free) > _UNDETERMINED
            if not safe.all():
                errors.append(np.full(values.shape[1], np.inf))
                continue
            out = np.linalg.solve(free, left.reshape(count, 3, -1))
            errors.append(np.mean(out**2, axis=(0, 1)))
        return np.array(errors)


def _count(degree: int) -> int:
    """Number of harmonics of degrees 1 to `degree`."""
    return degree * (degree + 2)


def _check(coil: int, points: Array, fields: Array, lines: Sequence[Sequence[int]] | None) -> None:
    name = _core.coil_names[coil]
    if len(points) < FEWEST:
        raise ScenarioError(
            f"coil {name}: {counted(len(points), 'point')}: allowed are {FEWEST} or more, as every "
            "coil has to be measured"
        )
    for values, names, most, unit, hint in (
        (points, "xyz", _FARTHEST, "m", "are these millimetres?"),
        (fields, ("Bx", "By", "Bz"), _STRONGEST, "T/A", "are these mT/A or gauss?"),
    ):
        for axis, column in enumerate(names):
            at = int(np.argmax(np.where(np.isnan(values[:, axis]), np.inf, abs(values[:, axis]))))
            worst = float(values[at, axis])
            if not abs(worst) <= most:
                where = f"coil {name}, {point_name(lines, coil, at)}"
                raise ScenarioError(
                    f"{where}: {column} = {shown(worst)}: allowed are -{most:g} to {most:g} "
                    f"{unit}; {hint}"
                )

    zero = np.flatnonzero(~fields.any(axis=1))
    if 0 < len(zero) < len(fields):
        raise ScenarioError(
            f"coil {name}, {point_name(lines, coil, int(zero[0]))}: Bx = By = Bz = 0 at "
            f"{len(zero)} of {counted(len(fields), 'point')}: allowed are zeros at all points, for "
            "a coil that is not there; leave out places without a value"
        )


def _check_box(low: Array, high: Array) -> None:
    sides = high - low
    thin, long = int(np.argmin(np.where(sides > 0.0, sides, np.inf))), int(np.argmax(sides))
    if sides[long] > max(_LONG, _FLATTEST * sides[thin]):
        raise ScenarioError(
            f"{'xyz'[long]} spans {sides[long]:.3g} m and {'xyz'[thin]} {sides[thin]:.3g} m: "
            f"allowed are {_FLATTEST:g} times as much; look at their units"
        )
    for axis, least, most in zip("xyz", low.tolist(), high.tolist(), strict=True):
        if not least <= 0.0 <= most:
            raise ScenarioError(
                f"{axis} goes from {least!r} to {most!r} m: allowed are maps that hold the place "
                "x = y = z = 0, to which the drive refers"
            )
        if axis != "y" and least == most:
            raise ScenarioError(
                f"{axis} = {least!r} m at all points: allowed are maps of some width, in which the "
                "robot can be"
            )
