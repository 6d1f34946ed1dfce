"""Runs: arrays, summaries, datasets, files, batches."""

import json
import math
import pickle
import resource
import subprocess
import sys

import numpy as np
import pytest
import xarray

from stickslip import (
    Coils,
    Drive,
    Record,
    Scenario,
    ScenarioError,
    Waveform,
    load,
    open_run,
    plot,
    simulate,
    simulate_batch,
)
from stickslip.simulation.columns import COLUMNS, PLANE_COLUMNS

SCENARIO = Scenario(drive=Drive(base=0.5e-3, pulses=12), record=Record(rate=2000.0))


@pytest.fixture(scope="module")
def run():
    return simulate(SCENARIO)


# Mean velocities in mm/s on which two independent programs agree within 0.05 %.
@pytest.mark.parametrize(
    ("mode", "frequency", "base", "hold", "edge", "clamp", "velocity"),
    [
        ("IPP", 100, 0.5e-3, 1.0e-3, "rise", "down", 1.9128),
        ("IPP", 30, 0.5e-3, 1.0e-3, "fall", "up", 0.5986),
        ("OPP", 30, 0.5e-3, 2.5e-3, "fall", "down", 0.7186),
        ("OPP", 100, 0.0, 2.5e-3, "rise", "up", 3.0680),
    ],
)
def test_every_field_of_the_drive_reaches_the_core(
    mode, frequency, base, hold, edge, clamp, velocity
):
    drive = Drive(
        mode=mode, frequency=frequency, base=base, hold=hold, edge=edge, clamp=clamp, pulses=20
    )
    assert simulate(Scenario(drive=drive)).mean_velocity * 1e3 == pytest.approx(velocity, rel=5e-4)


def test_arrays_lie_on_the_grid(run):
    # 0.05 s ramp and 12 pulses of 10 ms at 2 kHz: 340 intervals.
    assert run.ok
    assert run.t.shape == (341,)
    np.testing.assert_allclose(run.t, np.arange(341) / 2000.0, rtol=0, atol=1e-12)
    assert run.current.shape == (341, 5)
    for name in COLUMNS:
        if name not in ("event", *PLANE_COLUMNS):
            assert len(getattr(run, name)) == 341
    with pytest.raises(AttributeError, match=r'record\.rate to "events"'):
        _ = run.event


def test_arrays_agree_with_each_other(run):
    # The start is flat and at rest: half the height up, the front corner half a length ahead.
    assert (run.x[0], run.z[0], run.theta[0]) == (0.0, 50e-6, 0.0)
    flying = run.contact == run.contact_names.index("flight")
    assert 0 < flying.sum() < len(flying)
    assert np.isnan(run.contact_x[flying]).all()
    assert (run.normal_force[flying] == 0.0).all()
    touching = ~flying
    assert np.isfinite(run.contact_x[touching]).all()
    # Eq. (13)-(14): corner and centre are sqrt(L^2 + H^2)/2 apart.
    distance = np.hypot(run.x - run.contact_x, run.z)[touching]
    assert distance == pytest.approx(np.hypot(250e-6, 100e-6) / 2, rel=1e-9)
    # The field at the centre of mass is that of the currents there.
    points = np.column_stack([run.x, np.zeros_like(run.x), run.z])
    field = Coils().field(points[1:], run.current[1:])
    np.testing.assert_allclose(run.bx[1:], field[:, 0], atol=2e-9)
    np.testing.assert_allclose(run.bz[1:], field[:, 2], atol=2e-9)


def test_mean_velocity_is_that_of_the_arrays(run):
    start, end = SCENARIO.window
    first, last = np.searchsorted(run.t, [start - 1e-9, end - 1e-9])
    velocity = (run.x[last] - run.x[first]) / (run.t[last] - run.t[first])
    assert run.mean_velocity == pytest.approx(velocity, rel=1e-9)
    inside = (run.t >= start) & (run.t <= end)
    assert run.summary()["theta_min"] <= run.theta[inside].min() + 1e-12
    assert run.summary()["theta_max"] >= run.theta[inside].max() - 1e-12


def test_the_summary_has_the_documented_keys(run):
    summary = run.summary()
    names = ["mean_velocity", "theta_min", "theta_max", "slip_up", "slip_down"]
    names += ["airborne_fraction", "events", "painleve_events", "status", "message"]
    assert {*names, "simulated_time"} <= set(summary)
    assert summary["status"] == "ok"
    assert summary["simulated_time"] == pytest.approx(0.17)
    assert (summary["window_start"], summary["window_end"]) == SCENARIO.window
    assert summary["notes"] == [note.as_dict() for note in run.notes]
    assert summary["events"]["lift_off"] > 0
    assert "painleve" not in summary["events"]
    summary["events"]["lift_off"] = -1
    assert run.summary()["events"]["lift_off"] > 0


def test_a_record_of_events_holds_each_event():
    run = simulate(SCENARIO.replace({"record.rate": "events"}))
    counts = np.bincount(run.event, minlength=len(run.event_names))
    summary = run.summary()
    expected = {**summary["events"], "painleve": summary["painleve_events"]}
    assert dict(zip(run.event_names, counts.tolist(), strict=True)) == expected
    assert set(run.to_xarray()) >= {"event", "contact"}


def test_without_a_record_the_hint_names_the_key():
    run = simulate(SCENARIO.replace({"record.rate": "none"}))
    assert run.mean_velocity == pytest.approx(simulate(SCENARIO).mean_velocity, rel=1e-6)
    with pytest.raises(AttributeError, match=r"did not record theta: set record\.rate"):
        _ = run.theta
    with pytest.raises(AttributeError, match=r"set record\.rate"):
        run.to_xarray()
    with pytest.raises(AttributeError, match="no attribute 'thta'"):
        _ = run.thta


def test_a_failed_simulation_is_a_status():
    # Full slopes and no friction: the robot slides down 0.1 m to the coils.
    scenario = Scenario().replace(
        {
            "effects.surface_tilt.angle": 1.4,
            "contact.static_friction": 0.0,
            "contact.kinetic_friction": 0.0,
            "drag.linear": 0.0,
            "record.rate": 100.0,
        }
    )
    run = simulate(scenario)
    assert not run.ok
    assert run.status == "left_workspace"
    assert "coils" in run.message
    assert 0 < len(run.t) < scenario.duration * 100
    assert run.summary()["status"] == "left_workspace"


def test_a_run_of_twelve_pulses_is_read_back(run, tmp_path):
    path = tmp_path / "run.nc"
    run.save(path)
    assert [each.name for each in tmp_path.iterdir()] == ["run.nc"]
    with xarray.open_dataset(path, engine="h5netcdf") as read:
        for name, column in COLUMNS.items():
            if name in ("event", *PLANE_COLUMNS):
                assert name not in read
                continue
            np.testing.assert_array_equal(read[name].values, getattr(run, name), err_msg=name)
            assert read[name].attrs["units"] == column.unit
            assert read[name].attrs["long_name"] == column.meaning
        assert list(read["coil"].values) == ["xp", "xm", "yp", "ym", "clamp"]
        flags = read["contact"].attrs
        assert flags["flag_meanings"].split()[flags["flag_values"][0]] == "flight"
        assert read.attrs["mean_velocity"] == run.mean_velocity
        assert json.loads(read.attrs["events"]) == run.summary()["events"]
        (tmp_path / "again.toml").write_text(read.attrs["scenario"])
        assert load(tmp_path / "again.toml") == SCENARIO


def test_a_saved_run_is_opened_and_drawn(run, tmp_path):
    run.save(tmp_path / "run.nc")
    opened = open_run(tmp_path / "run.nc")
    assert opened.to_xarray().identical(run.to_xarray())
    (tmp_path / "run.nc").unlink()
    assert plot.run(opened).axes
    with pytest.raises(ScenarioError, match=r"run\.nc: cannot be read: No such file"):
        open_run(tmp_path / "run.nc")
    for draw in (plot.run, plot.fields):
        with pytest.raises(ScenarioError, match=r"= Scenario\(.*: allowed is a Run") as refusal:
            draw(SCENARIO)
        assert "\n" not in str(refusal.value)
    run.to_xarray().drop_attrs().to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(ValueError, match="is no run"):
        open_run(tmp_path / "other.nc")


@pytest.mark.parametrize("data", [b"", b"no netCDF file\n", b"\x89HDF\r\n\x1a\n" + bytes(600)])
def test_what_is_no_netcdf_file_is_refused_in_one_line(tmp_path, data):
    path = tmp_path / "run.nc"
    path.write_bytes(data)
    with pytest.raises(ScenarioError) as refusal:
        open_run(path)
    allowed = "allowed is a netCDF file that Run.save or --out wrote"
    assert str(refusal.value) == f"{path}: is no netCDF file; {allowed}"


def test_a_record_of_events_as_csv_has_the_names_of_events(tmp_path):
    run = simulate(SCENARIO.replace({"record.rate": "events"}))
    run.save(tmp_path / "run.csv")
    rows = [line.split(",") for line in (tmp_path / "run.csv").read_text().splitlines()]
    assert rows[0][-2:] == ["contact", "event"]
    assert [row[-1] for row in rows[1:]] == [run.event_names[k] for k in run.event]
    slip = rows[0].index("slip_velocity (m/s)")
    flying = [row[slip] for row in rows[1:] if row[-2] == "flight"]
    assert set(flying) == {""}


@pytest.mark.parametrize(
    ("changes", "notes"),
    [
        ({}, []),
        # 10 ohm over 0.96258 mT/A: 10389 V for 1 T in one coil, half of that in each of a pair, so
        # 207.8 V for 40 mT.
        ({"drive.peak": 40e-3}, ["asks for 207.8 V at coil xp, 20.78 A"]),
        ({"drive.pulses": 4}, []),
        ({"drive.pulses": 3}, ["drive.pulses = 3 is fewer than 4", "includes the start-up"]),
        ({"drive.hold": 20e-3, "drive.direction": "-x"}, ["207.8 V at coil clamp"]),
        ({"drive.mode": "OPP", "drive.peak": 20e-3, "drive.edge": "fall"}, ["at coil clamp"]),
        ({"drive.peak": 0.0, "drive.base": 0.0, "drive.hold": 0.0}, ["never moved"]),
        ({"drive.base": 0.0, "drive.peak": 0.0}, ["no pulses", "rolled over", "forth"]),
        ({"solver.rtol": 1e-4}, ["solver.rtol = 0.0001 is looser", "by a per cent", "1e-08"]),
        ({"solver.rtol": 1e-5}, []),
        (
            {"contact.tangential_restitution": 0.6},
            ["0.6 has no effect", "contact.restitution is 0"],
        ),
        ({"contact.tangential_restitution": 0.6, "contact.restitution": 0.1}, []),
    ],
)
def test_notes_report_unusual_results_of_a_run(changes, notes):
    unpulled = {"record.rate": "none", "drive.pulses": 20, "drive.coils": "pairs"}
    scenario = SCENARIO.replace({**unpulled, **changes})
    found = [str(note) for note in simulate(scenario).notes]
    if not notes:
        assert found == []
    text = "\n".join(found)
    for note in notes:
        assert note in text


def test_notes_of_a_program_name_its_coil():
    waveform = Waveform.hold(0.02, {"ym": -300.0})
    scenario = Scenario(drive=Drive(mode="program", program=waveform))
    assert any("300 V at coil ym, 30 A" in str(note) for note in simulate(scenario).notes)


def test_a_file_that_cannot_be_written_leaves_nothing(run, tmp_path):
    with pytest.raises(OSError, match="there is no folder"):
        run.save(tmp_path / "missing" / "run.nc")
    (tmp_path / "folder.nc").mkdir()
    with pytest.raises(OSError, match="is a folder"):
        run.save(tmp_path / "folder.nc")
    (tmp_path / "folder.nc").rmdir()
    with pytest.raises(ValueError, match=r"run\.txt: allowed are names that end in .*\.csv"):
        run.save(tmp_path / "run.txt")
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_the_older_file(tmp_path):
    (tmp_path / "run.nc").write_text("older")
    code = (
        "from stickslip import *\n"
        f"run = simulate(Scenario(record=Record(rate=1e4)))\n"
        f"try: run.save({str(tmp_path / 'run.nc')!r})\n"
        "except OSError as error: print(error)\n"
    )

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, preexec_fn=limit, timeout=60
    )
    assert done.stderr == ""
    assert done.stdout.startswith("cannot write")
    assert [each.name for each in tmp_path.iterdir()] == ["run.nc"]
    assert (tmp_path / "run.nc").read_text() == "older"


def test_a_batch_is_the_same_for_any_number_of_threads():
    scenarios = [
        SCENARIO.replace({"drive.frequency": f, "drive.mode": mode})
        for f in (30.0, 70.0, 100.0)
        for mode in ("IPP", "OPP")
    ]
    one, two = (simulate_batch(scenarios, threads=n) for n in (1, 2))
    alone = [simulate(scenario) for scenario in scenarios]
    for runs in (two, alone):
        for first, second in zip(one, runs, strict=True):
            assert first.scenario == second.scenario
            assert repr(first.summary()) == repr(second.summary())
            assert first.x.tobytes() == second.x.tobytes()
            assert first.contact.tobytes() == second.contact.tobytes()
    assert len({run.mean_velocity for run in one}) == len(scenarios)


def test_bad_batches_are_refused():
    assert simulate_batch([]) == []
    for threads in (0, -1, 1.5, True):
        with pytest.raises(ValueError, match="threads"):
            simulate_batch([SCENARIO], threads=threads)
    with pytest.raises(ScenarioError, match="scenario 1"):
        simulate_batch([SCENARIO, "scenario.toml"])


def test_progress_rises_and_can_stop():
    long = SCENARIO.replace({"solver.max_step": 2e-7, "record.rate": "none"})
    told = []
    simulate(long, progress=lambda *each: told.append(each))
    assert {stage for _, stage in told} == {"simulating"}
    seen = [fraction for fraction, _ in told]
    assert len(seen) >= 2
    assert seen == sorted(seen)
    assert 0.0 <= seen[0] < seen[-1] <= 1.0

    def stop(fraction, stage):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        # 5e8 steps, half of what solver.max_steps allows.
        simulate(long.replace({"drive.pulses": 10_000}), progress=stop)


def test_runs_pickle(run):
    again = pickle.loads(pickle.dumps(run))
    assert again.scenario == run.scenario
    assert again.summary() == run.summary()
    np.testing.assert_array_equal(again.theta, run.theta)


def test_what_was_never_measured_is_nan():
    # A run that leaves the workspace in its ramp never opens the measuring window.
    scenario = Scenario().replace(
        {
            "drive.ramp": 100.0,
            "effects.surface_tilt.angle": 1.4,
            "contact.static_friction": 0.0,
            "contact.kinetic_friction": 0.0,
        }
    )
    run = simulate(scenario)
    assert run.status == "left_workspace"
    assert math.isnan(run.mean_velocity)


def test_a_run_at_a_heading_tells_its_velocity_along_it():
    drive = {"base": 0.5e-3, "pulses": 5, "heading": 1.5}
    run = simulate(Scenario(drive=Drive(**drive)))
    along, across = run.velocity
    assert along > 1e-3
    assert run.mean_velocity < 0.1 * along
    assert f"{along:.6g} m/s along the heading, {across:.6g} m/s to its left" in repr(run)
    summary = run.summary()
    assert (summary["velocity_along"], summary["velocity_across"]) == (along, across)
    back = simulate(Scenario(drive=Drive(**{**drive, "heading": 0.5}, direction="-x"))).velocity
    ahead = simulate(Scenario(drive=Drive(**{**drive, "heading": 0.5}))).velocity
    assert back == pytest.approx(ahead, rel=1e-6)


def test_a_program_in_the_whole_plane_tells_its_velocity_along_the_axes():
    run = simulate(
        Scenario(drive=Drive(mode="program", program=Waveform.hold(0.02, {"xp": 20.0, "yp": 9.0})))
    )
    assert run.scenario.turns
    assert "velocity_along" not in run.summary()
    assert f"{run.mean_velocity:.6g} m/s along x, " in repr(run)


def test_a_run_in_its_plane_has_one_velocity(run):
    assert repr(run) == f"<Run: ok, {run.mean_velocity:.6g} m/s, {run.samples} samples>"
    assert "velocity_along" not in run.summary()


@pytest.mark.parametrize(
    ("drive", "heading"), [({}, 0.0), ({"direction": "-x"}, np.pi), ({"heading": np.pi}, np.pi)]
)
def test_a_run_in_its_plane_has_a_constant_y_and_heading(drive, heading, tmp_path):
    made = simulate(
        Scenario(
            drive=Drive(base=0.5e-3, pulses=2, **drive),
            record=Record(rate=2e3, fields="x", dtype="float32"),
        )
    )
    made.save(tmp_path / "a.nc")
    for run in (made, open_run(tmp_path / "a.nc")):
        assert run.y.tolist() == run.vy.tolist() == [0.0] * run.samples
        assert run.heading.dtype == np.float32
        assert run.heading.tolist() == [np.float32(heading)] * run.samples
        assert "y" not in run.to_xarray()
        with pytest.raises(AttributeError, match="stays in the plane"):
            _ = run.slip_across
    with pytest.raises(AttributeError, match=r"record\.rate"):
        _ = simulate(Scenario(drive=Drive(pulses=1))).y
