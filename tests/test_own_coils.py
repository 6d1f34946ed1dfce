"""Coils with values of their own: windings, circuits, drives and both directions."""

import math

import numpy as np
import pytest

from stickslip import COIL_NAMES, Coil, Coils, Drive, Scenario, Waveform, load, simulate, sweep
from stickslip.scenario.sections import OneCoil
from stickslip.walker.library import library

OWN = {
    "coil.clamp.side": 0.11, "coil.clamp.distance": 0.08, "coil.clamp.turns": 400.0,
    "coil.clamp.resistance": 7.0, "coil.clamp.inductance": 0.03,
}  # fmt: skip


def on_axis(side, distance, turns):
    """B/I of a square coil on its axis (Biot and Savart), T/A."""
    quarter = 0.25 * side**2
    near = distance**2 + quarter
    return 4e-7 * turns * 0.5 * side**2 / (near * math.sqrt(near + quarter))


def test_each_coil_has_the_field_of_its_own_winding():
    coils = Coils.of(Scenario().replace(OWN))
    expected = [on_axis(0.1385, 0.099, 510.0)] * 4 + [on_axis(0.11, 0.08, 400.0)]
    # The closed form and the sum of four wires round differently, by some units in the last place.
    assert coils.centre_field_per_ampere == pytest.approx(expected, rel=1e-14)
    point, currents = [1e-3, 2e-3, -1e-3], np.array([1.0, -2.0, 0.5, 3.0, 1.5])
    clamp_alone = Coils(0.11, 0.08, 400.0).field(point, currents * [0, 0, 0, 0, 1])
    others = Coils().field(point, currents * [1, 1, 1, 1, 0])
    assert coils.field(point, currents) == pytest.approx(others + clamp_alone, rel=1e-14)


def test_own_values_that_are_those_of_all_change_no_bit():
    same = {
        f"coil.{name}.{key}": getattr(Scenario().coil, key)
        for name in ("xp", "xm", "yp", "ym", "clamp")
        for key in ("resistance", "inductance", "side", "distance", "turns")
    }
    for more in ({}, {"effects.mutual_inductance.coupling": 0.1}):
        base = Scenario(drive=Drive(base=0.5e-3, pulses=5)).replace(more)
        assert simulate(base.replace(same)).summary() == simulate(base).summary()


def test_the_current_of_each_coil_follows_its_own_time_constant():
    # A step of 1 V in every coil: I = (1 - exp(-t R/L)) / R, Eq. (1).
    step = Waveform([([0.0, 0.05], np.ones((2, 5)), 1)])
    changes = {**OWN, "record.rate": 1e3, "robot.magnetization": 1.0}
    run = simulate(Scenario(drive=Drive(mode="program", program=step)).replace(changes))
    for coil, (ohm, henry) in enumerate([(10.0, 0.07)] * 4 + [(7.0, 0.03)]):
        expected = -np.expm1(-run.t * ohm / henry) / ohm
        # The sum of a steady and a fading part is near rounding of the steady one.
        assert run.current[:, coil] == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("mode", ["IPP", "OPP"])
def test_the_peak_of_the_drive_is_reached_with_each_winding(mode):
    # Held for 60 time constants, base and hold are steady.
    own = {**OWN, "coil.xp.turns": 300.0, "coil.xp.side": 0.2}
    drive = Drive(mode=mode, base=0.4e-3, peak=0.4e-3, hold=0.7e-3, frequency=1.0, pulses=1)
    changes = {**own, "record.rate": 10.0, "robot.magnetization": 1.0}
    run = simulate(Scenario(drive=drive).replace(changes))
    in_plane, clamp = (0.4e-3, 0.7e-3) if mode == "IPP" else (0.7e-3, 0.4e-3)
    # The robot lies 0.05 mm above the origin, where a coil's field differs by some 1e-3.
    assert run.bx[-1] == pytest.approx(in_plane, rel=5e-3)
    assert run.bz[-1] == pytest.approx(-clamp, rel=5e-3)


@pytest.mark.parametrize("turned_round", [False, True])
def test_a_key_of_all_coils_sets_those_that_no_key_of_one_does(turned_round):
    keys = ["coil.turns", "coil.yp.turns"]
    changes = {"coil.turns": 300.0, "coil.yp.turns": 450.0}
    if turned_round:
        keys.reverse()
        changes = dict(reversed(changes.items()))
    scenario = Scenario().replace({"coil.clamp.turns": 7.0}).replace(changes)
    assert scenario.get("coil.yp.turns") == scenario.coil.yp.turns == 450.0
    for name in ("xp", "xm", "ym", "clamp"):
        assert scenario.get(f"coil.{name}.turns") == 300.0
    assert scenario == Scenario(coil=Coil(turns=300.0, yp={"turns": 450.0}))
    base = Scenario(drive=Drive(mode="OPP", base=0.5e-3, pulses=4)).replace({"coil.xp.turns": 9.0})
    found = sweep(base, {key: [changes[key]] for key in keys})
    expected = simulate(base.replace(changes)).mean_velocity
    assert found["mean_velocity"].values.item() == expected


@pytest.mark.parametrize("count", range(1, 6))
def test_a_key_of_all_coils_reads_as_it_was_set_whatever_single_coils_have(count):
    own = {f"coil.{name}.turns": 9.0 + (k > 2) for k, name in enumerate(COIL_NAMES[:count])}
    scenario = Scenario().replace({"coil.turns": 300.0, **own})
    assert scenario.coil.turns == scenario.get("coil.turns") == 300.0
    assert scenario.coil.own_values() == own


def test_single_coils_in_a_file(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(
        "stickslip = 1\n[drive]\n[coil]\nresistance = 9\n[coil.xp]\nresistance = 10.5\n"
    )
    scenario = load(path)
    expected = Scenario(coil=Coil(resistance=9.0, xp={"resistance": 10.5}))
    assert scenario == expected
    assert hash(scenario) == hash(expected)
    assert eval(repr(scenario.coil), {"Coil": Coil, "OneCoil": OneCoil}) == scenario.coil
    text = scenario.to_toml(path)
    assert "[coil.xp]\nresistance = 10.5  # ohm\n" in text
    assert "[coil.xm]" not in text
    assert load(path) == scenario
    # A value of all coils that is set is of all coils.
    assert load(path).replace({"coil.resistance": 8.0}) == Scenario(coil=Coil(resistance=8.0))
    assert load(path).replace({"coil.ym.turns": 9.0}) == scenario.replace({"coil.ym.turns": 9.0})


def test_measured_windings_are_no_causes():
    assert not any("coil_x" in cause.name for cause in library(Scenario(), {}, 70.0))
