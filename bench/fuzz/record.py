"""A run on a grid fine enough for balances, with a sample just after each event between.

Everything is in the robot's own frame, whose x axis points the way that its moment does when it
lies, so that one set of equations serves both directions.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from stickslip import Coils, Run, Scenario, simulate_batch

Array = NDArray[np.float64]

# Angle in rad that the fastest free swing goes through between two samples: wanted, and the most
# at which the trapezium rule still says something.
_WANTED_PHASE, _MOST_PHASE = 0.03, 0.2
_MOST_SAMPLES = 100_000

# rad/s, of a body that nothing swings, so that it has some samples.
_SLOWEST = 1.0

FLIGHT, CORNER_STICK, FACE_STICK = 0, 1, 4
FACES = (4, 5, 6)


@dataclass(frozen=True)
class Record:
    """Samples in the order of time; shape (n,) each.

    Attributes
    ----------
    after_event : bool array
        The sample is the state just after an event; the phase before it ended at the same time.
    slips : int array
        +1 or -1 for a contact that slips to the robot's front or rear, else 0.
    fine : bool
        Whether the samples are near enough to each other for a balance.
    follows_currents : bool
        Whether they are for the currents too, which may rise and fall between two of them if not.
    swing : float
        Angular frequency of the fastest free swing, rad/s.
    """

    scenario: Scenario
    after_event: NDArray[np.bool_]
    contact: NDArray[np.int64]
    slips: NDArray[np.int64]
    t: Array
    x: Array
    z: Array
    theta: Array
    vx: Array
    vz: Array
    omega: Array
    normal: Array
    friction: Array
    contact_x: Array
    slip: Array
    bx: Array
    bz: Array
    current: Array  # shape (n, 5), A, those that make the field, world's frame
    sign: float
    fine: bool
    follows_currents: bool
    swing: float

    @property
    def flying(self) -> NDArray[np.bool_]:
        return self.contact == FLIGHT

    @property
    def on_face(self) -> NDArray[np.bool_]:
        return np.isin(self.contact, FACES)

    @property
    def touching(self) -> NDArray[np.bool_]:
        return ~self.flying

    @property
    def sticking(self) -> NDArray[np.bool_]:
        return self.touching & (self.slips == 0)

    def effect(self, key: str) -> float:
        return float(self.scenario.get(f"effects.{key}"))

    @property
    def radius(self) -> float:
        """From the centre of mass to a corner, m."""
        return 0.5 * float(np.hypot(self.scenario.robot.length, self.scenario.robot.height))

    @property
    def inertia(self) -> float:
        """About the centre of mass, kg m^2."""
        robot = self.scenario.robot
        return robot.mass * (robot.length**2 + robot.height**2) / 12.0

    @property
    def moment(self) -> float:
        """A m^2."""
        robot = self.scenario.robot
        volume = robot.length * robot.width * robot.height
        return volume * robot.magnetization

    @property
    def pace(self) -> Array:
        """Speed of the centre of mass and of the corners about it together, m/s."""
        return np.hypot(self.vx, self.vz) + self.radius * np.abs(self.omega)

    @property
    def fastest(self) -> float:
        """The natural speed of a corner, or the largest seen, m/s."""
        return float(max(np.max(self.pace), self.radius * self.swing))

    @property
    def force(self) -> float:
        """The natural size of forces: weight, adhesion and what swings a corner, N."""
        s = self.scenario
        weight = s.robot.mass * s.environment.gravity
        inertial = s.robot.mass * self.fastest**2 / self.radius
        return weight + s.contact.adhesion + inertial


def at_events(record: Record) -> Record:
    """Two samples for each event, and the fastest of all."""
    after = np.flatnonzero(record.after_event)
    wanted = np.unique(np.concatenate([after[after > 0] - 1, after, [np.argmax(record.pace)]]))
    arrays = {f.name: getattr(record, f.name) for f in fields(record)}
    kept = {name: a[wanted] for name, a in arrays.items() if isinstance(a, np.ndarray)}
    return replace(record, **kept)


def natural_swing(scenario: Scenario, run: Run) -> float:
    """rad/s, in the strongest field at an event, under weight and adhesion."""
    robot = scenario.robot
    radius = 0.5 * np.hypot(robot.length, robot.height)
    inertia = robot.mass * (robot.length**2 + robot.height**2) / 12.0 + robot.mass * radius**2
    moment = robot.length * robot.width * robot.height * robot.magnetization
    field = np.max(np.hypot(run.bx, run.bz), initial=0.0)
    weight = robot.mass * scenario.environment.gravity + scenario.contact.adhesion
    return float(np.sqrt((moment * field + weight * radius) / inertia))


def damping(scenario: Scenario, turning: float) -> float:
    """Rate at which drag takes velocity, 1/s, while the body turns with `turning` rad/s."""
    robot = scenario.robot
    inertia = robot.mass * (robot.length**2 + robot.height**2) / 12.0
    linear = scenario.drag.linear * (1.0 + abs(scenario.get("effects.angle_drag.strength")))
    rotational = float(scenario.get("effects.rotational_drag.coefficient"))
    rotational += scenario.drag.rotational * turning
    return linear / robot.mass + rotational / inertia


def recorded(scenario: Scenario, rtol: float | None = None) -> tuple[Record | None, Run]:
    """The record of a scenario, and its run at events; no record of one that never began."""
    return recorded_together([scenario], rtol)[0]


def recorded_together(
    scenarios: list[Scenario], rtol: float | None = None
) -> list[tuple[Record | None, Run]]:
    """What `recorded` gives of each; `rtol` is a limit on its own tolerance."""
    if rtol is not None:
        scenarios = [s.replace({"solver.rtol": min(rtol, s.solver.rtol)}) for s in scenarios]
    at_events = [scenario.replace({"record.rate": "events"}) for scenario in scenarios]
    events = simulate_batch(at_events, threads=1)
    begun = [run for run in events if run.summary()["simulated_time"] > 0.0]
    rates = [_rate(run) for run in begun]
    on_grid = [
        run.scenario.replace({"record.rate": rate})
        for run, (rate, _) in zip(begun, rates, strict=True)
    ]
    grids = simulate_batch(on_grid, threads=1)
    records = {
        id(run): _merged(grid, run, swing)
        for run, grid, (_, swing) in zip(begun, grids, rates, strict=True)
    }
    return [(records.get(id(run)), run) for run in events]


def _rate(run: Run) -> tuple[float, float]:
    """Samples a second that a balance wants, and the fastest free swing, rad/s."""
    scenario = run.scenario
    turning = float(np.max(np.abs(run.omega), initial=0.0))
    swing = float(max(natural_swing(scenario, run), turning, _SLOWEST))
    # The currents' own rate is followed where there are samples enough: a faster change is a jump.
    wanted = _fastest(swing, run) + scenario.coil.resistance / scenario.coil.inductance
    return min(wanted / _WANTED_PHASE, _MOST_SAMPLES / scenario.duration), swing


def _fastest(swing: float, run: Run) -> float:
    """Of swing and drag together, 1/s."""
    return swing + damping(run.scenario, float(np.max(np.abs(run.omega), initial=0.0)))


def _merged(grid: Run, events: Run, swing: float) -> Record:
    """A sample of the grid at the very time of an event is the state before it."""
    scenario = events.scenario
    most = _MOST_PHASE * float(grid.scenario.record.rate)
    fine = _fastest(swing, events) <= most
    follows_currents = scenario.coil.resistance / scenario.coil.inductance <= most
    sign = 1.0 if scenario.drive.direction == "+x" else -1.0
    order = np.argsort(np.concatenate([grid.t, events.t]), kind="stable")
    late = np.concatenate([np.zeros(len(grid.t), bool), np.ones(len(events.t), bool)])

    def both(name: str, factor: float = 1.0) -> Any:
        return factor * np.concatenate([getattr(grid, name), getattr(events, name)])[order]

    contact = both("contact").astype(int)
    slips = np.select([np.isin(contact, (2, 5)), np.isin(contact, (3, 6))], [1, -1], 0)
    lag = scenario.get("effects.eddy_lag.time")
    current = both("current") if lag == 0.0 else _lagging(grid, both("t"), float(lag))
    return Record(
        scenario, late[order], contact, (sign * slips).astype(int), both("t"), both("x", sign),
        both("z"), both("theta"), both("vx", sign), both("vz"), both("omega"),
        both("normal_force"), both("friction_force", sign), both("contact_x", sign),
        both("slip_velocity", sign), both("bx", sign), both("bz"), current, sign, fine,
        follows_currents, swing,
    )  # fmt: skip


def _lagging(grid: Run, t: Array, lag: float) -> Array:
    """Currents behind a first-order lag, exact for currents that are straight between samples."""
    step = 1.0 / float(grid.scenario.record.rate)
    ratio = step / lag
    decay = np.exp(-ratio)
    mean = -np.expm1(-ratio) / ratio
    filtered = lfilter([1.0 - mean, mean - decay], [1.0, -decay], grid.current, axis=0)
    return np.column_stack([np.interp(t, grid.t, column) for column in filtered.T])


def magnetic_load(record: Record) -> tuple[Array, Array, Array]:
    """Force along x and z (N), torque about +y (N m) of the field on the moment, Eqs. (8)-(9)."""
    s = record.scenario
    coils = Coils.of(s)
    points = np.column_stack([record.sign * record.x, np.zeros_like(record.x), record.z])
    slope = coils.gradient(points, record.current * gains(record))
    angle = record.theta + record.effect("misalignment.angle")
    mx, mz = record.moment * np.cos(angle), -record.moment * np.sin(angle)
    # Turning the frame about z by 180 degrees turns x and B_x: only dB_x/dz changes its sign.
    xx, xz, zz = slope[:, 0, 0], record.sign * slope[:, 0, 2], slope[:, 2, 2]
    scale = 1.0 + record.effect("gradient_scale.fraction")
    torque = mz * record.bx - mx * record.bz
    return scale * (mx * xx + mz * xz), scale * (mx * xz + mz * zz), torque


def gains(record: Record) -> Array:
    """Factor on the field of each coil."""
    in_plane = 1.0 + record.effect("field_gain.in_plane")
    return np.array([in_plane] * 4 + [1.0 + record.effect("field_gain.clamp")])
