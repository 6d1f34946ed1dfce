"""Scenarios: defaults, equality, TOML, dotted keys."""

import ast
import copy
import inspect
import pickle
import re

import numpy as np
import pytest

import stickslip
from sections_stub import FILE, NAMES_FILE, RUN_FILE, names_stub_text, run_stub_text, stub_text
from stickslip import (
    STATE_COLUMNS,
    STATE_UNITS,
    Contact,
    Drive,
    Record,
    Scenario,
    ScenarioError,
    State,
    Waveform,
    load,
    simulate,
)
from stickslip._util.messages import meant, nearest, suggestion
from stickslip.scenario.keys import is_of_one_coil, known_keys
from stickslip.scenario.sections import SECTIONS, OneCoil


def every_key_changed():
    """A scenario in which no scalar differs from none: each key has a value of its own."""
    changes = {}
    for number, (name, key) in enumerate(known_keys().items()):
        if key.kind in ("real", "whole") and not name.startswith("effects."):
            factor = 1.0 + 0.001 * number
            changes[name] = key.default * factor if key.kind == "real" else key.default + number
    changes.update(
        {
            "drive.mode": "OPP",
            "drive.clamp": "up",
            "drive.edge": "fall",
            "drive.direction": "-x",
            "drive.heading": 0.4,
            "drive.coils": "pairs",
            "drive.base": -1e-4,
            "drive.edge_time": 1e-4,
            "drive.ramp_down": 0.013,
            "contact.restitution": 0.25,
            "contact.tangential_restitution": 0.3,
            "solver.method": "arkode",
            "solver.max_step": 1e-3,
            "record.rate": 1234.5,
            "record.from": 0.1,
            "record.fields": "x, theta",
            "record.dtype": "float32",
            "record.pull_share": "yes",
            "drive.latency": 1e-3,
            "effects.surface_tilt.angle": 0.02,
            "effects.ambient_field.Bz": -4e-5,
            # In flight all of them may differ.
            "initial.z": 1e-3,
            "initial.contact": "flight",
        }
    )
    for number, name in enumerate(known_keys()):
        if (name.startswith("initial.") and changes[name] == 0.0) or name.endswith(".capacitance"):
            changes[name] = 1e-3 * (number + 1)
    return Scenario().replace(changes)


def test_sections_are_those_of_the_cores_table():
    scenario = Scenario()
    for name, key in known_keys().items():
        assert scenario.get(name) == key.default, name
        if not name.startswith("effects.") and not is_of_one_coil(name):
            assert getattr(getattr(scenario, key.section), key.field) == key.default
    for name, section in SECTIONS.items():
        signature = inspect.signature(section).parameters
        documented = re.findall(r"^(\w+) : ", section.__doc__, re.MULTILINE)
        assert list(signature) == documented == list(getattr(scenario, name).as_dict())
        assert section.__doc__.splitlines()[0].endswith(".")


def test_the_stub_is_that_of_the_table():
    def code(text):
        return ast.dump(ast.parse(text))

    assert code(FILE.read_text()) == code(stub_text())
    assert code(NAMES_FILE.read_text()) == code(names_stub_text())
    assert code(RUN_FILE.read_text()) == code(run_stub_text())


def test_a_section_is_a_value():
    scenario = every_key_changed()
    for name, section in SECTIONS.items():
        seen = getattr(scenario, name)
        for again in (section(**seen.as_dict()), pickle.loads(pickle.dumps(seen))):
            assert again == seen
            assert hash(again) == hash(seen)
        assert seen != section()
        assert eval(repr(seen), {section.__name__: section, "OneCoil": OneCoil}) == seen
    parts = {name: getattr(scenario, name) for name in (*SECTIONS, "effects")}
    assert Scenario(**parts) == scenario


def test_a_state_is_a_row_of_numbers():
    state = every_key_changed().initial
    assert State.from_row(state.row) == state
    assert Scenario().with_state(state).initial == state
    assert "[initial]" not in Scenario().to_toml()
    in_amperes = [name for name, unit in STATE_UNITS.items() if unit == "A"]
    assert in_amperes == [name for name in STATE_COLUMNS if name.startswith(("current", "field"))]
    with pytest.raises(ScenarioError, match=r"initial\.contact = 8\.0: allowed is a whole number"):
        State.from_row([8.0 if name == "contact" else 0.0 for name in STATE_COLUMNS])
    with pytest.raises(ScenarioError, match=r"row of shape \(27,\): allowed is shape \(28,\)"):
        State.from_row(state.row[1:])


def test_toml_and_python_give_the_same_object(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text(
        'stickslip = 1\n[drive]\nmode = "OPP"\nhold = 2.5e-3\nfrequency = 30\n'
        "[contact]\nadhesion = 0\n[effects.surface_tilt]\nangle = 0.02\n[record]\nrate = 1000\n"
    )
    built = Scenario(
        drive=Drive(mode="OPP", hold=2.5e-3, frequency=30.0),
        contact=Contact(adhesion=0.0),
        effects={"surface_tilt": {"angle": 0.02}},
        record=Record(rate=1000.0),
    )
    assert load(path) == built
    assert hash(load(path)) == hash(built)


def test_every_key_survives_the_file(tmp_path):
    scenario = every_key_changed()
    unchanged = [
        key
        for key in known_keys()
        if scenario.get(key) == Scenario().get(key)
        and not key.startswith(("effects.", "shake.", "inner."))
    ]
    assert unchanged == []
    path = tmp_path / "scenario.toml"
    text = scenario.to_toml(path)
    assert path.read_text() == text == scenario.to_toml()
    assert load(path) == scenario


def test_every_section_is_optional_but_drive(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text("stickslip = 1\n[drive]\n")
    assert load(path) == Scenario()


def test_an_extension_at_its_default_is_no_extension():
    # The core defines an extension as absent at zero, so these simulate the same.
    assert Scenario(effects={"surface_tilt": {"angle": 0.0}, "eddy_lag": {}}) == Scenario()


def test_replace_leaves_the_original_alone():
    scenario = Scenario(effects={"eddy_lag": {"time": 1e-3}})
    other = scenario.replace({"effects.surface_tilt.angle": 0.1, "coil.turns": 500})
    assert scenario.effects == {"eddy_lag": {"time": 1e-3}}
    assert other.effects == {"eddy_lag": {"time": 1e-3}, "surface_tilt": {"angle": 0.1}}
    assert (scenario.coil.turns, other.coil.turns) == (510.0, 500.0)


def test_what_is_no_key_is_kept_when_a_scenario_is_copied(tmp_path):
    """Its notes depend on the fluid."""
    scenario = Scenario().in_fluid("water")
    assert scenario.fluid
    again = [
        pickle.loads(pickle.dumps(scenario)), copy.copy(scenario), copy.deepcopy(scenario),
        scenario.replace({}), scenario.with_uncertain({"robot.mass": {"mean": 1e-8, "sd": 1e-9}}),
    ]  # fmt: skip
    for each in again:
        assert each.fluid == scenario.fluid


ONE_OF_EACH_KIND = {
    "drive.mode": "OPP", "drive.hold": 2.5e-3, "drive.direction": "-x", "drive.pulses": 5,
    "contact.kinetic_friction": 0.1,
    "effects.surface_tilt.angle": 0.03,
    "solver.rtol": 1e-6, "record.from": 0.06, "record.rate": "events",
}  # fmt: skip


@pytest.mark.parametrize("key", ONE_OF_EACH_KIND)
def test_a_replaced_scenario_simulates_as_one_that_is_made_anew(key):
    # Keys change one by one and back: what the core keeps of it has to follow each time.
    changed = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 4})
    for name, value in {**ONE_OF_EACH_KIND, key: changed.get(key)}.items():
        changed = changed.replace({name: value})
        anew = pickle.loads(pickle.dumps(changed))
        assert anew == changed
        assert repr(anew) == repr(changed)
        assert simulate(anew).summary() == simulate(changed).summary()
        assert simulate(anew).recorded == simulate(changed).recorded
        assert repr(simulate(anew).recorded_until) == repr(simulate(changed).recorded_until)


def test_a_program_can_be_set_and_removed():
    waveform = Waveform.hold(0.1, {"xp": 5.0})
    played = Scenario().replace({"drive.mode": "program", "drive.program": waveform})
    assert (played.duration, played.window) == (0.1, (0.0, 0.1))
    assert played.replace({"drag.linear": 0.0}).duration == 0.1
    again = Scenario(drive=played.drive)  # the section of another scenario
    assert again == played
    assert again.drive.program is waveform
    assert simulate(again).summary() == simulate(played).summary()
    pulsed = played.replace({"drive.mode": "IPP", "drive.program": None})
    assert pulsed == Scenario()
    assert pulsed.duration == Scenario().duration
    with pytest.raises(ScenarioError, match='allowed is "program"'):
        played.replace({"drive.mode": "IPP"})


def test_nothing_can_be_assigned():
    with pytest.raises(AttributeError):
        Scenario().drive.frequency = 3.0
    with pytest.raises(AttributeError):
        Scenario().drive = Drive(frequency=3.0)
    with pytest.raises(TypeError):
        Scenario().effects["eddy_lag"] = {"time": 1.0}


def test_numbers_keep_their_kind():
    drive = Drive(frequency=np.float32(50), pulses=np.int64(7), peak=1)
    assert (drive.frequency, drive.pulses, drive.peak) == (50.0, 7, 1.0)
    assert [type(v) for v in (drive.frequency, drive.pulses, drive.peak)] == [float, int, float]
    assert Drive(pulses=100.0) == Drive(pulses=100)


def test_duration_and_window_follow_from_the_drive():
    # 0.05 s ramp, 20 pulses of 10 ms, 0.02 s down; the window from the end of the third pulse.
    scenario = Scenario(drive=Drive(pulses=20, ramp=0.05, ramp_down=0.02))
    assert scenario.duration == pytest.approx(0.27, rel=1e-14)
    assert scenario.window == pytest.approx((0.08, 0.25), rel=1e-14)


def test_effects_table_is_the_cores():
    table = {effect.name: effect for effect in stickslip.effects()}
    angle, azimuth = table["surface_tilt"].parameters
    assert azimuth.name == "effects.surface_tilt.azimuth"
    assert (angle.name, angle.unit) == ("effects.surface_tilt.angle", "rad")
    for effect in table.values():
        assert effect.meaning
        assert effect.source
        assert effect.parameters
    listed = {key.name for effect in table.values() for key in effect.parameters}
    assert listed == {name for name in known_keys() if name.startswith("effects.")}


def test_a_parameter_of_an_effect_has_a_short_name():
    tilted = Scenario().replace({"surface_tilt.angle": 0.02})
    assert tilted == Scenario().replace({"effects.surface_tilt.angle": 0.02})
    assert tilted.get("surface_tilt.angle") == tilted.get("effects.surface_tilt.angle") == 0.02
    assert tilted == Scenario().replace(**{"surface_tilt.angle": 0.02})


def test_one_validation_decides_in_any_order():
    waveform = Waveform.hold(0.1, {"xp": 5.0})
    program = {"drive.mode": "program", "drive.program": waveform}
    pulsed = Scenario(drive=Drive(frequency=30.0, pulses=5, heading=0.3))
    for changes in (program, dict(reversed(program.items()))):
        assert pulsed.replace(changes) == Scenario(drive=Drive(mode="program", program=waveform))
        with pytest.raises(ScenarioError, match=r"drive\.pulses: not allowed with drive.mode"):
            pulsed.replace({"drive.pulses": 7, **changes})


def test_every_word_is_its_own_nearest_and_a_doubled_letter_is_recognised():
    tried = 0
    for key in known_keys().values():
        assert nearest(key.name.upper(), known_keys()) == key.name
        for word in key.words if key.kind == "word" else ():
            wrong = word + word[-1]
            with pytest.raises(ScenarioError) as caught:
                Scenario().replace({key.name: wrong})
            assert meant(wrong, key.words) in str(caught.value)
            tried += meant(wrong, key.words) != ""
    assert tried > 3
    assert meant("wxyz", ["one", "two"]) == ""
    assert suggestion("wxyz", ["one", "two"], ["one"]) == 'known are "one"'


@pytest.mark.parametrize("wrong", ['"wrong"', "[1]", "nan"])
def test_the_value_of_every_key_of_a_file_is_judged(tmp_path, wrong):
    path = tmp_path / "s.toml"
    for key in known_keys().values():
        section = f"[{key.section}]\n" if key.section != "drive" else ""
        path.write_text(f"stickslip = 1\n[drive]\n{section}{key.name.rpartition('.')[2]} = {wrong}")
        with pytest.raises(ScenarioError, match=re.escape(f"{path}: {key.name} = ")):
            load(path)


@pytest.mark.parametrize(("direction", "facing"), [("+x", 1.0), ("-x", -1.0)])
def test_a_robot_faces_the_way_of_its_drive(direction, facing):
    assert Scenario().replace({"drive.direction": direction}).drive.facing == facing
