"""Runs that are read back from files, files that hold none, and the keys of a record."""

import pytest

from command_line import stickslip
from recorded_runs import COARSE, assert_same_record
from stickslip import (
    Drive,
    Record,
    Scenario,
    ScenarioError,
    Waveform,
    load,
    open_run,
    plot,
    simulate,
    sweep,
)


@pytest.mark.parametrize("name", ["run.nc", "run.csv"])
def test_a_run_that_is_read_back_is_drawn_and_goes_on(tmp_path, name):
    waveform = Waveform.ramp(0.02, {"clamp": -10.0}) + Waveform.hold(0.03, {"xp": 9.0}).repeat(3)
    scenario = Scenario(drive=Drive(mode="program", program=waveform), record=Record(rate=2000.0))
    run = simulate(scenario, until="time >= 0.05", out=tmp_path / name)
    again = open_run(tmp_path / name)
    assert again.scenario == scenario
    assert again.condition_met
    assert plot.run(again).axes
    going_on = [simulate(each.scenario.with_state(each.final_state)) for each in (run, again)]
    assert going_on[0].x.tobytes() == going_on[1].x.tobytes()
    again.save(tmp_path / f"again-{name}")
    assert_same_record(open_run(tmp_path / f"again-{name}"), run)


def refusal_of(path):
    with pytest.raises(ScenarioError) as refusal:
        open_run(path)
    assert "\n" not in str(refusal.value)
    assert str(refusal.value).startswith(f"{path}: ")
    return str(refusal.value)


def test_files_that_are_no_runs_are_refused_in_one_line(tmp_path):
    path = tmp_path / "run.nc"
    run = simulate(COARSE)
    run.save(path)
    opened = open_run(path)
    image = path.read_bytes()
    path.write_bytes(image[:3000] + b"!" + image[3001:])
    assert "checksum" in refusal_of(path)
    with pytest.raises(ScenarioError, match=r"run\.nc: has changed since this run was opened"):
        _ = opened.x
    path.unlink()
    with pytest.raises(ScenarioError, match=r"run\.nc: cannot be read: No such file"):
        _ = opened.x
    data = run.to_xarray()
    data.drop_vars("theta").to_netcdf(path, engine="h5netcdf")
    assert "it has no theta" in refusal_of(path)
    for attribute, value in (("scenario", "[drive"), ("complete", "maybe"), ("events", "{")):
        data.assign_attrs({attribute: value}).to_netcdf(path, engine="h5netcdf")
        refusal_of(path)
    del data.attrs["final_state"]
    data.to_netcdf(path, engine="h5netcdf")
    assert "is no run of this version" in refusal_of(path)
    assert "cannot be read: Is a directory" in refusal_of(tmp_path)


def test_csv_files_that_are_no_runs_are_refused_in_one_line(tmp_path):
    path, side = tmp_path / "run.csv", tmp_path / "run.csv.json"
    simulate(COARSE, out=path)
    lines = path.read_text().splitlines(keepends=True)
    opened = open_run(path)
    path.write_text("".join(lines[:-1]))
    assert "has 340 samples, but run.csv.json is of a record of 341" in refusal_of(path)
    with pytest.raises(ScenarioError, match="has changed since this run was opened"):
        _ = opened.x
    path.write_text("".join([lines[0].replace("x (m)", "x (mm)"), *lines[1:]]))
    assert "it has no x" in refusal_of(path)
    path.write_text("".join([*lines[:-1], lines[-1].replace("corner", "edge")]))
    with pytest.raises(ScenarioError, match="its columns of contact cannot be read"):
        _ = open_run(path).contact
    about = side.read_text()
    for text in ("", "[]", "{}", about.replace('"stickslip_run": 1', '"stickslip_run": 2')):
        side.write_text(text)
        assert "run.csv.json beside it is no file of a run" in refusal_of(path)
    side.unlink()
    assert "run.csv.json is missing beside it" in refusal_of(path)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("from", "-1", ["record.from = -1", "from 0 s"]),
        ("from", '"late"', ['record.from = "late"']),
        ("from", "2.0", ["record.from = 2", "from 0 to 1.05 s, the duration of the run"]),
        ("fields", '"x, thta"', ['record.fields = "x, thta"', 'did you mean "theta"?']),
        ("fields", '["x", 1]', ["record.fields = ['x', 1]", '"all"']),
        ("fields", "[]", ["record.fields = []"]),
        ("dtype", '"float16"', ['record.dtype = "float16"', '"float64", "float32"']),
        ("form", "1", ["record.form = 1: there is no such key", "record.from"]),
    ],
)
def test_bad_keys_of_a_record_are_refused_in_one_line(tmp_path, key, value, words):
    path = tmp_path / "scenario.toml"
    path.write_text(f"stickslip = 1\n[drive]\n[record]\nrate = 1e3\n{key} = {value}\n")
    done = stickslip("run", path, "--out", tmp_path / "run.nc")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    for word in words:
        assert word in done.stderr
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]


def test_the_fields_of_a_record_are_one_value_however_they_are_written(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text('stickslip = 1\n[drive]\n[record]\nfields = ["theta", "x", "x"]\nfrom = 1\n')
    for scenario in (
        load(path),
        Scenario(record=Record(fields=("x", "theta"), from_=1.0)),
        Scenario().replace({"record.fields": " x,theta ", "record.from": 1}),
    ):
        assert scenario.get("record.fields") == "x, theta"
        assert scenario.record == Record(fields="theta, x", from_=1.0)
        scenario.to_toml(path)
        assert load(path) == scenario
    with pytest.raises(ScenarioError, match=r"record\.from: a sweep keeps summaries only"):
        sweep(Scenario(), vary={"record.from": [0.0, 1.0]})
