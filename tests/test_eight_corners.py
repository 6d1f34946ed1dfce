"""The reference for the robot that turns: its parts, answers that can be derived, and the core."""

import json

import numpy as np
import pytest

from helpers import program_of
from reference import eight_corners
from reference.cone import solve_cone
from reference.corner_contact import new_memory
from reference.corner_step import new_motion
from reference.drive import Voltages, voltages_of
from reference.heading import Heading, constant, heading_voltages
from reference.simulate import CONTACT_DEFAULTS
from reference.steering_table import FAST_OPP, FILE, IPP, OPP, SLOW, rows
from reference.walk import WHOLE_EDGES, block_of, run_corners, walk
from stickslip import Drive, Scenario, simulate

GRAVITY = 9.81  # m/s^2
SHORT = {**IPP, "pulses": 5}

# The kernel takes 11 s to compile, and then less than a second for a walk.
needs_kernel = pytest.mark.nightly
TABLE = {entry["name"]: entry for entry in json.loads(FILE.read_text())["walks"]}


def _solved(w, b, mu):
    """Impulses (n, 3) and velocities (n, 3) of contacts with these W, b and mu."""
    n = len(mu)
    full, right, limits = np.zeros((24, 24)), np.zeros(24), np.zeros(8)
    full[: 3 * n, : 3 * n], right[: 3 * n], limits[:n] = w, b, mu
    p = np.zeros(24)
    room = np.zeros(8), np.zeros(24), np.zeros((24, 24)), np.zeros(24)
    assert solve_cone(full, right, limits, n, p, *room) != 2
    return p[: 3 * n].reshape(n, 3), (w @ p[: 3 * n] + b).reshape(n, 3)


@pytest.mark.nightly
def test_cone_conditions_hold_for_random_bodies():
    random = np.random.default_rng(3)
    for _ in range(200):
        n = int(random.integers(1, 5))
        root = random.normal(size=(3 * n, 3 * n))
        mu = random.uniform(0.05, 0.8, n)
        w = root @ root.T + 0.3 * np.eye(3 * n)
        p, u = _solved(w, random.normal(size=3 * n), mu)
        tangential, slip = p[:, :2], u[:, :2]
        assert np.all(p[:, 2] >= 0.0)
        assert np.all(u[:, 2] >= -1e-7)
        assert p[:, 2] * u[:, 2] == pytest.approx(0.0, abs=1e-7)
        size, limit = np.hypot(*tangential.T), mu * p[:, 2]
        assert np.all(size <= limit + 1e-7)
        # Friction is against the slip and, where there is any, as large as it can be.
        assert np.sum(tangential * slip, axis=1) == pytest.approx(
            -limit * np.hypot(*slip.T), abs=1e-6
        )


def test_voltages_follow_a_heading_that_turns():
    turn = Heading((0.1, 0.13), (0.0, np.radians(90.0)))
    volts, planar = heading_voltages(IPP, turn), voltages_of(IPP)
    t = np.linspace(0.001, 0.24, 1234)

    def at(program):
        k = np.searchsorted(program.start, t, side="right") - 1
        return program.level[k] + program.slope[k] * (t - program.start[k])[:, None]

    # Of the two coils of an axis, alike, the sum makes the field.
    found = np.stack([at(volts)[:, :2].sum(axis=1), at(volts)[:, 2:4].sum(axis=1)], axis=1)
    expected = at(planar)[:, :1] * np.stack([np.cos(turn(t)), np.sin(turn(t))], axis=1)
    # Sawtooth and heading both change between two points: a quarter of the product of the changes.
    assert found == pytest.approx(expected, abs=3e-5 * np.abs(expected).max())


def _at_rest(block, seconds):
    """No voltage for `seconds`; a body that lies at rest at the origin; its memory."""
    volts = Voltages(np.zeros(1), np.zeros((1, 5)), np.zeros((1, 5)), 0.0, seconds, seconds)
    return volts, new_motion((0.0, 0.0, block.half_sizes[2])), new_memory()


@needs_kernel
def test_spin_on_a_face_stops_by_the_friction_of_four_corners():
    block = block_of()
    volts, now, memory = _at_rest(block, 4e-3)
    rate = 150.0
    now["spin"][2], now["momentum"][2] = rate, block.inertia[2] * rate
    memory["slipping"] = memory["touching"]
    samples = run_corners(block, volts, now, 1e5, memory=memory)[2]
    load = block.mass * GRAVITY + block.adhesion
    torque = block.mu_kinetic * load * np.hypot(*block.half_sizes[:2])
    # J omega d omega / d psi = -(friction + drag), the latter with omega^2.
    drag = block.drag_rotational
    angle = block.inertia[2] / (2 * drag) * np.log1p(drag * rate**2 / torque)
    assert samples[-1, eight_corners.HEADING] == pytest.approx(angle, rel=1e-4)
    assert np.abs(samples[-1, :2]) == pytest.approx(0.0, abs=1e-15)


@needs_kernel
@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_energy_of_a_tumbling_body_never_grows(restitution):
    random = np.random.default_rng(5)
    block = block_of(contact={"restitution": restitution})
    volts, now, memory = _at_rest(block, 0.03)
    quaternion = random.normal(size=4)
    now = new_motion((0.0, 0.0, 4e-4), quaternion / np.linalg.norm(quaternion))
    now["velocity"] = random.normal(size=3) * 0.02
    memory["touching"] = 0
    counts, samples = run_corners(block, volts, now, 1e5, memory=memory)[1:]
    energy = samples[1:, eight_corners.ENERGY]
    assert np.diff(energy).max() <= 1e-12 * (energy[0] - energy[-1])
    assert counts["landings"] > counts["leavings"] > 0
    assert samples[-1, eight_corners.CORNERS_DOWN] == 4


def _core_speed(drive, coils, contact):
    """Mean velocity of the planar core under the five voltages of heading 0, m/s."""
    volts = heading_voltages(drive, constant(0.0), coils)
    scenario = Scenario(drive=Drive(mode="program", program=program_of(volts))).replace(
        {"record.rate": 2e4, **{f"contact.{key}": value for key, value in contact.items()}}
    )
    done = simulate(scenario)
    assert done.ok, done.message
    begin, end = np.interp([volts.first_counted, volts.last_counted], done.t, done.x)
    return (end - begin) / (volts.last_counted - volts.first_counted)


@needs_kernel
@pytest.mark.parametrize(
    ("drive", "coils", "contact"),
    [(IPP, "single", {}), (IPP, "pairs", {}), (OPP, "single", {}), (OPP, "pairs", {}),
     (SLOW, "single", {}),
     (FAST_OPP, "single", {}),
     (OPP, "single", {"static_friction": 0.8, "kinetic_friction": 0.58}),
     (IPP, "single", {"restitution": 0.3}),
     (IPP, "single", {"adhesion": 0.0}),
     (SLOW, "pairs", {"static_friction": 0.1, "kinetic_friction": 0.1})],
)  # fmt: skip
def test_planar_walks_are_those_of_the_core(drive, coils, contact):
    # At 1 us the reference errs by up to 7e-4.
    expected, found = _core_speed(drive, coils, contact), walk(drive, 0.0, coils, contact=contact)
    assert found.along == pytest.approx(expected, rel=1.5e-3)
    assert abs(found.across) < 1e-9 * abs(found.along)


@needs_kernel
def test_error_is_of_first_order_in_the_step():
    lengths = 4e-9 / 2.0 ** np.arange(4)
    speeds = np.array([walk(IPP, np.radians(15.0), shortest=h).along for h in lengths])
    finest = 2 * speeds[-1] - speeds[-2]
    assert np.abs(speeds - finest) / finest == pytest.approx(6e-5 / 2.0 ** np.arange(4), abs=3e-5)


def test_stored_table_is_what_the_script_describes():
    described = dict(rows())
    assert list(TABLE) == list(described)
    for name, arguments in described.items():
        entry = TABLE[name]
        assert entry["heading"]["angles"] == pytest.approx(arguments["heading"].angles)
        assert entry["coils"] == arguments.get("coils", "single")
        assert entry["place"] == list(arguments.get("place", (0.0, 0.0)))
        assert entry["contact"] == {**CONTACT_DEFAULTS, **arguments.get("contact", {})}
        assert {key: entry["drive"][key] for key in arguments["drive"]} == arguments["drive"]


def test_stored_errors_are_below_a_percent():
    for name, entry in TABLE.items():
        for kind in ("whole", "sharp"):
            result = entry[kind]
            speed = np.hypot(result["values"]["along"], result["values"]["across"])
            for key in ("along", "across"):
                assert result["errors"][key] < 0.01 * speed, (name, kind)
            assert result["counts"]["unsolved"] == 0, (name, kind)


@needs_kernel
@pytest.mark.parametrize(("kind", "reach"), [("whole", WHOLE_EDGES), ("sharp", 0.0)])
@pytest.mark.parametrize(
    "name", ["IPP 30", "OPP 20, at (5, -7) mm", "IPP turn 0 to 90 in 5 pulses"]
)
def test_stored_walks_can_be_made_again(name, kind, reach):
    entry, found = TABLE[name][kind], walk(**dict(rows())[name], reach=reach)
    for key in ("along", "across"):
        # Errors of first order: at the coarsest step four times that of the finest, and more.
        allowed = 3 * entry["errors"][key] + 1e-7
        assert getattr(found, key) == pytest.approx(entry["values"][key], abs=allowed)
