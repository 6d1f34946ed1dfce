"""What the pictures of one motion need, from a Run or from the Dataset that it was saved as."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.simulation.run import Run

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    import xarray

    Data: TypeAlias = Run | xarray.Dataset

Array = NDArray[np.float64]

_DRAWN = ("t", "x", "z", "theta", "omega", "normal_force", "contact_x", "slip_velocity", "bx", "bz")


@dataclass(frozen=True)
class Motion:
    """A recorded motion. Arrays have shape (n,), in SI units and radians.

    Attributes
    ----------
    t, x, z, theta, omega, normal_force, contact_x, slip_velocity, bx, bz : numpy.ndarray
        As in `Run`.
    contact : numpy.ndarray of int8
        Index of `Run.contact_names`.
    length, height : float
        Of the body, m.
    heading : float
        1.0 for a robot that faces +x, -1.0 for one that faces -x.
    """

    t: Array
    x: Array
    z: Array
    theta: Array
    omega: Array
    normal_force: Array
    contact_x: Array
    slip_velocity: Array
    bx: Array
    bz: Array
    contact: NDArray[np.int8]
    length: float
    height: float
    heading: float

    def between(self, start: float | None, stop: float | None) -> Motion:
        """The part from `start` to `stop`, s.

        Raises
        ------
        ValueError
            If there are less than two samples.
        """
        first = self.t[0] if start is None else start
        last = self.t[-1] if stop is None else stop
        chosen = (self.t >= first) & (self.t <= last)
        if np.count_nonzero(chosen) < 2:
            raise ValueError(f"there are less than two samples from {first:g} s to {last:g} s")
        arrays = {name: getattr(self, name)[chosen] for name in (*_DRAWN, "contact")}
        return Motion(**arrays, length=self.length, height=self.height, heading=self.heading)

    def sample(self, time: float) -> int:
        """Index of the sample that is nearest to a time, s."""
        return int(np.abs(self.t - time).argmin())


def motion(data: Data) -> Motion:
    """The motion of a run on a uniform grid.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run, or what `Run.to_xarray` gave.

    Raises
    ------
    AttributeError
        If a run has no record.
    ValueError
        If the record is one of events, or a Dataset lacks a variable of a run.
    """
    if isinstance(data, Run):
        if data.scenario.record.rate == "events":
            raise ValueError(
                "a record of events cannot be drawn: set record.rate to a number of Hz"
            )
        robot, direction = data.scenario.robot, data.scenario.drive.direction
        arrays = {name: getattr(data, name) for name in (*_DRAWN, "contact")}
        return Motion(
            **arrays, length=robot.length, height=robot.height, heading=_heading(direction)
        )
    return _of_dataset(data)


def _of_dataset(data: xarray.Dataset) -> Motion:
    missing = [name for name in (*_DRAWN, "contact") if name not in data.variables]
    if missing:
        raise ValueError(f"a Dataset without {', '.join(missing)} is none of a run")
    if "event" in data.variables:
        raise ValueError("a record of events cannot be drawn: set record.rate to a number of Hz")
    scenario: dict[str, Any] = tomllib.loads(data.attrs["scenario"])
    arrays = {name: np.asarray(data[name].values) for name in (*_DRAWN, "contact")}
    return Motion(
        **arrays,
        length=scenario["robot"]["length"],
        height=scenario["robot"]["height"],
        heading=_heading(scenario["drive"]["direction"]),
    )


def _heading(direction: str) -> float:
    return 1.0 if direction == "+x" else -1.0


def corners(motion: Motion, index: int) -> Array:
    """The four corners at one sample, m, shape (4, 2) in x and z.

    In the order front bottom, rear bottom, rear top, front top, in the robot's own frame.
    """
    a = 0.5 * motion.length * np.array([1.0, -1.0, -1.0, 1.0])
    b = 0.5 * motion.height * np.array([-1.0, -1.0, 1.0, 1.0])
    cosine, sine = np.cos(motion.theta[index]), np.sin(motion.theta[index])
    x = motion.x[index] + motion.heading * (a * cosine + b * sine)
    z = motion.z[index] - a * sine + b * cosine
    return np.column_stack([x, z])


def lowest_corner(motion: Motion) -> Array:
    """Position along the surface of the lowest corner, m, shape (n,); in flight too.

    Corners are numbered as in `corners`. While the body touches, this is `contact_x`, but on a
    face, where it is one of the face's two ends.
    """
    a = 0.5 * motion.length * np.array([[1.0], [-1.0], [-1.0], [1.0]])
    b = 0.5 * motion.height * np.array([[-1.0], [-1.0], [1.0], [1.0]])
    cosine, sine = np.cos(motion.theta), np.sin(motion.theta)
    z = -a * sine + b * cosine
    x = motion.x + motion.heading * (a * cosine + b * sine)
    return np.asarray(np.take_along_axis(x, z.argmin(axis=0)[np.newaxis], axis=0)[0])
