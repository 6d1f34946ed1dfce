"""What is uncertain of the camera and the ammeter of a film, and what may be wrong with them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.model.problem import Cause, CauseParameter, Uncertain
from stickslip.diagnosis.observables.reading_errors import clipping
from stickslip.diagnosis.observables.tracking.camera import Camera
from stickslip.measurement.tracking import TrackingRun
from stickslip.scenario.priors import Prior

_ANGLE_OFFSET = math.radians(1.0)
_ANGLE_SCALE = _CURRENT_SCALE = 0.01
"""One standard deviation of a camera's angles, rad and 1, and of a current's scale. Chosen: what a
camera that was set up by eye and an ammeter of class 1 have."""

_TRIGGER = 3e-4
"""The same of the time at which frames begin, s. Chosen: a third of a frame of 1 kHz."""

_LATE, _MARKER = 1e-3, 2e-5
"""Delay, s, and distance of a marker, m, that would not surprise where a camera is set up wrongly.
Chosen: a frame of 1 kHz, and a tenth of a robot; thirty times as much is searched."""

# Share of the frames whose angles are not larger than what counts as the largest. Chosen: a few
# wild frames of a hundred would put the limit where nothing is cut off.
_SOUND = 0.98

_DELAY, _LIMIT = "film_delay.time", "film_clipping.limit"
_ALONG, _ACROSS = "marker_place.along", "marker_place.across"


def camera_nuisance(name: str, run: TrackingRun) -> tuple[Uncertain, ...]:
    """What is uncertain of one film, whose name is `name`, and of no other."""
    # A frame's time may mark the middle of the exposure or its beginning, so a long exposure makes
    # the trigger less certain.
    trigger = math.hypot(_TRIGGER, 0.25 * run.exposure)
    priors = [
        ("angle_offset", 0.0, _ANGLE_OFFSET, "rad"),
        ("angle_scale", 1.0, _ANGLE_SCALE, "-"),
        ("trigger", 0.0, trigger, "s"),
    ]
    if any(name.startswith("current") for name in run.columns):
        priors.append(("current_scale", 1.0, _CURRENT_SCALE, "-"))
    return tuple(
        Uncertain(f"{name}.{parameter}", Prior("normal", mean, sd), unit, False)
        for parameter, mean, sd, unit in priors
    )


def camera_suspects(theta: Array) -> tuple[Cause, ...]:
    """What may be wrong with all films alike; `theta` are angles of one, rad, shape (n,)."""
    size = np.abs(theta)
    limits = clipping("film_clipping", "rad", size[size <= np.quantile(size, _SOUND)])
    late = CauseParameter(_DELAY, "s", -30.0 * _LATE, 30.0 * _LATE, _LATE)
    places = tuple(
        CauseParameter(name, "m", -30.0 * _MARKER, 30.0 * _MARKER, _MARKER)
        for name in (_ALONG, _ACROSS)
    )
    return (
        Cause("film_delay", (late,), "frames are taken later than their times say"),
        # The camera itself cuts its angles off.
        *(Cause(each.name, each.parameters, each.meaning) for each in limits),
        Cause("marker_place", places, "the tracked point is not the centre of mass"),
    )


def camera_at(run: TrackingRun, name: str, values: Mapping[str, float]) -> Camera:
    """The camera of a film at values by the names of `camera_nuisance` and `camera_suspects`."""
    own = {
        each.removeprefix(f"{name}."): value
        for each, value in values.items()
        if each.startswith(f"{name}.")
    }
    own["trigger"] = own.get("trigger", 0.0) + values.get(_DELAY, 0.0)
    return Camera(
        run.exposure,
        **own,
        angle_limit=values.get(_LIMIT, 0.0),
        marker_along=values.get(_ALONG, 0.0),
        marker_across=values.get(_ACROSS, 0.0),
        facing=run.scenario.drive.facing,
    )
