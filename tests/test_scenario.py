"""Scenarios: defaults, equality, TOML, dotted keys."""

import dataclasses
import inspect
import pickle

import numpy as np
import pytest

import stickslip
from stickslip import (
    COIL_NAMES,
    Coil,
    Contact,
    Drive,
    Record,
    Scenario,
    ScenarioError,
    Waveform,
    load,
    simulate,
)
from stickslip.scenario.keys import known_keys


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
            "effects.surface_tilt.angle": 0.02,
            "effects.ambient_field.Bz": -4e-5,
            # In flight all of them may differ.
            "initial.z": 1e-3,
            "initial.contact": "flight",
        }
    )
    for number, name in enumerate(known_keys()):
        if name.startswith("initial.") and changes[name] == 0.0:
            changes[name] = 1e-3 * (number + 1)
    return Scenario().replace(changes)


def test_defaults_are_those_of_the_core():
    scenario = Scenario()
    for name, key in known_keys().items():
        assert scenario.get(name) == key.default, name
    for section in dataclasses.fields(Scenario):
        if section.name not in ("effects", "uncertain"):
            for field in dataclasses.fields(getattr(scenario, section.name)):
                if field.name not in ("program", "map", *COIL_NAMES):
                    # `from` is a word of Python, so its field is `from_`.
                    assert f"{section.name}.{field.name.removesuffix('_')}" in known_keys()


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
        if scenario.get(key) == Scenario().get(key) and not key.startswith("effects.")
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


def test_a_program_survives_the_file(tmp_path):
    waveform = Waveform.from_points([0.0, 0.1, 0.1, 0.3], np.arange(20.0).reshape(4, 5) / 3.0)
    scenario = Scenario(drive=Drive(mode="program", program=waveform))
    path = tmp_path / "scenario.toml"
    scenario.to_toml(path)
    assert load(path) == scenario
    assert load(path).drive.program.blocks[0][1][2, 3] == 13.0 / 3.0


@pytest.mark.parametrize("change", [{"drive.pulses": 99}, {"effects.eddy_lag.time": 1e-3}])
def test_a_change_makes_another_scenario(change):
    scenario = Scenario().replace(change)
    assert scenario != Scenario()
    (key, value), *_ = change.items()
    assert scenario.get(key) == value
    assert Scenario().get(key) != value


def test_an_extension_at_its_default_is_no_extension():
    # The core defines an extension as absent at zero, so these simulate the same.
    assert Scenario(effects={"surface_tilt": {"angle": 0.0}, "eddy_lag": {}}) == Scenario()


def test_replace_leaves_the_original_alone():
    scenario = Scenario(effects={"eddy_lag": {"time": 1e-3}})
    other = scenario.replace({"effects.surface_tilt.angle": 0.1, "coil.turns": 500})
    assert scenario.effects == {"eddy_lag": {"time": 1e-3}}
    assert other.effects == {"eddy_lag": {"time": 1e-3}, "surface_tilt": {"angle": 0.1}}
    assert (scenario.coil.turns, other.coil.turns) == (510.0, 500.0)


def test_scenarios_pickle():
    scenario = every_key_changed()
    assert pickle.loads(pickle.dumps(scenario)) == scenario
    assert pickle.loads(pickle.dumps(scenario)).effects == scenario.effects


ONE_OF_EACH_KIND = {
    "drive.mode": "OPP",
    "drive.hold": 2.5e-3,
    "drive.direction": "-x",
    "drive.pulses": 5,
    "contact.kinetic_friction": 0.1,
    "effects.surface_tilt.angle": 0.03,
    "solver.rtol": 1e-6,
    "record.from": 0.06,
    "record.rate": "events",
}


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
    pulsed = played.replace({"drive.mode": "IPP", "drive.program": None})
    assert pulsed == Scenario()
    assert pulsed.duration == Scenario().duration
    with pytest.raises(ScenarioError, match='allowed is "program"'):
        played.replace({"drive.mode": "IPP"})


def test_an_unknown_key_is_answered_with_the_nearest_one():
    with pytest.raises(ScenarioError, match=r'^drive\.frequncy: .*did you mean "drive\.frequency"'):
        Scenario().get("drive.frequncy")


def test_nothing_can_be_assigned():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Scenario().drive.frequency = 3.0
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


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Drive(frequency=-1.0), ["drive.frequency = -1.0", "from 1e-06"]),
        (lambda: Drive(frequency="3"), ['drive.frequency = "3"', "a number"]),
        (lambda: Drive(frequency=True), ["drive.frequency = true", "a number"]),
        (lambda: Drive(frequency=None), ["drive.frequency = None", "a number"]),
        (lambda: Drive(frequency=float("nan")), ["drive.frequency = nan"]),
        (lambda: Drive(pulses=1.5), ["drive.pulses = 1.5", "whole number"]),
        (lambda: Drive(pulses=10**400), ["drive.pulses = 1000", "whole number"]),
        (lambda: Drive(mode="ipp"), ['drive.mode = "ipp"', '"IPP", "OPP", "program"']),
        (lambda: Drive(program="file.csv"), ["drive.program", "Waveform"]),
        (lambda: Coil(side=float("inf")), ["coil.side = inf", "from 1e-06 to 100 m"]),
        (lambda: Record(rate=0), ["record.rate = 0", '"events" or "none"']),
        (lambda: Record(rate="all"), ['record.rate = "all"', '"events" or "none"']),
        (lambda: Scenario(drive={"frequency": 3.0}), ["drive = ", "a Drive"]),
        (lambda: Scenario(drive=Drive(mode="program")), ["drive.mode", "waveform"]),
        (lambda: Scenario(effects={"tilt": {}}), ["effects.tilt", "surface_tilt"]),
        (lambda: Scenario(effects={"surface_tilt": 3}), ["effects.surface_tilt = 3", "a table"]),
        (lambda: Scenario(effects=[]), ["effects = []"]),
        (
            lambda: Scenario(effects={"surface_tilt": {"angel": 1.0}}),
            ["effects.surface_tilt.angel = 1.0", 'mean "effects.surface_tilt.angle"'],
        ),
        (lambda: Scenario().replace({"drive.freqency": 3}), ['mean "drive.frequency"']),
        (lambda: Scenario().replace({"drive": 3}), ["drive = 3"]),
        (lambda: Scenario().replace({"": 3}), ["there is no such key"]),
        (lambda: Scenario().get("drive.mod"), ['mean "drive.mode"']),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(make, words):
    with pytest.raises(ScenarioError) as caught:
        make()
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 700
    for word in words:
        assert word in message


def test_a_long_or_broken_value_stays_on_one_short_line():
    with pytest.raises(ScenarioError) as caught:
        Drive(mode="a\nb" * 1000)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


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


def test_a_field_that_a_section_has_not_is_refused_with_the_nearest():
    with pytest.raises(ScenarioError, match=r'drive\.freqency = 3: .*; did you mean "frequency"'):
        Drive(freqency=3)
    with pytest.raises(ScenarioError, match=r"contact\.friction = 0\.2: .*; "):
        Contact(friction=0.2)
    assert "frequency" in inspect.signature(Drive).parameters


def test_a_parameter_of_an_effect_has_a_short_name():
    tilted = Scenario().replace({"surface_tilt.angle": 0.02})
    assert tilted == Scenario().replace({"effects.surface_tilt.angle": 0.02})
    assert tilted.get("surface_tilt.angle") == tilted.get("effects.surface_tilt.angle") == 0.02
