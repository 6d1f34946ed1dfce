"""Files of a report of a measurement: which are written, and which are told as read."""

import hashlib

import pytest

from measured_maps import formula_fields, grid
from stickslip import Drive, FieldMap, Scenario, Waveform, read_measurement
from stickslip.cli import diagnose_command
from stickslip.diagnosis.report.html import EXTENDED, JSON, PAGE, report_files
from stickslip.diagnosis.report.provenance import origin
from stickslip.scenario.toml_file import scenario_writers, write_scenario

PLAIN = "stickslip = 1\n[drive]\npulses = 6\n"
MEASUREMENT = 'stickslip_measurement = 1\nscenario = "nominal.toml"\n'
UNCERTAIN = '[uncertain]\n"drag.linear" = { low = 3e-6, high = 3e-5 }\n'
VELOCITY = '[[velocity]]\nfile = "velocity.csv"\n'


@pytest.fixture(scope="module")
def field_map():
    places = grid(count=(3, 3, 3))
    return FieldMap.from_points(places, formula_fields(places))


@pytest.fixture
def path(tmp_path):
    (tmp_path / "nominal.toml").write_text(PLAIN)
    (tmp_path / "velocity.csv").write_text("frequency,velocity\n25,1e-3\n40,2e-3\n60,3e-3\n")
    (tmp_path / "m.toml").write_text(MEASUREMENT + UNCERTAIN + VELOCITY)
    return tmp_path / "m.toml"


def files_told(measurement):
    rows = dict(origin(measurement, 0))
    return {name.removeprefix("file "): rows[name] for name in rows if name.startswith("file ")}


def test_files_that_the_scenario_names_are_told_with_their_checksums(path):
    measurement = read_measurement(path)
    assert list(files_told(measurement)) == ["m.toml", "nominal.toml", "velocity.csv"]
    folder = path.parent / "set-up"
    folder.mkdir()
    text = MEASUREMENT.replace("nominal.toml", "set-up/nominal.toml")
    path.write_text(text + UNCERTAIN + VELOCITY)
    named = '[drive]\nfile = "volts.csv"\n[coil]\nmap = "coils.csv"\n'
    (folder / "nominal.toml").write_text(f"stickslip = 1\n{named}")
    for name in ("volts.csv", "coils.csv"):
        (folder / name).write_text(name)
    told = files_told(measurement)
    assert set(told) == {"m.toml", "nominal.toml", "velocity.csv", "volts.csv", "coils.csv"}
    for name in ("volts.csv", "coils.csv"):
        assert told[name] == f"SHA-256 {hashlib.sha256(name.encode()).hexdigest()}"


@pytest.mark.parametrize("change", ["velocity = 3", "velocity = true", "[velocity]\nfile = 3", "["])
def test_a_measurement_file_that_was_changed_meanwhile_is_told_without_what_it_named(path, change):
    measurement = read_measurement(path)
    path.write_text(f"{MEASUREMENT}{change}\n")
    assert {"m.toml", "velocity.csv"} & set(files_told(measurement)) == {"m.toml"}


@pytest.mark.parametrize("change", ["stickslip = 1\ncoil = 3\n", "[", None])
def test_a_scenario_that_was_changed_meanwhile_is_told_without_what_it_named(path, change):
    measurement = read_measurement(path)
    if change is None:
        (path.parent / "nominal.toml").unlink()
    else:
        (path.parent / "nominal.toml").write_text(change)
    assert list(files_told(measurement)) == ["m.toml", "nominal.toml", "velocity.csv"]


@pytest.mark.parametrize("has_map", [False, True])
@pytest.mark.parametrize("has_program", [False, True])
def test_the_files_of_a_report_are_those_that_are_written(
    tmp_path, field_map, has_map, has_program
):
    program = Waveform.ramp(0.1, {"xp": 0.0}, {"xp": 10.0})
    scenario = Scenario(drive=Drive(mode="program", program=program) if has_program else Drive())
    if has_map:
        scenario = scenario.replace({"coil.map": field_map})
    written = scenario_writers(scenario, tmp_path / EXTENDED)[1]
    assert {*report_files(scenario)} == {PAGE, JSON, *(each.name for each in written)}


@pytest.mark.parametrize("has_map", [False, True])
def test_the_command_names_all_files_that_it_has_written(path, field_map, monkeypatch, has_map):
    if has_map:
        drive = Drive(pulses=6)
        scenario = Scenario(drive=drive).replace({"coil.map": field_map})
        write_scenario(scenario, path.parent / "nominal.toml")
    said = []
    monkeypatch.setattr(diagnose_command, "_diagnosed", lambda *_: None)
    monkeypatch.setattr(diagnose_command, "_tell", lambda *_: None)
    monkeypatch.setattr(diagnose_command, "say", said.append)
    out = path.parent / "found"
    diagnose_command.command.callback(
        path, out, as_json=False, seed=0, free_shapes=False, threads=1
    )
    names = "report.html, report.json, extended.toml" + has_map * ", extended.map.json"
    assert said == [f"  in {out}: {names}"]
