"""Motions of machines and heaters, compiled: use `stickslip.models`."""

from numpy import float64
from numpy.typing import NDArray

motion_terms: tuple[str, ...]

def moved(
    terms: NDArray[float64],
    start: NDArray[float64],
    times: NDArray[float64],
    knots: NDArray[float64],
    inputs: NDArray[float64],
    late: NDArray[float64],
    lines: bool,
) -> NDArray[float64]:
    """States x, v, y, w at the readings, (vectors, readings, 4)."""

def heated(
    terms: NDArray[float64],
    start: NDArray[float64],
    times: NDArray[float64],
    knots: NDArray[float64],
    inputs: NDArray[float64],
    late: NDArray[float64],
    lines: bool,
) -> NDArray[float64]:
    """Temperatures of the body at the readings, (vectors, readings)."""
