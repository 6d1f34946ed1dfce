"""Entry of the reference simulator: dictionaries with the keys of a scenario in, numbers out."""

from dataclasses import dataclass, field

import numpy as np

from . import stepper as slot
from .drive import DRIVE_DEFAULTS, complete, complete_drive, voltages_of
from .effects import COILS, circuit_with, completed_effects, driven, model_of
from .field import coil_wires
from .shaken import INNER, SHAKE, shaken_of
from .stepper import QUARTER_TURN, march

ROBOT_DEFAULTS = {
    "length": 250e-6,  # m, Table II
    "width": 130e-6,  # m
    "height": 100e-6,  # m
    "mass": 25.6e-9,  # kg; the weight of 251 nN shows that the table's "ng" means ug
    "magnetization": 5e5,  # A/m
}
CONTACT_DEFAULTS = {
    "static_friction": 0.2,
    "kinetic_friction": 0.145,
    "adhesion": 0.22e-6,  # N
    "restitution": 0.0,
}
DRAG_DEFAULTS = {
    "linear": 1.0e-5,  # N s/m, Eq. (18)
    "rotational": 9.0e-17,  # N m s^2, Eq. (19)
}

# Beyond this scan the first angle of balance is found to rounding by bisection.
SCAN, HALVINGS = 400, 60


@dataclass(frozen=True)
class ReferenceRun:
    """Result of one run. SI units, radians.

    mean_velocity: m/s, centre of mass in x from the end of the third pulse to that of the last;
        nan with three pulses or fewer. All else but the samples is of the same interval.
    theta_min, theta_max: rad. airborne_fraction: share of the time without any contact.
    slip_up, slip_down: m/s, travel of a single slipping contact corner while theta rises / falls,
        per unit of time (two-corner sliding at constant theta is neither).
    t, x, theta: samples, empty unless a rate was asked for.
    """

    mean_velocity: float
    theta_min: float
    theta_max: float
    airborne_fraction: float
    slip_up: float
    slip_down: float
    t: np.ndarray = field(repr=False)
    x: np.ndarray = field(repr=False)
    theta: np.ndarray = field(repr=False)


def _model(robot, contact, drag, effect, circuit, mirror, pace):
    return model_of(
        complete("robot", robot, ROBOT_DEFAULTS),
        complete("contact", contact, CONTACT_DEFAULTS),
        complete("drag", drag, DRAG_DEFAULTS),
        effect, circuit, mirror, pace,
    )  # fmt: skip


def simulate_reference(
    drive: dict,
    robot: dict | None = None,
    contact: dict | None = None,
    drag: dict | None = None,
    effects: dict | None = None,
    dt: float = 1e-7,
    rate: float | None = None,
    shake: dict | None = None,
    inner: dict | None = None,
) -> ReferenceRun:
    """Simulate one drive from rest.

    drive, robot, contact, drag, shake, inner: keys and units of the scenario sections of the same
    names (SI); absent keys take the defaults above. effects: {name: {parameter: value}}, see
    effects.py. dt: s, fixed step. rate: Hz of the samples; without it none are kept.
    Raises ValueError for a key or a word that is not known.
    """
    full = complete_drive(drive)
    # With direction "-x" the robot, its moment and the driving coil are turned about z together. In
    # the turned frame nothing differs but what is fixed to the world, so that is what is mirrored.
    mirror = 1.0 if full["direction"] == "+x" else -1.0
    effect = completed_effects(effects)
    full["edge_time"] += effect["edge_time"]["time"]
    volts = driven(voltages_of(full), effect)
    circuit = circuit_with(volts, effect)
    model = _model(robot, contact, drag, effect, circuit, mirror, full["frequency"])
    # The first coils of the list, as many as have a voltage of their own.
    wires = np.stack([coil_wires(name) for name in COILS[: volts.level.shape[1]]])
    # The last moment itself must fall inside a step, whichever way its multiple of dt rounds.
    shaken = shaken_of(complete("shake", shake, SHAKE), complete("inner", inner, INNER), mirror)
    steps = int(np.floor(volts.end / dt + 1e-9)) + 1
    window = np.array([volts.first_counted, volts.last_counted])
    count = int(np.floor(volts.end * rate + 1e-9)) + 1 if rate else 0
    samples = np.zeros((count, 2))
    marks = march(
        model, wires, volts.start, volts.level @ circuit.to_coils, volts.slope @ circuit.to_coils,
        float(dt), steps, window, float(rate or 1.0), samples, shaken,
    )  # fmt: skip
    seconds = window[1] - window[0]
    return ReferenceRun(
        mean_velocity=float(mirror * (marks[slot.X_END] - marks[slot.X_BEGIN]) / seconds),
        theta_min=float(marks[slot.THETA_MIN]),
        theta_max=float(marks[slot.THETA_MAX]),
        airborne_fraction=float(marks[slot.AIRBORNE] / seconds),
        slip_up=float(mirror * marks[slot.SLIP_UP] / seconds),
        slip_down=float(mirror * marks[slot.SLIP_DOWN] / seconds),
        t=np.arange(count) / (rate or 1.0),
        x=mirror * samples[:, 0],
        theta=samples[:, 1],
    )


def _tipping(model, bx, bz, theta, sense):
    """Torque in N m that turns the block on about its front (sense 1) or rear (-1) corner."""
    moment = model.moment
    angle = theta + model.misalignment
    magnetic = -moment * (bx * np.sin(angle) + bz * np.cos(angle))
    # Offset of the corner from the centre of mass; the surface bears the weight there.
    ahead = sense * model.half_length
    rx = ahead * np.cos(theta) - model.half_height * np.sin(theta)
    rz = -ahead * np.sin(theta) - model.half_height * np.cos(theta)
    normal, along = -model.mass * model.gravity_z, -model.mass * model.gravity_x
    return sense * (magnetic + rz * along - rx * normal)


def static_tilt_reference(fields, robot=None, contact=None, effects=None):
    """Angle in rad, (n,), at which the block rests in fields (Bx, Bz) in T, (n, 2).

    It comes from lying flat, with adhesion at both ends until one is lifted, and stands up to a
    quarter turn at most. Arguments as those of `simulate_reference`; what it measures is not here.
    """
    effect = completed_effects({k: v for k, v in (effects or {}).items() if k != "coil_heating"})
    circuit = circuit_with(driven(voltages_of(DRIVE_DEFAULTS), effect), effect)
    model = _model(robot, contact, None, effect, circuit, 1.0, DRIVE_DEFAULTS["frequency"])
    result = []
    for field_x, field_z in np.atleast_2d(fields):
        bx, bz = field_x + model.ambient_x, field_z + model.ambient_z
        # The end that is lifted first is torn off against half of the adhesion.
        hold = model.adhesion * model.half_length
        excess = {sense: _tipping(model, bx, bz, 0.0, sense) - hold for sense in (1, -1)}
        sense = max(excess, key=lambda each: excess[each])
        if excess[sense] <= 0.0:
            result.append(0.0)
            continue
        angles = np.linspace(0.0, QUARTER_TURN, SCAN)
        turning = np.array([_tipping(model, bx, bz, sense * each, sense) for each in angles])
        stops = np.flatnonzero(turning <= 0.0)
        if len(stops) == 0:
            result.append(sense * QUARTER_TURN)
            continue
        low, high = angles[max(stops[0] - 1, 0)], angles[stops[0]]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if _tipping(model, bx, bz, sense * middle, sense) > 0.0:
                low = middle
            else:
                high = middle
        result.append(sense * 0.5 * (low + high))
    return np.array(result)
