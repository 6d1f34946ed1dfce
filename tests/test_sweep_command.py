"""The command `stickslip sweep`: output, exit statuses, interrupts, bad input."""

import itertools
import json
import socket
from concurrent.futures import ThreadPoolExecutor

import h5netcdf
import numpy as np
import pytest
import xarray

from command_line import check, ended_at_the_bar, stickslip, stickslip_process
from stickslip import load, simulate, sweep
from stickslip._util.text import json_text

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 4\n"
VARY = ["--vary", "drive.frequency=30:90:3", "--vary", "drive.mode=OPP,IPP"]
GRID = {"drive.frequency": [30.0, 60.0, 90.0], "drive.mode": ["OPP", "IPP"]}
ENDLESS = ["--set=solver.max_step=1e-6", "--vary", "drive.frequency=50:60:1000"]


def test_json_is_one_object_with_the_summaries_of_single_runs(scenario):
    done = stickslip("sweep", scenario, *VARY, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout, parse_constant=pytest.fail)
    assert (found["points"], found["failed"], found["status"]) == (6, 0, {"ok": 6})
    assert len(found["results"]) == 6
    for point, values in zip(found["results"], itertools.product(*GRID.values()), strict=True):
        changes = dict(zip(GRID, values, strict=True))
        summary = simulate(load(scenario).replace(changes)).summary()
        for name in ("steps", "message", "notes", "window_start", "window_end"):
            del summary[name]
        assert point == {**changes, **json.loads(json_text(summary))}
    velocities = [point["mean_velocity"] for point in found["results"]]
    assert found["highest"]["mean_velocity"] == max(velocities)
    assert found["lowest"]["mean_velocity"] == min(velocities)


def test_the_table_has_a_row_for_each_point(scenario):
    done = stickslip("sweep", scenario, *VARY)
    assert (done.returncode, done.stderr) == (0, "")
    rows = [line.split() for line in done.stdout.splitlines()]
    data = sweep(load(scenario), GRID)
    velocity = float(data["mean_velocity"].sel(drive_frequency=60.0, drive_mode="IPP"))
    assert ["60", "IPP", "ok", f"{velocity * 1e3:.4f}"] in [row[:4] for row in rows]
    assert "6 (3 drive_frequency x 2 drive_mode)" in done.stdout


def test_a_long_table_is_left_out(scenario):
    many = ["--vary", "drive.frequency=30:90:60", "--set=drive.coils=pairs"]
    done = stickslip("sweep", scenario, *many)
    assert len(done.stdout.splitlines()) == 4


def test_the_file_holds_the_dataset_of_the_library(scenario, tmp_path):
    done = stickslip(
        "sweep", scenario, *VARY, "--set=contact.adhesion=0", "--out=a.nc", cwd=tmp_path
    )
    assert done.returncode == 0
    expected = sweep(load(scenario).replace({"contact.adhesion": 0}), GRID)
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as stored:
        xarray.testing.assert_identical(stored.load(), expected)
    again = stickslip(
        "sweep", scenario, *VARY, "--set=contact.adhesion=0", "--out=a.nc", "--resume", cwd=tmp_path
    )
    assert (again.returncode, again.stdout) == (0, done.stdout)


def test_a_sweep_is_drawn(scenario, tmp_path):
    pulses = "--vary=drive.pulses=4,5"
    for name, vary in {"lines.png": VARY, "map.png": [*VARY[:2], pulses]}.items():
        done = stickslip("sweep", scenario, *vary, "--plot", tmp_path / name)
        assert (done.returncode, done.stderr) == (0, "")
        assert "points" in done.stdout
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--vary=drive.mode=IPP,OPP", "--plot=a.png"], "--plot: allowed with one --vary of num"),
        ([*VARY, "--vary=drive.pulses=4,5", "--plot=a.png"], "--plot: allowed with one --vary of"),
        ([*VARY, "--plot=a.xyz"], "--plot: a.xyz: allowed are names that end in"),
        ([*VARY, "--plot=a.nc", "--out=a.nc"], "--out and --plot: a.nc cannot be both"),
    ],
)
def test_pictures_that_cannot_be_are_refused_before_the_sweep(scenario, tmp_path, options, told):
    done = stickslip("sweep", scenario, *options, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"stickslip: {told}")
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]


def test_a_sweep_without_a_velocity_is_printed_and_not_drawn(scenario, tmp_path):
    refused = "--vary=contact.static_friction=0.05,0.1"
    done = stickslip("sweep", scenario, refused, "--plot", tmp_path / "a.png")
    assert done.returncode == 1
    assert "refused" in done.stdout
    assert "stickslip: --plot: nothing drawn: no point of the sweep has a velocity" in done.stderr
    assert not (tmp_path / "a.png").exists()


def test_ranges_are_decimal(scenario):
    done = stickslip("sweep", scenario, "--vary=contact.adhesion=0.1e-6:0.5e-6:5", "--json")
    values = [point["contact.adhesion"] for point in json.loads(done.stdout)["results"]]
    assert values == [1e-7, 2e-7, 3e-7, 4e-7, 5e-7]
    done = stickslip("sweep", scenario, "--vary=drive.pulses=9:4:2", "--json")
    assert [point["drive.pulses"] for point in json.loads(done.stdout)["results"]] == [9, 4]


def test_a_failed_point_is_counted_and_the_command_succeeds(scenario):
    done = stickslip("sweep", scenario, "--vary=contact.static_friction=0.1,0.2", "--json")
    assert done.returncode == 0
    assert done.stderr == (
        "stickslip: 1 of 2 points failed; the first: contact.kinetic_friction = 0.145 with "
        "contact.static_friction = 0.1: allowed is a kinetic friction that is not above the "
        "static one\n"
    )
    found = json.loads(done.stdout, parse_constant=pytest.fail)
    assert found["status"] == {"refused": 1, "ok": 1}
    assert found["results"][0]["mean_velocity"] is None
    assert "static_friction" in found["results"][0]["message"]
    done = stickslip("sweep", scenario, "--vary=contact.static_friction=0.1")
    assert done.returncode == 0
    assert "nan" in done.stdout


def test_help_has_an_example():
    done = stickslip("sweep", "--help")
    assert done.returncode == 0
    assert "Example:" in done.stdout
    assert "stickslip sweep scenario.toml --vary" in done.stdout


def test_an_interrupt_keeps_a_checkpoint(scenario, tmp_path):
    arguments = ["sweep", scenario, *ENDLESS, "--threads=2", "--out", tmp_path / "a.nc"]
    done, seen = ended_at_the_bar(*arguments, shows=rb"\d points/s")  # some are done
    assert (done.returncode, done.stdout) == (130, b"")
    assert b"Traceback" not in done.stderr
    assert b"<" in seen  # the time left
    assert b" %, --resume goes on with " in done.stderr
    with h5netcdf.File(tmp_path / "a.nc", "r") as file:
        assert 0 < file.attrs["finished_points"] < 1000


def test_a_full_disk_is_one_line(scenario, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    done = stickslip_process(
        "sweep", scenario, *VARY, "--out", folder / "a.nc", largest_file=10_000
    )
    assert done.returncode == 1
    # On a busy machine a line of progress may come before.
    *_, told = done.stderr.splitlines()
    assert told.startswith("stickslip: cannot write")
    assert "Traceback" not in done.stderr
    assert list(folder.iterdir()) == []


VARIED = {
    "nothing": ([], ["--vary"]),
    "no equals": (["drive.frequency"], ["drive.frequency", "key=start:stop:count"]),
    "no key": (["=1,2"], ["key=start:stop:count"]),
    "no value": (["drive.frequency="], ["no value"]),
    "missing value": (["drive.frequency=1,,2"], ["beside a comma"]),
    "unknown key": (["drive.freqency=1,2"], ["did you mean", "drive.frequency"]),
    "unknown section": (["robto.length=1e-4,2e-4"], ["robto.length", "robot.length"]),
    "repeated key": (["drive.frequency=1,2", "drive.frequency=3:4:2"], ["is there twice"]),
    "repeated value": (["drive.frequency=1,2,1.0"], ["given twice"]),
    "word for number": (["drive.frequency=low,high"], ['drive.frequency = "low"', "a number"]),
    "word not allowed": (["drive.mode=IPP,IPO"], ['drive.mode = "IPO"', '"IPP", "OPP"']),
    "number for word": (["drive.mode=0:1:2"], ["drive.mode = 0.0", '"IPP", "OPP"']),
    "out of range": (["drive.frequency=-5:5:3"], ["drive.frequency = -5.0", "from 1e-06"]),
    "nan": (["drive.frequency=1,nan"], ["drive.frequency = nan"]),
    "half pulses": (["drive.pulses=1:4:3"], ["drive.pulses = 2.5", "whole number"]),
    "empty range": (["drive.frequency=5:5:3"], ["the range is empty"]),
    "one value of two": (["drive.frequency=5:6:1"], ["both start and stop"]),
    "count 0": (["drive.frequency=5:200:0"], ["count", "from 1"]),
    "count 1.5": (["drive.frequency=5:200:1.5"], ["count", "whole number"]),
    "negative count": (["drive.frequency=5:200:-3"], ["count", "whole number"]),
    "endless count": (["drive.frequency=5:200:1" + "0" * 5000], ["count", "whole number"]),
    "great count": (["drive.frequency=5:200:100000000"], ["count", "10000000"]),
    "many points": (["drive.frequency=5:6:9999", "drive.hold=0:1:9999"], ["99980001 points"]),
    "no count": (["drive.frequency=5:200"], ["key=start:stop:count"]),
    "four parts": (["drive.frequency=5:200:3:4"], ["key=start:stop:count"]),
    "range of nothing": (["drive.frequency=::"], ["finite numbers"]),
    "range of words": (["drive.frequency=a:b:3"], ["finite numbers"]),
    "infinite range": (["drive.frequency=1:inf:3"], ["finite numbers"]),
    "huge range": (["drive.frequency=1:1e999999999999:3"], ["finite numbers"]),
    "record": (["record.rate=100,200"], ["record.rate", "summaries"]),
    "voltages": (["drive.file=a.csv,b.csv"], ["drive.file", "numbers and words"]),
}


@pytest.mark.parametrize("name", VARIED)
def test_values_that_are_refused(scenario, tmp_path, name):
    texts, words = VARIED[name]
    options = itertools.chain.from_iterable(("--vary", text) for text in texts)
    check(stickslip("sweep", scenario, *options, "--out", tmp_path / "a.nc"), *words)
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]


def test_a_varied_value_of_the_file_is_not_checked(tmp_path):
    (tmp_path / "s.toml").write_text(TEXT + "frequency = -3\n")
    done = stickslip("sweep", "s.toml", "--vary=drive.frequency=30,40", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    done = stickslip("sweep", "s.toml", "--vary=drive.peak=2e-3,3e-3", cwd=tmp_path)
    check(done, "s.toml: drive.frequency = -3")
    done = stickslip("sweep", "s.toml", "--vary=drive.frequency=-1,30", cwd=tmp_path)
    check(done, "--vary: drive.frequency = -1")


OPTIONS = {
    "threads 0": (["--threads=0"], ["--threads", "0"]),
    "threads 1.5": (["--threads=1.5"], ["--threads", "1.5"]),
    "threads and dask": (["--threads=2", "--dask=tcp://127.0.0.1:1"], ["--threads", "--dask"]),
    "resume without out": (["--resume"], ["--resume", "--out"]),
    "set and vary": (["--set=drive.mode=OPP"], ["drive.mode", "--set", "--vary"]),
    "bad setting": (["--set=drive.peak=high"], ["drive.peak", "a number"]),
    "missing folder": (["--out=missing/a.nc"], ["missing/a.nc", "no folder"]),
    "missing folder to resume": (["--out=missing/a.nc", "--resume"], ["no folder"]),
    "folder": (["--out=."], ["is a folder"]),
    "device": (["--out=/dev/null"], ["not an ordinary file"]),
    "existing": (["--out=other.nc"], ["already there", "--resume"]),
    "another file": (["--out=other.nc", "--resume"], ["cannot be resumed"]),
    "the scenario": (["--out=scenario.toml"], ["--out", "is the scenario", "overwrite"]),
    "the scenario to resume": (["--out=./scenario.toml", "--resume"], ["is the scenario"]),
    "another format": (["--out=a.csv"], ["--out", "a.csv", ".nc, .nc4, .h5"]),
    "no address": (["--dask=nonsense"], ["--dask nonsense", "no cluster"]),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options_that_are_refused(scenario, tmp_path, name):
    options, words = OPTIONS[name]
    (tmp_path / "other.nc").write_text("other")
    check(stickslip("sweep", "scenario.toml", *VARY, *options, cwd=tmp_path), *words)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["other.nc", "scenario.toml"]
    assert (tmp_path / "other.nc").read_text() == "other"
    assert scenario.read_text() == TEXT


def test_a_cluster_that_does_not_answer(scenario):
    def asked(listening):
        with socket.socket() as server:
            server.bind(("127.0.0.1", 0))
            if listening:
                server.listen()
            address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
            # It gives up by itself, long before the process would be ended.
            return address, stickslip_process("sweep", scenario, *VARY, "--dask", address)

    # Both do little but wait.
    with ThreadPoolExecutor() as pool:
        for address, done in pool.map(asked, (False, True)):
            check(done, address, "no cluster")


def test_the_file_of_another_scenario_is_not_touched(scenario, tmp_path):
    stickslip("sweep", scenario, *VARY, "--out", tmp_path / "a.nc")
    before = (tmp_path / "a.nc").read_bytes()
    done = stickslip(
        "sweep", scenario, *VARY, "--set=drive.hold=2e-3", "--out", tmp_path / "a.nc", "--resume"
    )
    check(done, "cannot be resumed", "another sweep")
    assert (tmp_path / "a.nc").read_bytes() == before


def test_nan_and_infinity_are_no_json(scenario):
    done = stickslip("sweep", scenario, "--vary=contact.static_friction=0.1", "--json")
    found = json.loads(done.stdout, parse_constant=pytest.fail)
    assert found["results"][0]["theta_max"] is None
    assert "highest" not in found
    assert np.isnan(sweep(load(scenario), {"contact.static_friction": [0.1]})["theta_max"]).all()


def test_a_sweep_of_headings_tells_the_velocity_along_them(scenario):
    done = stickslip("sweep", scenario, "--vary", "drive.heading=0,0.5,1.5")
    data = sweep(load(scenario), {"drive.heading": [0.0, 0.5, 1.5]})
    along, across = (data[name].values * 1e3 for name in ("velocity_along", "velocity_across"))
    head, _, *rows = [line.split() for line in done.stdout.splitlines()[:5]]
    assert head[:5] == ["heading", "status", "velocity", "along", "across"]
    assert [row[2:4] for row in rows] == [
        [f"{a:.4f}", f"{c + 0.0:.4f}"] for a, c in zip(along, across, strict=True)
    ]
    assert f"highest   {along.max():.6g} mm/s along the heading at drive.heading" in done.stdout
    assert "-0.0000" not in done.stdout
    found = json.loads(stickslip("sweep", scenario, "--vary=drive.heading=0,1.5", "--json").stdout)
    assert found["highest"]["velocity_along"] * 1e3 == pytest.approx(along[[0, 2]].max())


def test_columns_of_keys_that_share_their_last_word_have_their_whole_names(scenario):
    vary = [
        "--vary",
        "drive.heading=0,0.5",
        "--vary",
        "initial.heading=0,1",
        "--vary",
        "drive.base=0",
    ]
    head = stickslip("sweep", scenario, *vary).stdout.splitlines()[0].split()
    assert head[:4] == ["drive.heading", "initial.heading", "base", "status"]
