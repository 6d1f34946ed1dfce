"""The recipes of examples/read_instruments.py, by what the product reads from their results."""

import math
import runpy

import numpy as np
import pytest

import instrument_files as given
from documentation_blocks import EXAMPLES
from stickslip import COIL_NAMES, Coil, Coils, FieldMap, Scenario, Waveform, read_measurement


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("instruments")
    given.write_all(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        runpy.run_path(str(EXAMPLES / "read_instruments.py"))
    return folder


def measured(folder, entry):
    Scenario(drive=given.DRIVE).to_toml(folder / "nominal.toml")
    (folder / "m.toml").write_text(
        f'stickslip_measurement = 1\nscenario = "nominal.toml"\n{entry}\n'
    )
    return read_measurement(folder / "m.toml")


# Three digits of some -10 V are 0.05 V; a bit of the other two is written in full.
@pytest.mark.parametrize(
    ("scope", "digit"), [("tektronix", 1e-12), ("rigol", 0.0501), ("picoscope", 1e-12)]
)
def test_voltages_of_an_oscilloscope_begin_at_zero_in_s_and_v(results, scope, digit):
    t, volts = Waveform.from_csv(results / f"{scope}_voltages.csv").points()
    samples = given.voltages()
    np.testing.assert_allclose(t, given.STEP * np.arange(len(samples)), rtol=0, atol=1e-11)
    expected = np.zeros((len(samples), 5))
    expected[:, [COIL_NAMES.index("xp"), COIL_NAMES.index("clamp")]] = samples
    np.testing.assert_allclose(volts, expected, rtol=0, atol=digit)
    assert np.ptp(samples, axis=0).min() > 5.0  # else any unit would pass


def test_velocities_with_decimal_commas_are_in_m_s(results):
    found = measured(results, '[[velocity]]\nfile = "velocity.csv"')
    assert found.left_out == ()
    (table,) = found.velocity
    np.testing.assert_allclose(table.velocity, [1e-3 * row[-1] for row in given.TRIALS], rtol=1e-15)
    conditions = [table.conditions[k] for k in table.condition]
    assert [each["drive.mode"] for each in conditions] == [row[0] for row in given.TRIALS]
    assert [each["drive.frequency"] for each in conditions] == [row[1] for row in given.TRIALS]


@pytest.mark.parametrize("solver", ["comsol", "maxwell"])
def test_a_field_of_a_solver_is_a_map_per_ampere(results, solver):
    fitted = FieldMap.from_file(results / f"{solver}_map.csv")
    # The fit itself leaves some 1e-5 of a coil's field; a wrong unit or coil, all of it.
    assert max(fitted.relative_residual) < 1e-4
    np.testing.assert_allclose([*fitted.low, *fitted.high], [*-given.HALF, *given.HALF])
    places, fields = given.fields()
    coils = Coils.of(Scenario(coil=Coil(map=fitted)))
    for name, one_ampere in zip(COIL_NAMES, np.eye(5), strict=True):
        largest = np.abs(fields[name]).max()
        for place, field in list(zip(places, fields[name], strict=True))[::40]:
            same = given.CURRENT * coils.field(place, one_ampere)
            np.testing.assert_allclose(same, field, rtol=0, atol=1e-3 * largest)


def test_the_longest_track_of_trackmate_is_one_row_with_the_robot_s_velocity(results):
    found = measured(results, '[[velocity]]\nfile = "tracked_velocity.csv"')
    assert [note.code for note in found.left_out] == ["columns-not-used"]  # its standard error
    (table,) = found.velocity
    start, end = found.scenario.window
    # Noise of 1 um a frame, three standard errors of the fit, and the settling after the start.
    error = 1e-6 * math.sqrt(12.0 / ((end - start) * given.FRAMES["trackmate"])) / (end - start)
    truth = given.run().mean_velocity
    assert table.velocity == pytest.approx([truth], abs=3.0 * error + 1e-3 * truth)
    (condition,) = table.conditions
    assert Scenario().replace(dict(condition)).drive == given.DRIVE


def test_frames_of_deeplabcut_are_a_film_without_those_that_failed(results):
    found = measured(results, '[[tracking]]\nfile = "film.csv"')
    assert found.left_out == ()
    (film,) = found.tracking
    t, x, theta = given.frames("deeplabcut")
    kept = np.arange(len(t)) % 50 != 49
    np.testing.assert_allclose(film.columns["t"], t[kept], rtol=0, atol=1e-12)
    # Two marks with 0.2 pixels each, 100 pixels apart; a largest deviation of 600 is below 4.5.
    off = film.columns["x"] - given.PIXEL * 100.0 - x[kept]
    assert np.abs(off).max() < 4.5 * 0.2 * given.PIXEL / math.sqrt(2.0)
    assert np.abs(film.columns["theta"] - theta[kept]).max() < 4.5 * 0.2 * math.sqrt(2.0) / 100.0
    assert theta.max() > 0.5  # nose-down is positive
