"""Which kinds of data set of a walker there are, and how many of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from blind.catalogue import CAUSES, HIDING, LAWS

ALIKE = 0.9
"""Cosine above which an effect looks like another one."""
ERROR_SHARE = (0.15, 0.35)
"""Size of a model error over that of the effect beside it, both after recalibration."""

VELOCITY, ANGLE, FIELD = ("velocity",), ("angle",), ("field",)
FILMED = ("velocity", "film")
TABLES = ("velocity", "angle", "field")


@dataclass(frozen=True)
class Noise:
    """Errors of the readings beyond independent normal ones.

    t4: Student's law with four degrees of freedom. setups: The robot was put down anew for
    every trial: half the noise, or a relative change. outlier: One wild trial of all.
    correlated: Range of a first-order correlation along the frequencies of a curve and the
    frames of a film.
    """

    t4: bool = False
    setups: bool = False
    outlier: bool = False
    correlated: tuple[float, float] | None = None


@dataclass(frozen=True)
class Kind:
    """A kind of data set.

    count: How many there are. family: What is hidden, in a word.
    hidden: What is hidden in one data set after the other, names of the catalogue or constants.
    wanted: Signal to noise of each hidden thing after recalibration, low and high end; of a law
    also beside each of its rivals. tables: What was measured. noise. error: The last hidden
    thing is a model error beside the cause: its effect, after recalibration, is a share of that
    of the cause; see ERROR_SHARE. alike: Range in which the largest cosine between the effect
    and that of any listed cause should be, after recalibration, of a law that of any cause or law
    that acts elsewhere; another thing is hidden where it is not.
    """

    count: int
    family: str
    hidden: tuple[tuple[str, ...], ...] = ((),)
    wanted: tuple[float, float] | None = None
    tables: tuple[str, ...] = VELOCITY
    noise: Noise = Noise()
    error: bool = False
    alike: tuple[float, float] | None = None


def _each(names: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    return tuple((name,) for name in names)


def _disturbed(error: str, first: int) -> tuple[tuple[str, ...], ...]:
    """Each cause beside a model error; kinds begin at different ones."""
    return tuple((name, error) for name in (*_MOVING[first:], *_MOVING[:first]))


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
_BESIDE = (*_MOVING, *LAWS)
_DISTURBED = tuple(
    (_MOVING[(k + 14) % len(_MOVING)], _BESIDE[(3 * k + 7) % len(_BESIDE)])
    for k in range(len(_MOVING))
)
_OUTSIDE = _each((*LAWS, "ripple"))
_SUSPECTS = ("contact.kinetic_friction", "contact.adhesion", "drag.rotational")

_ALONG = Noise(correlated=(0.3, 0.9))

KINDS = {
    "none": Kind(18, "none"),
    "none, t4": Kind(4, "none, hard", noise=Noise(t4=True)),
    "none, set-ups": Kind(4, "none, hard", noise=Noise(setups=True)),
    "none, outlier": Kind(4, "none, hard", noise=Noise(outlier=True)),
    "none, hard": Kind(4, "none, hard", noise=Noise(t4=True, setups=True, outlier=True)),
    "none, correlated": Kind(10, "none, correlated", noise=_ALONG),
    "none, film": Kind(4, "none", tables=FILMED),
    "none, film correlated": Kind(6, "none, correlated", tables=FILMED, noise=_ALONG),
    "none, angles": Kind(3, "none", tables=ANGLE),
    "none, fields": Kind(3, "none", tables=FIELD),
    "none, all tables": Kind(2, "none", tables=TABLES),
    "constant 3 sd": Kind(15, "constant 3 sd", _each(_SUSPECTS)),
    "constant 5 sd": Kind(13, "constant 5 sd", _each(_SUSPECTS)),
    "constant 5 sd, angles": Kind(1, "constant 5 sd", _each(("robot.magnetization",)), None, ANGLE),
    "constant 5 sd, fields": Kind(1, "constant 5 sd", _each(("coil.side",)), None, FIELD),
    "single": Kind(30, "single", _each(_MOVING), (6.0, 20.0)),
    "single, correlated": Kind(15, "single, correlated", _each(_MOVING), (6.0, 20.0), noise=_ALONG),
    "single, film": Kind(5, "single", _each(_FILMED), (6.0, 30.0), FILMED),
    "single, angles": Kind(3, "single", _each(_RESTING), (6.0, 20.0), ANGLE),
    "single, fields": Kind(2, "single", _each(_PROBED), (6.0, 20.0), FIELD),
    "single, all tables": Kind(
        2, "single", _each((*_RESTING, "surface_tilt")), (6.0, 30.0), TABLES),
    "weak": Kind(15, "weak", _each(_MOVING), (3.8, 4.2)),
    "near twins": Kind(
        15, "near twins", _each(("surface_tilt", "friction_anisotropy")), (6.0, 15.0)),
    "exact twins": Kind(15, "exact twins", _each(_TWINS), (6.0, 15.0)),
    "pair": Kind(15, "pair", _PAIRS, (8.0, 16.0)),
    "hiding": Kind(15, "hiding", HIDING, (6.0, 10.0)),
    "unknown": Kind(15, "unknown", (("ripple",),), (15.0, 25.0)),
    "law": Kind(15, "law", _each(tuple(LAWS)), (8.0, 20.0)),
    "law, 24 velocities": Kind(60, "law", _each(tuple(LAWS)), (8.0, 30.0), alike=(0.0, ALIKE)),
    "none, 24 velocities": Kind(100, "none"),
    "instrument": Kind(
        4, "instrument", _each(("velocity_offset", "velocity_clipping", *_TWINS)), (8.0, 20.0)),
    "instrument, angles": Kind(
        4, "instrument", _each(("angle_offset", "angle_scale", "angle_clipping")), (8.0, 20.0),
        ANGLE),
    "instrument, fields": Kind(
        3, "instrument", _each(("probe_turned", "probe_clipping")), (8.0, 20.0), FIELD),
    "instrument, film": Kind(
        4, "instrument", _each(("film_delay", "film_clipping", "marker_place")), (8.0, 30.0),
        FILMED),
    "none, correlated strong": Kind(
        15, "none, correlated strong", noise=Noise(correlated=(0.4, 0.95))),
    "model error, smooth": Kind(
        6, "model error", _disturbed("smooth_error", 0), (8.0, 30.0), error=True),
    "model error, correlated": Kind(
        6, "model error", _disturbed("correlated_error", 7), (8.0, 30.0), error=True),
    "model error, physical": Kind(6, "model error", _DISTURBED, (8.0, 30.0), error=True),
    "unlisted, unlike": Kind(15, "unlisted", _OUTSIDE, (15.0, 40.0), alike=(0.0, ALIKE)),
    "unlisted, alike": Kind(15, "unlisted", _OUTSIDE, (15.0, 40.0), alike=(ALIKE, 1.0)),
    "shuffled": Kind(10, "shuffled", _each(_MOVING), (6.0, 20.0)),
}  # fmt: skip


def plan(first: int, seeds: int, kinds: list[str]) -> Iterator[tuple[str, int]]:
    """Kinds and seeds, at most `seeds` of a kind, mixed: a study cut short has all kinds."""
    counts = {name: min(KINDS[name].count, seeds) for name in kinds}
    entries = [
        ((number + 0.5) / count, order, name, first + number)
        for order, (name, count) in enumerate(counts.items())
        for number in range(count)
    ]
    for _, _, name, seed in sorted(entries):
        yield name, seed
