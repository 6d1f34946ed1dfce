"""The sections of a scenario, as frozen dataclasses. Each checks its values when it is made."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast

from stickslip import _core
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import (
    checked,
    field_of,
    find_key,
    known_keys,
    recorded_fields,
    refuse,
)
from stickslip.scenario.path_keys import COIL_MAP, FILE, MAP_HINT, PROGRAM, PROGRAM_HINT

if TYPE_CHECKING:
    from stickslip.field.field_map import FieldMap
    from stickslip.scenario.waveform import Waveform

COIL_NAMES = _core.coil_names
"""Order of the coils in every array of currents or voltages: +x, -x, +y, -y, and below (-z)."""

SAWTOOTH = (
    *("drive.frequency", "drive.peak", "drive.base", "drive.hold", "drive.clamp"),
    *("drive.edge", "drive.edge_time", "drive.ramp", "drive.pulses", "drive.ramp_down"),
    *("drive.heading", "drive.coils"),
)
"""Keys that say what a pulsed drive does; a program of voltages has no use for them."""


def refuse_sawtooth(mode: object, given: Iterable[str]) -> None:
    """Refuse the first key of the sawtooth that is given together with a program of voltages."""
    key = next((key for key in given if key in SAWTOOTH), None)
    if mode == "program" and key is not None:
        raise ScenarioError(
            f'{key}: not allowed with drive.mode = "program", whose voltages ({FILE}, or {PROGRAM} '
            "in Python) say it all; leave it out"
        )


def refuse_sawtooth_values(mode: object, values: Mapping[str, object]) -> None:
    """The same of those of some keys that differ from their default."""
    refuse_sawtooth(mode, (key for key in values if values[key] != find_key(key).default))


_GEOMETRY = frozenset(
    f"{part}.{name}"
    for part in ("coil", *(f"coil.{name}" for name in COIL_NAMES))
    for name in ("side", "distance", "turns")
)


def refuse_uncertain_geometry(coil: Coil, keys: Iterable[str]) -> None:
    """Refuse the first uncertain key of the coils' geometry, which has no effect beside a map."""
    key = next((key for key in keys if key in _GEOMETRY), None)
    if coil.map is not None and key is not None:
        raise ScenarioError(
            f"{key}: cannot be uncertain beside {COIL_MAP}, which has the field of the coils; "
            "effects.field_gain.in_plane and effects.field_gain.clamp can"
        )


class Section:
    """A section of a scenario: it checks its fields by the keys of its own name."""

    _key: ClassVar[str]

    def __init_subclass__(cls, key: str | None = None) -> None:
        cls._key = key or cls.__name__.lower()

    def __post_init__(self) -> None:
        for each in dataclasses.fields(self):  # type: ignore[arg-type]
            key = f"{self._key}.{each.name.removesuffix('_')}"
            if key in known_keys():
                value = checked(key, getattr(self, each.name))
                object.__setattr__(self, each.name, value)


@dataclass(frozen=True, kw_only=True)
class Drive(Section):
    """What the coils are driven with, section V of the paper.

    A field given in tesla is the steady-state one of one coil, at the centre.
    The paper gives the default of `peak` (Figs. 4-13) and uses 100 Hz in Figs. 8-11. It states
    neither `base`, `hold`, `edge` nor `clamp`: their defaults are this package's, as are those of
    all other fields.

    Parameters
    ----------
    mode : {"IPP", "OPP", "program"}
        In-plane pulsing (the clamp coil holds), out-of-plane pulsing (the reverse), or `program`.
    frequency : float
        Pulses a second, Hz.
    peak, base : float
        Top and bottom of the sawtooth, T.
    hold : float
        Field of the holding coil, T.
    clamp : {"down", "up"}
        Sign of the clamp coil's field; ``"down"``: B_z < 0, nose-down, theta > 0.
    edge : {"rise", "fall"}
        Where the sawtooth is sudden.
    edge_time : float
        Duration of the sudden edge, s.
    direction : {"+x", "-x"}
        Where the robot faces. ``"-x"`` turns it by 180 degrees about z, and a pulsed drive with it:
        the -x coil drives, with the opposite sign. The voltages of a program stay as they are
        given, coil by coil in the world's frame: only the robot is turned, so that
        ``program.turned()`` moves it as `program` moves one that faces +x.
    heading : float
        Where the robot is driven, rad from `direction` to the left, within 6.3. The field turns it
        there: with a heading that is no multiple of pi the robot moves in the whole plane. A
        program has none, and no choice of `coils`: its voltages say where.
    coils : {"single", "pairs"}
        Which coils of an axis make its part of the field along the surface: the one that lies
        ahead, which pulls the robot too, or both alike, whose gradients cancel at the centre.
    ramp : float
        Rise of both coils from zero before the first pulse, s.
    pulses : int
        Number of pulses.
    ramp_down : float
        Fall of the in-plane coil to zero after the last pulse, s.
    program : Waveform, optional
        Voltages of the five coils; with ``mode="program"`` only, and then required. What is a
        pulsed drive's then has its default: all but `direction`.
    """

    mode: Literal["IPP", "OPP", "program"] = "IPP"
    frequency: float = 100.0
    peak: float = 2.5e-3
    base: float = 0.0
    hold: float = 1.0e-3
    clamp: Literal["down", "up"] = "down"
    edge: Literal["rise", "fall"] = "rise"
    edge_time: float = 0.0
    direction: Literal["+x", "-x"] = "+x"
    heading: float = 0.0
    coils: Literal["single", "pairs"] = "single"
    ramp: float = 0.05
    pulses: int = 100
    ramp_down: float = 0.0
    program: Waveform | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.program is not None:
            from stickslip.scenario.waveform import Waveform

            if not isinstance(self.program, Waveform):
                allowed = f"a Waveform; in a file or with --set, {PROGRAM_HINT}"
                refuse(PROGRAM, self.program, allowed)
        refuse_sawtooth_values(self.mode, {key: getattr(self, field_of(key)) for key in SAWTOOTH})

    @property
    def facing(self) -> float:
        """1 where a robot that stays in its plane faces +x, -1 where it faces -x."""
        back = self.direction == "-x"
        if self.mode != "program" and math.cos(self.heading) < 0.0:
            back = not back
        return -1.0 if back else 1.0


@dataclass(frozen=True, kw_only=True)
class OneCoil:
    """Values of one coil, as those of `Coil`."""

    resistance: float
    inductance: float
    side: float
    distance: float
    turns: float


_VALUES = tuple(each.name for each in dataclasses.fields(OneCoil))
_LIKE_MOST = cast("OneCoil", None)


@dataclass(frozen=True, kw_only=True, repr=False)
class Coil(Section):
    """The five coils, Table I.

    Parameters
    ----------
    resistance : float
        ohm.
    inductance : float
        H.
    side : float
        Effective length of a side, m.
    distance : float
        Distance of each coil's plane from the centre, m.
    turns : float
        Number of turns.
    map : FieldMap, optional
        Measured field of the five coils, in place of that of `side`, `distance` and `turns`, which
        then have their defaults.
    xp, xm, yp, ym, clamp : mapping or OneCoil, optional
        Values of one coil that differs, such as ``{"resistance": 10.5}``. It reads as a `OneCoil`.

    Where coils differ, `resistance` and its like are those of most coils (of xp, if all differ).
    """

    resistance: float = 10.0
    inductance: float = 0.07
    side: float = 0.1385
    distance: float = 0.099
    turns: float = 510.0
    map: FieldMap | None = None
    xp: OneCoil = _LIKE_MOST
    xm: OneCoil = _LIKE_MOST
    yp: OneCoil = _LIKE_MOST
    ym: OneCoil = _LIKE_MOST
    clamp: OneCoil = _LIKE_MOST

    def __post_init__(self) -> None:
        super().__post_init__()
        common = {name: getattr(self, name) for name in _VALUES}
        coils = {}
        for name in COIL_NAMES:
            given = getattr(self, name)
            if isinstance(given, OneCoil):
                given = vars(given)
            if not isinstance(given, Mapping | None):
                refuse(f"coil.{name}", given, f"a table [coil.{name}]")
            own = {k: checked(f"coil.{name}.{k}", v) for k, v in (given or {}).items()}
            coils[name] = {**common, **own}
        self._take(coils)
        if self.map is not None:
            from stickslip.field.field_map import FieldMap

            if not isinstance(self.map, FieldMap):
                refuse(COIL_MAP, self.map, f"a path in a file or with --set; {MAP_HINT}")

    def _take(self, coils: Mapping[str, Mapping[str, Any]]) -> None:
        for name, values in coils.items():
            object.__setattr__(self, name, OneCoil(**values))
        for value in _VALUES:
            each = [values[value] for values in coils.values()]
            object.__setattr__(self, value, max(each, key=each.count))

    def __repr__(self) -> str:
        shown = [*_VALUES, "map", *dict.fromkeys(key.split(".")[1] for key in self.own_values())]
        return f"Coil({', '.join(f'{name}={getattr(self, name)!r}' for name in shown)})"

    def own_values(self) -> dict[str, float]:
        """By dotted key, the values of single coils that differ from those of most."""
        return {
            f"coil.{name}.{value}": getattr(getattr(self, name), value)
            for name in COIL_NAMES
            for value in _VALUES
            if getattr(getattr(self, name), value) != getattr(self, value)
        }

    def with_values(self, values: Mapping[str, Any]) -> Coil:
        """A copy with other values, by key without ``coil.``, that are checked already.

        Those of all coils are set before those of single ones.
        """
        coils = {name: dict(vars(getattr(self, name))) for name in COIL_NAMES}
        for key in sorted(values, key=lambda key: "." in key):
            name, _, value = key.rpartition(".")
            for each in (name,) if name else COIL_NAMES:
                coils[each][value] = values[key]
        made = object.__new__(type(self))
        vars(made).update(vars(self))
        made._take(coils)
        return made


@dataclass(frozen=True, kw_only=True)
class Robot(Section):
    """The magnetic body, Table II.

    Parameters
    ----------
    length, width, height : float
        Length along the magnetization, width across the plane of motion, and height, m.
    mass : float
        kg. Table II's "ng" are micrograms: the body's density leaves no other reading.
    magnetization : float
        Along the length, A/m.
    """

    length: float = 250e-6
    width: float = 130e-6
    height: float = 100e-6
    mass: float = 25.6e-9
    magnetization: float = 5e5


@dataclass(frozen=True, kw_only=True)
class Contact(Section):
    """Contact of the body with the surface, sections IV-C, VI-A and VI-B.

    Parameters
    ----------
    static_friction, kinetic_friction : float
        Coulomb coefficients of a contact that sticks and of one that slips.
    adhesion : float
        Pull of the surface on the touching corners together, N.
    restitution : float
        Newton restitution of a touch-down, 0 to 1.
    tangential_restitution : float
        Part of its slip that a corner which rebounds reverses, as far as friction can, 0 to 1;
        what the surfaces' tangential elasticity gives back (Walton, 1993).
    """

    static_friction: float = 0.2
    kinetic_friction: float = 0.145
    adhesion: float = 0.22e-6
    restitution: float = 0.0
    tangential_restitution: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Drag(Section):
    """Drag of the fluid, section VI-C.

    Parameters
    ----------
    linear : float
        Force by velocity at the centre of mass, Eq. (18), N s/m.
    rotational : float
        Torque by the square of the angular rate, Eq. (19), N m s^2.
    """

    linear: float = 1.0e-5
    rotational: float = 9.0e-17


@dataclass(frozen=True, kw_only=True)
class Environment(Section):
    """What is the same for everything.

    Parameters
    ----------
    gravity : float
        Acceleration of gravity, m/s^2.
    """

    gravity: float = 9.81


@dataclass(frozen=True, kw_only=True)
class Solver(Section):
    """The integrator.

    Parameters
    ----------
    method : {"tsit5", "arkode"}
        Own Runge-Kutta method of fifth order, or that of SUNDIALS, where the build has it.
    rtol : float
        Local error a step, relative to the natural scales of the motion. Tightened where the linear
        drag is low; looser than 1e-5 gets a note.
    max_step : float
        Longest step, s; 0: no limit.
    max_steps : int
        Most steps of a run. One that needs more ends with the status "too_many_steps", whose
        message names the key that makes the steps short.
    """

    method: Literal["tsit5", "arkode"] = "tsit5"
    rtol: float = 1e-8
    max_step: float = 0.0
    max_steps: int = 1_000_000_000


@dataclass(frozen=True, kw_only=True)
class Record(Section):
    """What a run keeps beside its summary.

    Parameters
    ----------
    rate : float or {"none", "events"}
        Rate of a uniform grid of samples, Hz; or one sample at each event of the contact; or none.
    from_ : float
        Simulated time before which nothing is recorded, s; the key is ``record.from``.
    fields : str or sequence of str
        Which quantities are kept, of the arrays of a `Run`: names, or a text of them with commas
        between them, or ``"all"``. `t` is always kept.
    dtype : {"float64", "float32"}
        Precision of what is kept. `t` always has float64: in float32 the samples of a run of some
        minutes would share times.
    """

    rate: float | Literal["none", "events"] = "none"
    from_: float = 0.0
    fields: str | Sequence[str] = "all"
    dtype: Literal["float64", "float32"] = "float64"

    def give_to(self, core: _core.Scenario) -> None:
        """Set the keys of the record in the core's scenario, which takes them together."""
        fields = recorded_fields(str(self.fields))
        if self.rate == "events":
            core.record_events(self.from_, fields)
        elif isinstance(self.rate, float):
            core.record_uniform(self.rate, self.from_, fields)
        else:
            core.record_nothing()
