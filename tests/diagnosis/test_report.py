"""The report of a diagnosis: its dictionary of numbers, its page, and its files."""

import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest

import films
import made_findings as made
import made_velocities
from stickslip._util.palette import VERMILION
from stickslip._util.text import json_text
from stickslip.diagnosis.data.film import FilmTable
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.entry import diagnose_model
from stickslip.diagnosis.measured import freed, pose
from stickslip.diagnosis.report import amounts
from stickslip.diagnosis.report.files import page
from stickslip.diagnosis.report.numbers import _drift, notes_of, numbers_of
from stickslip.diagnosis.report.pictures import drawing
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.steps import run
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.laws import free_law
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import load
from stickslip.scenario.uncertain import Prior
from stickslip.simulation.note import Note
from toys import LEVEL, SLOPE, STEP, WAVE, data, line

TRUTH = (1.1, 1.9, made.BUMP, 0.0, 0.0)
TILT = Parameter("effects.surface_tilt.angle", None, "rad", -0.5, 0.5, math.radians(2.0))
KEYS = {
    "verdict", "cause", "parameters", "probabilities", "p_value", "bounds", "gain", "next",
    "next_experiments", "left_out", "seed", "version", "headline", "notes", "recalibrated",
    "ranking", "conditions", "channels", "share", "discrepancy", "deciding_readings",
}  # fmt: skip
VOID = {"meta", "br", "link", "img", "path", "line", "rect", "circle", "ellipse", "use", "stop"}


class Page(HTMLParser):
    """What is on a page, and whether its elements are closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.targets, self.labels, self.words = [], [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if "id" in given:
            self.ids.append(given["id"])
        target = given.get("href") or given.get("src")
        if target:
            self.targets.append(target)
        if given.get("role") == "img":
            self.labels.append(given.get("aria-label", ""))

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if not {"style", "script"} & set(self.open):
            self.words.append(data)


@pytest.fixture(scope="module")
def dominant():
    """A cause beside an error along the curves: every number of a report is there."""
    return made.toy(TRUTH, error=0.12)


@pytest.fixture(scope="module")
def none():
    return made.toy((1.1, 1.9, 0.0, 0.0, 0.0))


def verdicts(dominant, none):
    """The same diagnosis told as each kind of verdict."""
    chance = dominant.chance.fits
    pair = next(each for each in chance if len(each.causes) == 2)
    plain = dominant.findings.models.get(["bump"])
    return {
        "named": made.said(dominant, "named", fit=plain),
        "dominant": dominant,
        "pair": made.said(dominant, "pair", fit=pair, causes=tuple(sorted(pair.names))),
        "ambiguous": made.said(
            dominant, "ambiguous", members=chance[:3], causes=("bump", "kink"), common=("bump",)
        ),
        "unexplained": made.said(dominant, "unexplained", fit=None, causes=()),
        "none": none,
        "data-problem": made.refused(dominant),
    }


@pytest.mark.parametrize(
    "kind", ["named", "dominant", "pair", "ambiguous", "unexplained", "none", "data-problem"]
)
def test_each_verdict_has_a_sound_page(dominant, none, kind):
    result = verdicts(dominant, none)[kind]
    numbers = numbers_of(result)
    assert numbers["verdict"] == kind
    numbers["origin"] = []
    seen = Page(page(result, numbers))
    assert not seen.open
    assert len(set(seen.ids)) == len(seen.ids)
    assert [each for each in seen.targets if not each.startswith("#")] == []
    assert {each[1:] for each in seen.targets} <= set(seen.ids)
    assert all(seen.labels)
    text = " ".join(" ".join(seen.words).split())
    assert numbers["headline"].split(". ")[0] in text
    assert not re.search(r"\b(None|nan|inf|Undefined|Namespace|Decimal)\b|[{}]", text)
    for card in ("what", "size", "sure", "decides", "do"):
        assert card in seen.ids
    first = text[: text.index("Contents")]
    assert first.count("The probability") <= 1
    assert len(set(re.findall(r"p [=<] \S*\d", first))) <= 1
    assert numbers["headline"] == result.summary().split("\n")[0]


def test_the_page_has_no_number_that_the_dictionary_lacks(dominant, none):
    """A page of report.json as it is read again, and one in which a number was changed."""
    for result in (dominant, none):
        numbers = {**numbers_of(result), "origin": []}
        again = json.loads(json_text(numbers))
        assert page(result, again) == page(result, numbers)
    numbers = {**numbers_of(dominant), "origin": []}
    numbers["parameters"]["bump.height"]["value"] = 0.7654321
    assert "0.765" in page(dominant, numbers)


def test_the_dictionary_has_the_keys_of_the_reference(dominant, none):
    for result in (dominant, none, made.refused(dominant)):
        numbers = result.as_dict()
        assert set(numbers) >= KEYS
        json_text(numbers)
    numbers = dominant.as_dict()
    assert numbers["cause"] == "bump"
    assert numbers["parameters"]["bump.height"]["value"] == dominant.params["value"]["bump.height"]
    assert numbers["share"] == dominant.candidate("bump").share
    assert none.as_dict()["bounds"].keys() == {"bump.height", "wave.size", "kink.slope"}


def test_the_readings_that_decide_are_at_the_bump(dominant):
    """The bump is at 0.5 of a range in 20 places."""
    numbers = dominant.as_dict()
    rows = numbers["deciding_readings"]
    assert len(rows) == 3
    places = [numbers["conditions"][each["number"] - 1]["settings"]["x"] for each in rows]
    assert all(abs(place - 0.5) < 0.15 for place in places)
    assert 0.0 < sum(each["share"] for each in rows) < 1.0


def test_the_readings_of_a_pair_speak_for_each_cause_against_the_other(dominant, none):
    rows = verdicts(dominant, none)["pair"].as_dict()["deciding_readings"]
    own = [each for each in rows if each["for"] == "a bump in the middle"]
    assert len(rows) == 4
    assert len(own) == 2
    assert max(each["difference"] for each in own) == max(each["difference"] for each in rows)


def test_the_misfit_is_that_of_the_recalibrated_model(dominant):
    """All readings have the same error: its square is the share of chi-square."""
    numbers = dominant.as_dict()
    square = [(each["reading"] - each["recalibrated"]) ** 2 for each in numbers["conditions"]]
    largest = sorted(square, reverse=True)[:3]
    assert [each["share"] for each in numbers["misfit"]] == pytest.approx(largest / np.sum(square))


def test_a_drift_is_told_by_its_size_over_all_trials():
    """12 velocities that grow by 0.01 % of themselves from trial to trial, among 3 repeats."""
    condition, order = np.repeat(np.arange(4), 3), np.random.default_rng(1).permutation(12)
    level = np.array([1e-3, -2e-3, 3e-3, 0.0])[condition]
    y = level * (1.0 + 1e-4 * order)
    mean = np.bincount(condition, y) / 3
    table = SimpleNamespace(condition=condition, mean=mean, y=y, sequence=order.astype(float))
    used = order[:9]
    # Each is beside its own mean, which has grown too: by less than 0.1 %.
    assert _drift(table) == pytest.approx(1e-4 * (used.max() - used.min()), rel=2e-3)
    _, size, do = amounts.suspect("drift", 0.31)
    assert "31 %" in size
    assert "random order" in do


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("bump", "a bump in the middle"),
        ("bump + level", "a bump in the middle and another level than stated"),
        ("step_out", "“step_out”"),
        ("friction over speed", "a dependence of friction on speed"),
    ],
)
def test_a_title_can_follow_of(name, said):
    step = Cause(
        "step_out",
        Parameter("period", low=0.0, high=9.0, size=1.0),
        "the rotor falls behind its field",
    )
    law = free_law("friction", "speed", "m/s", 0.0, 1.0, factor_of="mu")
    causes = (*made.CAUSES, *freed(made.CONSTANTS), step, law)
    assert amounts.title(name, causes) == said
    assert amounts.in_titles(f"{name} leads (p = 1e-15).", causes) == f"{said} leads (p < 10⁻¹²)."


def test_odds_are_those_of_the_ranking(dominant):
    """And a cause has the probability of all models that have it."""
    numbers = dominant.as_dict()
    chance = {row["candidate"]: row["probability"] for row in numbers["ranking"]}
    rivals = [name for name in chance if "bump" not in name.split(" + ")]
    assert numbers["runner_up"]["candidate"] == rivals[0]
    for said, name in (
        (numbers["runner_up"]["odds"], rivals[0]),
        (numbers["odds"]["none"], "none"),
    ):
        assert said == pytest.approx(chance["bump"] / chance[name])
        assert said in [row["odds"] for row in numbers["ranking"] if row["candidate"] == name]
    assert numbers["leader"]["in_all"] == pytest.approx(numbers["probabilities"]["bump"])
    assert numbers["leader"]["in_all"] > chance["bump"]
    assert amounts.percent(numbers["leader"]["in_all"]) in dominant.summary().split("\n")[1]


def test_tables_of_one_name_have_errors_of_their_own():
    """Those that the tables have while they are called differently."""
    wave = 0.8 * np.sin(5.0 * np.linspace(1.0, 3.0, 30))
    tables = [data(wave, sd=sd) for sd in (0.1, 0.3)]
    tables[1].name = "other"
    result = diagnose_model(line, tables, [SLOPE, LEVEL], [WAVE, STEP])
    before = result.as_dict()["gain"]
    tables[1].name = tables[0].name
    after = result.as_dict()["gain"]
    for key in ("mae_before", "mae_after"):
        assert after[key]["line 1"] == pytest.approx(before[key]["line"])
        assert after[key]["line 2"] == pytest.approx(before[key]["other"])


@pytest.mark.parametrize("everywhere", [True, False])
def test_a_curve_is_drawn_where_the_model_can_be_computed(everywhere):
    """Not where a model knows its own rows only, or means something else between them."""
    x = np.linspace(1.0, 3.0, 20)
    wave = np.sin(5.0 * x)

    def predict(table, p):
        shape = np.sin(5.0 * table["x"]) if everywhere else np.resize(wave, len(table["x"]))
        return p["slope"] * table["x"] + p["wave.height"] * shape

    noise = 0.05 * np.random.default_rng(1).standard_normal(20)
    table = Table({"x": x}, x + 0.8 * wave + noise, sd=0.05, name="way")
    result = diagnose_model(predict, table, [SLOPE], [WAVE])
    axes = result.plot.residuals().axes[0]
    (drawn,) = [each for each in axes.lines if len(each.get_xdata()) >= 20 and
                each.get_color() == VERMILION]  # fmt: skip
    places, change = np.array(drawn.get_data())
    assert (len(places) > 20) == everywhere == bool(axes.collections[1:])
    known = result.predict({"x": places})
    if everywhere:
        assert np.allclose(change, known["extended"] - known["recalibrated"])
    low, high = axes.get_ylim()
    assert np.all((change > low) & (change < high))


def test_the_notes_of_a_film_name_it_and_what_all_have_comes_last(none):
    own = replace(none, notes=(Note("no-block-column", "No blocks."), Note("rest", "It rests.")))
    numbers = own.as_dict()
    assert [each["text"] for each in numbers["notes"]] == ["It rests.", "No blocks."]
    assert "It rests." in own.summary()
    assert "No blocks." not in own.summary()
    film = FilmTable(films.tracking_run({}, 400.0, 1, stated=False))
    seen = SimpleNamespace(problem=SimpleNamespace(tables=(film,)), notes=())
    assert all(each["text"].startswith(f"{film.title}: ") for each in notes_of(seen))
    assert len(notes_of(seen)) == len(film.notes) > 0


def test_a_notebook_shows_tables_and_figures_are_files(dominant, none, tmp_path):
    for result in (dominant, none, made.refused(dominant)):
        shown = Page(result._repr_html_())
        assert not shown.open
        assert "Verdict" in " ".join(shown.words)
    assert dominant._repr_html_().count("<table") == 4
    written = dominant.save_figures(tmp_path / "figures")
    assert {each.name for each in written} == {
        f"{name}.{form}"
        for name in ("fit-volts", "residuals-volts", "ranking", "cosines")
        for form in ("svg", "pdf")
    }
    heads = {each.suffix: each.read_bytes()[:5] for each in written}
    assert heads == {".svg": b"<?xml", ".pdf": b"%PDF-"}
    with pytest.raises(ScenarioError, match="folder"):
        none.save_figures(5)


@pytest.mark.nightly
def test_a_law_is_told_by_its_curve_and_a_formula():
    result = made.friction()
    assert result.verdict.causes == ("friction over speed",)
    numbers = result.as_dict()
    law = numbers["law"]
    at, value = np.array(law["at"]), np.array(law["value"])
    true = 0.3 * (1.0 - 0.4 * (1.0 - np.exp(-at / 0.2)))
    inside = (at > 0.05) & (at < 0.95)
    # Five knots cannot bend as sharply as the truth does at first.
    assert np.max(np.abs(value - true)[inside]) < 0.03
    assert np.all(np.array(law["low"]) < value)
    assert "friction" in page(result, {**numbers, "origin": []})


def test_user_text_is_escaped(dominant, tmp_path):
    made.refused(dominant).save_report(tmp_path, title="<b>volts</b>")
    text = (tmp_path / "report.html").read_text()
    assert "<alike>" not in text
    assert "<b>volts" not in text
    assert "&lt;alike&gt;" in text
    assert sorted(each.name for each in tmp_path.iterdir()) == ["report.html", "report.json"]


def test_nothing_is_written_where_one_file_cannot_be(none, tmp_path):
    (tmp_path / "report.json").mkdir()
    with pytest.raises(OSError, match=r"report\.json") as raised:
        none.save_report(tmp_path)
    assert "\n" not in str(raised.value)
    assert [each.name for each in tmp_path.iterdir()] == ["report.json"]
    with pytest.raises(ScenarioError, match="folder"):
        none.save_report(5)


def test_a_measurement_has_an_extended_scenario(tmp_path):
    measured = made_velocities.measurement(made_velocities.trials())
    result = Diagnosis(run(pose(measured), 0), measured)
    result.save_report(tmp_path)
    extended = load(tmp_path / "extended.toml")
    key = "contact.kinetic_friction"
    assert extended.get(key) == pytest.approx(result.params.loc[key, "value"])
    assert extended.uncertain.matrix[0][0] == pytest.approx(result.params.loc[key, "sd"] ** 2)
    assert not Page((tmp_path / "report.html").read_text()).open
    table = result.predict([{"frequency": 25.0, "direction": "+x", "base": 0.5e-3}])
    row = next(
        k for k, each in enumerate(result.problem.tables[0].conditions)
        if (each["drive.frequency"], each["drive.direction"]) == (25.0, "+x")
    )  # fmt: skip
    predicted = result.best.prediction["predicted"].iloc[row]
    assert table["recalibrated"].iloc[0] == pytest.approx(predicted, rel=1e-3)


@pytest.mark.parametrize(
    ("value", "sd", "said"),
    [
        (14.947, 0.7512, "14.95 ± 0.75"),
        (1.2231, 0.0943, "1.223 ± 0.094"),
        (1.2231, 0.0993, "1.22 ± 0.10"),
        (1512.0, 97.3, "1510 ± 100"),
        (2.2e-7, 3e-8, "(2.20 ± 0.30)·10⁻⁷"),
        (0.0, 0.02, "0.000 ± 0.020"),
        (3.0, float("nan"), "3"),
    ],
)
def test_an_amount_ends_at_the_second_digit_of_its_error(value, sd, said):
    assert amounts.amount(value, sd) == said


@pytest.mark.parametrize(
    ("parameter", "said"),
    [
        (TILT, "normal about 0, 68 % within 2 degrees"),
        (replace(TILT, low=0.0), "half-normal from 0 on, 68 % within 2 degrees"),
        (Parameter("k", Prior("normal", 2.0, 0.3), "V"), "normal, 2.00 ± 0.30 V"),
        (Parameter("k", Prior("log-uniform", 1.0, 9.0)), "log-uniform, 1 to 9"),
    ],
)
def test_a_prior_is_told_by_its_name_in_the_unit_of_the_headline(parameter, said):
    assert amounts.before(parameter) == said


def test_each_cause_of_the_library_has_its_drawing():
    for name, each in {**amounts._WORDS["effects"], **amounts._WORDS["readings"]}.items():
        assert drawing(each["drawing"]), name
        for words in each["sizes"].values():
            for way in {"up", "down"} & words.keys():
                assert Page(drawing(each["drawing"], words[way])).open == []
    assert drawing("tilt", "downhill to -x") != drawing("tilt")
    assert drawing("no such thing") == ""
