"""What differs between two states of a machine, `before` and `after`: one problem of both.

A cause is one difference: a constant that has another value after, or an effect, an instrument or
an event that is there on one side only. What both sides share cancels. Where each table has one of
the same settings on the other side, or of the same times and inputs, their differences are what is
fitted, so that errors of the model that both have cancel too. Elsewhere both are fitted as they
are, and where no difference explains them, causes that both may have are tried as well.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pandas import DataFrame

from stickslip._util.arrays import Array, Indices
from stickslip._util.messages import check_whole
from stickslip._util.prior import Prior
from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.entry import diagnosed_with, stated_terms
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.fitting.search import Progress, recalibrated
from stickslip.diagnosis.model import Predict, Values, bare_problem, posed, tables_in
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter, either_way
from stickslip.diagnosis.terms.words import Vocabulary, Words
from stickslip.errors import ScenarioError

SIDES = BEFORE, AFTER = "before", "after"
_WHERE = {BEFORE: "only before", AFTER: "only after", "both": "before and after"}
"""Words behind the name of a cause, and what they mean."""

_RELAXED = 5.0
"""Times the stated error of a constant within which it is likely: what both sides share need not be
as stated. Chosen: twenty errors off cost eight nats, which all models pay."""

_USUAL = 0.1
"""A usual difference, as a part of a constant. Chosen, as for the effects of `models`."""

_WIDER = 3.0
"""Of the error of a fit, where a cause of the earlier side may have bent it. Chosen."""

_DIGITS = 6  # in which equal settings agree
_LEAST = 1e-9  # of a size, below which an error is none


def diagnose_change(
    predict: Predict,
    before: Table | Sequence[Table],
    after: Table | Sequence[Table],
    uncertain: Sequence[Parameter] | None = None,
    causes: Sequence[Cause] = (),
    *,
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Diagnose what changed between two logs, or sets of logs, of one machine.

    Constants are shared by both sides. Each that may be a cause may have changed (``<name>
    change``), and each effect and instrument may be there on one side only (``<name> before``,
    ``<name> after``); where both sides have what no difference explains, in both (``<name> both``).
    In `Diagnosis.extended` are the parameters of each side.

    Parameters
    ----------
    predict, uncertain, causes, seed, progress
        As for `diagnose_model`. A law of a free shape is no cause here.
    before, after : Table, Series, or sequence of them
        Where each has a counterpart with equal settings, or with equal times and inputs, errors of
        the model that are the same in both do not count.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ScenarioError
        If something is given that is not allowed.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Parameter, Prior, Table, diagnose_change
    >>> x = np.linspace(1.0, 3.0, 12)
    >>> def line(table, p):
    ...     return p["slope"] * table["x"]
    >>> slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    >>> logs = [Table({"x": x}, k * x + np.sin(9 * x), sd=0.1) for k in (1.0, 1.3)]
    >>> result = diagnose_change(line, *logs, [slope])
    >>> result.verdict.kind, result.verdict.causes
    ('named', ('slope change',))
    """
    check_whole("seed", seed)
    tables = [*_of_side(before, BEFORE), *_of_side(after, AFTER)]
    stated = stated_terms(predict, uncertain, causes, tables)
    # The names of tables are those of their sides below.
    of_all = stated[1]
    if isinstance(of_all, Sequence):
        of_all = [one for one in of_all if getattr(one, "table", None) is None]
    return diagnosed_with(
        predict, tables, lambda _: (stated[0], of_all), int(seed), progress,
        lambda found: posed_change(found, lambda _: predict, *stated, int(seed)),
    )  # fmt: skip


def _of_side(given: Any, side: str) -> list[Table]:
    tables = tables_in(side, given)
    several = len(tables) > 1
    return [(one.having(name=f"{k}") if several and not one.name else one).of_side(side)
            for k, one in enumerate(tables, start=1)]  # fmt: skip


class TwoSides(Rivals):
    """A forward model of tables of both sides, with all differences but of instruments."""

    def __init__(
        self, predict: Predict, constants: Sequence[Parameter], causes: Iterable[Cause]
    ) -> None:
        self.predict, self.constants = predict, constants
        self.jumps = getattr(predict, "jumps", False)
        self.differences = [cause for cause in causes if not cause.is_instrument]

    @property
    def cheap(self) -> TwoSides | None:
        """The same by a cheaper model, if there is one."""
        low = getattr(self.predict, "cheap", None)
        return None if low is None else TwoSides(low, self.constants, self.differences)

    def __call__(self, table: Table, p: Mapping[str, Array]) -> Array:
        vectors, own = max(map(len, p.values()), default=1), self.values(table.side, p)
        rows = {name: np.broadcast_to(value, (vectors, 1)) for name, value in own.items()}
        return self.predict(table, Values(rows))

    def values(self, side: str, p: Mapping[str, Any]) -> dict[str, Any]:
        """Parameters of the model on a side, where absent differences are not in `p`."""
        known = {one.name for cause in self.differences for one in cause.parameters}
        own = {name: value for name, value in p.items() if name not in known}
        for cause in self.differences:
            first, there = cause.parameters[0], cause.side in ("", side)
            acts = p.get(first.name, first.middle) != first.middle
            for one in cause.parameters:
                name, value = _old(one.name), p.get(one.name, one.middle)
                before = own.setdefault(name, one.middle)
                if there and one is first and not one.falls:
                    own[name] = before + value - one.middle
                elif there:  # the last that acts has its shape
                    own[name] = np.where(acts, value, before)
        for constant in self.constants:
            if constant.name in own:
                own[constant.name] = np.clip(own[constant.name], constant.low, constant.high)
        return own

    def sides(self, values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
        told = {*values, *map(_old, values)}
        return {side: {name: float(value) for name, value in self.values(side, values).items()
                       if name in told} for side in SIDES}  # fmt: skip

    def extended(self, values: Mapping[str, Any], covariance: DataFrame | None) -> Any:
        return self.sides(values)


def posed_change(
    tables: Sequence[Table], make: Callable[[Sequence[Table]], Predict],
    constants: Sequence[Parameter], causes: Sequence[Cause], seed: int, *, alike: bool = True,
    words: Vocabulary | None = None, kind: Callable[..., TwoSides] = TwoSides,
) -> Problem:  # fmt: skip
    """The problem of two sides, whose tables say of which they are.

    `make` returns the forward model of some tables; `kind` is that of both sides. They are `alike`
    where nothing but their settings tells what a table was measured with.
    """
    paired, words = _paired(tables) if alike else [], words or Vocabulary()
    every = list(_differences(constants, causes, [table.name for table in tables], words))
    listed = [one for one in every if one.side and not (paired and _undone(one))]
    # Constants have half of the prior probability that something changed. Chosen: a machine that
    # wears or is loaded has another constant, and seldom a new effect.
    changes = sum(one.changes is not None for one in listed)
    odds = max(len(listed) / max(changes, 1) - 1.0, 1.0)
    listed = [replace(one, odds=odds if one.changes else one.odds) for one in listed]
    model = kind(make(paired or tables), constants, every)
    made = posed(
        paired or tables, model, [_relaxed(one, paired) for one in constants], listed,
        low_fidelity=model.cheap, rivals=model, words=_words(words, every),
        laws=None if paired else lambda *_: [cause for cause in every if not cause.side],
    )  # fmt: skip
    if paired:
        before = [table for table in tables if table.side == BEFORE]
        model = TwoSides(make(before), constants, every)
        first = bare_problem(before, model, constants, (), model.cheap)
        stated = {one.name for one in constants if one.is_stated}
        made = replace(made, constants=_as_before(made.constants, first, stated, seed))
    return replace(made, forward=None)


def _differences(
    constants: Sequence[Parameter], causes: Sequence[Cause], tables: Sequence[str],
    words: Vocabulary,
) -> Iterator[Cause]:  # fmt: skip
    told = Words(words, causes)
    for constant in constants:
        if constant.cause and not constant.each_record:
            middle, far = constant.value(np.array([0.0, 1.0])).tolist()
            size = max(abs(far - middle), _USUAL * abs(middle))
            change = either_way(f"{constant.name} change", constant.unit, size)
            meaning = f"a change of {told.parameter(constant.name)}"
            yield Cause(change.name, (change,), meaning, side=AFTER, changes=constant.name)
    for cause in causes:
        if cause.curve is not None or cause.frees is not None:
            raise ScenarioError(f"cause {cause.name}: allowed is no law of a free shape here")
        if cause.table is not None and not {f"{one} {cause.table}" for one in SIDES} & {*tables}:
            raise ScenarioError(f"cause {cause.name}: there is no table {cause.table}")
        for word, where in _WHERE.items():
            table = cause.table and f"{word} {cause.table}"
            if table is None or table in tables:
                meaning = f"{told.title(cause.name)} {where}"
                yield replace(_copy(cause, word), table=table, meaning=meaning)


def _copy(cause: Cause, word: str) -> Cause:
    """A cause that acts where a word says, with parameters of its own."""
    names = {one.name: re.sub(r"(?=\.[^.]*$|$)", f" {word}", one.name, count=1)
             for one in cause.parameters}  # fmt: skip

    def own(p: Mapping[str, Array]) -> dict[str, Array]:
        return {old: p[new] for old, new in names.items()}

    read, acts = cause.read, cause.acts
    return replace(
        cause, name=f"{cause.name} {word}", side=word if word in SIDES else "",
        parameters=tuple(replace(one, name=names[one.name]) for one in cause.parameters),
        read=read and (lambda readings, predicted, p, of: read(readings, predicted, own(p), of)),
        acts=acts and (lambda signal, p: acts(signal, own(p))),
    )  # fmt: skip


def _old(name: str) -> str:
    """The name in the model of a parameter of a difference."""
    return re.sub(rf" ({'|'.join(_WHERE)}|change)(?=(\.[^.]*)?$)", "", name)


def _undone(cause: Cause) -> bool:
    """Whether a cause of the earlier side is one of the later side with the other sign."""
    first = cause.parameters[0]
    return cause.side == BEFORE and first.is_amplitude and not (first.one_sided or first.falls)


def _words(words: Vocabulary, causes: Sequence[Cause]) -> Vocabulary:
    """The words of a model, with those of differences."""
    rows, constants = dict(words.causes), dict(words.constants)
    for cause in causes:
        name, _, word = cause.name.rpartition(" ")
        row = (words.constants if cause.changes else words.causes).get(name)
        if row is not None:
            where = f"{_WHERE[word].capitalize()}: {row['finding']}" if word in _WHERE else ""
            rows[cause.name] = {"remedy": "", "sizes": {}, **row, "name": cause.meaning,
                                "finding": where}  # fmt: skip
            constants |= {one.name: words.constants[_old(one.name)] for one in cause.parameters
                          if _old(one.name) in words.constants}  # fmt: skip
            if cause.changes:
                constants[cause.name] = {**row, "name": cause.meaning.removeprefix("a ")}
    return replace(words, causes=rows, constants=constants)


def _relaxed(constant: Parameter, paired: Sequence[Table]) -> Parameter:
    """A constant that is no cause by itself, and elsewhere than in pairs need not be as stated."""
    prior = constant.prior
    if prior is None or constant.each_record:
        return constant
    wider = {"normal": _RELAXED * prior.second, "log-normal": prior.second**_RELAXED}
    second = prior.second if paired else wider.get(prior.kind, prior.second)
    return replace(constant, prior=Prior(prior.kind, prior.first, second), cause=False)


def _as_before(
    constants: Sequence[Parameter], problem: Problem, stated: Collection[str], seed: int
) -> tuple[Parameter, ...]:
    """The constants as the earlier side has them, as well known as they are stated.

    Those of which a range is stated, and those of the earlier records, to which pairs of tables
    refer, are as well known as their fit, with what it misses.
    """
    fit = recalibrated(problem, seed)[0]
    scatter = math.sqrt(fit.chi2 / max(len(problem.y) - len(fit.free), 1))
    if all(errors.known for errors in problem.errors):
        scatter = max(scatter, 1.0)
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)).tolist()
    priors = {}
    for one, x, error in zip(problem.constants, fit.x.tolist(), sd, strict=False):
        reach = 1.0 if one.name in stated else min(_WIDER * scatter * error, 1.0) or 1.0
        low, value, high = one.value(x + reach * np.array([-1.0, 0.0, 1.0])).tolist()
        prior = Prior("normal", value, max(0.5 * (high - low), _LEAST * abs(value), 1e-300))
        if one.prior is not None and one.prior.kind != "normal":
            prior = Prior("log-normal", value, max(math.sqrt(high / low), 1.0 + _LEAST))
        priors[one.name] = prior
    return tuple(replace(one, prior=priors.get(one.name, one.prior)) for one in constants)


def _paired(tables: Sequence[Table]) -> list[Table]:
    """A table of differences for each of the later side; none unless every table has its like."""
    rest, made = [table for table in tables if table.side == BEFORE], []
    for table in tables[len(rest) :]:
        keys = _keys(table)
        alike = (one for one in rest if type(one) is type(table) and {*_keys(one)} == {*keys}
                 and len({*keys}) == len(keys) == len(one.mean))  # fmt: skip
        like = next(alike, None)
        if like is None:
            return []
        rest.remove(like)
        places = {key: k for k, key in enumerate(_keys(like))}
        made.append(_less(table, like, np.array([places[key] for key in keys])))
    return [] if rest else made


def _keys(table: Table) -> list[tuple[str, ...]]:
    """The settings of each condition, or the time and the inputs of each reading, to be equal."""
    columns: list[Sequence[Any]] = [values for values, _ in table.named_settings.values()]
    if isinstance(table, Series):
        steps = np.round((table.t - table.t[0]) / table.step, 6)
        columns = [steps.tolist(), *(table.inputs[name].tolist() for name in sorted(table.inputs))]
    texts = [[one if isinstance(one, str) else f"{float(one) + 0.0:.{_DIGITS}g}" for one in column]
             for column in columns]  # fmt: skip
    return list(zip(*texts, strict=True)) if texts else [()] * len(table.mean)


def _less(after: Table, before: Table, order: Indices) -> Table:
    """Readings of one table less those of the conditions of another."""
    off, one, other = before.mean[order], after.errors, before.errors
    covariance, dof, sd = None, 0.0, np.hypot(one.sd, other.sd[order])
    if one.covariance is not None or other.covariance is not None:
        parts = [np.diag(each.sd**2) if each.covariance is None else each.covariance
                 for each in (one, other)]  # fmt: skip
        covariance = parts[0] + parts[1][np.ix_(order, order)]
    if one.known and other.known:  # as Satterthwaite has it
        spread = sum(float(np.mean(each.sd**2)) ** 2 / each.dof for each in (one, other))
        dof = float(np.mean(sd**2)) ** 2 / spread if spread else math.inf
    sizes = {"s0": math.hypot(*(each.sizes.get("s0", 0.0) for each in (one, other)))}
    return after.having(
        y=after.y - off[after.condition], mean=after.mean - off, repeat_of=None,
        errors=Errors(sd, covariance, dof, sizes, (*one.notes, *other.notes)),
        less=(before, order), own_notes=(*before.own_notes, *after.own_notes),
    )  # fmt: skip
