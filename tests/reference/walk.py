"""Walks of the robot that turns: a scenario in, speed along and across the heading out."""

from dataclasses import dataclass, field

import numpy as np

from . import eight_corners as slot
from .circuit import circuit_of
from .corner_contact import new_memory, new_step
from .corner_step import Block, new_motion, new_trial
from .drive import Voltages, complete
from .effects import GRAVITY
from .field import INDUCTANCE, RESISTANCE, coil_wires
from .heading import COILS, Heading, constant, heading_voltages
from .near_field import new_field
from .simulate import CONTACT_DEFAULTS, DRAG_DEFAULTS, ROBOT_DEFAULTS

# A corner no higher than this lands together with the first of its edge. Corners that are sharp to
# the last (0) land one after the other however small the roll, bounce to and fro for 0.2 ms, and so
# break the symmetry of left and right: at heading 0.001 degrees that walks 2 % faster than at 0.
# With 0.3 um at the centre, and 1 um 10 mm off it, edges land as wholes, and from there on nothing
# depends on the number.
WHOLE_EDGES = 2e-6  # m

HALVINGS = 8
SHORTEST = 4e-9  # s
RATE = 12e3  # Hz, of the samples


@dataclass(frozen=True)
class Walk:
    """Result of one walk. SI units, radians.

    along, across: m/s, mean velocity of the centre of mass along the commanded heading and to its
        left, from the end of the third pulse to that of the last; while the heading changes, along
        what it is at the moment. displacement (2,): m, in x and y, between the same times.
    lag_max, lag_rms: rad, angle from the moment's horizontal part to that of the field at the body.
    roll_max: rad, size of the angle between the body's y axis and the plane. All in the same time.
    counts: see corner_contact.py. t (n,), samples (n, 9): x, y, z, heading, tilt, roll, field's
        heading, touching corners, energy.
    """

    along: float
    across: float
    displacement: np.ndarray
    lag_max: float
    lag_rms: float
    roll_max: float
    counts: dict = field(repr=False)
    t: np.ndarray = field(repr=False)
    samples: np.ndarray = field(repr=False)


def block_of(contact=None, reach=0.0) -> Block:
    """Constants of the kernel; absent keys of `[contact]` take the reference's defaults."""
    body, fluid = ROBOT_DEFAULTS, DRAG_DEFAULTS
    touch = complete("contact", contact, CONTACT_DEFAULTS)
    sizes = np.array([body["length"], body["width"], body["height"]])
    squares = np.sum(sizes**2) - sizes**2
    return Block(
        half_sizes=sizes / 2,
        mass=float(body["mass"]),
        inertia=body["mass"] * squares / 12,
        moment=float(np.prod(sizes) * body["magnetization"]),
        mu_static=float(touch["static_friction"]),
        mu_kinetic=float(touch["kinetic_friction"]),
        adhesion=float(touch["adhesion"]),
        restitution=float(touch["restitution"]),
        drag_linear=float(fluid["linear"]),
        drag_rotational=float(fluid["rotational"]),
        gravity=GRAVITY,
        reach=float(reach),
    )


def run_corners(block, volts: Voltages, now, rate, shortest=SHORTEST, memory=None):
    """March from `now`; returns marks, counts, and samples (n, 9) at multiples of 1 / rate."""
    circuit = circuit_of(np.full(5, RESISTANCE), INDUCTANCE * np.eye(5), 0.0)
    wires = np.stack([coil_wires(name) for name in COILS])
    samples = np.zeros((int(np.floor(volts.end * rate + 1e-9)) + 1, slot.COLUMNS))
    marks, counts = slot.march_corners(
        block, wires, circuit, volts.start, volts.level @ circuit.to_coils,
        volts.slope @ circuit.to_coils, now, new_motion(), new_field(5), new_trial(),
        new_step(), new_memory() if memory is None else memory, float(shortest), HALVINGS,
        volts.end, np.array([volts.first_counted, volts.last_counted]), float(rate), samples,
    )  # fmt: skip
    names = ("landings", "leavings", "slips", "newton_failed", "unsolved", "steps")
    return marks, dict(zip(names, counts.tolist(), strict=True)), samples


def walk(
    drive: dict,
    heading: float | Heading = 0.0,
    coils: str = "single",
    place: tuple = (0.0, 0.0),
    contact: dict | None = None,
    reach: float = 0.0,
    shortest: float = SHORTEST,
) -> Walk:
    """Walk from rest, flat on the plane and turned to the heading.

    drive: keys of `[drive]` without `direction`. heading: rad, or a function of time. coils: see
    `coil_shares`. place: m, of the centre of mass. contact: keys of that section. reach: m, see
    WHOLE_EDGES. shortest: s, length of a step with an event; without, a step is up to
    shortest 2^HALVINGS. Raises ValueError for a word or key that is not known.
    """
    way = heading if isinstance(heading, Heading) else constant(heading)
    volts = heading_voltages(drive, way, coils)
    block = block_of(contact, reach)
    half_turn = 0.5 * float(way(0.0))
    quaternion = [np.cos(half_turn), 0.0, 0.0, np.sin(half_turn)]
    now = new_motion((*place, block.half_sizes[2]), quaternion)
    marks, counts, samples = run_corners(block, volts, now, RATE, shortest)
    t = np.arange(len(samples)) / RATE
    return Walk(*_speeds(t, samples, way, marks, volts), counts, t, samples)


def _speeds(t, samples, way, marks, volts):
    """The numbers of a Walk, in its order, up to roll_max."""
    seconds = volts.last_counted - volts.first_counted
    displacement = marks[[slot.X_END, slot.Y_END]] - marks[[slot.X_BEGIN, slot.Y_BEGIN]]
    if len(way.times) == 1:
        angle = way(0.0)
        along = np.cos(angle) * displacement[0] + np.sin(angle) * displacement[1]
        across = -np.sin(angle) * displacement[0] + np.cos(angle) * displacement[1]
    else:
        counted = (t >= volts.first_counted - 1e-9) & (t <= volts.last_counted + 1e-9)
        angle = way(0.5 * (t[counted][1:] + t[counted][:-1]))
        dx, dy = np.diff(samples[counted][:, : slot.Z], axis=0).T
        along = np.sum(np.cos(angle) * dx + np.sin(angle) * dy)
        across = np.sum(-np.sin(angle) * dx + np.cos(angle) * dy)
    lag = np.sqrt(marks[slot.LAG_SQUARED] / seconds)
    return (
        float(along / seconds), float(across / seconds), displacement,
        float(marks[slot.MOST_LAG]), float(lag), float(marks[slot.MOST_ROLL]),
    )  # fmt: skip
