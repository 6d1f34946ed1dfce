"""Sweeps from Python: which points there are, how they are labelled, and what is refused."""

import json

import numpy as np
import pytest
import xarray

import stickslip
from stickslip import (
    Drive,
    Record,
    Scenario,
    ScenarioError,
    Waveform,
    simulate,
    sweep,
    sweep_dataframe,
)
from stickslip.sweeping.points import short_name
from stickslip.sweeping.results import EVENTS, NUMBERS

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=4))
FREQUENCIES = [200.0, 30.0, 100.0]
MODES = ["OPP", "IPP"]


def assert_point(point, run):
    """All that a sweep keeps of a point is what the run says, to the last bit."""
    summary = run.summary()
    for name in NUMBERS:
        np.testing.assert_equal(float(point[name]), summary[name], err_msg=name)
    assert dict(zip(EVENTS, point["events"].values.tolist(), strict=True)) == summary["events"]
    assert int(point["painleve_events"]) == summary["painleve_events"]
    assert int(point["status"]) == 0


def test_a_grid_has_the_order_and_labels_it_was_given():
    data = sweep(BASE, {"drive.frequency": FREQUENCIES, "drive.mode": MODES}, threads=2)
    assert data["mean_velocity"].dims == ("frequency", "mode")
    assert data["events"].dims == ("frequency", "mode", "event")
    assert data["frequency"].values.tolist() == FREQUENCIES
    assert data["mode"].values.tolist() == MODES
    assert data["frequency"].attrs["units"] == "Hz"
    assert all(variable.attrs["long_name"] for variable in data.variables.values())
    assert "message" not in data
    for frequency in FREQUENCIES:
        for mode in MODES:
            run = simulate(BASE.replace({"drive.frequency": frequency, "drive.mode": mode}))
            assert_point(data.sel(frequency=frequency, mode=mode), run)


def test_attributes_say_what_was_swept():
    data = sweep(BASE, {"drive.mode": MODES, "drive.pulses": np.array([4, 5])})
    assert json.loads(data.attrs["vary"]) == {"drive.mode": MODES, "drive.pulses": [4, 5]}
    assert data.attrs["scenario"] == BASE.to_toml()
    assert data.attrs["stickslip_version"] == stickslip.__version__
    assert (data.attrs["points"], data.attrs["finished_points"]) == (4, 4)
    assert data["pulses"].dtype == np.int64


def test_keys_of_one_word_are_told_apart():
    data = sweep(
        BASE, {"effects.surface_tilt.angle": [0.0, 0.01], "effects.misalignment.angle": [0.0]}
    )
    assert data["status"].dims == ("surface_tilt_angle", "misalignment_angle")


def test_no_key_is_called_like_another_or_like_a_result():
    taken = {*NUMBERS, "events", "painleve_events", "status", "message", "event", "point"}
    names = [short_name(key) for key in Scenario.keys()]  # noqa: SIM118
    assert len({*names, *taken}) == len(names) + len(taken)
    assert all(name.isidentifier() for name in names)


def test_a_list_of_changes_is_one_point_each():
    rows = [{"drive.mode": "OPP"}, {"drive.frequency": 30}, {}, {}]
    data = sweep(BASE, rows)
    assert data["status"].dims == ("point",)
    assert data["frequency"].values.tolist() == [100.0, 30.0, 100.0, 100.0]
    assert data["mode"].values.tolist() == ["OPP", "IPP", "IPP", "IPP"]
    for place, row in enumerate(rows):
        assert_point(data.isel(point=place), simulate(BASE.replace(row)))


def test_a_list_of_scenarios_is_labelled_by_what_differs():
    scenarios = [
        BASE,
        BASE.replace({"effects.surface_tilt.angle": 0.01, "record.rate": "events"}),
        BASE.replace({"contact.adhesion": 0.0}),
    ]
    data = sweep(scenarios)
    assert data["surface_tilt_angle"].values.tolist() == [0.0, 0.01, 0.0]
    assert set(data.coords) == {"surface_tilt_angle", "adhesion", "event"}
    for place, scenario in enumerate(scenarios):
        assert_point(data.isel(point=place), simulate(scenario.replace({"record.rate": "none"})))
    assert sweep([BASE])["status"].shape == (1,)


def test_voltages_are_part_of_a_sweep():
    program = Waveform.ipp(base=0.5e-3, pulses=4)
    played = Scenario(drive=Drive(mode="program", program=program))
    data = sweep(played, {"contact.adhesion": [0.1e-6, 0.2e-6]})
    assert "voltage_blocks" in data.attrs
    run = simulate(played.replace({"contact.adhesion": 0.2e-6}))
    assert_point(data.sel(adhesion=0.2e-6), run)
    mixed = sweep([BASE, played])
    assert mixed["mode"].values.tolist() == ["IPP", "program"]
    assert_point(mixed.isel(point=0), simulate(BASE))
    assert_point(mixed.isel(point=1), simulate(played))
    other = Scenario(drive=Drive(mode="program", program=2 * program))
    with pytest.raises(ScenarioError, match="one program"):
        sweep([played, other])


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
    for name in set(NUMBERS) - {"simulated_time"}:
        assert np.isnan(data[name][0, 0]), name
    assert 0.0 < float(data["simulated_time"][0, 0]) < 100.0

    data = sweep(BASE, {"contact.static_friction": [0.2, 0.1]})
    assert data["status"].values.tolist() == [0, -1]
    assert data["message"].values.tolist()[0] == ""
    assert "contact.static_friction = 0.1" in str(data["message"][1].item())
    assert json.loads(data.attrs["statuses"]) == {"refused": 1, "ok": 1}
    assert data.attrs["failed_points"] == 1
    assert np.isfinite(data["mean_velocity"].values).tolist() == [True, False]


def test_progress_ends_with_everything_done():
    told = []
    sweep(BASE, {"drive.frequency": [30.0, 100.0]}, progress=lambda *each: told.append(each))
    seen = [fraction for fraction, _ in told]
    assert seen == sorted(seen)
    assert (seen[0], seen[-1]) == (0.0, 1.0)
    assert {stage for _, stage in told} == {"simulating"}


@pytest.mark.parametrize("threads", [1, 2])
def test_what_progress_raises_stops_the_sweep(threads):
    def stop(fraction, stage):
        raise RuntimeError("enough")

    endless = BASE.replace({"solver.max_step": 1e-7, "drive.pulses": 5_000})
    with pytest.raises(RuntimeError, match="enough"):
        sweep(endless, {"drive.frequency": [30.0, 100.0]}, progress=stop, threads=threads)


REFUSED = {
    "no key": ({}, "needs a key"),
    "no list": ([], "the list is empty"),
    "nothing": (None, "vary = None"),
    "word": ("drive.frequency", 'vary = "drive.frequency"'),
    "unknown key": ({"drive.freqency": [1]}, 'did you mean "drive.frequency"'),
    "number as key": ({3: [1]}, "key 3"),
    "no value": ({"drive.frequency": []}, "drive.frequency: there is no value"),
    "one value": ({"drive.frequency": 30.0}, "drive.frequency = 30.0: allowed is a list"),
    "one word": ({"drive.mode": "IPP"}, 'drive.mode = "IPP": allowed is a list'),
    "array of none": ({"drive.frequency": np.array(3.0)}, "allowed is a list"),
    "table": ({"drive.frequency": np.ones((2, 2))}, "drive.frequency = "),
    "nan": ({"drive.frequency": [30.0, np.nan]}, "drive.frequency = nan"),
    "negative": ({"drive.frequency": [30.0, -1.0]}, "drive.frequency = -1.0"),
    "bool": ({"drive.frequency": [True]}, "drive.frequency = true"),
    "unknown word": ({"drive.mode": ["IPP", "ipp"]}, 'drive.mode = "ipp"'),
    "half a pulse": ({"drive.pulses": [1.5]}, "drive.pulses = 1.5"),
    "twice": ({"drive.frequency": [30, 30.0]}, "drive.frequency = 30.0: this value is given twice"),
    "record": ({"record.rate": [1e3]}, "record.rate: a sweep keeps summaries only"),
    "program": ({"drive.program": [None]}, "drive.program: a sweep varies numbers and words"),
    "rows of numbers": ([1.0], "vary, point 0 = 1.0"),
    "unknown key in a row": ([{"drive.freqency": 1}], "did you mean"),
    "wrong value in a row": ([{}, {"drive.pulses": 0}], "drive.pulses = 0"),
    "too many": (
        {"drive.frequency": np.linspace(1, 2, 10_000), "drive.peak": np.linspace(0, 1, 10_000)},
        "100000000 points",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name):
    vary, words = REFUSED[name]
    with pytest.raises(ScenarioError) as error:
        sweep(BASE, vary)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_lists_of_scenarios_that_are_refused():
    for scenarios, words in [([], "is empty"), ([BASE, 3], "scenario 1 = 3"), (3, "scenario = 3")]:
        with pytest.raises(ScenarioError, match=words):
            sweep(scenarios)
    with pytest.raises(ScenarioError, match="one scenario only"):
        sweep([BASE], {"drive.frequency": [30.0]})


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, "2"])
def test_threads_that_are_refused(threads):
    with pytest.raises(ValueError, match="threads = "):
        sweep(BASE, {"drive.frequency": [30.0]}, threads=threads)


HEADINGS = [0.0, 0.5, 1.5]


def test_a_sweep_of_headings_has_the_velocities_along_them():
    base = Scenario(drive=Drive(base=0.5e-3, pulses=4))
    vary = {"drive.direction": ["+x", "-x"], "drive.heading": HEADINGS}
    data = sweep(base, vary)
    for direction in ("+x", "-x"):
        for heading in HEADINGS:
            changes = {"drive.direction": direction, "drive.heading": heading}
            at = data.sel(direction=direction, drive_heading=heading)
            found = (at.velocity_along.item(), at.velocity_across.item())
            assert found == simulate(base.replace(changes)).velocity
    listed = sweep([base.replace({"drive.heading": heading}) for heading in HEADINGS])
    along = data.velocity_along.sel(direction="+x").values
    np.testing.assert_array_equal(listed.velocity_along.values, along)
    assert listed.velocity_along.attrs["units"] == "m/s"
    assert "velocity_along" in sweep_dataframe(listed)


def test_a_sweep_in_the_plane_has_no_velocity_along_headings():
    base = Scenario(drive=Drive(base=0.5e-3, pulses=4))
    data = sweep(base, {"drive.heading": [0.0, np.pi]})
    assert "velocity_along" not in data
    assert data.mean_velocity.values[0] == pytest.approx(-data.mean_velocity.values[1])
