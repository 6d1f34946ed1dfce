"""A mass within the body: closed forms of what it does to the robot."""

import numpy as np
import pytest

from helpers import ADHESION, GRAVITY, MASS, friction, scenario
from stickslip import Forces, ScenarioError, _core, load, open_run, simulate

EVENTS = list(_core.events)
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


DOWN = {"inner.direction": np.pi / 2}
# A pulse, and no force from then on: so fast it is thrown to the stop ahead.
THROWN = {"inner.amplitude": 1e-6, "inner.duty": 0.05, "inner.stop_high": 20e-6, "drive.pulses": 1}
SPEED = 1e-6 / INNER * 0.05 / FREQUENCY  # m/s, over the ground
RATIOS = [0.0, 0.3, 1.0]


@pytest.mark.parametrize("ratio", RATIOS)
def test_a_stop_of_a_free_body(ratio):
    of = run(BALL, EXACT, THROWN, {"inner.restitution": ratio}, rate=1e6)
    v, u = of.vx, of.inner_velocity
    before, after = u.max(), u[-1]
    assert before == pytest.approx(SPEED * (1.0 + INNER / MASS), rel=1e-9)
    assert after == pytest.approx(-ratio * before, rel=1e-12)
    assert MASS * v + INNER * (v + u) == pytest.approx(0.0, abs=1e-12 * INNER * before)
    lost = 0.5 * MASS * INNER / (MASS + INNER) * (1.0 - ratio**2) * before**2
    energy = 0.5 * MASS * v**2 + 0.5 * INNER * (v + u) ** 2
    assert energy.max() - energy[-1] == pytest.approx(lost, rel=1e-9, abs=1e-12 * energy.max())


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("steep", [0.3, 1.0 - 1e-6, 1.0 + 1e-6, 3.0])
def test_friction_holds_a_body_within_its_cone(ratio, steep):
    # Downwards by an angle whose tangent is this over mu. Adhesion answers no blow.
    angle = np.arctan(steep / MU)
    keys = {"inner.direction": angle, "inner.restitution": ratio, "environment.gravity": 0.0}
    of = run(HELD, friction(MU), EXACT, THROWN, keys, rate="events")
    if steep > 1.0:
        assert of.final_state.x == 0.0
        return
    along = np.cos(angle)
    pushed = (along - MU * np.sin(angle)) / MASS  # m/s over N s
    blow = (1.0 + ratio) * SPEED / (1.0 / INNER + along * pushed)
    (k,) = np.flatnonzero(of.event == EVENTS.index("slip_start"))[:1]
    assert of.vx[k] == pytest.approx(blow * pushed, rel=1e-9)
    assert of.inner_velocity[k] == pytest.approx(-ratio * SPEED, rel=1e-9, abs=1e-15)


def fallen(t, height, ratio):
    """Depth (m) at time t of a mass that falls by `height` and bounces."""
    first = np.sqrt(2.0 * height / GRAVITY)
    if t < first:
        return 0.5 * GRAVITY * t**2
    begin, speed = first, ratio * GRAVITY * first
    while t > begin + 2.0 * speed / GRAVITY and speed > 1e-6:
        begin, speed = begin + 2.0 * speed / GRAVITY, ratio * speed
    since = t - begin
    return height - max(speed * since - 0.5 * GRAVITY * since**2, 0.0)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 0.9, 1.0])
def test_a_bouncing_mass(ratio):
    keys = {**DOWN, "inner.stop_high": 10e-6, "inner.restitution": ratio, "drive.pulses": 5}
    of = run(HELD, EXACT, keys, rate=2e5)
    expected = [fallen(t, 10e-6, ratio) for t in of.t]
    assert of.inner_place == pytest.approx(expected, abs=1e-10)
    assert of.x[-1] == of.x[0]
    if ratio < 1.0:
        assert (of.inner_place[-1], of.inner_velocity[-1]) == (10e-6, 0.0)
        assert of.normal_force[-1] == pytest.approx((MASS + INNER) * GRAVITY + 1e-3, rel=1e-12)


def test_a_blow_upwards_lifts_the_body():
    keys = {"inner.direction": -np.pi / 2, "inner.restitution": 0.5}
    of = run(EXACT, THROWN, keys, rate="events")
    (k,) = np.flatnonzero(of.event == EVENTS.index("lift_off"))[:1]
    pulse, rise = 0.05 / FREQUENCY, 1e-6 / INNER - GRAVITY
    way = 20e-6 - 0.5 * rise * pulse**2  # after the pulse
    speed = np.sqrt((rise * pulse) ** 2 - 2.0 * GRAVITY * way)
    assert of.inner_velocity[k] == pytest.approx(-0.5 * speed, rel=1e-9)
    assert of.vz[k] == pytest.approx(1.5 * INNER / (MASS + INNER) * speed, rel=1e-9)


PRESSED = {"inner.amplitude": 3e-6, "inner.duty": 1.0, "inner.stop_high": 1e-6}


@pytest.mark.parametrize("ratio", [0.0, 0.5])
def test_a_mass_on_its_stop_is_a_part_of_the_body(ratio):
    flat = {"robot.height": 1e-6, **friction(MU, 0.15), "contact.adhesion": 0.0}
    shake = {"shake.frequency": FREQUENCY, "shake.amplitude_x": 5e-6, "shake.harmonic_2_x": 0.4}
    inner = run(flat, EXACT, shake, PRESSED, {"inner.restitution": ratio}, rate=1e5)
    alone = run(flat, EXACT, shake, {"inner.mass": 0.0, "robot.mass": MASS + INNER}, rate=1e5)
    late = inner.t > 2.0 / FREQUENCY
    assert set(inner.inner_place[late]) == {1e-6}
    assert inner.vx[late] == pytest.approx(alone.vx[late], abs=1e-9)


@pytest.mark.parametrize(("part", "slips"), [(1.0 - 1e-9, False), (1.0 + 1e-9, True)])
def test_slip_begins_with_the_mass_on_its_stop(part, slips):
    # Down on its stop from the start, so that nothing strikes.
    hold = MU * (GRAVITY + ADHESION / (MASS + INNER))
    keys = {"inner.stop_low": 0.0, "inner.amplitude": -1e-6, "inner.duty": 1.0, "drive.pulses": 1,
            "shake.frequency": FREQUENCY, "shake.amplitude_x": part * hold / RATE**2}  # fmt: skip
    of = run(friction(MU, 0.15), keys)
    assert (of.summary()["events"]["slip_start"] > 0) == slips


def test_it_lets_go_where_it_presses_no_more():
    of = run(HELD, EXACT, {"inner.stop_low": -1e-6, "inner.amplitude": -1e-7}, rate=1e6)
    # Pressed to the stop behind until the sine turns; thrown from there on.
    turns = of.t > 0.5 / FREQUENCY
    t = of.t[turns & (of.t < 0.8 / FREQUENCY)] - 0.5 / FREQUENCY
    way = 1e-7 / INNER / RATE * (t - np.sin(RATE * t) / RATE)
    assert of.inner_place[turns][: len(t)] + 1e-6 == pytest.approx(way, rel=1e-6, abs=1e-14)


def test_a_mirrored_drive_moves_it_the_other_way():
    keys = {"inner.stiffness": SPRING, "inner.damping": 3e-7, "inner.amplitude": 4e-7,
            "inner.harmonic_2": 0.5, "inner.phase_2": 1.0, "inner.stop_high": 8e-6,
            "inner.restitution": 0.4}  # fmt: skip
    ahead, back = run(keys), run(keys, {"drive.direction": "-x"})
    turned = {"inner.direction": np.pi, "inner.phase": 0.0}
    assert back.mean_velocity == -ahead.mean_velocity != 0.0
    assert run(keys, turned).mean_velocity == pytest.approx(-ahead.mean_velocity, rel=1e-6)


def test_forces_by_rows(tmp_path):
    # A triangle on a held mass: its velocity is the sum below the straight lines.
    rows = np.array([[0.0, 0.0], [2e-3, 4e-8], [5e-3, -3e-8], [8e-3, 0.0]])
    forces = Forces(rows)
    keys = {"inner.frequency": 100.0, "inner.forces": forces, "drive.pulses": 3}
    of = run(HELD, EXACT, keys, rate=4e3)
    assert of.t[-1] == pytest.approx(24e-3, rel=1e-12)
    gained = np.concatenate(
        [[0], np.cumsum(np.diff(rows[:, 0]) * (rows[1:, 1] + rows[:-1, 1]) / 2)]
    )
    for time, impulse in zip(rows[:, 0], gained, strict=True):
        at = np.isclose(of.t, 8e-3 + time, rtol=0.0, atol=1e-9)
        expected = (impulse + gained[-1]) / INNER
        assert of.inner_velocity[at] == pytest.approx([expected], rel=1e-9, abs=1e-12)
    of.scenario.to_toml(tmp_path / "a.toml")
    assert (tmp_path / "a.forces.csv").exists()
    read = load(tmp_path / "a.toml")
    assert (read, hash(read)) == (of.scenario, hash(of.scenario))
    of.save(tmp_path / "a.nc")
    assert open_run(tmp_path / "a.nc").scenario == of.scenario
    assert read.replace({"inner.forces": None}).inner.forces is None


ROWS = Forces([[0.0, 1.0], [1.0, 0.0]])
REFUSED = [
    ({"drive.heading": 1.0}, "inner.mass: it moves in the plane y = 0"),
    ({"inner.stop_low": 0.0, "inner.stop_high": 0.0}, "inner.stop_low = 0 with inner.stop_high"),
    ({"inner.forces": ROWS, "inner.duty": 0.5}, "inner.duty: not allowed with inner.file"),
    ({"inner.forces": 3.0}, "inner.forces = 3.0"),
    ({"initial.inner_place": 1e-5, "inner.stop_high": 1e-6}, "initial.inner_place = 1e-05"),
]


@pytest.mark.parametrize(("keys", "said"), REFUSED, ids=[said[:30] for _, said in REFUSED])
def test_what_is_refused(keys, said):
    with pytest.raises(ScenarioError, match=r"^[^\n]*$") as error:
        scenario({"inner.mass": 1e-9, **keys})
    assert said in str(error.value)


@pytest.mark.parametrize("rows", [[[0, 1]], [[1, 1], [2, 0]], [[0, 1], [0, 0]], [[0, 1, 2]]])
def test_rows_that_are_none(rows):
    with pytest.raises(ScenarioError, match="row"):
        Forces(rows)


def test_what_an_inner_mass_lacks_is_said_with_its_size():
    keys = {"inner.direction": np.pi / 2, "inner.stiffness": SPRING, "inner.amplitude": 1e-6}
    (note,) = [each for each in run(keys).notes if each.code == "inner"]
    assert note.value == pytest.approx(0.4)
    assert not [each for each in run({"inner.amplitude": 1e-7}).notes if each.code == "inner"]
    with pytest.raises(AttributeError, match="no inner mass"):
        _ = simulate(scenario({"record.rate": 1e3, "drive.pulses": 1})).inner_place
