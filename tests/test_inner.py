"""A mass within the body: closed forms of what it does to the robot."""

import numpy as np
import pytest

from helpers import ADHESION, GRAVITY, MASS, friction, scenario
from stickslip import ScenarioError, simulate

FREQUENCY = 128.0  # Hz
RATE = 2.0 * np.pi * FREQUENCY
INNER = 0.4 * MASS  # kg
FREE = {"drive.mode": "none", "drive.pulses": 6, "inner.mass": INNER, "inner.frequency": FREQUENCY,
        "drag.linear": 0.0, "drag.rotational": 0.0}  # fmt: skip
EXACT = {"solver.rtol": 1e-12}
HELD = {"contact.adhesion": 1e-3}
BALL = {"contact.adhesion": 0.0, **friction(0.0)}
MU = 0.2
SPRING = INNER * (2.0 * np.pi * 200.0) ** 2  # N/m, 200 Hz


def run(*changes, **record):
    found = simulate(scenario(FREE, *changes, {f"record.{k}": v for k, v in record.items()}))
    assert found.ok, found.message
    return found


@pytest.mark.parametrize(("part", "slips"), [(1.0 - 1e-9, False), (1.0 + 1e-9, True)])
def test_slip_begins_where_the_force_exceeds_friction(part, slips):
    hold = MU * ((MASS + INNER) * GRAVITY + ADHESION)
    of = run(friction(MU, 0.15), {"inner.amplitude": part * hold, "drive.pulses": 1})
    assert (of.summary()["events"]["slip_start"] > 0) == slips


@pytest.mark.parametrize(("part", "lifts"), [(1.0 - 1e-9, False), (1.0 + 1e-9, True)])
def test_a_force_upwards_lifts_the_body_alone(part, lifts):
    force = part * (MASS * GRAVITY + ADHESION)
    keys = {"inner.direction": np.pi / 2, "inner.amplitude": force, "drive.pulses": 1}
    of = run(friction(5.0), keys)
    assert (of.summary()["events"]["lift_off"] + of.summary()["events"]["tip"] > 0) == lifts


@pytest.mark.parametrize("frequency", [64.0, 200.0, 512.0])
def test_resonance_of_a_held_robot(frequency):
    damping, amplitude = 0.2 * INNER * 2.0 * np.pi * 200.0, 1e-7
    keys = {"inner.stiffness": SPRING, "inner.damping": damping, "inner.amplitude": amplitude,
            "inner.frequency": frequency, "drive.pulses": 220}  # fmt: skip
    of = run(HELD, EXACT, keys, rate=64 * frequency)
    omega = 2.0 * np.pi * frequency
    late = slice(200 * 64, 220 * 64)
    turns = np.exp(-1j * omega * of.t[late])
    response = -1j * amplitude / (SPRING - INNER * omega**2 + 1j * omega * damping)
    for found, expected in ((of.inner_place, response), (of.inner_velocity, 1j * omega * response)):
        assert 2.0 * np.mean(found[late] * turns) == pytest.approx(expected, rel=1e-8)
    assert of.x[-1] == of.x[0]


def test_weight_hangs_on_the_spring():
    down = {"inner.direction": np.pi / 2, "inner.stiffness": SPRING}
    of = run(HELD, EXACT, {**down, "inner.damping": 2e-5, "drive.pulses": 20}, rate=1e3)
    assert of.inner_place[-1] == pytest.approx(INNER * GRAVITY / SPRING, rel=1e-9)
    assert of.normal_force[-1] == pytest.approx((MASS + INNER) * GRAVITY + 1e-3, rel=1e-9)


def test_momentum_and_energy_without_friction():
    damping = 1e-6
    keys = {"inner.stiffness": SPRING, "inner.damping": damping, "inner.amplitude": 3e-7,
            "inner.harmonic_2": 0.5, "inner.phase_2": 0.7}  # fmt: skip
    of = run(BALL, EXACT, keys, rate=2.0**20)
    v, q, u = of.vx, of.inner_place, of.inner_velocity
    assert MASS * v + INNER * (v + u) == pytest.approx(0.0, abs=1e-9 * MASS * np.abs(v).max())
    energy = 0.5 * MASS * v**2 + 0.5 * INNER * (v + u) ** 2 + 0.5 * SPRING * q**2
    force = 3e-7 * (np.sin(RATE * of.t) + 0.5 * np.sin(2 * RATE * of.t + 0.7))
    power = force * u - damping * u**2
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(of.t))])
    assert energy == pytest.approx(work, abs=1e-6 * energy.max())


@pytest.mark.parametrize("damped", [0.0, 0.1, 0.4])
def test_restitution_of_a_stop(damped):
    # Thrown to the stop by one pulse; it leaves where it presses no more: Schwager and Poeschel,
    # Granular Matter 9, 465 (2007).
    stiffness = INNER * (2.0 * np.pi * 5e4) ** 2
    beta = damped * np.sqrt(stiffness / INNER)
    keys = {"inner.amplitude": 1e-6, "inner.duty": 0.05, "inner.stop_high": 20e-6,
            "inner.stop_low": -1e-3, "inner.stop_stiffness": stiffness, "drive.pulses": 1,
            "inner.stop_damping": 2.0 * INNER * beta}  # fmt: skip
    of = run(HELD, EXACT, keys, rate=1e6)
    omega = np.sqrt(stiffness / INNER - beta**2)
    left = np.pi - np.arctan2(2.0 * beta * omega, omega**2 - beta**2)
    before, after = of.inner_velocity.max(), of.inner_velocity[-1]
    assert before == pytest.approx(1e-6 / INNER * 0.05 / FREQUENCY, rel=1e-9)
    assert -after / before == pytest.approx(np.exp(-beta / omega * left), rel=1e-8)


def test_a_mirrored_drive_moves_it_the_other_way():
    keys = {"inner.stiffness": SPRING, "inner.damping": 3e-7, "inner.amplitude": 4e-7,
            "inner.harmonic_2": 0.5, "inner.phase_2": 1.0, "inner.stop_high": 8e-6,
            "inner.stop_low": -1e-3, "inner.stop_stiffness": 100.0 * SPRING}  # fmt: skip
    ahead, back = run(keys), run(keys, {"drive.direction": "-x"})
    turned = {"inner.direction": np.pi, "inner.phase": 0.0}
    assert back.mean_velocity == -ahead.mean_velocity != 0.0
    assert run(keys, turned).mean_velocity == pytest.approx(-ahead.mean_velocity, rel=1e-6)


def test_whole_plane_is_refused():
    with pytest.raises(ScenarioError, match=r"^inner\.mass: it moves in the plane y = 0"):
        scenario({"inner.mass": 1e-9, "drive.heading": 1.0})


def test_what_an_inner_mass_lacks_is_said_with_its_size():
    keys = {"inner.direction": np.pi / 2, "inner.stiffness": SPRING, "inner.amplitude": 1e-6}
    (note,) = [each for each in run(keys).notes if each.code == "inner"]
    assert note.value == pytest.approx(0.4)
    assert not [each for each in run({"inner.amplitude": 1e-7}).notes if each.code == "inner"]
    with pytest.raises(AttributeError, match="no inner mass"):
        _ = simulate(scenario({"record.rate": 1e3, "drive.pulses": 1})).inner_place
