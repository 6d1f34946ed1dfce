# Made by tests/sections_stub.py from the core's tables of a run's quantities.
from abc import ABC, abstractmethod
from typing import Any

from numpy.typing import NDArray

class Recorded(ABC):
    @abstractmethod
    def _number(self, name: str) -> float: ...
    @abstractmethod
    def _recorded(self, name: str) -> NDArray[Any]: ...
    mean_velocity: float
    mean_velocity_y: float
    turning_speed: float
    theta_min: float
    theta_max: float
    slip_up: float
    slip_down: float
    slip_flat: float
    airborne_fraction: float
    velocity_growth: float
    pull_ratio: float
    pull_share: float
    field_change: float
    field_max: float
    field_min: float
    current_max: float
    voltage_max: float
    power_mean: float
    simulated_time: float
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
