"""Runs: arrays, summaries, datasets, files, batches."""

import json
import pickle

import numpy as np
import pytest
import xarray

from recorded_runs import COARSE
from stickslip import Coils, Drive, Record, Scenario, Waveform, load, open_run, simulate
from stickslip.simulation.quantities import COLUMNS, INNER_COLUMNS, NUMBERS, PLANE_COLUMNS


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


def test_arrays_lie_on_the_grid(walk_ipp):
    run = walk_ipp
    # 0.05 s ramp and 12 pulses of 10 ms at 2 kHz: 340 intervals.
    assert run.ok
    assert run.t.shape == (341,)
    np.testing.assert_allclose(run.t, np.arange(341) / 2000.0, rtol=0, atol=1e-12)
    assert run.current.shape == (341, 5)
    for name in COLUMNS:
        if name not in ("event", *PLANE_COLUMNS, *INNER_COLUMNS):
            assert len(getattr(run, name)) == 341
    with pytest.raises(AttributeError, match=r'record\.rate to "events"'):
        _ = run.event


def test_arrays_agree_with_each_other(walk_ipp):
    run = walk_ipp
    # The start is flat and at rest: half the height up, the front corner half a length ahead.
    assert (run.x[0], run.z[0], run.theta[0]) == (0.0, 50e-6, 0.0)
    flying = run.contact == run.contact_names.index("flight")
    assert 0 < flying.sum() < len(flying)
    assert np.isnan(run.contact_x[flying]).all()
    assert np.isnan(run.slip_velocity[flying]).all()
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


def test_mean_velocity_is_that_of_the_arrays(walk_ipp):
    run = walk_ipp
    start, end = COARSE.window
    first, last = np.searchsorted(run.t, [start - 1e-9, end - 1e-9])
    velocity = (run.x[last] - run.x[first]) / (run.t[last] - run.t[first])
    assert run.mean_velocity == pytest.approx(velocity, rel=1e-9)
    inside = (run.t >= start) & (run.t <= end)
    assert run.summary()["theta_min"] <= run.theta[inside].min() + 1e-12
    assert run.summary()["theta_max"] >= run.theta[inside].max() - 1e-12


def test_the_summary_has_the_documented_keys(walk_ipp):
    run = walk_ipp
    summary = run.summary()
    names = ["mean_velocity", "theta_min", "theta_max", "slip_up", "slip_down"]
    names += ["airborne_fraction", "events", "painleve_events", "status", "message"]
    assert {*names, "simulated_time"} <= set(summary)
    assert summary["status"] == "ok"
    assert summary["simulated_time"] == pytest.approx(0.17)
    assert (summary["window_start"], summary["window_end"]) == COARSE.window
    assert summary["notes"] == [note.as_dict() for note in run.notes]
    assert summary["events"]["lift_off"] > 0
    assert "painleve" not in summary["events"]
    summary["events"]["lift_off"] = -1
    assert run.summary()["events"]["lift_off"] > 0


def test_the_numbers_of_the_summary_are_attributes(walk_ipp):
    summary = walk_ipp.summary()
    for name in NUMBERS.keys() - {"pull_share"}:
        np.testing.assert_equal(getattr(walk_ipp, name), summary[name])
    with pytest.raises(AttributeError, match="pull_share: set"):
        walk_ipp.pull_share  # noqa: B018
    assert "pull_share" not in summary


def test_a_record_of_events_holds_each_event():
    run = simulate(COARSE.replace({"record.rate": "events"}))
    counts = np.bincount(run.event, minlength=len(run.event_names))
    summary = run.summary()
    expected = {**summary["events"], "painleve": summary["painleve_events"]}
    assert dict(zip(run.event_names, counts.tolist(), strict=True)) == expected
    assert set(run.to_xarray()) >= {"event", "contact"}


def test_without_a_record_the_hint_names_the_key():
    run = simulate(COARSE.replace({"record.rate": "none"}))
    assert run.mean_velocity == pytest.approx(simulate(COARSE).mean_velocity, rel=1e-6)
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
            "solver.max_step": 1e-3,
        }
    )
    run = simulate(scenario)
    assert not run.ok
    assert run.status == "left_workspace"
    assert "coils" in run.message
    assert 0 < len(run.t) < scenario.duration * 100
    assert run.summary()["status"] == "left_workspace"
    # Its step ends behind 0.9 of the way to a coil's plane; none is in the way where none drives.
    assert 0.9 <= run.final_state.x / scenario.coil.distance < 0.92
    off = Waveform.hold(0.3, {})
    free = simulate(scenario.replace({"drive.mode": "program", "drive.program": off}))
    assert free.ok
    assert free.x[-1] > 2.0 * scenario.coil.distance


def test_progress_rises_and_can_stop():
    long = COARSE.replace({"solver.max_step": 2e-7, "record.rate": "none"})
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


def test_runs_pickle(walk_ipp):
    run = walk_ipp
    again = pickle.loads(pickle.dumps(run))
    assert again.scenario == run.scenario
    assert again.summary() == run.summary()
    np.testing.assert_array_equal(again.theta, run.theta)


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


def test_a_run_at_a_heading_tells_its_velocity_along_it(steered):
    along, across = steered.velocity
    assert along > 1e-3
    assert steered.mean_velocity < 0.1 * along
    assert f"{along * 1e3:.6g} mm/s" in repr(steered)
    assert f"{across * 1e3:.6g} mm/s" in repr(steered)
    summary = steered.summary()
    assert (summary["velocity_along"], summary["velocity_across"]) == (along, across)
    there, back = (
        simulate(steered.scenario.replace({"drive.heading": 0.5, "drive.direction": direction}))
        for direction in ("+x", "-x")
    )
    assert back.velocity == pytest.approx(there.velocity, rel=1e-6)


def test_other_runs_tell_their_velocity_along_the_axes(program, walk_ipp):
    assert program.scenario.whole_plane
    for run in (program, walk_ipp):
        assert f"{run.mean_velocity * 1e3:.6g} mm/s" in repr(run)
        assert "velocity_along" not in run.summary()


def test_the_file_of_a_run_says_what_its_columns_are(walk_ipp, tmp_path):
    walk_ipp.save(tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as read:
        for name, column in COLUMNS.items():
            if name in ("event", *PLANE_COLUMNS, *INNER_COLUMNS):
                assert name not in read
                continue
            np.testing.assert_array_equal(read[name].values, getattr(walk_ipp, name), err_msg=name)
            assert read[name].attrs["units"] == column.unit
            assert read[name].attrs["long_name"] == column.meaning
        assert list(read["coil"].values) == ["xp", "xm", "yp", "ym", "clamp"]
        flags = read["contact"].attrs
        assert flags["flag_meanings"].split()[flags["flag_values"][0]] == "flight"
        assert read.attrs["mean_velocity"] == walk_ipp.mean_velocity
        assert json.loads(read.attrs["events"]) == walk_ipp.summary()["events"]
        (tmp_path / "again.toml").write_text(read.attrs["scenario"])
        assert load(tmp_path / "again.toml") == walk_ipp.scenario
