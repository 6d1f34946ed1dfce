"""Predictions with error bars: their quantiles, what failed, tables, files and pictures."""

import math

import numpy as np
import pytest
import xarray
from scipy.stats import norm

from stickslip import (
    Drive,
    JointPrior,
    Scenario,
    plot,
    predict,
    simulate,
    simulate_batch,
    sweep_dataframe,
)
from stickslip.sweeping.predict import quantiles_with_errors

PRIORS = {
    "contact.kinetic_friction": {"mean": 0.145, "sd": 0.01},
    "contact.adhesion": {"median": 0.22e-6, "factor": 1.2},
}
BASE = Scenario(drive=Drive(base=0.5e-3, pulses=4), uncertain=PRIORS)
GRID = {"drive.frequency": [30.0, 60.0], "drive.mode": ["OPP", "IPP"]}


@pytest.fixture(scope="module")
def found():
    return predict(BASE, GRID, draws=24)


def voltages(uncertain, draws, levels):
    """Quantiles of the largest voltage over that of the scenario's own resistance of 10 ohm.

    The drive states fields, so its voltages are proportional to the resistance.
    """
    given = BASE.replace({"coil.resistance": 10.0, "drive.pulses": 4})
    data = predict(given, draws=draws, quantiles=levels, uncertain=uncertain)
    return data["voltage_max"].values / simulate(given).summary()["voltage_max"]


@pytest.mark.parametrize(
    "uncertain",
    [
        {"coil.resistance": {"mean": 10.0, "sd": 0.5}},
        JointPrior({}, ("coil.resistance", "drag.linear"), ((0.25, 2.5e-7), (2.5e-7, 1e-12))),
    ],
    ids=["prior", "covariance"],
)
def test_quantiles_with_errors_are_those_of_the_law_where_a_figure_is_linear(uncertain):
    draws, levels = 600, (0.1, 0.25, 0.5, 0.9)
    expected = norm.ppf(levels, 1.0, 0.05)
    # The standard error of a sample's quantile is sqrt(q (1 - q) / n) over the density there; five
    # of them are exceeded once in 2e6 seeds.
    density = norm.pdf(expected, 1.0, 0.05)
    error = np.sqrt(np.array(levels) * (1.0 - np.array(levels)) / draws) / density
    assert (np.abs(voltages(uncertain, draws, levels) - expected) < 5.0 * error).all()


def test_quantiles_with_errors_are_those_of_single_runs_of_the_draws(found):
    for frequency in GRID["drive.frequency"]:
        drive = {"drive.frequency": frequency, "drive.mode": "IPP"}
        runs = simulate_batch([each.replace(drive) for each in BASE.draws(24)])
        for name in ("mean_velocity", "theta_max", "power_mean"):
            values = [run.summary()[name] for run in runs]
            here = found[name].sel(drive_frequency=frequency, drive_mode="IPP")
            np.testing.assert_allclose(here, np.quantile(values, [0.1, 0.5, 0.9]), rtol=1e-12)


def test_the_error_of_a_quantile_is_that_of_its_share_of_the_draws():
    # That of a share q is sqrt(q (1 - q) / n), divided by the density. Quantiles of 60 samples
    # scatter by it to within 1 / sqrt(2 * 60). The error of one sample is made of at least 24
    # spacings between draws, so the mean of 60 is right to 3 %; curvature of the law adds 5 %.
    rows = np.random.default_rng(0).standard_normal((60, 400))
    level, error = quantiles_with_errors(rows, [0.1, 0.5])
    for place, q in enumerate((0.1, 0.5)):
        expected = math.sqrt(q * (1.0 - q) / 400) / norm.pdf(norm.ppf(q))
        assert np.mean(error[:, place]) == pytest.approx(expected, rel=0.1)
        assert np.std(level[:, place]) == pytest.approx(expected, rel=4.0 / math.sqrt(120.0))
    data = predict(BASE, draws=100, quantiles=[0.4, 0.5, 0.6])
    width = (data["mean_velocity"][2] - data["mean_velocity"][0]).item()
    assert data["mean_velocity_error"][1].item() == pytest.approx(0.25 * width, rel=1e-9)


def test_a_quantile_has_no_error_where_the_draws_are_too_few_to_know_it():
    # sqrt(q (1 - q) / n) is 0.05 for q = 0.1 and 36 draws, and that of 0.9 as well; for 0.5 it is
    # a quarter of 1 with four draws.
    rows = np.random.default_rng(0).standard_normal((6, 37))
    for row, count in zip(rows, (0, 1, 3, 5, 35, 37), strict=True):
        row[count:] = np.nan
    level, error = quantiles_with_errors(rows, [0.1, 0.5, 0.9])
    assert (np.isfinite(level) == [[count > 0] * 3 for count in (0, 1, 3, 5, 35, 37)]).all()
    few, half, many = [False] * 3, [False, True, False], [True] * 3
    assert np.isfinite(error).tolist() == [few, few, few, half, half, many]
    assert (error[-1] > 0.0).all()


def test_any_number_of_threads_gives_the_same_bits(found):
    for threads in (1, 3):
        again = predict(BASE, GRID, draws=24, threads=threads)
        xarray.testing.assert_identical(again, found)
    other = predict(BASE, GRID, draws=24, seed=1)
    assert not np.array_equal(other["mean_velocity"], found["mean_velocity"])


def test_what_is_uncertain_can_be_given_beside_the_scenario(found):
    known = BASE.with_uncertain(None)
    for uncertain in (PRIORS, BASE.uncertain, BASE):
        again = predict(known, GRID, draws=24, uncertain=uncertain)
        xarray.testing.assert_identical(again, found)


def test_a_list_of_points_and_a_single_point_are_those_of_the_grid(found):
    rows = [{"drive.frequency": 60.0, "drive.mode": "IPP"}, {"drive.mode": "OPP"}]
    listed = predict(BASE.replace({"drive.frequency": 30.0}), rows, draws=24)
    assert listed["mean_velocity"].dims == ("point", "quantile")
    single = predict(BASE.replace(rows[0]), draws=24)
    assert single["mean_velocity"].dims == ("quantile",)
    grid = found["mean_velocity"]
    for here, there in (
        (listed["mean_velocity"][0], grid.sel(drive_frequency=60.0, drive_mode="IPP")),
        (listed["mean_velocity"][1], grid.sel(drive_frequency=30.0, drive_mode="OPP")),
        (single["mean_velocity"], grid.sel(drive_frequency=60.0, drive_mode="IPP")),
    ):
        np.testing.assert_array_equal(here, there)


def test_draws_that_fail_are_counted_and_in_no_quantile():
    frictions = [each.contact.kinetic_friction for each in BASE.draws(24)]
    # A kinetic friction above the static one makes no scenario: of some draws, of all, of none.
    limit = float(np.median(frictions))
    statics = [limit, 0.01, 0.5]
    result = predict(BASE, {"contact.static_friction": statics}, draws=24)
    sound = [each for each in BASE.draws(24) if each.contact.kinetic_friction <= limit]
    assert result["failed"].values.tolist() == [24 - len(sound), 24, 0]
    assert result.attrs["failed_draws"] == 48 - len(sound)
    runs = simulate_batch([each.replace({"contact.static_friction": limit}) for each in sound])
    expected = np.quantile([run.mean_velocity for run in runs], [0.1, 0.5, 0.9])
    np.testing.assert_allclose(result["mean_velocity"][0], expected, rtol=1e-12)
    assert np.isnan(result["mean_velocity"][1]).all()
    assert "contact.static_friction" in result.attrs["message"]


def test_draws_that_were_drawn_again_are_counted():
    # Half of the values of a friction about the static one lie above it.
    uncertain = {"contact.kinetic_friction": {"mean": 0.2, "sd": 0.01}}
    given = BASE.with_uncertain(uncertain).replace({"contact.static_friction": 0.2})
    result = predict(given, draws=200)
    assert result.attrs["failed_draws"] == 0
    # As many failures as successes, with the variance of a negative binomial law, n (1 - p) / p^2.
    assert abs(result.attrs["redrawn"] - 200) < 5.0 * math.sqrt(200 * 0.5 / 0.25)
    assert predict(BASE, draws=24).attrs["redrawn"] == 0


def test_the_table_has_a_row_a_point(found):
    table = sweep_dataframe(found)
    assert table["drive_frequency"].tolist() == [30.0, 30.0, 60.0, 60.0]
    assert table["drive_mode"].tolist() == ["OPP", "IPP"] * 2
    for name in ("mean_velocity", "mean_velocity_error"):
        np.testing.assert_array_equal(
            table[[f"{name}_q10", f"{name}_q50", f"{name}_q90"]],
            found[name].values.reshape(4, 3),
        )
        assert table.attrs["units"][f"{name}_q10"] == "m/s"
    assert (table["failed"] == 0).all()


def test_bands_are_drawn_about_the_medians(found):
    (axes,) = plot.velocity(found).axes
    for line, band, mode in zip(axes.get_lines(), axes.collections, ["OPP", "IPP"], strict=True):
        here = found["mean_velocity"].sel(drive_mode=mode) * 1e3
        np.testing.assert_allclose(line.get_ydata(), here.sel(quantile=0.5))
        # The outline goes along the lower quantile and back along the upper one.
        corners = band.get_paths()[0].vertices
        for frequency in GRID["drive.frequency"]:
            edges = [float(y) for x, y in corners if x == frequency]
            ends = here.sel(drive_frequency=frequency, quantile=[0.1, 0.9]).values.tolist()
            assert [min(edges), max(edges)] == pytest.approx(ends)
    rows = [{"drive.frequency": f} for f in (60.0, 30.0)]
    nested = predict(BASE, rows, 24, quantiles=[0.05, 0.25, 0.5, 0.75, 0.95])
    (axes,) = plot.velocity(nested).axes
    assert len(axes.collections) == 2
    assert axes.get_lines()[0].get_xdata().tolist() == [30.0, 60.0]


def test_bands_that_cannot_be_drawn_are_refused(found):
    lopsided = predict(BASE, {"drive.frequency": [30.0, 60.0]}, 4, quantiles=[0.1, 0.5])
    with pytest.raises(ValueError, match=r"pairs about it.*\.sel"):
        plot.velocity(lopsided)
    assert plot.velocity(lopsided.sel(quantile=0.1)).axes
    two = predict(BASE, {"drive.frequency": [30.0, 60.0], "drive.hold": [1e-3, 2e-3]}, 4)
    with pytest.raises(ValueError, match="without bands"):
        plot.velocity(two)
    assert plot.velocity(two.sel(quantile=0.5)).axes


def test_an_empty_mapping_varies_nothing():
    assert predict(BASE, {}, draws=2).identical(predict(BASE, draws=2))


def test_the_velocity_along_headings_has_quantiles_with_errors():
    base = Scenario(
        drive=Drive(base=0.5e-3, pulses=4),
        uncertain={"contact.kinetic_friction": {"mean": 0.145, "sd": 0.01}},
    )
    data = predict(base, {"drive.heading": [0.0, 1.5]}, draws=4, quantiles=[0.5])
    draws = [each.replace({"drive.heading": 1.5}) for each in base.draws(4)]
    expected = np.median([simulate(each).velocity[0] for each in draws])
    assert data.velocity_along.values[1, 0] == pytest.approx(expected, rel=1e-12)
