"""The command `stickslip sweep`: output, exit statuses, interrupts, bad input."""

import itertools
import json
import socket
from concurrent.futures import ThreadPoolExecutor

import distributed
import pandas as pd
import pytest
import xarray

from command_line import check, stickslip, stickslip_process
from stickslip import load, simulate, sweep
from stickslip._util.text import json_text

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 4\n"
VARY = ["--vary", "drive.frequency=30:90:3", "--vary", "drive.mode=OPP,IPP"]
GRID = {"drive.frequency": [30.0, 60.0, 90.0], "drive.mode": ["OPP", "IPP"]}


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
    assert ["60", "IPP", "ok", f"{velocity:.6g}"] in [row[:4] for row in rows]
    assert "6 (3 drive_frequency x 2 drive_mode)" in done.stdout
    rows = stickslip("sweep", scenario, "--vary=drive.frequency=30:80:51").stdout.splitlines()
    assert rows[0].startswith("51 points")
    ends = [row.split() for row in rows if row.startswith(("lowest", "highest"))]
    assert [end[:2] for end in ends[:2]] == [["lowest", "30"], ["highest", "80"]]


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


def test_a_table_is_written_once_at_the_end(scenario, tmp_path):
    options = ("--vary=drive.frequency=10:1000:3:log", "--set=drive.pulses=4", "--out=a.csv")
    done = stickslip("sweep", scenario, *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    table = pd.read_csv(tmp_path / "a.csv")
    assert table["drive_frequency (Hz)"].tolist() == [10.0, 100.0, 1000.0]
    data = sweep(load(scenario).replace({"drive.pulses": 4}), {"drive.frequency": [10, 100, 1000]})
    assert table["mean_velocity (m/s)"].tolist() == data["mean_velocity"].values.tolist()
    check(stickslip("sweep", scenario, *options, cwd=tmp_path), "a.csv already exists")


def test_a_sweep_is_drawn(scenario, tmp_path):
    pulses = "--vary=drive.pulses=4,5"
    for name, vary in {"lines.png": VARY, "map.png": [*VARY[:2], pulses]}.items():
        done = stickslip("sweep", scenario, *vary, "--plot", tmp_path / name)
        assert (done.returncode, done.stderr) == (0, "")
        assert "points" in done.stdout
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_a_sweep_without_a_velocity_is_printed_and_not_drawn(scenario, tmp_path):
    refused = "--vary=contact.static_friction=0.05,0.1"
    done = stickslip("sweep", scenario, refused, "--plot", tmp_path / "a.png")
    assert done.returncode == 1
    assert "refused" in done.stdout
    assert "2 of 2 points failed" in done.stderr
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
    assert done.stderr.startswith("stickslip: 1 of 2 points failed; the first: contact.")
    found = json.loads(done.stdout, parse_constant=pytest.fail)
    assert done.stderr.count("\n") == 1
    assert found["status"] == {"refused": 1, "ok": 1}
    for name in ("mean_velocity", "theta_max"):
        assert found["results"][0][name] is None
    assert "static_friction" in found["results"][0]["message"]
    none = ("sweep", scenario, "--vary=contact.static_friction=0.1")
    done = stickslip(*none)
    assert done.returncode == 1
    assert "NaN" in done.stdout
    assert "highest" not in json.loads(stickslip(*none, "--json").stdout)


def test_dask(scenario, tmp_path):
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=True, dashboard_address=None
    ) as cluster:
        address = cluster.scheduler_address
        done = stickslip("sweep", scenario, *VARY, "--dask", address, "--out=a.nc", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as stored:
        xarray.testing.assert_identical(stored.load(), sweep(load(scenario), GRID))


@pytest.mark.nightly
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


def test_a_sweep_of_headings_tells_the_velocity_along_them(scenario):
    vary = "--vary=drive.heading=0,0.5,1.5"
    table = stickslip("sweep", scenario, vary).stdout
    data = sweep(load(scenario), {"drive.heading": [0.0, 0.5, 1.5]})
    along = data["velocity_along"].values
    assert table.split()[2:4] == ["velocity_along", "velocity_across"]
    assert f"highest  {along.max() * 1e3:.6g} mm/s along the heading at drive.heading" in table
    found = json.loads(stickslip("sweep", scenario, vary, "--json").stdout)
    assert found["highest"]["velocity_along"] == along.max()
    assert [each["velocity_along"] for each in found["results"]] == along.tolist()
