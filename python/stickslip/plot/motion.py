"""What the pictures of one motion need, from a Run or from the Dataset that it was saved as."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.scenario.keys import refuse
from stickslip.simulation.columns import PLANE_COLUMNS
from stickslip.simulation.run import Run

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    import xarray

Data: TypeAlias = "Run | xarray.Dataset"
Array = NDArray[np.float64]

DRAWN = (
    *("t", "x", "z", "theta", "omega", "normal_force", "slip_velocity"),
    *("bx", "by", "bz", "contact"),
)
"""Quantities that the pictures of one motion need."""

DRAWN_ACROSS = ("y", "heading", "slip_across")
"""Those that they need too where the robot leaves its plane."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A recorded motion; arrays have shape (n,), and are those of a `Run` where it has them.

    A robot that stays in its plane has y and `slip_across` of 0, and a heading of 0 or pi.
    """

    t: Array
    x: Array
    y: Array
    z: Array
    theta: Array
    heading: Array  # rad from +x to the left; without the jumps from pi to -pi
    omega: Array
    normal_force: Array
    slip_velocity: Array
    slip_across: Array
    bx: Array
    by: Array
    bz: Array
    contact: NDArray[np.int8]
    way: Array  # of the centre of mass along the heading since the record began, m
    length: float  # of the body, m
    width: float
    height: float
    facing: float  # where the front is in the side view: 1.0 at the right, -1.0 at the left
    turns: bool  # whether the robot leaves its plane
    drive: Mapping[str, Any]  # the keys of the scenario's [drive]

    @property
    def along(self) -> Array:
        """Position in the side view, m: x, or of a robot that leaves its plane the way."""
        return self.way if self.turns else self.x

    @property
    def along_name(self) -> str:
        """What `along` is called beside an axis."""
        return "way along the heading" if self.turns else "x"

    def between(self, start: float | None, stop: float | None) -> Motion:
        """The part from `start` to `stop`, s; it has two samples or more."""
        first = self.t[0] if start is None else start
        last = self.t[-1] if stop is None else stop
        chosen = np.flatnonzero((self.t >= first) & (self.t <= last))
        if len(chosen) < 2:
            raise ValueError(f"there are less than two samples from {first:g} s to {last:g} s")
        return self.samples(int(chosen[0]), int(chosen[-1]))

    def samples(self, first: int, last: int) -> Motion:
        """The part from one sample to another."""
        names = (*DRAWN, *DRAWN_ACROSS, "way")
        chosen = slice(first, last + 1)
        return replace(self, **{name: getattr(self, name)[chosen] for name in names})

    def sample(self, time: float) -> int:
        """Index of the sample that is nearest to a time, s."""
        return int(np.abs(self.t - time).argmin())


def motion(data: Data) -> Motion:
    """The motion of a run on a uniform grid, or of what `Run.to_xarray` gave of it."""
    if isinstance(data, Run):
        events = data.scenario.record.rate == "events"
        robot: Any = vars(data.scenario.robot)
        drive: Any = vars(data.scenario.drive)
        heading = data.final_state.heading
        leaves = data.scenario.turns
    else:
        if not hasattr(data, "variables"):
            refuse("data", data, "a Run, as simulate(scenario) makes it, or the Dataset of one")
        leaves = any(name in data.variables for name in PLANE_COLUMNS) or _ends_aside(data)
        needed = (*DRAWN, *DRAWN_ACROSS) if leaves else DRAWN
        missing = [name for name in needed if name not in data.variables]
        if missing:
            raise ValueError(f"the Dataset is not one of a run: it has no {', '.join(missing)}")
        events = "event" in data.variables
        scenario = tomllib.loads(data.attrs["scenario"])
        robot, drive = scenario["robot"], scenario["drive"]
        heading = json.loads(data.attrs["final_state"])["heading"]
    if events:
        raise ValueError("a record of events cannot be drawn: set record.rate to a number of Hz")
    arrays = {name: np.asarray(getattr(data, name)) for name in DRAWN}
    facing = -1.0 if math.cos(heading) < 0.0 and not leaves else 1.0
    if leaves:
        arrays |= {name: np.asarray(getattr(data, name)) for name in DRAWN_ACROSS}
        arrays["heading"] = np.unwrap(arrays["heading"])
    else:
        still = np.zeros(len(arrays["t"]))
        arrays |= {"y": still, "heading": np.full_like(still, heading), "slip_across": still}
    return Motion(
        **arrays,
        way=_way(arrays["x"], arrays["y"], arrays["heading"]),
        length=robot["length"],
        width=robot["width"],
        height=robot["height"],
        facing=facing,
        turns=leaves,
        drive=drive,
    )


def _ends_aside(data: xarray.Dataset) -> bool:
    """Whether a run left its plane, also one of which nothing across was recorded."""
    return bool(json.loads(data.attrs["final_state"])["y"] != 0.0)


def _way(x: Array, y: Array, heading: Array) -> Array:
    """What has been gone along the heading since the first sample, m."""
    middle = 0.5 * (heading[1:] + heading[:-1])
    # Doubles, also of a record in single precision, whose rounding would else add up.
    dx, dy = np.diff(x.astype(np.float64)), np.diff(y.astype(np.float64))
    steps = dx * np.cos(middle) + dy * np.sin(middle)
    return np.concatenate([[0.0], np.cumsum(steps)])


def rectangle(
    length: float, height: float, facing: float, x: Any, z: Any, theta: Any
) -> tuple[Array, Array]:
    """Places of the corners in the side view, m, x and z, shape (4, ...) for centres and tilts.

    In the order front bottom, rear bottom, rear top, front top, in the robot's own frame; `facing`
    is that of a `Motion`.
    """
    a = 0.5 * length * np.array([1.0, -1.0, -1.0, 1.0])
    b = 0.5 * height * np.array([-1.0, -1.0, 1.0, 1.0])
    cosine, sine = np.cos(theta), np.sin(theta)
    outer = np.multiply.outer
    along = x + facing * (outer(a, cosine) + outer(b, sine))
    return along, z - outer(a, sine) + outer(b, cosine)


def _corners(motion: Motion, along: Any, z: Any, theta: Any) -> tuple[Array, Array]:
    return rectangle(motion.length, motion.height, motion.facing, along, z, theta)


def corners(motion: Motion, index: int) -> Array:
    """The four corners of the side view at one sample, m, shape (4, 2), `along` and z."""
    at = motion.along[index], motion.z[index], motion.theta[index]
    return np.column_stack(_corners(motion, *at))


def footprint(motion: Motion, index: int) -> Array:
    """The outline as seen from above at one sample, m, shape (4, 2) in x and y.

    In the order front right, rear right, rear left, front left. A tilted body is seen with its
    upper or lower face beside its front or back.
    """
    theta, heading = motion.theta[index], motion.heading[index]
    seen = motion.length * abs(np.cos(theta)) + motion.height * abs(np.sin(theta))
    a = 0.5 * seen * np.array([1.0, -1.0, -1.0, 1.0])
    b = 0.5 * motion.width * np.array([-1.0, -1.0, 1.0, 1.0])
    cosine, sine = np.cos(heading), np.sin(heading)
    x, y = motion.x[index], motion.y[index]
    return np.column_stack([x + a * cosine - b * sine, y + a * sine + b * cosine])


def lowest_corner(motion: Motion) -> Array:
    """Position in the side view of the lowest corner, m, shape (n,); in flight too.

    While the body touches, this is `Run.contact_x` of a robot in its plane, but on a face, where
    it is one of the face's two ends.
    """
    along, z = _corners(motion, motion.along, 0.0, motion.theta)
    return np.asarray(np.take_along_axis(along, z.argmin(axis=0)[np.newaxis], axis=0)[0])
