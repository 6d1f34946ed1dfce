"""The compiled core. Thin and unchecked: use the package's public classes."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypedDict

from numpy import float64, generic, int8
from numpy.typing import NDArray

__version__: str
has_arkode: bool
wire_radius: float
coil_names: tuple[str, ...]
contact_names: tuple[str, ...]
event_names: tuple[str, ...]
status_names: tuple[str, ...]
state_columns: tuple[str, ...]
stop_quantities: tuple[str, ...]
record_columns: tuple[str, ...]
plane_columns: tuple[str, ...]

class _Parameter(TypedDict):
    key: str
    unit: str
    low: float
    high: float
    allowed: str
    integer: bool
    default: float
    meaning: str

class _Choice(TypedDict):
    key: str
    allowed: list[str]
    default: str
    meaning: str

class _Effect(TypedDict):
    name: str
    meaning: str
    source: str

class _Steps(TypedDict):
    accepted: int
    rejected: int
    evaluations: int

class _Summary(TypedDict):
    mean_velocity: float
    theta_min: float
    theta_max: float
    slip_up: float
    slip_down: float
    slip_flat: float
    airborne_fraction: float
    velocity_growth: float
    pull_ratio: float
    field_change: float
    field_max: float
    field_min: float
    current_max: float
    voltage_max: float
    power_mean: float
    simulated_time: float
    events: dict[str, int]
    painleve_events: int
    steps: _Steps

class _Recording(TypedDict):
    t: NDArray[float64]
    x: NDArray[float64]
    z: NDArray[float64]
    theta: NDArray[float64]
    vx: NDArray[float64]
    vz: NDArray[float64]
    omega: NDArray[float64]
    normal_force: NDArray[float64]
    friction_force: NDArray[float64]
    contact_x: NDArray[float64]
    slip_velocity: NDArray[float64]
    bx: NDArray[float64]
    by: NDArray[float64]
    bz: NDArray[float64]
    current: NDArray[float64]
    contact: NDArray[int8]
    event: NDArray[int8]

_Block = tuple[NDArray[float64], NDArray[float64], int]

def parameters() -> list[_Parameter]: ...
def choices() -> list[_Choice]: ...
def effects() -> list[_Effect]: ...
def register_effect(
    name: str,
    meaning: str,
    source: str,
    parameters: Sequence[tuple[str, str, float, float, float, str]],
    function: object,
    address: int = 0,
) -> None: ...
def unregister_effect(name: str) -> None: ...
def registered_effects() -> list[str]: ...
def simulate_batch(
    scenarios: Sequence[Scenario],
    threads: int = 1,
    progress: Callable[[float], object] | None = None,
    until: tuple[str, bool, float] | None = None,
) -> list[RunResult]: ...
def stream(
    result: RunResult,
    scenario: Scenario,
    sink: Callable[[_Recording], object],
    progress: Callable[[float], object] | None = None,
    until: tuple[str, bool, float] | None = None,
) -> None: ...
def rollout(
    scenarios: Sequence[Scenario],
    runs: int,
    states: NDArray[float64] | None,
    voltages: NDArray[float64],
    duration: float,
    linear: bool,
    columns: Sequence[int],
    out: NDArray[float64],
    threads: int,
    progress: Callable[[float], object] | None,
) -> NDArray[int8]: ...
def sweep(
    base: Scenario,
    keys: Sequence[str],
    values: NDArray[float64],
    threads: int = 1,
    progress: Callable[[float], object] | None = None,
) -> tuple[dict[str, NDArray[generic]], dict[int, str]]: ...
def static_tilts(
    base: Scenario,
    keys: Sequence[str],
    values: NDArray[float64],
    fields: NDArray[float64],
) -> NDArray[float64]: ...
def probe_readings(
    base: Scenario,
    keys: Sequence[str],
    values: NDArray[float64],
    points: NDArray[float64],
    currents: NDArray[float64],
) -> NDArray[float64]: ...
def surface_directions(
    angles: NDArray[float64],
) -> tuple[NDArray[float64], NDArray[float64]]: ...

most_map_degree: int

class FieldMap:
    def __init__(
        self,
        low: Sequence[float],
        high: Sequence[float],
        coefficients: Sequence[Sequence[float]],
    ) -> None: ...

def harmonic_fields(
    low: NDArray[float64], high: NDArray[float64], degree: int, points: NDArray[float64]
) -> NDArray[float64]: ...

class CoilSet:
    def __init__(
        self, side: Sequence[float], distance: Sequence[float], turns: Sequence[float]
    ) -> None: ...
    @property
    def side(self) -> list[float]: ...
    @property
    def distance(self) -> list[float]: ...
    @property
    def turns(self) -> list[float]: ...
    @property
    def centre_field_per_ampere(self) -> list[float]: ...
    @property
    def box(self) -> tuple[NDArray[float64], NDArray[float64]] | None: ...
    def field(self, points: NDArray[float64], currents: NDArray[float64]) -> NDArray[float64]: ...
    def gradient(
        self, points: NDArray[float64], currents: NDArray[float64]
    ) -> NDArray[float64]: ...
    def shares(self, points: NDArray[float64], currents: NDArray[float64]) -> NDArray[float64]: ...

class Scenario:
    def __init__(self, other: Scenario = ...) -> None: ...
    def set(self, key: str, value: float | str) -> None: ...
    def set_program(self, blocks: Sequence[_Block]) -> None: ...
    def set_map(self, map: FieldMap) -> None: ...
    def record_nothing(self) -> None: ...
    def record_events(self, start: float = 0.0, fields: Sequence[str] = ...) -> None: ...
    def record_uniform(
        self, rate: float, start: float = 0.0, fields: Sequence[str] = ...
    ) -> None: ...
    def check(self) -> None: ...
    def program(self) -> list[_Block]: ...
    def asked_voltages(self) -> list[float]: ...
    def coils(self) -> CoilSet: ...
    def resistances(self) -> list[float]: ...
    def rocking_rate(self, tesla: float) -> float: ...
    def free_curve(self, effect: str, arguments: NDArray[float64]) -> NDArray[float64]: ...
    @property
    def in_plane_coil(self) -> str: ...
    @property
    def turns(self) -> bool: ...
    @property
    def duration(self) -> float: ...
    @property
    def window(self) -> tuple[float, float]: ...

class Snapshot:
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(data: bytes) -> Snapshot: ...

class Simulator:
    def __init__(self, scenario: Scenario, whole_plane: bool) -> None: ...
    def step(
        self,
        voltages: Mapping[str, float],
        duration: float,
        linear: bool,
        start: Mapping[str, float] | None = None,
    ) -> dict[str, float | str]: ...
    def state(self) -> dict[str, float | str]: ...
    def snapshot(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot) -> None: ...
    @property
    def time(self) -> float: ...
    @property
    def voltages(self) -> list[float]: ...
    @property
    def status(self) -> str: ...
    @property
    def message(self) -> str: ...

class SimulatorBatch:
    def __init__(self, scenarios: Sequence[Scenario], whole_plane: bool) -> None: ...
    def step(
        self, voltages: NDArray[float64], duration: float, linear: bool, threads: int
    ) -> None: ...
    def states(self, out: NDArray[float64]) -> None: ...
    def statuses(self) -> NDArray[int8]: ...
    def snapshot(self, run: int) -> Snapshot: ...
    def restore(self, run: int, snapshot: Snapshot) -> None: ...
    def reset(self, run: int, scenario: Scenario) -> None: ...

class RunResult:
    def __init__(self) -> None: ...
    @property
    def stopped(self) -> bool: ...
    @property
    def final_state(self) -> dict[str, float | str]: ...
    @property
    def status(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def mean_velocity(self) -> float: ...
    def summary(self) -> _Summary: ...
    def take_recording(self) -> _Recording: ...
