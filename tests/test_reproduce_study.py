"""The study of the paper: its data against single simulations, its files, its page."""

import csv
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from pictures import assert_legible
from stickslip import Scenario, reproduce, simulate
from stickslip.reproduction.curves import CURVES, MeasuredPoint, draw_curves
from stickslip.reproduction.motions import MOTIONS, draw_motion, film_times, reference_runs
from stickslip.reproduction.points import (
    FEWER_PULSES_BELOW,
    PULSES,
    PULSES_WHEN_SLOW,
    RTOL,
)
from stickslip.reproduction.settings import MODES, Grid
from stickslip.reproduction.study import FIGURES, Effort

SMALL = Effort(
    Grid(edges=("rise",), bases=(0.0, 1e-3), holds=(1.5e-3, 2.5e-3)),
    survey_variations=1,
    band_variations=2,
)
UNITS = {"", "1", "s", "m", "m/s", "rad", "T", "N", "Hz", "N s/m", "N m s^2"}
MEASURED = "figure,mode,x,y\nfig12,IPP,50,0.001\nfig12,IPP,80,0.0015\nfig8,OPP,0.2,0.003\n"


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    points = folder / "points.csv"
    points.write_text(MEASURED)
    calls = []
    result = reproduce(
        folder / "a" / "b",
        measured=points,
        effort=SMALL,
        progress=lambda fraction, what: calls.append((what, fraction)),
    )
    return result, calls


@pytest.fixture(scope="module")
def runs(study):
    return reference_runs(study[0].reference, 1)


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_every_figure_has_a_picture_and_data(study):
    result, _ = study
    assert tuple(result.figures) == FIGURES
    assert ("fig2", *(f"fig{k}" for k in range(4, 16))) == FIGURES
    folder = result.page.parent
    expected = {f"{name}.{suffix}" for name in FIGURES for suffix in ("png", "csv")}
    assert {each.name for each in folder.iterdir()} == expected | {"index.html", "settings.csv"}
    for path in result.figures.values():
        with Image.open(path) as picture:
            assert min(picture.size) > 300
            assert np.asarray(picture.convert("L")).std() > 5.0


def test_progress_goes_from_nothing_to_all(study):
    fractions = [fraction for _, fraction in study[1]]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert {what for what, _ in study[1]} >= {"trying settings", "simulating figures", "drawing"}


@pytest.mark.parametrize("name", FIGURES)
def test_a_csv_file_has_the_columns_and_values_of_its_table(study, name):
    result, _ = study
    table = result.tables[name]
    written = rows(result.figures[name].with_suffix(".csv"))
    assert len(written) == len(table)
    units = table.attrs["units"]
    assert list(units) == list(table.columns)
    assert set(units.values()) <= UNITS
    headings = [
        f"{each} ({unit})" if unit not in ("", "1") else each for each, unit in units.items()
    ]
    assert list(written[0]) == headings
    for column, heading in zip(table, headings, strict=True):
        cells = [row[heading] for row in written]
        if table[column].dtype.kind != "f":
            assert cells == [str(value) for value in table[column]]
        else:
            numbers = np.array([float(cell) if cell else np.nan for cell in cells])
            np.testing.assert_array_equal(numbers, table[column])


@pytest.mark.parametrize(
    ("name", "column"),
    [
        ("fig8", "static_friction"),
        ("fig9", "adhesion"),
        ("fig10", "linear"),
        ("fig11", "rotational"),
        ("fig12", "frequency"),
        ("fig13", "frequency"),
        ("fig14", "peak"),
        ("fig15", "peak"),
    ],
)
def test_velocities_are_those_of_single_simulations(study, name, column):
    result, _ = study
    table = result.tables[name].to_dict("series")
    table = {each: values.to_numpy() for each, values in table.items()}
    assert next(iter(table)) == column
    assert sorted(set(table["mode"].tolist())) == sorted(CURVES[name].modes)
    for place in (0, len(table["mode"]) // 2, -1):
        mode, x = str(table["mode"][place]), float(table[column][place])
        setting = result.reference[mode]
        frequency = x if column == "frequency" else CURVES[name].scan.frequency
        keys = {
            **setting.keys(),
            "drive.peak": 2.5e-3,
            "drive.frequency": frequency,
            "drive.pulses": PULSES_WHEN_SLOW if frequency < FEWER_PULSES_BELOW else PULSES,
            "solver.rtol": RTOL,
            CURVES[name].scan.key: x,
        }
        if column == "static_friction":
            keys["contact.kinetic_friction"] = 0.7 * x
        if str(table["varied"][place]) == "all fields in proportion":
            keys |= {
                "drive.base": setting.base * x / 2.5e-3,
                "drive.hold": setting.hold * x / 2.5e-3,
            }
        expected = simulate(Scenario().replace(keys)).mean_velocity
        assert table["velocity"][place] == pytest.approx(expected, rel=1e-12)
    low, middle, high = (table[f"velocity_{each}"] for each in ("p10", "median", "p90"))
    assert np.all((low <= middle) & (middle <= high))


def test_motions_are_those_of_single_simulations(study, runs):
    result, _ = study
    for name, column in (("fig4", "bx"), ("fig6", "bz"), ("fig5", "theta"), ("fig7", "theta")):
        run = runs[MOTIONS[name].mode]
        table = result.tables[name]
        chosen = np.isin(run.t, table["t"])
        assert len(table["t"]) > 1000
        np.testing.assert_array_equal(getattr(run, column)[chosen], table[column])
        drive = run.scenario.drive
        assert (drive.frequency, drive.mode) == (30.0, MOTIONS[name].mode)


def test_the_film_shows_a_pulse_of_opp(study, runs):
    run = runs["OPP"]
    times = film_times(run)
    assert times == sorted(times)
    assert times[-1] - times[0] < 2.0 / 30.0
    table = study[0].tables["fig2"]
    tilt = np.abs(table["theta"])
    assert tilt[0] > tilt[1] < tilt[2] < tilt[3]
    assert table["contact_x"][3] > table["contact_x"][0]
    np.testing.assert_array_equal(table["contact_x_before"][1:], table["contact_x"].to_numpy()[:-1])
    corners_z = np.array([table[f"corner{k}_z"] for k in range(1, 5)])
    assert np.abs(corners_z.min(axis=0)).max() < 1e-5


@pytest.mark.parametrize("name", FIGURES)
def test_figures_can_be_read(study, runs, name):
    result, _ = study
    if name in MOTIONS:
        figure = draw_motion(name, runs[MOTIONS[name].mode])
    else:
        figure = draw_curves(name, result.tables[name], [])
    assert_legible(figure, least=8)
    assert all(axes.has_data() or axes.patches for axes in figure.axes)
    labels = [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())]
    assert all("(" in text or text == "static friction coefficient" for text in labels if text)


def test_measured_points_are_laid_over_their_figure(study):
    table = study[0].tables["fig12"]
    points = [MeasuredPoint("fig12", "IPP", 50.0, 1e-3), MeasuredPoint("fig13", "OPP", 9.0, 1e-3)]
    drawn = list(draw_curves("fig12", table, points).axes[0].get_lines())
    assert [(list(line.get_xdata()), list(line.get_ydata())) for line in drawn[1:]] == [
        ([50.0], [1.0])
    ]
    assert "measured" in drawn[1].get_label()


def test_statements_and_reference(study):
    result, _ = study
    assert [each.name for each in result.statements] == [f"S{k}" for k in range(1, 18)]
    motion = result.statements[:4]
    assert all(each.verdict.at_reference for each in motion)
    assert result.reference["IPP"].edge == result.reference["OPP"].edge == "rise"
    by_name = {each.name: each for each in result.statements}
    assert by_name["S14"].verdict.word == "reproduced"
    assert by_name["S16"].verdict.word == "reproduced"
    assert by_name["S17"].verdict.word == "not reproduced"
    assert "12.1%" in by_name["S17"].numbers
    assert "2.35%" in by_name["S17"].numbers
    assert len(result.settings["mode"]) == 16
    effects = " ".join(flaw.effect for flaw in result.flaws)
    assert "121 mT/m" in effects
    assert "24.05 µg" in effects


def test_results_are_the_same_for_any_number_of_threads(study):
    again = reproduce(only=["fig9"], threads=1, effort=SMALL)
    first = study[0]
    assert again.page is None
    assert again.figures == {}
    assert list(again.tables) == ["fig9"]
    for column in again.tables["fig9"].columns:
        np.testing.assert_array_equal(again.tables["fig9"][column], first.tables["fig9"][column])
    assert again.reference == first.reference
    assert again.as_dict()["statements"] == first.as_dict()["statements"]


class Page(HTMLParser):
    """Pictures, links and scripts of a page, and its text."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.sources, self.words = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.sources += [v for name, v in attributes if name in ("src", "href", "srcset", "data")]

    def handle_data(self, data):
        self.words.append(data)


def test_the_page_needs_nothing_but_itself(study):
    text = study[0].page.read_text(encoding="utf-8")
    page = Page(text)
    assert not {"script", "link", "iframe", "object", "form"} & set(page.tags)
    assert page.tags.count("img") == len(FIGURES)
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    without_pictures = re.sub(r'base64,[^"]*', "", text)
    assert not re.search(r"https?:|//|@import|url\(", without_pictures)
    words = " ".join(" ".join(page.words).split())
    for each in study[0].statements:
        assert each.text in words
        assert each.numbers in words
        assert each.verdict.text in words
    for flaw in study[0].flaws:
        assert flaw.effect in words
    assert "2 measured points from a file" in words
    for mode in MODES:
        assert study[0].reference[mode].text() in words
