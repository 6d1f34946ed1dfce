"""What counts as a reading: rows that no sensor gave by itself, of each ready-made machine."""

import math

import numpy as np
import pytest

from diagnosis.test_lost_readings import KINDS, N, T, record
from stickslip import ScenarioError, Series
from stickslip.diagnosis.data.readings import unwrap

AT = np.arange(N)


def logged(how, n, inputs, y):
    """Times, readings and inputs as a logger or a tool writes them, and the readings that count."""
    t, row, whole = T, AT, np.ones(N, dtype=bool)
    if how in ("held", "lines"):
        fine = np.arange((N - 1) * n + 1) / n
        row, t, whole = fine.astype(int), np.interp(fine, AT, T), fine % 1 == 0.0
        y = y[row] if how == "held" else np.interp(fine, AT, y)
    elif how == "slow sensor":
        first = np.ceil(np.floor(AT / n) * n).astype(int)
        y, whole = y[first], first == AT
    elif how == "mean":
        y, whole = np.convolve(np.r_[np.full(n - 1, y[0]), y], np.full(n, 1 / n), "valid"), None
    elif how == "mean about each":
        more = np.r_[np.full(n // 2, y[0]), y, np.full(n // 2, y[-1])]
        y, whole = np.convolve(more, np.full(n, 1 / n), "valid"), None
    else:
        low, high = {"largest": (0, n), "least": (n, 0), "both": (n, n)}[how]
        y = np.clip(y, *np.quantile(y, [low / 100, 1 - high / 100]))
        whole = (y > y.min() if low else whole) & (y < y.max() if high else whole)
    return t, y, {name: u[row] for name, u in inputs.items()}, whole


HOW = [("held", 2, "repeated"), ("held", 5, "repeated"), ("slow sensor", 3, "repeated"),
       ("slow sensor", 1.6, "repeated"), ("lines", 2, "on-lines"), ("lines", 5, "on-lines"),
       ("lines", 20, "on-lines"), ("mean", 3, "averaged"), ("mean", 9, "averaged"),
       ("mean about each", 5, "averaged"), ("largest", 10, "saturated"), ("least", 25, "saturated"),
       ("both", 20, "saturated"), ("largest", 60, "clipped")]  # fmt: skip


@pytest.mark.parametrize("make", KINDS)
@pytest.mark.parametrize(("how", "n", "code"), HOW)
def test_rows_that_are_no_readings_are_told_and_left_out(make, how, n, code):
    inputs, y = record(make)
    t, read, acting, whole = logged(how, n, inputs, y)
    series = Series(t, read, acting, unit="-")
    assert [note.code for note in series.own_notes] == [code]
    if code == "averaged":
        assert (len(series.window), len(series)) == (n, (N - n // 2) // n)
    elif code == "clipped":  # too many to be left out
        assert len(series) == N
    else:
        assert np.array_equal(series.rows, np.flatnonzero(whole))
        assert np.array_equal(series.whole.inputs[next(iter(acting))], next(iter(acting.values())))


def test_rows_of_a_file_with_few_digits_count_as_those_of_a_computer():
    inputs, y = record(KINDS[0])
    for how, n, code in HOW:
        t, read, acting, _ = logged(how, n, inputs, y)
        series = Series(t, np.round(read, 5), acting)
        assert [note.code for note in series.own_notes] == [code], (how, n)


def test_a_mean_is_predicted_as_one():
    of = Series(T, np.zeros(N), {}, sd=1.0)
    part = of.having(whole=of, kept=np.arange(8, N, 9), window=range(-8, 1), first=np.arange(44))
    made = part.of_conditions(lambda table: np.stack([table.t, table.t**2]))
    assert made[0] == pytest.approx(T[8::9] - 4 * T[1])
    square = np.convolve(T**2, np.full(9, 1 / 9), "valid")
    assert made[1] == pytest.approx(square[::9])
    assert [*map(list, {len(one.window): one.window for one in part.windows()}.values())] == [
        list(range(-4, 5)), [0]]  # fmt: skip


TURNS = 2.0 * np.sin(2.0 * T) + T


@pytest.mark.parametrize("part", [1, 2, 4, 7, 12, 1 / 3])
@pytest.mark.parametrize("noise", [0.0, 0.003])
@pytest.mark.parametrize("low", [0.0, -0.5])
def test_angles_that_wrap_after_a_part_of_a_turn_are_unwrap(part, noise, low):
    span = math.tau / part
    y = TURNS * max(1.0, 2.0 / part) + noise * np.random.default_rng(2).standard_normal(N)
    made, notes = unwrap("", (y - low * span) % span + low * span, "rad")
    assert [note.code for note in notes] == ["unwrapped"]
    assert made - made[0] == pytest.approx(y - y[0], abs=1e-9)


@pytest.mark.parametrize("y", [TURNS, np.sign(np.sin(9 * T)), 10.0 * np.sin(200 * T), T * 0.0])
def test_what_only_jumps_is_not_unwrap(y):
    assert unwrap("", y, "m") == (pytest.approx(y), [])


def test_two_rows_of_one_time_are_an_event():
    u = np.where(AT < 100, 0.0, 1.0)
    twice = np.sort(np.r_[AT, 100])
    log = Series(T[twice], T[twice], {"u": np.insert(u, 100, 0.0)}, sd=1.0)
    assert len(log) == N
    assert np.array_equal(log.y, T)
    assert log.whole.inputs["u"][99:103].tolist() == [0.0, 0.0, 1.0, 1.0]
    with pytest.raises(ScenarioError, match=r"row 101 = .*or the same reading at an event"):
        Series(T[twice], np.arange(N + 1.0), sd=1.0)


def test_readings_behind_a_gap_in_which_an_input_changed_start_anew():
    _, y = record(KINDS[-1])
    power = np.where(AT < 200, 60.0, 0.0)
    near, far = (~((AT > 195) & (195 + n > AT)) for n in (4, 12))
    log = Series(T, y, {"power": power}, sd=0.1, name="heater")
    assert len(log.pieces()) == 1
    for kept, parts in ((near, 1), (far, 2), (far & (AT < 205), 1)):
        made = Series(T[kept], y[kept], {"power": power[kept]}, sd=0.1, name="heater").pieces()
        assert len(made) == parts
    first, second = Series(T[far], y[far], {"power": power[far]}, sd=0.1, name="heater").pieces()
    assert np.array_equal(np.r_[first.y, second.y], y[far])
    assert (first.name, second.name) == ("heater", f"heater from {T[207]:.6g} s")
    assert [note.code for note in second.own_notes] == ["gap"]
    steady = Series(T[far], y[far], {"power": 0.0 * power[far]}, sd=0.1)
    assert len(steady.pieces()) == 1


def first_order(u, rate=0.08):
    y = [0.0]
    for each in u[:-1]:
        y.append(y[-1] + rate * (each - y[-1]))
    return np.array(y)


def levels(hold, seed=3):
    return np.repeat(np.random.default_rng(seed).uniform(-1.0, 1.0, N // hold + 1), hold)[:N]


CHIRP = np.sin(40.0 * T**2 / 2.0)
REST = np.where((T > 2.0) & (T < 5.0), 0.0, np.sin(3.0 * T))
# Inputs, and readings without noise, of which each is one.
SOUND = {
    "a pulse in a hundred": (np.where(AT % 100 < 10, 1.0, 0.0), None),
    **{f"levels of {hold} rows": (levels(hold), None) for hold in (5, 8, 10, 20)},
    **{f"a binary sequence of {hold} rows": (np.sign(levels(hold)), None) for hold in (5, 8, 10)},
    **{f"a square of {period} rows": (np.where(AT % period < period // 2, 1.0, -1.0), None)
       for period in (8, 10, 16, 20)},
    "a chirp": (CHIRP, None), "a counter": (0.0 * T, AT // 2 * 1.0),
    **{f"a sine of {period} rows": (0.0 * T, np.sin(2.0 * np.pi * AT / period))
       for period in (4, 5, 10)},
    "a rest": (0.0 * T, REST), "a line": (0.0 * T, T),
    "a square that is read": (0.0 * T, np.where(T % 2.0 < 1.0, 0.0, 1.5)),
}  # fmt: skip


@pytest.mark.parametrize("noise", [0.0, 1e-6, 2e-3])
@pytest.mark.parametrize("name", SOUND)
def test_readings_of_usual_inputs_all_count(name, noise):
    if name == "a counter" and noise == 1e-6:
        pytest.skip("a staircase of two rows with less noise than any meter is taken for a mean")
    u, y = SOUND[name]
    y = first_order(u) if y is None else y
    still = (y == 0.0) if name == "a rest" else np.zeros(N, dtype=bool)
    y = y + np.where(still, 0.0, noise * np.random.default_rng(1).standard_normal(N))
    series = Series(T, y, {"u": u}, unit="rad")
    assert (series.own_notes, len(series)) == ((), N)


@pytest.mark.parametrize("height", [1.57, math.pi, 0.3])
def test_set_points_are_not_unwrapped(height):
    goal = np.where(T % 2.0 < 1.0, 0.0, height) - 0.5 * height * (height == math.pi)
    assert unwrap("", goal, "rad", parts=False) == (pytest.approx(goal), [])
    assert unwrap("", 2.0 * goal, "rad", parts=False) == (pytest.approx(2.0 * goal), [])
