"""Paths along the surface, by their length."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array, in_columns, numbers
from stickslip._util.messages import check_above_zero, known_arguments
from stickslip.errors import ScenarioError

COLUMNS = "x", "y"
_BEHIND, _AHEAD = 0.2e-3, 0.6e-3  # chosen: m, where along the path a robot is looked for
_SLACK = 1e-12  # m, rounding


@known_arguments
class Path:
    """A polyline along the surface.

    A robot's progress is the arc length of the point of the path that is nearest to it. It is
    looked for from 0.2 mm behind to 0.6 mm ahead of the progress before, so that a path may cross
    itself.

    Parameters
    ----------
    points : array_like, shape (k, 2)
        Corners x and y, or columns of these names, m, from the start to the end.

    Attributes
    ----------
    points : numpy.ndarray, shape (k, 2)
    length : float
        m.

    Raises
    ------
    ScenarioError
        If there are fewer than two corners, one of them is not finite, or two in a row are the
        same.

    Examples
    --------
    >>> from stickslip.control import Path
    >>> path = Path([(0, 0), (3e-3, 0), (3e-3, 1e-3)])
    >>> path.at(3.5e-3).tolist()
    [0.003, 0.0005]
    """

    def __init__(self, points: ArrayLike) -> None:
        corners = in_columns("path", points, COLUMNS, "shape (k, 2) of finite x and y, m", axes=2)
        if len(corners) < 2:
            raise ScenarioError(f"path of shape {corners.shape}: allowed are two corners or more")
        sides = np.diff(corners, axis=0)
        lengths = np.hypot(*sides.T)
        if not lengths.all():
            again = int(np.argmin(lengths)) + 1
            raise ScenarioError(f"path: corner {again} is where the one before it is")
        self.points = corners
        self._starts = np.concatenate([[0.0], np.cumsum(lengths)])
        self._lengths = lengths
        self._corners, self._along = corners[:-1].T.copy(), (sides / lengths[:, None]).T.copy()
        self.length = float(self._starts[-1])
        # Sides that lie within what is looked at from a progress, at most.
        ends = np.searchsorted(self._starts, self._starts[:-1] + _BEHIND + _AHEAD, side="right")
        self._looked_at = int(np.max(ends - np.arange(len(lengths)))) + 1

    @staticmethod
    def figure_of_eight(width: float = 4e-3) -> Path:
        """x = a sin u, y = a/2 sin 2u, from its crossing at the origin and back to it.

        `width` is 2 a, m: the figure is twice as wide as it is high, 3.05 widths long, and nowhere
        bent more than by a radius of 0.21 a.
        """
        check_above_zero("width", width, "m")
        u = np.linspace(0.0, 2.0 * np.pi, 361)
        half = 0.5 * width
        return Path(np.column_stack([half * np.sin(u), 0.5 * half * np.sin(2.0 * u)]))

    def at(self, progress: ArrayLike) -> Array:
        """Places at arc lengths, m, shape (...) to (..., 2); beyond an end, that end."""
        lengths = numbers("progress", progress, unit="m")
        x, y = (np.interp(lengths, self._starts, coordinate) for coordinate in self.points.T)
        return np.stack([x, y], axis=-1)

    def project(self, places: ArrayLike, before: ArrayLike) -> tuple[Array, Array]:
        """Progress and distance across of robots, m, shapes (...), the distance to the left.

        Parameters
        ----------
        places : array_like, shape (..., 2)
            m.
        before : array_like, shape (...)
            Their progress before, m.
        """
        where = in_columns("places", places, COLUMNS, unit="m", gaps=True)
        known = numbers("before", before, unit="m", gaps=True)[..., None]
        low, high = known - _BEHIND, known + _AHEAD
        first = np.searchsorted(self._starts, low, side="right") - 1
        sides = np.clip(first + np.arange(self._looked_at), 0, len(self._lengths) - 1)
        starts = self._starts[sides]
        # Coordinates apart: sums over an axis of two take longer than all else.
        along_x, along_y = self._along[0][sides], self._along[1][sides]
        off_x, off_y = (where[..., k, None] - self._corners[k][sides] for k in (0, 1))
        near = np.clip(off_x * along_x + off_y * along_y, low - starts, high - starts)
        near = np.clip(near, 0.0, self._lengths[sides])
        away_x, away_y = off_x - near * along_x, off_y - near * along_y
        progress, squares = starts + near, away_x**2 + away_y**2
        within = (progress > low - _SLACK) & (progress < high + _SLACK)
        best = np.argmin(np.where(within, squares, np.inf), axis=-1)[..., None]
        left = along_x * away_y - along_y * away_x
        across = np.copysign(np.sqrt(squares), left)
        return (
            np.take_along_axis(progress, best, -1)[..., 0],
            np.take_along_axis(across, best, -1)[..., 0],
        )

    def __repr__(self) -> str:
        return f"<Path: {len(self.points)} corners, {1e3 * self.length:.4g} mm>"
