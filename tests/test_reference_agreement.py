"""Event-driven against time-stepping: the same scenarios in the independent reference simulator."""

import pytest

from helpers import run
from reference import simulate_reference

# Its kernels are compiled for half a minute.
pytestmark = pytest.mark.nightly

# The required agreement. The reference errs by less than 1e-4 on most of these at its step of
# 0.2 us, and the product by its tolerance; the slowest crawl (0.02 mm/s out of 0.6 mm/s of travel
# to and fro) by 8e-4.
AGREEMENT = 3e-3
STEP = 2e-7  # s

# mode, Hz, edge, clamp; base, hold (mT); static, kinetic friction, adhesion (uN); other keys
SCENARIOS = [
    ("IPP", 10, "rise", "down", 0.5, 1.0, 0.2, 0.145, 0.22, {}),
    ("IPP", 60, "fall", "down", 0.8, 0.6, 0.3, 0.21, 0.1, {}),
    ("IPP", 150, "rise", "up", 0.5, 1.5, 0.5, 0.35, 0.4, {}),
    ("IPP", 200, "fall", "down", 1.0, 1.0, 0.2, 0.145, 0.6, {}),
    ("IPP", 40, "rise", "up", 0.3, 0.8, 0.9, 0.63, 0.22, {}),
    ("IPP", 80, "fall", "up", 0.5, 2.0, 0.1, 0.07, 0.0, {}),
    ("OPP", 20, "rise", "down", 0.0, 2.0, 0.4, 0.28, 0.3, {}),
    ("OPP", 50, "fall", "up", 0.5, 1.0, 0.25, 0.18, 0.15, {}),
    ("OPP", 100, "rise", "down", 0.5, 1.5, 0.6, 0.42, 0.5, {}),
    ("OPP", 150, "fall", "down", 0.3, 2.5, 0.2, 0.145, 0.05, {}),
    ("OPP", 200, "rise", "up", 0.5, 2.0, 0.8, 0.56, 0.22, {}),
    ("OPP", 30, "fall", "down", 1.0, 1.0, 0.15, 0.1, 0.6, {"edge_time": 2e-3}),
    ("IPP", 100, "rise", "down", 0.0, 1.0, 0.2, 0.145, 0.22, {}),
    ("IPP", 30, "rise", "down", 0.5, 1.0, 0.2, 0.145, 0.22, {"direction": "-x"}),
    ("OPP", 70, "rise", "up", 0.2, 1.2, 0.35, 0.35, 0.2, {"ramp_down": 0.02}),
    ("IPP", 120, "fall", "down", 0.6, 1.2, 0.3, 0.2, 0.22, {"peak": 4e-3}),
]
# At the limit of friction: in the first case for a short visit, in the second within 3e-5 of it,
# which steps above 0.15 us take for slip.
AT_THE_LIMIT = [
    ("OPP", 100, "fall", "down", 0.0, 1.0, 1.8, 1.305, 0.22, {}),
    ("OPP", 100, "rise", "up", 0.0, 2.5, 0.2, 0.145, 0.22, {}),
]


def _name(case):
    words = [f"{key}={value}" for key, value in case[-1].items()]
    return "-".join([case[0], f"{case[1]}Hz", *case[2:4], *words])


@pytest.mark.parametrize("case", [*SCENARIOS, *AT_THE_LIMIT], ids=_name)
def test_a_drive(case):
    mode, frequency, edge, clamp, base, hold, static, kinetic, adhesion, more = case
    drive = {
        "mode": mode, "frequency": float(frequency), "edge": edge, "clamp": clamp,
        "base": base * 1e-3, "hold": hold * 1e-3, "pulses": 6, **more,
    }  # fmt: skip
    contact = {"static_friction": static, "kinetic_friction": kinetic, "adhesion": adhesion * 1e-6}
    ours = run({f"contact.{key}": value for key, value in contact.items()}, **drive).summary()
    step = STEP / 2 if case in AT_THE_LIMIT else STEP
    other = simulate_reference(drive, contact=contact, dt=step)
    span = other.theta_max - other.theta_min
    assert ours["mean_velocity"] == pytest.approx(other.mean_velocity, rel=AGREEMENT)
    assert ours["theta_min"] == pytest.approx(other.theta_min, abs=1e-3 * span)
    assert ours["theta_max"] == pytest.approx(other.theta_max, abs=1e-3 * span)
    # Each hop begins and ends on a step of the reference: two steps of some 3 ms or more.
    assert ours["airborne_fraction"] == pytest.approx(other.airborne_fraction, abs=2e-4)
    # A part can be far smaller than the travel, so each is measured by the larger of the two.
    slack = AGREEMENT * max(abs(other.slip_up), abs(other.slip_down))
    assert ours["slip_up"] == pytest.approx(other.slip_up, abs=slack)
    assert ours["slip_down"] == pytest.approx(other.slip_down, abs=slack)


BASES = {
    "IPP": {"mode": "IPP", "edge": "fall", "base": 0.5e-3, "hold": 1e-3},
    "OPP": {"mode": "OPP", "edge": "rise", "base": 0.0, "hold": 2e-3},
}
# name: product's parameters, reference's parameters; a constant of the product has its key
EFFECTS = {
    "surface_tilt": ({"angle": 0.06}, {"angle": 0.06}),
    "ambient_field": ({"Bx": 2e-4, "Bz": -1e-4}, {"Bx": 2e-4, "Bz": -1e-4}),
    "misalignment": ({"angle": 0.3}, {"angle": 0.3}),
    "restitution": ({"contact.restitution": 0.4}, {"coefficient": 0.4}),
    "edge_time": ({"drive.edge_time": 1e-3}, {"time": 1e-3}),
    "magnetization_scale": ({"robot.magnetization": 6e5}, {"fraction": 0.2}),
    "angle_drag": ({"strength": 20.0}, {"amplitude": 20.0, "power": 2}),
    "rotational_drag": ({"coefficient": 2e-13}, {"coefficient": 2e-13}),
    "stribeck_friction": ({"velocity": 2e-3}, {"speed": 2e-3, "form": "gaussian"}),
    "eddy_lag": ({"time": 5e-4}, {"time": 5e-4}),
    **{
        name: (each, each)
        for name, each in {
            "coil_heating": {"coefficient": 0.02},
            "amplifier_limit": {"voltage": 22.0},
            "sample_hold": {"period": 1e-3},
            "mutual_inductance": {"coupling": 0.05},
            "gradient_scale": {"fraction": 1.0},
            "field_gain": {"in_plane": 0.1, "clamp": -0.1},
            "viscous_friction": {"coefficient": 10.0},
            "friction_anisotropy": {"fraction": 0.2},
            "angle_adhesion": {"strength": -1.0},
            "adhesion_ageing": {"rate": 0.1, "time": 1e-3},
            "quadratic_drag": {"coefficient": 5e-3},
            "friction_patches": {"amplitude": 0.4, "period": 2e-4},
        }.items()
    },
}


@pytest.mark.parametrize("mode", BASES)
@pytest.mark.parametrize("effect", EFFECTS)
def test_mean_velocity_with_an_effect(effect, mode):
    # Steady from the third pulse on, so that one more shows as much as seven.
    drive = {**BASES[mode], "frequency": 60.0, "pulses": 4}
    mine, others = EFFECTS[effect]
    keys = {key if "." in key else f"effects.{effect}.{key}": each for key, each in mine.items()}
    velocity = run(keys, **drive).mean_velocity
    # Rebounds scatter with the step, by up to a third of what is allowed.
    step = STEP if effect == "restitution" else 2 * STEP
    reference = simulate_reference(drive, effects={effect: others}, dt=step)
    # An effect may all but stop the robot, and then its own velocity is no measure.
    plain = run(**drive).mean_velocity
    close = {"rel": AGREEMENT, "abs": AGREEMENT * abs(plain)}
    assert velocity == pytest.approx(reference.mean_velocity, **close)
    # The effect counts here: without it the two would differ. IPP on this base hardly leaves the
    # surface, so restitution has nothing to act on.
    if (effect, mode) != ("restitution", "IPP"):
        assert abs(velocity / plain - 1.0) > 5 * AGREEMENT


@pytest.mark.parametrize("restitution", [0.9, 1.0])
def test_mean_velocity_where_the_restitution_is_bounded(restitution):
    # Some 300 rebounds of corners with much friction, of which Newton's law would make energy: the
    # velocity would be 0.69 instead of 0.78 mm/s, and -0.30 instead of 0.74 with full restitution.
    drive = {**BASES["OPP"], "hold": 2.5e-3, "frequency": 60.0, "pulses": 6}
    contact = {"static_friction": 1.0, "kinetic_friction": 0.7, "restitution": restitution}
    velocity = run({f"contact.{key}": value for key, value in contact.items()}, **drive)
    reference = simulate_reference(drive, contact=contact, dt=STEP)
    assert velocity.mean_velocity == pytest.approx(reference.mean_velocity, rel=AGREEMENT)


STILL = {"peak": 0.0, "base": 0.0, "hold": 0.0, "ramp": 0.0, "frequency": 100.0, "pulses": 6}
ALONG = {"frequency": 100.0, "amplitude_x": 40e-6, "harmonic_2_x": 0.3, "phase_2_x": 1.0}
# shake, contact, drive, drag: what differs from the above and the defaults
SHAKEN = {
    "along": ({}, {}, {}),
    "along, rough": ({"amplitude_x": 90e-6}, {"static_friction": 0.6, "kinetic_friction": 0.4}, {}),
    "four sines": ({"harmonic_3_x": -0.2, "phase_3_x": 0.4, "harmonic_4_x": 0.1}, {}, {}),
    "faced back": ({}, {}, {"direction": "-x"}),
    "a leg": ({"amplitude_z": 5e-6, "phase": 1.2, "harmonic_2_x": 0.0}, {"adhesion": 0.0}, {}),
    "a leg that lifts": (
        {"amplitude_z": 40e-6, "phase": 0.7, "harmonic_2_z": 0.2, "phase_2_z": 2.0},
        {"adhesion": 0.0}, {},
    ),
    "the liquid rests": ({"liquid": "rests"}, {"adhesion": 0.1e-6}, {}),
    "beside IPP": ({"amplitude_x": 10e-6}, {}, {"mode": "IPP", **BASES["IPP"], "peak": 2.5e-3}),
    "beside OPP": (
        {"amplitude_x": 5e-6, "amplitude_z": 4e-6, "phase": -0.6}, {},
        {"mode": "OPP", **BASES["OPP"], "peak": 2.5e-3},
    ),
}  # fmt: skip


def shaken(drive, contact, shake, inner=None, step=STEP):
    """Mean velocities of both, m/s."""
    sections = {"contact": contact, "shake": shake, "inner": inner or {}}
    keys = {f"{section}.{key}": v for section, own in sections.items() for key, v in own.items()}
    other = simulate_reference(drive, contact=contact, shake=shake, inner=inner, dt=step)
    return run(keys, **drive).mean_velocity, other.mean_velocity


@pytest.mark.parametrize("name", SHAKEN)
def test_a_shaken_surface(name):
    shake, contact, drive = SHAKEN[name]
    velocity, other = shaken({**STILL, **drive}, contact, {**ALONG, **shake})
    assert abs(velocity) > 1e-5
    assert velocity == pytest.approx(other, rel=AGREEMENT)


SPRUNG = {"mass": 10e-9, "stiffness": 0.02, "damping": 2e-6, "frequency": 200.0,
          "amplitude": 2e-7, "harmonic_2": 0.5, "phase_2": 1.0}  # fmt: skip
STOPS = {"stop_low": -5e-6, "stop_high": 4e-6, "restitution": 0.6}
# inner, contact, shake
CAPSULES = {
    "two sines": ({}, {}, {}),
    "stops": ({**STOPS, "harmonic_2": 0.0}, {}, {}),
    "pulses": ({"duty": 0.3, "amplitude": 3e-7, "phase": 1.0}, {}, {}),
    "pulses and stops": ({**STOPS, "duty": 0.4, "amplitude": 3e-7}, {"adhesion": 0.05e-6}, {}),
    "aslant": ({"direction": 0.6}, {"adhesion": 0.4e-6}, {}),
    "upright": ({"direction": 1.5707963, "amplitude": 1e-7}, {}, {"amplitude_x": 20e-6}),
    "aslant and stops": ({**STOPS, "direction": 0.6, "amplitude": 3e-7}, {"adhesion": 0.1e-6}, {}),
    "upright and stops": ({**STOPS, "direction": 1.5707963, "amplitude": 3e-7, "restitution": 0.3},
                          {"adhesion": 0.05e-6}, {"amplitude_x": 20e-6}),
    "along on a shaken surface": ({"amplitude": 1e-7}, {}, {"amplitude_x": 10e-6}),
}  # fmt: skip


@pytest.mark.parametrize("name", CAPSULES)
def test_an_inner_mass(name):
    inner, contact, shake = CAPSULES[name]
    moved = {**ALONG, **shake} if shake else {}
    # Pulses that begin and end on a step, beside stops: its error is of first order.
    step = STEP / 4 if name == "pulses and stops" else STEP
    velocity, other = shaken(STILL, contact, moved, {**SPRUNG, **inner}, step)
    assert abs(velocity) > 1e-5
    assert velocity == pytest.approx(other, rel=AGREEMENT)
