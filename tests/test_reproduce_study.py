"""The study of the paper: its data against single simulations, its files, its page."""

import csv
import re
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from pictures import assert_legible
from stickslip import Coils, Drive, Scenario, ScenarioError, reproduce, simulate
from stickslip.reproduction.curve_drawing import draw_curves
from stickslip.reproduction.curves import CURVES
from stickslip.reproduction.field_checks import field_checks
from stickslip.reproduction.measured import MeasuredPoint, read_measured
from stickslip.reproduction.motions import MOTIONS, draw_motion, film_times, reference_runs
from stickslip.reproduction.points import (
    FEWER_PULSES_BELOW,
    PULSES,
    PULSES_WHEN_SLOW,
    RTOL,
    variations,
)
from stickslip.reproduction.settings import MODES, Grid, Setting
from stickslip.reproduction.strokes import strokes
from stickslip.reproduction.study import FIGURES, Effort
from stickslip.reproduction.survey import stroke_scenario, survey

SMALL = Effort(
    Grid(edges=("rise",), bases=(0.0, 1e-3), holds=(1.5e-3, 2.5e-3)),
    survey_variations=1,
    band_variations=2,
)
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
    assert set(units.values()) <= {
        "",
        "1",
        "s",
        "m",
        "m/s",
        "rad",
        "T",
        "N",
        "Hz",
        "N s/m",
        "N m s^2",
    }
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


def test_the_survey_is_that_of_single_simulations():
    grid = Grid(("rise",), ("up",), (1e-3,), (2e-3,))
    found = survey(grid, 1, 2)
    (setting,) = found.settings["OPP"]
    assert setting == Setting("OPP", "rise", "up", 1e-3, 2e-3)
    run = simulate(stroke_scenario(setting))
    by_stroke = found.strokes["OPP"][0]
    assert by_stroke == strokes(run)
    start, stop = run.scenario.window
    summary = run.summary()
    # With the clamp up theta is negative: what rises in magnitude falls in theta.
    assert by_stroke.slip_up == pytest.approx(summary["slip_down"] * (stop - start), rel=0.02)
    assert -found.tilt_high["OPP"][0] == pytest.approx(summary["theta_min"], abs=0.1)
    still = simulate(
        Scenario(
            drive=Drive(
                mode="OPP", clamp="up", peak=1e-3, base=1e-3, hold=2e-3, frequency=10, pulses=13
            )
        )
    )
    assert found.still_tilt["OPP"][0] == pytest.approx(abs(still.summary()["theta_max"]), abs=1e-4)


def test_small_changes_are_spread_and_begin_with_none():
    spread = variations(64)
    assert spread[0].tolist() == [0.0, 0.0, 0.0]
    assert np.abs(spread).max() <= 1.0
    assert np.abs(spread.mean(axis=0)).max() < 0.05
    assert np.abs(np.corrcoef(spread.T) - np.eye(3)).max() < 0.1


def test_the_field_by_hand():
    checks = field_checks()
    assert checks.torque == pytest.approx(1.625e-6 * 6.5e-3)
    assert checks.gradient_at_centre == pytest.approx(0.1214, abs=1e-4)
    assert checks.force_at_centre == pytest.approx(1.625e-6 * checks.gradient_at_centre)
    coils = Coils()
    current = [6.5e-3 / coils.centre_field_per_ampere, 0, 0, 0, 0]
    at = coils.gradient([checks.full_gradient_offset, 0, 0], current)[0, 0]
    assert at == pytest.approx(0.149, rel=1e-5)
    corner = coils.field([0.0125, 0.0125, 0.0125], [1, 0, 0, 0, 0])
    assert checks.fringe == pytest.approx(abs(corner[1] / corner[0]))
    assert checks.winding_flat == pytest.approx(0.0051, abs=1e-4)


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


def test_what_cannot_be_done_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match=r'figure "fig3": allowed is .*fig2.*fig15'):
        reproduce(only=["fig8", "fig3"])
    with pytest.raises(ValueError, match="threads"):
        reproduce(threads=0)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="not a folder"):
        reproduce(tmp_path / "file")


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "no row of data"),
        ("figure,mode,x\nfig12,IPP,1\n", 'column "y" is missing'),
        ("figure,mode,x,y\n", "no row of data"),
        ("figure,mode,x,y\nfig3,IPP,1,1\n", r'line 2: figure = "fig3": allowed is one of fig8'),
        ("figure,mode,x,y\n\nfig12,OPP,1,1\n", r'line 3: mode = "OPP": allowed in fig12 is IPP'),
        ("figure,mode,x,y\nfig12,IPP,ten,1\n", r'x = "ten": allowed is drive\.frequency'),
        ("figure,mode,x,y\nfig12,IPP,-1,0.1\n", r"x = \"-1\""),
        ("figure,mode,x,y\nfig12,IPP,10,nan\n", r'y = "nan": allowed is a velocity in m/s'),
        ("figure,mode,x,y\nfig12,IPP,10,1.5\n", r"y = \"1.5\""),
        ("figure,mode,x,y\nfig12,IPP,10\n", "line 2: 3 cells; allowed are 4"),
        ('figure,mode,x,y\n"fig12,IPP,10\n', "line 2: 1 cells"),
        ("figure,mode,x,y\nfig12,IPP,10,\xff\n".encode("latin-1"), "not UTF-8"),
    ],
)
def test_a_file_of_points_that_is_not_sound_is_refused(tmp_path, text, error):
    path = tmp_path / "points.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ScenarioError, match=error) as caught:
        read_measured(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_columns_may_come_in_any_order_and_with_others(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("﻿y,note, x ,mode,figure\n0.001,a,50,IPP,fig12\n\n", encoding="utf-8")
    assert read_measured(path) == [MeasuredPoint("fig12", "IPP", 50.0, 0.001)]


def test_importing_the_package_does_not_import_the_study():
    code = (
        "import sys, stickslip; assert not any('reproduction' in m for m in sys.modules); "
        "import stickslip.reproduction; assert callable(stickslip.reproduce)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
