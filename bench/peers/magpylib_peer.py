"""The field of a square coil with magpylib, a closed line current; its gradient by differences."""

from __future__ import annotations

import magpylib
import numpy as np

from peers.problem import DISTANCE, SIDE, TURNS

CHUNK = 2000  # points a call: magpylib is quickest where its intermediate arrays stay in cache
OFFSET = 2e-5  # m, half the base of a central difference


class Coil:
    """The +x coil with one ampere in each turn; the origin is the centre of the coil set."""

    def __init__(self) -> None:
        h = SIDE / 2
        corners = [(h, h), (-h, h), (-h, -h), (h, -h), (h, h)]
        vertices = [(DISTANCE, y, z) for y, z in corners]
        self._wire = magpylib.current.Polyline(vertices=vertices, current=float(TURNS))

    def field(self, points: np.ndarray) -> np.ndarray:
        """Field at `points` (n, 3) in m; (n, 3), T."""
        parts = [self._wire.getB(points[k : k + CHUNK]) for k in range(0, len(points), CHUNK)]
        return np.concatenate(parts)

    def gradient(self, points: np.ndarray) -> np.ndarray:
        """dB_i/dx_j at `points` (n, 3) in m; (n, 3, 3), T/m.

        Central differences along x and y; the derivatives along z follow from a curl and a
        divergence of zero.
        """
        by_x, by_y = (
            (self.field(points + step) - self.field(points - step)) / (2 * OFFSET)
            for step in (np.array([OFFSET, 0.0, 0.0]), np.array([0.0, OFFSET, 0.0]))
        )
        by_z = np.stack([by_x[:, 2], by_y[:, 2], -by_x[:, 0] - by_y[:, 1]], axis=1)
        return np.stack([by_x, by_y, by_z], axis=2)
