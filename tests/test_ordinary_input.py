"""Ordinary input of laboratories: kinds of arrays, tracks, models and tables of readings."""

import datetime
import pickle
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pint
import polars
import pytest
import xarray
from astropy import units as astropy_units

from made_velocities import drives, measurement, trials
from stickslip import (
    COIL_NAMES,
    STATE_COLUMNS,
    Accelerations,
    Cause,
    Coils,
    Drive,
    FieldMap,
    Parameter,
    Prior,
    Scenario,
    ScenarioError,
    Series,
    State,
    Table,
    Waveform,
    diagnose,
    diagnose_model,
    events,
    instruments,
    optimise,
    rollout,
    simulate,
    sweep,
    velocity_of_track,
)
from stickslip.control.environments import RobotEnv
from stickslip.diagnosis.data.series import with_repeats
from stickslip.diagnosis.model import ForwardModel
from stickslip.models import vectorised
from stickslip.walker.exposure import record

V = np.arange(1.0, 13.0)
PLANE = np.array([1.0, 1.0, 0.0, 0.0, 1.0])  # of the five coils those in the plane y = 0
ROW = np.arange(12.0)
SLOW = Drive(frequency=2.0, pulses=30)  # of which 1.55 to 15.05 s are measured


def track(t):
    return [velocity_of_track(t, 1e-4 * ROW, SLOW)["velocity"]]


# What a door makes of a row, its unit, and whether it leaves out a gap or refuses it.
DOORS = {
    "Table y": (lambda v: Table({"x": ROW}, v, sd=1.0, unit="m").y, "m", True),
    "Table setting": (lambda v: Table({"x": v}, ROW, sd=1.0)["x"], None, True),
    "Table array": (lambda v: Table(v, ROW, sd=1.0).settings, None, True),
    "Table sd": (lambda v: Table({"x": ROW}, ROW, sd=v, unit="m").errors.sd, "m", True),
    "Series y": (lambda v: Series(ROW, v, sd=1.0, unit="m").y, "m", True),
    "Series sd": (lambda v: Series(ROW, ROW, sd=v, unit="m").errors.sd, "m", True),
    "Series t": (lambda v: Series(v, ROW, sd=1.0).t, "s", False),
    "Series input": (lambda v: Series(ROW, ROW, {"u": v}, sd=1.0)["u"], None, False),
    "delay": (lambda v: [instruments.delay(v, 1.0).parameters[0].size], "s", False),
    "Waveform": (lambda v: Waveform.hold(1.0, v[:5]).points()[1], "V", False),
    "Coils": (lambda v: Coils().field([0.0, 0.0, 0.01], v[:5]), "A", False),
    "track": (track, "s", True),
}

SAME = {
    "float32": lambda v: v.astype(np.float32),
    "big-endian": lambda v: v.astype(">f8"),
    "int": lambda v: v.astype(int),
    "list": lambda v: v.tolist(),
    "objects": lambda v: np.array([*v[:-1], int(v[-1])], dtype=object),
    "Decimal": lambda v: [Decimal(str(each)) for each in v],
    "Fraction": lambda v: [Fraction(int(each), 1) for each in v],
    "pandas": lambda v: pd.Series(v),
    "pandas Int64": lambda v: pd.Series(v).astype("Int64"),
    "category": lambda v: pd.Series(pd.Categorical(v)),
    "polars": lambda v: polars.Series(v),
    "no mask": lambda v: np.ma.array(v),
    "memory": lambda v: memoryview(v.copy()),
    "durations": lambda v: (1000 * v).astype("timedelta64[ms]"),
    "objects of durations": lambda v: np.array([*(1000 * v).astype("timedelta64[ms]"), None])[:-1],
    "timedelta": lambda v: [datetime.timedelta(seconds=each) for each in v.tolist()],
}
GAPS = {
    "mask": lambda v: np.ma.masked_values(np.where(ROW == 3, -9999.0, v), -9999.0),
    "NaN": lambda v: np.where(ROW == 3, np.nan, v),
    "None": lambda v: [None if k == 3 else each for k, each in enumerate(v.tolist())],
    "NA": lambda v: pd.Series(v).astype("Int64").where(ROW != 3),
    "NaT": lambda v: pd.to_timedelta(pd.Series(np.where(ROW == 3, np.nan, v)), "s"),
    "null": lambda v: polars.Series([None if k == 3 else each for k, each in enumerate(v)]),
}
REFUSED = {
    "complex": (lambda v: v + 0j, "allowed"),
    "text among numbers": (lambda v: [*v[:3].tolist(), "4,0", *v[4:].tolist()], "row 3"),
    "word": (lambda v: ["b", *v[1:].tolist()], "row 0"),
    "infinite": (lambda v: np.where(ROW == 3, np.inf, v), "row 3"),
    "a date among numbers": (
        lambda v: [datetime.date(2026, 1, 5) if each == 4 else each for each in v],
        "row 3",
    ),
    "months": (lambda v: v.astype(int).astype("timedelta64[M]"), "allowed"),
    "durations without a unit": (lambda v: v.astype(int).astype("timedelta64"), "allowed"),
}


@pytest.mark.parametrize("kind", SAME)
@pytest.mark.parametrize("door", DOORS)
def test_numbers_of_any_kind_are_the_same_numbers(door, kind):
    make, _, _ = DOORS[door]
    np.testing.assert_array_equal(make(SAME[kind](V)), make(V))


def test_truths_have_no_unit():
    # As xarray keeps it through a comparison.
    above = xarray.DataArray(V > 4, attrs={"units": "mm"})
    with pytest.raises(ScenarioError, match="true and false have no unit"):
        Series(np.arange(len(V)), above, unit="m")


@pytest.mark.parametrize("matrix", [V[:, None], V[None, :]], ids=["column", "row"])
@pytest.mark.parametrize("door", sorted(DOORS.keys() - {"Table array", "Waveform", "Coils"}))
def test_a_matrix_of_one_row_or_column_is_a_row(door, matrix):
    # As MATLAB stores a vector. The doors that are left out take matrices.
    make, _, _ = DOORS[door]
    np.testing.assert_array_equal(make(matrix), make(V))


@pytest.mark.parametrize("kind", GAPS)
@pytest.mark.parametrize("door", DOORS)
def test_a_gap_is_left_out_or_refused_with_its_row(door, kind):
    make, _, leaves_out = DOORS[door]
    if not leaves_out:
        with pytest.raises(ScenarioError, match="row 3"):
            make(GAPS[kind](V))
        return
    found = np.asarray(make(GAPS[kind](V)))
    assert np.isfinite(found).all()
    assert found.size in (1, 11)  # a velocity, or a row less


@pytest.mark.parametrize("kind", REFUSED)
@pytest.mark.parametrize("door", DOORS)
def test_what_is_no_number_is_refused(door, kind):
    values, said = REFUSED[kind]
    with pytest.raises(ScenarioError, match=said):
        DOORS[door][0](values(V))


@pytest.mark.parametrize("door", DOORS)
def test_a_unit_is_converted_or_refused(door):
    make, unit, _ = DOORS[door]
    for quantity in (pint.Quantity(1e3 * V, f"m{unit}"), 1e3 * V * astropy_units.Unit(f"m{unit}")) \
            if unit else ():  # fmt: skip
        np.testing.assert_allclose(make(quantity), make(V), rtol=1e-12)
    if unit:
        with pytest.raises(ScenarioError, match="kelvin"):
            make(pint.Quantity(V, "kelvin"))
        return
    # What has no unit of its own takes the numbers in SI.
    np.testing.assert_allclose(make(pint.Quantity(1e3 * V, "millikelvin")), make(V), rtol=1e-12)


TENTH = {
    "degC": pint.Quantity(0.1, "degC"),
    "delta_degC": pint.Quantity(np.full(12, 0.1), "delta_degC"),
    "K": pint.Quantity(0.1, "kelvin"),
    "degF": pint.Quantity(0.18, "degF"),
    "xarray": xarray.DataArray(0.1, attrs={"units": "degC"}),
    "astropy": 0.1 * astropy_units.K,
    "masked": pint.Quantity(np.ma.masked_equal(np.where(ROW == 3, 9.0, 0.1), 9.0), "degC"),
}


@pytest.mark.parametrize("unit", ["K", "degC"])
@pytest.mark.parametrize("door", ["Table sd", "Series sd"])
@pytest.mark.parametrize("kind", TENTH)
def test_an_error_of_a_temperature_is_a_difference(kind, door, unit):
    make = {
        "Table sd": lambda v: Table({"x": ROW}, ROW, sd=v, unit=unit).errors.sd,
        "Series sd": lambda v: Series(ROW, ROW, sd=v, unit=unit).errors.sd,
    }[door]
    np.testing.assert_allclose(make(TENTH[kind]), 0.1, rtol=1e-12)


def test_readings_of_a_temperature_are_none_and_neither_is_the_scatter_of_their_repeats():
    t, warm = np.arange(60.0), 20.0 + np.random.default_rng(0).normal(size=(2, 60))
    sizes = []
    for given in (pint.Quantity(warm, "degC"), warm + 273.15):
        first, again = (
            Series(t, given[k], name=f"{k}", repeat_of="0" if k else None, unit="K") for k in (0, 1)
        )
        np.testing.assert_allclose(first.y, warm[0] + 273.15)
        sizes.append([each.errors.sizes["s0"] for each in with_repeats([first, again])])
    np.testing.assert_allclose(*sizes)
    assert max(sizes[0]) < 2.0


@pytest.mark.parametrize("door", DOORS)
def test_what_a_user_does_afterwards_changes_nothing(door):
    make, _, _ = DOORS[door]
    given = V.copy()
    found = make(given)
    given *= 2.0
    np.testing.assert_array_equal(found, make(V))


def test_dates_are_seconds_from_the_first():
    dates = pd.date_range("2026-01-05", periods=12, freq="10s")
    for given in (
        dates,
        dates.tz_localize("UTC"),
        dates.to_numpy().astype("datetime64[s]"),
        list(dates.to_pydatetime()),
        polars.Series(dates.to_pydatetime().tolist()),
    ):
        np.testing.assert_array_equal(Series(given, ROW, sd=1.0).t, 10.0 * ROW)
        np.testing.assert_array_equal(Table({"t": given}, ROW, sd=1.0)["t"], 10.0 * ROW)


def test_tables_are_read_by_columns():
    frame = pd.DataFrame({"x": V, "word": ["a", "b"] * 6})
    rows = frame.to_dict("records")
    for given in (frame, frame.to_records(index=False), polars.DataFrame(rows), rows):
        table = Table(given, ROW, sd=1.0)
        np.testing.assert_array_equal(table["x"], V)
        assert table["word"].tolist() == ["a", "b"] * 6
        assert not table["x"].flags.writeable
    with pytest.raises(ScenarioError, match='column "x" is there twice'):
        Table(pd.concat([frame[["x"]]] * 2, axis=1), ROW, sd=1.0)
    with pytest.raises(ScenarioError, match=r'column "drive\.frequency" is there twice'):
        sweep(WALK, pd.DataFrame([[50.0, 60.0]], columns=["drive.frequency"] * 2))
    with pytest.raises(ScenarioError, match="another index than y"):
        Table(frame[["x"]][::-1], pd.Series(ROW), sd=1.0)


PROGRAM = np.random.default_rng(0).uniform(1.0, 5.0, (3, 5))
PLACES = np.random.default_rng(1).uniform(-5e-3, 5e-3, (60, 3))
MAPPED = np.stack([Coils().field(PLACES, one) for one in np.eye(5)], axis=1)
CORNERS = np.array([[0.0, 0.0], [2e-3, 0.0], [2e-3, 1e-3]])
SHAKEN = np.array([[0.0, 1.0, 2.0], [0.1, -1.0, 3.0], [0.2, 1.0, 2.0]])
STATE = np.array([Scenario().initial.row])


def seen_goal(task, **options):
    """Where an environment shows the goal, from a robot 0.2 mm before a corner of `CORNERS`."""
    near = Scenario(initial=State(x=-0.2e-3))
    return RobotEnv(task=task, scenario=near, **options).reset(seed=1)[0][:2]


# What a door makes of numbers whose last axis it knows by name, the names, and numbers.
NAMED = {
    "waveform": (lambda v: Waveform.from_points([0, 1, 2], v).points()[1], COIL_NAMES, PROGRAM),
    "voltages": (lambda v: Waveform.hold(1.0, v).points()[1], COIL_NAMES, PROGRAM[0]),
    "rollout": (lambda v: rollout(Scenario(), None, v, 1e-3).states, COIL_NAMES, PROGRAM * PLANE),
    "states": (
        lambda v: rollout(Scenario(), v, PROGRAM * PLANE, 1e-3).states, STATE_COLUMNS, STATE
    ),
    "row": (lambda v: State.from_row(v).row, STATE_COLUMNS, STATE[0]),
    "currents": (lambda v: Coils().field([0.0, 0.0, 0.0], v), COIL_NAMES, PROGRAM),
    "points": (lambda v: Coils().field(v, PROGRAM[0]), tuple("xyz"), PLACES),
    "turns": (lambda v: Coils(turns=v).turns, COIL_NAMES, 100.0 * PROGRAM[0]),
    "map": (lambda v: FieldMap.from_points(v, MAPPED).coefficients, tuple("xyz"), PLACES),
    "path": (lambda v: seen_goal("follow", path=v), tuple("xy"), CORNERS),
    "goal": (lambda v: seen_goal("reach", goal=v), tuple("xy"), CORNERS[2]),
    "shake": (lambda v: Accelerations(v).rows, ("t", "ax", "az"), SHAKEN),
}  # fmt: skip
LABELLED = {
    "pandas": lambda v, names: pd.DataFrame(v, columns=names),
    "polars": lambda v, names: polars.DataFrame(dict(zip(names, v.T, strict=True))),
    "structured": lambda v, names: pd.DataFrame(v, columns=names).to_records(index=False),
    "dict": lambda v, names: dict(zip(names, v.T, strict=True)),
}


@pytest.mark.parametrize("kind", LABELLED)
@pytest.mark.parametrize("door", NAMED)
def test_columns_with_names_are_read_by_them(door, kind):
    make, names, values = NAMED[door]
    label = LABELLED[kind]
    if values.ndim == 1:
        label = {"dict": label}.get(kind, lambda v, names: pd.Series(v, index=names))
    expected = make(values)
    names, turned = list(names), values[..., ::-1]
    np.testing.assert_array_equal(make(label(values, names)), expected)
    np.testing.assert_array_equal(make(label(turned, names[::-1])), expected)
    with pytest.raises(ScenarioError, match='"other": '):
        make(label(values, ["other", *names[1:]]))
    if door != "voltages":  # of which those that are not named are 0
        with pytest.raises(ScenarioError, match=f"no {names[-1]}; allowed are all of"):
            make(label(values[..., :-1], names[:-1]))


def test_rows_with_gaps_are_named():
    table = Table({"x": np.where(ROW == 2, np.nan, V)}, np.where(ROW == 5, np.nan, ROW), sd=1.0)
    (said,) = table.notes
    assert (said.code, said.value) == ("gaps", 2)
    assert "rows 2, 5: 2 of 12 rows" in said.text


def filled(table, p):
    """How far a tank is filled, by all that ran in since the record began."""
    steps = np.diff(table.t, prepend=table.t[0])
    return p["slope"] * np.cumsum(table["inflow"] * steps)


@pytest.mark.parametrize("gap", [np.nan, None])
@pytest.mark.parametrize("named", [False, True])
def test_what_was_put_in_while_nothing_was_read_counts(gap, named):
    """And of what is left out afterwards, a model is still asked for all from the first on."""
    t, random = np.arange(40.0), np.random.default_rng(2)
    inflow = random.uniform(0.0, 2.0, 40)
    whole = Series(t, np.cumsum(inflow * np.diff(t, prepend=0.0)), {"inflow": inflow}, 0.01)
    expected = filled(whole, {"slope": np.ones((1, 1))})[0]
    read = [gap if 10 <= k < 20 else value for k, value in enumerate(expected)]
    tank = Series(t, read, {"inflow": inflow}, 0.01)
    if named:
        tank = tank.named("tank")
        assert tank.whole.name == "tank"
    model = ForwardModel(filled, None, (Parameter("slope", Prior("normal", 1.0, 0.1)),), ())
    for table in (
        tank,
        tank.without(np.arange(30) == 3, "lost."),
        tank.without(np.arange(30) == 3, "lost.").without(np.arange(29) < 5, "lost."),
    ):
        found = table.of_conditions(lambda whole: model(whole, ["slope"], np.ones((1, 1))))[0]
        assert found == pytest.approx(table.y, rel=1e-12)


def test_a_table_without_more_and_more_rows_is_predicted_as_the_first():
    """A model may be one of the whole table: here the place in it counts."""

    def place(table, p):
        return p["slope"] * np.arange(len(table["x"]), dtype=float)

    table = Table({"x": V}, np.arange(12.0), sd=1.0)
    fewer = table.without(np.arange(12) == 2, "lost.").without(np.arange(11) == 0, "lost.")
    model = ForwardModel(place, None, (Parameter("slope", Prior("normal", 1.0, 0.1)),), ())
    found = fewer.of_conditions(lambda whole: model(whole, ["slope"], np.ones((1, 1))))[0]
    assert found.tolist() == [1.0, *map(float, range(3, 12))] == fewer.y.tolist()
    assert fewer.rows.tolist() == [1, *range(3, 12)]


def test_truths_beside_a_gap_stay_truths():
    table = Table({"on": [True, None, False, True]}, [1.0, 2.0, 3.0, 4.0], sd=1.0)
    assert table["on"].tolist() == [True, False, True]
    assert table["on"].dtype == bool


@pytest.mark.parametrize("nothing", [np.nan, None, pd.NA])
def test_a_reading_of_no_known_set_up_has_one_of_its_own(nothing):
    x, known = np.tile(np.arange(6.0), 6), np.repeat(np.arange(6), 6) < 2
    y = 10.0 * x + np.random.default_rng(0).standard_normal(36)
    own = np.where(known, np.repeat(["a", "b"], 18), np.arange(36).astype(str))
    missing = [each if is_known else nothing for each, is_known in zip(own, known, strict=True)]
    one, other = (Table({"x": x}, y, block=each).errors for each in (own, missing))
    np.testing.assert_array_equal(one.sd, other.sd)


@pytest.mark.parametrize("origin", [0.0, 1.7e9, 1.7e12, 2460000.5])
def test_settings_are_told_apart_by_their_spread(origin):
    table = Table({"t": origin + 60.0 * ROW}, ROW, sd=1.0)
    assert len(table.mean) == 12
    assert not table.notes
    near = Table({"t": origin + np.repeat([0.0, 600.0], 6) + 1e-5 * (ROW == 7)}, ROW, sd=1.0)
    merged = origin < 1e12  # else it is beyond the digits of a double
    assert len(near.mean) == 2
    assert [each.code for each in near.notes] == ["equal-settings"] * merged


# ---------------------------------------------------------------------------------------- tracks

FRAMES = np.arange(0.0, 0.31, 0.005)
LONG = Drive(frequency=50.0, pulses=13)
WALKED = 1e-3 * FRAMES + 1e-3 + 2e-6 * np.random.default_rng(0).standard_normal(len(FRAMES))
ROWS = np.arange(len(FRAMES))
SPOILT = {
    "one written as 0": np.arange(len(FRAMES)) == 40,
    "some written as 0": np.arange(len(FRAMES)) % 7 == 3,
    "every third": np.arange(len(FRAMES)) % 3 == 0,
    "several in a row": (FRAMES > 0.2) & (FRAMES < 0.22),
}


@pytest.mark.parametrize("value", [0.0, -1.0, 0.02])
@pytest.mark.parametrize("lost", SPOILT)
def test_frames_without_the_robot_are_left_out(lost, value):
    sound = velocity_of_track(FRAMES, np.where(SPOILT[lost], np.nan, WALKED), LONG)
    with pytest.warns(UserWarning, match="left out") as said:
        found = velocity_of_track(FRAMES, np.where(SPOILT[lost], value, WALKED), LONG)
    assert said[0].filename == __file__
    assert found == sound
    assert abs(found["velocity"] - 1e-3) < 3.0 * found["standard_error"]


def test_a_speck_within_a_body_is_left_out():
    with pytest.warns(UserWarning, match=r"1 of 40 frames .* t = 0.2 s"):
        found = velocity_of_track(FRAMES, WALKED + 50e-6 * (FRAMES[40] == FRAMES), LONG)
    assert abs(found["velocity"] - 1e-3) < 3.0 * found["standard_error"]


@pytest.mark.parametrize(
    ("t", "x", "said"),
    [
        (np.r_[FRAMES, FRAMES], np.r_[WALKED, WALKED + 1e-4], "two places at t = 0 s.* digits"),
        (FRAMES, WALKED + 2e-3 * (ROWS % 2), "two places in turn"),
        (FRAMES[ROWS % 7 > 0], (WALKED + 2e-3 * (ROWS % 2))[ROWS % 7 > 0], "two places in turn"),
        (FRAMES, np.where(FRAMES > 0.2, 2e-3 + WALKED, WALKED), "another body from t = 0.205 s"),
        (FRAMES, np.where(FRAMES > 0.2, 2e-3, WALKED), "another body from t = 0.205 s"),
    ],
)
def test_two_bodies_are_refused_with_the_time(t, x, said):
    with pytest.raises(ScenarioError, match=said):
        velocity_of_track(t, x, LONG)


def test_any_whole_pulses_of_a_walk_are_enough():
    some = (FRAMES > 0.165) & (FRAMES < 0.275)
    found = velocity_of_track(FRAMES[some], WALKED[some], LONG)
    assert found["pulses"] == 3 + 4  # 0.17 to 0.27 s hold those from 0.19 to 0.27 s
    assert abs(found["velocity"] - 1e-3) < 3.0 * found["standard_error"]


# ------------------------------------------------------------------------- models of one's own


def line(table, p):
    return p["slope"] * table["x"] + p.get("wave.h", 0.0) * np.sin(5.0 * table["x"])


SLOPE = Parameter("slope", Prior("normal", 1.0, 0.1))
WAVE = Cause("wave", Parameter("wave.h", size=0.5, low=-5.0, high=5.0))
X = np.linspace(0.0, 3.0, 24)
Y = X + 0.1 * np.random.default_rng(1).standard_normal(24)


def saturating(table, p):
    x = table["x"]
    with np.errstate(all="ignore"):
        return p["slope"] * x * x / (x + p.get("wave.h", 0.0))


def test_a_row_that_only_a_cause_makes_computable_is_left_out():
    size = Cause("size", Parameter("wave.h", low=0.0, high=2.0, size=0.1))
    found = diagnose_model(saturating, Table({"x": X}, Y, sd=0.1), [SLOPE], [size])
    assert found.verdict.kind == "none"
    (said,) = found.problem.tables[0].notes
    assert said.code == "rows-not-computed"
    assert "row 0" in said.text


@pytest.mark.parametrize(
    ("predict", "said"),
    [
        (lambda table, p: table["x"].__imul__(p["slope"][0, 0]), r"copies, as table"),
        (lambda table, p: np.array([[float(p["slope"]) if p["slope"] > 0 else 0.0]]), "vectors"),
        (lambda table, p: line(table, p) + 0j, "allowed is an array of numbers"),
    ],
)
def test_what_a_model_may_not_do_is_said(predict, said):
    with pytest.raises(ScenarioError, match=said):
        diagnose_model(predict, Table({"x": X}, Y, sd=0.1), [SLOPE], [WAVE])


@pytest.mark.parametrize(
    "predict",
    [
        lambda table, p, factor=1.0: factor * line(table, p),
        lambda table, p, *rest: line(table, p),
        lambda table, p, **rest: line(table, p).tolist(),
        lambda table, p: pd.DataFrame(line(table, p)),
    ],
)
def test_a_model_may_have_more_arguments_and_other_arrays(predict):
    y = Y + 0.5 * np.sin(5.0 * X)
    found = diagnose_model(predict, Table({"x": X}, y, sd=0.1), [SLOPE], [WAVE])
    assert found.verdict.causes == ("wave",)


def test_what_an_answer_masks_is_not_computed():
    masked = vectorised(lambda table, p: np.ma.array(p["slope"] * table["x"], mask=X > 2.0))
    made = masked(Table({"x": X}, Y, sd=0.1), {"slope": np.ones((2, 1))})
    np.testing.assert_array_equal(made, np.where([X > 2.0] * 2, np.nan, X))


def test_a_coarse_meter_has_the_error_of_its_step():
    x = np.repeat(np.linspace(1.0, 3.0, 12), 3)
    y = np.round(2.0 * x + 0.01 * np.random.default_rng(0).standard_normal(36), 1)
    table = Table({"x": x}, y)
    assert table.errors.sd == pytest.approx(np.full(12, 0.1 / np.sqrt(12.0)))
    assert "meter-step" in {each.code for each in table.notes}
    fine = Table({"x": x}, 2.0 * x + 0.05 * np.random.default_rng(0).standard_normal(36))
    assert "meter-step" not in {each.code for each in fine.notes}


def test_causes_and_diagnoses_are_pickled():
    t = np.linspace(0.0, 1.0, 24)
    causes = [
        instruments.offset("V", 0.2),
        instruments.clipping("V", 10.0, 3.0),
        instruments.delay(t, 0.5),
        instruments.lag(0.1),
        events.step(0.5, 0.0, 1.0),
    ]
    readings, table = np.linspace(1.0, 2.0, 24)[None, :], Series(t, Y, sd=0.1)
    for cause in causes:
        again = pickle.loads(pickle.dumps(cause))
        p = {each.name: np.full((1, 1), 0.3) for each in cause.parameters}
        one, other = (each.read(readings, readings, p, table) for each in (cause, again))
        np.testing.assert_array_equal(one, other)
    for found in (
        diagnose_model(line, Table({"x": X}, Y, sd=0.1), [SLOPE], [WAVE]),
        diagnose(measurement(trials(table=drives(mode="IPP"))), threads=1),
    ):
        assert pickle.loads(pickle.dumps(found)).summary() == found.summary()


# ------------------------------------------------------------------------------------ changes


SHORT, FULL = "surface_tilt.angle", "effects.surface_tilt.angle"
WALK = Scenario(drive=Drive(base=0.5e-3, pulses=4))


@pytest.mark.parametrize(
    "change",
    [lambda keys: WALK.replace(dict.fromkeys(keys, 0.01)),
     lambda keys: WALK.replace({keys[0]: 0.01}, **{keys[1]: 0.01}),
     lambda keys: sweep(WALK, {key: [0.0, 0.01] for key in keys}),
     lambda keys: sweep(WALK, [dict.fromkeys(keys, 0.01)]),
     lambda keys: sweep(WALK, pd.DataFrame({key: [0.0, 0.1] for key in keys})),
     lambda keys: optimise(WALK, maximise="mean_velocity", free=dict.fromkeys(keys, (0.0, 0.1)),
                           evaluations=8),
     lambda keys: WALK.with_uncertain({key: {"mean": 0.0, "sd": 0.1} for key in keys})],
)  # fmt: skip
@pytest.mark.parametrize("keys", [(SHORT, FULL), (FULL, SHORT)])
def test_a_key_by_two_names_is_refused(change, keys):
    with pytest.raises(ScenarioError, match="twice"):
        change(keys)


@pytest.mark.parametrize("keys", [("coil", "coil.xp"), ("coil.xp", "coil")])
def test_keys_of_all_coils_are_set_before_those_of_one(keys):
    values = {"coil": 10.0, "coil.xp": 12.0}
    changes = {f"{key}.resistance": values[key] for key in keys}
    asked = WALK.replace({"coil.xp.resistance": 12.0})
    assert WALK.replace(changes) == asked
    velocity = simulate(asked).mean_velocity
    assert sweep(WALK, [changes])["mean_velocity"].item() == velocity
    (motion,) = record(WALK, list(changes), np.array([list(changes.values())]), 1e3, 1)
    (expected,) = record(asked, [], np.zeros((1, 0)), 1e3, 1)
    np.testing.assert_array_equal(motion["x"], expected["x"])
