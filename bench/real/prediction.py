"""Motion that the core predicts from a drop's first free frames, and its constants of impact."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.optimize import minimize

from stickslip import (
    STATE_COLUMNS,
    Drive,
    Robot,
    Scenario,
    State,
    Waveform,
    rollout,
    simulate_batch,
)

from .contacts import ABOUT, SIDE, ContactGeometry, reach
from .flights import FRAME, Drops, Flight, FlightConstants, state_of

AFTER = 52e-3
"""Time after the first contact at which predictions are judged, s."""
SCALE = np.array([5e-3, 4e-3, 0.25])
"""Errors of x, z (m) and theta (rad) that count as one in the fit. Chosen: about the medians at
`AFTER` of the best fit, so that half of the drops count nearly by their squares."""

_MASS = 1.0  # kg; without forces but weight and a drag by mass it does not matter
_FITTED_FRAMES = 14
"""After the last free frame. Chosen: 56 ms, the frames up to `AFTER`."""
_LATEST = 3
"""Frame in which the first flight begins at the latest. Chosen: a bad frame or two at the beginning
may be left out, while a flight after a contact begins later by the window of `find_flights`."""
_STILL = Drive(mode="program", program=Waveform.hold(1.0, {}))


@dataclass(frozen=True)
class ImpactConstants:
    """Constants that are fitted to the motion after the first contact.

    restitution, friction, tangential_restitution: See `stickslip.Contact`; static and kinetic
    friction are the same. side: Of the square that the core simulates, m: its corners lie where
    a rounded square's arcs have their middles, and its inertia belongs to it. height: Of the
    plate that it meets at x = 0, m; the rounding's radius is a part of it. lean: Angle by which
    the simulated square is turned on against the real one, rad: it takes up what the model
    lacks, and is no part of the camera's offset.
    """

    restitution: float
    friction: float
    tangential_restitution: float
    side: float
    height: float
    lean: float


UNIT = ImpactConstants(0.03, 0.01, 0.15, 1e-3, 3e-4, 4e-3)
"""Step of each constant with which the search begins."""


@dataclass(frozen=True)
class Model:
    """All that a prediction needs."""

    flight: FlightConstants
    geometry: ContactGeometry
    impact: ImpactConstants

    @property
    def offset(self) -> float:
        """Reading of theta less the angle of the simulated square, rad."""
        return self.geometry.angle_offset - self.impact.lean

    def scenario(self) -> Scenario:
        """The square on its plate, without a state to begin with."""
        flight, impact = self.flight, self.impact
        gravity = np.hypot(flight.gravity_x, flight.gravity_z)
        downhill = np.arctan2(flight.gravity_x, -flight.gravity_z) - self.geometry.slope
        inertia = _MASS * impact.side**2 / 6.0
        side = impact.side
        robot = Robot(length=side, width=side, height=side, mass=_MASS, magnetization=0.0)
        return Scenario(robot=robot, drive=_STILL).replace(
            {
                "contact.restitution": impact.restitution,
                "contact.tangential_restitution": impact.tangential_restitution,
                "contact.static_friction": impact.friction,
                "contact.kinetic_friction": impact.friction,
                "contact.adhesion": 0.0,
                "drag.linear": _MASS * flight.drag,
                "drag.rotational": 0.0,
                "effects.rotational_drag.coefficient": inertia * flight.spin_drag,
                "effects.surface_tilt.angle": downhill,
                "environment.gravity": gravity,
                "solver.rtol": 1e-6,
            }
        )


@dataclass(frozen=True)
class Starts:
    """Last free frame of each drop.

    drop, frame: shape (n,): state: shape (n, 6): x, z, theta, vx, vz, omega of the centre of
    mass there, theta as it is read.
    """

    drop: np.ndarray
    frame: np.ndarray
    state: np.ndarray


def starts(drops: Drops, flights: list[Flight], constants: FlightConstants, frames: int) -> Starts:
    """The first flight of each drop that has so many frames after it.

    Drops whose recording lost frames as it began are left out: their first regular flight comes
    later than `_LATEST`, after a contact.
    """
    first: dict[int, Flight] = {}
    for flight in flights:
        first.setdefault(flight.drop, flight)
    last = drops.poses.shape[1] - frames
    chosen = [each for each in first.values() if each.first <= _LATEST and each.end <= last]
    frame = np.array([each.end - 1 for each in chosen])
    return Starts(
        np.array([each.drop for each in chosen]),
        frame,
        np.array(
            [state_of(drops, each, constants, FRAME * (each.end - 1), True) for each in chosen]
        ),
    )


def at_plate(model: Model, state: np.ndarray) -> np.ndarray:
    """Rows of `stickslip.STATE_COLUMNS`: in flight, along the plate, which rises by thousandths."""
    x, z, theta, vx, vz, omega = state.T
    slope = model.geometry.slope
    rows = np.zeros((len(state), len(STATE_COLUMNS)))
    rows[:, :6] = np.stack(
        [
            x + slope * z,
            z - slope * x - model.impact.height,
            theta - model.offset,
            vx + slope * vz,
            vz - slope * vx,
            omega,
        ],
        axis=1,
    )
    # What has been read below the plate begins on it; a table of these rows has five digits.
    rows[:, 1] = np.maximum(rows[:, 1], reach(rows[:, 2], 0.5 * model.impact.side) + 2e-5)
    return rows


def predict(model: Model, begin: Starts, frames: int) -> np.ndarray:
    """Poses of the marker in the frames that follow, shape (n, frames, 3)."""
    rows = at_plate(model, begin.state)
    found = rollout(
        model.scenario(), rows, np.zeros((frames, 5)), FRAME, record=("x", "z", "theta")
    )
    x, above, angle = np.moveaxis(found.states, 2, 0)
    slope, theta = model.geometry.slope, angle + model.offset
    z = above + model.impact.height
    x, z = x - slope * z, z + slope * x
    beside, up = model.flight.marker(theta)
    return np.stack([x + beside, z + up, theta], axis=2)


def time_to_contact(model: Model, begin: Starts) -> np.ndarray:
    """Time from the last free frame to the first contact, s; at most three frames."""
    since = np.linspace(0.0, 3.0 * FRAME, 301)
    rows = at_plate(model, begin.state)
    way, fallen, turned = model.flight.travel(since)
    z = rows[:, 1:2] + rows[:, 4:5] * way + model.flight.gravity_z * fallen
    angle = rows[:, 2:3] + rows[:, 5:6] * turned
    below = z < reach(angle, 0.5 * model.impact.side)
    return np.where(below.any(axis=1), since[below.argmax(axis=1)], since[-1])


def tilt_at_contact(model: Model, begin: Starts) -> np.ndarray:
    """Angle of the simulated square's lowest face against the plate at the first contact, rad."""
    turned = model.flight.travel(time_to_contact(model, begin))[2]
    angle = begin.state[:, 2] - model.offset + begin.state[:, 5] * turned
    return angle - 0.5 * np.pi * np.round(angle / (0.5 * np.pi))


def touch_downs(model: Model, begin: Starts, after: float = AFTER) -> np.ndarray:
    """How many touch-downs the core counts up to a time after the first contact."""
    until = time_to_contact(model, begin) + after
    scenario = model.scenario()
    runs = [
        scenario.replace({"drive.program": Waveform.hold(float(end), {})}).with_state(
            State.from_row(row)
        )
        for end, row in zip(until, at_plate(model, begin.state), strict=True)
    ]
    return np.array([run.summary()["events"]["touch_down"] for run in simulate_batch(runs)])


def errors_at(model: Model, drops: Drops, begin: Starts, after: float = AFTER) -> np.ndarray:
    """Predicted minus measured pose at a time after the first contact, shape (n, 3)."""
    frames = int(np.ceil(after / FRAME)) + 4
    error = predict(model, begin, frames) - measured(drops, begin, frames)
    place = (time_to_contact(model, begin) + after) / FRAME - 1.0
    before = np.floor(place).astype(int)
    part = (place - before)[:, None]
    row = np.arange(len(error))
    return error[row, before] * (1.0 - part) + error[row, before + 1] * part


def measured(drops: Drops, begin: Starts, frames: int) -> np.ndarray:
    """Poses in the frames after the starts, shape (n, frames, 3)."""
    return drops.poses[begin.drop[:, None], begin.frame[:, None] + 1 + np.arange(frames)]


def fit_impacts(
    model: Model, drops: Drops, begin: Starts, held: tuple[str, ...] = (), tries: int = 150
) -> Model:
    """The model with constants of impact that suit the frames after the first contact.

    Nelder and Mead's search, as the motion jumps where another corner comes first; each error
    counts by the logarithm of one plus its square, so that drops that went another way do not rule.
    """
    names = [each.name for each in fields(ImpactConstants) if each.name not in held]
    unit = np.array([getattr(UNIT, name) for name in names])
    middle = np.array([getattr(model.impact, name) for name in names])
    seen = measured(drops, begin, _FITTED_FRAMES)

    def changed(steps: np.ndarray) -> Model:
        values = dict(zip(names, map(float, middle + unit * steps), strict=True))
        for name in ("restitution", "tangential_restitution", "friction"):
            if name in values:
                values[name] = min(max(values[name], 0.0), 1.0)
        return replace(model, impact=replace(model.impact, **values))

    def loss(steps: np.ndarray) -> float:
        off = (predict(changed(steps), begin, _FITTED_FRAMES) - seen) / SCALE
        return float(np.mean(np.log1p(np.sum(off**2, axis=2))))

    best = np.zeros(len(names))
    for size in (1.0, 0.5):
        # Twice, as a simplex that has shrunk may have done so on a ridge.
        corners = best + size * np.concatenate([np.zeros((1, len(names))), np.eye(len(names))])
        best = minimize(
            loss,
            best,
            method="Nelder-Mead",
            options={"initial_simplex": corners, "maxfev": tries, "xatol": 1e-2, "fatol": 1e-5},
        ).x
    return changed(best)


def first_guess(flight: FlightConstants, geometry: ContactGeometry) -> Model:
    """Start of a fit: corners and plate from the heights at contact."""
    height = geometry.plate + geometry.rounding - geometry.slope * ABOUT
    side = SIDE - 2.0 * geometry.rounding
    return Model(flight, geometry, ImpactConstants(0.45, 0.09, 0.5, side, height, 0.0))
