"""The page of a diagnosis: five answers for every verdict, figures that show something, words."""

import functools
import re
from dataclasses import replace

import numpy as np
import pytest

from made_measurement import write
from report_page import ANSWERS, Page
from stickslip import Scenario, diagnose, read_measurement
from stickslip.diagnosis import diagnose_model
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.report.chart import Line, Panel, Point
from stickslip.diagnosis.report.differences import Rows
from stickslip.diagnosis.report.drawings import DRAWN, drawing
from stickslip.diagnosis.report.provenance import origin
from stickslip.diagnosis.report.velocity_difference import abscissa_key
from stickslip.facts import Code, Fact
from stickslip.facts.causes import CAUSES, CONSTANTS
from stickslip.scenario.keys import known_keys
from toy_model import CAUSES as TOY
from toy_model import (
    MODE,
    SIZE,
    UNCERTAIN,
    X,
    like_the_simulators,
    predict,
    result,
    shared_result,
)


def _perhaps():
    named = shared_result(3, wave=1.0)
    why = (Fact(Code.AT_LIMIT, {"name": "wave"}),)
    verdict = replace(named.findings.verdict, kind="ambiguous", reasons=why)
    return replace(named, findings=replace(named.findings, verdict=verdict))


def _pair():
    found = (shared_result(seed, wave=0.5, swell=-0.5) for seed in range(20))
    return next(each for each in found if each.verdict.kind == "pair")


VERDICTS = {
    "named": lambda: shared_result(3, wave=1.0),
    "constant": lambda: result(3, shift={1: 9.0}),
    "pair": _pair,
    "perhaps": _perhaps,
    "set": lambda: shared_result(0, split=0.4),
    "none": lambda: shared_result(3),
    "unexplained": lambda: result(2, extra=0.3 * np.sign(np.sin(25.0 * X + 2.0 * MODE))),
    "data-problem": lambda: diagnose_model(predict, None, np.zeros(SIZE), UNCERTAIN, TOY),
}
HEADLINES = {
    "named": r"^The data show wave: wave\.size = .* Keep it in the model: errors on \d+ conditions",
    "constant": r"^The constant k1 is .*, stated as 0\. Measure this constant again, or keep it in",
    "pair": "^Two causes act together. The data show swell: .* The data show wave: .*Keep both",
    "perhaps": "^The data show wave: .* But this is not certain: An amplitude of wave",
    "set": r"^Probably one of these \d causes acts, and the data cannot say which: .*split",
    "none": "^Nothing is wrong with the model beyond its constants",
    "unexplained": r"none of the \d+ causes that were tried, .* explains it well enough",
    "data-problem": "^These data allow no diagnosis. Every reading is zero",
}


@functools.cache
def toy_page(kind, folder):
    VERDICTS[kind]().save_report(folder, title="Toy", place=X, labels=("x", "y (V)"), unit="V")
    return Page(folder / "report.html")


@pytest.fixture(scope="module")
def page_of(tmp_path_factory):
    """The page of a verdict, made once."""
    folder = tmp_path_factory.mktemp("pages")
    return lambda kind: toy_page(kind, folder / kind)


every_verdict = pytest.mark.parametrize("kind", VERDICTS)


@every_verdict
def test_the_headline_says_what_and_what_to_do(page_of, kind):
    assert re.search(HEADLINES[kind], page_of(kind).headline)


@every_verdict
def test_the_five_questions_are_answered_in_full_sentences(page_of, kind):
    for name in ANSWERS:
        answer = page_of(kind).answer(name)
        assert answer, name
        for sentence in answer:
            assert re.search(r"\w[^.]*\.$", sentence.strip()), sentence
            assert not re.search(r"\bNone\b|\bnan\b|[{}]|Code\.|\+-", sentence), sentence


@every_verdict
def test_the_page_needs_nothing_from_elsewhere(page_of, kind, tmp_path):
    page = page_of(kind)
    for each in page.elements:
        for key in ("href", "src", "action", "data", "xlink:href"):
            address = each.get(key) or "#"
            assert address.startswith(("#", "data:")), each
        assert each["tag"] not in ("iframe", "object", "link", "form"), each
    source = "".join(each["text"] for each in page.elements if each["tag"] in ("style", "script"))
    assert not re.search(r"https?:|//|import|fetch|XMLHttp", source)
    # Within a figure a clip or a marker is named, by its own page's names.
    assert set(re.findall(r"url\(([^)]*)\)", source)) == set()


@every_verdict
def test_names_within_the_page_are_unique_and_there(page_of, kind):
    page = page_of(kind)
    names = [each["id"] for each in page.elements if "id" in each]
    assert len(names) == len(set(names))
    for each in page.elements:
        inside = re.findall(r"url\(#([^)]*)\)", " ".join(str(value) for value in each.values()))
        inside += [each["href"][1:]] if each.get("href", "")[:1] == "#" else []
        assert set(inside) <= set(names)


@every_verdict
def test_every_figure_shows_something(page_of, kind):
    page = page_of(kind)
    charts = page.all("svg", "chart")
    assert charts
    for chart in charts:
        points = [each for each in chart["inside"] if each["tag"] == "title"]
        assert len(points) >= SIZE
        assert all(each["text"] for each in points)
        assert chart["aria-label"]
    for plot in page.all("div", "plot"):
        drawn = [each for each in plot["inside"] if each["tag"] in ("path", "use", "image")]
        assert len(drawn) > 10
    assert page.all("img") == []
    for each in page.elements:
        assert "nan" not in str(each.get("points", each.get("cy", each.get("d", "")))), each


@every_verdict
def test_the_contents_name_all_that_is_folded(page_of, kind):
    page = page_of(kind)
    (contents,) = page.all("nav")
    links = [each["href"][1:] for each in contents["inside"] if each["tag"] == "a"]
    folds = page.all("details")
    assert len(links) == len(folds) == len(set(links)) >= 4
    for name, fold in zip(links, folds, strict=True):
        assert name in {each.get("id") for each in fold["inside"]}
        assert "open" not in fold
    # Nothing statistical is on the first screen but in the folds; the origin ends the page.
    assert links[-1] == "origin"


def test_a_curve_is_drawn_where_something_is_claimed_and_only_there(page_of):
    for kind in VERDICTS:
        (chart,) = page_of(kind).all("svg", "chart")
        curves = [each for each in chart["inside"] if "line" in each.get("class", "").split()]
        assert bool(curves) == (kind not in ("none", "unexplained", "data-problem")), kind


def test_the_page_opens_its_folds_in_print_and_has_both_themes(page_of):
    (style,) = page_of("none").all("style")
    for words in ("prefers-color-scheme: dark", "@media print", "max-width: 40rem"):
        assert words in style["text"]
    (script,) = page_of("none").all("script")
    assert "beforeprint" in script["text"]


def test_every_cause_and_every_constant_has_words_and_a_drawing():
    causes = library(Scenario(), {}, volts=10.0)
    assert set(CAUSES) == {cause.name for cause in causes}
    for cause in causes:
        words = CAUSES[cause.name]
        ends = [each.name.rpartition(".")[2] for each in cause.parameters]
        assert set(ends) == set(words.sizes)
        assert words.drawing in DRAWN
        assert words.remedy[0].isupper()
        fields = dict.fromkeys(ends, "5 units") | {f"{end}_way": "up" for end in ends}
        said = words.finding.format_map(fields)
        assert said.count("5 units") == len(ends)
        assert re.match(r"[A-Z].*[^.]\.$", said)
        for size in words.sizes.values():
            assert size.factor > 0.0
            assert bool(size.up) == bool(size.down)
    uncertain = {
        name
        for name, key in known_keys().items()
        if key.kind == "real"
        and name.split(".")[0] in ("coil", "robot", "contact", "drag", "environment")
    }
    assert set(CONSTANTS) == uncertain
    for name, words in CONSTANTS.items():
        assert words.drawing in DRAWN, name
        assert words.size.factor > 0.0


@pytest.mark.parametrize("name", sorted(DRAWN))
def test_a_drawing_is_whole_and_says_what_it_shows(name, tmp_path):
    (tmp_path / "a.html").write_text(drawing(name))
    page = Page(tmp_path / "a.html")
    (svg,) = page.all("svg")
    (title,) = page.all("title")
    assert svg["aria-label"] == title["text"]
    assert any(each.get("class") in ("cause", "patch") for each in svg["inside"])


@pytest.mark.parametrize(
    ("name", "parameter", "unit", "scale", "size", "said"),
    [
        ("surface_tilt", "angle", "rad", 0.02, -0.03,
         r"^The surface is tilted by 1\.[67]\d* ± 0\.0\d+ degrees, downhill to -x\. Level it, or "),
        ("surface_tilt", "angle", "rad", 0.02, 0.03, "downhill to \\+x"),
        ("length_scale", "fraction", "-", 0.03, -0.06,
         r"^The camera reads lengths (6\.|5\.9)\d* ± 0\.\d+ % too short\. Film a scale"),
        ("eddy_lag", "time", "s", 3e-4, 6e-4, r"with a delay of 0\.(6|5)\d* ± 0\.\d+ ms\. Remove"),
    ],
)  # fmt: skip
def test_sizes_are_told_in_peoples_units_with_words_for_their_sign(
    tmp_path, name, parameter, unit, scale, size, said
):
    found = like_the_simulators(name, parameter, unit, scale, size)
    assert found.verdict.kind == "named"
    found.save_report(tmp_path)
    page = Page(tmp_path / "report.html")
    assert re.search(said, page.headline.replace("\xa0", " ")), page.headline
    assert len(page.all("svg", "drawing")) == 1
    assert "With a probability of 95 % it is" in page.answer("size")[0]


@pytest.mark.parametrize(
    ("kind", "said"), [("named", "with the cause "), ("pair", "with both causes ")]
)
def test_a_point_says_what_it_is_compared_with(page_of, kind, said):
    titles = [each["text"] for each in page_of(kind).all("title") if "measured" in each["text"]]
    assert len(titles) >= SIZE
    assert all(said in each for each in titles)


def test_where_nothing_is_found_wide_limits_are_told_too(page_of):
    sharpest, widest, *_ = page_of("none").answer("size")
    assert re.search("limit best, .* below ", sharpest)
    assert "of up to" in widest
    assert "50 % before any data" in " ".join(page_of("none").answer("sure")).replace("\xa0", " ")


def test_errors_of_a_set_are_those_of_its_leading_member(page_of):
    assert "the leading one" in page_of("set").answer("better")[0]
    assert "the leading one" in page_of("set").answer("do")[-2]
    assert "the leading one" not in page_of("perhaps").answer("better")[0]


def test_nothing_is_drawn_where_nothing_is_named(page_of):
    for kind in ("none", "unexplained", "data-problem"):
        assert page_of(kind).all("svg", "drawing") == []


def test_the_figure_is_over_the_setting_on_which_the_change_depends():
    conditions = [
        {"drive.mode": "IPP", "drive.direction": "+x", "drive.frequency": f, "drive.peak": p}
        for f in (20.0, 40.0, 60.0, 80.0)
        for p in (1e-3, 2e-3, 3e-3, 4e-3)
    ]
    zero = np.zeros(16)
    for key in ("drive.frequency", "drive.peak"):
        change = np.array([each[key] for each in conditions])
        rows = Rows(zero, zero, change, None, zero > 0, "with the cause")
        assert abscissa_key(conditions, rows) == key
    # A setting that was mostly left as it was is no abscissa.
    for k, each in enumerate(conditions):
        each["drive.peak"] = 1e-3 * k if k > 12 else 1e-3
    assert abscissa_key(conditions, rows) == "drive.frequency"


def test_panels_have_axes_of_their_own_and_say_values_on_hover(tmp_path):
    def ticks(level):
        points = tuple(Point(k, level * k, 0.1 * level, f"value {k}") for k in range(4))
        line = Line((0.0, 3.0), (0.0, 3.0 * level), "cause", "curve")
        svg = Panel("a", "x", "y (m)", points, (line,)).svg()
        return svg, re.findall(r'text-anchor="end">([^<]*)<', svg)

    small, of_small = ticks(1e-7)
    large, of_large = ticks(3.0)
    assert "value 3" in small
    assert "y (10⁻⁹ m)" in small
    assert "y (m)" in large
    assert of_small != of_large
    assert len(set(of_small)) == len(of_small) >= 3


@pytest.fixture(scope="module")
def nothing_hidden(tmp_path_factory):
    """The folder of a measurement without any cause, and its diagnosis."""
    folder = tmp_path_factory.mktemp("nothing")
    return folder, diagnose(read_measurement(write(folder, {})), seed=3, threads=1)


def test_the_page_of_a_measurement_ends_with_its_origin(nothing_hidden):
    folder, found = nothing_hidden
    found.save_report(folder / "found")
    page = Page(folder / "found" / "report.html")
    assert len(page.all("svg", "chart")) == 2
    told_of = page.by_id("origin")["text"]
    for words in ("SHA-256", "m.toml", "nominal.toml", "velocity.csv", "date", "numpy", "seed"):
        assert words in told_of
    rows = dict(origin(found.measurement, 3))
    (folder / "velocity.csv").write_text("changed")
    again = dict(origin(found.measurement, 3))
    assert {name for name in rows if rows[name] != again[name]} <= {"file velocity.csv", "date"}
    assert rows["file velocity.csv"] != again["file velocity.csv"]
    (folder / "velocity.csv").unlink()
    assert "no ordinary file" in dict(origin(found.measurement, 3))["file velocity.csv"]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (["/usr/bin/stickslip", "diagnose", "a b.toml"], "stickslip diagnose 'a b.toml'"),
        (["/lib/stickslip/__main__.py", "diagnose", "m.toml"], "stickslip diagnose m.toml"),
        (["notebook.py", "m.toml"], "Python: save_report"),
    ],
)
def test_the_origin_has_the_command_line(monkeypatch, nothing_hidden, line, said):
    monkeypatch.setattr("sys.argv", line)
    assert dict(origin(nothing_hidden[1].measurement, 0))["made by"] == said


def test_the_members_of_a_set_are_all_told(page_of):
    found = VERDICTS["set"]()
    answer = " ".join(page_of("set").answer("size"))
    for fit in set_members(found.findings):
        assert f"{fit.name}.size" in answer
