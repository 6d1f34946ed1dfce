"""Fields of what the page of a diagnosis says first, and what of them its sentences say."""

from stickslip.facts import Code, Fact

FELL = {"count": 8, "thing": "condition", "before": "13 %", "after": "1.4 %", "change": "falls"}
CHANGE = {"before": "13 % (2 mm/s)", "after": "1.4 % (0.2 mm/s)", "count": 1, "thing": "reading"}
FOUND = {"finding": "The wave is high.", "remedy": "Level it", "causes": 1, "readings": False}
SEVERAL = {**CHANGE, "leading": "a wave"}
PREDICTED = [{"name": "a wave", "velocity": -6.3e-4}, {"name": "a bend", "velocity": 2e-3}]

KNOWN = {"name": "pull of k", "unit": "uN", "before": 0.22, "after": 0.146, "pull": -2.46}
RANGE = {"name": "drag", "unit": "N s/m", "before": None, "after": 8.4e-5, "pull": None}

ANSWERS = {
    Code.HEADLINE_NAMED: (
        {**FOUND, **FELL}, r"^The wave is high\. Level it, or keep it .*: errors .* fall from 13 %"
    ),
    Code.HEADLINE_PAIR: (
        {**FOUND, **FELL, "remedy": "", "causes": 2, "change": "not sure"},
        r"^Two causes act together\. The wave is high\. Keep both .*; errors .* a gain, go from"
    ),
    Code.HEADLINE_PERHAPS: (
        {**FOUND, "reason": Fact(Code.AT_LIMIT, {"name": "wave"})}, "not certain: An amplitude"
    ),
    Code.HEADLINE_SET: (
        {"count": 2, "things": "causes", "names": ["a wave", "a bend"], "probability": 0.52},
        r"^Perhaps one of these 2 causes .* wave; a bend\. With .* 48 % it is none .*\. Measure",
    ),
    Code.HEADLINE_NEAREST: (
        {"count": 2, "things": "causes", "names": ["a wave", "a bend"], "other": 0.94},
        r"^Something .* 94 % it is nothing .*\. Of the causes .* 2 come nearest: a wave",
    ),
    Code.HEADLINE_NONE: (
        {"moved": [KNOWN, RANGE]},
        r"^Nothing is wrong .*: pull of k 0\.146 instead of 0\.22 uN; drag 8\.4e-05 N s/m\.",
    ),
    Code.HEADLINE_NONE_OPEN: (
        {"p_value": 0.075, "probability": 0.47, "moved": []},
        r"^Nothing was found .* not sure: .* 47 %, and p is 0\.075\. .* near what was stated\.",
    ),
    Code.HEADLINE_UNEXPLAINED: ({"count": 28}, "28 causes .* well enough.* which part"),
    Code.HEADLINE_NO_CAUSE: ({}, "no cause was given.* which part"),
    Code.HEADLINE_LAW: (
        {"law": "drag", "argument": "speed", **FELL, "change": "grows"}, "drag .* speed .* but"
    ),
    Code.HEADLINE_REFUSED: ({"reason": Fact(Code.ALL_ZERO, {})}, "no diagnosis. Every reading"),
    Code.WHAT_CAUSE: ({"name": "A wave", "meaning": "water"}, "A wave: water"),
    Code.WHAT_NOTHING: ({}, "Nothing"),
    Code.WHAT_MOVED: (
        {"moved": [KNOWN, RANGE]},
        r"pull of k from 0\.22 to 0\.146 uN \(2\.5 standard .* drag 8\.4e-05 N s/m \(within",
    ),
    Code.WHAT_UNKNOWN: ({}, "no cause that was tried"),
    Code.WHAT_DATA: ({}, "data"),
    Code.SIZE_OF_CAUSE: (
        {"name": "A wave", "size": "5 +- 1 mm", "interval": "3 to 7 mm"}, "A wave: 5 .* is 3 to 7"
    ),
    Code.SIZE_NOT_CERTAIN: (
        {"name": "A wave", "size": "4 mm"}, r"A wave: 4 mm \(best value\)\. .* not known, as fits"
    ),
    Code.SIZE_IN_INTERVAL: (
        {"name": "A wave", "size": "4 mm", "interval": "3 to 7 mm"},
        r"A wave: 4 mm \(best value\)\. .* 3 to 7 mm",
    ),
    Code.SIZE_OF_LAW: (
        {"law": "wind", "low": -0.5, "high": 1.5, "unit": "N"}, r"wind .* -0\.5 and 1\.5 N\."
    ),
    Code.SIZE_LIMITS: (
        {"percent": 95.0, "limits": ["a wave below 5 mm"]}, "best, .* 95 % .*: a wave below"
    ),
    Code.SIZE_HIDDEN: ({"name": "a bend", "size": "27 %"}, "a bend of up to 27 %"),
    Code.SIZE_UNLIMITED: ({"count": 3, "causes": 28}, "^3 of the 28 causes cannot be limited"),
    Code.SIZE_OF_MISFIT: ({"ratio": 3.4}, r"3\.4 times"),
    Code.SIZE_UNKNOWN: ({}, "no model"),
    Code.SURE_OF_CAUSE: (
        {"names": ["a wave", "a bend"], "probabilities": [0.75, 0.9999], "count": 28},
        r"28 causes, no cause .*: the probability is 75 % for a wave, more than 99\.9 % for a bend",
    ),
    Code.SURE_OF_CLOSE: ({"odds_needed": 20.09}, "odds of 20 to 1 are needed"),
    Code.SURE_OF_ALIKE: ({}, "before the measurement"),
    Code.SURE_OF_RUNNER_UP: ({"name": "a bend", "lead": 3.0}, "a bend, is 20 times less"),
    Code.SURE_OF_MISFIT: ({"p_value": 1e-20}, "less than 1e-12"),
    Code.SURE_OF_NOTHING: (
        {"p_value": 0.28, "level": 0.05, "before": 0.5, "probability": 0.57},
        r"explains the data: .* 0\.28, .* below 0\.05 .* 50 % before any data, and is 57 %",
    ),
    Code.SURE_OF_LAW: ({"lead": 20.0, "band": 90.0}, "more than a million times .* 90 %"),
    Code.SURE_OF_REST: (
        {"where": "after the fit", "p_value": 0.002, "level": 0.05},
        r"left after the fit .* only 0\.002, and less than 0\.05 is taken",
    ),
    Code.SURE_OF_REFUSAL: ({}, "checks of the data"),
    Code.DO_REMEDY: ({"remedy": "Level it"}, "Level it"),
    Code.DO_KEEP: ({"model": "extended.toml", "first": False}, r"Or go on with extended\.toml"),
    Code.DO_KEEP_ROBOT: ({"model": "extended.toml"}, "extended.toml, .* readings is not in it"),
    Code.DO_VALUES: ({}, r"report\.json, under .parameters."),
    Code.DO_EXPERIMENT: (
        {"settings": "mode OPP", "predicted": PREDICTED, "why": Fact(Code.NO_SAFE_NAME, {})},
        r"mode OPP\. Predicted is -0\.63 mm/s with a wave, 2 mm/s with a bend\. No name",
    ),
    Code.DO_MEASURE_MORE: ({}, "repeat"),
    Code.DO_CONFIRM: ({"model": "extended.toml"}, r"extended\.toml"),
    Code.DO_LEADING: (
        {"model": "extended.toml", "name": "a wave"}, r"extended\.toml is .* leading .* a wave"
    ),
    Code.DO_FREE_SHAPES: ({}, "--free-shapes"),
    Code.DO_LOOK: ({}, "misfit is largest"),
    Code.DO_CORRECT: ({}, "again"),
    Code.BETTER_FALLS: (CHANGE, r"1 reading not used .* falls from 13 % \(2 mm/s\) to 1\.4 %"),
    Code.BETTER_NOT_SURE: (CHANGE, "may be chance"),
    Code.BETTER_TOO_FEW: ({"count": 8, "thing": "condition"}, "^8 conditions are too few"),
    Code.BETTER_WORSE: (SEVERAL, "fit, with a wave, the leading one, grows from"),
    Code.BETTER_IN_FIT: (CHANGE, "too few"),
    Code.BETTER_CONSTANTS: (CHANGE, r"13 % .* 1\.4 %"),
    Code.BETTER_ALONE: (CHANGE, r"no other .* 1\.4 %"),
    Code.BETTER_UNKNOWN: (CHANGE, r"none explains .* well enough; .* 1\.4 %"),
    Code.BETTER_NO_MODEL: ({}, "No model"),
}  # fmt: skip
