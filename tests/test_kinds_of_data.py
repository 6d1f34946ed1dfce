"""Kinds of what laboratories write, by every door: a file, a frame, a Dataset, pint."""

import datetime

import drawn
import numpy as np
import pandas as pd
import pint
import pytest
import xarray

from made_measurement import write_files
from measured_maps import formula_fields, grid, write_csv
from refusals.measurement import NOMINAL, TOML
from stickslip import (
    Drive,
    FieldMap,
    Measurement,
    Scenario,
    ScenarioError,
    Series,
    models,
    velocity_of_track,
)
from stickslip._util import columns
from stickslip._util.units import per_si
from stickslip.walker import read_measurement
from stickslip.walker.read_tracking import read_tracking

N = 120
T = 0.02 * np.arange(N)
TORQUE = np.where(np.sin(3.0 * T) > 0.0, 1.0, -1.0)
SPEED = np.cos(T) + 0.3 * TORQUE
JOINT = models.joint(inertia=0.1, viscous=0.2)
TURNING = models.joint(inertia=0.1, viscous=0.2, reads="angle")
HEATER = models.thermal(capacity=800.0, loss=2.0, ambient=20.0)


def file(table, model, folder):
    path = folder / "log.csv"
    pd.DataFrame(table).to_csv(path, index=False)
    return models.read_log(path, model)


def with_units(table, carry):
    """The columns with the units of their headings, where these have any."""
    found = {}
    for heading, values in table.items():
        name, unit = columns.split_unit(heading)
        numbers = np.asarray(values)
        carried = None if unit is None or numbers.dtype.kind not in "fiu" else carry(numbers, unit)
        found[heading if carried is None else name] = numbers if carried is None else carried
    return found


def dataset(table, model, folder):
    made = with_units(table, lambda v, unit: xarray.DataArray(v, dims="row", attrs={"units": unit}))
    plain = {k: v if isinstance(v, xarray.DataArray) else ("row", v) for k, v in made.items()}
    return models.read_log(xarray.Dataset(plain), model)


DOORS = {
    "file": file,
    "frame": lambda table, model, folder: models.read_log(pd.DataFrame(table), model),
    "xarray": dataset,
    "pint": lambda table, model, folder: models.read_log(
        with_units(table, lambda v, unit: None if unit in NO_PINT else pint.Quantity(v, unit)),
        model),
}  # fmt: skip
NO_PINT = ("mm:ss", "r/min", "Nm", "deg C", "Celsius", "%", "ºC", "℃", "rev/4096")


def joint(t="t (s)", times=T, speed="speed (rad/s)", read=SPEED, torque="torque (N m)", **more):
    return {t: times, speed: read, torque: TORQUE, **more}


def dates(step, begin="2026-05-01 12:00:00", count=N):
    first = np.datetime64(begin, "ns")
    return [str(first + k * np.timedelta64(step, "ns")).replace("T", " ") for k in range(count)]


def clocks(begin, template, count=N):
    at = [datetime.timedelta(seconds=begin + k) for k in range(count)]
    parts = [(each.seconds // 3600, each.seconds // 60 % 60, each.seconds % 60) for each in at]
    return [template.format(h=h, m=m, s=s, mm=60 * h + m) for h, m, s in parts]


SEASON = dates(10**9, "2026-10-25 02:59:00", 60) + dates(10**9, "2026-10-25 02:00:00", 60)
ANGLE = 6.0 * T + np.sin(T)

# A kind: its columns, a model, and the times or readings that are right, with the code of a note
# where one has to be; or the words of a refusal.
LOGS = {
    "minutes": (joint("time (minutes)", T / 60), JOINT, ("t", T), "converted"),
    "days": (joint("time (d)", 2.0 + T / 86400), JOINT, ("t", 172800 + T), "converted"),
    "Hz for rad/s": (joint(speed="speed (Hz)"), JOINT, "Hz", None),
    "32 bits of us": (
        joint("time (us)", (2**32 - 900_000 + 20000 * np.arange(N)) % 2**32), JOINT,
        "sort the rows, or cut", None),
    "no order": (joint("time (s)", 0.1 * np.random.default_rng(3).permutation(N)), JOINT,
                 "sort the rows, or cut", None),
    "midnight": (joint("time", clocks(86400 - 50, "{h:02}:{m:02}:{s:02}")), JOINT,
                 "sort the rows, or cut", None),
    "hh:mm or mm:ss": (joint("time", clocks(300, "{m:02}:{s:02}")), JOINT, '"time (mm:ss)"', None),
    "mm:ss": (joint("time (mm:ss)", clocks(300, "{m:02}:{s:02}")), JOINT,
              ("t", 300.0 + np.arange(N)), None),
    "mm:ss of hours": (joint("time (mm:ss)", clocks(3500, "{mm:02}:{s:02}")), JOINT,
                       ("t", 3500.0 + np.arange(N)), None),
    **{f"a date as {template}": (
        joint("time", clocks(300, template + " {h:02}:{m:02}:{s:02}")), JOINT, ("t", np.arange(N)),
        "dates") for template in ("31.5.2026", "2026/05/31", "2026-05-31")},
    "no date": (joint("time", clocks(300, "31.4.2026 {h:02}:{m:02}:{s:02}")), JOINT,
                "allowed is a finite number or a date", None),
    "dates beside numbers": (joint("time", [*dates(10**9)[1:], "119"]), JOINT,
                             "has numbers beside", None),
    "summer time": (joint("time", SEASON), JOINT, "sort the rows, or cut", None),
    "100 ns": (joint("time", dates(100)), JOINT, ("t", 1e-7 * np.arange(N)), None),
    "a turn": (joint(speed="angle (deg)", read=np.degrees(ANGLE) % 360.0), TURNING, ("y", ANGLE),
               "unwrapped"),
    "half turns": (joint(speed="angle (deg)", read=(np.degrees(ANGLE) + 180) % 360.0 - 180),
                   TURNING, ("y", ANGLE), "unwrapped"),
    "16 bits below zero": (
        joint(speed="speed (rpm)", read=np.round(3000 * np.sin(3 * T)).astype(int) % 65536), JOINT,
        ("y", np.round(3000 * np.sin(3 * T)) * np.pi / 30), "unwrapped"),
    "no 16 bits": (joint(speed="speed (rpm)", read=5000 * np.arange(N) % 55000), JOINT,
                   ("y", np.pi / 30 * (5000 * np.arange(N) % 55000)), None),
    "U/min": (joint(speed="speed_U/min", read=30.0 / np.pi * SPEED), JOINT, ("y", SPEED), None),
    "an error of a controller": (joint(error=0.1 + 0.0 * T), JOINT, ("y", SPEED),
                                 "error-not-used"),
    "a set point beside": (joint(**{"speed setpoint (rad/s)": SPEED + 1.0}), JOINT, ("y", SPEED),
                           None),
    "a set point alone": (joint(speed="target (rad/s)"), JOINT, '"speed" is missing', None),
    "command beside torque": (joint(**{"torque measured (N m)": TORQUE}), JOINT, "may both be",
                              None),
    "nothing that drives": ({"t (s)": T, "speed (rad/s)": SPEED}, JOINT, "column of zeros", None),
    "another reading": (joint(speed="angle (rad)"), JOINT, 'reads="angle"', None),
    "percent": ({"time (s)": T, "command (%)": TORQUE, "position (mm)": T},
                models.axis(mass=1.0), ("y", 1e-3 * T), "converted"),
    **{f"temperature in {unit}": (
        {"t (s)": T, "power (W)": TORQUE + 1.0, f"temperature ({unit})": 20.0 + T}, HEATER,
        ("y", 20.0 + T), None) for unit in ("Celsius", "deg C", "℃", "ºC", "degC")},
    "temperature in degF": ({"t (s)": T, "power (W)": TORQUE + 1.0, "temperature (degF)": 68.0 + T},
                            HEATER, ("y", 20.0 + T / 1.8), "converted"),
}  # fmt: skip


ASKED = "state {0}=(VALUE, ERROR) (--set {0}=VALUE,ERROR)"
BY_CURRENT = models.joint(inertia=0.1, torque_constant=0.05)
AXIS, DRIVEN = models.axis(mass=1.0, gain=2.0), models.axis(mass=1.0, force_constant=2.0)
NO_SPEED = {"t (s)": T, "torque (N m)": TORQUE}
# Columns that state another quantity than the missing one, a model, and what is to be stated.
OTHERS = {
    **{f"{heading} for a torque": (
        {"t (s)": T, "speed (rad/s)": SPEED, heading: TORQUE}, JOINT,
        ASKED.format("torque_constant")) for heading in
       ("current (A)", "current (mA)", "i_q (A)", "torque (A)", "current", "motor_current_mA")},
    **{f"{heading} for a command": (
        {"t (s)": T, "position (mm)": SPEED, heading: TORQUE}, AXIS,
        ASKED.format("force_constant")) for heading in ("current (mA)", "command (A)")},
    "a torque for a current": (joint(), BY_CURRENT, "state no torque_constant"),
    "a force for a current": ({"t (s)": T, "position (m)": T, "force (N)": TORQUE}, DRIVEN,
                              "state no force_constant"),
    **{f"{heading} for a speed": ({**NO_SPEED, heading: ANGLE}, JOINT,
                                  'with reads="angle" (--set reads=angle) the model reads that')
       for heading in ("position (deg)", "encoder (rev/4096)", "position (rad)", "position")},
    "a speed for an angle": ({**NO_SPEED, "velocity (deg/s)": SPEED}, TURNING, 'reads="speed"'),
    "a speed for a position": ({"t (s)": T, "command (V)": T, "v (mm/s)": T}, AXIS,
                               'reads="speed"'),
    "a way for a speed": ({**NO_SPEED, "way (mm)": T}, JOINT, 'column "speed" is missing'),
}  # fmt: skip


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("kind", OTHERS)
def test_a_column_that_states_another_quantity_is_not_to_be_renamed(kind, door, tmp_path):
    table, model, said = OTHERS[kind]
    with pytest.raises(ScenarioError) as error:
        DOORS[door](table, model, tmp_path)
    text = str(error.value)
    assert said in text
    assert not [each for each in ("call one", "\n") if each in text]


@pytest.mark.parametrize("door", DOORS)
def test_a_current_is_read_in_its_unit_and_an_angle_by_its_unit(door, tmp_path):
    whole = np.round(900.0 * SPEED)
    table = {"t (s)": T, "position (deg)": np.degrees(ANGLE)}
    model = models.joint(inertia=0.1, torque_constant=0.05, reads="angle")
    a = DOORS[door]({**table, "current (A)": whole / 1000.0}, model, tmp_path)
    ma = DOORS[door]({**table, "motor (mA)": whole}, model, tmp_path)
    np.testing.assert_array_equal(a["current"], ma["current"])
    np.testing.assert_allclose(a.y, ANGLE, rtol=1e-9)


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("kind", LOGS)
def test_a_log_is_right_noted_or_refused(kind, door, tmp_path):
    table, model, right, code = LOGS[kind]
    if isinstance(right, str):
        with pytest.raises(
            ScenarioError, match="(?i)" + right.replace("(", r"\(").replace(")", r"\)")
        ):
            DOORS[door](table, model, tmp_path)
        return
    log = DOORS[door](table, model, tmp_path)
    name, expected = right
    offset = log.t[0] - expected[0] if name == "t" else 0.0
    np.testing.assert_allclose(getattr(log, name) - offset, expected, rtol=1e-9, atol=2e-8)
    if code:
        assert code in {note.code for note in log.own_notes}


# ------------------------------------------------------------------------------------- velocities
SETTINGS = [(mode, f, p) for mode in ("IPP", "OPP") for f in (20.0, 40.0) for p in (2.0, 2.5, 3.0)]
TRIALS = {
    "mode": [mode for mode, *_ in SETTINGS for _ in (1, 2)],
    "frequency (Hz)": np.repeat([f for _, f, _ in SETTINGS], 2),
    "peak (mT)": np.repeat([p for *_, p in SETTINGS], 2),
    "velocity (mm/s)": np.linspace(1.0, 2.0, 24),
}


def of_file(table, folder):
    rows = pd.DataFrame(table).to_csv(index=False)
    return read_measurement(write_files(folder, NOMINAL, TOML, velocity=rows))


def of_dataset(table, folder):
    rows = {name: ("row", np.asarray(values)) for name, values in table.items()}
    return Measurement.from_dataframe(xarray.Dataset(rows), Scenario())


TABLES = {
    "file": of_file,
    "frame": lambda table, folder: Measurement.from_dataframe(pd.DataFrame(table), Scenario()),
    "xarray": of_dataset,
    "pint": lambda table, folder: Measurement.from_dataframe(
        with_units(table, pint.Quantity), Scenario()
    ),
}


@pytest.mark.parametrize("door", TABLES)
def test_settings_are_the_same_by_every_door(door, tmp_path):
    (data,) = TABLES[door](TRIALS, tmp_path).velocity
    names = ("drive.mode", "drive.frequency", "drive.peak")
    found = [tuple(each[name] for name in names) for each in data.conditions]
    assert found == [(m, f, pytest.approx(1e-3 * p)) for m, f, p in SETTINGS]
    np.testing.assert_allclose(data.velocity, np.linspace(1e-3, 2e-3, 24), rtol=1e-12)


# What the column of the field or of the frequency is called in its place.
NAMES = {
    "mode": ("gait", "type", "x7"),
    "peak (mT)": ("amplitude (mT)", "amplitude", "peak field (mT)", "field (mT)", "B (mT)", "Bmax",
                  "my coil (mT)", "x7", "drive [mT]", "intensity", "u (V)", "current (A)", "duty",
                  "peak in V"),
    "frequency (Hz)": ("f (Hz)", "freq", "rate", "f", "pulse rate (Hz)", "tempo"),
}  # fmt: skip


@pytest.mark.parametrize("door", TABLES)
@pytest.mark.parametrize(("name", "other"), [(k, v) for k, names in NAMES.items() for v in names])
def test_a_setting_under_another_name_is_not_lost(name, other, door, tmp_path):
    table = {other if key == name else key: values for key, values in TRIALS.items()}
    with pytest.raises(ScenarioError, match=r"setting|no unit of|is not known|repeats"):
        TABLES[door](table, tmp_path)


@pytest.mark.parametrize(
    ("name", "values"),
    [("temperature (degC)", 21.0 + np.arange(24) % 3), ("no", np.arange(24)),
     ("operator", ["a"] * 24), ("film", np.arange(24) % 5),
     ("distance (mm)", np.linspace(1.0, 2.0, 24)), ("x2", [7.0] * 24)],
)  # fmt: skip
def test_what_is_no_setting_is_information(name, values, tmp_path):
    found = of_file({**TRIALS, name: values}, tmp_path)
    assert [each.code for each in found.left_out] == ["converted", "columns-not-used"]


# ------------------------------------------------------------------------------- films and maps
def test_means_below_a_film_are_no_frame(tmp_path):
    t = 0.002 * np.arange(200)
    frames = np.stack([t, 1e-4 + 3e-3 * t, 0.3 * np.sin(90.0 * t) ** 2], axis=1)
    rows = np.vstack([frames, frames.mean(axis=0)])
    pd.DataFrame(rows, columns=["t", "x", "theta"]).to_csv(tmp_path / "film.csv", index=False)
    run, notes = read_tracking(tmp_path / "film.csv", {}, drawn.SCENARIO)
    np.testing.assert_array_equal(run.columns["t"], t)
    assert [note.code for note in notes] == ["last-row-back"]


@pytest.mark.parametrize(
    ("row", "column", "factor", "said"),
    [(40, 0, -1.7, "row 42 is"), (40, 4, 1.5, "row 42 is"),
     (slice(None), 1, 100.0, "look at their units")],
)  # fmt: skip
def test_a_wrong_number_of_a_map_is_told(row, column, factor, said, tmp_path):
    points = grid()
    fields = formula_fields(points)
    rows = np.array([[*place, *own] for place, own in zip(points, fields[:, 0], strict=True)])
    rows[row, column] = factor * rows[row, column] + (1e-3 if column < 3 and factor < 0 else 0.0)
    file = write_csv(tmp_path / "map.csv", points, fields)
    head, *lines = file.read_text().splitlines()
    for k, (x, y, z, *own) in enumerate(rows.tolist()):
        lines[k] = ",".join(map(str, (x, y, z, "xp", *own)))
    file.write_text("\n".join([head, *lines]))
    with pytest.raises(ScenarioError, match=said):
        FieldMap.from_file(file)


# -------------------------------------------------------------------------------- units in memory
def labelled(values, unit):
    return xarray.DataArray(values, dims="row", attrs={"units": unit})


@pytest.mark.parametrize(
    ("unit", "si", "size"),
    [("Nm", "N m", 1.0), ("m s-1", "m/s", 1.0), ("millimeter / second", "m/s", 1e-3),
     ("G", "T", 1e-4), ("revolutions_per_minute", "rad/s", np.pi / 30), ("hours", "s", 3600.0),
     ("kilogram * meter ** 2", "kg m^2", 1.0), ("kHz", "Hz", 1e3), ("%", "-", 0.01),
     ("mm s^-2", "m/s^2", 1e-3)],
)  # fmt: skip
def test_a_unit_is_known_to_every_door(unit, si, size):
    assert 1.0 / per_si(unit, si) == pytest.approx(size)
    series = Series(T, labelled(SPEED, unit), unit=si)
    np.testing.assert_allclose(series.y, size * SPEED)
    assert ("converted" in {note.code for note in series.own_notes}) == (size != 1.0)


@pytest.mark.parametrize(
    ("unit", "si"),
    [
        ("Hz", "rad/s"),
        ("rpm", "Hz"),
        ("rad/s", "Hz"),
        ("cycle / s", "Hz"),
        ("MM", "m"),
        ("Mm", "m"),
        ("J", "N"),
        ("delta_degC", "K"),
    ],
)
def test_what_is_not_the_same_quantity_is_refused(unit, si):
    with pytest.raises(ScenarioError, match="allowed are numbers in"):
        Series(T, labelled(SPEED, unit), unit=si)


def test_a_unit_may_be_one_over_another():
    assert columns.split_unit("f / 1/s") == ("f", "1/s")
    assert columns.split_unit("f / 1") == ("f / 1", None)


@pytest.mark.parametrize("kind", ["M8[ns]", "m8[ns]", object])
def test_dates_are_no_numbers_of_the_unit_of_their_heading(kind):
    first = datetime.datetime(2026, 5, 1)
    at = [first + datetime.timedelta(seconds=float(t)) for t in T]
    if kind == "m8[ns]":
        at = [each - first for each in at]
    columns = {**joint(), "time (ms)": np.array(at, dtype=kind)}
    del columns["t (s)"]
    np.testing.assert_allclose(models.read_log(columns, JOINT).t, T, atol=1e-9)


def test_truths_among_numbers_are_numbers():
    assert Series(T, np.array([True, *SPEED[1:]], dtype=object)).y[0] == 1.0


def test_an_input_may_carry_a_unit():
    inputs = {"power": labelled(1e3 * SPEED, "mW"), "ambient": labelled(293.15 + T, "K")}
    series = Series(T, 20.0 + T, inputs, unit="degC")
    np.testing.assert_allclose(series["power"], SPEED)
    np.testing.assert_allclose(series["ambient"], 20.0 + T)
    (note,) = (each for each in series.own_notes if each.code == "converted")
    assert "power from mW to W, ambient from K to degC" in note.text


def test_a_unit_within_a_label_counts_and_a_stale_one_is_told():
    within = xarray.DataArray(pint.Quantity(1e3 * T, "mm"), dims="row")
    np.testing.assert_allclose(Series(T, within, unit="m").y, T)
    with pytest.warns(UserWarning, match="x from mm to m"):
        velocity_of_track(T, labelled(1e-3 * T, "mm"), Drive(frequency=20.0, pulses=40))


class Masked:
    """Array as of astropy, with a mask that `numpy.array` does not see."""

    def __init__(self, values, mask):
        self.unmasked, self.mask = values, mask

    def __array__(self, dtype=None, copy=None):
        return self.unmasked


class Variable(Masked):
    """Variable as of netCDF4: its numbers are masked when they are read."""

    set_auto_mask = None

    def __getitem__(self, key):
        return np.ma.MaskedArray(self.unmasked, self.mask)[key]


class Scipp:
    """Array as of scipp, whose `value` is that of a single number."""

    def __init__(self, values, unit):
        self.values, self.unit = values, unit

    @property
    def value(self):
        raise RuntimeError("not a scalar")


Scipp.__module__ = "scipp"


@pytest.mark.parametrize("kind", [Masked, Variable])
def test_a_mask_is_kept(kind):
    assert len(Series(T, kind(SPEED, np.arange(N) % 10 == 3), sd=0.1)) == N - 12


def test_a_variable_of_scipp_is_read():
    np.testing.assert_allclose(Series(Scipp(1e3 * T, "ms"), SPEED).t, T)


def test_what_is_drawn_is_never_silently_wrong():
    found = drawn.counts(range(240))
    assert sum(found.values()) == 240
    assert [kind for (kind, what), _ in found.items() if what == "WRONG"] == []
    assert {kind.split(", ")[0] for kind, _ in found} == set(drawn.TABLES)
    assert {what for _, what in found} >= {"right", "noted", "refused"}
