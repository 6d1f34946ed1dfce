"""Models in time: records, their errors, start states, and causes that act on an input."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import multivariate_normal

from stickslip import (
    Cause,
    Parameter,
    Prior,
    ScenarioError,
    Series,
    Table,
    diagnose_model,
    events,
    instruments,
)
from stickslip.diagnosis.data.errors import of_one_meter
from stickslip.diagnosis.data.series import with_repeats
from stickslip.diagnosis.fitting.forms import Correlated
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.scatter import with_scatter
from stickslip.diagnosis.model import posed

STEP, COUNT, NOISE = 0.2, 200, 0.02
T = STEP * np.arange(COUNT)


def random(seed):
    return np.random.default_rng([26, seed])


def drive(seed, count=COUNT):
    """A random staircase of 2 s a stair."""
    return np.repeat(random(seed).uniform(0.0, 2.0, count // 10 + 1), 10)[:count]


def tank(record, p):
    """x' = u - rate x - drag x |x|, by Euler's steps of the record."""
    u = record["u"]
    x = p["start"] + 0.0 * p["rate"]
    states = [x]
    for k, step in enumerate(np.diff(record.t)):
        x = x + step * (u[..., [k]] - p["rate"] * x - p["drag"] * x * np.abs(x))
        states.append(x)
    return np.hstack(states)


def made(count=COUNT, seed=0, *, start=0.3, drag=0.0, rate=0.5, u=None, noise=NOISE, **more):
    """A record of the tank, with white noise."""
    t, u = STEP * np.arange(count), drive(seed, count) if u is None else u
    p = {key: np.array([[value]]) for key, value in
         {"start": start, "rate": rate, "drag": drag}.items()}  # fmt: skip
    y = tank(Series(t, t, {"u": u}, sd=1.0), p)[0]
    return Series(t, y + noise * random(seed + 50).standard_normal(count), {"u": u}, **more)


START = Parameter("start", Prior("normal", 0.0, 1.0), each_record=True)
RATE = Parameter("rate", Prior("normal", 0.5, 0.05))
DRAG = Cause("quadratic drag", Parameter("drag", low=-1.0, high=1.0, size=0.1))
CAUSES = [
    DRAG,
    instruments.offset("-", 0.1),
    instruments.scale(),
    instruments.lag(0.2, input="u", name="slow valve"),
    instruments.delay(size=0.2, input="u", name="late valve"),
    events.step(0.2, 0.0, 40.0, name="shift"),
    events.step(0.2, 0.0, 40.0, input="u", name="leak"),
]


def told(records, causes=CAUSES):
    result = diagnose_model(tank, records, [RATE, START], causes)
    return result, result.verdict.kind, result.verdict.causes


def test_a_cause_is_named_over_records_of_unequal_length_with_starts_of_their_own():
    records = [made(200, 1, start=0.3, drag=0.15), made(120, 2, start=2.0, drag=0.15)]
    result, kind, causes = told(records, CAUSES[:4])
    assert (kind, causes) == ("named", ("quadratic drag",))
    found = result.params["value"]
    assert found["drag"] == pytest.approx(0.15, abs=0.02)
    starts = found[["start[record 1]", "start[record 2]"]]
    assert starts.tolist() == pytest.approx([0.3, 2.0], abs=4 * NOISE)
    # The noise is white about a smooth curve, and is told to a tenth from 400 readings.
    sd = result.problem.sd
    assert np.median(sd) == pytest.approx(NOISE, rel=0.25)


@pytest.mark.parametrize(
    ("name", "size", "value"),
    [("late valve", "late valve.time", 0.33), ("leak", "leak.height", -0.25)],
)
@pytest.mark.daily("leak")
def test_what_an_input_suffers_is_named_with_its_size(name, size, value):
    u = drive(3)
    seen = np.interp(T - value, T, u) if name == "late valve" else u + value * (T > 17.03)
    record = made(seed=3, u=seen)
    record = Series(T, record.y, {"u": u})
    some = {"quadratic drag", "slow valve", "late valve", name}
    result, kind, causes = told(record, [cause for cause in CAUSES if cause.name in some])
    assert (kind, causes) == ("named", (name,))
    low, high = result.conf_int(0.998).loc[size, ["low", "high"]]
    assert low < value < high
    if name == "leak":
        assert result.params.loc["leak.time", "value"] == pytest.approx(17.03, abs=STEP)


@pytest.mark.nightly
def test_a_short_pulse_is_found_anywhere_in_a_record():
    """One of a fiftieth of the record, near its end, whose effect no other place shares."""
    pulse, at = events.pulse(0.2, 0.0, 40.0, 2.0, name="knock"), 33.7
    record = made(seed=5)
    knocked = Series(T, record.y + 0.3 * ((at < T) & (at + 0.8 > T)), record.inputs)
    result, kind, causes = told(knocked, [*CAUSES[:4], pulse])
    assert (kind, causes) == ("named", ("knock",))
    assert result.params.loc["knock.time", "value"] == pytest.approx(at, abs=STEP)
    assert result.params.loc["knock.height", "value"] == pytest.approx(0.3, abs=5 * NOISE)


def test_nothing_is_named_where_nothing_is_hidden_whatever_tells_the_errors():
    smooth = [made(150, seed) for seed in (6, 7)]
    again = [made(100, 8, name="first"), made(100, 8, noise=0.0)]
    again[1] = Series(again[1].t, again[1].y + NOISE * random(9).standard_normal(100),
                      again[1].inputs, name="again", repeat_of="first")  # fmt: skip
    rough = made(150, 10, u=random(10).uniform(-20.0, 20.0, 150))
    for code, records in {"smooth": smooth, "repeats": again, "fit": [rough]}.items():
        result, kind, _ = told(records, CAUSES[:4])
        assert kind == "none"
        notes = {note.code for table in result.problem.tables for note in table.notes}
        assert f"noise-{code}" in notes
        assert np.median(result.problem.sd) == pytest.approx(NOISE, rel=0.3)


@pytest.mark.nightly
def test_noise_that_lasts_names_nothing():
    """Neither white nor a curve: of 0.3, correlated over five readings."""
    noise = lfilter([np.sqrt(1 - 0.8**2)], [1, -0.8], random(11).standard_normal(COUNT))
    record = made(seed=10)
    _, kind, causes = told(Series(T, record.y + 0.3 * noise, record.inputs), CAUSES[:4])
    assert kind in ("none", "unexplained")
    assert causes == ()


def test_repeats_tell_the_error_and_correlation_costs_degrees_of_freedom():
    white = random(12).standard_normal((2, 2000))
    lasting = lfilter([np.sqrt(1 - 0.9**2)], [1, -0.9], white)
    t = np.arange(2000.0)
    for noise, correlation in ((white, 0.0), (lasting, 0.9)):
        pair = [Series(t, noise[0], name="a"), Series(t, noise[1], name="b", repeat_of="a")]
        errors = with_repeats(pair)[1].errors
        assert errors.sizes["s0"] == pytest.approx(1.0, abs=0.15)
        # The sum of the squared correlations is (1 + phi^2) / (1 - phi^2).
        wanted = 2000 * (1 - correlation**2) / (1 + correlation**2)
        assert errors.dof == pytest.approx(wanted, rel=0.5)


@pytest.mark.parametrize("told_by", ["curve", "fit"])
@pytest.mark.parametrize(
    ("noise", "units", "shared"),
    [
        ((1.0, 1.0, 1.0), "VVV", True), ((1.0, 1.0, 5.0), "VVV", False),
        ((1.0, 1.0, 5.0), "VVA", [True, True, False]),
    ],
)  # fmt: skip
def test_records_of_one_unit_share_an_error_unless_a_test_tells_them_apart(
    told_by, noise, units, shared
):
    records = [
        made(count, 20 + k, noise=NOISE * size, unit=unit, name=f"{k}",
             u=None if told_by == "curve" else random(k).uniform(-20.0, 20.0, count))
        for k, (count, size, unit) in enumerate(zip((150, 90, 200), noise, units, strict=True))
    ]  # fmt: skip
    problem = with_scatter(posed(records, tank, [RATE, START], [DRAG]), 0)
    found = [errors.sizes["s0"] for errors in problem.errors]
    # A fit tells an error to 1 / sqrt(2 * 90), a curve to 1 / sqrt(2 * 90 / 8) and a part beside.
    assert found == pytest.approx(NOISE * np.array(noise), rel=0.45)
    assert {note.code for e in problem.errors for note in e.notes} == {
        "noise-smooth" if told_by == "curve" else "noise-fit"
    }
    assert [found.count(one) > 1 for one in found] == np.broadcast_to(shared, 3).tolist()
    # Readings of all that share an error tell it.
    dof = [errors.dof for errors in problem.errors]
    assert (dof[0] == dof[1]) == (shared is not False)


def test_equal_errors_are_told_apart_as_seldom_as_stated_and_in_any_unit():
    dof = np.array([4.0, 30.0, 8.0])
    sizes = np.sqrt(random(30).chisquare(dof, (4000, 3)) / dof)
    found = [of_one_meter(["V"] * 3, sd, 10.0 * dof, dof) for sd in sizes]
    apart = np.array([len(set(sd)) > 1 for sd, _ in found])
    # At 1 in 1000 more than 12 of 4000 come once in a thousand times.
    assert apart.sum() <= 12
    sd, readings = found[int(np.argmin(apart))]
    assert sd[0] ** 2 == pytest.approx(dof @ sizes[int(np.argmin(apart))] ** 2 / 42.0)
    assert readings == [420.0] * 3
    for scale in (1e-150, 1e150):
        again, _ = of_one_meter(["V"] * 3, scale * sizes[0], 10.0 * dof, dof)
        assert again == pytest.approx(scale * np.array(found[0][0]))


@pytest.mark.parametrize(
    ("wild", "left_out"),
    [({7: 900.9}, True), ({7: -900.0, 20: -910.0, 31: -920.0}, True), ({7: 3.0}, False),
     ({7: 90.0, 8: 90.0}, False), ({7: 1e10, 8: 1e10}, True),
     ({k: 900.0 + k for k in range(7, 17, 2)}, False)],
)  # fmt: skip
def test_single_readings_beyond_what_all_others_span_are_left_out(wild, left_out):
    t = np.arange(60.0)
    y = np.sin(0.3 * t)
    y[list(wild)] = list(wild.values())
    record = Series(t, y, {"u": t})
    assert set(range(60)) - set(record.rows.tolist()) == (set(wild) if left_out else set())
    assert [note.code for note in record.own_notes] == left_out * len(wild) * ["wild-reading"]


def test_a_row_less_makes_no_other_reading_a_wild_one():
    t = np.arange(60.0)
    y = np.sin(0.3 * t)
    y[30:32] = 50.0  # two neighbours are no slips of a meter
    gone = t == 30.0
    left = Series(t, y, {"u": t}, name="a").without(gone, "not computed")
    assert left.rows.tolist() == left.kept.tolist() == np.flatnonzero(~gone).tolist()
    assert np.array_equal(left.t, t[~gone])
    assert len(left.errors.sd) == left.named_settings.count == 59


def test_a_gap_in_a_record_leaves_the_other_rows_of_its_repeats():
    t, (first, again) = np.arange(200.0), random(13).standard_normal((2, 200))
    missing = np.isin(t, [3, 150])
    known = ~missing
    gappy = [Series(t, np.where(missing, np.nan, first), name="a"),
             Series(t, again, name="b", repeat_of="a")]  # fmt: skip
    whole = [Series(t[known], first[known], name="a"),
             Series(t[known], again[known], name="b", repeat_of="a")]  # fmt: skip
    found, wanted = (with_repeats(each)[0].errors for each in (gappy, whole))
    assert (found.sizes, found.dof) == (wanted.sizes, wanted.dof)
    with pytest.raises(ScenarioError, match=r"row 4: t = 5: allowed is the same time, 4"):
        with_repeats([gappy[0], Series(t + (t > 3), again, name="b", repeat_of="a")])


def beside_dense(problem, covariance, kept, seed):
    """A correlated discrepancy of all rows and of those that are kept, beside a dense matrix."""
    form, h, rows = Correlated(problem), np.log([0.7, 2.0, 0.04]), len(covariance)
    columns = random(seed).standard_normal((rows, 3))
    dense = multivariate_normal(np.zeros(rows), covariance).logpdf(columns.T)
    assert form.density(columns.T, h) == pytest.approx(dense, rel=1e-9)
    own, inner = form.of_rows(kept), covariance[np.ix_(kept, kept)]
    dense = columns[kept].T @ np.linalg.solve(inner, columns[kept])
    assert own.gram(own.prepared(columns), h) == pytest.approx(dense, rel=1e-9)


def test_a_correlated_discrepancy_and_its_kept_rows_beside_dense_matrices():
    """Two records and a table of blocks, whose errors are correlated on their own."""
    records = [made(60, 1, name="a", sd=0.05), made(30, 2, name="b", sd=0.02)]
    x = np.tile([1.0, 2.0, 3.0], 8)
    block = np.repeat(np.arange(8), 3)
    readings = x + 0.5 * random(14).standard_normal(8)[block] + 0.1 * random(15).standard_normal(24)
    table = Table({"x": x}, readings, block=block, name="c")
    tables = (*records, table)
    errors = table.errors.covariance
    problem = Problem(tables, lambda values: np.zeros((len(values), 93)), ())
    covariance = np.diag((0.7 * problem.sd) ** 2)
    covariance[90:, 90:] = 0.7**2 * errors
    assert np.abs(np.corrcoef(errors)[0, 1]) > 0.5
    for part, record, s in zip(problem.rows, records, (0.1, 0.04), strict=False):
        apart = np.abs(np.subtract.outer(record.order, record.order)) / (len(record) - 1)
        covariance[part, part] += s**2 * np.exp(-apart / 0.04)
    kept = np.setdiff1d(np.arange(len(covariance)), [0, 1, *range(20, 40), 59, 60, 75])
    beside_dense(problem, covariance, kept, 13)


def test_a_correlated_discrepancy_along_the_mean_of_runs_beside_a_dense_matrix():
    """Five runs over the same twelve settings, of which some were missed, beside another table."""
    x, run = np.tile(np.arange(12.0), 5), np.repeat(np.arange(5), 12)
    used = np.setdiff1d(np.arange(60), [3, 14, 40])
    noise = np.cumsum(random(16).standard_normal((5, 12)), axis=1).ravel()
    table = Table({"x": x[used]}, (x + 0.1 * noise)[used], run=run[used], name="runs")
    other = Table({"x": np.arange(4.0)}, np.zeros(4), sd=0.3, name="other")
    for tables in ((table,), (table, other)):
        count = sum(len(one.mean) for one in tables)
        problem = Problem(tables, np.zeros_like, ())
        covariance = np.diag((0.7 * problem.sd) ** 2)
        s = 2.0 * np.median(table.errors.sd)
        apart = np.abs(np.subtract.outer(table.order, table.order)) / 11.0
        covariance[:12, :12] = 0.49 * table.errors.covariance + s**2 * np.exp(-apart / 0.04)
        kept = np.setdiff1d(np.arange(count), [0, 5, 6, count - 1])
        beside_dense(problem, covariance, kept, 17)


@pytest.mark.parametrize(
    ("settings", "runs", "run", "place"),
    [
        ("abcabc", "111222", [0, 0, 0], [0, 1, 2]),  # repeats of one run
        ("abcac", "11122", [0, 0, 0], [0, 1, 2]),  # with a gap
        ("bcdab", "11122", [0, 0, 0, 0], [1, 2, 3, 0]),  # that overlap
        ("abxyabxy", "11223344", [0, 0, 1, 1], [0, 1, 2, 3]),  # two runs, each repeated
        ("abcd", "1122", [0, 0, 1, 1], [0, 1, 2, 3]),
        ("abccba", "111222", None, None),  # up and down
        ("aba", "111", None, None),
        ("abdacd", "111222", None, None),  # b and c in either order
    ],
)
def test_conditions_that_repeat_in_several_runs_keep_them(settings, runs, run, place):
    table = Table({"x": list(settings)}, random(18).standard_normal(len(runs)), run=list(runs))
    if run is None:
        assert table.run is table.order is None
        return
    assert table.run.tolist() == run
    ranks = np.argsort(np.argsort(table.order))
    assert ranks.tolist() == place


def test_a_cause_is_named_beside_what_a_model_misses_in_each_of_several_runs():
    """Five runs over the same places, along which the model is wrong by a correlated 0.08."""
    x, run = np.tile(np.linspace(0.0, 4.0, 40), 5), np.repeat(np.arange(5), 40)
    missed = 0.08 * lfilter([0.6], [1.0, -0.8], random(19).standard_normal(60))[20:]
    y = 1.05 * x + 0.5 * np.sin(2 * x) + missed[np.tile(np.arange(40), 5)]
    table = Table({"x": x}, y + 0.02 * random(20).standard_normal(200), run=run)

    def model(table, p):
        at = table["x"]
        return p["slope"] * at + p["height"] * np.sin(2 * at) + p["bend"] * at**2

    causes = [Cause(name, Parameter(key, low=-5.0, high=5.0, size=size))
              for name, key, size in (("wave", "height", 0.5), ("bow", "bend", 0.1))]  # fmt: skip
    result = diagnose_model(model, table, [Parameter("slope", Prior("normal", 1.0, 0.1))], causes)
    assert (result.verdict.kind, result.verdict.causes) == ("dominant", ("wave",))
    low, high = result.conf_int(0.998).loc["height", ["low", "high"]]
    assert low < 0.5 < high


def test_the_time_of_an_edge_is_no_finer_than_the_readings():
    t = np.arange(40.0)
    y = 1.0 * (t > 20.3) + 0.001 * np.random.default_rng(3).standard_normal(40)
    causes = [events.step(1.0, 0.0, 39.0), events.pulse(1.0, 0.0, 39.0, 20.0)]
    level = Parameter("level", Prior("normal", 0.0, 0.1), cause=False)
    found = diagnose_model(lambda s, p: p["level"] + 0.0 * s["t"], Series(t, y, sd=0.001), [level],
                           causes)  # fmt: skip
    assert found.verdict.causes == ("step",)
    low, high = found.conf_int().loc["step.time", ["low", "high"]]
    assert low < 20.0 < 21.0 < high  # all places in the gap are alike
    assert found.params.loc["step.height", "sd"] < 0.001


def test_a_long_record_beside_short_ones_is_tested_as_of_few_readings(monkeypatch):
    of = random(11)
    logs = [Series(STEP * np.arange(n), of.standard_normal(n), {"u": of.uniform(size=n)}, name=name)
            for name, n in {"long": 4100, "a": 20, "b": 20, "c": 20}.items()]  # fmt: skip
    level = Parameter("level", Prior("normal", 0.0, 0.1), cause=False)
    sizes = [Parameter(f"c{k}", size=0.1, low=-3.0, high=3.0) for k in range(24)]

    def model(record, p):
        waves = (p[each.name] * np.sin((k + 2.0) * record["u"]) for k, each in enumerate(sizes))
        return p["level"] + sum(waves)

    tests = []
    for is_long in (True, False):
        monkeypatch.setattr(Problem, "is_long", is_long)
        causes = [Cause(each.name, each) for each in sizes]
        tests.append(diagnose_model(model, logs, [level], causes).findings.test)
    assert tests[0].p_value == pytest.approx(tests[1].p_value, abs=0.05)


@pytest.mark.filterwarnings("error")
def test_a_model_that_diverges_at_a_trial_point_is_no_fault_of_a_long_record():
    t = np.arange(4100.0)
    log = Series(t, np.exp(1e-3 * t) + 0.1 * random(1).standard_normal(len(t)), sd=0.1)
    uncertain = [Parameter("a", Prior("normal", 1.0, 0.1), cause=False),
                 Parameter("rate", Prior("normal", 1e-3, 0.02), cause=False)]  # fmt: skip
    found = diagnose_model(lambda s, p: p["a"] * np.exp(p["rate"] * s["t"]), log, uncertain, [])
    assert found.verdict.kind == "none"


def test_a_search_of_a_long_record_begins_with_its_first_readings(monkeypatch):
    count, of = 4500, random(7)
    t, u = STEP * np.arange(count), of.uniform(-1.0, 1.0, count)
    log = Series(t, 2.1 * u + 0.1 * u**2 + 0.3 * of.standard_normal(count), {"u": u}, sd=0.3)
    slope = Parameter("slope", Prior("normal", 2.0, 0.2), cause=False)
    causes = [Cause(name, Parameter(name, size=0.1, low=-3.0, high=3.0)) for name in ("bend", "on")]

    def line(record, p, begin=300.0):
        on = p["on"] * (record.t > begin)
        return p["slope"] * record["u"] + p["bend"] * record["u"] ** 2 + on

    def late(record, p):  # what begins behind the first readings is not seen there
        return line(record, p, 800.0)

    short = [len(posed(log, each, [slope], causes).short.y) for each in (line, late)]
    assert short == [2000, count]
    found = diagnose_model(line, log, [slope], causes)
    monkeypatch.setattr("stickslip.diagnosis.model._FIRST", count)
    monkeypatch.setattr(Problem, "is_long", False)
    whole = diagnose_model(line, log, [slope], causes)
    assert found.verdict.causes == whole.verdict.causes == ("bend",)
    for names in ((), ("bend",), ("on",)):
        costs = [one.findings.models.get(names).cost for one in (found, whole)]
        assert costs[0] == pytest.approx(costs[1], abs=0.02)
    for key in (([], "ar1"), (["bend"], "exact"), (["bend"], "ar1"), (["on"], "exact")):
        evidence = [one.findings.models.get(*key).log_evidence for one in (found, whole)]
        assert evidence[0] == pytest.approx(evidence[1], abs=0.1)
    tests = [(one.findings.test.score, one.findings.test.lack_of_fit) for one in (found, whole)]
    assert tests[0] == pytest.approx(tests[1], abs=0.02)


@pytest.mark.parametrize("step", [0.02, 0.5, 1.5])
def test_a_reading_about_a_curve_is_no_finer_than_the_step_of_its_meter(step):
    # In another unit, so that equal readings differ by rounding; plateaus of up to 40 readings.
    t, random = 0.02 * np.arange(400), np.random.default_rng(3)
    y = 4.0 * np.sin(t) + 0.05 * random.standard_normal(400)
    read = np.round(y / step) * step * np.pi / 30.0
    sd = Series(t, read).errors.of_reading(np.zeros(1))[0] / (np.pi / 30.0)
    assert np.hypot(0.05, step) / 4.0 < sd < np.hypot(0.05, step / np.sqrt(12.0)) * 1.2
    assert sd > 0.999 * step / np.sqrt(12.0)
