"""Notes on scenarios that are hardly meant so, and none on sound ones."""

import numpy as np
import pytest

from stickslip import Drive, Scenario, Waveform, simulate
from stickslip.simulation.scenario_notes import field_swing, scenario_notes

WEIGHT = 25.6e-9 * 9.81

# One key of each is nonsense with the others at their defaults; the note has the text.
NONSENSE = [
    ({"robot.mass": 25.6e-6}, "robot.mass = 2.56e-05 kg makes a density of 7.88e+06 kg/m3: is"),
    ({"robot.mass": 25.6e-12}, "robot.mass = 2.56e-11 makes a density of 7.88 kg/m3"),
    ({"robot.length": 25e-3}, "density of 78.8 kg/m3"),
    ({"robot.height": 1e-6}, "density of 7.88e+05 kg/m3"),
    ({"robot.width": 0.13}, "density of 7.88 kg/m3"),
    ({"effects.surface_tilt.angle": 0.7}, "effects.surface_tilt.angle = 0.7 rad is steeper"),
    ({"effects.surface_tilt.angle": -1.5}, "effects.surface_tilt.angle = 1.5 rad is steeper"),
    (
        {"contact.static_friction": 0.01, "contact.kinetic_friction": 0.01, "contact.adhesion": 0.0,
         "effects.surface_tilt.angle": 0.02},
        "the robot slides",
    ),
    ({"drive.frequency": 5e3}, "a pulse of 0.2 ms is 0.029 times the time constant"),
    ({"drive.frequency": 400.0}, "L/R = 7 ms, so that the field comes to swing by 0.11 mT"),
    ({"coil.inductance": 7.0}, "L/R = 700 ms"),
    ({"drive.frequency": 200.0, "drive.pulses": 4}, "the measuring window lasts 5 ms, less than"),
    ({"coil.resistance": 0.1}, "the field comes to swing by 0.0045 mT"),
    ({"contact.adhesion": 1e-3}, "contact.adhesion = 0.001 N is 3.98e+03 times the weight"),
    ({"contact.adhesion": 6e-6}, "contact.adhesion = 6e-06 N is 23.9 times the weight"),
    ({"environment.gravity": 0.0}, "acts on a robot without weight"),
    ({"solver.rtol": 1e-2}, "solver.rtol = 0.01 is looser than 1e-05"),
    ({"drive.peak": 0.1}, "the drive asks for"),
    ({"drive.pulses": 2}, "drive.pulses = 2 is fewer than 4"),
    ({"contact.tangential_restitution": 0.5}, "has no effect while contact.restitution is 0"),
    ({"drive.base": 2.5e-3}, "drive.base = drive.peak = 0.0025 T: the voltage is constant"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "text"), NONSENSE)
def test_nonsense_gets_a_note(changes, text):
    assert not scenario_notes(Scenario())
    notes = scenario_notes(Scenario().replace(changes))
    assert any(text in str(note) for note in notes), notes


def test_sound_scenarios_get_none():
    # About the paper's: half to twice its robot, contacts and drives.
    random = np.random.default_rng(3)
    for _ in range(300):
        static = random.uniform(0.1, 0.6)
        base = random.uniform(0.0, 1e-3)
        changes = {
            "drive.mode": str(random.choice(["IPP", "OPP"])),
            "drive.frequency": random.uniform(1.0, 250.0),
            "drive.base": base,
            "drive.peak": base + random.uniform(1e-3, 4e-3),
            "drive.hold": random.uniform(0.0, 3e-3),
            "drive.pulses": int(random.integers(6, 100)),
            "robot.length": 250e-6 * random.uniform(0.8, 1.25),
            "robot.height": 100e-6 * random.uniform(0.8, 1.25),
            "robot.mass": 25.6e-9 * random.uniform(0.5, 1.25),
            "contact.static_friction": static,
            "contact.kinetic_friction": static * random.uniform(0.5, 1.0),
            "contact.adhesion": WEIGHT * random.choice([0.0, random.uniform(0.0, 5.0)]),
            "effects.surface_tilt.angle": random.uniform(-0.05, 0.05),
            "solver.rtol": 10.0 ** random.uniform(-10.0, -5.0),
        }
        assert scenario_notes(Scenario().replace(changes)) == []


@pytest.mark.parametrize("frequency", [1.0, 30.0, 200.0, 1e4])
def test_the_swing_of_the_field_is_that_of_the_simulated_current(frequency):
    # From 40 time constants on the start is forgotten to 4e-18.
    tau = 0.007
    pulses = int(np.ceil(40.0 * tau * frequency)) + 4
    rate = 2000.0 * frequency
    changes = {
        "drive.frequency": frequency,
        "drive.base": 0.0,
        "drive.hold": 0.0,
        "drive.pulses": pulses,
        "drive.ramp": 0.0,
        "robot.magnetization": 1.0,
        "record.rate": rate,
        "record.from": (pulses - 2) / frequency,
    }
    run = simulate(Scenario().replace(changes))
    field = np.abs(run.bx)
    # A sample in 2000 of a period misses the top by less than a thousandth of the swing.
    swing = (field.max() - field.min()) / 2.5e-3
    assert swing == pytest.approx(field_swing(frequency, tau), rel=2e-3)


def test_the_swing_of_a_coil_far_from_its_time_constant_is_that_of_the_limit():
    # Of s = T / tau it is s / 8 up to a term in s^3, and 1 for a coil that follows at once.
    for share in (1e-3, 1e-5, 1e-7, 1e-300):
        assert field_swing(1.0, 1.0 / share) == pytest.approx(share / 8.0, rel=1e-6)
    assert field_swing(1.0, 1e-9) == pytest.approx(1.0, abs=1e-7)
    assert field_swing(1e-300, 1e-300) == 1.0


def test_a_program_that_is_over_before_the_current_has_followed_is_noted():
    def noted(duration):
        program = Waveform.ramp(duration, {"xp": 5.0}, {"xp": 10.0})
        drive = Drive(mode="program", program=program)
        notes = scenario_notes(Scenario(drive=drive))
        return [str(note) for note in notes if note.code == "window-short"]

    (note,) = noted(5e-3)
    assert "lasts 5 ms, less than the time constant of coil xp, L/R = 7 ms" in note
    assert noted(0.1) == []
