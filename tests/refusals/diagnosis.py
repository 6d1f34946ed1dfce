"""Refusals of a diagnosis, its data, terms and result: name, call, error, words."""

import functools
import math

import numpy as np
import pandas as pd

import made_findings as made
from made_velocities import drives
from made_velocities import measurement as measured
from stickslip import (
    Cause,
    Drive,
    Parameter,
    Prior,
    Scenario,
    ScenarioError,
    Series,
    Table,
    Waveform,
    diagnose,
    diagnose_model,
    events,
    free_law,
    instruments,
    propose_experiments,
)
from stickslip.diagnosis.data.series import with_repeats
from stickslip.diagnosis.model import Values, posed
from stickslip.diagnosis.terms.laws import Curves, beside_constants
from stickslip.walker.problem import posed_by
from stickslip.walker.velocity import drive_settings
from toys import LEVEL, SLOPE, WAVE, line
from toys import data as table_of

X, ROW = np.linspace(1.0, 3.0, 12), np.ones(3)
HEIGHT = Parameter("wave.height", size=0.5, low=-5.0, high=5.0)
LAW = free_law("pull", "gap", "m", 0.0, 1.0)
ABOVE_0, FROM_0 = "allowed is a number above 0", "allowed is a whole number from 0"

TABLES = [
    (lambda: Table({"x": ROW}, [math.nan] * 3), "table: rows 0, 1, 2: every row has a gap"),
    (lambda: Table({"x": []}, []), ["y = ", "one row"]),
    (lambda: Table({"x": ROW}, np.ones(4)), "settings x: allowed are 4 rows"),
    (lambda: Table({"x": [1.0, math.inf, 2.0]}, ROW), "settings x: row 1 = inf: allowed is"),
    (lambda: Table([[1.0, "a"], [2.0, "b"]], [1.0, 2.0]), "settings: texts beside numbers"),
    (lambda: Table([[1.0], [2.0, 3.0]], [1.0, 2.0]), "settings 0 = [[1.0], [2.0, 3.0]]: allowed"),
    (lambda: Table({"x": ROW}, ROW, sd=0.0), f"sd = 0.0: {ABOVE_0}, or 3 of"),
    (lambda: Table({"x": ROW}, ROW, sd="small"), 'sd = "small": allowed is finite numbers'),
    (lambda: Table({"x": ROW}, ROW, block=[1, 2]), "block: allowed is one for each of 3"),
]

T3, Y3 = [0.0, 1.0, 2.0], [1.0, 2.0, 3.0]
RECORDS = [
    (lambda: Series([0, 1, 1], Y3, name="a"), "a: t: row 2 = 1.0: allowed is a time after 1.0"),
    (lambda: Series(T3, [1, 2]), "series: y: 2 values; allowed are 3"),
    (lambda: Series([0, np.nan, 2], Y3), "series: t: row 1 = nan: allowed is one row of finite"),
    (lambda: Series(T3, Y3, {"u": [1, 2, np.inf]}), "inputs u: row 2 = inf: allowed is"),
    (lambda: Series(T3, Y3, [1, 2, 3]), ["inputs = ", ": allowed is a table of rows"]),
    (lambda: with_repeats([Series(T3, Y3, name="a", repeat_of="b")]), 'repeat_of = "b": allowed'),
    (lambda: with_repeats([Series(T3, Y3, name="a"),
                           Series([0, 1, 3], Y3, name="b", repeat_of="a")]),
     "series b: repeat_of = a: row 2: t = 3: allowed is the same time, 2"),
    (lambda: posed(Series(X, X, {"u": X}), lambda record, p: record["u"], [SLOPE],
                   [instruments.lag(1.0, input="v")]),
     "cause lag: input = v: allowed is an input: u"),
    (lambda: posed(Series(X, X, {"u": X}, unit="K"), lambda record, p: record["u"],
                   [SLOPE], [events.step(0.1, 0.0, 2.0, unit="mK")]),
     "cause step: unit = mK: allowed is that of the readings, K"),
    (lambda: events.step(0.1, 3.0, 2.0), "begin = 3.0, end = 2.0: allowed is begin < end"),
]  # fmt: skip


def flat(table, p):
    return p["slope"] * table["x"]


def own(**changes):
    """A diagnosis of a line by a line."""
    given = {"predict": flat, "data": Table({"x": X}, X, sd=0.1, name="line")}
    return diagnose_model(**{**given, "uncertain": [SLOPE], "causes": [WAVE], **changes})


OWN = [
    ({"predict": 3}, "predict = 3: allowed is a function of (table, p)"),
    ({"predict": lambda p: p}, "predict takes (p): allowed is a function of (table, p)"),
    ({"causes": [LAW]}, "predict takes (table, p): allowed is a function of (table, p, curves)"),
    ({"predict": lambda t, p: flat(t, p)[0]},
     ["returned shape (12,) for table line at slope = 1", "here (1, 12)"]),
    ({"predict": lambda t, p: "fast"}, "its answer = \"fast\": allowed is"),
    ({"predict": lambda t, p: flat(t, p) * math.nan}, "it computes no reading"),
    ({"predict": lambda t, p: np.where(np.arange(12) % 4 == 1, math.nan, flat(t, p))},
     "predict: table line: rows 1, 5, 9: the model without causes computes no reading"),
    ({"predict": lambda t, p: p["slop"]}, 'p: there is no parameter slop; did you mean "slope"'),
    ({"data": []}, "data = []: allowed is a Table"),
    ({"data": [Table({"x": X}, X, sd=0.1)] * 2}, "tables: no name comes twice"),
    ({"uncertain": SLOPE}, ["uncertain = ", ": allowed is a list of Parameter"]),
    ({"uncertain": [SLOPE, 0.3]}, ["uncertain = ", ": allowed is a list of Parameter"]),
    ({"uncertain": [HEIGHT]}, "uncertain: wave.height has no prior"),
    ({"uncertain": [SLOPE, SLOPE]}, "slope comes twice"),
    ({"causes": [HEIGHT]}, ["causes = ", ": allowed is a list of Cause"]),
    ({"causes": [WAVE, WAVE]}, "wave comes twice"),
    ({"causes": [WAVE, Cause("b", WAVE.parameters)]}, "parameters: wave.height comes twice"),
    ({"causes": [Cause("slope", HEIGHT)]}, "causes and uncertain: slope comes twice"),
    ({"causes": [Cause("a", frees="slop")]}, ["cause a: frees = slop: ", 'did you mean "slope"']),
    ({"causes": [instruments.scale(table="lines")]},
     'cause scale: there is no table lines; did you mean "line"'),
    ({"seed": -1}, f"seed = -1: {FROM_0}"),
]  # fmt: skip


def amplitude(name="a", size=1.0, low=-1.0, high=1.0, **more):
    return Parameter(name, size=size, low=low, high=high, **more)


def law(**changes):
    given = {"law": "friction", "argument": "speed", "unit": "m/s", "low": 0.0, "high": 2.0}
    return free_law(**{**given, **changes})


MU = Parameter("mu_k", Prior("log-normal", 0.3, 1.1), "1/m")
TERMS = [
    (lambda: Parameter("a"), "parameter a: allowed is one of prior and size"),
    (lambda: Parameter("a", 0.1), "parameter a: prior = 0.1: allowed is a Prior"),
    (lambda: Parameter(5, Prior("normal", 2.0, 0.2)), ["name of a parameter = 5: ", " a text"]),
    (lambda: amplitude(size=0.0), "size = 0.0: allowed is a number"),
    (lambda: amplitude(size=True), ["size = ", ": allowed is a number"]),
    (lambda: amplitude(low=1.0, high=-1.0), "allowed is low < high"),
    (lambda: Parameter("a", size=1.0), "allowed are a finite low and high for an amplitude"),
    (lambda: amplitude(low=1.0, high=2.0), "absent = 0.0: allowed is 1.0 to 2"),
    (lambda: amplitude(fineness=0.0), "fineness = 0.0"),
    (lambda: Cause("none", HEIGHT), 'a text other than "none"'),
    (lambda: Cause("a"), "cause a has no Parameter"),
    (lambda: Cause("a", [0.3]), "cause a: parameters: allowed are Parameters"),
    (lambda: Values({"slope": np.ones((1, 1))})["sloop"], 'sloop; did you mean "slope"'),
    (lambda: law(low=2.0), "friction over speed: low = 2.0, high = 2.0: allowed is numbers"),
    (lambda: law(high=np.inf), "low < high"),
    (lambda: law(law=""), "law of a free law"),
    (lambda: law(largest=np.inf), "largest"),
    (lambda: law(knots=2), "knots"),
    (lambda: law(law_unit="N", factor_of="mu"),
     'law_unit = "N": allowed is "-" beside factor_of'),
    (lambda: beside_constants([law(factor_of="mu")], [MU]), ['factor_of = "mu"', "mu_k"]),
    (lambda: Curves([law()], {})["friction over sped"], "friction over speed"),
    (lambda: instruments.delay([0.0, 0.0], 0.1), "times"),
    (lambda: instruments.delay([0.0, 1.0], 0.1, curve=[0]), "curve: allowed is one for each of 2"),
    (lambda: instruments.marker_place([0], [1], 0.1), "theta, angle"),
    (lambda: instruments.scale(size=0.0), "scale.error"),
    (lambda: own(causes=[instruments.scale(rows=[12])]), "rows"),
    (lambda: own(causes=[instruments.scale(rows=[True, False])]), "rows"),
    (lambda: own(causes=[instruments.delay([0.0, 1.0], 0.1)]), "one for each"),
    (lambda: instruments.delay([0.0, 1.0], 0.1, input="u"), "times, curve, rows: allowed is none"),
    (lambda: own(causes=[instruments.marker_place([0], [1], 0.1, angle=[0, 1])]), "one for each"),
]  # fmt: skip

DRIVES = [
    ([{"frequencies": 40.0}], ["row 0: ", 'did you mean "drive.frequency"']),
    ([{"robot.length": 1e-3}], "row 0: drive.robot.length"),
    *((bad, "allowed is a DataFrame or a list of dicts")
      for bad in ({"frequency": 40.0}, "frequency", None, [40.0])),
    ([], "there is no row"),
    (pd.DataFrame({"frequency": [np.nan]}, index=["a"]), "row a: drive.frequency = nan"),
]  # fmt: skip


@functools.cache
def data():
    return measured(drives().assign(velocity=1e-3))


toy = functools.cache(lambda: made.toy(made.TRUTH))
ASKED = [
    *((lambda level=level: toy().conf_int(level), ["level = ", ABOVE_0])
      for level in (0.0, 1.0, -0.5, math.nan, "0.9", True)),
    (lambda: toy().candidate("bmup"), ["no such model was fitted", 'did you mean "bump"']),
    (lambda: diagnose_model(line, table_of(), [SLOPE, LEVEL], [WAVE])
     .predict({"x": [1.0, 2.0], "z": 1.0}), ["settings z", "2 rows"]),
    (lambda: toy().propose_experiments(), ["model of one's own", "separate"]),
    (lambda: propose_experiments(toy()), ["model of one's own", "separate"]),
    (lambda: propose_experiments(toy(), noise=0.1), "noise, trials, seed, threads: allowed for a"),
    (lambda: made.refused(toy()).predict([0.5]), "predict: the data allow no diagnosis"),
    (lambda: made.refused(toy()).candidate("none"), "candidate: the data allow no diagnosis"),
    (lambda: toy().save_report(5), "folder"),
    (lambda: toy().save_figures(5), "folder"),
]  # fmt: skip


def proposed(folder, what=None, **more):
    return propose_experiments(WALKER if what is None else what, **more)


WALKER = Scenario().replace({"drive.pulses": 5})
PROGRAM = Scenario(drive=Drive(mode="program", program=Waveform.hold(0.07, {})))
TURNING = WALKER.replace({"drive.heading": 0.5})
KINETIC = "contact.kinetic_friction"
PROPOSED = [
    ({"what": "s.toml"}, 'what = "s.toml": allowed is a Scenario or a Diagnosis'),
    ({"count": 0}, "count = 0: allowed is a whole number from 1"),
    ({"noise": 0.0}, "noise = 0.0: allowed is a number above 0 and below 1"),
    ({"noise": 5}, "noise = 5: allowed is"),
    ({"trials": 0}, "trials = 0: allowed is a whole number from 1"),
    ({"seed": -1}, f"seed = -1: {FROM_0}"),
    ({"what": PROGRAM}, 'drive.mode = "program": allowed is IPP or OPP'),
    ({"what": TURNING}, ["drive.heading = 0.5", "walk along x"]),
    ({"what": WALKER.replace({"robot.magnetization": 0.0})}, "stands still"),
    ({"what": WALKER.with_uncertain({KINETIC: {"mean": 0.15, "sd": 9.0}})}, "cannot be simulated"),
]

MEASUREMENT = "allowed is a Measureme"
ENTRY = [
    *((lambda given=given: diagnose(given), ScenarioError, ["measurement = ", MEASUREMENT])
      for given in ("m.toml", None, np.zeros(3))),
    (lambda: diagnose(data(), seed=-1), ScenarioError, f"seed = -1: {FROM_0}"),
    (lambda: diagnose(data(), threads=0), ValueError, "threads"),
    *((lambda row=row: data().with_velocities(pd.DataFrame([row])), ScenarioError, words)
      for row, words in (
          ({"frequency": 50.0, "velocity": "1.1 mm/s"}, 'velocity = "1.1 mm/s": allowed is'),
          ({"frequency": "fast", "velocity": 1e-3}, 'frequency = "fast": allowed is'),
          ({"direction": "z", "velocity": 1e-3}, 'drive.direction = "z": allowed'),
      )),
    (lambda: posed_by(measured(drives().assign(velocity=1e-3, heading=0.5))), ScenarioError,
     ["drive.heading = 0.5", "walk along x"]),
]  # fmt: skip

REFUSALS = [
    *((f"{kind} {number}", lambda _, call=call: call(), ScenarioError, words)
      for kind, rows in {"table": TABLES, "record": RECORDS, "term": TERMS, "result": ASKED}.items()
      for number, (call, words) in enumerate(rows)),
    *((f"own model {number}", lambda _, given=given: own(**given), ScenarioError, words)
      for number, (given, words) in enumerate(OWN)),
    *((f"drives {number}", lambda _, bad=bad: drive_settings(bad, Scenario()), ScenarioError, words)
      for number, (bad, words) in enumerate(DRIVES)),
    *((f"propose {number}", functools.partial(proposed, **given), ScenarioError, words)
      for number, (given, words) in enumerate(PROPOSED)),
    *((f"measurement {number}", lambda _, call=call: call(), kind, words)
      for number, (call, kind, words) in enumerate(ENTRY)),
]  # fmt: skip
