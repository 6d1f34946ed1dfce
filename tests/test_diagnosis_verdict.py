"""The verdict's rules and reasons, each on fits that are made for it."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from line_model import BEND, SD, SLOPE, WAVE, X, fitted, line, problem
from stickslip.diagnosis import Prior, Uncertain, diagnose_model
from stickslip.diagnosis.fit.distinguishability import alike
from stickslip.diagnosis.fit.fit_result import Ranking
from stickslip.diagnosis.inference.claim_checks import (
    CorrelatedLead,
    checked_on_training_subset,
    checked_with_correlation,
)
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.inference.verdict import (
    Table,
    Verdict,
    contradictions,
    decide,
    most_pulled,
    reasons_against,
)
from stickslip.facts import Code, Fact


@pytest.mark.parametrize(("source", "word"), [((), "named"), ("a" * 12 + "b" * 12, "ambiguous")])
def test_a_cause_that_one_table_contradicts_is_not_named(source, word):
    # Twelve residuals of 1.6 errors in one half: p = 0.002 there, and 0.2 of all 24.
    off = np.where(np.arange(len(X)) < 12, 0.0, 1.6 * SD * (-1.0) ** np.arange(len(X)))
    found = diagnose_model(
        line, None, X + np.sin(4 * X) + off, [SLOPE], [WAVE],
        sd=np.full(len(X), SD), source=source,
    ).findings  # fmt: skip
    assert found.verdict.causes == ("wave",)
    assert found.verdict.kind == word
    against = [each for each in found.verdict.reasons if each.code is Code.TABLE_CONTRADICTS]
    assert [each.fields["kind"] for each in against] == (["b"] if source else [])


# Of unit length, and nothing that the slope can make up for.
CURVE = X**2 - X * (X @ X**2) / (X @ X)
CURVE = CURVE / np.linalg.norm(CURVE)


def bent(_, p):
    """A line with a wave and, where that is a suspect, a bend along the curve."""
    return line(_, p) + (p[:, 2:3] * CURVE if p.shape[1] > 2 else 0.0)


def diagnosed(observed, causes=(WAVE,)):
    sd = np.full(len(X), SD)
    return diagnose_model(bent, None, observed, [SLOPE], list(causes), sd=sd).findings.verdict


def test_a_second_cause_behind_an_adequate_first_one_is_seen():
    wave = X + np.sin(4 * X)
    alone = diagnosed(wave, [WAVE, BEND])
    assert (alone.kind, alone.causes) == ("named", ("wave",))
    (left,) = [each for each in alone.reasons if each.code is Code.NOTHING_LEFT]
    assert left.fields["lead"] < 1.0 < left.fields["needed"]
    # Without noise: beside the wave, a bend of 4.6 errors leaves a chi-square of at most 21 for 24
    # readings, p = 0.6, and takes all of it: 10 in log-evidence, less 2 for its amplitude.
    both = diagnosed(wave + 4.6 * SD * CURVE, [WAVE, BEND])
    assert (both.kind, both.causes) == ("pair", ("bend", "wave"))


def test_a_name_whose_fit_pulls_a_constant_far_is_withheld():
    # Of the prior's mean of 1; whether the slope itself is named beside the wave is another rule.
    for pull, kind in ((1.5, "named"), (3.2, "ambiguous")):
        said = diagnosed((1.0 + pull * 0.5) * X + np.sin(4 * X))
        assert (said.kind, "wave" in said.causes) == (kind, True)
        codes = [each.code for each in said.reasons]
        assert (Code.CONSTANT_PULLED in codes) == (kind == "ambiguous")


@pytest.mark.parametrize("count", [1, 2, 9, 30])
def test_the_limit_of_pulls_refuses_as_few_right_fits_however_many_constants_there_are(count):
    # Honest constants that the data do not determine are pulled by standard normal amounts, and
    # one of several independent ones is beyond L with 1 - (1 - 2 Q(L))^n, less than 2 n Q(L).
    limit, draws = most_pulled(count), 40_000
    pulls = np.random.default_rng(count).standard_normal((draws, count))
    refused = np.mean(np.max(np.abs(pulls), axis=1) > limit)
    expected = 1.0 - (1.0 - math.erfc(limit / math.sqrt(2.0))) ** count
    # Five standard errors of the share.
    assert refused == pytest.approx(expected, abs=5.0 * math.sqrt(expected / draws))
    assert expected < 0.0251
    # Beyond two constants no more is given away than the bound's own gap, 0.025^2 / 2, and than is
    # lost by 2.5 itself for fewer.
    assert count < 2 or expected > 0.025 - 0.025**2


def test_many_constants_of_instruments_do_not_refuse_a_right_name():
    # One of twenty, which the data hardly determine, is 2.8 sd of its prior off: more than one
    # constant may be, and less than the largest of twenty is in one case of forty, 3.2.
    def predict(_, p):
        shifts = p[:, 1:20] @ np.eye(19, len(X))
        return line(_, p[:, [0, *range(20, p.shape[1])]]) + 1e-4 * shifts

    tiny = [Uncertain(f"pixel {k}", Prior("normal", 0.0, 1.0)) for k in range(19)]
    for pull, kind in ((2.8, "named"), (3.6, "ambiguous")):
        observed = (1.0 + pull * 0.5) * X + np.sin(4 * X)
        said = diagnose_model(
            predict, None, observed, [replace(SLOPE, suspect=False), *tiny], [WAVE],
            sd=np.full(len(X), SD),
        ).verdict  # fmt: skip
        assert (said.kind, said.causes) == (kind, ("wave",))
        assert (Code.CONSTANT_PULLED in [each.code for each in said.reasons]) == (pull > 3.2)


def test_a_name_that_leaves_one_reading_far_off_is_withheld():
    # 4.9 errors of one reading: chi-square 24 of 24, p = 0.5; among 24 readings noise gives one as
    # large in one case of ten thousand.
    off = np.zeros(len(X))
    off[7] = 4.9 * SD
    said = diagnosed(X + np.sin(4 * X) + off)
    assert said.kind == "ambiguous"
    assert Code.ERRORS_CONTRADICTED in [each.code for each in said.reasons]


@pytest.mark.parametrize(("table", "refused"), [("a", False), ("b", True)])
def test_a_reading_is_judged_by_the_degrees_of_freedom_of_its_own_table(table, refused):
    # One of 24 readings is off by 6 errors, of which the fit's two parameters leave 5.7. That is
    # rarer than 0.001 where the noise is known (b), 24 * 2 Q(5.7) = 3e-7, and not where it has six
    # degrees of freedom (a), by Student's law 0.03. By the 24 degrees of freedom of both tables
    # together, 0.0002, it would be in either.
    off = np.zeros(len(X))
    off[4 if table == "a" else 16] = 6.0 * SD
    fit = fitted(replace(problem(X + np.sin(4 * X) + off), dof=24.0), [WAVE])
    tables = [Table("a", np.arange(12), 6.0), Table("b", np.arange(12, 24), math.inf)]
    said = reasons_against(replace(problem(X), dof=24.0), fit, fit, tables)
    assert (Code.ERRORS_CONTRADICTED in [each.code for each in said]) == refused


def test_each_table_is_judged_by_its_own_noise():
    # Eight residuals of 1.7: p = 0.003 where the noise is known, 0.08 where eight trials told it.
    fit = SimpleNamespace(name="wave", residual=np.repeat([1.7, 1.0], 8))
    rows = np.arange(8)
    known = [Table("velocity", rows, math.inf), Table("angle", rows + 8, math.inf)]
    assert [each.fields["kind"] for each in contradictions(fit, known)] == ["velocity"]
    assert contradictions(fit, [Table("velocity", rows, 8.0), known[1]]) == ()
    assert contradictions(fit, known[:1]) == ()


def test_a_verdict_that_changes_on_the_training_subset_is_ambiguous():
    given = problem(X + 0.2 * np.sin(4 * X), (WAVE, BEND))
    fits = tuple(fitted(given, causes) for causes in ([WAVE], [BEND], [WAVE, BEND]))
    ranking = Ranking(fitted(given), fits[:2], fits[2:])
    said = Verdict("named", ("wave",), fits[0], ("why",), {})
    apart = np.eye(2)
    assert checked_on_training_subset(given, said, ranking, apart, "wave", 0.0) is said
    other = checked_on_training_subset(given, said, ranking, apart, "bend", 3.1)
    assert (other.kind, other.causes, other.fit) == ("ambiguous", ("wave",), fits[0])
    assert other.reasons == (Fact(Code.TRAINING_SUBSET, {"name": "bend", "joins": False}),)
    # It joins the set if it explains the data, which here it does where nothing is hidden.
    plain = problem(X, (WAVE, BEND))
    alike = Ranking(fitted(plain), tuple(fitted(plain, [each]) for each in (WAVE, BEND)), ())
    joined = checked_on_training_subset(plain, said, alike, apart, "bend", 3.1)
    assert (joined.kind, joined.causes) == ("ambiguous", ("wave", "bend"))
    # And the set of a verdict that was ambiguous before.
    doubtful = replace(said, kind="ambiguous")
    again = checked_on_training_subset(plain, doubtful, alike, apart, "bend", 3.1)
    assert (again.causes, again.reasons) == (("wave", "bend"), ("why", *joined.reasons))
    # A small lead says that the subset tells nothing of the cause, but not where the two are alike.
    assert checked_on_training_subset(given, said, ranking, apart, "bend", 2.9) is said
    twins = np.array([[1.0, 0.95], [0.95, 1.0]])
    assert checked_on_training_subset(given, said, ranking, twins, "bend", 0.1) == other


# The bend, and not the pair that has the wave and the bend: it says the same of the wave.
BEHIND = (Code.RUNNER_UP, {"name": "bend", "lead": 20.0})
LESS_LIKELY = (Code.LESS_LIKELY, {"explaining": "wave", "name": "bend"})


def standing(evidence, misfit, causes, like):
    """A fit of given log-evidence whose data leave a chi-square of `misfit`."""
    candidate = replace(like.candidate, causes=causes)
    return replace(
        like, candidate=candidate, log_evidence=evidence, data_chi2=misfit, converged=True
    )


@pytest.mark.parametrize(
    ("wave", "bend", "both", "word", "said"),
    [
        # Log-evidence and misfit of 24 readings; above 43 (p < 0.01) it is not explained.
        ((90.0, 20.0), (70.0, 30.0), (96.0, 18.0), "named", BEHIND),
        ((90.0, 20.0), (88.7, 60.0), (70.0, 18.0), "ambiguous", (Code.NOT_SEPARATED, {})),
        ((90.0, 20.0), (95.0, 60.0), (70.0, 18.0), "unexplained", LESS_LIKELY),
        # More than 6.7 above the wave, but not above the bend, which itself leads by too little.
        ((90.0, 20.0), (92.0, 60.0), (97.5, 18.0), "ambiguous", (Code.NOT_SEPARATED, {})),
        ((90.0, 60.0), (70.0, 60.0), (95.0, 18.0), "unexplained", (Code.PAIR_LEADS_TOO_LITTLE, {})),
        ((90.0, 60.0), (70.0, 60.0), (97.0, 60.0), "unexplained", (Code.NO_EXPLANATION, {})),
        ((90.0, 20.0), (70.0, 60.0), (99.0, 60.0), "named", BEHIND),
    ],
)
def test_the_reason_says_why_the_verdict_is_not_more_definite(wave, bend, both, word, said):
    verdict = judged(wave, bend, both)
    assert verdict.kind == word
    code, fields = said
    assert verdict.reasons[0].code is code
    assert {key: verdict.reasons[0].fields[key] for key in fields} == fields


@pytest.mark.parametrize(
    ("both", "code", "lead"),
    [
        # Less than 6.7 above the wave's 90; more than that by 2.3, but with a misfit of p < 0.01.
        ((96.0, 18.0), Code.NOTHING_LEFT, 6.0),
        ((99.0, 60.0), Code.OTHER_LEADS_UNEXPLAINED, 2.3),
    ],
)
def test_what_a_second_cause_adds_is_said_beside_a_name(both, code, lead):
    verdict = judged((90.0, 20.0), (70.0, 60.0), both)
    assert (verdict.kind, verdict.causes) == ("named", ("wave",))
    _, second = verdict.reasons
    assert second.code is code
    assert second.fields["lead"] == pytest.approx(lead)


def test_starts_that_disagree_matter_sooner_beside_an_alike_cause():
    # A twin is 6.1 behind: with starts that are 1 apart in chi-square it may be 5.6 behind.
    for starts, word in (((20.0, 20.1), "named"), ((20.0, 21.0), "ambiguous")):
        first = {"converged": False, "starts": starts}
        for cosine, said in ((0.95, word), (0.5, "named")):
            cosines = np.array([[1.0, cosine], [cosine, 1.0]])
            verdict = judged((90.0, 20.0), (83.9, 21.0), (70.0, 18.0), cosines, **first)
            assert (verdict.kind, verdict.causes) == (said, ("wave",))


def test_a_pair_that_is_led_by_one_that_explains_nothing_is_not_said():
    third = replace(BEND, name="third")
    given = problem(X + 0.2 * np.sin(4 * X), (WAVE, BEND, third))
    fit = fitted(given, [BEND, WAVE])
    pairs = (standing(94.0, 60.0, (third, WAVE), fit), standing(90.0, 20.0, (BEND, WAVE), fit))
    single = standing(60.0, 60.0, (WAVE,), fitted(given, [WAVE]))
    ranking = Ranking(fitted(given), (single,), pairs)
    found = SimpleNamespace(found=True)
    verdict = decide(given, found, ranking, np.eye(3), {}, lambda fit: True)
    assert verdict.kind == "unexplained"
    names = {"explaining": "bend + wave", "name": "third + wave"}
    assert verdict.reasons == (Fact(Code.LESS_LIKELY, names),)


@pytest.mark.parametrize(
    ("kind", "lead", "said"),
    [("named", 3.1, "named"), ("named", 2.9, "ambiguous"),
     ("pair", 6.8, "pair"), ("pair", 6.6, "ambiguous")],
)  # fmt: skip
def test_a_claim_leads_too_where_errors_may_be_correlated(kind, lead, said):
    given = problem(X + 0.2 * np.sin(4 * X), (WAVE, BEND))
    causes = (WAVE,) if kind == "named" else (BEND, WAVE)
    claim = Verdict(kind, tuple(each.name for each in causes), fitted(given, causes), ("why",), {})
    assert checked_with_correlation(claim, None) is claim
    checked = checked_with_correlation(claim, CorrelatedLead(0.4, lead))
    assert (checked.kind, checked.causes) == (said, claim.causes)
    if said == "ambiguous":
        (reason,) = checked.reasons
        assert (reason.code, reason.fields["correlation"]) == (Code.MAY_BE_CORRELATED, 0.4)


@pytest.mark.parametrize(
    ("second", "word"),
    [
        # The wave's 90 lead the pair's 91, without its price of 6.7, by 5.7, and the bend's 70 by
        # 20. Only the bend lacks the wave. Its search may have missed half of what the wave's has.
        (20.0 + 33.9, "named"),
        (20.0 + 34.1, "ambiguous"),
        (None, "ambiguous"),
    ],
)
def test_starts_that_disagree_matter_where_a_rival_could_lead(second, word):
    starts = (20.0,) if second is None else (20.0, second)
    verdict = judged((90.0, 20.0), (70.0, 60.0), (91.0, 18.0), converged=False, starts=starts)
    assert (verdict.kind, verdict.causes) == (word, ("wave",))
    assert (Code.STARTS_DISAGREE in [each.code for each in verdict.reasons]) == (word != "named")


@pytest.mark.parametrize(
    ("lead", "cosine", "word"),
    [
        (1.9, 0.5, "ambiguous"), (2.1, 0.5, "pair"),
        (5.9, 0.95, "ambiguous"), (6.1, 0.95, "pair"),
    ],
)  # fmt: skip
def test_a_pair_leads_other_pairs_by_its_margin(lead, cosine, word):
    third = replace(BEND, name="third")
    given = problem(X + 0.2 * np.sin(4 * X), (WAVE, BEND, third))
    fit = fitted(given, [BEND, WAVE])
    pairs = (
        standing(90.0, 20.0, (BEND, WAVE), fit), standing(90.0 - lead, 20.0, (third, WAVE), fit)
    )  # fmt: skip
    ranking = Ranking(fitted(given), (standing(60.0, 60.0, (WAVE,), fitted(given, [WAVE])),), pairs)
    found = SimpleNamespace(found=True)
    cosines = np.eye(3)
    cosines[1, 2] = cosines[2, 1] = cosine
    verdict = decide(given, found, ranking, cosines, {}, lambda fit: True)
    assert verdict.kind == word
    assert set(verdict.causes) == {"bend", "wave"} | ({"third"} if word == "ambiguous" else set())


def test_candidates_are_alike_by_the_causes_that_they_do_not_share():
    third, fourth = replace(BEND, name="third"), replace(BEND, name="fourth")
    given = problem(X, (WAVE, BEND, third, fourth))
    cosines = np.eye(4)
    for one, other, cosine in ((0, 1, 0.95), (1, 2, 0.92), (0, 3, 0.5)):
        cosines[one, other] = cosines[other, one] = cosine
    assert alike(given, cosines, (WAVE,), (BEND,))
    assert alike(given, cosines, (WAVE, BEND), (WAVE, third))
    # The wave is like the bend, but both have the wave; the bend is not like the fourth.
    assert not alike(given, cosines, (WAVE, BEND), (WAVE, fourth))
    assert not alike(given, cosines, (WAVE, third), (BEND, fourth))
    # The bend is like both of the others, but those are two; and of two pairs each cause has to be
    # like one of the other, on either side.
    assert not alike(given, cosines, (BEND,), (WAVE, third))
    assert not alike(given, cosines, (BEND, fourth), (WAVE, third))
    cosines[2, 3] = cosines[3, 2] = 0.95
    assert alike(given, cosines, (BEND, fourth), (WAVE, third))


def test_the_reasons_tell_which_pairs_a_set_has():
    third = replace(BEND, name="third")
    given = problem(X + 0.2 * np.sin(4 * X), (WAVE, BEND, third))
    fit = fitted(given, [BEND, WAVE])
    pairs = tuple(
        standing(evidence, 20.0, causes, fit)
        for evidence, causes in (
            (90.0, (BEND, WAVE)), (88.5, (BEND, third)), (85.0, (third, WAVE))
        )
    )  # fmt: skip
    ranking = Ranking(fitted(given), (), pairs)
    close = Fact(Code.SEVERAL_PAIRS, {"pairs": ["bend + wave", "bend + third"]})
    turned = Fact(Code.TRAINING_SUBSET, {"name": "third + wave", "joins": True})
    kept = Fact(Code.TRAINING_SUBSET, {"name": "third + wave", "joins": False})
    for reasons, causes, members in (
        ((), ("bend", "wave"), pairs[:1]),
        ((close,), ("bend", "wave", "third"), pairs[:2]),
        ((turned,), ("bend", "wave", "third"), pairs[::2]),
        # It does not explain the data, so that it has not joined the set.
        ((close, kept), ("bend", "wave", "third"), pairs[:2]),
    ):
        said = Verdict("ambiguous", causes, pairs[0], reasons, {})
        assert set_members(SimpleNamespace(verdict=said, ranking=ranking)) == [*members]


def judged(wave, bend, both, cosines=None, **first):
    """The verdict on fits of two causes and of both, by their log-evidence and misfit.

    The causes are as alike as `cosines` say, and not at all without. With `first` the wave's fit
    has other attributes.
    """
    given = problem(X + 0.2 * np.sin(4 * X), (WAVE, BEND))
    singles = [standing(*at, (each,), fitted(given, [each]))
               for at, each in ((wave, WAVE), (bend, BEND))]  # fmt: skip
    singles[0] = replace(singles[0], **first)
    pair = standing(*both, (BEND, WAVE), fitted(given, [BEND, WAVE]))
    singles.sort(key=lambda fit: -fit.log_evidence)
    ranking = Ranking(fitted(given), tuple(singles), (pair,))
    found = SimpleNamespace(found=True)
    cosines = np.eye(2) if cosines is None else cosines
    return decide(given, found, ranking, cosines, {}, lambda fit: True)
