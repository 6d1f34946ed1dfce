"""Every fact that a measurement or a diagnosis can tell has one full sentence with its numbers."""

import json
import re
from pathlib import Path

import pandas as pd
import pytest

from answer_examples import ANSWERS
from stickslip import Measurement, Prior, Scenario
from stickslip.facts import Code, Fact
from stickslip.facts.sentences import SENTENCES

SOURCES = Path(__file__).parents[1] / "python" / "stickslip"
FILE = {"table": "a.csv"}
LINES = {**FILE, "lines": [3, 5], "count": 2}
FAR = {
    "ratio": 1234.0, "measured": 1.5, "usual": 0.5, "unit": "m", "allowed": [0.02, 50.0],
    "unit_factor": 1e3,
}  # fmt: skip
FEW = {"origin": "repeats", "dof": 7, "taken": 0.25, "unit": "T"}
COLUMN = {**FILE, "column": "z", "unit": "m"}
LOOK = {"seen": ["tilt"], "unseen": ["a", "b", "c", "d", "e", "f"]}
WAYS = {"forward": 1.25, "reverse": -2.5, "total": -1.5, "t": 4.5}

# Fields of each code, and what of them its sentence says.
EXAMPLES = {
    Code.ROWS_LEFT_OUT: ({**FILE, "count": 3, "rows": 4}, "3 of 4 rows"),
    Code.CELL_COUNT: ({**LINES, "cells": 6, "columns": 7}, "lines 3, 5: a row of 6 cells .* 7"),
    Code.NOT_A_NUMBER: ({**LINES, "column": "hold", "cell": "x"}, 'lines 3, 5: hold "x"'),
    Code.REPEATED_ROW: ({**LINES, "count": 9}, "lines 3, 5, ...: "),
    Code.SETTING_REFUSED: ({**LINES, "refusal": "k = 3: allowed is 4"}, "5: k = 3: allowed is 4"),
    Code.SETTING_TOO_LARGE: (
        {**LINES, "key": "hold", "value": 0.6, "unit": "T", "limit": 0.1, "other": "mT"},
        "hold of 0.6 T is above 0.1 T; if it is in mT",
    ),
    Code.SETTING_TOO_SMALL: (
        {**LINES, "key": "pace", "value": 0.03, "unit": "Hz", "limit": 0.2, "other": "kHz"},
        "pace of 0.03 Hz is below 0.2 Hz; if it is in kHz",
    ),
    Code.OUTLIER: (
        {**FILE, "velocity": 0.5, "others": 5e-4, "unit_factor": 1e3},
        r"0\.5 m/s .* 0\.0005 m/s; the factor of 1000",
    ),
    Code.EQUAL_SETTINGS: (
        {**FILE, "column": "frequency", "count": 2, "relative": 1e-6},
        "frequency has 2 values within 1e-06 of another",
    ),
    Code.TOO_FAST: ({**LINES, "limit": 1.0}, "above 1 m/s; .* mm/s"),
    Code.BAD_CELLS: ({**LINES, "rows": 18}, r"2 of 18 rows .* \(lines 3, 5\)"),
    Code.COMMENTS: ({**FILE, "count": 2}, "2 lines below the header"),
    Code.EMPTY_COLUMNS: ({**FILE, "count": 1}, "1 empty column without"),
    Code.COLUMNS_NOT_USED: ({**FILE, "columns": ["date", "room"]}, "only: date and room"),
    Code.GAPS: ({**FILE, "count": 17, "column": "z"}, "column z has 17 cells"),
    Code.NO_SOUND_ROW: ({**FILE, "why": Fact(Code.REPEATED_ROW, LINES)}, "sound. .* repeats"),
    Code.FRAMES_SORTED: (FILE, "order of time"),
    Code.REPEATED_TIMES: ({**FILE, "count": 1}, "1 left out"),
    Code.FRAMES_AFTER_DRIVE: ({**FILE, "count": 6, "end": 0.13}, r"0\.13 s.* 6 left out"),
    Code.FRAMES_NOT_NEEDED: ({**FILE, "count": 900, "used": 200}, "first 200 of 900"),
    Code.FRAME_RATE_NOT_USED: (
        {**FILE, "stated": 500.0, "spacing": 0.001}, r"500 Hz .* 0\.001 s"
    ),
    Code.RUN_TOO_SHORT: (
        {**FILE, "count": 10, "start": 0.15, "end": 0.45, "needed": 20},
        r"10 sound frames from 0\.15 s to 0\.45 s.*20 are needed",
    ),
    Code.RUN_ANGLE_UNIT: ({**FILE, "theta": 45.0, "limit": 6.28}, r"near 45.* 6\.28.* degrees"),
    Code.RUN_LENGTH_UNIT: (
        {**FILE, "span": 2.5, "limit": 0.1, "meant": "mm"}, r"2\.5.* 0\.1.* be mm"
    ),
    Code.RUN_TIME_UNIT: (
        {**FILE, "spacing": 0.5, "last": 900.0, "meant": "ms", "factor": 1e3},
        r"0\.5 apart and up to 900, are ms; .* by 1000",
    ),
    Code.RUN_STANDS_STILL: (FILE, "ever changes"),
    Code.COLUMN_TOO_SHORT: ({**COLUMN, "count": 5, "needed": 20}, "column z .* 5 numbers; 20"),
    Code.COLUMN_SIZE: (
        {**COLUMN, "what": "spread", **FAR},
        r"spread is about 1\.23e\+03 times .*1\.5 against 0\.5 m; allowed is 0\.02 to 50 .*1000",
    ),
    Code.WILD_FRAMES: ({**COLUMN, "count": 2, "time": 0.17}, r"2 frames .* in z.* 0\.17 s"),
    Code.ANGLE_BEYOND_TURN: ({**FILE, "theta": 55.0}, "55 rad"),
    Code.LONELY_ANGLE: ({**FILE, "theta": 1.5, "Bx": 0.1, "Bz": 0.2}, r"1\.5 .* 0\.1 T.* 0\.2 T"),
    Code.PROBES_ON_WIRE: ({**FILE, "count": 1}, "wire of a coil .* 1 left out"),
    Code.FAR_FIELD: (
        {**FILE, "field": [0.1, 0.0, 0.2], "currents": [1.0, 2.0, 0.0, 0.0, 3.0]},
        r"\(0\.1, 0, 0\.2\) T .* \(1, 2, 0, 0, 3\) A",
    ),
    Code.CONDITION_NOT_COMPUTED: ({"condition": "hold 1 mT", "settings": {}}, "hold 1 mT"),
    Code.NOISE_STATED: ({"dof": 2, "needed": 4, "stated": 0.01}, r"2 degrees .* 4 are .* 0\.01"),
    Code.NOISE_UNKNOWN: ({"dof": 2, "needed": 4}, "2 degrees of freedom, where 4"),
    Code.SETUPS: ({"count": 3, "shift": 0.5, "gain": 1.5}, r"3 .* 0\.5 times .* 1\.5 times"),
    Code.NO_BLOCK_COLUMN: ({}, "column block"),
    Code.ONE_BLOCK: ({}, "only one set-up"),
    Code.SETUPS_NOT_CROSSED: ({}, "another set-up"),
    Code.ERRORS_CORRELATED: (
        {"value": 0.612, "low": 0.4, "high": 0.8, "origin": "repeats", "readings": 60,
         "effective": 21.4},
        r"0\.61 \(0\.40 to 0\.80, from repeats\), .* 60 .* 21 independent",
    ),
    Code.ERRORS_INDEPENDENT: (
        {"value": 0.1, "low": -0.2, "high": 0.3, "origin": "smooth curves"},
        r"0\.10 \(-0\.20 to 0\.30, from smooth curves\).*independent",
    ),
    Code.CORRELATION_UNKNOWN: ({"free": 5, "needed": 8}, "5 degrees .* 8 .*independent"),
    Code.CURVES_NOT_SMOOTH: ({"ratio": 2.25}, r"2\.2 times .*independent"),
    Code.UNEVEN_SETUP: (
        {"setup": 3, "ratio": 2.5, "p_value": 1e-5}, r"set-up 3.* 2\.5 times .* 1e-05"
    ),
    Code.MODEL_JUMPS: ({"count": 2}, "2 conditions"),
    Code.NO_RESPONSE: ({"causes": ["slip", "lag"]}, "changes with slip and lag: they say nothing"),
    Code.STATED_RUNS: (
        {"note": "flight", "text": "2 of 9 conditions: in flight"},
        "stated model: 2 of 9 conditions: in flight",
    ),
    Code.FEW_PULSES: ({"count": 2, "needed": 4}, "2 conditions .* fewer than 4 pulses"),
    Code.STANDS_STILL: (
        {"count": 6, "speed": 1e-3, "conditions": ["f 20 Hz", "f 21 Hz"]},
        "zero at 6 conditions .* 1 mm/s: f 20 Hz; f 21 Hz and 4 more",
    ),
    Code.READING_NOISE: ({**FILE, **FEW, "sd": 0.125}, r"0\.12 T.*7 degrees.*0\.25 T"),
    Code.READING_NOISE_SMALL: ({**FILE, **FEW}, r"7 degrees .* 0\.25 T"),
    Code.READING_NOISE_UNKNOWN: ({**FILE, **FEW, "needed": 4}, r"7 degrees .* 4 .* 0\.25 T"),
    Code.FRAME_NOISE: ({**COLUMN, "scatter": 0.5, "taken": 0.6}, r"z .* 0\.5 m; 0\.6 m"),
    Code.FRAME_NOISE_ABOVE_STATED: (
        {**COLUMN, "scatter": 0.5, "stated": 0.4}, r"z .* 0\.5 m .* 0\.4 m"
    ),
    Code.FRAME_NOISE_UNKNOWN: ({**COLUMN, "taken": 0.6}, r"z .* 0\.6 m"),
    Code.FRAMES_CORRELATED: (
        {**COLUMN, "value": 0.612, "low": 0.4, "high": 0.8}, r"z .* 0\.61 \(0\.40 to 0\.80\)"
    ),
    Code.ROUNDED_COLUMN: ({**COLUMN, "step": 0.5, "taken": 0.14}, r"z .* 0\.5 m; .* 0\.14 m"),
    Code.PERIODS_DIFFER: ({**COLUMN, "scatter": 0.5}, r"z .* 0\.5 m"),
    Code.ADVANCE_SCATTERS: ({**COLUMN, "scatter": 0.5}, r"z .* 0\.5 m"),
    Code.STATED_PROBLEM: ({"problem": "Nothing moves."}, "Nothing moves.$"),
    Code.ALL_ZERO: ({}, "zero"),
    Code.TOO_FEW_CONDITIONS: ({"count": 1, "needed": 4}, "1 condition is .* 4 are needed"),
    Code.NO_NOISE: ({}, "velocity_sd"),
    Code.CONDITIONS_ALIKE: ({"ratio": 1.5, "needed": 3.0}, r"1\.5 times .* 3 times"),
    Code.ROUNDED: ({"percent": 60.0, "limit": 40.0}, "60 % .*40 %"),
    Code.DRIFT: ({"p_value": 1e-5, "level": 0.002}, r"1e-05, below 0\.002"),
    Code.NOTHING_COMPUTED: (
        {"refusal": "b.static = 0.2 is too low"},
        r"uncertain: b.static = 0.2 is too low; change the scenario, or narrow .* \[uncertain\]",
    ),
    Code.VELOCITIES_SIZE: (FAR, "about .* times what the stated model gives"),
    Code.VELOCITY_SIZE: ({**FAR, "condition": "hold 1 mT"}, "of hold 1 mT is about .* fastest"),
    Code.OPPOSITE_SIGN: ({"cosine": -0.9, "limit": -0.8}, r"opposite sign .*-0\.9, below -0\.8"),
    Code.SPEEDS: ({}, "speeds"),
    Code.REVERSED: ({"setting": "mode", "value": "OPP"}, "mode is OPP"),
    Code.NOTHING_DETECTED: ({"p_value": 0.3, "level": 0.05}, r"lack-of-fit .* 0\.3 .* 0\.05"),
    Code.RUNNER_UP: ({"name": "none", "lead": 4.5}, r"no cause at all, is behind by 4\.5"),
    Code.OTHER_LEADS: ({"name": "wave", "lead": 4.5}, r"wave .* 4\.5"),
    Code.OTHER_LEADS_UNEXPLAINED: (
        {"name": "wave", "lead": 4.5, "level": 0.01}, r"wave.* 4\.5 .* 0\.01"
    ),
    Code.NEAREST: (
        {"name": "wave", "chi2": 90.0, "recalibrated": 300.0, "observables": 24},
        "wave .* 90 for 24 .* 300",
    ),
    Code.ALIKE: ({"causes": ["wave", "bend"], "limit": 0.9}, r"wave and bend .* 0\.9"),
    Code.NOT_SEPARATED: ({"causes": ["wave", "bend"], "margin": 3.0}, "wave and bend: .* 3 "),
    Code.SEVERAL_PAIRS: (
        {"count": 2, "pairs": ["a + b", "a + c"], "margin": 3.0}, r"2 pairs .* 3 .*: a \+ b and a"
    ),
    Code.LITTLE_EVIDENCE: ({"name": "wave", "lead": 1.5, "margin": 3.0}, r"wave is 1\.5 .* 3 is"),
    Code.STARTS_DISAGREE: ({"name": "wave"}, "wave"),
    Code.NOT_PREDICTED_BETTER: ({"name": "wave"}, "wave"),
    Code.AT_LIMIT: ({"name": "wave"}, "wave"),
    Code.TABLE_CONTRADICTS: (
        {"kind": "angle", "name": "wave", "level": 0.005}, r"angle contradict wave.* 0\.005"
    ),
    Code.TRAINING_SUBSET: ({"name": "none"}, "no cause at all would lead"),
    Code.SMOOTH_REST: ({"name": "wave", "percent": 40.0, "needed": 70.0}, "wave .* 40 % .* 70 %"),
    Code.NO_EXPLANATION: ({"level": 0.01}, r"0\.01"),
    Code.LESS_LIKELY: ({"explaining": "wave", "name": "bend"}, "wave, .* bend, which does not"),
    Code.PAIR_LEADS_TOO_LITTLE: (
        {"name": "a + b", "lead": 4.5, "needed": 6.7}, r"a \+ b leads by 4\.5 .* 6\.7"
    ),
    Code.ERRORS_CONTRADICTED: (
        {"name": "wave", "errors": 5.25, "level": 1e-3}, r"wave one .* 5\.2 errors .* 0\.001"
    ),
    Code.MAY_BE_CORRELATED: (
        {"name": "wave", "correlation": 0.4, "lead": 1.5, "margin": 3.0},
        r"by 0\.40, .* of wave .* \+1\.5, .* needs \+3",
    ),
    Code.CONSTANT_PULLED: (
        {"name": "wave", "constant": "slope", "pull": -3.25, "limit": 2.5},
        r"wave, slope has to be -3\.2 standard .* 2\.5",
    ),
    Code.NOTHING_LEFT: (
        {"name": "wave", "other": "bend", "lead": 1.5, "needed": 6.7}, r"bend, adds 1\.5 .* 6\.7"
    ),
    Code.NO_FREE_SHAPE: (
        {"law": "drag", "argument": "speed", "lead": 1.5, "p_value": 1e-5, "level": 0.01},
        r"drag over speed, is 1\.5 above .* p = 1e-05; a p of 0\.01 is",
    ),
    Code.FREE_SHAPE: (
        {"law": "drag", "argument": "speed", "lead": 15.0, "band": 90.0},
        r"drag depends on speed .* 15\.0 above .* 90 %",
    ),
    Code.FREE_SHAPE_MEANING: (
        {"law": "drag", "argument": "speed", "unit": "m/s", "told": (0.25, 0.5), "size": "|u|",
         "reach": 0.75},
        r"drag is .* times 1 \+ f\(u\), .* speed in m/s.* from 0\.25 to 0\.5 m/s; .* "
        r"\|u\| is above 0\.75 m/s",
    ),
    Code.FREE_TERM_MEANING: (
        {"law": "wind", "argument": "speed", "unit": "m/s", "told": None, "low": -0.5, "high": 2.0,
         "own": "N"},
        r"wind is f\(u\) in N, .* speed in m/s.*\. Below -0\.5 and above 2 m/s it is held constant",
    ),
    Code.FREE_SHAPE_RIVALS: (
        {"law": "drag", "argument": "speed", "others": ["drag over tilt", "field over time"]},
        "drag over tilt and field over time .* drag over speed",
    ),
    Code.FREE_SHAPE_GAIN: (
        {"before": 25.0, "after": 1.25, "count": 8, "certain": False},
        r"8 held-out .* 25\.0 without .* 1\.2 with it; its interval includes no gain",
    ),
    Code.FREE_SHAPE_FORMULA: (
        {
            "formula": "f(u) = a u with a = 3 per K", "argument": "warmth", "unit": "K",
            "origin": 280.0, "lead": 4.25, "others": ["a", "a u^2"],
        },
        r"less 280 K: f\(u\) = a u .* per K; .* 4\.2 above .*; nearly as likely: a and a u\^2",
    ),
    Code.LAW_BESIDE_CAUSES: (
        {"law": "drag", "argument": "speed", "name": "a + b", "lead": -5.04},
        r"drag over speed, .* as well as a \+ b, .* -5\.0 beside it",
    ),
    Code.PAIR_NEEDED: ({"name": "a + b"}, r"a \+ b"),
    Code.NAME_SAFE: (
        {"name": "a", "margin": 3.0},
        "a is safe, .* it by at least 3",
    ),
    Code.NEAR_RIVAL: (
        {"name": "a", "rival": "b + c", "lead": 1.25, "needed": 3.0},
        r"a is not safe: b \+ c is 1\.2 behind .* and 3 behind would be enough",
    ),
    Code.NO_SAFE_NAME: ({}, "ambiguous"),
    Code.NOTHING_TO_SEPARATE: ({"verdict": "unexplained"}, "verdict unexplained there are no"),
    Code.SEPARATES: (
        {"first": "a", "second": "b", "chi2": 5.5, "trials": 3, "needed": 4.0},
        r"separates a from b: with 3 trials their .* lie 2\.3 standard errors apart; 2 would be e",
    ),
    Code.SEPARATES_TOO_LITTLE: (
        {"first": "a", "second": "b", "chi2": 1.5, "trials": 3, "needed": 4.0},
        r"a from b too little: with 3 trials their .* lie 1\.2 standard errors apart; 2 would be n",
    ),
    Code.NONE_SEPARATES: ({"trials": 3}, "3 trials"),
    **{code: (LOOK, "tilt.* a, b, c, d and 2 more") for code in Code if code.name[:4] == "LOOK"},
    Code.MISFIT_EVEN: ({"contrast": 2.0}, "2 times"),
    Code.MISFIT_UNEVEN: (
        {"parts": [{"part": "OPP", "misfit": 7.3, "other": "IPP", "misfit_of_other": 1.1}]},
        r"OPP \(7\.3, against 1\.1 in IPP\)",
    ),
    Code.VELOCITIES_UNCHANGED: ({}, "hardly"),
    Code.VELOCITIES_FASTER: ({}, "faster throughout"),
    Code.VELOCITIES_SLOWER: ({"causes": 2}, "^With both .* slower throughout"),
    Code.VELOCITIES_SHIFTED: ({"direction": "-x"}, "towards -x throughout"),
    Code.VELOCITIES_MIXED: (
        {"faster": ["IPP +x", "IPP -x"], "slower": ["OPP +x"]},
        r"faster in IPP \+x and IPP -x and slower in OPP \+x",
    ),
    Code.CONSTANT_CHANGES: (
        {"name": "k", "first": "IPP", "second": "OPP", "gap": 4.5, "limit": 2.5},
        r"k differs between IPP and OPP by 4\.5 .* 2\.5",
    ),
    Code.TRADE_OFF: ({"names": ["k", "l"]}, "k and l"),
    Code.LITTLE_KNOWN: ({"name": "k"}, "k"),
    Code.ANGLE_MISFIT: (
        {"recalibrated": 0.0174533, "extended": 0.00872665}, r"1\.00 degrees.* 0\.50 degrees"
    ),
    Code.ANGLE_MODEL: ({}, "magnetic torque"),
    Code.NO_ANGLE_WITHOUT_FIELD: ({"percent": 5.0}, "5 %"),
    Code.FIELD_MISFIT: (
        {"recalibrated": 5e-6, "extended": None, "largest": 2e-3}, r"5 uT \(.* 2 mT"
    ),
    Code.NO_SMOOTHED_MOTION: ({}, "frames"),
    Code.ADVANCE: (
        {"measured": 1.5e-5, "sd": 1e-7, "recalibrated": 2.5e-5, "extended": 1.25e-5},
        r"15 ± 0\.1 um, .* 25 um, .*extended.* 12\.5 um",
    ),
    Code.NO_DRIFT_OF_PERIODS: ({}, "nothing drifts"),
    Code.DRIFT_OF_TILT: ({"value": 0.25, "sd": 0.5}, r"tilt .* 0\.25 ± 0\.5 rad"),
    Code.DRIFT_OF_ADVANCE: ({"value": 0.25, "sd": 0.5}, r"advance .* 0\.25 ± 0\.5 m"),
    Code.DIRECTIONS_TOO_SHORT: ({}, "too short"),
    Code.DIRECTIONS_CANCEL: (WAYS, r"1\.25 m and -2\.5 m, .* 4\.5"),
    Code.DIRECTIONS_DIFFER: (WAYS, r"1\.25 m and -2\.5 m, .* -1\.5 m .* 4\.5"),
    **ANSWERS,
}  # fmt: skip


def test_every_code_has_a_sentence_and_an_example():
    assert set(SENTENCES) == set(Code) == set(EXAMPLES)


@pytest.mark.parametrize("code", Code, ids=lambda code: code.value)
def test_it_is_one_full_sentence_with_the_numbers_in_it(code):
    fields, said = EXAMPLES[code]
    sentence = str(Fact(code, fields))
    assert re.search(said, sentence), sentence
    # It begins with a capital, a number or the name of a file, and ends with a full stop.
    assert re.match(r"[A-Z0-9]|a\.csv[: ]", sentence), sentence
    assert re.search(r"[^.]\.$", sentence), sentence
    assert not re.search(r"  |[{}]|\bNone\b|\bnan\b|Code\.|\n", sentence), sentence
    assert sentence.count("(") == sentence.count(")")


def test_a_prior_whose_middle_no_scenario_has_is_named_with_what_to_do():
    table = pd.DataFrame({"frequency": [20.0, 30.0], "velocity": [1e-3, 1.1e-3]})
    wide = {"contact.kinetic_friction": Prior("log-uniform", 0.15, 0.3)}
    refusal = Measurement.from_dataframe(table, Scenario(), wide).refusal()
    said = str(Fact(Code.NOTHING_COMPUTED, {"refusal": refusal}))
    # The middle of a log-uniform prior is the root of 0.15 * 0.3 = 0.045.
    assert "contact.kinetic_friction = 0.2121" in said
    assert "raise contact.static_friction, or narrow the prior" in said
    narrow = {"contact.kinetic_friction": Prior("log-uniform", 0.15, 0.19)}
    assert Measurement.from_dataframe(table, Scenario(), narrow).refusal() is None


@pytest.mark.parametrize("code", Code, ids=lambda code: code.value)
def test_every_code_is_used_somewhere(code):
    users = [
        path for path in SOURCES.rglob("*.py")
        if path.parent.name != "facts" and re.search(rf"Code\.{code.name}\b", path.read_text())
    ]  # fmt: skip
    assert users


def test_a_fact_goes_into_json_with_its_code_and_its_fields():
    row = Fact(Code.REPEATED_ROW, {"lines": [3], "count": 1}).of(table="a.csv")
    fact = Fact(Code.NO_SOUND_ROW, {"table": "a.csv", "why": row})
    inside = {"code": "repeated-row", "fields": {"table": "a.csv", "lines": [3], "count": 1}}
    expected = {"code": "no-sound-row", "fields": {"table": "a.csv", "why": inside}}
    assert json.loads(json.dumps(fact.as_dict())) == expected


def test_what_a_file_holds_is_escaped_in_a_sentence_and_whole_in_the_fields():
    fact = Fact(Code.FRAMES_SORTED, {"table": "a\x1b.csv"})
    assert str(fact).isprintable()
    assert fact.fields["table"] == "a\x1b.csv"


def test_a_number_is_not_compared_with_a_limit_that_a_sentence_has_of_its_own():
    # Any other limit in the fields changes the sentence.
    names = {"limit", "needed", "level", "margin", "contrast", "trials"}
    found = 0
    for code, (fields, _) in EXAMPLES.items():
        for name in names & set(fields):
            other = Fact(code, {**fields, name: fields[name] + 11})
            assert str(other) != str(Fact(code, fields)), (code, name)
            found += 1
    assert found > 20
