"""Display of objects in notebooks, and tables of runs and sweeps: small, escaped, with units."""

import pickle
import re
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from recorded_runs import flat_columns
from stickslip import (
    Accelerations,
    Cause,
    Drive,
    FieldMap,
    Forces,
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
from stickslip.scenario.held import OBJECTS
from toys import SLOPE, WAVE, data

BOX = Path(__file__).with_name("frozen") / "box.json"
BAD = "<script>alert('1')</script>&\x1b[31m"
TEXT = re.compile(r"<(script|img|iframe|object|embed|link)\b|\son\w+=|javascript:", re.IGNORECASE)


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


def test_a_scenario_shows_every_object_that_it_holds():
    """Those that a section takes beside its keys, whichever they are, and the fluid."""
    objects = {
        "drive.program": Waveform.hold(0.1, {"xp": 5.0}),
        "coil.map": FieldMap.from_file(BOX),
        "shake.accelerations": Accelerations([(0.0, 1.0, 0.0), (0.01, -1.0, 0.0)]),
        "inner.forces": Forces([(0.0, 1e-6), (0.01, -1e-6)]),
    }
    assert OBJECTS.keys() == objects.keys()
    beside_it = {"drive.program": {"drive.mode": "program"}, "inner.forces": {"inner.mass": 1e-9}}
    wet = Scenario().in_fluid("water")
    for key, value in objects.items():
        made = wet.replace({**beside_it.get(key, {}), key: value})
        for scenario in (made, pickle.loads(pickle.dumps(made))):
            shown = rows(scenario._repr_html_())
            assert shown[key] == escape(str(value))
            assert shown["fluid"] == escape(str(wet.fluid))
        assert key not in rows(made.replace({key: None, "drive.mode": "IPP"})._repr_html_())


def test_a_run_that_failed_or_has_no_record_says_so():
    slide = {"effects.surface_tilt.angle": 1.4, "drag.linear": 0.0, "drive.pulses": 100}
    run = simulate(Scenario().replace(slide))
    shown = run._repr_html_()
    assert "<p>left_workspace, nan mm/s, no record</p>" in shown
    assert f"<p>{escape(run.message)}</p>" in shown
    assert "mean_velocity" not in shown


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


def test_a_figure_is_shown_once_with_and_without_pyplot(walk_ipp, swept):
    before = plt.get_fignums()
    drawn = (
        plot.run(walk_ipp),
        plot.path(walk_ipp),
        plot.filmstrip(walk_ipp, [0.06]),
        plot.velocity(swept),
    )
    for figure in drawn:
        assert figure._repr_png_().startswith(b"\x89PNG")
    # What pyplot does not have it does not show at the end of a cell.
    assert plt.get_fignums() == before


def test_a_table_of_a_run_has_a_row_a_sample_with_units(walk_ipp, tmp_path):
    run = walk_ipp
    run.save(tmp_path / "run.nc")
    for each in (run, open_run(tmp_path / "run.nc")):
        table = each.to_dataframe()
        assert len(table) == run.t.size
        columns = list(flat_columns(run))
        assert list(table.columns) == [name for name, _, _ in columns]
        assert table.attrs["units"] == {name: unit for name, unit, _ in columns}
        for name, _, values in columns:
            np.testing.assert_array_equal(table[name], values)


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
