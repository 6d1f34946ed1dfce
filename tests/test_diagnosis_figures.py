"""Figures of the diagnosis: which readings are hollow, what the legend says, what is a curve."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.markers import MarkerStyle

from pictures import assert_legible
from stickslip.diagnosis.report import figures
from stickslip.diagnosis.report.chart import MARKERS, marker
from stickslip.diagnosis.report.velocity_difference import velocity_figure
from toy_model import X, shared_result

HELD = "held out for the gain"


def hollow(frame):
    """Abscissae of hollow points, a list for each marker."""
    lines = {each.lines[0] for each in frame.containers}
    return [line.get_xdata().tolist() for line in lines if line.get_markerfacecolor() == "w"]


def said(frame):
    return [text.get_text() for text in frame.get_legend().get_texts()]


def against(held_out, **more):
    m = len(held_out)
    rows = np.zeros((m, len(more.get("names", ("",)))))
    held_out = np.array(held_out)
    models = {"recalibrated": rows, "extended": rows}
    return figures.against_model(
        np.arange(m), rows, rows + 1.0, models, held_out, ("place", "value"), **more
    )


def test_held_out_readings_have_hollow_markers():
    frame = against([True, False, False, True]).axes[0]
    assert hollow(frame) == [[0, 3]]
    assert said(frame).count(HELD) == 1


def test_held_out_field_readings_have_hollow_markers_and_one_legend_entry():
    frame = against([False, True, False], names=("Bx", "By", "Bz"), joined=False).axes[0]
    assert hollow(frame) == [[1]] * 3
    assert sorted(said(frame)) == sorted(
        [f"measured {name} (2 sd)" for name in ("Bx", "By", "Bz")]
        + ["recalibrated", "extended", HELD]
    )


def test_without_held_out_readings_no_marker_is_hollow():
    frame = against([False] * 3).axes[0]
    assert hollow(frame) == []
    assert HELD not in said(frame)


def test_held_out_conditions_of_a_users_own_model_have_hollow_markers():
    given = shared_result(3, wave=1.0)
    (points,) = hollow(given.plot.fit(place=X).axes[0])
    assert points == sorted(X[given.gain.held_out].tolist())


@pytest.mark.parametrize("kind", ["fit", "residuals", "ranking", "profile"])
def test_a_saved_figure_shows_all_its_text_and_fills_the_page(kind):
    plot = shared_result(3, wave=1.0).plot
    figure = plot.profile("wave.size") if kind == "profile" else getattr(plot, kind)()
    assert_legible(figure)
    frame = figure.axes[0].get_tightbbox()
    assert frame.width > 0.95 * figure.bbox.width


def test_long_names_of_axes_are_shortened_to_what_has_place():
    long = "a name that nobody can mistake for another one, as it is " * 3
    found = shared_result(3, wave=1.0)
    figure = found.plot.fit(place=X, labels=(long, long))
    assert_legible(figure)
    above, below = figure.axes
    for label in (above.get_ylabel(), below.get_xlabel()):
        assert label.endswith("...")
        assert long.startswith(label[:-3])


def test_a_curve_is_drawn_only_through_conditions_of_one_setting():
    # Eight at one peak, and six at a peak each: seven kinds, more than there are markers.
    usual = [(20.0 + 10.0 * k, 2.5e-3) for k in range(8)]
    other = [(25.0 + 10.0 * k, 3e-3 + 1e-4 * k) for k in range(6)]
    conditions = [
        {"drive.mode": "IPP", "drive.direction": "+x", "drive.frequency": hertz, "drive.peak": peak}
        for hertz, peak in usual + other
    ]
    simulated = []

    def velocities(drives, vectors):
        simulated.extend((each["drive.frequency"], each["drive.peak"]) for each in drives)
        return np.outer(vectors[:, 0], [each["drive.frequency"] for each in drives])

    change = np.array([hertz for hertz, _ in usual + other])
    problem = SimpleNamespace(
        observed=change, size=1, base_count=0, causes=(), physical=lambda x: x,
        predicted=lambda x: np.outer(x[:, 0], change),
    )  # fmt: skip
    fit = SimpleNamespace(x=np.ones(1), name="wave", candidate=SimpleNamespace(causes=("wave",)))
    found = SimpleNamespace(
        problem=problem, null=SimpleNamespace(x=np.zeros(1)), extended=(problem, fit),
        noise=SimpleNamespace(dof=0.0, covariance=np.eye(14)), held_out=np.zeros(14, dtype=bool),
        verdict=SimpleNamespace(kind="named"), free_shape=None,
    )  # fmt: skip
    model = SimpleNamespace(velocities=velocities)
    posed = SimpleNamespace(conditions=conditions, extended_model=lambda _: model)
    figure = velocity_figure(found, posed)
    assert figure.kinds == ("peak 2.5 mT", "other peak")
    ((curve, dashes),) = [panel.lines for panel in figure.panels]
    assert curve.joined
    assert len(curve.x) > len(usual)
    assert not dashes.joined
    assert sorted(dashes.x) == sorted(hertz for hertz, _ in other)
    assert {peak for _, peak in simulated} == {2.5e-3}


@pytest.mark.parametrize(("kind", "letter"), list(enumerate(MARKERS.values())))
def test_a_kind_of_settings_has_one_shape_in_all_figures_of_a_page(kind, letter):
    style = MarkerStyle(letter)
    corners = style.get_path().transformed(style.get_transform()).vertices
    sign = marker(kind, 0.0, 0.0)
    points = re.search(r'points="(.*?)"', sign)
    if points is None:
        assert sign.split()[0] == {"o": "<circle", "s": "<rect"}[letter]
        return
    drawn = np.array([each.split(",") for each in points.group(1).split()], dtype=float)
    drawn[:, 1] *= -1.0  # downwards in SVG
    # The lowest and the highest place have the same number of corners.
    for end in (np.min, np.max):
        at = end(drawn[:, 1]), end(corners[:, 1])
        distinct = [
            {round(float(x), 6) for x, y in shape if abs(y - height) < 1e-6}
            for shape, height in zip((drawn, corners), at, strict=True)
        ]
        assert len(distinct[0]) == len(distinct[1])


def test_what_is_claimed_has_the_colour_of_the_extended_model():
    found = shared_result(3, wave=1.0).findings
    bars = {
        name.get_text(): bar.get_facecolor()
        for axes in figures.ranking(found).axes
        for name, bar in zip(axes.get_yticklabels(), axes.patches, strict=True)
    }
    claimed = to_rgba(figures.COLOURS["extended"])
    assert [name for name, colour in bars.items() if colour == claimed] == ["wave"]
    lines = figures.residuals(found, X, "x").axes[0].lines
    assert {line.get_color() for line in lines if line.get_label() == "extended"} == {
        figures.COLOURS["extended"]
    }
    assert {line.get_marker() for line in lines} == {"o"}
