"""The report of a diagnosis: its dictionary of numbers, its page, and its files."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from report_keys import WORDS, reference

import made_findings as made
import made_velocities
from report_page import Page
from stickslip._util.note import Note
from stickslip._util.palette import VERMILION
from stickslip._util.text import json_text
from stickslip.diagnosis.data.settings import Settings
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.entry import diagnose_model
from stickslip.diagnosis.pipeline import run
from stickslip.diagnosis.report.files import figures_of, page
from stickslip.diagnosis.report.numbers import numbers_of, summary_text
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.cause import Cause, CauseNote
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.words import Vocabulary, Words
from stickslip.scenario.scenario import load
from stickslip.walker.problem import posed_by, vocabulary
from toys import LEVEL, SLOPE, STEP, WAVE, data, line, problem

KEYS = reference().keys()
"""Keys of report.json, from the reference."""


@pytest.fixture(scope="module")
def results(rough, none):
    """The same diagnosis told as each kind of verdict."""
    chance = rough.chance.fits
    pair = next(each for each in chance if len(each.causes) == 2)
    plain = rough.findings.models.get(["bump"])
    return {
        "named": made.said(rough, "named", fit=plain),
        "dominant": rough,
        "pair": made.said(rough, "pair", fit=pair, causes=tuple(sorted(pair.names))),
        "ambiguous": made.said(rough, "ambiguous", members=chance[:3], causes=("bump", "kink")),
        "unexplained": made.said(rough, "unexplained", fit=None, causes=(), leader=plain),
        "none": none,
        "data-problem": made.refused(rough),
    }


@pytest.mark.parametrize(
    "kind", ["named", "dominant", "pair", "ambiguous", "unexplained", "none", "data-problem"]
)
@pytest.mark.daily("named", "ambiguous", "none")
def test_each_verdict_has_a_page_of_its_numbers(results, kind, tmp_path):
    result = results[kind]
    numbers = numbers_of(result)
    assert numbers["verdict"] == kind
    assert set(numbers) == KEYS - {"sides", "paired"}  # of a comparison alone
    html = page({**numbers, "origin": []}, figures_of(result), result.problem.words)
    html = re.sub(r"<(style|script).*?</\1>", "", html, flags=re.DOTALL)
    (tmp_path / "report.html").write_text(html)
    seen = Page(tmp_path / "report.html")
    ids = [each["id"] for each in seen.elements if "id" in each]
    links = [each.get("href") or each.get("src") for each in seen.elements]
    assert {each for each in links if each} <= {f"#{each}" for each in ids}
    (text,) = (each["text"] for each in seen.all("body"))
    assert numbers["headline"].split(". ")[0] in " ".join(text.split())
    assert ("nearest, with a bump" in text) == (kind == "unexplained")
    assert not re.search(r"\b(None|nan|inf|Undefined|Namespace|Decimal)\b|[{}]", text)
    assert numbers["headline"] == result.summary().split("\n")[0]
    assert "Verdict" in result._repr_html_()
    # Sizes of a set are of rivals: wherever they are told, so is that, and names beside words.
    told = [" ".join(each.split()) for each in (text, result.summary(), result._repr_html_())]
    is_set = kind == "ambiguous"
    assert [each.count("own model is right") for each in told] == [2 * is_set, is_set, is_set]
    assert ("bump + kink (a bump in the middle and" in told[1]) == is_set


def test_constants_that_moved_or_had_a_range_are_in_the_text(rough, none):
    for told in (rough, none):
        numbers = numbers_of(told)
        row = numbers["recalibrated"]["level"]
        error = row["sd_extended" if numbers["claimed"] else "sd"]
        assert error == told.params.loc["level", "sd"]
        size = amounts.amount(told.params.loc["level", "value"], error, "V")
        for pull, stated, shown in ((0.9, 1.0, False), (-1.1, 1.0, True), (0.1, None, True)):
            row |= {"pull": pull, "pull_extended": pull, "stated": stated}
            assert (f"level = {size} (" in summary_text(numbers, told.problem.words)) == shown


def test_a_size_says_whether_its_interval_has_zero_and_a_constant_what_was_stated(rough):
    numbers = {**numbers_of(rough), "origin": []}
    row = numbers["parameters"]["bump.height"]
    for low, stated in ((-0.1, None), (0.1, 7.0)):
        row |= {"low": low, "stated": stated}
        text = summary_text(numbers, rough.problem.words)
        told = text, page(numbers, figures_of(rough), rough.problem.words)
        assert all(("not told from 0" in each) == (low < 0.0) for each in told)
        assert (" V, stated 7 V," in text) == (stated is not None)


def test_a_size_that_models_of_a_set_share_says_whose_it_is_and_what_is_cut_is_counted(results):
    result = results["ambiguous"]
    numbers = numbers_of(result)
    rows, chance = numbers["parameters"], result.chance
    first = next(each for each in chance.fits if "bump" in each.names)
    models = rows["bump.height"]["models"]
    assert [*models] == [each.name for each in result.verdict.members if "bump" in each.names]
    assert next(iter(models)) == first.name
    for name, told in models.items():
        own = result.candidate(name).params.loc["bump.height"]
        assert (told["value"], told["sd"]) == (own["value"], own["sd"])
        assert told["low"] < told["value"] < told["high"]
    text = summary_text(numbers, result.problem.words)
    assert f"bump.height (model {first.name}) = " in text
    assert "more in the report" not in text
    numbers["parameters"] = {f"{k}": rows["bump.height"] for k in range(8)}
    assert "and 2 more in the report" in summary_text(numbers, result.problem.words)


def words_of(value, names):
    """Names and words in a dictionary of numbers, wherever a key has one of the names."""
    if isinstance(value, list):
        return {pair for each in value for pair in words_of(each, names)}
    if not isinstance(value, dict):
        return set()
    other = "law", "settings"  # their words are of other lists
    own = {(name, value[name]) for name in names & value.keys() if isinstance(value[name], str)}
    return own | words_of([each for key, each in value.items() if key not in other], names)


def test_the_reference_has_each_word_that_is_written(results):
    written = set().union(*(words_of(numbers_of(each), WORDS.keys()) for each in results.values()))
    assert {name for name, _ in written} == WORDS.keys()
    assert written <= {(name, word) for name, words in WORDS.items() for word in words}
    assert {word for name, word in written if name == "form"} > {"exact"}
    text = " ".join(reference().values())
    assert not re.search(r"<\w+>", text)
    assert {word for _, word in written} <= set(re.findall(r"`([\w-]+)`", text))


def test_a_leader_that_takes_most_is_told_first_though_it_is_not_named(rough):
    reason = CauseNote("uncertain-gain", "{} predicts held-out readings worse.", ["bump"])
    first = {}
    for name in ("bump", "wave"):
        leader = rough.findings.models.get([name])
        told = made.said(
            rough, "unexplained", fit=None, causes=(), leader=leader, reasons=(reason,)
        )
        first[name] = told.summary().split("\n")[0]
    part = amounts.percent(rough.candidate("bump").share)
    assert first["bump"].startswith(
        f"A bump in the middle takes {part} of the model's squared error, but is not named: a"
        " bump in the middle predicts held-out readings worse"
    )
    assert first["wave"].startswith("Something is wrong that none of the 5 listed causes explains.")


@pytest.mark.nightly
def test_the_page_has_no_number_that_the_dictionary_lacks(results, rough, none):
    """A page of report.json as it is read again, and one in which a number was changed."""
    for result in (rough, none, results["data-problem"]):
        numbers, figures = {**numbers_of(result), "origin": []}, figures_of(result)
        again = json.loads(json_text(numbers))
        words = result.problem.words
        assert page(again, figures, words) == page(numbers, figures, words)
    numbers = {**numbers_of(rough), "origin": []}
    numbers["parameters"]["bump.height"]["value"] = 0.7654321
    assert "0.765" in page(numbers, figures, words)


def test_an_error_on_the_page_has_two_digits(rough):
    numbers, figures = {**numbers_of(rough), "origin": []}, figures_of(rough)
    for row in numbers["conditions"]:
        row["sd"] = 0.0123456
    (channel,) = numbers["channels"].values()
    channel["median_sd"] = 0.0456789
    text = page(numbers, figures, rough.problem.words)
    assert text.count(">0.012&nbsp;V<") == len(numbers["conditions"])
    assert "a usual error of 0.046&nbsp;V" in text
    assert not re.search(r"0\.(0123|0457)", text)


def test_numbers_are_those_of_the_result(rough, none):
    numbers = rough.as_dict()
    assert numbers["cause"] == "bump"
    assert max(numbers["probabilities"].values()) <= 1.0
    assert numbers["parameters"]["bump.height"]["value"] == rough.params["value"]["bump.height"]
    assert numbers["share"] == rough.candidate("bump").share
    bounds = none.as_dict()["bounds"]
    assert bounds.keys() == {"bump.height", "wave.size", "kink.slope"}


def test_the_readings_that_decide_are_at_the_bump(rough):
    """The bump is at 0.5 of a range in 20 places."""
    numbers = rough.as_dict()
    rows = numbers["deciding_readings"]
    assert len(rows) == 3
    places = [numbers["conditions"][each["number"] - 1]["settings"]["x"] for each in rows]
    assert all(abs(place - 0.5) < 0.15 for place in places)
    assert 0.0 < sum(each["share"] for each in rows) < 1.0


def test_the_readings_of_a_pair_speak_for_each_cause_against_the_other(results):
    rows = results["pair"].as_dict()["deciding_readings"]
    own = [each for each in rows if each["for"] == "a bump in the middle"]
    assert (len(rows), len(own)) == (4, 2)
    assert max(each["difference"] for each in own) == max(each["difference"] for each in rows)


def test_the_misfit_is_that_of_the_recalibrated_model(rough):
    """All readings have the same error: its square is the share of chi-square."""
    numbers = rough.as_dict()
    square = [(each["reading"] - each["recalibrated"]) ** 2 for each in numbers["conditions"]]
    largest = sorted(square, reverse=True)[:3]
    assert [each["share"] for each in numbers["misfit"]] == pytest.approx(largest / np.sum(square))


def test_a_drift_is_told_by_its_size_over_all_trials():
    _, size, do = Words(vocabulary()).data_problem(Note("drift", "They drift.", 0.31))
    assert "31 %" in size
    assert "random order" in do


def test_odds_are_those_of_the_ranking(rough):
    """And a cause has the probability of all models that have it."""
    numbers = rough.as_dict()
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
    assert amounts.percent(numbers["leader"]["in_all"]) in rough.summary().split("\n")[1]


@pytest.mark.nightly
def test_tables_of_one_name_have_errors_of_their_own():
    """Those that the tables have while they are called differently."""
    wave = 0.8 * np.sin(5.0 * np.linspace(1.0, 3.0, 30))
    tables = [data(wave, sd=sd) for sd in (0.1, 0.3)]
    tables[1].name = "other"
    posed = problem(tables)
    before = run(posed, 0).verdict.gain
    tables[1].name = tables[0].name
    after = run(posed, 0).verdict.gain
    for one, two in ((before.mae_before, after.mae_before), (before.mae_after, after.mae_after)):
        assert list(two) == ["line 1", "line 2"]
        assert list(two.values()) == pytest.approx(list(one.values()))


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
    assert drawn.get_label() == "with a wave"
    places, change = np.array(drawn.get_data())
    assert (len(places) > 20) == everywhere == bool(axes.collections[1:])
    known = result.predict({"x": places})
    if everywhere:
        assert np.allclose(change, known["extended"] - known["recalibrated"])
    low, high = axes.get_ylim()
    assert np.all((change > low) & (change < high))


def test_figures_are_files(rough, tmp_path):
    written = rough.save_figures(tmp_path / "figures")
    assert {each.name for each in written} == {
        f"{name}.{form}" for name in ("fit-volts", "residuals-volts") for form in ("svg", "pdf")
    }
    heads = {each.suffix: each.read_bytes()[:5] for each in written}
    assert heads == {".svg": b"<?xml", ".pdf": b"%PDF-"}


@pytest.mark.nightly
def test_a_law_is_told_by_its_form_and_its_lines():
    result = made.friction()
    assert result.verdict.causes == ("friction over speed",)
    numbers = result.as_dict()
    law = numbers["law"]
    at, value = np.array(law["at"]), np.array(law["value"])
    true = 0.3 * (1.0 - 0.4 * (1.0 - np.exp(-at / 0.2)))
    assert np.max(np.abs(value - true)) < 0.01
    assert np.all(np.array(law["low"]) < value)
    # 0.3 (1 - 0.4 (1 - exp(-u/0.2))) is 0.18 (1 + 0.67 exp(-u/0.2)).
    assert (law["form"], next(iter(law["forms"]))) == ("exponential", "exponential")
    sizes = result.params["value"]
    assert sizes["mu"] == pytest.approx(0.18, abs=0.01)
    assert sizes["friction over speed.exponential.scale"] == pytest.approx(0.2, rel=0.1)
    assert law["lines"][0].startswith("friction = 0.1")
    assert law["lines"][0] in result.summary()
    # At new conditions too the law is in its form.
    predicted = result.predict({"u": at[1:]})["extended"]
    assert np.array(predicted) == pytest.approx(value[1:], abs=1e-6)
    assert "friction" in page({**numbers, "origin": []}, figures_of(result), result.problem.words)


def test_user_text_is_escaped(rough, tmp_path):
    made.refused(rough).save_report(tmp_path, title="<b>volts</b>")
    text = (tmp_path / "report.html").read_text()
    assert "<alike>" not in text
    assert "<b>volts" not in text
    assert "&lt;alike&gt;" in text
    assert sorted(each.name for each in tmp_path.iterdir()) == ["report.html", "report.json"]


@pytest.mark.nightly
def test_a_measurement_has_an_extended_scenario(tmp_path):
    measured = made_velocities.measurement(made_velocities.trials())
    result = Diagnosis(run(posed_by(measured), 0), measured)
    result.save_report(tmp_path)
    extended = load(tmp_path / "extended.toml")
    key = "contact.kinetic_friction"
    assert extended.get(key) == pytest.approx(result.params.loc[key, "value"])
    text = (tmp_path / "extended.toml").read_text()
    assert re.findall(r"^# (\S+): \S+ -> ", text, re.MULTILINE) == [key]
    assert extended.uncertain.matrix[0][0] == pytest.approx(result.params.loc[key, "sd"] ** 2)
    table = result.predict([{"frequency": 25.0, "direction": "+x", "base": 0.5e-3}])
    row = next(
        k for k, each in enumerate(result.problem.tables[0].conditions)
        if (each["drive.frequency"], each["drive.direction"]) == (25.0, "+x")
    )  # fmt: skip
    predicted = result.best.prediction["predicted"].iloc[row]
    assert table["recalibrated"].iloc[0] == pytest.approx(predicted, rel=1e-3)


def wave_of(cause, **names):
    """A wave of a model of one's own, and how its cause is told."""
    x = np.linspace(1.0, 3.0, 24)
    y = x + np.sin(5.0 * x) + 0.1 * np.random.default_rng(0).standard_normal(24)
    (name,) = (each.name for each in cause.parameters)
    predict = lambda t, p: p["slope"] * t["x"] + p[name] * np.sin(5.0 * t["x"])  # noqa: E731
    return diagnose_model(predict, Table({"x": x}, y, sd=0.1, **names), [SLOPE], [cause])


@pytest.mark.parametrize("name", ["error", "s", "{}", "model's"])
def test_a_note_has_a_cause_in_words_and_its_other_words_as_they_are(name):
    words = Words(Vocabulary(), [Cause(name, frees=name)])
    note = CauseNote("small-share", "{} takes 3 % of the model's error; {} none.", [name, "none"])
    assert str(note) == f"{name} takes 3 % of the model's error; none none."
    said = f"another {name} than stated takes 3 % of the model's error; no cause none."
    assert words.note(note) == said
    assert words.note(Note("plain", "A {} of error.")) == "A {} of error."
    assert note.as_dict().keys() == {"code", "text", "value"}


@pytest.mark.parametrize(
    ("name", "parameter", "meaning", "title"),
    [
        ("wave", "wave", "dry friction", "dry friction"),
        ("wave", "wave.height", "The ripple of a motor.", "The ripple of a motor"),
        ("surface_tilt", "surface_tilt.angle", "", "“surface_tilt”"),
    ],
)
def test_an_own_cause_is_told_by_its_meaning(name, parameter, meaning, title):
    cause = Cause(name, Parameter(parameter, unit="N m", size=0.5, low=-5.0, high=5.0), meaning)
    (said,) = wave_of(cause).as_dict()["claimed"][0]["causes"]
    assert (said["title"], said["remedy"], said["meaning"]) == (title, "", "")
    short = parameter.rpartition(".")[2]
    assert re.match(rf".*: {short} = [\d.]+ ± [\d.]+ N m\.", said["finding"])


def test_a_misfit_that_nothing_explains_is_told_by_its_settings_and_sign():
    """A bump below the line at 1.8 to 2.2, in one of two oils."""
    x, oil = np.tile(np.linspace(1.0, 3.0, 31), 2), np.repeat(["thin", "thick"], 31)
    y = x - 2.0 * ((abs(x - 2.0) < 0.21) & (oil == "thin"))
    y += 0.1 * np.random.default_rng(0).standard_normal(62)
    table = Table({"oil": oil, "x": x}, y, sd=0.1, unit="N")
    result = diagnose_model(lambda t, p: p["slope"] * t["x"], table, [SLOPE])
    numbers = made.said(result, "unexplained", causes=(), fit=None).as_dict()
    pattern = numbers["pattern"]
    assert (pattern["where"], pattern["side"]) == ("oil thin, x 1.8 to 2.2", "below")
    assert (pattern["readings"], pattern["of"]) == (7, 62)
    assert pattern["mean"] == pytest.approx(-2.0, abs=0.3)
    assert numbers["parameters"] == {}


def test_errors_that_are_not_known_are_not_shown(none):
    table = none.problem.tables[0]
    problem = replace(none.problem, errors=(replace(none.problem.errors[0], dof=0.0),))
    findings = none.findings
    models = type(findings.models)(problem, problem.causes)
    result = made.refused(replace(none, findings=replace(findings, models=models)))
    numbers = result.as_dict()
    assert {each["sd"] for each in numbers["conditions"]} == {None}
    assert numbers["channels"][table.name]["median_sd"] is None
    (bars,) = result.plot.fit().axes[0].containers[:1]
    assert not bars.has_yerr


def test_the_gain_of_each_record_is_told_the_worst_first():
    wave = 0.8 * np.sin(5.0 * np.linspace(1.0, 3.0, 30))
    tables = [data(wave), data(wave, seed=2), data(seed=1)]
    for table, name in zip(tables, ("a", "b", "flat"), strict=True):
        table.name = name
    result = diagnose_model(line, tables, [SLOPE, LEVEL], [WAVE, STEP])
    records = result.as_dict()["gain"]["records"]
    assert {each["title"] for each in records} == {"a", "b", "flat"}
    ratios = [each["after"] / each["before"] for each in records]
    assert ratios == sorted(ratios, reverse=True)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([20.0, 150.0], "t 20 to 150 s"),
        ([1.7e9 + 0.5, 1.7e9 + 59.0], "t 1700000000.5 to 1700000059 s"),
        ([3.0, 3.0], "t 3 s"),
    ],
)
def test_a_setting_has_the_digits_of_its_spread(values, said):
    assert Settings({"t": (values, "s")}, len(values)).text("t", *values) == said


def test_a_condition_is_its_words_what_varies_most_and_what_is_unusual():
    columns = {"t": [1.0, 2.0, 3.0, 3.0], "u": [5.0, 5.0, 5.0, 9.0], "way": [*"abbb"]}
    settings = Settings({name: (values, "s") for name, values in columns.items()}, 4)
    assert settings.words == ["way a, t 1 s", "way b, t 2 s", "way b, t 3 s", "way b, t 3 s, u 9 s"]


@pytest.mark.parametrize(
    ("value", "sd", "said"),
    [
        (14.947, 0.7512, "14.95 ± 0.75"),
        (1.2231, 0.0943, "1.223 ± 0.094"),
        (1.2231, 0.0993, "1.22 ± 0.10"),
        (1512.0, 97.3, "1510 ± 100"),
        (2.2e-7, 3e-8, "(2.20 ± 0.30)·10⁻⁷"),
        (1.7e9 + 33.4, 0.14, "1700000033.40 ± 0.14"),
        (0.0, 0.02, "0.000 ± 0.020"),
        (3.0, float("nan"), "3"),
    ],
)
def test_an_amount_ends_at_the_second_digit_of_its_error(value, sd, said):
    assert amounts.amount(value, sd) == said


def test_what_is_in_the_set_is_not_said_to_be_unseen(results):
    numbers = numbers_of(results["ambiguous"])
    within, other = numbers["claimed"][0]["title"], "a draught"
    bound = {"relative": 2.0, "falls": False, "seen": True, "text": "0.2 m"}
    numbers["bounds"] = {name: {**bound, "cause": name, "title": name} for name in (within, other)}
    one = {"cause": "bump", "constants": ["slope"], "titles": ["slope"]}
    numbers["cannot_tell"]["hidden"] = [{**one, "title": within}]
    text = summary_text(numbers, results["ambiguous"].problem.words)
    assert f"Could be there unseen: {other} up to 0.2 m." in text
    assert "would not be seen" not in text
    numbers["claimed"] = []
    text = summary_text(numbers, results["ambiguous"].problem.words)
    assert "would not be seen: slope" in text


def test_what_is_left_is_said_of_the_model_that_leaves_it(results):
    result = results["unexplained"]
    numbers = {**numbers_of(result), "origin": []}
    numbers["leader"] |= {"left": ["an error of 3 m"], "share": 0.5}
    shown = page(numbers, figures_of(result), result.problem.words)
    assert f"Left beside {numbers['leader']['title']}: an error of 3 m." in shown
    numbers["leader"]["causes"] = []
    shown = page(numbers, figures_of(result), result.problem.words)
    assert "Left by the recalibrated model: an error of 3 m." in shown
