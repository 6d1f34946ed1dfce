"""What the pictures of one motion need, from a Run or from the Dataset that it was saved as."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.scenario.keys import refuse
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


@dataclass(frozen=True, eq=False)
class Motion:
    """A recorded motion; arrays have shape (n,), and are those of a `Run`."""

    t: Array
    x: Array
    z: Array
    theta: Array
    omega: Array
    normal_force: Array
    slip_velocity: Array
    bx: Array
    by: Array
    bz: Array
    contact: NDArray[np.int8]
    length: float  # of the body, m
    height: float
    heading: float  # 1.0 for a robot that faces +x, -1.0 for one that faces -x

    def between(self, start: float | None, stop: float | None) -> Motion:
        """The part from `start` to `stop`, s; it has two samples or more."""
        first = self.t[0] if start is None else start
        last = self.t[-1] if stop is None else stop
        chosen = (self.t >= first) & (self.t <= last)
        if np.count_nonzero(chosen) < 2:
            raise ValueError(f"there are less than two samples from {first:g} s to {last:g} s")
        return replace(self, **{name: getattr(self, name)[chosen] for name in DRAWN})

    def sample(self, time: float) -> int:
        """Index of the sample that is nearest to a time, s."""
        return int(np.abs(self.t - time).argmin())


def motion(data: Data) -> Motion:
    """The motion of a run on a uniform grid, or of what `Run.to_xarray` gave of it."""
    if isinstance(data, Run):
        events = data.scenario.record.rate == "events"
        robot: Any = vars(data.scenario.robot)
        direction = data.scenario.drive.direction
    else:
        if not hasattr(data, "variables"):
            refuse("data", data, "a Run, as simulate(scenario) makes it, or the Dataset of one")
        missing = [name for name in DRAWN if name not in data.variables]
        if missing:
            raise ValueError(f"the Dataset is not one of a run: it has no {', '.join(missing)}")
        events = "event" in data.variables
        scenario = tomllib.loads(data.attrs["scenario"])
        robot, direction = scenario["robot"], scenario["drive"]["direction"]
    if events:
        raise ValueError("a record of events cannot be drawn: set record.rate to a number of Hz")
    return Motion(
        **{name: np.asarray(getattr(data, name)) for name in DRAWN},
        length=robot["length"],
        height=robot["height"],
        heading=1.0 if direction == "+x" else -1.0,
    )


def rectangle(
    length: float, height: float, heading: float, x: Any, z: Any, theta: Any
) -> tuple[Array, Array]:
    """Places of the corners, m, x and z, shape (4, ...) for centres and tilts (...).

    In the order front bottom, rear bottom, rear top, front top, in the robot's own frame; `heading`
    is that of a `Motion`.
    """
    a = 0.5 * length * np.array([1.0, -1.0, -1.0, 1.0])
    b = 0.5 * height * np.array([-1.0, -1.0, 1.0, 1.0])
    cosine, sine = np.cos(theta), np.sin(theta)
    outer = np.multiply.outer
    along = x + heading * (outer(a, cosine) + outer(b, sine))
    return along, z - outer(a, sine) + outer(b, cosine)


def _corners(motion: Motion, x: Any, z: Any, theta: Any) -> tuple[Array, Array]:
    return rectangle(motion.length, motion.height, motion.heading, x, z, theta)


def corners(motion: Motion, index: int) -> Array:
    """The four corners at one sample, m, shape (4, 2) in x and z."""
    return np.column_stack(_corners(motion, motion.x[index], motion.z[index], motion.theta[index]))


def lowest_corner(motion: Motion) -> Array:
    """Position along the surface of the lowest corner, m, shape (n,); in flight too.

    While the body touches, this is `Run.contact_x`, but on a face, where it is one of the face's
    two ends.
    """
    x, z = _corners(motion, motion.x, 0.0, motion.theta)
    return np.asarray(np.take_along_axis(x, z.argmin(axis=0)[np.newaxis], axis=0)[0])
