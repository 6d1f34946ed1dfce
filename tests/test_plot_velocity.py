"""Pictures of sweeps."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from pictures import assert_legible
from stickslip import Drive, Scenario, plot, simulate, sweep

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=5))
FREQUENCIES = [20.0, 50.0, 100.0]


@pytest.fixture(scope="module")
def by_mode():
    return sweep(BASE, {"drive.frequency": FREQUENCIES, "drive.mode": ["IPP", "OPP"]})


@pytest.fixture(scope="module")
def by_two():
    friction = {"contact.static_friction": [0.15, 0.2, 0.3]}
    return sweep(BASE, {"drive.frequency": FREQUENCIES, **friction})


def test_a_line_a_mode(by_mode):
    figure = plot.velocity(by_mode)
    (axes,) = figure.axes
    for line, mode in zip(axes.get_lines(), ["IPP", "OPP"], strict=True):
        np.testing.assert_allclose(line.get_xdata(), FREQUENCIES)
        expected = by_mode.mean_velocity.sel(drive_mode=mode).values * 1e3
        np.testing.assert_allclose(line.get_ydata(), expected)
        assert line.get_label() == mode
    first, second = axes.get_lines()
    assert to_hex(first.get_color()) != to_hex(second.get_color())
    assert first.get_linestyle() != second.get_linestyle()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("frequency (Hz)", "mean velocity (mm/s)")
    assert_legible(figure, least=10)


def test_a_heat_map_over_two_keys(by_two):
    figure = plot.velocity(by_two)
    axes, bar = figure.axes
    (mesh,) = axes.collections
    np.testing.assert_allclose(mesh.get_array(), by_two.mean_velocity.values.T * 1e3)
    edges = mesh.get_coordinates()
    np.testing.assert_allclose(edges[0, :, 0], [5.0, 35.0, 75.0, 125.0])
    np.testing.assert_allclose(edges[:, 0, 1], [0.125, 0.175, 0.25, 0.35])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("frequency (Hz)", "static friction")
    assert bar.get_ylabel() == "mean velocity (mm/s)"
    assert_legible(figure, least=10)


def test_a_list_of_points_is_drawn_in_order():
    points = [
        {"drive.frequency": f, "drive.mode": m} for f in (100.0, 20.0, 50.0) for m in ("IPP", "OPP")
    ]
    (axes,) = plot.velocity(sweep(BASE, points)).axes
    for line in axes.get_lines():
        assert line.get_xdata().tolist() == [20.0, 50.0, 100.0]
    assert axes.get_xlabel() == "frequency (Hz)"

    single = sweep(BASE, [{"contact.adhesion": a} for a in (0.3e-6, 0.1e-6)])
    (axes,) = plot.velocity(single).axes
    np.testing.assert_allclose(axes.get_lines()[0].get_xdata(), [0.1, 0.3])
    assert axes.get_xlabel() == "adhesion (µN)"


def test_wide_ranges_are_logarithmic():
    data = sweep(BASE, {"drag.linear": [1e-7, 1e-6, 1e-5]})
    (axes,) = plot.velocity(data).axes
    assert axes.get_xscale() == "log"
    both = sweep(BASE, {"drag.linear": [1e-7, 1e-6, 1e-5], "drag.rotational": [1e-17, 1e-14]})
    figure = plot.velocity(both)
    axes = figure.axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    np.testing.assert_allclose(
        axes.collections[0].get_coordinates()[0, :, 0], 1e-7 * 10 ** np.array([-0.5, 0.5, 1.5, 2.5])
    )
    assert_legible(figure)


def test_failed_points_are_gaps(by_mode):
    broken = by_mode.copy(deep=True)
    broken.mean_velocity[1, 0] = np.nan
    (axes,) = plot.velocity(broken).axes
    assert np.isnan(axes.get_lines()[0].get_ydata()).tolist() == [False, True, False]


def test_the_legend_of_a_map_says_which_cells_have_no_velocity_and_why():
    # On steep slopes the robot slides away, unless drag holds it; kinetic friction of 0.145 is
    # above the least static one.
    steep = {"effects.surface_tilt.angle": [0.0, 0.8, 1.4], "drag.linear": [0.0, 1e-7, 1e-5]}
    refused = {"effects.surface_tilt.angle": [0.0, 0.01], "contact.static_friction": [0.1, 0.2]}
    for keys, words in (
        (steep, "no velocity: 4 left workspace"),
        (refused, "no velocity: 2 refused"),
    ):
        figure = plot.velocity(sweep(BASE.replace({"drive.pulses": 100}), keys))
        axes = figure.axes[0]
        assert [each.get_text() for each in axes.get_legend().get_texts()] == [words]
        (patch,) = axes.get_legend().get_patches()
        assert to_hex(patch.get_facecolor()) == to_hex(axes.get_facecolor())
        assert_legible(figure)


def test_a_map_without_gaps_has_no_legend(by_two):
    assert plot.velocity(by_two).axes[0].get_legend() is None


def test_given_axes_are_drawn_in(by_mode):
    figure = Figure()
    ax = figure.subplots()
    assert plot.velocity(by_mode, ax=ax) is figure
    assert len(ax.get_lines()) == 2


def test_what_cannot_be_drawn_is_refused(by_mode, by_two):
    with pytest.raises(ValueError, match="not one of a sweep"):
        plot.velocity(by_mode.drop_vars("mean_velocity"))
    with pytest.raises(ValueError, match=r"<Run: ok.*allowed is what sweep or predict gave"):
        plot.velocity(simulate(BASE))
    with pytest.raises(ValueError, match="no point"):
        plot.velocity(by_mode.assign(mean_velocity=by_mode.mean_velocity * np.nan))
    with pytest.raises(ValueError, match=r"varies drive_mode: .* \.sel"):
        plot.velocity(by_mode.sel(drive_frequency=20.0))
    with pytest.raises(ValueError, match="varies nothing"):
        plot.velocity(by_mode.sel(drive_frequency=20.0, drive_mode="IPP"))
    with pytest.raises(ValueError, match="9 lines: allowed are at most 8"):
        plot.velocity(by_mode.isel(drive_mode=[0] * 9).assign_coords(drive_mode=list("abcdefghi")))
    twice = sweep(BASE, [{"drive.frequency": f} for f in (20.0, 50.0)]).isel(point=[0, 0, 1])
    with pytest.raises(ValueError, match="twice"):
        plot.velocity(twice)


def test_of_headings_the_velocity_along_them_is_drawn():
    data = sweep(BASE, {"drive.heading": [0.0, 0.5, 1.5]})
    (axes,) = plot.velocity(data).axes
    (line,) = axes.get_lines()
    np.testing.assert_allclose(line.get_ydata(), data.velocity_along.values * 1e3)
    assert axes.get_ylabel() == "mean velocity along the heading (mm/s)"
