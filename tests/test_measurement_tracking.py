"""Tables of tracked frames as they come: what is left out, and what is used."""

import numpy as np
import pytest

from films import NOMINAL, ROBOT, TRUE, film
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
    *_, note = (each for each in found.left_out if "a.csv: " in each.text)
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
    dirty["theta"][[11, 12]] = np.nan
    order = random.permutation(len(dirty["t"]))
    dirty = {key: column[order] for key, column in dirty.items()}
    dirty["current_x"] = np.full(len(order), np.nan)
    dirty["z"] = np.where(random.random(len(order)) < 0.05, np.nan, 5e-5)
    found = read(tmp_path, a=dirty)
    (run,) = found.tracking
    assert len(run.columns["t"]) == len(kept) - 2
    assert np.all(np.diff(run.columns["t"]) > 0.0)
    codes = ["many-gaps", "bad-cells", "gaps", "frames-sorted", "repeated-times"]
    assert [each.code for each in found.left_out] == codes
    said = [each.text for each in found.left_out[:3]]
    assert f"{len(order)} of {len(order)} cells of column current_x are gaps" in said[0]
    assert f"column z has {found.left_out[2].value} cells without a number" in said[2]
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
        (lambda frames: {**frames, "t": 1.7e9 + frames["t"]}, "run-too-short", 0,
         "(times are in s, from the start of the drive)."),
        (lambda frames: {**frames, "x": frames["x"] + 1e-3 * (np.arange(len(frames["x"])) % 2)},
         "run-of-two-bodies", None, "two places in turn"),
    ],
    ids=["few frames", "no frame", "date", "two in turn"],
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


def test_lost_frames_are_left_out_of_a_column(tmp_path, full_frames):
    # A camera that has lost the robot writes zeros, and a late logger -9999.
    frames = {name: column.copy() for name, column in full_frames.items()}
    frames["z"] += 0.02
    frames["z"][150::40] = 0.0
    frames["current_x"][170] = -9999.0
    columns, said = used(tmp_path, frames)
    assert columns == set(ALL)
    assert [each.code for each in said] == ["wild-frames"] * 2
    assert "of their phase in z" in said[0].text
    assert "of their phase in current_x" in said[1].text


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
