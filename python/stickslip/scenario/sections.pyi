# Made by tests/sections_stub.py from the core's table of keys.
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple

from stickslip.field.field_map import FieldMap
from stickslip.scenario.played_rows import Accelerations, Forces
from stickslip.scenario.section import Section
from stickslip.scenario.waveform import Waveform

STATE_COLUMNS: tuple[str, ...]
CONTACT_WORDS: tuple[str, ...]
SECTIONS: dict[str, type[Any]]

class OneCoil(NamedTuple):
    resistance: float
    inductance: float
    capacitance: float
    side: float
    distance: float
    turns: float

class Drive(Section, key="drive"):
    def __init__(
        self,
        *,
        mode: Literal["IPP", "OPP", "program", "none"] = "IPP",
        clamp: Literal["down", "up"] = "down",
        edge: Literal["rise", "fall"] = "rise",
        direction: Literal["+x", "-x"] = "+x",
        coils: Literal["single", "pairs"] = "single",
        frequency: float = 100.0,
        peak: float = 0.0025,
        base: float = 0.0,
        hold: float = 0.001,
        edge_time: float = 0.0,
        heading: float = 0.0,
        ramp: float = 0.05,
        pulses: int = 100,
        ramp_down: float = 0.0,
        latency: float = 0.0,
        program: Waveform | None = None,
    ) -> None: ...
    @property
    def mode(self) -> Literal["IPP", "OPP", "program", "none"]: ...
    @property
    def clamp(self) -> Literal["down", "up"]: ...
    @property
    def edge(self) -> Literal["rise", "fall"]: ...
    @property
    def direction(self) -> Literal["+x", "-x"]: ...
    @property
    def coils(self) -> Literal["single", "pairs"]: ...
    @property
    def frequency(self) -> float: ...
    @property
    def peak(self) -> float: ...
    @property
    def base(self) -> float: ...
    @property
    def hold(self) -> float: ...
    @property
    def edge_time(self) -> float: ...
    @property
    def heading(self) -> float: ...
    @property
    def ramp(self) -> float: ...
    @property
    def pulses(self) -> int: ...
    @property
    def ramp_down(self) -> float: ...
    @property
    def latency(self) -> float: ...
    @property
    def program(self) -> Waveform | None: ...
    @property
    def kind(self) -> Literal["sawtooth", "program", "none"]: ...
    @property
    def facing(self) -> float: ...

class Coil(Section, key="coil"):
    def __init__(
        self,
        *,
        resistance: float = 10.0,
        inductance: float = 0.07,
        capacitance: float = 0.0,
        side: float = 0.1385,
        distance: float = 0.099,
        turns: float = 510.0,
        map: FieldMap | None = None,
        xp: Mapping[str, float] | OneCoil | None = None,
        xm: Mapping[str, float] | OneCoil | None = None,
        yp: Mapping[str, float] | OneCoil | None = None,
        ym: Mapping[str, float] | OneCoil | None = None,
        clamp: Mapping[str, float] | OneCoil | None = None,
    ) -> None: ...
    @property
    def resistance(self) -> float: ...
    @property
    def inductance(self) -> float: ...
    @property
    def capacitance(self) -> float: ...
    @property
    def side(self) -> float: ...
    @property
    def distance(self) -> float: ...
    @property
    def turns(self) -> float: ...
    @property
    def map(self) -> FieldMap | None: ...
    def own_values(self) -> dict[str, float]: ...
    @staticmethod
    def of(
        *,
        field_per_ampere: float,
        distance: float,
        side: float | None = None,
        radius: float | None = None,
        resistance: float,
        inductance: float | None = None,
        rise_time: float | None = None,
        capacitance: float = 0.0,
    ) -> Coil: ...
    @property
    def xp(self) -> OneCoil: ...
    @property
    def xm(self) -> OneCoil: ...
    @property
    def yp(self) -> OneCoil: ...
    @property
    def ym(self) -> OneCoil: ...
    @property
    def clamp(self) -> OneCoil: ...

class Robot(Section, key="robot"):
    def __init__(
        self,
        *,
        length: float = 0.00025,
        width: float = 0.00013,
        height: float = 0.0001,
        mass: float = 2.56e-08,
        magnetization: float = 500000.0,
    ) -> None: ...
    @property
    def length(self) -> float: ...
    @property
    def width(self) -> float: ...
    @property
    def height(self) -> float: ...
    @property
    def mass(self) -> float: ...
    @property
    def magnetization(self) -> float: ...
    @staticmethod
    def of(
        length: float,
        width: float,
        height: float,
        *,
        material: str | None = None,
        density: float | None = None,
        magnetization: float | None = None,
    ) -> Robot: ...

class Contact(Section, key="contact"):
    def __init__(
        self,
        *,
        static_friction: float = 0.2,
        kinetic_friction: float = 0.145,
        adhesion: float = 2.2e-07,
        restitution: float = 0.0,
        tangential_restitution: float = 0.0,
    ) -> None: ...
    @property
    def static_friction(self) -> float: ...
    @property
    def kinetic_friction(self) -> float: ...
    @property
    def adhesion(self) -> float: ...
    @property
    def restitution(self) -> float: ...
    @property
    def tangential_restitution(self) -> float: ...

class Drag(Section, key="drag"):
    def __init__(
        self,
        *,
        linear: float = 1e-05,
        rotational: float = 9e-17,
    ) -> None: ...
    @property
    def linear(self) -> float: ...
    @property
    def rotational(self) -> float: ...

class Environment(Section, key="environment"):
    def __init__(
        self,
        *,
        gravity: float = 9.81,
    ) -> None: ...
    @property
    def gravity(self) -> float: ...

class Shake(Section, key="shake"):
    def __init__(
        self,
        *,
        liquid: Literal["moves", "rests"] = "moves",
        frequency: float = 100.0,
        amplitude_x: float = 0.0,
        amplitude_z: float = 0.0,
        phase: float = 0.0,
        harmonic_2_x: float = 0.0,
        phase_2_x: float = 0.0,
        harmonic_3_x: float = 0.0,
        phase_3_x: float = 0.0,
        harmonic_4_x: float = 0.0,
        phase_4_x: float = 0.0,
        harmonic_2_z: float = 0.0,
        phase_2_z: float = 0.0,
        harmonic_3_z: float = 0.0,
        phase_3_z: float = 0.0,
        harmonic_4_z: float = 0.0,
        phase_4_z: float = 0.0,
        accelerations: Accelerations | None = None,
    ) -> None: ...
    @property
    def liquid(self) -> Literal["moves", "rests"]: ...
    @property
    def frequency(self) -> float: ...
    @property
    def amplitude_x(self) -> float: ...
    @property
    def amplitude_z(self) -> float: ...
    @property
    def phase(self) -> float: ...
    @property
    def harmonic_2_x(self) -> float: ...
    @property
    def phase_2_x(self) -> float: ...
    @property
    def harmonic_3_x(self) -> float: ...
    @property
    def phase_3_x(self) -> float: ...
    @property
    def harmonic_4_x(self) -> float: ...
    @property
    def phase_4_x(self) -> float: ...
    @property
    def harmonic_2_z(self) -> float: ...
    @property
    def phase_2_z(self) -> float: ...
    @property
    def harmonic_3_z(self) -> float: ...
    @property
    def phase_3_z(self) -> float: ...
    @property
    def harmonic_4_z(self) -> float: ...
    @property
    def phase_4_z(self) -> float: ...
    @property
    def accelerations(self) -> Accelerations | None: ...

class Inner(Section, key="inner"):
    def __init__(
        self,
        *,
        mass: float = 0.0,
        stiffness: float = 0.0,
        damping: float = 0.0,
        direction: float = 0.0,
        stop_low: float = -1.0,
        stop_high: float = 1.0,
        restitution: float = 0.0,
        amplitude: float = 0.0,
        frequency: float = 100.0,
        phase: float = 0.0,
        harmonic_2: float = 0.0,
        phase_2: float = 0.0,
        harmonic_3: float = 0.0,
        phase_3: float = 0.0,
        harmonic_4: float = 0.0,
        phase_4: float = 0.0,
        duty: float = 0.0,
        forces: Forces | None = None,
    ) -> None: ...
    @property
    def mass(self) -> float: ...
    @property
    def stiffness(self) -> float: ...
    @property
    def damping(self) -> float: ...
    @property
    def direction(self) -> float: ...
    @property
    def stop_low(self) -> float: ...
    @property
    def stop_high(self) -> float: ...
    @property
    def restitution(self) -> float: ...
    @property
    def amplitude(self) -> float: ...
    @property
    def frequency(self) -> float: ...
    @property
    def phase(self) -> float: ...
    @property
    def harmonic_2(self) -> float: ...
    @property
    def phase_2(self) -> float: ...
    @property
    def harmonic_3(self) -> float: ...
    @property
    def phase_3(self) -> float: ...
    @property
    def harmonic_4(self) -> float: ...
    @property
    def phase_4(self) -> float: ...
    @property
    def duty(self) -> float: ...
    @property
    def forces(self) -> Forces | None: ...

class State(Section, key="initial"):
    def __init__(
        self,
        *,
        contact: Literal[
            "from_motion",
            "flight",
            "corner_stick",
            "corner_slip_forward",
            "corner_slip_backward",
            "face_stick",
            "face_slip_forward",
            "face_slip_backward",
        ] = "from_motion",
        x: float = 0.0,
        z: float = 0.0,
        theta: float = 0.0,
        vx: float = 0.0,
        vz: float = 0.0,
        omega: float = 0.0,
        current_xp: float = 0.0,
        current_xm: float = 0.0,
        current_yp: float = 0.0,
        current_ym: float = 0.0,
        current_clamp: float = 0.0,
        field_lag_xp: float = 0.0,
        field_lag_xm: float = 0.0,
        field_lag_yp: float = 0.0,
        field_lag_ym: float = 0.0,
        field_lag_clamp: float = 0.0,
        capacitor_xp: float = 0.0,
        capacitor_xm: float = 0.0,
        capacitor_yp: float = 0.0,
        capacitor_ym: float = 0.0,
        capacitor_clamp: float = 0.0,
        contact_age: float = 0.0,
        y: float = 0.0,
        vy: float = 0.0,
        heading: float = 0.0,
        inner_place: float = 0.0,
        inner_velocity: float = 0.0,
    ) -> None: ...
    @property
    def contact(
        self,
    ) -> Literal[
        "from_motion",
        "flight",
        "corner_stick",
        "corner_slip_forward",
        "corner_slip_backward",
        "face_stick",
        "face_slip_forward",
        "face_slip_backward",
    ]: ...
    @property
    def x(self) -> float: ...
    @property
    def z(self) -> float: ...
    @property
    def theta(self) -> float: ...
    @property
    def vx(self) -> float: ...
    @property
    def vz(self) -> float: ...
    @property
    def omega(self) -> float: ...
    @property
    def current_xp(self) -> float: ...
    @property
    def current_xm(self) -> float: ...
    @property
    def current_yp(self) -> float: ...
    @property
    def current_ym(self) -> float: ...
    @property
    def current_clamp(self) -> float: ...
    @property
    def field_lag_xp(self) -> float: ...
    @property
    def field_lag_xm(self) -> float: ...
    @property
    def field_lag_yp(self) -> float: ...
    @property
    def field_lag_ym(self) -> float: ...
    @property
    def field_lag_clamp(self) -> float: ...
    @property
    def capacitor_xp(self) -> float: ...
    @property
    def capacitor_xm(self) -> float: ...
    @property
    def capacitor_yp(self) -> float: ...
    @property
    def capacitor_ym(self) -> float: ...
    @property
    def capacitor_clamp(self) -> float: ...
    @property
    def contact_age(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def vy(self) -> float: ...
    @property
    def heading(self) -> float: ...
    @property
    def inner_place(self) -> float: ...
    @property
    def inner_velocity(self) -> float: ...
    @property
    def row(self) -> list[float]: ...
    @staticmethod
    def from_row(row: Any) -> State: ...

class Solver(Section, key="solver"):
    def __init__(
        self,
        *,
        method: Literal["tsit5", "arkode"] = "tsit5",
        rtol: float = 1e-08,
        max_step: float = 0.0,
        max_steps: int = 1000000000,
    ) -> None: ...
    @property
    def method(self) -> Literal["tsit5", "arkode"]: ...
    @property
    def rtol(self) -> float: ...
    @property
    def max_step(self) -> float: ...
    @property
    def max_steps(self) -> int: ...

class Record(Section, key="record"):
    def __init__(
        self,
        *,
        rate: float | Literal["none", "events"] = "none",
        fields: str | Sequence[str] = "all",
        dtype: Literal["float64", "float32"] = "float64",
        pull_share: Literal["no", "yes"] = "no",
        from_: float = 0.0,
    ) -> None: ...
    @property
    def rate(self) -> float | Literal["none", "events"]: ...
    @property
    def fields(self) -> str: ...
    @property
    def dtype(self) -> Literal["float64", "float32"]: ...
    @property
    def pull_share(self) -> Literal["no", "yes"]: ...
    @property
    def from_(self) -> float: ...
