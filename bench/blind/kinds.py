"""The plan of the study: which kinds of data set there are, and how many of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from blind.catalogue import CAUSES, HIDING, LAWS

VELOCITY, ANGLE, FIELD = ("velocity",), ("angle",), ("field",)
FILMED = ("velocity", "film")
TABLES = ("velocity", "angle", "field")


@dataclass(frozen=True)
class Noise:
    """Errors of the readings beyond independent normal ones.

    Attributes
    ----------
    t4 : bool
        Student's law with four degrees of freedom.
    setups : bool
        The robot was put down anew for every trial: half the noise, or a relative change.
    outlier : bool
        One wild trial of all.
    correlated : bool
        First-order correlation of 0.3 to 0.9 along the frequencies of a curve and the frames of a
        film.
    """

    t4: bool = False
    setups: bool = False
    outlier: bool = False
    correlated: bool = False


@dataclass(frozen=True)
class Kind:
    """A kind of data set.

    Attributes
    ----------
    count : int
        How many the plan has.
    family : str
        Whose demands it is judged by; see scoring.py.
    hidden : tuple of tuple of str
        What is hidden in one data set after the other, names of the catalogue or constants.
    wanted : (float, float), optional
        Signal to noise of each hidden thing after recalibration, low and high end; of a law also
        beside each of its rivals.
    tables : tuple of str
        What was measured.
    noise : Noise
    """

    count: int
    family: str
    hidden: tuple[tuple[str, ...], ...] = ((),)
    wanted: tuple[float, float] | None = None
    tables: tuple[str, ...] = VELOCITY
    noise: Noise = Noise()


def _each(names: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    return tuple((name,) for name in names)


_TWINS = ("length_scale", "clock_scale")
# What velocities can show of one cause by itself: exact twins and what is only in angles are out.
_MOVING = tuple(name for name in CAUSES if name not in (*_TWINS, "angle_offset"))
_RESTING = ("misalignment", "ambient_field", "angle_offset")
_PROBED = ("field_gain", "ambient_field")
_FILMED = (
    "eddy_lag", "edge_time", "misalignment", "ambient_field", "stribeck_friction", "angle_drag",
    "angle_adhesion", "rotational_drag", "surface_tilt", "friction_patches", *_TWINS,
)  # fmt: skip
_PAIRS = tuple((one, _MOVING[(k + 5) % len(_MOVING)]) for k, one in enumerate(_MOVING))
_SUSPECTS = ("contact.kinetic_friction", "contact.adhesion", "drag.rotational")

KINDS = {
    "none": Kind(128, "none"),
    "none, t4": Kind(30, "none, hard", noise=Noise(t4=True)),
    "none, set-ups": Kind(30, "none, hard", noise=Noise(setups=True)),
    "none, outlier": Kind(30, "none, hard", noise=Noise(outlier=True)),
    "none, hard": Kind(30, "none, hard", noise=Noise(t4=True, setups=True, outlier=True)),
    "none, correlated": Kind(40, "none, correlated", noise=Noise(correlated=True)),
    "none, film": Kind(10, "none", tables=FILMED),
    "none, film correlated": Kind(
        20, "none, correlated", tables=FILMED, noise=Noise(correlated=True)
    ),
    "none, angles": Kind(12, "none", tables=ANGLE),
    "none, fields": Kind(12, "none", tables=FIELD),
    "none, all tables": Kind(6, "none", tables=TABLES),
    "constant 3 sd": Kind(39, "constant 3 sd", _each(_SUSPECTS)),
    "constant 5 sd": Kind(39, "constant 5 sd", _each(_SUSPECTS)),
    "constant 5 sd, angles": Kind(4, "constant 5 sd", _each(("robot.magnetization",)), None, ANGLE),
    "constant 5 sd, fields": Kind(4, "constant 5 sd", _each(("coil.side",)), None, FIELD),
    "single": Kind(154, "single", _each(_MOVING), (6.0, 20.0)),
    "single, correlated": Kind(
        22, "single, correlated", _each(_MOVING), (6.0, 20.0), noise=Noise(correlated=True)
    ),
    "single, film": Kind(24, "single", _each(_FILMED), (6.0, 30.0), FILMED),
    "single, angles": Kind(16, "single", _each(_RESTING), (6.0, 20.0), ANGLE),
    "single, fields": Kind(8, "single", _each(_PROBED), (6.0, 20.0), FIELD),
    "single, all tables": Kind(
        8, "single", _each((*_RESTING, "surface_tilt")), (6.0, 30.0), TABLES
    ),
    "weak": Kind(44, "weak", _each(_MOVING), (3.8, 4.2)),
    "near twins": Kind(
        30, "near twins", _each(("surface_tilt", "friction_anisotropy")), (6.0, 15.0)
    ),
    "exact twins": Kind(30, "exact twins", _each(_TWINS), (6.0, 15.0)),
    "pair": Kind(66, "pair", _PAIRS, (8.0, 16.0)),
    "hiding": Kind(32, "hiding", HIDING, (6.0, 10.0)),
    "unknown": Kind(30, "unknown", (("ripple",),), (15.0, 25.0)),
    "law": Kind(48, "law", _each(tuple(LAWS)), (8.0, 20.0)),
    "instrument": Kind(
        12, "instrument", _each(("velocity_offset", "velocity_clipping", *_TWINS)), (8.0, 20.0)
    ),
    "instrument, angles": Kind(
        12, "instrument", _each(("angle_offset", "angle_scale", "angle_clipping")), (8.0, 20.0),
        ANGLE,
    ),
    "instrument, fields": Kind(
        8, "instrument", _each(("probe_turned", "probe_clipping")), (8.0, 20.0), FIELD
    ),
    "instrument, film": Kind(
        12, "instrument", _each(("film_delay", "film_clipping", "marker_place")), (8.0, 30.0),
        FILMED,
    ),
    "shuffled": Kind(10, "shuffled", _each(_MOVING), (6.0, 20.0)),
}  # fmt: skip


def plan(first: int, seeds: int, kinds: list[str]) -> Iterator[tuple[str, int]]:
    """Kinds and seeds, at most `seeds` of a kind, mixed: a study cut short has all kinds."""
    entries = [
        ((number + 0.5) / min(KINDS[name].count, seeds), order, name, first + number)
        for order, name in enumerate(kinds)
        for number in range(min(KINDS[name].count, seeds))
    ]
    for _, _, name, seed in sorted(entries):
        yield name, seed
