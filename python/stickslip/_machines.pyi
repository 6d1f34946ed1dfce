"""Motions of machines and heaters, compiled: use `stickslip.models`."""

from typing import Protocol

from numpy import float64
from numpy.typing import NDArray

class _States(Protocol):
    """States of a machine at the readings, (vectors, readings, states)."""

    def __call__(
        self,
        terms: NDArray[float64],
        start: NDArray[float64],
        times: NDArray[float64],
        knots: NDArray[float64],
        inputs: NDArray[float64],
        late: NDArray[float64],
        lines: bool,
        /,
    ) -> NDArray[float64]: ...

terms: dict[str, tuple[str, ...]]
"""Names of the terms of each machine."""

states: dict[str, _States]
