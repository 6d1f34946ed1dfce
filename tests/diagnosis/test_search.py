"""Which models are fitted: the truth is among them, wherever the search begins."""

from dataclasses import replace

import numpy as np
import pytest

from sliding_block import (
    FRICTION,
    HIDDEN,
    OVER_LOAD,
    OVER_SPEED,
    OVER_WARMTH,
    measured,
    push,
    result,
)
from stickslip import Cause, Parameter, Prior, Series, Table, diagnose_model, instruments, models
from stickslip._util.note import Note
from stickslip.diagnosis.fitting.options import DESCENT
from stickslip.diagnosis.model import posed
from stickslip.diagnosis.pipeline import run
from stickslip.diagnosis.terms.laws import free_law
from toys import LEVEL, SLOPE, WAVE, data, problem, shapes

X = np.linspace(1.0, 3.0, 30)


# ------------------------------------------------------------------------------ many causes, pairs
def crowd(count):
    """Waves of other lengths and phases as causes, and a model that has all of them."""
    paces = np.linspace(2.0, 18.0, count)
    phases = np.random.default_rng(11).uniform(0.0, np.pi, count)
    columns = np.sin(paces[:, None] * X + phases[:, None])
    causes = [
        Cause(f"c{k}", Parameter(f"c{k}.size", size=0.3, low=-3.0, high=3.0)) for k in range(count)
    ]

    def model(table, p):
        sizes = np.hstack([p[f"c{k}.size"] for k in range(count)])
        return p["slope"] * table["x"] + p["level"] + sizes @ columns

    return causes, columns, model


@pytest.mark.parametrize("hidden", [{3: 0.5}, {2: 0.8, 9: -0.6}], ids=["single", "pair"])
@pytest.mark.daily("single")
def test_the_truth_is_found_among_many_causes_and_pairs(hidden):
    causes, columns, model = crowd(14)  # 14 single ones and 91 pairs
    table = data(sum(size * columns[k] for k, size in hidden.items()), sd=0.05)
    found = run(posed(table, model, [SLOPE, LEVEL], causes), 0)
    names = tuple(sorted(f"c{k}" for k in hidden))
    assert (found.verdict.kind, found.verdict.causes) == ("pair" if names[1:] else "named", names)
    values = found.problem.physical(found.verdict.fit.x[None, :])[0]
    chosen = found.problem.columns([causes[k] for k in hidden])
    # 0.05 / sqrt(30 / 2) is the error of a size where nothing trades off with it.
    assert values[chosen] == pytest.approx(list(hidden.values()), abs=0.1)


# --------------------------------------------------------------------- at the leader's constants
def twins(extra=()):
    """`b` does what `a` does, but only where the constant is 1; without a cause it is 0."""
    h, g, rest = np.eye(16)[0], 5.0 * np.eye(16)[1] - np.eye(16)[0], np.eye(16)[1]

    def model(table, p):
        made = p["k"] * h + (p["a.size"] + p["b.size"] * p["k"] ** 2) * g
        return made + sum(p[each.parameters[0].name] for each in extra) * rest

    causes = [Cause(n, Parameter(f"{n}.size", size=1.0, low=-5.0, high=5.0)) for n in "ab"]
    constant = Parameter("k", Prior("normal", 0.0, 1.0), cause=False)
    table = Table({"x": np.arange(16.0)}, h + g, sd=0.05)
    return posed(table, model, [constant], [*causes, *extra])


def test_a_cause_that_acts_only_at_the_leaders_constants_is_found():
    models = run(twins(), 0).models
    assert abs(models.null.x[0]) < 0.05
    assert models.get(["a"]).chi2 < 1.0
    # Exchanged for `a` where the constant is 1, it explains as much.
    assert models.get(["b"]).chi2 < 1.0
    # Also beside a third cause that leads first: it explains a part and leaves the constant at 0.
    models = run(twins([Cause("c", Parameter("c.size", size=1.0, low=-1.0, high=1.0))]), 0).models
    assert models.get(["c"]).chi2 > 100.0
    assert models.get(["b"]).chi2 < 1.0


@pytest.mark.parametrize("size", [0.02, 0.05])
@pytest.mark.parametrize("error", [0.1, 0.15, 0.25, 0.4])
@pytest.mark.daily("0.1-0.02", "0.4-0.05")
def test_a_scale_is_found_beside_constants_that_almost_undo_it(error, size):
    """Constants are as stated, and could take the scale's place at many of their errors.

    The way from there is a narrow valley that turns. No minimum is above the truth.
    """
    x, draw = np.linspace(0.2, 3.0, 60), np.random.default_rng(3)
    noise = draw.standard_normal(60)
    y = (1.0 + error) * (2.0 * x + 0.5 * x**2) + 0.02 * noise
    stated = {"a": 2.0, "b": 0.5}
    found = diagnose_model(
        lambda t, p: p["a"] * t["x"] + p["b"] * t["x"] ** 2,
        Table({"x": x}, y, sd=0.02),
        [Parameter(name, Prior("normal", value, 0.02)) for name, value in stated.items()],
        [instruments.scale(size)],
    )
    prior = np.arcsinh(error / size * np.sinh(1.0))
    truth = float(noise @ noise) + prior**2
    assert found.findings.models.get(["scale"]).cost < truth + DESCENT.settled


def test_no_model_fits_worse_than_one_that_it_contains():
    models = run(problem(data(0.5 * shapes(X)["wave.height"] + 0.3 * (X > 2.0))), 0).models
    plain = {key[0]: each for key, each in models.best.items() if key[1] == "exact"}
    assert any(len(names) == 2 for names in plain)
    for names, each in plain.items():
        for inner, other in plain.items():
            if inner < names:
                assert each.cost < other.cost + 0.5, (names, inner)


def test_what_is_at_fault_is_a_problem_of_the_data():
    reason = Note("drift", "The readings drift.")
    found = run(problem(data(2.0 * shapes(X)["wave.height"]), [WAVE]), 0, fault=reason)
    assert (found.verdict.kind, found.verdict.reasons) == ("data-problem", (reason,))


# --------------------------------------------------------------------------------- narrow minima
# Readings of a straight line over 100 s with a ripple, of which only the period is not known. At
# the end a period T that is off by dT has another phase by 2 pi 100 s dT / T^2: a minimum is a few
# hundredths of T wide where the end is 4 s.
WHEN = np.sort(np.random.default_rng(5).uniform(0.0, 4.0, 30))
RIPPLE, RIPPLE_SD, PERIOD = 0.3, 0.1, 0.9137


def rippled(table, p):
    when, period = table["t"], p["ripple.period"]
    wave = np.where(period > 0.0, np.sin(2.0 * np.pi * when / np.maximum(period, 0.2)), 0.0)
    return p["slope"] * when + p["level"] + RIPPLE * wave


def test_a_narrow_minimum_is_found_where_it_is():
    period = Parameter(
        "ripple.period", unit="s", size=0.5, low=0.0, high=4.0, negligible=0.2, fineness=0.1
    )
    noise, phase = np.random.default_rng(11).standard_normal(30), 2.0 * np.pi * WHEN / PERIOD
    y = WHEN + 0.2 + RIPPLE * np.sin(phase) + RIPPLE_SD * noise
    table = Table({"t": WHEN}, y, sd=RIPPLE_SD)
    found = diagnose_model(rippled, table, [SLOPE, LEVEL], [Cause("ripple", period)])
    made = found.candidate("ripple").params.loc["ripple.period"]
    # The derivative of the ripple by T is 2 pi t / T^2 times its size and a cosine.
    sd = RIPPLE_SD / np.linalg.norm(RIPPLE * phase / PERIOD * np.cos(phase))
    assert abs(made["value"] - PERIOD) < 4.0 * sd
    assert made["sd"] == pytest.approx(sd, rel=0.3)


# ------------------------------------------------------------------------ far from what is stated
def test_a_pair_is_found_however_precise_the_readings():
    # Each cause by itself leaves a hundred errors a row.
    table = data(0.5 * shapes(X)["wave.height"] + 0.4 * shapes(X)["bend.size"], sd=1e-3)
    found = run(problem(table), 0)
    assert found.models.get(["wave"]).chi2 > 1e4 * len(X)
    assert (found.verdict.kind, found.verdict.causes) == ("pair", ("bend", "wave"))


@pytest.mark.parametrize("far", [4.4, 6.1])
@pytest.mark.daily("4.4")
def test_a_constant_that_is_far_off_is_found_behind_other_minima(far):
    # sin(w k) is near sin(w far) at other k too. The model without a cause follows the constant, so
    # that held-out readings give no proof of it.
    w = np.linspace(0.5, 3.0, 30)

    def model(table, p):
        return np.sin(table["w"] * p["k"]) + p["level"]

    y = np.sin(far * w) + 0.05 * np.random.default_rng(0).standard_normal(30)
    k = Parameter("k", Prior("normal", 0.0, 1.0))
    found = diagnose_model(model, Table({"w": w}, y, sd=0.05), [k, LEVEL])
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("k",))
    assert found.params.loc["k", "value"] == pytest.approx(far, abs=0.03)


# ------------------------------------------------------------------------------------------ laws
@pytest.mark.parametrize("law", HIDDEN, ids=lambda law: law.curve.argument)
@pytest.mark.nightly
def test_a_hidden_law_is_named_over_its_argument(law):
    hidden, at = HIDDEN[law]
    found = result(measured(0, 1.0 + hidden(at)))
    assert (found.verdict.kind, found.verdict.causes) == ("named", (law.name,))
    told = found.as_dict()["law"]
    truth = FRICTION * (1.0 + hidden(np.array(told["at"])))
    # The whole law, by a tenth of what it varies.
    assert np.sqrt(np.mean((np.array(told["value"]) - truth) ** 2)) < 0.1 * np.ptp(truth)
    # A parabola about 305 K is no form: there the curve, or what bends alike within the range.
    forms = {OVER_SPEED: ["exponential"], OVER_LOAD: ["wave"], OVER_WARMTH: ["curve", "wave"]}
    assert told["form"] in forms[law]
    assert sum(told["forms"].values()) == pytest.approx(1.0)


@pytest.mark.nightly
def test_a_cause_that_explains_the_data_comes_before_the_laws():
    # A step of the force itself, beside laws that could follow a part of it.
    cause = Cause("push", Parameter("push.force", unit="N", size=0.1, low=-3.0, high=3.0))

    def pushed(table, p, curves):
        return push(table, p, curves) + p["push.force"] * np.cos(3.0 * table["speed"])

    extra = 0.2 * np.cos(3.0 * np.linspace(0.02, 2.0, 40))
    found = result(measured(1, extra=extra), predict=pushed, causes=[cause])
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("push",))


def with_laws(posed, asked):
    """The problem whose law, a wave through knots, is only found when it is asked for."""
    law = free_law("height", "place", "m", 1.0, 3.0, size=0.3)

    def laws(given, x):
        asked.append(x)
        return (law,)

    def wider(given, more):
        def model(values):
            knots = values[:, given.size :]
            return given.model(values[:, : given.size]) + knots @ law.curve.design(X).T

        causes = (*given.causes, *more)
        return replace(given, model=model, low_fidelity=None, causes=causes, wider=None)

    return replace(posed, laws=laws, wider=wider), law


BENT, LAW = 0.5 * np.tanh(4.0 * (X - 1.7)), ("height over place",)
SCATTER = 0.14 * np.random.default_rng(2).standard_normal(30)  # far ahead of the law as stated


@pytest.mark.parametrize(
    ("extra", "kind", "causes"),
    [(BENT, "named", LAW), (BENT + SCATTER, "dominant", LAW), (0.0, "none", ()),
     (0.5 * shapes(X)["wave.height"], "named", ("wave",))],
    ids=["a law", "a law beside scatter", "nothing", "a cause"],
)  # fmt: skip
def test_laws_compete_where_something_is_wrong(extra, kind, causes):
    asked, told = [], []
    posed, law = with_laws(problem(data(extra, sd=0.05), [WAVE]), asked)
    found = run(posed, 0, lambda *each: told.append(each))
    assert (found.verdict.kind, found.verdict.causes) == (kind, causes)
    assert len(asked) == (kind != "none")
    # One that does not promise to come near what explains the data is not searched.
    compared = {name for fit in found.models.best.values() for name in fit.names}
    assert (law.name in compared) == (causes == (law.name,))
    # The search says how far it is; that of laws begins again.
    fractions = [fraction for fraction, _ in told]
    assert (fractions[0], fractions[-1]) == (0.0, 1.0)
    assert asked or fractions == sorted(fractions)
    assert [stage for _, stage in told][:2] == ["recalibrating", "testing"]
    assert ("comparing models" in dict(map(reversed, told))) == (kind != "none")


@pytest.mark.nightly
def test_a_limit_that_binds_far_is_found_though_the_way_there_leads_uphill():
    # A mass under a force that is cut off: a limit that hardly binds fits worse than none.
    step, top = 0.02, 2.0
    t = step * np.arange(200)
    force = 3.0 * np.sin(3.5 * t + 0.3) + 2.2 * np.sin(5.7 * t + 1.0)

    def moved(table, p):
        cut = np.clip(force, -p["limit.level"], p["limit.level"])
        v = x = np.zeros((len(cut), 1))
        places = []
        for k in range(len(t)):
            places.append(x)
            v = v + step * (cut[:, k : k + 1] - p["drag"] * v) / p["mass"]
            x = x + step * v
        return np.hstack(places)

    true = {"limit.level": [[top]], "mass": [[1.02]], "drag": [[1.6]]}
    y = moved(None, {name: np.array(each) for name, each in true.items()})[0]
    y += 0.005 * np.random.default_rng(0).standard_normal(len(t))
    level = Parameter("limit.level", size=0.5, low=0.5, high=6.0, absent=np.inf, falls=True)
    mass = Parameter("mass", Prior("log-normal", 1.0, 1.05))
    drag = Parameter("drag", Prior("log-normal", 1.5, 1.35))
    table = Table({"t": t}, y, sd=0.005)
    found = diagnose_model(moved, table, [mass, drag], [Cause("limit", level)])
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("limit",))
    assert found.params["value"]["limit.level"] == pytest.approx(top, abs=0.02)


@pytest.mark.nightly
def test_two_causes_are_found_though_a_model_of_one_is_far_from_the_data():
    """A precise meter: the wrong zero alone leaves nine errors in a reading, and a damping that is
    too large hides that of the square of the speed.
    """
    spring = models.oscillator(mass=1.0, stiffness=(25.0, 1.0), viscous=(0.1, 0.02))
    t = np.linspace(0.0, 5.0, 151)
    y = spring.simulate(t, {}, stiffness=25.4, viscous=0.12, quadratic=0.08, start_position=1.0)
    y += 0.025 + 1e-3 * np.random.default_rng(0).standard_normal(len(t))
    found = diagnose_model(spring, Series(t, y, sd=1e-3, unit="m"))
    alone = found.findings.models.get(["zero"])
    assert alone.chi2 > 70.0 * len(t)
    assert (found.verdict.kind, set(found.verdict.causes)) == ("pair", {"quadratic", "zero"})
    assert found.verdict.fit.form == "exact"
