"""A surface that moves: closed forms of what a body on it does, in the ground's frame."""

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers import ADHESION, FLIGHT, GRAVITY, HEIGHT, MASS, friction, scenario
from stickslip import Accelerations, Coils, ScenarioError, Shake, load, simulate
from stickslip.scenario.keys import keys_of

FREQUENCY = 128.0  # Hz; times of periods are exact
RATE = 2.0 * np.pi * FREQUENCY
FREE = {"drive.mode": "none", "drive.pulses": 6, "shake.frequency": FREQUENCY,
        "drag.linear": 0.0, "drag.rotational": 0.0}  # fmt: skip
EXACT = {"solver.rtol": 1e-12}
MU = 0.2
HOLD = MU * (GRAVITY + ADHESION / MASS)  # m/s^2, at which static friction gives way


def along(acceleration, **more):
    """Amplitude of a sine along x, or with axis="z", from that of its acceleration."""
    axis = more.get("axis", "x")
    return {f"shake.amplitude_{axis}": acceleration / RATE**2}


def run(*changes, **record):
    found = simulate(scenario(FREE, *changes, {f"record.{k}": v for k, v in record.items()}))
    assert found.ok, found.message
    return found


def surface(keys, t):
    """Place, velocity and acceleration along x at times t, by the definition of the keys."""
    made = scenario(FREE, keys).shake.as_dict()
    s, v, a = 0.0, 0.0, 0.0
    for k in (1, 2, 3, 4):
        size = made["amplitude_x"] * made.get(f"harmonic_{k}_x", 1.0)
        phase = made.get(f"phase_{k}_x", 0.0)
        angle = k * RATE * t + phase
        s = s + size * (np.sin(angle) - np.sin(phase))
        v = v + size * k * RATE * np.cos(angle)
        a = a - size * (k * RATE) ** 2 * np.sin(angle)
    return s, v, a


ASYMMETRIC = {
    "shake.amplitude_x": 60e-6, "shake.harmonic_2_x": 0.4, "shake.phase_2_x": 1.1,
    "shake.harmonic_3_x": 0.1, "shake.phase_3_x": -0.4,
}  # fmt: skip


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize(("part", "slips"), [(1.0 - 1e-9, False), (1.0 + 1e-9, True)])
def test_slip_begins_where_friction_holds_no_more(part, slips, direction):
    of = run(friction(MU, 0.15), along(part * HOLD), {"drive.direction": direction})
    assert (of.summary()["events"]["slip_start"] > 0) == slips


@pytest.mark.parametrize("adhesion", [0.0, ADHESION])
@pytest.mark.parametrize(("part", "lifts"), [(1.0 - 1e-9, False), (1.0 + 1e-9, True)])
def test_a_face_leaves_where_the_surface_falls_too_fast(part, lifts, adhesion):
    pull = {"contact.adhesion": adhesion}
    of = run(pull, along(part * (GRAVITY + adhesion / MASS), axis="z"))
    assert (of.summary()["events"]["lift_off"] + of.summary()["events"]["tip"] > 0) == lifts


def test_flight_and_landing_are_a_parabola_in_the_ground():
    of = run({"contact.adhesion": 0.0}, EXACT, along(2.0 * GRAVITY, axis="z"), rate="events")
    off = np.arcsin(0.5) / RATE  # -a_z = g first
    amplitude = 2.0 * GRAVITY / RATE**2
    z, vz = amplitude * 0.5, amplitude * RATE * np.cos(RATE * off)

    def gap(t):
        return z + vz * (t - off) - 0.5 * GRAVITY * (t - off) ** 2 - amplitude * np.sin(RATE * t)

    landed = brentq(gap, off + 0.25 / FREQUENCY, off + 0.9 / FREQUENCY, xtol=1e-15)
    assert of.t[of.contact == FLIGHT][0] == pytest.approx(off, abs=1e-12)
    down = int(np.argmax(of.event == of.event_names.index("touch_down")))
    assert of.t[down] == pytest.approx(landed, abs=1e-11)
    assert of.z[down] == pytest.approx(HEIGHT / 2 + amplitude * np.sin(RATE * landed), abs=1e-13)


def slipping(keys, friction_acceleration, periods):
    """Place in the ground (m) at the ends of periods of a body that slips all the time.

    It begins at rest on the surface, and friction acts against the slip.
    """
    mu_g = friction_acceleration
    t, x, v = 0.0, 0.0, surface(keys, 0.0)[1]
    way = -np.sign(surface(keys, 0.0)[2]) or -1.0
    ends, places = np.arange(1, periods + 1) / FREQUENCY, []

    def slip(later):
        return v - way * mu_g * (later - t) - surface(keys, later)[1]

    def moved(later):
        return x + v * (later - t) - 0.5 * way * mu_g * (later - t) ** 2

    while len(places) < periods:
        grid = t + np.linspace(1e-4, 1.2, 4000) / FREQUENCY
        sign = way * slip(grid)
        first = int(np.argmax(sign < 0.0))
        assert first > 0
        stop = brentq(slip, grid[first - 1], grid[first], xtol=1e-16)
        while len(places) < periods and ends[len(places)] <= stop:
            places.append(moved(ends[len(places)]))
        x, v, t, way = moved(stop), v - way * mu_g * (stop - t), stop, -way
        assert way * surface(keys, t)[2] < -mu_g  # the slip reverses without a stop
    return places


def test_drift_of_pure_slip():
    mu = 0.02
    of = run(friction(mu), {"contact.adhesion": 0.0, "drive.pulses": 10}, EXACT, ASYMMETRIC)
    places = slipping(ASYMMETRIC, mu * GRAVITY, 10)
    expected = (places[-1] - places[2]) * FREQUENCY / 7
    assert abs(expected) > 1e-4
    assert of.mean_velocity == pytest.approx(expected, rel=1e-8)


def test_a_mirrored_shake_moves_it_the_other_way():
    ahead = run(ASYMMETRIC)
    mirrored = {**ASYMMETRIC, "shake.amplitude_x": -60e-6, "drive.direction": "-x"}
    assert run(mirrored).mean_velocity == -ahead.mean_velocity != 0.0


def test_energy_that_the_surface_gives_is_that_of_the_motion():
    keys = {
        **ASYMMETRIC,
        **along(0.9 * GRAVITY, axis="z"),
        "contact.adhesion": 0.0,
        "shake.phase": 0.7,
    }
    of = run(friction(0.3, 0.2), keys, EXACT, rate=2.0**21)
    kinetic = 0.5 * MASS * (of.vx**2 + of.vz**2)
    height = MASS * GRAVITY * (of.z - of.z[0])
    power = of.friction_force * of.vx + of.normal_force * of.vz
    work = summed(power, of.t)
    assert of.summary()["events"]["tip"] == 0
    gained = kinetic - kinetic[0] + height
    assert np.abs(work - gained).max() < 1e-4 * np.ptp(gained)


def test_the_field_is_that_of_the_place_in_the_ground():
    keys = {
        "drive.mode": "IPP",
        "drive.pulses": 2,
        "shake.frequency": FREQUENCY,
        "shake.amplitude_x": 1e-3,
        "shake.amplitude_z": 2e-4,
        "shake.phase": 1.0,
        "contact.adhesion": 1e-3,
        "record.rate": 5e3,
    }
    of = simulate(scenario(keys))
    assert np.ptp(of.x) == pytest.approx(2e-3, rel=1e-2)
    field = np.array(
        [Coils().field([x, 0.0, z], i) for x, z, i in zip(of.x, of.z, of.current, strict=True)]
    )
    assert of.bx == pytest.approx(field[:, 0], abs=1e-9 * np.abs(field).max())
    assert of.bz == pytest.approx(field[:, 2], abs=1e-9 * np.abs(field).max())
    size = np.hypot(field[:, 0], field[:, 2])
    assert size.max() * (1 - 1e-9) <= of.summary()["field_max"] <= size.max() * 1.01


@pytest.mark.parametrize(("liquid", "carried"), [("moves", True), ("rests", False)])
def test_drag_is_against_the_liquid(liquid, carried):
    keys = {**friction(0.0), "drag.linear": 1e-4, "shake.liquid": liquid, "drive.pulses": 40,
            "shake.amplitude_x": 1e-4}  # fmt: skip
    of = run(keys, EXACT, rate=FREQUENCY * 64)
    late = of.t > 30 / FREQUENCY
    # Driven through the drag alone, after its start has died away: i omega v = c (v_s - v) / m.
    share = 1.0 / np.hypot(1.0, RATE * MASS / 1e-4)
    assert np.ptp(of.x[late]) == pytest.approx(2e-4 * share * carried, rel=2e-3, abs=1e-9)


def summed(values, t):
    """Integral over t by the trapezoidal rule, from zero."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))])


def test_accelerations_are_integrated_and_do_not_drift():
    rows = [[0.0, 0.5, 0.0], [1e-3, -1.0, 0.3], [4e-3, 1.0, -0.2], [5e-3, 0.7, 0.1]]
    shaken = Accelerations(rows)
    assert shaken.period == 5e-3
    t = np.linspace(0.0, 5e-3, 200001)
    keys = {
        "drive.mode": "none",
        "drive.pulses": 5,
        "shake.accelerations": shaken,
        "contact.static_friction": 5.0,
        "contact.adhesion": 1e-6,
        "record.rate": 4e4,
    }
    of = simulate(scenario(keys))
    assert of.ok
    for axis, column in (("x", 1), ("z", 2)):
        a = np.interp(t, shaken.rows[:, 0], shaken.rows[:, column])
        mean = summed(a, t)[-1] / 5e-3
        assert shaken.mean[column - 1] == pytest.approx(mean, rel=1e-9)
        v = summed(a - mean, t)
        v -= summed(v, t)[-1] / 5e-3
        s = summed(v, t)
        at = of.t % 5e-3
        place, speed = getattr(of, axis), getattr(of, f"v{axis}")
        assert place - place[0] == pytest.approx(np.interp(at, t, s), abs=1e-5 * np.ptp(s))
        assert speed == pytest.approx(np.interp(at, t, v), abs=1e-5 * np.ptp(v))


def test_accelerations_of_a_sine_move_it_as_the_sine_does():
    t = np.linspace(0.0, 1.0 / FREQUENCY, 2001)
    a = -HOLD * 3.0 * np.sin(RATE * t)
    of_rows = run(
        {"shake.frequency": 100.0},
        {"shake.accelerations": Accelerations(np.c_[t, a, 0 * a])},
        rate=1e4,
    )
    of_sine = run(along(3.0 * HOLD), rate=1e4)
    assert of_rows.x == pytest.approx(of_sine.x, abs=1e-5 * np.ptp(of_sine.x))
    assert of_rows.summary()["events"] == of_sine.summary()["events"]


def test_every_key_survives_a_file(tmp_path):
    keys = {key.name: 0.1 for key in keys_of("shake") if key.kind == "real"}
    made = scenario({**keys, "shake.liquid": "rests"})
    made.to_toml(tmp_path / "a.toml")
    read = load(tmp_path / "a.toml")
    assert read == made
    assert all(read.get(name) == 0.1 for name in keys)
    assert read.shake == Shake(**made.shake.as_dict())


SOME = {"shake.amplitude_x": 1e-6}
NONE = {"drive.mode": "none"}
REFUSED = [
    ({"drive.heading": 1.0, **SOME}, "shake: the surface moves in the plane y = 0"),
    ({**NONE, "drive.peak": 1e-3}, 'drive.peak: not allowed with drive.mode = "none"'),
    ({**NONE, **SOME, "drive.frequency": 3.0}, "drive.frequency: not allowed"),
    (
        {**SOME, "shake.accelerations": Accelerations([[0, 1, 0], [1, 0, 0]])},
        "shake.amplitude_x: not allowed",
    ),
    ({"shake.accelerations": 3.0}, "shake.accelerations = 3.0"),
]


@pytest.mark.parametrize(("keys", "said"), REFUSED, ids=[said[:30] for _, said in REFUSED])
def test_what_is_refused(keys, said):
    with pytest.raises(ScenarioError, match=r"^[^\n]*$") as error:
        scenario(keys)
    assert said in str(error.value)


@pytest.mark.parametrize(
    "rows", [[[0, 1, 0]], [[1, 1, 0], [2, 0, 0]], [[0, 1, 0], [0, 0, 0]], [[0, 1], [1, 0]]]
)
def test_rows_that_are_none(rows):
    with pytest.raises(ScenarioError, match="row"):
        Accelerations(rows)
