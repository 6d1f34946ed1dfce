"""Capabilities of coils and amplifiers, and coils from a laboratory's measurements."""

import json
import math

import numpy as np
import pytest
from paper.statements import fringe

from command_line import stickslip
from measured_maps import formula_map
from stickslip import Coil, Drive, Scenario, Waveform, _core, simulate
from stickslip.design.coil_facts import coil_facts, dimension_changes

OWN = {"coil.clamp.turns": 400.0, "coil.clamp.side": 0.11, "coil.clamp.resistance": 7.0}


@pytest.mark.parametrize("keys", [{}, OWN, {"coil.side": 0.05, "coil.distance": 0.03}])
def test_the_numbers_of_coils_are_those_of_magpylib(keys):
    magpylib = pytest.importorskip("magpylib")
    scenario, step = Scenario().replace(keys), 2e-5  # m; the slope's error is (step / distance)^2
    for name, facts in coil_facts(scenario).items():
        own = getattr(scenario.coil, name)
        half, far = 0.5 * own.side, own.distance
        corners = [(half, half, far), (-half, half, far), (-half, -half, far), (half, -half, far)]
        winding = magpylib.current.Polyline(vertices=[*corners, corners[0]], current=own.turns)
        field = winding.getB([[0, 0, -step], [0, 0, 0], [0, 0, step]])[:, 2]
        assert facts.field == pytest.approx(abs(field[1]), rel=1e-6)
        slope = abs(field[2] - field[0]) / (2.0 * step)
        assert facts.gradient == pytest.approx(slope, rel=1e-6)
    if not keys:
        assert coil_facts(scenario)["xp"].fringe == pytest.approx(fringe(5e-3), rel=1e-9)


def test_the_drive_and_the_amplifier_are_those_of_a_run():
    scenario = Scenario(drive=Drive(base=0.0, peak=2e-3, hold=0.0, pulses=40, frequency=30))
    facts = coil_facts(scenario, volts=20.0)["xp"]
    assert facts.current == pytest.approx(2e-3 / facts.field)
    assert facts.power == pytest.approx(facts.current**2 * 10.0)
    # By hand: 282.54 m of wire of 10 ohm are 1.23 kg of copper with 474 J/K.
    assert facts.heating == pytest.approx(facts.power / 474.0, rel=0.01)
    assert (facts.most_current, facts.most_field) == pytest.approx((2.0, 2.0 * facts.field))
    assert coil_facts(scenario, volts=20.0, amperes=1.5)["xp"].most_current == 1.5
    limited = scenario.replace({"effects.amplifier_limit.voltage": 20.0})
    assert coil_facts(limited)["xp"] == facts
    assert math.isnan(coil_facts(scenario)["xp"].most_field)
    # A sawtooth to the voltage of the amplifier, by a run.
    full = scenario.replace({"drive.peak": facts.most_field, "robot.magnetization": 1.0})
    run = simulate(full.replace({"record.rate": 3e4, "record.from": 38.0 / 30.0}))
    assert np.ptp(np.abs(run.bx)) == pytest.approx(facts.most_swing, rel=5e-3)


@pytest.mark.parametrize("mode", _core.drive_kinds)
def test_the_swing_is_that_of_a_drive_with_a_sawtooth(mode):
    program = Waveform.hold(0.1, {"xp": 5.0}) if mode == "program" else None
    facts = coil_facts(Scenario(drive=Drive(mode=mode, program=program)), volts=20.0)["xp"]
    assert math.isfinite(facts.most_swing) == (mode in ("IPP", "OPP"))


def test_changes_of_dimensions_are_their_powers():
    changes = dimension_changes(Scenario(), "xp")
    assert changes["turns"]["field"] == pytest.approx(0.05)
    assert changes["inductance"]["rise_time"] == pytest.approx(0.05)
    assert changes["resistance"]["rise_time"] == pytest.approx(1 / 1.05 - 1)
    # Side and distance together scale the coil: the field with 1 / size, the gradient twice.
    for number, power in (("field", -1), ("gradient", -2), ("gradient_per_field", -1)):
        both = changes["side"][number] + changes["distance"][number]
        assert both == pytest.approx(1.05**power - 1.0, abs=0.01)


def test_a_map_has_neither_winding_nor_sides():
    scenario = Scenario(coil=Coil(map=formula_map(count=(5, 5, 5))))
    facts = coil_facts(scenario, volts=10.0)["clamp"]
    assert facts.field == pytest.approx(coil_facts(Scenario())["clamp"].field, rel=1e-3)
    assert math.isnan(facts.heating)
    assert set(dimension_changes(scenario, "xp")) == {"resistance", "inductance"}


def test_coils_of_a_laboratory_have_what_was_measured():
    coil = Coil.of(
        field_per_ampere=0.8e-3, distance=0.06, radius=0.04, resistance=6.0, rise_time=4e-3
    )
    facts = coil_facts(Scenario(coil=coil))["yp"]
    assert (facts.field, facts.rise_time) == pytest.approx((0.8e-3, 4e-3))
    # A circle's gradient over its field, on the axis: 3 d / (d^2 + R^2).
    assert facts.gradient / facts.field == pytest.approx(3 * 0.06 / (0.06**2 + 0.04**2), rel=3e-3)
    known = Coil.of(
        field_per_ampere=0.8e-3, distance=0.06, side=0.07, resistance=6.0, inductance=0.02
    )
    assert (known.side, known.inductance) == (0.07, 0.02)
    ringing = Coil.of(
        field_per_ampere=0.8e-3, distance=0.06, side=0.07, resistance=6.0, inductance=0.02,
        capacitance=1e-6,
    )  # fmt: skip
    facts = coil_facts(Scenario(coil=ringing), volts=20.0)["xp"]
    assert facts.resonance == pytest.approx(1.0 / (2.0 * math.pi * math.sqrt(2e-8)))
    assert (facts.current, facts.most_current) == (0.0, 0.0)


def test_the_command_tells_them(tmp_path):
    scenario = Scenario().replace({**OWN, "drive.frequency": 400.0})
    scenario.to_toml(tmp_path / "s.toml")
    more = ["--volts", "24", "--amperes", "2"]
    picture = tmp_path / "coils.png"
    text = stickslip("coils", tmp_path / "s.toml", *more, "--plot", picture).stdout
    assert text.startswith("xp xm yp ym\n")
    assert "\nclamp\n" in text
    assert text.count("\nnote: ") == 1
    assert picture.stat().st_size > 10_000
    found = json.loads(stickslip("coils", tmp_path / "s.toml", *more, "--json").stdout)
    (note,), told = found["notes"], found["coils"]
    assert note["code"] == "pulses-short"
    expected = coil_facts(scenario, 24.0, 2.0)
    assert {name: told[name]["most_field"] for name in told} == {
        name: facts.most_field for name, facts in expected.items()
    }
    assert told["clamp"]["changes"] == dimension_changes(scenario, "clamp")
