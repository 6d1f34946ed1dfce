"""Errors of cameras, markers and probes of a measured walker, as causes.

Each function gives those of one kind of table, with usual sizes; the diagnosis of a measurement
adds them by itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from stickslip._util.arrays import Array, root_mean_square
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import clipping, offset, scale
from stickslip.diagnosis.terms.parameter import Parameter, either_way

# Usual sizes of the errors of measured tables. Chosen as orders of magnitude, like those of the
# simulator's effects.
_ZERO_OF_VELOCITY = 0.02  # of the velocities' root mean square: a stage or a picture that creeps
_SCALE_OF_ANGLES = 0.02
_TURN_OF_PROBE, _LARGEST_TURN = 0.03, 0.5  # rad
_LATE, _MARKER = 1e-3, 2e-5  # s and m: a frame of 1 kHz, a tenth of a body of 200 um
# Where a limit begins to act and its usual distance below, in the largest reading.
_ABOVE_ALL, _SIZE_OF_CLIP = 1.2, 0.12
# Of a camera: microns per pixel, frame rate, and how it is turned against the surface.
_LENGTH = Parameter("length_scale.fraction", low=-0.3, high=0.4, size=0.03)
_CLOCK = Parameter("clock_scale.fraction", low=-0.3, high=0.4, size=0.03)
_TURN = Parameter("angle_offset.angle", unit="rad", low=-0.3, high=0.3, size=0.03)
# Share of a film's angles that count for the largest. Chosen: a few wild frames of a hundred would
# put the limit where it cuts nothing off.
_SOUND = 0.98

_LENGTH_SCALE = Cause("length_scale", (_LENGTH,), "the camera's scale is off")
_CLOCK_SCALE = Cause("clock_scale", (_CLOCK,), "the camera's clock is off")
_ANGLE_OFFSET = Cause("angle_offset", (_TURN,), "the camera is turned against the surface")


def of_velocities(measured: Array) -> tuple[Cause, ...]:
    """A wrong camera, zero or limit of measured velocities, m/s, shape (n,); none where all are 0.

    Lengths and times that are read too long by parts l and c make velocities (1 + l) / (1 + c)
    times what they are.
    """
    if not np.any(measured):
        return ()
    size = _ZERO_OF_VELOCITY * root_mean_square(measured)
    return (
        replace(_LENGTH_SCALE, read=_longer, table="velocity"),
        replace(_CLOCK_SCALE, read=_slower, table="velocity"),
        offset("m/s", size, table="velocity", name="velocity_offset"),
        *_limit("velocity_clipping", "m/s", measured, "velocity"),
    )


def _longer(readings: Array, _: Array, p: dict[str, Array], table: Table) -> Array:
    return readings * (1.0 + p[_LENGTH.name])


def _slower(readings: Array, _: Array, p: dict[str, Array], table: Table) -> Array:
    return readings / (1.0 + p[_CLOCK.name])


def of_angles(theta: Array) -> tuple[Cause, ...]:
    """A turned camera, a wrong scale and a limit of angles, rad, shape (n,)."""
    return (
        replace(_ANGLE_OFFSET, read=_rotated, table="angle"),
        scale(_SCALE_OF_ANGLES, table="angle", name="angle_scale"),
        *_limit("angle_clipping", "rad", theta, "angle"),
    )


def _rotated(readings: Array, _: Array, p: dict[str, Array], table: Table) -> Array:
    return readings + p[_TURN.name]


_ABOUT = [f"probe_turned.about_{axis}" for axis in "xyz"]


def of_fields(fields: Array) -> tuple[Cause, ...]:
    """A turned probe, and its limit; fields in T along x, y and z, shape (n, 3)."""
    angles = tuple(either_way(name, "rad", _TURN_OF_PROBE, _LARGEST_TURN) for name in _ABOUT)
    turned = Cause("probe_turned", angles, "the probe is turned", read=_turned, table="field")
    return turned, *_limit("probe_clipping", "T", fields, "field")


def _turned(readings: Array, _: Array, p: dict[str, Array], table: Table) -> Array:
    # The probe's axes are those of the field after the rotation vector.
    turns = Rotation.from_rotvec(np.hstack([p[name] for name in _ABOUT])).as_matrix()
    seen = np.einsum("vji,vnj->vni", turns, readings.reshape(len(turns), -1, 3))
    return np.asarray(seen.reshape(readings.shape))


def of_films(theta: Array) -> tuple[Cause, ...]:
    """Errors of all films alike; `theta` are angles of one, rad, shape (n,).

    These causes have no `read`: the camera of a film applies them.
    """
    size = np.abs(theta)
    limits = _limit("film_clipping", "rad", size[size <= np.quantile(size, _SOUND)], None)
    late = either_way("film_delay.time", "s", _LATE)
    places = tuple(either_way(f"marker_place.{word}", "m", _MARKER) for word in ("along", "across"))
    return (
        _LENGTH_SCALE,
        _CLOCK_SCALE,
        _ANGLE_OFFSET,
        Cause("film_delay", (late,), "frames are taken later than their times say"),
        *(replace(limit, read=None) for limit in limits),
        Cause("marker_place", places, "the tracked point is not the centre of mass"),
    )


def _limit(name: str, unit: str, readings: Array, table: str | None) -> tuple[Cause, ...]:
    """A limit of readings, any shape, above all of them; none where all are 0."""
    largest = float(np.max(np.abs(readings), initial=0.0))
    if largest == 0.0:
        return ()
    above, size = _ABOVE_ALL * largest, _SIZE_OF_CLIP * largest
    return (clipping(unit, above, size, table=table, name=name),)
