"""Sweeps from Python: which points there are, how they are labelled, and what is kept of them."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray

import stickslip
from stickslip import Coil, Drive, Record, Scenario, Waveform, _core, simulate, sweep
from stickslip.simulation.quantities import ASKED
from stickslip.sweeping.dataset import EVENTS, notes_of
from stickslip.sweeping.points import from_changes, name_of

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=4))
FREQUENCIES = [200.0, 30.0, 100.0]
MODES = ["OPP", "IPP"]


def assert_point(point, run):
    """All that a sweep keeps of a point is what the run says, to the last bit."""
    summary = run.summary()
    for name in set(_core.summary_numbers) - {*ASKED}:
        np.testing.assert_equal(float(point[name]), summary[name], err_msg=name)
    assert dict(zip(EVENTS, point["events"].values.tolist(), strict=True)) == summary["events"]
    assert int(point["painleve_events"]) == summary["painleve_events"]
    assert int(point["status"]) == 0


def test_a_grid_has_the_order_and_labels_it_was_given():
    data = sweep(BASE, {"drive.frequency": FREQUENCIES, "drive.mode": MODES}, threads=2)
    assert data["mean_velocity"].dims == ("drive_frequency", "drive_mode")
    assert data["events"].dims == ("drive_frequency", "drive_mode", "event")
    assert data["drive_frequency"].values.tolist() == FREQUENCIES
    assert data["drive_mode"].values.tolist() == MODES
    assert data["drive_frequency"].attrs["units"] == "Hz"
    assert all(variable.attrs["long_name"] for variable in data.variables.values())
    assert "message" not in data
    for frequency in FREQUENCIES:
        for mode in MODES:
            run = simulate(BASE.replace({"drive.frequency": frequency, "drive.mode": mode}))
            assert_point(data.sel(drive_frequency=frequency, drive_mode=mode), run)


def test_attributes_say_what_was_swept():
    data = sweep(BASE, {"drive.mode": MODES, "drive.pulses": np.array([4, 5])})
    about = json.loads(data.attrs["sweep"])
    assert about["vary"] == {"drive.mode": MODES, "drive.pulses": [4, 5]}
    assert about["dimensions"] == {"drive_mode": 2, "drive_pulses": 2}
    assert about["scenario"] == BASE.to_toml()
    assert about["stickslip_version"] == stickslip.__version__
    assert json.loads(data.attrs["statuses"]) == {"ok": 4}
    assert (data.attrs["finished_points"], data.attrs["failed_points"]) == (4, 0)
    assert data["drive_pulses"].dtype == np.int64


def test_no_key_is_called_like_another_or_like_a_result():
    names = [name_of(key) for key in Scenario.keys()]  # noqa: SIM118
    results = sweep(BASE, {"drive.heading": [0.5]}).variables
    assert len({*names, *results}) == len(names) + len(results) - 1
    assert all(name.isidentifier() for name in names)


def test_a_list_of_changes_is_one_point_each():
    rows = [{"drive.mode": "OPP"}, {"drive.frequency": 30}, {}, {}]
    data = sweep(BASE, rows)
    assert data["status"].dims == ("point",)
    assert data["drive_frequency"].values.tolist() == [100.0, 30.0, 100.0, 100.0]
    assert data["drive_mode"].values.tolist() == ["OPP", "IPP", "IPP", "IPP"]
    for place, row in enumerate(rows):
        assert_point(data.isel(point=place), simulate(BASE.replace(row)))
    assert_point(sweep(BASE, [{}]).isel(point=0), simulate(BASE))


def test_a_table_is_a_list():
    table = pd.DataFrame({"drive.mode": MODES, "drive.pulses": [4, 5]})
    xarray.testing.assert_identical(sweep(BASE, table), sweep(BASE, table.to_dict("records")))


def test_a_change_of_all_coils_leaves_none_of_a_single_one():
    # Where coils differ, no value of all coils stands for "as before".
    unequal = BASE.replace({"coil.turns": 100.0, "coil.xp.turns": 110.0})
    rows = [{}, {"coil.turns": 90.0}, {"coil.xm.turns": 95.0}]
    for base in (BASE, unequal):
        data = sweep(base, rows)
        for place, row in enumerate(rows):
            assert_point(data.isel(point=place), simulate(base.replace(row)))
    grid = sweep(BASE, {"coil.xp.turns": [120.0], "coil.turns": [100.0]})
    both = simulate(BASE.replace({"coil.turns": 100.0, "coil.xp.turns": 120.0}))
    assert_point(grid.isel(coil_xp_turns=0, coil_turns=0), both)
    assert unequal.coil != Coil()


def test_voltages_are_part_of_a_sweep():
    program = Waveform.ipp(base=0.5e-3, pulses=4)
    played = Scenario(drive=Drive(mode="program", program=program))
    data = sweep(played, {"contact.adhesion": [0.1e-6, 0.2e-6]})
    assert_point(
        data.sel(contact_adhesion=0.2e-6), simulate(played.replace({"contact.adhesion": 0.2e-6}))
    )
    mixed = sweep(played, [{"drive.mode": "IPP", "drive.pulses": 4}, {}])
    assert mixed["drive_mode"].values.tolist() == ["IPP", "program"]
    ipp = {"drive.program": None, "drive.mode": "IPP", "drive.pulses": 4}
    assert_point(mixed.isel(point=0), simulate(played.replace(ipp)))
    assert_point(mixed.isel(point=1), simulate(played))


def test_what_is_recorded_is_ignored():
    vary = {"drive.frequency": [100.0]}
    recorded = sweep(Scenario(drive=BASE.drive, record=Record(rate=1e3)), vary)
    xarray.testing.assert_identical(recorded, sweep(BASE, vary))


def test_a_point_that_fails_is_a_status():
    data = sweep(
        BASE.replace({"contact.kinetic_friction": 0.0, "drive.ramp": 100.0}),
        {"contact.static_friction": [0.0, 0.2], "effects.surface_tilt.angle": [1.4]},
    )
    names = data["status"].attrs["flag_meanings"].split()
    first = data["status"].attrs["flag_values"][0]
    assert names[int(data["status"][0, 0]) - first] == "left_workspace"
    assert "reached the coils" in str(data["message"][0, 0].item())
    for name in set(_core.summary_numbers) - {*ASKED, "simulated_time"}:
        assert np.isnan(data[name][0, 0]), name
    assert 0.0 < float(data["simulated_time"][0, 0]) < 100.0

    data = sweep(BASE, {"contact.static_friction": [0.2, 0.1]})
    assert data["status"].values.tolist() == [0, -1]
    assert data["message"].values.tolist()[0] == ""
    assert "contact.static_friction = 0.1" in str(data["message"][1].item())
    assert json.loads(data.attrs["statuses"]) == {"refused": 1, "ok": 1}
    assert data.attrs["failed_points"] == 1
    assert np.isfinite(data["mean_velocity"].values).tolist() == [True, False]


def test_points_that_fail_are_in_no_note():
    # It slides to the coils, so its field changes.
    slides = {"effects.surface_tilt.angle": 0.8, "drag.linear": 1e-7, "drive.pulses": 200}
    points = from_changes(BASE, [slides, {}])
    columns, _ = _core.sweep(points.scenario.to_core(), points.keys, points.rows(np.arange(2)))
    assert columns["field_change"][0] > 0.1
    assert columns["status"][0] != 0
    assert "field-change" not in {note.code for note in notes_of(points, columns, "points")}


def test_mean_velocities_alone_have_the_bits_of_a_sweep():
    changes = [
        {}, {"effects.sample_hold.period": 2e-4}, {"effects.free_field_time.knot_3": 0.2},
        {"effects.mutual_inductance.coupling": 0.1}, {"drive.latency": 2e-3, "drive.ramp": 1e-2},
        {"contact.static_friction": 0.1}, {"solver.max_steps": 100},
    ]  # fmt: skip
    points = from_changes(BASE, changes)
    asked = points.scenario.to_core(), points.keys, points.rows(np.arange(len(changes)))
    columns, _ = _core.sweep(*asked)
    ended = columns["status"] == 0
    assert ended.tolist() == [True] * 5 + [False] * 2
    expected = np.where(ended, columns["mean_velocity"], np.nan)
    assert np.array_equal(_core.mean_velocities(*asked), expected, equal_nan=True)


def test_progress_ends_with_everything_done():
    told = []
    sweep(BASE, {"drive.frequency": [30.0, 100.0]}, progress=lambda *each: told.append(each))
    seen = [fraction for fraction, _ in told]
    assert seen == sorted(seen)
    assert (seen[0], seen[-1]) == (0.0, 1.0)
    assert {stage for _, stage in told} == {"simulating"}


HEADINGS = [0.0, 0.5, 1.5]


def test_a_sweep_of_headings_has_the_velocities_along_them():
    vary = {"drive.direction": ["+x", "-x"], "drive.heading": HEADINGS}
    data = sweep(BASE, vary)
    for direction in ("+x", "-x"):
        for heading in HEADINGS:
            changes = {"drive.direction": direction, "drive.heading": heading}
            at = data.sel(drive_direction=direction, drive_heading=heading)
            found = (at.velocity_along.item(), at.velocity_across.item())
            assert found == simulate(BASE.replace(changes)).velocity
    listed = sweep(BASE, [{"drive.heading": heading} for heading in HEADINGS])
    along = data.velocity_along.sel(drive_direction="+x").values
    np.testing.assert_array_equal(listed.velocity_along.values, along)
    assert listed.velocity_along.attrs["units"] == "m/s"


def test_a_sweep_in_the_plane_has_no_velocity_along_headings():
    data = sweep(BASE, {"drive.heading": [0.0, np.pi]})
    assert "velocity_along" not in data
    assert data.mean_velocity.values[0] == pytest.approx(-data.mean_velocity.values[1])
