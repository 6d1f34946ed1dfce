"""The motion of a run, for pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip._util.arrays import Array
from stickslip._util.messages import refuse
from stickslip._util.text import is_number
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.quantities import recorded_names
from stickslip.simulation.run import Run

_DRAWN = (
    *("t", "x", "z", "theta", "omega", "normal_force", "slip_velocity"),
    *("bx", "by", "bz", "contact"),
)
_DRAWN_ACROSS = ("y", "heading", "slip_across")


@dataclass(frozen=True, eq=False)
class Motion:
    """A recorded motion; arrays have shape (n,), and are those of the run where it has them.

    The side view is the one from the robot's right: its horizontal axis is the way along the
    heading, which of a robot that faces +x is x, and the front is at the right.
    """

    scenario: Scenario
    t: Array
    x: Array
    y: Array
    z: Array
    theta: Array
    heading: Array  # rad from +x to the left; without the jumps from pi to -pi
    omega: Array
    normal_force: Array
    slip_velocity: Array  # along the heading
    slip_across: Array  # to its left; 0 of a robot that stays in its plane
    bx: Array
    by: Array
    bz: Array
    contact: NDArray[np.int8]
    way: Array  # of the centre of mass along the heading, m

    def between(self, start: float | None, stop: float | None) -> Motion:
        """The part from `start` to `stop`, s; it has two samples or more."""
        check_times(start=start, stop=stop)
        first = self.t[0] if start is None else start
        last = self.t[-1] if stop is None else stop
        chosen = np.flatnonzero((self.t >= first) & (self.t <= last))
        if len(chosen) < 2:
            raise ValueError(f"there are less than two samples from {first:g} s to {last:g} s")
        return self.samples(int(chosen[0]), int(chosen[-1]))

    def samples(self, first: int, last: int) -> Motion:
        """The part from one sample to another."""
        chosen = slice(first, last + 1)
        arrays = {name: array[chosen] for name, array in vars(self).items() if name != "scenario"}
        return replace(self, **arrays)

    def sample(self, time: float) -> int:
        """Index of the sample that is nearest to a time, s."""
        return int(np.abs(self.t - time).argmin())


def check_times(**given: object) -> None:
    """Refuse what is neither a number of seconds nor None."""
    for name, time in given.items():
        if time is not None and not is_number(time):
            refuse(name, time, "a time, s")


def check_drawable(scenario: Scenario) -> None:
    """Refuse a scenario whose record lacks a quantity that pictures of the motion draw."""
    record = scenario.record
    if record.rate == "events":
        refuse("record.rate", "events", "a number of Hz, as a picture needs a uniform grid")
    drawn = (*_DRAWN, *_DRAWN_ACROSS) if scenario.whole_plane else _DRAWN
    if missing := [name for name in drawn if name not in recorded_names(scenario)]:
        refuse("record.fields", record.fields, f"a record of {', '.join(missing)} too, to draw it")


def motion(run: Run) -> Motion:
    """The motion of a run with a record on a uniform grid."""
    if not isinstance(run, Run):
        refuse("run", run, "a Run, as simulate(scenario) and open_run(path) give it")
    if run.scenario.record.rate == "events":
        raise ValueError("a record of events cannot be drawn: set record.rate to a number of Hz")
    arrays = {name: getattr(run, name) for name in (*_DRAWN, "y", "heading")}
    arrays["heading"] = heading = np.unwrap(arrays["heading"])
    across = run.slip_across if run.scenario.whole_plane else np.zeros_like(heading)
    way = _way(arrays["x"], arrays["y"], heading)
    return Motion(run.scenario, **arrays, slip_across=across, way=way)


def _way(x: Array, y: Array, heading: Array) -> Array:
    """Distance along the heading, m; it begins with the place along the first heading."""
    middle = np.concatenate([heading[:1], 0.5 * (heading[1:] + heading[:-1])])
    # Doubles, also of a record in single precision, whose rounding would else add up.
    dx, dy = (np.diff(values.astype(np.float64), prepend=0.0) for values in (x, y))
    return np.cumsum(dx * np.cos(middle) + dy * np.sin(middle))


def corners(motion: Motion, at: int | slice = slice(None)) -> Array:
    """Corners in the side view at one sample or more, m, shape (..., 4, 2): way and height.

    In the order front bottom, rear bottom, rear top, front top, in the robot's own frame.
    """
    robot = motion.scenario.robot
    a = 0.5 * robot.length * np.array([1.0, -1.0, -1.0, 1.0])
    b = 0.5 * robot.height * np.array([-1.0, -1.0, 1.0, 1.0])
    way, z, theta = (values[at, None] for values in (motion.way, motion.z, motion.theta))
    cosine, sine = np.cos(theta), np.sin(theta)
    return np.stack([way + a * cosine + b * sine, z - a * sine + b * cosine], axis=-1)


def footprint(motion: Motion, index: int) -> Array:
    """The outline as seen from above at one sample, m, shape (4, 2) in x and y.

    In the order front right, rear right, rear left, front left. A pitched body is seen with its
    upper or lower face beside its front or back.
    """
    robot, theta, heading = motion.scenario.robot, motion.theta[index], motion.heading[index]
    seen = robot.length * abs(np.cos(theta)) + robot.height * abs(np.sin(theta))
    a = 0.5 * seen * np.array([1.0, -1.0, -1.0, 1.0])
    b = 0.5 * robot.width * np.array([-1.0, -1.0, 1.0, 1.0])
    cosine, sine = np.cos(heading), np.sin(heading)
    x, y = motion.x[index], motion.y[index]
    return np.column_stack([x + a * cosine - b * sine, y + a * sine + b * cosine])


def lowest_corner(motion: Motion) -> Array:
    """Place of the lowest corner in the side view, m, shape (n,); in flight too."""
    way, z = np.moveaxis(corners(motion), -1, 0)
    return np.asarray(np.take_along_axis(way, z.argmin(axis=-1)[:, None], axis=-1)[:, 0])
