"""Extensions of the model: names, parameters and forms of effects, and the kernel's constants.

Names and meanings are those of `stickslip effects`; a form that is a matter of choice is a word of
the effect (`form`, `power`), and the library's form is one of the words.
"""

from dataclasses import replace

import numpy as np

from .circuit import Circuit, circuit_of, mean_squares
from .drive import Voltages, clipped, complete, held
from .field import INDUCTANCE, RESISTANCE
from .laws import laws_of
from .stepper import Model

GRAVITY = 9.81  # m/s^2

# Every effect is absent at these values.
EFFECT_DEFAULTS = {
    "coil_heating": {"coefficient": 0.0, "form": "program"},  # 1/W; mean power of it, or "pulses"
    "amplifier_limit": {"voltage": 0.0},  # V, 0: none
    "eddy_lag": {"time": 0.0},  # s
    "sample_hold": {"period": 0.0},  # s
    "edge_time": {"time": 0.0},  # s, beyond the drive's own
    "mutual_inductance": {"coupling": 0.0},
    "gradient_scale": {"fraction": 0.0},
    "field_gain": {"in_plane": 0.0, "clamp": 0.0},
    "misalignment": {"angle": 0.0},  # rad, added to theta in the moment's direction
    "magnetization_scale": {"fraction": 0.0},
    "ambient_field": {"Bx": 0.0, "Bz": 0.0},  # T, in the world
    "stribeck_friction": {"speed": 0.0, "form": "gaussian"},  # m/s; or "rational"
    "viscous_friction": {"coefficient": 0.0, "power": 1.0, "scale": 1.0},  # s/m; (v/scale)^power
    "friction_anisotropy": {"fraction": 0.0},
    "angle_adhesion": {"strength": 0.0, "power": 2.0},  # 1 - strength |sin theta|^power
    "adhesion_ageing": {"rate": 0.0, "time": 1e-3, "form": "log"},  # s; or "rise"
    "restitution": {"coefficient": 0.0},  # added to that of [contact]
    "angle_drag": {"amplitude": 0.0, "power": 2.0},  # 1 + amplitude |cos theta|^power
    "quadratic_drag": {"coefficient": 0.0, "power": 1.0, "scale": 1.0},  # N s^2/m^2 |v| v
    "rotational_drag": {"coefficient": 0.0},  # N m s, torque -coefficient omega
    "surface_tilt": {"angle": 0.0},  # rad, > 0 is downhill towards +x of the world
    "friction_patches": {"amplitude": 0.0, "period": 1e-3, "form": "wave", "phase": 0.0},
    # Any law of one quantity, a part of what it has without; see laws.py for the words.
    "law": {
        "target": "friction", "argument": "angle", "form": "power", "amplitude": 0.0, "scale": 1.0,
        "exponent": 1.0,
    },
}  # fmt: skip

# Of the coils xp, clamp and xm, yp, ym: axis, and side of the centre. Only coupling gives the last
# three a current.
_AXIS = np.array([0, 2, 0, 1, 1])
_SIDE = np.array([1.0, -1.0, -1.0, 1.0, -1.0])
COILS = ("xp", "clamp", "xm", "yp", "ym")

HEATING_STEP = 1e-5  # s; a trapezoid over a current of time constant 7 ms errs by 1e-7


def completed_effects(effects: dict | None) -> dict:
    """All effects with all their parameters."""
    given = complete("effects", effects, EFFECT_DEFAULTS)
    return {k: complete(f"effects.{k}", given[k], v) for k, v in EFFECT_DEFAULTS.items()}


def driven(volts: Voltages, effect: dict) -> Voltages:
    """Voltages that the coils get when these are asked for; two columns, five if coils couple."""
    if effect["amplifier_limit"]["voltage"] > 0.0:
        volts = clipped(volts, effect["amplifier_limit"]["voltage"])
    if effect["sample_hold"]["period"] > 0.0:
        volts = held(volts, effect["sample_hold"]["period"])
    if effect["mutual_inductance"]["coupling"] != 0.0:
        more = np.zeros((len(volts.start), len(COILS) - 2))
        volts = replace(
            volts, level=np.hstack([volts.level, more]), slope=np.hstack([volts.slope, more])
        )
    return volts


def circuit_with(volts: Voltages, effect: dict) -> Circuit:
    """Circuit of the coils that `volts` drives."""
    count = volts.level.shape[1]
    coupling = effect["mutual_inductance"]["coupling"]
    # Flux of one coil through another: along its axis for one on the same axis, else by the sides.
    sign = np.where(_AXIS[:, None] == _AXIS, 1.0, -np.outer(_SIDE, _SIDE))
    inductance = INDUCTANCE * (coupling * sign + (1.0 - coupling) * np.eye(len(COILS)))
    inductance = inductance[:count, :count]
    lag, cold = effect["eddy_lag"]["time"], np.full(count, RESISTANCE)
    heating = effect["coil_heating"]
    if heating["form"] not in ("program", "pulses"):
        raise ValueError(f"effects.coil_heating.form = {heating['form']!r}")
    if heating["coefficient"] == 0.0:
        return circuit_of(cold, inductance, lag)
    begin = 0.0
    if heating["form"] == "pulses":
        # The first pulses bring the currents to what they are in all others.
        begin = volts.first_counted
    warm = cold
    for _ in range(50):
        circuit = circuit_of(warm, inductance, 0.0)
        modal = volts.level @ circuit.to_coils, volts.slope @ circuit.to_coils
        squares = mean_squares(begin, volts.end, HEATING_STEP, volts.start, *modal, circuit)
        # Halfway, since a warm coil takes less power: the full step would swing about the end.
        warm = 0.5 * (warm + cold * (1.0 + heating["coefficient"] * warm * squares))
    return circuit_of(warm, inductance, lag)


def _laws(touch: dict, fluid: dict, effect: dict):
    """Terms of all effects that are a law of the motion."""
    stribeck, ageing = effect["stribeck_friction"], effect["adhesion_ageing"]
    viscous, square = effect["viscous_friction"], effect["quadratic_drag"]
    patches, law = effect["friction_patches"], effect["law"]
    sizes = {"drag": fluid["linear"], "sliding": touch["kinetic_friction"]}
    slipping = (touch["static_friction"] - touch["kinetic_friction"]) * (stribeck["speed"] > 0.0)
    angle_drag, angle_adhesion = effect["angle_drag"], effect["angle_adhesion"]
    return laws_of(
        [
            ("sliding", "slip_speed", stribeck["form"], slipping, stribeck["speed"], 0.0),
            ("sliding", "slip_speed", "power", viscous["coefficient"] * viscous["scale"],
             viscous["scale"], viscous["power"]),
            ("friction", "place", patches["form"], patches["amplitude"], patches["period"],
             patches["phase"]),
            ("adhesion", "angle", "sine", -angle_adhesion["strength"], 1.0,
             angle_adhesion["power"]),
            ("adhesion", "age", ageing["form"], ageing["rate"], ageing["time"], 0.0),
            ("drag", "angle", "cosine", angle_drag["amplitude"] * fluid["linear"], 1.0,
             angle_drag["power"]),
            ("drag", "speed", "power", square["coefficient"] * square["scale"], square["scale"],
             square["power"]),
            (law["target"], law["argument"], law["form"],
             law["amplitude"] * sizes.get(law["target"], 1.0), law["scale"], law["exponent"]),
        ]
    )  # fmt: skip


def model_of(
    body: dict, touch: dict, fluid: dict, effect: dict, circuit: Circuit, mirror: float, pace: float
) -> Model:
    """Constants of the kernel in the robot's frame; `mirror` is -1 if that faces the world's -x.

    pace: Hz of the drive.
    """
    volume = body["length"] * body["width"] * body["height"]
    tilt = effect["surface_tilt"]["angle"]
    along = 1.0 + effect["field_gain"]["in_plane"]
    clamp = 1.0 + effect["field_gain"]["clamp"]
    gain = np.array([along, clamp, along, along, along])[: len(circuit.to_coils)]
    restitution = effect["restitution"]["coefficient"] + touch["restitution"]
    return Model(
        half_length=float(body["length"] / 2),
        half_height=float(body["height"] / 2),
        mass=float(body["mass"]),
        inertia=float(body["mass"] * (body["height"] ** 2 + body["length"] ** 2) / 12),
        moment=float(
            volume * body["magnetization"] * (1.0 + effect["magnetization_scale"]["fraction"])
        ),
        mu_static=float(touch["static_friction"]),
        mu_kinetic=float(touch["kinetic_friction"]),
        lean=float(effect["friction_anisotropy"]["fraction"]),
        adhesion=float(touch["adhesion"]),
        restitution=float(restitution),
        drag_linear=float(fluid["linear"]),
        drag_quadratic=float(fluid["rotational"]),
        drag_rotational=float(effect["rotational_drag"]["coefficient"]),
        gravity_x=float(mirror * GRAVITY * np.sin(tilt)),
        gravity_z=float(-GRAVITY * np.cos(tilt)),
        ambient_x=float(mirror * effect["ambient_field"]["Bx"]),
        ambient_z=float(effect["ambient_field"]["Bz"]),
        misalignment=float(effect["misalignment"]["angle"]),
        gradient=float(1.0 + effect["gradient_scale"]["fraction"]),
        gain=gain,
        mirror=float(mirror),
        frequency=float(pace),
        laws=_laws(touch, fluid, effect),
        circuit=circuit,
    )
