"""Materials of robots, fluids around them, and the force of a fluid on a body in it."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from stickslip._util.messages import check_above_zero, refuse, shown, suggestion
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import USUAL

MU_0 = 4e-7 * math.pi
"""Magnetic constant, T m/A, to 1e-9."""

ROUGHNESS = 1.5e-6
"""Gap below a body that lies on a surface, m: that of Eq. (16), a measured roughness."""


class Material(NamedTuple):
    """A permanent magnet.

    Attributes
    ----------
    density : float
        kg/m^3.
    remanence : float
        Middle of the range that makers give, T. Small pieces may have half of it: a laser or a saw
        damages what it cuts, and the paper's robot has 0.63 T.
    source : str
        Where the numbers are from.
    """

    density: float
    remanence: float
    source: str

    @property
    def magnetization(self) -> float:
        """A/m, without the loss in the magnet's own field, some 3 % with a recoil of 1.05."""
        return self.remanence / MU_0


MATERIALS: Mapping[str, Material] = {
    "NdFeB N35": Material(7500.0, 1.195, "makers' tables: 1.17 to 1.22 T, sintered"),
    "NdFeB N42": Material(7500.0, 1.30, "makers' tables: 1.28 to 1.32 T, sintered"),
    "NdFeB N52": Material(7500.0, 1.45, "makers' tables: 1.42 to 1.48 T, sintered"),
    "NdFeB bonded": Material(6000.0, 0.68, "makers' tables: 0.65 to 0.71 T, grade 10, pressed"),
    "SmCo5": Material(8300.0, 0.90, "makers' tables: 0.86 to 0.93 T, 18 to 22 MGOe"),
    "Sm2Co17": Material(8400.0, 1.06, "makers' tables: 1.02 to 1.10 T, 26 to 30 MGOe"),
    "ferrite Y30": Material(4900.0, 0.385, "SJ 285-77: 0.380 T at least, 0.385 T typical"),
}


class Liquid(NamedTuple):
    """A liquid or gas: density, kg/m^3, viscosity, Pa s, and where they are from."""

    density: float
    viscosity: float
    source: str


_MOST_NEAR = 9  # names that a message suggests; chosen: all silicone oils


def _silicone(stokes: float, density: float) -> Liquid:
    source = "nominal viscosity; density by makers' tables to 0.5 %, 25 degrees C"
    return Liquid(density, 1e-6 * stokes * density, source)


LIQUIDS: Mapping[str, Liquid] = {
    # 2.4 % less viscous for each degree.
    "water": Liquid(998.2, 1.002e-3, "Kestin, Sokolov and Wakeham (1978), 20 degrees C"),
    "ethanol": Liquid(785.0, 1.074e-3, "CRC Handbook of Chemistry and Physics, 25 degrees C"),
    "glycerol": Liquid(1261.0, 1.41, "Cheng (2008), 20 degrees C, free of water"),
    "air": Liquid(1.204, 1.82e-5, "CRC Handbook of Chemistry and Physics, to 20 degrees C"),
    **{
        f"silicone oil {stokes} cSt": _silicone(stokes, density)
        for stokes, density in ((5, 913), (10, 935), (20, 950), (50, 960), (100, 965))
    },
    **{f"silicone oil {stokes} cSt": _silicone(stokes, 970) for stokes in (350, 500, 1000)},
}


@dataclass(frozen=True)
class Fluid:
    """A fluid around a robot.

    Attributes
    ----------
    density : float
        kg/m^3.
    viscosity : float
        Dynamic one, Pa s.
    gap : float or None
        Height of the fluid between the robot and the wall, m; None far from a wall.
    name : str or None
        Its name, where it was given by one.
    """

    density: float
    viscosity: float
    gap: float | None = None
    name: str | None = None

    @staticmethod
    def of_table(table: Mapping[str, Any]) -> Fluid:
        """The fluid of a section ``[fluid]``: the arguments of `Scenario.in_fluid`."""
        known = ("name", "density", "viscosity", "wall")
        for key, value in table.items():
            if key not in known:
                raise ScenarioError(
                    f"fluid.{key} = {shown(value)}: there is no such key; {suggestion(key, known)}"
                )
        name, density, viscosity = (table.get(key) for key in known[:3])
        with prefixed("[fluid]"):
            return fluid_of(name, density, viscosity, table.get("wall", True))

    @property
    def lines(self) -> list[str]:
        """The section in a scenario's file."""
        wall = "false" if self.gap is None else repr(self.gap)
        return [
            "[fluid]  # for its notes: what it sets stands above",
            *([] if self.name is None else [f"name = {shown(self.name)}"]),
            f"density = {self.density!r}  # kg/m^3",
            f"viscosity = {self.viscosity!r}  # Pa s",
            f"wall = {wall}  # m",
        ]

    @property
    def values(self) -> list[tuple[str, tuple[float, float, str], float]]:
        """What it states: names, usual magnitudes of a fluid or of that by name, and values."""
        of, density, viscosity = "", USUAL["fluid.density"], USUAL["fluid.viscosity"]
        if self.name is not None:
            known, of = LIQUIDS[self.name], f" of {self.name}"
            density = 0.8 * known.density, 1.2 * known.density, density[2]
            viscosity = known.viscosity / 3.0, 3.0 * known.viscosity, viscosity[2]
        return [
            (f"fluid.density{of}", density, self.density),
            (f"fluid.viscosity{of}", viscosity, self.viscosity),
        ]

    def changes(self, robot: Any, gravity: float) -> dict[str, float]:
        """The keys of a scenario for a robot in this fluid, where bodies fall with `gravity`."""
        body = robot.mass / (robot.length * robot.width * robot.height)
        if self.density >= body:
            refuse("density", self.density, f"one below {body:.4g} kg/m3, of the robot: it floats")
        radius = equal_radius(robot)
        along, turning = wall_factors(self.gap / radius) if self.gap is not None else (1.0, 1.0)
        return {
            "drag.linear": 6.0 * math.pi * self.viscosity * radius * along,
            "drag.rotational": 0.0,
            "effects.rotational_drag.coefficient": (
                8.0 * math.pi * self.viscosity * radius**3 * turning
            ),
            "environment.gravity": gravity * (1.0 - self.density / body),
        }


def magnet_of(
    material: str | None, density: float | None, magnetization: float | None
) -> tuple[float, float]:
    """Density, kg/m^3, and magnetization, A/m, of a material, or those that are given."""
    if material is not None:
        known = _named("material", material, MATERIALS)
        density = known.density if density is None else density
        magnetization = known.magnetization if magnetization is None else magnetization
    _check_given("a material", density=density, magnetization=magnetization)
    check_above_zero("density", density, "kg/m3")
    if not (is_number(magnetization) and 0.0 <= magnetization < math.inf):
        refuse("magnetization", magnetization, "a number of A/m from 0")
    return density, magnetization  # type: ignore[return-value]


def fluid_of(
    name: str | None, density: float | None, viscosity: float | None, wall: bool | float
) -> Fluid:
    """The fluid of these arguments of `Scenario.in_fluid`."""
    if name is not None:
        known = _named("fluid", name, LIQUIDS)
        density = known.density if density is None else density
        viscosity = known.viscosity if viscosity is None else viscosity
    _check_given("a fluid", density=density, viscosity=viscosity)
    check_above_zero("density", density, "kg/m3")
    check_above_zero("viscosity", viscosity, "Pa s")
    if isinstance(wall, bool):
        gap = ROUGHNESS if wall else None
    else:
        check_above_zero("wall", wall, "m, true or false;")
        gap = float(wall)
    return Fluid(float(density), float(viscosity), gap, name)  # type: ignore[arg-type]


def _check_given(what: str, **values: object) -> None:
    """Refuse that one of the numbers is missing, which a name would stand for."""
    for key, value in values.items():
        if value is None:
            raise ScenarioError(f"{key} is missing: give {' and '.join(values)}, or name {what}")


def _named(key: str, name: Any, table: Mapping[str, Any]) -> Any:
    if not isinstance(name, str) or name not in table:
        word = name.casefold() if isinstance(name, str) else None
        near = [each for each in table if word and word in each.casefold()]
        near = near or difflib.get_close_matches(str(name), table)
        hint = f"did you mean {' or '.join(map(shown, near))}?"
        if not 0 < len(near) <= _MOST_NEAR:
            hint = suggestion("", table)
        refuse(key, name, f"a name of the table; {hint}")
    return table[name]


def equal_radius(robot: Any) -> float:
    """Radius of the sphere of the robot's volume, m."""
    return math.cbrt(0.75 / math.pi * robot.length * robot.width * robot.height)


def wall_factors(gap: float) -> tuple[float, float]:
    """Drag and drag torque of a sphere above a wall over those far from it.

    It moves along the wall, or turns about an axis along it, with a gap of `gap` radii. Near the
    wall they are Eqs. (2.65) and (3.13) of Goldman, Cox and Brenner (1967), which grow with the
    logarithm of 1 / gap, and far from it Faxen's series of the height of the centre, as Faucheux
    and Libchaber (1994) give it, which is never negative there: the larger one is within 5 % (drag)
    and 8 % (torque) of their exact numbers at every gap. Faxen's series with the height of a
    block's centre, below the radius, would be negative.
    """
    near, u = math.log(1.0 / gap), 1.0 / (1.0 + gap)
    faxen = 1.0 - 9 / 16 * u + 1 / 8 * u**3 - 45 / 256 * u**4 - 1 / 16 * u**5
    along = max(8 / 15 * near + 0.9588, 1.0 / faxen)
    return along, max(2 / 5 * near + 0.3817, 1.0 / (1.0 - 5 / 16 * u**3))


class LeftOut(NamedTuple):
    """Parts of a fluid's force on a robot that the model leaves out.

    Over Stokes' drag: more of it on a sphere that swings (Stokes, 1851), and that moves steadily
    (`inertia`; Schiller and Naumann, 1933), and of the film below a robot that lies flat, Eq. (16).
    Over the robot's mass: that of the fluid which a swinging sphere carries along.
    """

    drag: float = 0.0
    mass: float = 0.0
    inertia: float = 0.0
    film: float = 0.0


def left_out(fluid: Fluid, robot: Any, frequency: float, speed: float) -> LeftOut:
    """Parts that are left out at a frequency, Hz, and a steady speed, m/s; zero for none."""
    radius, volume = equal_radius(robot), robot.length * robot.width * robot.height
    drag = mass = film = 0.0
    if frequency > 0.0:
        layer = math.sqrt(fluid.viscosity / (math.pi * frequency * fluid.density))
        drag = radius / layer
        mass = (0.5 + 2.25 / drag) * fluid.density * volume / robot.mass
    if fluid.gap is not None:
        face = robot.length * robot.width / fluid.gap
        film = face / (6.0 * math.pi * radius * wall_factors(fluid.gap / radius)[0])
    reynolds = 2.0 * radius * abs(speed) * fluid.density / fluid.viscosity
    return LeftOut(drag, mass, 0.15 * reynolds**0.687, film)
