"""The first screen of a diagnosis: sizes and their intervals, drawings, and what is left over."""

import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

from report_page import Page
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.report.answers import Answers
from stickslip.diagnosis.report.cause_words import Told, size_in_words
from stickslip.diagnosis.report.certainty import sure_of
from stickslip.diagnosis.report.drawings import drawing
from stickslip.diagnosis.report.messages import parameter_lines
from stickslip.facts import Code, Fact
from stickslip.facts.causes import CAUSES
from toy_model import shared_result


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
