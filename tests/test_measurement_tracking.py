"""Tables of tracked frames as they come: what is left out, and what is used."""

import json

import numpy as np
import pytest

from films import NOISE, NOMINAL, ROBOT, TRUE, film
from made_measurement import write_files
from stickslip import simulate
from stickslip.errors import ScenarioError
from stickslip.walker import read_measurement
from stickslip.walker.exposure import CameraModel
from stickslip.walker.film import FilmTable

TOML = """stickslip_measurement = 1
scenario = "nominal.toml"

[[tracking]]
file = "a.csv"
frame_rate = 1000.0
exposure = 3e-4
drive = { frequency = 30.0 }
"""
ALL = ("x", "theta", "z", "current_x", "current_clamp")


def read(folder, toml=TOML, **tables):
    return read_measurement(write_files(folder, NOMINAL, toml, **tables))


def used(folder, frames, toml=TOML):
    """Columns of the one film that the diagnosis uses, and what it leaves out."""
    table = FilmTable(read(folder, toml, a=frames).tracking[0])
    return set(table.columns), table.left_out


def beside(folder, toml, odd, sound):
    """The note on a film that is left out beside a sound one."""
    with pytest.raises(ScenarioError, match=r"^[^\n]*nothing sound is left[^\n]*$"):
        read(folder, toml, a=odd)
    sound_entry = TOML.split("\n\n")[1].replace("a.csv", "b.csv")
    found = read(folder, toml + sound_entry, a=odd, b=sound)
    assert [run.file for run in found.tracking] == ["b.csv"]
    (note,) = (each for each in found.left_out if "a.csv: " in each.text)
    return note


@pytest.fixture(scope="module")
def full_frames():
    return film(TRUE, CameraModel(3e-4), 1000.0, 0, names=ALL)


@pytest.fixture(scope="module")
def frames(full_frames):
    return {name: full_frames[name] for name in ("t", "x", "theta")}


def test_of_a_film_with_invalid_frames_the_valid_ones_are_used(tmp_path, frames):
    random = np.random.default_rng(1)
    kept = np.flatnonzero(random.random(len(frames["t"])) > 0.15)
    dirty = {key: column[np.append(kept, kept[7])].copy() for key, column in frames.items()}
    # The square of the second overflows.
    dirty["theta"][[11, 12]] = np.nan, 1e308
    order = random.permutation(len(dirty["t"]))
    dirty = {key: column[order] for key, column in dirty.items()}
    dirty["current_x"] = np.full(len(order), np.nan)
    dirty["z"] = np.where(random.random(len(order)) < 0.05, np.nan, 5e-5)
    found = read(tmp_path, a=dirty)
    (run,) = found.tracking
    assert len(run.columns["t"]) == len(kept) - 2
    assert np.all(np.diff(run.columns["t"]) > 0.0)
    codes = ["bad-cells", "gaps", "gaps", "frames-sorted", "repeated-times"]
    assert [each.code for each in found.left_out] == codes
    for said, column in zip(found.left_out[1:3], ("current_x", "z"), strict=True):
        assert f"column {column} has {said.value} cells without a number" in said.text
    assert found.left_out[1].value == len(kept) - 1
    table = FilmTable(run)
    unused = table.left_out[-1]
    assert (unused.code, unused.value) == ("column-too-short", 0)
    assert "column current_x is not used" in unused.text
    assert np.all(np.isfinite(table.predict(list(TRUE), np.array([[*TRUE.values()]]))))


@pytest.mark.parametrize(
    ("change", "code", "value", "said"),
    [
        (lambda frames: {key: column[:160] for key, column in frames.items()}, "run-too-short", 10,
         "a.csv: the run is left out, as it has 10 sound frames from"),
        (lambda frames: {key: np.full(30, np.nan) for key in frames}, "no-sound-row", None,
         "a.csv: no row is sound. a.csv lines 2, 3, "),
        (lambda frames: {**frames, "theta": np.degrees(frames["theta"])}, "run-angle-unit", None,
         "a.csv: the run is left out, as theta is near"),
        (lambda frames: {**frames, "theta": 1e3 * frames["theta"]}, "run-angle-unit", None,
         "rad are wanted, so call the column theta (deg) or theta (mrad)"),
        (lambda frames: {**frames, "t": 1.7e9 + frames["t"]}, "run-time-start", 1.7e9,
         "begin at 1700000000 s, and the drive ends at 0.45 s: subtract the time"),
        (lambda frames: {**frames, "x": frames["x"] + 1e-3 * (np.arange(len(frames["x"])) % 2)},
         "run-of-two-bodies", None, "two places in turn"),
        (lambda frames: {**frames, "x": 1e3 * frames["x"]}, "run-length-unit", None,
         "m are wanted, and these may be mm."),
    ],
    ids=["few frames", "no frame", "degrees", "mrad", "date", "two in turn", "mm"],
)  # fmt: skip
def test_a_film_that_cannot_be_used_is_left_out_and_others_are_used(
    tmp_path, frames, change, code, value, said
):
    note = beside(tmp_path, TOML, change(frames), frames)
    assert note.code == code
    assert value in (None, note.value)
    assert said in note.text


@pytest.mark.parametrize("name", ["id", "TRACK_ID", "particle", "robot"])
def test_a_column_of_two_bodies_at_a_time_is_refused(tmp_path, frames, name):
    count = len(frames["t"])
    stacked = {key: np.tile(column, 2) for key, column in frames.items()}
    for columns, ids in ((stacked, np.arange(2 * count) // count), (frames, np.arange(count) % 2)):
        with pytest.raises(
            ScenarioError, match=rf'column {name} has "0" and "1" at the same times'
        ):
            read(tmp_path, a={name: ids, **columns})
    # A tracker that finds its robot again may count on; a number of each row says nothing.
    for ids in (np.arange(count) // 100, np.arange(count)):
        assert read(tmp_path, a={name: ids, **frames}).tracking


TURN = 2.0 * np.pi
WRAPPED = {
    "modulo a turn": lambda theta: theta % TURN,
    "modulo a turn, from degrees": lambda theta: (
        np.round(np.degrees(theta) % 360.0, 2) / 360 * TURN
    ),
    "a turn in some": lambda theta: theta + TURN * (np.arange(len(theta)) % 7 == 0),
    "two turns less in many": lambda theta: theta - 2.0 * TURN * (np.arange(len(theta)) // 40 % 2),
    "a frame is lost": lambda theta: np.where(np.arange(len(theta)) == 99, 1234.0, theta % TURN),
}


@pytest.mark.parametrize("way", WRAPPED)
@pytest.mark.parametrize(("step", "sign"), [(1, 1.0), (1, -1.0), (10, 1.0)])
def test_angles_that_jump_by_whole_turns_are_moved_back(tmp_path, frames, way, step, sign):
    some = {key: column[::step] for key, column in frames.items()}
    theta = sign * some["theta"]
    wrapped = WRAPPED[way](theta)
    toml = TOML.replace("1000.0", f"{1000.0 / step}")
    found = read(tmp_path, toml, a={**some, "theta": wrapped})
    (run,) = found.tracking
    seen = np.abs(wrapped) < 100.0
    assert run.columns["theta"][seen] == pytest.approx(theta[seen], abs=1e-4)
    moved = int(np.sum(np.abs(wrapped - run.columns["theta"]) > 1.0))
    assert [(each.code, each.value) for each in found.left_out] == (
        [("whole-turns", moved)] if moved else []
    )


@pytest.mark.parametrize(
    "change",
    [
        lambda theta: np.where(np.arange(len(theta)) % 40 == 7, 3.0, theta),  # a few lost frames
        lambda theta: np.degrees(theta) / 10.0,  # in a wrong unit
        lambda theta: theta + np.pi,
    ],
)
def test_other_jumps_of_an_angle_are_left(tmp_path, frames, change):
    theta = change(frames["theta"])
    (run,) = read(tmp_path, a={**frames, "theta": theta}).tracking
    assert run.columns["theta"].tolist() == theta.tolist()


@pytest.mark.parametrize("column", ALL)
def test_a_mirrored_column_is_what_is_wrong(tmp_path, full_frames, column):
    (run,) = read(tmp_path, a={**full_frames, column: -full_frames[column]}).tracking
    table = FilmTable(run)
    stated = table.predict(list(TRUE), np.array([[*TRUE.values()]]))[0]
    note = table.data_fault(stated)
    assert note.text == f"Column {column} would fit the stated model if it were of the other sign."
    sound = FilmTable(read(tmp_path, a=full_frames).tracking[0])
    assert sound.data_fault(stated) is None


@pytest.mark.parametrize(
    ("stated", "per_second", "meant", "mend"),
    [
        (1000.0, 1e3, "ms or numbers of frames", "divide them by 1000"),  # one ms a frame
        (500.0, 1e3, "numbers of frames", "divide them by 500"),
        (None, 1e3, "ms or numbers of frames",
         "divide ms by 1000, numbers of frames by the frame rate"),
        (None, 1e6, "us", "divide them by 1000000"),
    ],
)  # fmt: skip
def test_a_film_whose_times_are_not_in_s_is_left_out_with_their_unit(
    tmp_path, frames, stated, per_second, meant, mend
):
    toml = TOML.replace("1000.0", repr(stated)) if stated else TOML.replace("frame_rate", "# ")
    toml = toml.replace("exposure = 3e-4\n", "")
    in_unit = {**frames, "t": np.round(per_second * frames["t"], 6)}
    note = beside(tmp_path, toml, in_unit, frames)
    assert note.code == "run-time-unit"
    assert note.text.endswith(f", are {meant}; s are wanted, so {mend}.")


@pytest.mark.parametrize("toml", [TOML, TOML.replace("frame_rate", "# ")])
def test_a_film_that_goes_on_long_after_the_drive_is_in_s(tmp_path, frames, toml):
    # Ten times as long as the drive, and most of it after the drive's end.
    count = len(frames["t"])
    long = {
        key: np.append(column, np.full(9 * count, column[-1])) for key, column in frames.items()
    }
    found = read(tmp_path, toml, a={**long, "t": np.arange(10 * count) * 1e-3})
    assert [run.file for run in found.tracking] == ["a.csv"]
    assert [each.code for each in found.left_out] == ["frames-after-drive"]


@pytest.mark.parametrize(
    ("column", "unit", "factor"),
    [("z", "m", 1e3), ("current_x", "A", 1e-3)],
)
def test_a_column_in_a_wrong_unit_is_reported(tmp_path, full_frames, column, unit, factor):
    in_unit = {**full_frames, column: factor * full_frames[column]}
    columns, (note,) = used(tmp_path, in_unit)
    assert columns == set(ALL) - {column}
    assert note.code == "column-size"
    for said in (f"column {column} is not used", f" {unit}; allowed is 0.02 to 50 times)",
                 "in a unit that is wrong by 1000"):  # fmt: skip
        assert said in note.text


@pytest.mark.parametrize(
    "drive",
    [
        {},
        {"mode": "OPP", "direction": "-x"},
        {"hold": 0.0},  # nothing but noise through the clamp coil
        {"hold": 1e-6, "frequency": 150.0},  # currents lag
    ],
)
def test_columns_in_the_right_unit_pass_whatever_the_drive(tmp_path, drive):
    changes = {f"drive.{key}": value for key, value in drive.items()}
    frames = film({**TRUE, **changes}, CameraModel(3e-4), 1000.0, 0, ALL, {**NOISE, "z": 5e-6})
    frames["z"] += 0.02  # its origin is anywhere
    frames["current_clamp"] += 0.02 * np.random.default_rng(3).standard_normal(len(frames["t"]))
    entries = ", ".join(f"{key} = {json.dumps(v)}" for key, v in drive.items())
    toml = TOML.replace("{ frequency = 30.0 }", f"{{ {entries} }}")
    assert used(tmp_path, frames, toml) == (set(ALL), [])


def test_lost_frames_are_not_taken_for_a_wrong_unit(tmp_path, full_frames):
    # A camera that has lost the robot writes zeros; -9999 of a late logger is a gap.
    frames = {name: column.copy() for name, column in full_frames.items()}
    frames["z"] += 0.02
    frames["z"][150::40] = 0.0
    frames["current_x"][170] = -9999.0
    columns, said = used(tmp_path, frames)
    assert columns == set(ALL)
    assert [each.code for each in said] == ["wild-frames"]
    assert "of their phase in z" in said[0].text


def test_a_film_at_the_weakest_currents_of_its_drive_is_used(tmp_path, full_frames):
    # 25 ms of a period of 33 ms, and those after each pulse, when little current flows.
    late = full_frames["t"] > 0.2
    few = {name: column[late][:25] for name, column in full_frames.items()}
    assert used(tmp_path, few)[0] == set(ALL)


def test_the_csv_file_of_a_run_is_a_film(tmp_path):
    run = simulate(ROBOT.replace({"record.rate": 1000.0}))
    run.save(tmp_path / "a.csv")
    found = read(tmp_path, TOML.replace("exposure = 3e-4\n", ""))
    (film_of_run,) = found.tracking
    count = len(film_of_run.columns["t"])
    assert count > 300
    for name, column in film_of_run.columns.items():
        assert column.tolist() == getattr(run, name)[:count].tolist()
    (note,) = [each for each in found.left_out if each.code == "columns-not-used"]
    assert note.text.startswith("a.csv: columns that are information only: ")
    assert "vx (m/s)" in note.text
