"""Frames of a motion by a camera: late, blurred, turned, scaled and few.

A rocking at 421 Hz that 200 frames a second alias to 21 Hz is aliased here too: nothing is filtered
out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array
from stickslip.diagnosis.terms.instruments import marker
from stickslip.scenario.changes import Changes
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario

Recording = Mapping[str, Array]

_SAMPLES = 12.0
"""Samples in a period of the fastest free motion. Chosen: see the error in `recording_rate`."""

_SLOWEST, _FASTEST = 5e3, 5e4
"""Limits of the rate, Hz. Chosen: the edges of the currents need the one, memory the other."""

STRONGEST = 6.5e-3
"""Field of a program of voltages, T: the largest of the paper's Table I."""

_BLUR = 5e-4
"""Exposure that one more node makes exact, s. Chosen: 421 Hz turn by a fifth of a period in it."""

_AT_A_TIME = 400_000
"""Samples in memory at a time. Chosen: at 170 bytes each they take 70 MB."""

_RATES = {"x": "vx", "z": "vz", "theta": "omega"}


@dataclass(frozen=True)
class CameraModel:
    """A camera and its synchronisation with the drive.

    A frame shows the mean over the `exposure`, s, with its time in the middle, and is taken by
    `trigger`, s, later than its time says. theta is read as ``angle_scale * theta + angle_offset``,
    1 and rad, up to `angle_limit` on either side, if there is one; `current_scale` is that of both
    currents. The tracked point lies `marker_along` the body towards its front and `marker_across`
    it upwards, m, from the centre of mass; the front is ahead at a `facing` of 1. Lengths are read
    too long by the part `length_scale`, times by `clock_scale`.
    """

    exposure: float = 0.0
    trigger: float = 0.0
    angle_offset: float = 0.0
    angle_scale: float = 1.0
    current_scale: float = 1.0
    length_scale: float = 0.0
    clock_scale: float = 0.0
    angle_limit: float = 0.0
    marker_along: float = 0.0
    marker_across: float = 0.0
    facing: float = 1.0

    def frames(
        self, motion: Recording, times: Array, names: Sequence[str] = ("x", "theta")
    ) -> dict[str, Array]:
        """Noiseless readings at frame `times`, s: x, z (m), theta (rad), currents (A), shape (n,).

        `motion` is a recording on a uniform grid with ``t``, the quantities and their rates. Before
        it the robot rests where it begins, and after it where it ends. A current is read at the
        frame's time, not over its exposure.
        """
        read = times + self.trigger
        nodes, weights = _nodes(self.exposure)
        exposed, sharp = (
            _Grid(motion["t"], times / (1.0 + self.clock_scale))
            for times in (read[:, None] + nodes, read)
        )
        result = {
            name: exposed.cubic(motion[name], motion[_RATES[name]]) @ weights
            if name in _RATES
            else sharp.linear(motion[name]) * self.current_scale
            for name in names
        }
        if self.marker_along != 0.0 or self.marker_across != 0.0:
            theta = exposed.cubic(motion["theta"], motion["omega"])
            ahead, above = marker(theta, self.marker_along, self.marker_across)
            for name, shift in (("x", self.facing * ahead), ("z", above)):
                if name in result:
                    result[name] = result[name] + shift @ weights
        for name in {"x", "z"} & result.keys():
            result[name] = result[name] * (1.0 + self.length_scale)
        if "theta" in result:
            result["theta"] = self.angle_scale * result["theta"] + self.angle_offset
            if self.angle_limit > 0.0:
                result["theta"] = np.clip(result["theta"], -self.angle_limit, self.angle_limit)
        return result


def rocking(scenario: Scenario) -> float:
    """Frequency of the fastest free motion, Hz.

    It is the rocking of a body in flight, sqrt(V M B / J) / 2 pi, some 842 Hz at 2.5 mT.
    """
    drive = scenario.drive
    top = STRONGEST if drive.kind == "program" else math.hypot(drive.peak, drive.hold)
    return scenario.to_core().rocking_rate(top) / (2.0 * math.pi)


def recording_rate(scenario: Scenario) -> float:
    """Sampling rate that resolves every free motion, Hz.

    With cubic interpolation from positions and rates 12 samples a period err by 2e-4 of its
    amplitude, (2 pi / 12)^4 / 384; more samples would only cost time. The rate is a multiple of the
    drive's, and, if there is such a one, has a sample at the end of the ramp, so that the drive's
    sudden edges coincide with samples.
    """
    drive, pace = scenario.drive, scenario.pulse_rate
    enough = float(np.clip(_SAMPLES * rocking(scenario), _SLOWEST, _FASTEST))
    if pace == 0.0:  # a program repeats at no rate
        return enough
    fewest = math.ceil(enough / pace)
    for number in range(fewest, 2 * fewest + 1):
        samples = (drive.latency + drive.ramp) * pace * number
        if abs(samples - round(samples)) < 1e-9 * number:
            return number * pace
    return fewest * pace


def record(
    scenario: Scenario, names: Sequence[str], values: Array, rate: float, threads: int
) -> Iterator[Recording | None]:
    """Recordings at `rate`, Hz, of a scenario with `values`, shape (vectors, names), of some keys.

    In their order, whatever the number of threads; None where the values make no scenario or its
    simulation fails.
    """
    base = scenario.to_core()
    base.set("record.rate", rate)
    driving, clamp = COIL_NAMES.index(base.in_plane_coil), COIL_NAMES.index("clamp")
    share = max(threads, int(_AT_A_TIME / (base.duration * rate + 1.0)))
    for start in range(0, len(values), share):
        cores = [_core_with(base, names, row) for row in values[start : start + share]]
        results = iter(_core.simulate_batch([core for core in cores if core is not None], threads))
        for core in cores:
            result = None if core is None else next(results)
            if result is None or result.status != "ok":
                yield None
                continue
            motion: dict[str, Array] = result.take_recording()
            motion["current_x"] = motion["current"][:, driving]
            motion["current_clamp"] = motion["current"][:, clamp]
            yield motion


def _core_with(base: _core.Scenario, names: Sequence[str], values: Array) -> _core.Scenario | None:
    core = _core.Scenario(base)
    try:
        Changes(dict(zip(names, values.tolist(), strict=True))).apply(core)
        core.check()
    except ValueError:
        return None
    return core


def _nodes(exposure: float) -> tuple[Array, Array]:
    """Times about the middle of an exposure, s, and their weights, more for a longer one."""
    if exposure == 0.0:
        return np.zeros(1), np.ones(1)
    # Three nodes are exact for what is of the fifth order over the exposure.
    nodes, weights = np.polynomial.legendre.leggauss(3 + math.ceil(exposure / _BLUR))
    return 0.5 * exposure * nodes, 0.5 * weights


class _Grid:
    """Interpolation at some times, of any shape, of quantities on a uniform grid."""

    def __init__(self, t: Array, times: Array) -> None:
        self.step = float(t[1] - t[0])
        place = np.clip((times - t[0]) / self.step, 0.0, len(t) - 1.0)
        self.left = np.minimum(place.astype(np.int64), len(t) - 2)
        self.share = place - self.left

    def linear(self, y: Array) -> Array:
        below = y[self.left]
        return np.asarray(below + self.share * (y[self.left + 1] - below))

    def cubic(self, y: Array, slope: Array) -> Array:
        """Hermite's cubic; its slopes are the true ones, so it needs few samples."""
        u, k = self.share, self.left
        rest = 1.0 - u
        ends = y[k] * (1.0 + 2.0 * u) * rest**2 + y[k + 1] * (3.0 - 2.0 * u) * u**2
        bends = slope[k] * u * rest**2 - slope[k + 1] * u**2 * rest
        return np.asarray(ends + self.step * bends)
