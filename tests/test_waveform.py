"""Voltage programs."""

import math
import pickle

import numpy as np
import pytest

from stickslip import (
    Coil,
    Drive,
    Scenario,
    ScenarioError,
    Waveform,
    simulate,
    volts_per_tesla,
)


def blocks(waveform):
    return [(t.tolist(), v.tolist(), n) for t, v, n in waveform.blocks]


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("edge_time", [0.0, 2e-3])  # s; without, the edge is a jump
@pytest.mark.parametrize("edge", ["rise", "fall"])
@pytest.mark.parametrize(("mode", "clamp"), [("IPP", "down"), ("OPP", "up")])
def test_builders_give_every_breakpoint_of_the_drive_modes(mode, clamp, edge, edge_time, direction):
    coil, base, peak, hold = Coil(resistance=12.0, distance=0.09), 0.5e-3, 2.5e-3, 1e-3
    fields = {"frequency": 40.0, "peak": peak, "base": base, "hold": hold, "ramp": 0.05,
              "pulses": 7, "edge": edge, "edge_time": edge_time, "ramp_down": 0.1,
              "clamp": clamp, "direction": direction}  # fmt: skip
    made = (Waveform.ipp if mode == "IPP" else Waveform.opp)(coil=coil, **fields)
    core = Scenario(drive=Drive(mode=mode, **fields), coil=coil).to_core()
    assert blocks(made) == [(t.tolist(), v.tolist(), n) for t, v, n in core.program().blocks]
    top = edge_time if edge == "rise" else 1.0 / 40.0 - edge_time
    in_plane, forward = mode == "IPP", direction == "+x"
    expected = [
        ([0.0, 0.05], [0.0, base], [0.0, hold], 1),
        ([0.0, top, 1.0 / 40.0], [base, peak, base], [hold, hold, hold], 7),
        # Of the coil in the plane alone.
        ([0.0, 0.1], [base, base * (not in_plane)], [hold, hold * in_plane], 1),
    ]
    # xp, or xm, whose positive current points the other way.
    for (t, v, n), (times, tooth, held, repeats) in zip(made.blocks, expected, strict=True):
        plane, up = (tooth, np.negative(held)) if in_plane else (held, tooth)
        fields = np.zeros((len(t), 5))
        fields[:, 0 if forward else 1] = plane if forward else np.negative(plane)
        fields[:, 4] = up
        assert t == pytest.approx(np.array(times), rel=3e-16, abs=0.0)
        assert v == pytest.approx(volts_per_tesla(coil) * fields, rel=1e-15, abs=0.0)
        assert n == repeats


def test_without_ramps_there_are_no_blocks_for_them_and_any_pulses_are_one():
    ((t, _, repeats),) = Waveform.ipp(ramp=0.0, ramp_down=0.0, pulses=400_000_000).blocks
    assert (len(t), repeats) == (3, 400_000_000)


def test_volts_per_tesla_is_resistance_over_field_per_ampere():
    # The centre field of a square loop of N turns and side a at distance c:
    # B/I = mu0 N a^2 / (2 pi (c^2 + a^2/4) sqrt(c^2 + a^2/2)).
    a, c, turns, ohms = 0.1385, 0.099, 510, 10.0
    field = 4e-7 * np.pi * turns * a**2 / (2 * np.pi * (c**2 + a**2 / 4) * np.sqrt(c**2 + a**2 / 2))
    assert volts_per_tesla() == pytest.approx(ohms / field, rel=1e-12)
    assert volts_per_tesla(Coil(resistance=20.0)) == pytest.approx(2 * ohms / field, rel=1e-12)


def test_a_program_moves_the_robot_as_the_mode_does():
    fields = {"base": 0.5e-3, "pulses": 12}
    by_mode = simulate(Scenario(drive=Drive(**fields)).replace({"record.rate": 1000.0}))
    program = Drive(mode="program", program=Waveform.ipp(**fields))
    by_program = simulate(Scenario(drive=program).replace({"record.rate": 1000.0}))
    np.testing.assert_array_equal(by_program.x, by_mode.x)


def test_voltages_between_points_and_at_jumps():
    rise = Waveform.sawtooth(0.01, {"xp": 10.0}, {"xp": 30.0, "clamp": -4.0})
    # The edge is sudden, so at t = 0 the voltage is the top's; halfway down it is the mean.
    np.testing.assert_allclose(rise.voltages(0.0), [30, 0, 0, 0, -4])
    np.testing.assert_allclose(rise.voltages([0.005, 0.01])[:, 0], [20, 10])
    fall = Waveform.sawtooth(0.01, {"xp": 10.0}, {"xp": 30.0}, edge="fall")
    np.testing.assert_allclose(fall.voltages([0.0, 0.005, 0.01])[:, 0], [10, 20, 10])


def test_concatenation_and_repeats():
    tooth = Waveform.sawtooth(0.25, {"yp": 1.0}, {"yp": 3.0})
    program = Waveform.ramp(0.5, {"yp": 1.0}) + 3 * tooth + Waveform.hold(1.0, {"yp": 1.0})
    assert program.duration == 2.25
    t = np.array([0.25, 0.5, 0.625, 0.75, 1.125, 1.25, 2.25])
    np.testing.assert_allclose(program.voltages(t)[:, 2], [0.5, 3, 2, 3, 2, 1, 1])
    assert program.voltages(np.zeros((2, 3))).shape == (2, 3, 5)


def test_repeats_need_no_memory():
    program = Waveform.sawtooth(0.01, {"xp": 1.0}, {"xp": 2.0}).repeat(10**6) * 10**6
    assert len(program.blocks) == 1
    assert program.blocks[0][2] == 10**12
    assert program.duration == pytest.approx(1e10)


def test_repeats_within_repeats_are_written_out():
    tooth = Waveform.sawtooth(1.0, {"xp": 0.0}, {"xp": 1.0}, edge="fall")
    program = 2 * (3 * tooth + Waveform.hold(1.0, {"xp": 0.0}))
    assert program.duration == 8.0
    halves = np.arange(8) + 0.5
    np.testing.assert_allclose(program.voltages(halves)[:, 0], [0.5] * 3 + [0] + [0.5] * 3 + [0])
    with pytest.raises(ValueError, match="repeats within repeats"):
        (tooth * 10**6 + tooth) * 10**6


def test_what_is_left_after_an_instant():
    tooth = Waveform.sawtooth(0.01, {"xp": 5.0}, {"xp": 25.0})
    program = Waveform.ramp(0.05, {"xp": 5.0}) + 3 * tooth + Waveform.hold(0.02, {"clamp": -10.0})
    # Within a ramp, a tooth and a hold, at ends of teeth and of blocks, and at jumps.
    for t in (0.0, 0.02, 0.05, 0.0537, 0.06, 0.0699999, 0.07, 0.08, 0.09):
        rest = program.after(t)
        assert rest.duration == pytest.approx(program.duration - t, rel=1e-12)
        # Not at the jumps, on whose sides a rounded time may lie.
        inside = np.array([0.0003, 0.21, 0.4777, 0.83, 0.9999]) * rest.duration
        expected = program.voltages(t + inside)
        np.testing.assert_allclose(rest.voltages(inside), expected, atol=1e-9)
    assert program.after(0.0) == program
    single = np.float32(0.0853)
    assert program.after(single) == program.after(float(single))
    assert program.after(0.06).blocks[0][2] == 2
    for t in (-1e-3, program.duration, 1.0, math.nan, math.inf, 1e308, "soon", None):
        with pytest.raises(ValueError, match=r"allowed is from 0 to less than 0\.1"):
            program.after(t)


def test_what_is_left_after_a_jump_begins_after_it():
    low, high = Waveform.hold(0.01, {"xp": 5.0}), Waveform.hold(0.01, {"xp": 25.0})
    steps = (low + high).repeat(40)
    for count in (1, 2, 3, 29, 61):
        # 0.01 is no double, so that products and sums of it are rounded.
        for t in (0.01 * count, sum([0.01] * count)):
            rest = steps.after(t)
            assert rest.voltages(0.0)[0] == (25.0 if count % 2 else 5.0)
            assert rest.blocks[0][0][1] == pytest.approx(0.01)
    # The tolerance is of what was cut, and not of blocks that follow.
    short = Waveform.hold(1000.0, {"xp": 5.0}) + 5 * Waveform.ramp(5e-10, {"xp": 25.0})
    assert short.after(1000.0) == 5 * Waveform.ramp(5e-10, {"xp": 25.0})


def test_a_run_is_entered_in_the_middle_of_its_drive():
    program = Waveform.ipp(base=0.5e-3, pulses=5)

    def driven(voltages, **more):
        return Scenario(drive=Drive(mode="program", program=voltages), **more)

    whole = simulate(driven(program)).final_state
    cut = simulate(driven(program), until="time >= 0.0737").final_state
    onward = simulate(driven(program.after(0.0737), initial=cut)).final_state
    # The robot walks 0.1 mm; the solver's tolerance is 1e-8 of that and less.
    assert onward.x == pytest.approx(whole.x, abs=1e-9)
    assert abs(whole.x - cut.x) > 2e-5


def test_times_that_fall_by_rounding_are_jumps():
    falling = [0.0, np.nextafter(0.055, 1.0), 0.055, 0.06]
    rows = np.arange(20.0).reshape(4, 5)
    assert Waveform.from_points(falling, rows).voltages(0.0551)[0] > 10.0
    for duration in (-1.0, 0.0, math.inf):
        with pytest.raises(ValueError, match="duration = "):
            Waveform.hold(duration, {"xp": 1.0})


def test_turned_is_its_own_inverse_and_swaps_the_pair():
    wave = Waveform.hold(1.0, [1, 2, 3, 4, 5])
    np.testing.assert_array_equal(wave.turned().voltages(0.5), [-2, -1, -4, -3, 5])
    assert wave.turned().turned() == wave


def test_csv_keeps_every_bit_and_any_order_of_columns(tmp_path):
    rng = np.random.default_rng(20080625)
    t = np.concatenate([[0.0], np.sort(rng.random(6)).repeat(2)])
    waveform = Waveform.from_points(t, rng.normal(size=(13, 5)))
    path = tmp_path / "voltages.csv"
    waveform.write(path)
    assert Waveform.from_csv(path) == waveform

    rows = [line.split(",") for line in path.read_text().splitlines()]
    shuffled = tmp_path / "shuffled.csv"
    order = [3, 5, 0, 1, 4, 2]
    lines = [", ".join(row[i] for i in order) for row in rows]
    shuffled.write_text("﻿" + "\r\n".join(lines) + "\r\n\r\n", encoding="utf-8")
    assert Waveform.from_csv(shuffled) == waveform


def test_waveforms_are_values():
    waveform = Waveform.opp(pulses=3)
    assert pickle.loads(pickle.dumps(waveform)) == waveform
    assert hash(Waveform.opp(pulses=3)) == hash(waveform)
    assert waveform != Waveform.opp(pulses=4)
    with pytest.raises(ValueError, match="read-only"):
        waveform.blocks[0][1][0, 0] = 3.0


def test_a_program_has_no_sawtooth_beside_it():
    program = Waveform.hold(0.1, {"clamp": -10.0})
    given = {"mode": "program", "program": program}
    played = Scenario(drive=Drive(**given))
    for key, value in {"frequency": 45.0, "clamp": "up", "heading": 0.5, "coils": "pairs"}.items():
        with pytest.raises(ScenarioError, match=f"drive.{key}: not allowed with drive.mode"):
            played.replace({f"drive.{key}": value})
    # Where a sawtooth gives way to a program, nothing of it is left.
    sawtooth = Scenario(drive=Drive(mode="OPP", frequency=45.0, peak=1e-3))
    replaced = sawtooth.replace({f"drive.{key}": value for key, value in given.items()})
    assert replaced == played


@pytest.mark.parametrize("frequency", [7.0, 30.0, 33.3, 100.0, 123.456, 250.0])
@pytest.mark.parametrize("pulses", [1, 7, 30])
def test_points_of_a_repeated_waveform_can_be_read_back(frequency, pulses, tmp_path):
    # A sum of periods rounds: no time may fall below the one before it.
    waveform = Waveform.ipp(frequency=frequency, pulses=pulses, base=0.5e-3, ramp_down=0.013)
    t, voltages = waveform.points()
    assert np.all(np.diff(t) >= 0.0)
    once = Waveform.from_points(t, voltages)
    assert once.duration == pytest.approx(waveform.duration, rel=1e-14)
    waveform.write(tmp_path / "v.csv")
    assert Waveform.from_csv(tmp_path / "v.csv") == once
    twice = waveform * 2
    assert np.all(np.diff(twice.points()[0]) >= 0.0)
    middle = ((t[1:] + t[:-1]) / 2)[np.diff(t) > 1e-9]  # not at jumps
    assert once.voltages(middle) == pytest.approx(waveform.voltages(middle), abs=1e-9)


def test_a_row_that_is_there_again_is_no_third_one(tmp_path):
    # As where files of pieces are put together.
    (tmp_path / "v.csv").write_text(
        "t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n1,5,0,0,0,0\n1,5,0,0,0,0\n1,9,0,0,0,0\n2,5,0,0,0,0\n"
    )
    read = Waveform.from_csv(tmp_path / "v.csv")
    assert read.voltages([0.5, 1.0, 1.5])[:, 0].tolist() == [2.5, 9.0, 7.0]


def test_points_of_pieces_that_jump_where_they_meet_are_two(tmp_path):
    # Each of the first two pieces ends with a jump and the next begins with one.
    def piece(*volts):
        return Waveform.from_points([0, 0, 1, 1], [[v, 0, 0, 0, 0] for v in volts])

    whole = piece(0, 1, 2, 3) + 2 * piece(4, 5, 6, 5) + piece(7, 7, 8, 8)
    t, v = whole.points()
    assert t.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4]
    assert v[:, 0].tolist() == [0, 1, 2, 5, 6, 5, 6, 7, 8]
    whole.write(tmp_path / "v.csv")
    read = Waveform.from_csv(tmp_path / "v.csv")
    times = np.linspace(0.0, 4.0, 33)[:-1]
    np.testing.assert_array_equal(read.voltages(times), whole.voltages(times))
