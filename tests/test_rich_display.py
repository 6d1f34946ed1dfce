"""What notebooks show of objects, and tables of runs and sweeps: small, escaped, with units."""

import re

import matplotlib.pyplot as plt
import numpy as np
import pytest

from stickslip import (
    COIL_NAMES,
    Cause,
    Drive,
    Record,
    Scenario,
    Waveform,
    diagnose_model,
    open_run,
    plot,
    simulate,
    sweep,
    sweep_dataframe,
)
from stickslip._util.html import html_table
from stickslip.simulation.columns import COLUMNS, PLANE_COLUMNS
from toys import SLOPE, WAVE, data

BAD = "<script>alert('1')</script>&\x1b[31m"
TEXT = re.compile(r"<(script|img|iframe|object|embed|link)\b|\son\w+=|javascript:", re.IGNORECASE)


@pytest.fixture(scope="module")
def run():
    return simulate(Scenario(drive=Drive(base=0.5e-3, pulses=4), record=Record(rate=5e3)))


@pytest.fixture(scope="module")
def swept():
    keys = {"contact.static_friction": [0.1, 0.2, 0.3], "drive.mode": ["IPP", "OPP"]}
    return sweep(Scenario(drive=Drive(base=0.5e-3, pulses=4)), keys)


def rows(html):
    found = re.findall(r"<tr><th[^>]*>(.*?)</th><td[^>]*>(.*?)</td></tr>", html)
    return dict(found)


def test_texts_are_escaped():
    shown = html_table(BAD, [(BAD, BAD)])
    assert not TEXT.search(shown)
    assert shown.count("&lt;script&gt;") == 3
    assert "\x1b" not in shown


def test_a_scenario_shows_its_drive_and_what_is_changed():
    scenario = Scenario(
        drive=Drive(peak=2e-3, pulses=7),
        effects={"surface_tilt": {"angle": 0.5}},
        uncertain={"contact.adhesion": {"mean": 0.2e-6, "sd": 0.03e-6}},
    )
    shown = rows(scenario._repr_html_())
    assert shown["drive.peak"] == "2 mT"
    assert shown["drive.pulses"] == "7"
    assert shown["effects.surface_tilt.angle"] == "28.6479 degrees"
    assert "contact.adhesion" in shown["uncertain"]
    assert "contact.kinetic_friction" not in shown
    assert "robot.length" not in shown


def test_a_scenario_of_a_program_shows_the_program():
    drive = Drive(mode="program", program=Waveform.hold(0.1, {"xp": 5.0}))
    shown = rows(Scenario(drive=drive)._repr_html_())
    assert "&lt;Waveform: 0.1 s" in shown["drive.program"]
    assert "drive.peak" not in shown


def test_a_run_shows_its_summary(run):
    shown = rows(run._repr_html_())
    assert shown["status"] == "ok"
    assert shown["mean velocity"] == f"{run.mean_velocity * 1e3:.4g} mm/s"
    assert shown["record"] == f"{run.t.size} samples, to {run.t[-1]:.6g} s"
    assert "stick" in shown["events"]


def test_a_run_that_failed_or_has_no_record_says_so():
    slide = {"effects.surface_tilt.angle": 1.4, "drag.linear": 0.0, "drive.pulses": 100}
    shown = rows(simulate(Scenario().replace(slide))._repr_html_())
    assert shown["status"].startswith("left_workspace: ")
    assert "mean velocity" not in shown
    assert "record" not in shown


def test_a_diagnosis_is_shown_escaped():
    named = Cause(f"wave {BAD}", WAVE.parameters)

    def predict(table, p):
        return p["slope"] * table["x"] + p["wave.height"] * np.sin(5.0 * table["x"])

    wave = 0.8 * np.sin(5.0 * np.linspace(1.0, 3.0, 30))
    result = diagnose_model(predict, data(wave), [SLOPE], [named])
    assert result.verdict.causes == (named.name,)
    shown = result._repr_html_()
    assert "wave" in shown
    assert shown.count("<table>") == 4
    assert not TEXT.search(shown)


def test_a_sweep_is_shown_escaped(swept):
    assert (swept["message"].values != "").any()
    changed = swept.assign(message=(swept["message"].dims, np.full((3, 2), BAD)))
    # Its own display, which xarray makes: it has a style, and no script.
    shown = changed._repr_html_()
    assert "&lt;script&gt;" in shown
    assert not TEXT.search(re.sub(r"<style>.*?</style>", "", shown, flags=re.DOTALL))


def test_a_figure_is_shown_once_with_and_without_pyplot(run, swept):
    before = plt.get_fignums()
    drawn = (plot.run(run), plot.path(run), plot.filmstrip(run, [0.06]), plot.velocity(swept))
    for figure in drawn:
        assert figure._repr_png_().startswith(b"\x89PNG")
    # What pyplot does not have it does not show at the end of a cell.
    assert plt.get_fignums() == before


def test_a_table_of_a_run_has_a_row_a_sample_with_units(run, tmp_path):
    run.save(tmp_path / "run.nc")
    for each in (run, open_run(tmp_path / "run.nc")):
        table = each.to_dataframe()
        assert len(table) == run.t.size
        units = table.attrs["units"]
        assert list(units) == list(table.columns)
        for name, column in COLUMNS.items():
            if name in PLANE_COLUMNS:
                assert name not in table
            elif name == "current":
                for k, coil in enumerate(COIL_NAMES):
                    np.testing.assert_array_equal(table[f"current_{coil}"], run.current[:, k])
                    assert units[f"current_{coil}"] == "A"
            elif name == "contact":
                assert table["contact"].tolist() == [run.contact_names[k] for k in run.contact]
                assert units["contact"] == ""
            elif name != "event":
                np.testing.assert_array_equal(table[name], getattr(run, name))
                assert units[name] == column.unit


def test_a_table_of_events_names_them(run):
    events = simulate(run.scenario.replace({"record.rate": "events"}))
    table = events.to_dataframe()
    assert table["event"].tolist() == [events.event_names[k] for k in events.event]


def test_a_table_of_a_run_without_a_record_is_refused(run):
    silent = simulate(run.scenario.replace({"record.rate": "none"}))
    assert silent.samples == 0
    with pytest.raises(AttributeError, match=r"set record\.rate"):
        silent.to_dataframe()


def test_a_table_of_a_sweep_has_a_row_a_point_with_units(swept, tmp_path):
    table = sweep_dataframe(swept)
    assert len(table) == swept["status"].size
    assert list(table.attrs["units"]) == list(table.columns)
    assert table.attrs["units"]["theta_max"] == "rad"
    assert table.attrs["units"]["drive_mode"] == ""
    for _, row in table.iterrows():
        point = swept.sel(
            contact_static_friction=row["contact_static_friction"], drive_mode=row["drive_mode"]
        )
        assert row["status"] == ("refused" if row["contact_static_friction"] == 0.1 else "ok")
        np.testing.assert_array_equal(row["mean_velocity"], point["mean_velocity"].item())
        assert row["events_stick"] == point["events"].sel(event="stick").item()
        assert row["message"] == point["message"].item()
    part = sweep_dataframe(swept.sel(drive_mode="OPP"))
    assert part["drive_mode"].tolist() == ["OPP"] * 3


def test_a_table_of_a_list_of_points_has_their_order():
    points = [{"drive.frequency": f} for f in (60.0, 30.0)]
    table = sweep_dataframe(sweep(Scenario(drive=Drive(base=0.5e-3, pulses=4)), points))
    assert table["drive_frequency"].tolist() == [60.0, 30.0]
    assert "point" not in table


def test_a_run_at_a_heading_shows_its_velocity_along_it_and_where_it_ends():
    made = simulate(Scenario(drive=Drive(base=0.5e-3, pulses=4, heading=1.5)))
    shown = rows(made._repr_html_())
    assert shown["mean velocity along the heading"] == f"{made.velocity[0] * 1e3:.4g} mm/s"
    assert "mean velocity" not in shown
    assert f"y {made.final_state.y * 1e6:.4g} µm" in shown["final place"]
