"""The first screen of a diagnosis: sizes and their intervals, drawings, and what is left over."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from report_page import Page
from stickslip import Scenario
from stickslip._util.number_text import alike
from stickslip.diagnosis import Prior, Uncertain
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.report.answers import Answers, answers
from stickslip.diagnosis.report.cause_words import Told, size_in_words
from stickslip.diagnosis.report.certainty import sure_of
from stickslip.diagnosis.report.constants import moved
from stickslip.diagnosis.report.drawings import drawing
from stickslip.diagnosis.report.headline import headline
from stickslip.diagnosis.report.messages import parameter_lines
from stickslip.facts import Code, Fact
from stickslip.facts.causes import CAUSES
from toy_model import like_the_simulators, shared_result


@pytest.mark.parametrize(
    ("value", "text", "interval"),
    [
        (0.5, "0.50 +- 0.10 mT, along +x", "0.304 to 0.696 mT"),
        (-0.5, "0.50 +- 0.10 mT, along -x", "0.304 to 0.696 mT"),
        (-0.1, "0.10 +- 0.10 mT, along -x", "0.296 mT along -x to 0.096 mT along +x"),
    ],
)
def test_an_interval_with_both_signs_has_both_words(value, text, interval):
    entry = {"value": 1e-3 * value, "sd": 1e-4, "unit": "T"}
    found = SimpleNamespace(profiles=())
    words = CAUSES["ambient_field"].sizes["Bx"]
    size = size_in_words(found, "effects.ambient_field.Bx", entry, words)
    assert (size.name, size.text, size.interval) == ("ambient_field.Bx", text, interval)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_interval_holds_its_value_where_both_signs_have_one_word(sign):
    entry = {"value": sign * 0.05, "sd": 0.1, "unit": "-"}
    words = CAUSES["friction_patches"].sizes["amplitude"]
    name = "effects.friction_patches.amplitude"
    size = size_in_words(SimpleNamespace(profiles=()), name, entry, words)
    low, high = (float(end) for end in size.interval.removesuffix(" %").split(" to "))
    assert low <= 100.0 * abs(entry["value"]) <= high
    # By the normal law 95 % are within 1.96 sd of 5 %, and the size is at least 0.
    assert (low, high) == (0.0, pytest.approx(5.0 + 1.96 * 10.0, abs=0.05))


def test_a_value_and_its_ends_are_printed_to_the_same_place():
    # By digits of their own, 12.346 would stand beside 12.3 to 12.3.
    assert alike(0.0012, 12.34567, 12.3433, 12.348) == ["12.3457", "12.3433", "12.348"]
    assert alike(3e-7, 1.0481e-5, 9.912e-6, 1.1e-5) == ["1.048e-05", "9.91e-06", "1.1e-05"]
    random = np.random.default_rng(0)
    for size in 10.0 ** random.uniform(-12.0, 12.0, 500):
        low, value, high = np.sort(size * (random.standard_normal() + 1e-3 * random.random(3)))
        shown = [float(each) for each in alike((high - low) / 4, low, value, high)]
        assert shown == sorted(shown)
        assert abs(shown[1] - value) < 0.02 * (high - low)


@pytest.mark.parametrize(
    ("low", "high", "fits"), [(0.35, 0.65, True), (0.45, 0.55, False), (0.45, 0.9, False)]
)
def test_an_error_that_contradicts_the_interval_is_not_told_beside_it(low, high, fits):
    entry = {"value": 5e-4, "sd": 1e-4, "unit": "T"}
    name = "effects.ambient_field.Bx"
    ends = (1e-3 * low, 1e-3 * high)
    profile = SimpleNamespace(name=name, interval=lambda _: ends)
    size = size_in_words(
        SimpleNamespace(profiles=(profile,)), name, entry, CAUSES["ambient_field"].sizes["Bx"]
    )
    assert (size.error_fits, size.way) == (fits, "along +x")
    # A sentence has the interval in its place.
    assert ("+-" in size.text, size.interval in size.text) == (fits, not fits)


def test_the_command_begins_with_the_sentence_of_the_page(tmp_path):
    found = shared_result(3, wave=1.0)
    found.save_report(tmp_path)
    first = found.verdict_lines()[0].replace(" +- ", " ± ")
    assert first == "named: " + Page(tmp_path / "report.html").headline.replace("\xa0", " ")


def test_the_command_has_the_keys_of_what_its_first_sentence_says_in_words():
    (line,) = parameter_lines(shared_result(3, wave=1.0).findings)
    value, low, high = re.fullmatch(
        r"  wave\.size = (\S+), with 95 % from (\S+) to (\S+)", line
    ).groups()
    assert float(low) < float(value) < float(high)
    uncertain = shared_result(0, split=0.4).findings
    causes, *sizes = parameter_lines(uncertain)
    assert causes == f"  the set: {', '.join(uncertain.verdict.causes)}"
    assert [each.split(" = ")[0].strip() for each in sizes] == [
        f"{each.name}.size" for fit in set_members(uncertain) for each in fit.candidate.causes
    ]
    assert parameter_lines(shared_result(3).findings) == []


@pytest.mark.parametrize(
    ("interval", "sure"), [((0.5, 9.0), True), ((-0.5, 9.0), False), ((-9.0, -0.5), True)]
)
def test_an_uncertain_gain_is_told_with_it(interval, sure):
    named = shared_result(3, wave=1.0)
    gain = replace(named.findings.gain, interval=interval)
    lines = replace(named, findings=replace(named.findings, gain=gain)).verdict_lines()
    (line,) = [each for each in lines if "chi-square per condition" in each]
    assert line.endswith("the interval of the gain includes 0") != sure


def test_an_arrow_points_the_way_that_was_found():
    words = {
        (each.drawing, way)
        for each in CAUSES.values()
        for size in each.sizes.values()
        for way in (size.up, size.down)
    }
    for name in ("ambient", "tilt", "moment", "camera"):
        ways = {way for drawn, way in words if drawn == name and re.match("along|down|nose", way)}
        assert len(ways) in (2, 4)
        assert len({drawing(name, way) for way in ways}) == len(ways), name


def test_each_of_several_drawings_has_the_name_of_its_cause_and_a_pair_has_two_or_none():
    def cause(name, picture):
        return Told(name, f"a {name}", "", "", picture, ())

    def drawn(*candidates):
        one = Fact(Code.WHAT_NOTHING, {})
        told = tuple(tuple(cause(*each) for each in causes) for causes in candidates)
        return [
            (each.name, "" if each.caption is None else each.caption.fields["name"])
            for each in Answers(one, told, None, (one,), (), (), (), ()).drawings
        ]

    assert drawn([("bend", "coil")]) == [("coil", "")]
    assert drawn([("bend", "coil"), ("wave", "coil")]) == [("coil", "A bend"), ("coil", "A wave")]
    assert drawn([("bend", "coil"), ("wave", "")]) == []
    assert drawn([("bend", "coil")], [("wave", "")]) == [("coil", "A bend")]


def test_what_is_left_above_the_noise_is_said():
    named = shared_result(3, wave=1.0)
    gain = replace(named.findings.gain, p_value=0.002)
    for found, expected in ((named.findings, 0), (replace(named.findings, gain=gain), 1)):
        codes = [each.code for each in sure_of(found, 6)]
        assert codes.count(Code.SURE_OF_REST) == expected


def of_toy(result):
    return result.posed, result.findings


def with_verdict(found, **changed):
    return replace(found, verdict=replace(found.verdict, **changed))


@pytest.mark.parametrize(
    ("probability", "said", "unsaid"),
    [
        (0.98, "^Probably one of these", "none of these"),
        (0.8, "^Probably one of .* a probability of 20 % it is none of these", "Perhaps"),
        (0.52, "^Perhaps one of .* a probability of 48 % it is none of these", "Probably"),
    ],
)
def test_the_headline_of_a_set_agrees_with_its_probabilities(probability, said, unsaid):
    posed, found = of_toy(shared_result(0, split=0.4))
    causes = found.verdict.causes
    shares = {each: probability / len(causes) for each in causes}
    text = str(headline(with_verdict(found, probabilities=shares), posed, "V"))
    assert re.search(said, text)
    assert unsaid not in text


@pytest.mark.parametrize(("code", "count"), [(Code.ALIKE, 1), (Code.NOT_SEPARATED, 0)])
def test_probabilities_of_causes_that_are_alike_are_no_choice(code, count):
    found = shared_result(0, split=0.4).findings
    names = list(found.verdict.causes)
    reason = Fact(code, {"causes": names, "limit": 0.9, "margin": 3.0})
    said = sure_of(with_verdict(found, reasons=(reason,)), 6)
    assert [each.code for each in said].count(Code.SURE_OF_ALIKE) == count


@pytest.mark.parametrize(
    ("p_value", "probability", "is_sure"),
    [(0.4, 0.8, True), (0.07, 0.8, False), (0.4, 0.5, False)],
)
def test_that_nothing_is_wrong_is_told_softly_where_it_is_not_sure(p_value, probability, is_sure):
    posed, found = of_toy(shared_result(3))
    shares = {**found.verdict.probabilities, "none": probability}
    found = with_verdict(found, probabilities=shares)
    found = replace(found, detection=replace(found.detection, p_value=p_value))
    code = headline(found, posed, "V").code
    assert code is (Code.HEADLINE_NONE if is_sure else Code.HEADLINE_NONE_OPEN)


def test_the_constants_that_have_moved_are_told_the_farthest_first():
    posed, found = of_toy(shared_result(3))
    x = found.null.x.copy()
    x[:4] = (0.5, -2.5, 1.5, -0.9)
    told = moved(replace(found, null=replace(found.null, x=x)), posed)
    assert [(each["name"], each["before"], each["pull"]) for each in told] == [
        ("k1", 0.0, -2.5),
        ("k2", 0.0, 1.5),
    ]
    x[:4] = 0.9
    assert moved(replace(found, null=replace(found.null, x=x)), posed) == []


def test_a_constant_of_a_range_has_moved_from_the_value_of_the_scenario():
    posed, found = of_toy(shared_result(3))
    drag = Uncertain("drag.linear", Prior("log-uniform", 1e-6, 1e-4), "N s/m")
    found = replace(found, problem=replace(found.problem, uncertain=(drag,)))
    scenario = Scenario()
    simulator = SimpleNamespace(scenario=scenario)
    (told,) = moved(found, replace(posed, simulator=simulator))
    assert (told["before"], told["pull"]) == (scenario.get("drag.linear"), None)
    (told,) = moved(found, posed)
    assert told["before"] is None


@pytest.mark.parametrize(("p_value", "count"), [(0.002, 1), (0.4, 0)])
def test_a_set_that_fails_on_held_out_data_is_asked_for_a_law_of_another_shape(p_value, count):
    posed, found = of_toy(shared_result(0, split=0.4))
    found = replace(found, gain=replace(found.gain, p_value=p_value))
    for simulator, expected in ((None, 0), (lambda *_: None, count)):
        said = answers(found, replace(posed, simulator=simulator), [], "V").do
        assert [each.code for each in said].count(Code.DO_FREE_SHAPES) == expected


@pytest.mark.parametrize(("interval", "count"), [((-0.5, 9.0), 1), ((0.5, 9.0), 0)])
def test_a_sure_cause_whose_gain_is_not_sure_has_too_few_conditions_for_that(interval, count):
    posed, found = of_toy(shared_result(3, wave=1.0))
    found = replace(found, gain=replace(found.gain, interval=interval))
    said = answers(found, posed, [], "V").better
    assert [each.code for each in said].count(Code.BETTER_TOO_FEW) == count


@pytest.mark.parametrize(
    ("is_narrow", "said"),
    [
        (
            False,
            r": larger by \d\.\d+ \+- 0\.\d+ %\. With a probability of 95 % it is \S+ to \S+ %\.$",
        ),
        (
            True,
            r": larger by (\d\.\d+) % \(best value\)\. "
            r"With a probability of 95 % it is (\S+) to (\S+) %\.$",
        ),
    ],
)
def test_a_size_has_its_best_value_after_the_word_for_its_sign(is_narrow, said):
    result = like_the_simulators("magnetization_scale", "fraction", "-", 0.03, 0.06)
    posed, found = of_toy(result)
    if is_narrow:
        # One standard deviation reaches beyond such an interval, and is not told beside it.
        name = found.profiles[0].name
        value = found.profiles[0].best
        narrow = SimpleNamespace(name=name, sd=1e-3, interval=lambda _: (value, value + 2e-5))
        found = replace(found, profiles=(narrow,))
    (size,) = answers(found, posed, [], "V").size
    match = re.search(said, str(size))
    assert match, str(size)
    if is_narrow:
        best, low, high = map(float, match.groups())
        assert low <= best <= high
