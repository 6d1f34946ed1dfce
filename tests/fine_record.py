"""A run on a grid fine enough for balances, with a sample just after each event between.

Everything is in the robot's own frame, whose x axis points the way that its moment does when it
lies, so that one set of equations serves both directions.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import lfilter

from free_shapes import LAWS, curve
from stickslip import Coils, Scenario, simulate_batch

# Angle in rad that the fastest free swing goes through between two samples: wanted, and the most
# at which the trapezium rule still says something.
WANTED_PHASE, MOST_PHASE = 0.03, 0.2
MOST_SAMPLES = 100_000

# rad/s, of a body that nothing swings, so that it has some samples.
SLOWEST = 1.0

FLIGHT, CORNER_STICK, FACE_STICK = 0, 1, 4


@dataclass(frozen=True)
class Record:
    """Samples in the order of time, shape (n,) each.

    after_event: the sample is the state just after an event; the phase before it ended at the same
    time. slips: +1 or -1 for a contact that slips to the robot's front or rear, else 0. current:
    shape (n, 5), A, those that make the field, world's frame. unsure: A, by which samples half as
    dense move them. fine: whether the samples are near enough to each other for a balance.
    follows_currents: whether they are for the currents too, which may rise and fall between two of
    them if not. swing: of the fastest free swing, rad/s.
    """

    scenario: Scenario
    after_event: Any
    contact: Any
    slips: Any
    t: Any
    x: Any
    z: Any
    theta: Any
    vx: Any
    vz: Any
    omega: Any
    normal: Any
    friction: Any
    contact_x: Any
    slip: Any
    bx: Any
    bz: Any
    current: Any
    unsure: Any
    sign: float
    fine: bool = False
    follows_currents: bool = False
    swing: float = 0.0

    @classmethod
    def of(cls, run, events=None, **more):
        """Samples of one run, or of a grid and of the same run recorded at its events.

        A sample of the grid at the very time of an event is the state before it.
        """
        runs = [run] if events is None else [run, events]
        sign = 1.0 if run.scenario.drive.direction == "+x" else -1.0
        late = np.repeat([False, True][: len(runs)], [len(each.t) for each in runs])
        order = np.argsort(np.concatenate([each.t for each in runs]), kind="stable")

        def both(name, factor=1.0):
            return factor * np.concatenate([getattr(each, name) for each in runs])[order]

        contact = both("contact").astype(int)
        slips = np.select([np.isin(contact, (2, 5)), np.isin(contact, (3, 6))], [1, -1], 0)
        lag = run.scenario.get("effects.eddy_lag.time")
        if lag == 0.0 or events is None:
            current, unsure = both("current"), 0.0
        else:
            current, coarse = (_lagging(run, both("t"), lag, every) for every in (1, 2))
            unsure = current - coarse
        return cls(
            runs[-1].scenario, late[order], contact, (sign * slips).astype(int), both("t"),
            both("x", sign), both("z"), both("theta"), both("vx", sign), both("vz"), both("omega"),
            both("normal_force"), both("friction_force", sign), both("contact_x", sign),
            both("slip_velocity", sign), both("bx", sign), both("bz"), current, unsure, sign,
            **more,
        )  # fmt: skip

    @property
    def flying(self):
        return self.contact == FLIGHT

    @property
    def on_face(self):
        return np.isin(self.contact, (4, 5, 6))

    @property
    def sticking(self):
        return ~self.flying & (self.slips == 0)

    def effect(self, key):
        return float(self.scenario.get(f"effects.{key}"))

    @property
    def radius(self):
        """Distance from the centre of mass to a corner, m."""
        return 0.5 * float(np.hypot(self.scenario.robot.length, self.scenario.robot.height))

    @property
    def inertia(self):
        """About the centre of mass, kg m^2."""
        robot = self.scenario.robot
        return robot.mass * (robot.length**2 + robot.height**2) / 12.0

    @property
    def moment(self):
        """Magnetic moment, A m^2."""
        robot = self.scenario.robot
        return robot.length * robot.width * robot.height * robot.magnetization

    @property
    def pace(self):
        """Speed of the centre of mass and of the corners about it together, m/s."""
        return np.hypot(self.vx, self.vz) + self.radius * np.abs(self.omega)

    @property
    def fastest(self):
        """The natural speed of a corner, or the largest seen, m/s."""
        return float(max(np.max(self.pace), self.radius * self.swing))

    @property
    def force(self):
        """The natural size of forces: weight, adhesion and what swings a corner, N."""
        s = self.scenario
        weight = s.robot.mass * s.environment.gravity
        return weight + s.contact.adhesion + s.robot.mass * self.fastest**2 / self.radius

    def shape(self, name, argument):
        """Factor of a free shape."""
        if name in LAWS:
            law = self.scenario.laws.get(name)
            knots, span = (law.knots, law.scale) if law else ((0.0,), None)
        else:
            knots = [self.effect(f"{name}.knot_{i}") for i in range(1, 6)]
            span = self.effect(f"{name}.span")
        if not any(knots):
            return 1.0
        return np.maximum(0.0, 1.0 + curve(name, knots, argument, span))

    @property
    def tilt(self):
        """Theta within half a turn, rad."""
        return np.arctan2(np.sin(self.theta), np.cos(self.theta))

    @property
    def adhesion(self):
        """Adhesion of the contact, N; its age is the time since the last touch-down."""
        lands = np.append(False, self.flying[:-1]) & ~self.flying
        begun = np.where(lands, self.t, -self.scenario.initial.contact_age)
        age = self.t - np.maximum.accumulate(begun)
        strength = self.scenario.contact.adhesion
        strength *= 1.0 - self.effect("angle_adhesion.strength") * np.sin(self.theta) ** 2
        ageing = np.log1p(age / self.effect("adhesion_ageing.time"))
        strength *= 1.0 + self.effect("adhesion_ageing.rate") * ageing
        strength *= self.shape("free_adhesion_angle", self.tilt)
        return np.where(self.flying, 0.0, strength * self.shape("free_adhesion_age", age))

    def sources(self, current):
        """Currents that would make the field without gains and shapes, A, shape (n, 5)."""
        in_plane = 1.0 + self.effect("field_gain.in_plane")
        gains = np.array([in_plane] * 4 + [1.0 + self.effect("field_gain.clamp")])
        size = np.sqrt(np.sum(self.current[:, :4] ** 2, axis=1))
        factor = self.shape("free_field_time", self.t) * self.shape("free_field_amplitude", size)
        if self.scenario.drive.mode != "program":
            factor *= self.shape("free_field_frequency", self.scenario.drive.frequency)
        return current * gains * np.reshape(factor, (-1, 1))

    @property
    def moments(self):
        """Along x and z, A m^2."""
        angle = self.theta + self.effect("misalignment.angle")
        return self.moment * np.cos(angle), -self.moment * np.sin(angle)

    @property
    def magnetic_load(self):
        """Force along x and z (N), torque about +y (N m) on the moment, Eqs. (8)-(9)."""
        mx, mz = self.moments
        return *self.magnetic_force(self.current), mz * self.bx - mx * self.bz

    def magnetic_force(self, current):
        """Along x and z, N, for currents in A."""
        points = np.column_stack([self.sign * self.x, np.zeros_like(self.x), self.z])
        slope = Coils.of(self.scenario).gradient(points, self.sources(current))
        mx, mz = self.moments
        # Turning the frame about z by 180 degrees turns x and B_x: only dB_x/dz changes its sign.
        xx, xz, zz = slope[:, 0, 0], self.sign * slope[:, 0, 2], slope[:, 2, 2]
        scale = 1.0 + self.effect("gradient_scale.fraction")
        return scale * (mx * xx + mz * xz), scale * (mx * xz + mz * zz)


def recorded(scenarios, rtol):
    """Records at a tolerance of at most `rtol`; None of a run that never began."""
    scenarios = [s.replace({"solver.rtol": min(rtol, s.solver.rtol)}) for s in scenarios]
    at_events = [s.replace({"record.rate": "events"}) for s in scenarios]
    events = simulate_batch(at_events, threads=1)
    begun = [run for run in events if run.summary()["simulated_time"] > 0.0]
    rates = {id(run): _rates(run) for run in begun}
    grids = simulate_batch(
        [run.scenario.replace({"record.rate": rates[id(run)][0]}) for run in begun], threads=1
    )
    records = {}
    for run, grid in zip(begun, grids, strict=True):
        rate, swing, fastest, of_currents = rates[id(run)]
        more = {"fine": fastest <= MOST_PHASE * rate, "swing": swing}
        records[id(run)] = Record.of(
            grid, run, follows_currents=of_currents <= MOST_PHASE * rate, **more
        )
    return [records.get(id(run)) for run in events]


def _rates(run):
    """Samples a second that a balance wants; swing, swing and drag together, currents, 1/s."""
    s = run.scenario
    robot, radius = s.robot, 0.5 * np.hypot(s.robot.length, s.robot.height)
    inertia = robot.mass * (robot.length**2 + robot.height**2) / 12.0
    moment = robot.length * robot.width * robot.height * robot.magnetization
    turning = float(np.max(np.abs(run.omega), initial=0.0))
    field = np.max(np.hypot(run.bx, run.bz), initial=0.0)
    weight = robot.mass * s.environment.gravity + s.contact.adhesion
    free = np.sqrt((moment * field + weight * radius) / (inertia + robot.mass * radius**2))
    swing = float(max(free, turning, SLOWEST))
    linear = s.drag.linear * (1.0 + abs(s.get("effects.angle_drag.strength")))
    rotational = s.get("effects.rotational_drag.coefficient") + s.drag.rotational * turning
    fastest = swing + linear / robot.mass + rotational / inertia
    # Over a span that the motion crosses in less time, a shape changes faster than the motion.
    crossed = {"angle": turning, "rate": swing * turning, "speed": radius * swing**2}
    for name in LAWS:
        of = name.rpartition("_")[2]
        if of in crossed and name in s.laws:
            fastest += crossed[of] / s.laws[name].scale
    # The currents' own rate is followed where there are samples enough: a faster change is a jump.
    of_currents = s.coil.resistance / s.coil.inductance
    wanted = (fastest + of_currents) / WANTED_PHASE
    return min(wanted, MOST_SAMPLES / s.duration), swing, fastest, of_currents


def _lagging(grid, t, lag, every):
    """Currents behind a first-order lag, exact for currents that are straight between samples.

    every: so many steps of the grid are one.
    """
    ratio = every / (float(grid.scenario.record.rate) * lag)
    decay = np.exp(-ratio)
    mean = -np.expm1(-ratio) / ratio
    filtered = lfilter([1.0 - mean, mean - decay], [1.0, -decay], grid.current[::every], axis=0)
    return np.column_stack([np.interp(t, grid.t[::every], column) for column in filtered.T])
