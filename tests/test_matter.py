"""Robots of a material, and liquids that they lie in."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers import FLIGHT
from stickslip import Coil, Robot, Scenario, load, simulate
from stickslip.scenario.matter import LIQUIDS, MATERIALS, left_out, wall_factors

OIL = "silicone oil 100 cSt"
SIZE = (250e-6, 130e-6, 100e-6)

# Goldman, Cox and Brenner (1967), exact: height of the centre in radii, drag and torque over those
# far from the wall.
EXACT = [
    (10.0677, 1.0591, 1.0003), (3.7622, 1.1738, 1.0059), (2.3524, 1.3079, 1.0250),
    (1.5431, 1.5675, 1.0998), (1.1276, 2.1514, 1.3877), (1.0453, 2.6475, 1.7004),
    (1.005004, 3.7863, 2.5056), (1.003202, 4.0223, 2.6792),
]  # fmt: skip


@pytest.mark.parametrize(("height", "drag", "torque"), EXACT)
def test_the_factors_of_a_wall_are_near_the_exact_ones(height, drag, torque):
    along, turning = wall_factors(height - 1.0)
    assert along == pytest.approx(drag, rel=0.05)
    assert turning == pytest.approx(torque, rel=0.08)


def test_every_block_has_drag_in_every_fluid():
    random = np.random.default_rng(4)
    for _ in range(200):
        robot = Robot.of(*10.0 ** random.uniform(-6.0, -1.0, 3), density=7500.0, magnetization=1e6)
        liquid = str(random.choice(list(LIQUIDS)))
        wall = bool(random.integers(2)) or float(10.0 ** random.uniform(-10.0, -1.0))
        found = Scenario(robot=robot).in_fluid(liquid, wall=wall)
        assert found.drag.linear > 0.0
        assert found.get("effects.rotational_drag.coefficient") > 0.0
        assert 0.0 < found.environment.gravity < 9.81


@pytest.mark.parametrize("material", MATERIALS)
def test_a_robot_has_the_mass_and_moment_of_its_material(material):
    density, remanence, _ = MATERIALS[material]
    robot = Robot.of(*SIZE, material=material)
    assert robot.mass == pytest.approx(density * math.prod(SIZE), rel=1e-12)
    assert robot.magnetization == pytest.approx(remanence / 1.25663706e-6, rel=1e-8)
    assert not [note for note in simulate(Scenario(robot=robot)).notes if note.code == "moment"]
    other = Robot.of(*SIZE, material=material, magnetization=5e5)
    assert (other.mass, other.magnetization) == (robot.mass, 5e5)


def test_a_file_takes_the_words_of_a_robot_and_of_coils_beside_their_keys(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text(
        "stickslip = 1\n[drive]\n[robot]\nlength = 400e-6\nwidth = 200e-6\nheight = 150e-6\n"
        'material = "SmCo5"\nmass = 9e-8\n[coil]\nfield_per_ampere = 0.8e-3\ndistance = 0.06\n'
        "radius = 0.04\nresistance = 6\nrise_time = 4e-3\n[coil.clamp]\nresistance = 7\n"
    )
    robot = Robot.of(400e-6, 200e-6, 150e-6, material="SmCo5")
    coil = Coil.of(
        field_per_ampere=0.8e-3, distance=0.06, radius=0.04, resistance=6.0, rise_time=4e-3
    )
    own = {"robot.mass": 9e-8, "coil.clamp.resistance": 7.0}
    assert load(file) == Scenario(robot=robot, coil=coil).replace(own)


def test_a_fluid_is_plain_keys_and_may_be_set_again(tmp_path):
    oil = Scenario().in_fluid(OIL)
    oil.to_toml(tmp_path / "oil.toml")
    again = load(tmp_path / "oil.toml")
    assert (again, again.fluid) == (oil, oil.fluid)
    far = Scenario().in_fluid(OIL, wall=False)
    far.to_toml(tmp_path / "far.toml")
    assert load(tmp_path / "far.toml").fluid == far.fluid
    assert oil.in_fluid("water") == Scenario().in_fluid("water")
    assert oil.in_fluid("water", viscosity=2e-3).drag.linear == pytest.approx(
        2e-3 / LIQUIDS["water"].viscosity * Scenario().in_fluid("water").drag.linear
    )


def test_a_file_may_name_a_fluid_and_has_the_last_word(tmp_path):
    head = 'stickslip = 1\n[drive]\n[fluid]\nname = "water"\n'
    (tmp_path / "s.toml").write_text(head + "wall = 1e-5\n[robot]\nwidth = 2e-4\n")
    expected = Scenario(robot=Robot(width=2e-4)).in_fluid("water", wall=1e-5)
    found = load(tmp_path / "s.toml")
    assert (found, found.fluid) == (expected, expected.fluid)
    (tmp_path / "s.toml").write_text(head + "[drag]\nlinear = 1e-6\n")
    own = load(tmp_path / "s.toml")
    assert own.drag.linear == 1e-6
    assert own.environment == Scenario().in_fluid("water").environment
    assert any(note.code == "fluid" for note in simulate(own.replace({"drive.pulses": 5})).notes)


def in_flight(wall):
    """A block of Table II that falls and turns in oil, without field."""
    start = {"initial.z": 2e-3, "initial.omega": 50.0, "initial.contact": "flight"}
    still = {"drive.peak": 0.0, "drive.hold": 0.0, "robot.magnetization": 0.0}
    ends = {"drive.pulses": 4, "drive.ramp": 0.0, "record.rate": 1e4}
    scenario = Scenario().in_fluid(OIL, wall=wall).replace({**start, **still, **ends})
    return scenario, simulate(scenario)


@pytest.mark.parametrize("wall", [False, True, 1e-5])
def test_a_block_falls_and_turns_in_oil_as_in_closed_form(wall):
    scenario, run = in_flight(wall)
    robot = scenario.robot
    radius = (0.75 * math.prod(SIZE) / math.pi) ** (1 / 3)
    along, turning = wall_factors(wall / radius) if wall else (1.0, 1.0)
    if wall is True:
        along, turning = wall_factors(1.5e-6 / radius)
    viscosity = 100e-6 * 965.0
    slowing = 6.0 * math.pi * viscosity * radius * along / robot.mass
    pull = 9.81 * (1.0 - 965.0 * math.prod(SIZE) / robot.mass)
    inertia = robot.mass * (robot.length**2 + robot.height**2) / 12.0
    stopping = 8.0 * math.pi * viscosity * radius**3 * turning / inertia
    flying = run.contact == FLIGHT
    assert flying.sum() > 300
    t = run.t[flying]
    shed = -np.expm1(-slowing * t) / slowing
    fallen = pull / slowing * (t - shed)
    assert 2e-3 - run.z[flying] == pytest.approx(fallen, rel=1e-6, abs=1e-12)
    turned = -50.0 / stopping * np.expm1(-stopping * t)
    assert run.theta[flying] == pytest.approx(turned, rel=1e-6, abs=1e-12)


def test_in_water_a_note_says_how_much_is_left_out():
    scenario = Scenario().in_fluid("water").replace({"drive.base": 0.5e-3, "drive.pulses": 12})
    run = simulate(scenario)
    note = next(note for note in run.notes if note.code == "fluid")
    # By hand: a layer of sqrt(2 nu / omega) = 56.5 um around a sphere of 91.9 um.
    assert "163 % to the drag" in note.text
    assert "24 % to the mass" in note.text
    face = SIZE[0] * SIZE[1] * 1.002e-3 / 1.5e-6  # Eq. (16)
    assert note.value == pytest.approx(face / scenario.drag.linear)
    assert not any(n.code == "fluid" for n in simulate(Scenario()).notes)
    oil = Scenario().in_fluid("silicone oil 1000 cSt", wall=False)
    quiet = simulate(oil.replace({"drive.frequency": 5.0, "drive.pulses": 4}))
    assert not any(n.code == "fluid" for n in quiet.notes)


# Reynolds numbers and drag coefficients of smooth spheres as they were measured; a table of the
# standard curve (Indiana University of Pennsylvania, CalcDEMma).
MEASURED = [
    (0.4786, 58.88), (3.020, 10.86), (7.015, 5.623), (15.49, 3.388), (57.54, 1.479),
    (144.5, 0.9204), (264.9, 0.7194), (512.9, 0.5623),
]  # fmt: skip


@pytest.mark.parametrize(("reynolds", "coefficient"), MEASURED)
def test_what_a_steady_motion_meets_beyond_stokes_is_what_was_measured(reynolds, coefficient):
    water = Scenario().in_fluid("water", wall=False)
    density, viscosity, _ = LIQUIDS["water"]
    radius = (0.75 * math.prod(SIZE) / math.pi) ** (1 / 3)
    speed = reynolds * viscosity / (2.0 * radius * density)
    measured = 0.5 * coefficient * density * math.pi * radius**2 * speed**2
    beyond = left_out(water.fluid, water.robot, 0.0, speed).inertia
    assert measured / (water.drag.linear * speed) == pytest.approx(1.0 + beyond, rel=0.11)


def test_a_fall_in_water_is_too_fast_by_what_the_drag_curve_says():
    """Schiller and Naumann (1933) beside Stokes: the error of the model, by its own number."""
    water = Scenario().in_fluid("water", wall=False)
    density, viscosity, _ = LIQUIDS["water"]
    weight = water.robot.mass * water.environment.gravity
    stokes = weight / water.drag.linear
    radius = (0.75 * math.prod(SIZE) / math.pi) ** (1 / 3)

    def pull(speed):
        reynolds = 2.0 * radius * speed * density / viscosity
        area = math.pi * radius**2
        drag = 24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687)
        return 0.5 * drag * density * area * speed**2 - weight

    curve = brentq(pull, 1e-6, stokes)
    beyond = left_out(water.fluid, water.robot, 0.0, curve)
    assert stokes / curve == pytest.approx(1.0 + beyond.inertia, rel=1e-9)
    assert stokes / curve > 1.5  # it is no small one
