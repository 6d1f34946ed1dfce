"""Notes on scenarios that are hardly meant so, and none on sound ones."""

import re
from pathlib import Path

import numpy as np
import pytest

from stickslip import (
    Accelerations,
    Drive,
    Forces,
    Scenario,
    Waveform,
    _core,
    load,
    simulate,
)
from stickslip._core import field_swing
from stickslip.scenario.keys import IDLE, USUAL, known_keys
from stickslip.scenario.matter import LIQUIDS
from stickslip.simulation.notes import CODES, scenario_notes

WEIGHT = 25.6e-9 * 9.81

VOLUME = 250e-6 * 130e-6 * 100e-6  # m^3, of the robot
# 10 ohm over 0.96258 mT/A: 10389 V for 1 T in one coil, half of that in each of a pair.
VOLTS = 10389.0

# One key of each is nonsense with the others at their defaults: the note's code, and its value.
NONSENSE = [
    ({"robot.mass": 25.6e-6}, "density", 25.6e-6 / VOLUME),
    ({"robot.mass": 25.6e-12}, "density", 25.6e-12 / VOLUME),
    ({"robot.height": 1e-6}, "density", 100.0 * 25.6e-9 / VOLUME),
    ({"robot.magnetization": 2.1e6}, "moment", 2.1e6),
    ({"effects.surface_tilt.angle": -1.5}, "steep-surface", 1.5),
    ({"contact.static_friction": 0.01, "contact.kinetic_friction": 0.01, "contact.adhesion": 0.0,
      "effects.surface_tilt.angle": 0.02}, "steep-surface", 0.02),
    ({"drive.frequency": 400.0}, "pulses-short", 2.5e-3 * field_swing(400.0, 7e-3)),
    ({"coil.inductance": 7.0}, "pulses-short", 2.5e-3 * field_swing(100.0, 0.7)),
    ({"drive.frequency": 200.0, "drive.pulses": 4}, "window-short", 5e-3),
    ({"contact.adhesion": 6e-6}, "adhesion", 6e-6),
    ({"environment.gravity": 0.0}, "adhesion", 0.22e-6),
    ({"solver.rtol": 1e-2}, "tolerance", 1e-2),
    ({"drive.peak": 40e-3, "drive.coils": "pairs"}, "voltage", 0.5 * 40e-3 * VOLTS),
    ({"drive.hold": 20e-3, "drive.direction": "-x"}, "voltage", 20e-3 * VOLTS),
    ({"drive.mode": "OPP", "drive.peak": 20e-3, "drive.edge": "fall"}, "voltage", 20e-3 * VOLTS),
    ({"drive.pulses": 3}, "start-up", 3.0),
    ({"contact.tangential_restitution": 0.5}, "tangential-restitution", 0.5),
    ({"drive.base": 2.5e-3}, "no-pulses", 2.5e-3),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "code", "value"), NONSENSE)
def test_nonsense_gets_a_note(changes, code, value):
    notes = {note.code: note for note in scenario_notes(Scenario().replace(changes))}
    assert notes[code].value == pytest.approx(value, rel=1e-4)
    assert "\n" not in str(notes[code])


def test_the_core_has_its_notes_in_the_order_of_all():
    codes = [row["code"] for row in _core.note_rows if not row["code"].startswith("rest")]
    assert codes == sorted(codes, key=CODES.index)


# Which kinds of drive have a note with these changes, as far as a kind has their keys.
OF_KINDS = [
    ("pulses-short", {"drive.frequency": 400.0}, {"sawtooth"}),
    ("no-pulses", {"drive.base": 2.5e-3}, {"sawtooth"}),
    ("capacitor", {"coil.capacitance": 1e-3}, {"sawtooth"}),
    ("start-up", {"drive.pulses": 3}, {"sawtooth", "none"}),
]


@pytest.mark.parametrize("mode", known_keys()["drive.mode"].words)
@pytest.mark.parametrize(("code", "changes", "kinds"), OF_KINDS)
def test_notes_are_of_the_kind_of_drive(mode, code, changes, kinds):
    given = {key: value for key, value in changes.items() if key not in IDLE.get(mode, ())}
    if mode == "program":
        given["drive.program"] = Waveform.hold(0.1, {"xp": 5.0})
    scenario = Scenario().replace({"drive.mode": mode, **given})
    assert scenario.drive.kind == {"IPP": "sawtooth", "OPP": "sawtooth"}.get(mode, mode)
    notes = scenario_notes(scenario)
    assert (code in {note.code for note in notes}) == (scenario.drive.kind in kinds)
    of_sawtooth = re.compile("ramp|drive.(peak|base|hold|frequency)")
    assert scenario.drive.kind == "sawtooth" or not any(map(of_sawtooth.search, map(str, notes)))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"drive.pulses": 4},
        {"solver.rtol": 1e-5},
        {"contact.tangential_restitution": 0.6, "contact.restitution": 0.1},
        # What shakes it is not the field.
        {"drive.base": 2.5e-3, "shake.amplitude_x": 1e-6, "shake.frequency": 100.0},
        {"drive.base": 2.5e-3, "shake.amplitude_z": 1e-6, "shake.frequency": 100.0},
        {"drive.base": 2.5e-3, "shake.accelerations": Accelerations([[0, 1, 0], [1e-2, -1, 0]])},
        {"drive.base": 2.5e-3, "inner.mass": 1e-9, "inner.stiffness": 1.0},
    ],
)
def test_what_is_just_sound_gets_none(changes):
    assert scenario_notes(Scenario().replace(changes)) == []


def test_the_voltage_of_a_program_is_noted_with_its_coil():
    scenario = Scenario(drive=Drive(mode="program", program=Waveform.hold(0.02, {"ym": -300.0})))
    assert any("300 V at coil ym, 30 A" in str(note) for note in scenario_notes(scenario))


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


SHAKEN = {"shake.frequency": 1e3, "shake.amplitude_x": 1e-6, "shake.amplitude_z": 2e-7}
CAPSULE = {"inner.mass": 1e-9, "inner.stiffness": 0.01, "inner.frequency": 14.0}

# What a sound value is in another unit: mm, um, kHz, ms, mH, uF, mT, uT, uN, kA/m, cm/s^2.
OTHER_UNITS = [
    {"shake.amplitude_x": 1.0}, {"shake.amplitude_z": -0.2}, {"shake.frequency": 1.0},
    {"inner.stop_high": 2.0}, {"inner.stop_low": -2.0}, {"inner.frequency": 0.014},
    {"drive.frequency": 0.1}, {"drive.ramp": 50.0}, {"drive.latency": 5.0},
    {"drive.hold": 1.0}, {"drive.peak": 0.25},
    {"coil.inductance": 70.0}, {"coil.clamp.inductance": 70.0}, {"coil.capacitance": 100.0},
    {"coil.resistance": 1e-3}, {"coil.side": 13.85}, {"coil.xp.distance": 9.9},
    {"robot.width": 0.13}, {"robot.magnetization": 500.0}, {"contact.adhesion": 0.22},
    {"environment.gravity": 981.0}, {"initial.x": 5.0}, {"effects.ambient_field.Bz": -0.045},
    {"effects.sample_hold.period": 1.0}, {"effects.eddy_lag.time": 0.4},
]  # fmt: skip


@pytest.mark.parametrize("changes", OTHER_UNITS, ids=lambda changes: next(iter(changes)))
def test_a_value_in_another_unit_is_told_with_its_unit_and_the_usual_values(changes):
    key, value = next(iter(changes.items()))
    others = {"shake": SHAKEN, "inner": CAPSULE}.get(key.partition(".")[0], {})
    scenario = Scenario().replace({**others, **changes})
    low, high, unit = known_keys()[key].usual
    (text,) = (note.text for note in scenario_notes(scenario) if f"{key} = " in note.text)
    if "is it in SI units" in text:  # else another note has the key, such as an adhesion
        assert f"{key} = {value:g} {unit} is far from the usual {low:g} to {high:g}" in text
    else:
        assert key == "contact.adhesion"


def test_usual_values_hold_the_defaults_in_the_units_of_the_keys():
    for name, (low, high, unit) in USUAL.items():
        assert low < high
        if not name.startswith("fluid."):
            key = known_keys()[name]
            assert key.unit == unit
            whole = name.startswith("inner.stop")  # there is none by default
            assert whole or key.default == 0.0 or low <= key.default <= high, name


def test_a_period_in_other_units_is_told():
    rows = [[0.0, 30.0, 0.0], [0.5, -30.0, 0.0], [1.0, 30.0, 0.0]]  # ms
    still = {"drive.mode": "none", "drive.pulses": 5}
    found = scenario_notes(
        Scenario().replace({**still, "shake.accelerations": Accelerations(rows)})
    )
    assert [note.code for note in found] == ["unusual"]
    assert "1 / period of Accelerations = 1 Hz" in found[0].text
    driven = {**still, **CAPSULE, "inner.forces": Forces([[0.0, 1e-7], [5.0, 1e-7]])}
    del driven["inner.frequency"]
    found = scenario_notes(Scenario().replace(driven))
    assert [note.code for note in found] == ["unusual"]


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ({"viscosity": 1.0}, "fluid.viscosity of water = 1 Pa s"),
        ({"viscosity": 1e-6}, "fluid.viscosity of water = 1e-06 Pa s"),
        ({"density": 1.3}, "fluid.density of water = 1.3 kg/m^3"),
        ({"density": 1260.0}, "fluid.density of water = 1260 kg/m^3"),
        ({"viscosity": 0.7e-3, "density": 992.0}, None),  # at 37 degrees C
        ({"viscosity": 1.8e-3, "density": 1060.0}, None),  # with salt or sugar
        ({}, None),
    ],
)
def test_a_named_liquid_with_the_numbers_of_another_one_is_told(tmp_path, stated, words):
    lines = [f"{key} = {value!r}" for key, value in stated.items()]
    text = "\n".join(["stickslip = 1", "[drive]", "[fluid]", 'name = "water"', *lines])
    (tmp_path / "a.toml").write_text(text)
    scenario = load(tmp_path / "a.toml")
    assert scenario == Scenario().in_fluid("water", **stated)
    scenario.to_toml(tmp_path / "b.toml")
    for made in (scenario, Scenario().in_fluid("water", **stated), load(tmp_path / "b.toml")):
        found = [note.text for note in scenario_notes(made) if note.code == "unusual"]
        assert len(found) == (words is not None)
        assert words is None or found[0].startswith(words)


def test_liquids_of_the_table_are_usual():
    robot = {"robot.length": 2e-3, "robot.width": 1e-3, "robot.height": 1e-3, "robot.mass": 15e-6}
    for name in LIQUIDS:
        notes = scenario_notes(Scenario().replace(robot).in_fluid(name))
        assert not [note for note in notes if note.code == "unusual"], name


def test_scenarios_of_the_examples_have_usual_values():
    files = [*Path(__file__).resolve().parents[1].glob("examples/**/*.toml")]
    scenarios = [
        load(file) for file in files if re.search("^stickslip = 1$", file.read_text(), re.M)
    ]
    assert scenarios
    for scenario in scenarios:
        assert not [note for note in scenario_notes(scenario) if note.code == "unusual"]


T = np.linspace(0.0, 1e-3, 21)
W = 2e3 * np.pi
CLOSED = {
    "sine": 40.0 * np.sin(W * T),
    "cosine": 40.0 * np.cos(W * T),
    "two harmonics": np.sin(W * T + 0.4) + 0.5 * np.sin(2.0 * W * T),
    "triangle": np.abs(np.mod(4e3 * T + 0.7, 4.0) - 2.0) - 1.0,
}
WHOLE = {
    "sawtooth": np.linspace(-1.0, 1.0, 21),
    "rectangle": np.where(T < 0.5e-3, 1.0, -1.0),
    "steps": np.array([0.0, 0.0, 1.0, 1.0, 1.0, -2.0, -2.0, 0.5, 0.5, 0.5, 0.2] + [0.0] * 10),
    "read back": 40.0 * np.sin(W * T) + 0.3 * np.random.default_rng(1).standard_normal(21),
    "short": np.array([1.0, -1.0]),
}


def ends_told(t, values):
    """Whether the end of the period is told to be missing, of a shake and of a mass inside."""
    shaken = {"shake.accelerations": Accelerations(np.c_[t, values, 0.1 * values])}
    driven = {"inner.mass": 1e-9, "inner.stiffness": 0.01, "inner.forces": Forces(np.c_[t, values])}
    return [
        [note.value for note in scenario_notes(Scenario().replace(each))
         if note.code == "period-end"]
        for each in (shaken, driven)
    ]  # fmt: skip


@pytest.mark.parametrize("kind", CLOSED)
@pytest.mark.parametrize("step", [1, 2])
def test_a_period_without_its_end_is_told_and_one_with_it_not(kind, step):
    t, values = T[::step], CLOSED[kind][::step]
    assert ends_told(t, values) == [[], []]
    assert ends_told(t[:-1], values[:-1]) == [[pytest.approx(1e-3)], [pytest.approx(1e-3)]]


@pytest.mark.parametrize("kind", WHOLE)
def test_a_period_that_jumps_at_its_end_is_whole(kind):
    assert ends_told(T[: len(WHOLE[kind])], WHOLE[kind]) == [[], []]


def test_a_period_of_uneven_steps_is_whole():
    t = 1e-3 * np.linspace(0.0, 1.0, 20) ** 1.5
    assert ends_told(t, np.sin(0.95 * W * t)) == [[], []]
