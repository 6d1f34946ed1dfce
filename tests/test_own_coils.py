"""Coils with values of their own: windings, circuits, drives and both directions."""

import math

import numpy as np
import pytest

from stickslip import Coils, Drive, Scenario, ScenarioError, Waveform, effects, simulate
from stickslip.diagnosis.terms.library import library

OWN = {
    "effects.coil_clamp.side": 0.11,
    "effects.coil_clamp.distance": 0.08,
    "effects.coil_clamp.turns": 400.0,
    "effects.coil_clamp.resistance": 7.0,
    "effects.coil_clamp.inductance": 0.03,
}


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
        f"effects.coil_{name}.{key}": getattr(Scenario().coil, key)
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
    own = {**OWN, "effects.coil_xp.turns": 300.0, "effects.coil_xp.side": 0.2}
    drive = Drive(mode=mode, base=0.4e-3, peak=0.4e-3, hold=0.7e-3, frequency=1.0, pulses=1)
    changes = {**own, "record.rate": 10.0, "robot.magnetization": 1.0}
    run = simulate(Scenario(drive=drive).replace(changes))
    in_plane, clamp = (0.4e-3, 0.7e-3) if mode == "IPP" else (0.7e-3, 0.4e-3)
    # The robot lies 0.05 mm above the origin, where a coil's field differs by some 1e-3.
    assert run.bx[-1] == pytest.approx(in_plane, rel=5e-3)
    assert run.bz[-1] == pytest.approx(-clamp, rel=5e-3)


def test_a_robot_that_faces_the_other_way_sees_the_mirrored_coils():
    own = {"turns": 450.0, "side": 0.15, "distance": 0.09, "resistance": 9.0, "inductance": 0.05}
    base = Scenario(drive=Drive(base=0.5e-3, pulses=6))
    ahead = simulate(base.replace({f"effects.coil_xp.{k}": v for k, v in own.items()}))
    back = simulate(
        base.replace(
            {f"effects.coil_xm.{k}": v for k, v in own.items()} | {"drive.direction": "-x"}
        )
    )
    assert back.mean_velocity == -ahead.mean_velocity
    assert ahead.mean_velocity != simulate(base).mean_velocity


def test_what_is_not_allowed():
    for key, value, allowed in [
        ("side", 1e-9, "0 (coil.side) or a number from 1e-06 to 100 m"),
        ("distance", 1e-6, "0 (coil.distance) or a number from 0.001 to 100 m"),
        ("resistance", -1.0, "a number from 0 to 1e+09 ohm"),
    ]:
        with pytest.raises(ScenarioError) as caught:
            Scenario().replace({f"effects.coil_xm.{key}": value})
        assert f"effects.coil_xm.{key} = " in str(caught.value)
        assert allowed in str(caught.value)


def test_measured_windings_are_no_suspects():
    assert {f"coil_{name}" for name in ("xp", "xm", "yp", "ym", "clamp")} <= {
        each.name for each in effects()
    }
    assert not any(cause.name.startswith("coil_x") for cause in library(Scenario(), {}, 70.0))
