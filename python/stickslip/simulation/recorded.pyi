# Made by tests/sections_stub.py from the core's table of recorded quantities.
from abc import ABC, abstractmethod
from typing import Any

from numpy.typing import NDArray

class Recorded(ABC):
    @abstractmethod
    def _recorded(self, name: str) -> NDArray[Any]: ...
    t: NDArray[Any]
    x: NDArray[Any]
    z: NDArray[Any]
    theta: NDArray[Any]
    vx: NDArray[Any]
    vz: NDArray[Any]
    omega: NDArray[Any]
    normal_force: NDArray[Any]
    friction_force: NDArray[Any]
    contact_x: NDArray[Any]
    slip_velocity: NDArray[Any]
    bx: NDArray[Any]
    by: NDArray[Any]
    bz: NDArray[Any]
    current: NDArray[Any]
    contact: NDArray[Any]
    event: NDArray[Any]
    y: NDArray[Any]
    vy: NDArray[Any]
    heading: NDArray[Any]
    friction_across: NDArray[Any]
    contact_y: NDArray[Any]
    slip_across: NDArray[Any]
    inner_place: NDArray[Any]
    inner_velocity: NDArray[Any]
