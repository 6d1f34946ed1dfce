"""Differences between two states of a machine, `before` and `after`: one problem of both.

A cause is one difference, such as ``load[after]``: what is added on one side to a constant or an
effect that has the name before the bracket. Where each table has one of the same settings on the
other side, or of the same times and inputs, their differences are fitted, so that errors of the
model that both have cancel. Elsewhere both are fitted as they are, and where no difference explains
them, causes that both may have are tried as well.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.arrays import Array, Indices
from stickslip._util.messages import check_whole
from stickslip._util.note import Note
from stickslip._util.prior import Prior
from stickslip._util.units import unit_label
from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.entry import diagnosed, fault_of, one_blas_thread, prepared, stated_terms
from stickslip.diagnosis.fitting.problem import Cached, Problem
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.fitting.scatter import with_scatter
from stickslip.diagnosis.fitting.search import Progress
from stickslip.diagnosis.fitting.starts import recalibrated
from stickslip.diagnosis.model import Predict, tables_in, without_effect
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter, either_way
from stickslip.diagnosis.terms.words import Vocabulary, Words
from stickslip.errors import ScenarioError

SIDES = BEFORE, AFTER = "before", "after"

_RELAXED = 5.0
"""Times the stated error of a constant within which it is likely: what both sides share need not be
as stated. Chosen: twenty errors off cost eight nats, which all models pay."""

_USUAL = 0.1
"""A usual difference, as a part of a constant. Chosen, as for the effects of `models`."""

_FACTOR = 1.5  # within which a constant is likely of which a range is stated; chosen
_DIGITS = 6  # in which equal settings agree


def diagnose_change(
    predict: Predict, before: Table | Sequence[Table], after: Table | Sequence[Table],
    uncertain: Sequence[Parameter] | None = None, causes: Sequence[Cause] = (), *, seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:  # fmt: skip
    """Diagnose what changed between two logs, or sets of logs, of one machine.

    Constants are shared. A difference is ``name[after]`` or ``name[before]``: another value of a
    constant after, an effect or an instrument of one side. Causes of both sides are as listed.
    `Diagnosis.extended` has the parameters of each side.

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
    """
    check_whole("seed", seed)
    both = [tables_in(*one) for one in ((BEFORE, before), (AFTER, after))]
    stated = stated_terms(predict, uncertain, causes, [*both[0], *both[1]])
    with one_blas_thread():
        ready = [prepared(predict, tables, stated, int(seed)) for tables in both]
        problems = [problem for problem, _ in ready]
        faults = [fault for _, fault in ready]
        faults += [fault_of(problem, True) for problem in problems]
        shared = [one.name for one in stated[0] if not one.each_record]
        made = posed_change(problems, shared, int(seed), _words(predict, problems[1].constants))
        fault = next(filter(None, faults), None)
        made = made if fault else with_scatter(made, int(seed))
        return diagnosed(made, int(seed), progress, without_effect(made), fault=fault)


@dataclass(frozen=True, eq=False)
class TwoSides(Rivals):
    """The problems of both sides, each as if it were alone.

    `order` has of each condition after the one before whose reading is taken off; None where both
    are fitted as they are. `known` are parameters that are not fitted.
    """

    problems: Sequence[Problem]
    order: Indices | None
    known: Mapping[str, float]
    shared: Collection[str]

    def of_side(self, k: int, p: Mapping[str, Any]) -> dict[str, Any]:
        """Parameters of the problem of a side; absent differences need not be given."""
        side, own = f"[{SIDES[k]}]", {}
        for one in self.problems[k].constants:
            value = p.get(one.name, 0.0) + p.get(one.name + side, 0.0)
            own[one.name] = np.clip(value, one.low, one.high)
        for cause in self.problems[k].causes:
            acts = None  # whether the first, its size, is there
            for one in cause.parameters:
                both, more = p.get(one.name, one.middle), p.get(one.name + side, one.middle)
                acts = more != one.middle if acts is None else acts
                # Sizes add up; the last that acts has its shape.
                adds = one.is_amplitude and not one.falls
                own[one.name] = both + more - one.middle if adds else np.where(acts, more, both)
        return own

    def predicted(self, names: Sequence[str], cheap: bool, values: Array) -> Array:
        """Predictions of fitted readings, (vectors, n), for values by name, (vectors, names)."""
        p, each = {**self.known, **dict(zip(names, values.T, strict=True))}, []
        for k, problem in enumerate(self.problems):
            own = self.of_side(k, p)
            rows = [np.broadcast_to(own[name], len(values)) for name in problem.names]
            model = problem.low_fidelity if cheap and problem.low_fidelity else problem.model
            each.append(model(np.stack(rows, axis=1)))
        return np.hstack(each) if self.order is None else each[1] - each[0][:, self.order]

    def wider(self, problem: Problem, more: Sequence[Cause]) -> Problem:
        """The same with further causes."""
        made = replace(problem, causes=(*problem.causes, *more))
        model, cheap = (Cached(partial(self.predicted, made.names, k)) for k in (False, True))
        return replace(made, model=model, low_fidelity=self.problems[0].low_fidelity and cheap)

    def sides(self, values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
        p = {**self.known, **values} if values else {}
        return {side: {name: float(value) for name, value in self.of_side(k, p).items()
                       if not p.keys().isdisjoint((name, *(f"{name}[{one}]" for one in SIDES)))}
                for k, side in enumerate(SIDES)}  # fmt: skip

    def extended(self, values: Mapping[str, Any], covariance: Any) -> Any:
        each = zip(self.problems, self.sides(values).items(), strict=True)
        return {side: problem.rivals.extended(own, None) for problem, (side, own) in each}

    def writers(self, folder: Path, told: str, causes: str, extended: Any) -> dict[Path, Any]:
        each = zip(self.problems, extended.values(), strict=True)
        made = [problem.rivals.writers(folder, told, causes, own) for problem, own in each]
        return made[0] | made[1]


def posed_change(
    problems: Sequence[Problem], shared: Collection[str], seed: int, words: Vocabulary,
    alike: bool = True,
) -> Problem:  # fmt: skip
    """The problem of what changed from one to the other, which have the `shared` constants.

    They are `alike` where nothing but their settings tells what a table was measured with.
    """
    pairs, order = _paired(problems) if alike else ([], [])
    tables = pairs or [one.having(name=f"{side} {one.name}".rstrip(), side=side)
                       for side, problem in zip(SIDES, problems, strict=True)
                       for one in problem.tables]  # fmt: skip
    known: dict[str, float] = {}
    if pairs:  # as the earlier side has them
        values = problems[0].physical(recalibrated(problems[0], seed)[0].x[None, :])[0].tolist()
        known = dict(zip((one.name for one in problems[0].constants), values, strict=False))
    constants = {
        name: replace(one, name=name) if name != one.name else _free(one, known.get(name))
        for side, problem in zip(SIDES, problems, strict=True) for one in problem.constants
        for name in [one.name if one.name in shared else f"{one.name}[{side}]"]
    }  # fmt: skip
    fixed = {f"{name}[{BEFORE}]": value for name, value in known.items() if name not in shared}
    fitted = tuple(one for name, one in constants.items() if name not in fixed)
    both = TwoSides(problems, np.concatenate(order) if pairs else None, fixed, shared)
    laws = [replace(cause, table=None) for cause in problems[1].causes if cause.parameters]
    whole = Problem(
        tuple(tables), problems[1].model, fitted, wider=both.wider, rivals=both,
        laws=None if pairs else lambda *_: laws, words=replace(words, nouns=True),
        finer={f"{name}{at}": size for problem in problems for name, size in problem.finer.items()
               for at in ("", f"[{BEFORE}]", f"[{AFTER}]")},
    )  # fmt: skip
    return both.wider(whole, _differences(problems, shared, words, bool(pairs)))


def _differences(
    problems: Sequence[Problem], shared: Collection[str], words: Vocabulary, paired: bool
) -> list[Cause]:
    told, changes, effects = Words(words, problems[1].causes), [], []
    for one in problems[1].constants:
        if one.name in shared and one.cause:
            middle, far = one.value(np.array([0.0, 1.0])).tolist()
            size = max(abs(far - middle), _USUAL * abs(middle))
            change = either_way(f"{one.name}[{AFTER}]", one.unit, size)
            meaning = f"a change of {told.parameter(one.name)}"
            changes.append(Cause(change.name, (change,), meaning))
    of_sides = [(side, one) for side, problem in zip(SIDES, problems, strict=True)
                for one in problem.causes if not one.is_constant]  # fmt: skip
    for side, cause in of_sides:
        if cause.curve is not None:
            raise ScenarioError(f"cause {cause.name}: allowed is no law of a free shape here")
        first = cause.parameters[0]
        # Of differences one of the earlier side is one of the later with the other sign, but for a
        # delay: late before is after an edge, early afterwards before it.
        signed = not (first.one_sided or first.falls or first.unit == "s")
        if paired and side == BEFORE and signed:
            continue
        own = tuple(replace(one, name=f"{one.name}[{side}]") for one in cause.parameters)
        meaning = f"{told.title(cause.name)} only {side}"
        effects.append(replace(cause, name=f"{cause.name}[{side}]", parameters=own, table=None,
                               meaning=meaning))  # fmt: skip
    # Constants have half of the prior probability that something changed. Chosen: a machine that
    # wears or is loaded has another constant, and seldom a new effect.
    odds = max(len(effects) / max(len(changes), 1), 1.0)
    return [*(replace(one, odds=odds) for one in changes), *effects]


def _words(predict: Predict, constants: Sequence[Parameter]) -> Vocabulary:
    """Constants by the meanings that a model gives them, or else by their names."""
    terms = getattr(getattr(predict, "kind", None), "every", {})
    rows = {one.name: {"name": terms[one.name].meaning if one.name in terms else f"`{one.name}`",
                       "unit": unit_label(one.unit)} for one in constants}  # fmt: skip
    return Vocabulary(constants=rows, units={row["unit"]: 1.0 for row in rows.values()})


def _free(constant: Parameter, value: float | None) -> Parameter:
    """A shared constant, which is no cause: as stated about a known value, or else wider.

    One that is uniform stays so.
    """
    prior = constant.prior
    assert prior is not None
    if value is not None and prior.kind != "uniform":
        known = replace(prior, first=value) if prior.has_middle else None
        prior = known or Prior("log-normal", value, _FACTOR)
    elif value is None and prior.has_middle:
        wider = _RELAXED * prior.second if prior.kind == "normal" else prior.second**_RELAXED
        prior = replace(prior, second=wider)
    return replace(constant, prior=prior, cause=False)


def _paired(problems: Sequence[Problem]) -> tuple[list[Table], list[Indices]]:
    """A table of differences for each after, and the conditions before that are taken off, of all
    tables; none unless every table has its like."""
    before, made, order = problems[0], [], []
    rest = {k: _keys(table) for k, table in enumerate(before.tables)}
    for table in problems[1].tables:
        keys = _keys(table)
        k = next((k for k, one in rest.items() if keys and {*one} == {*keys}), None)
        if k is None:
            return [], []
        places = {key: place for place, key in enumerate(rest.pop(k))}
        own = np.array([places[key] for key in keys])
        made.append(_less(table, before.tables[k], own))
        order.append(before.rows[k].start + own)
    return ([], []) if rest else (made, order)


def _keys(table: Table) -> list[tuple[Any, ...]]:
    """The settings of each condition, or the time and the inputs of each reading, to be equal; none
    where two are the same."""
    columns: list[Sequence[Any]] = [values for values, _ in table.named_settings.values()]
    if isinstance(table, Series):
        steps = np.round((table.t - table.t[0]) / table.step, 6)
        columns = [steps.tolist(), *(table.inputs[name].tolist() for name in sorted(table.inputs))]
    texts = [[one if isinstance(one, str) else f"{float(one) + 0.0:.{_DIGITS}g}" for one in column]
             for column in columns]  # fmt: skip
    keys = [(type(table), *row) for row in zip(*texts, strict=True)]
    return keys if len({*keys}) == len(keys) == len(table.mean) else []


def _less(after: Table, before: Table, order: Indices) -> Table:
    """Readings of one table less those of the conditions of another."""
    off, one, other = before.mean[order], after.errors, before.errors
    sd = np.hypot(one.sd, other.sd[order])
    parts = [np.diag(each.sd**2) if each.covariance is None else each.covariance
             for each in (one, other)]  # fmt: skip
    independent = one.covariance is None and other.covariance is None
    covariance = None if independent else parts[0] + parts[1][np.ix_(order, order)]
    dof = one.dof + other.dof if one.known and other.known else 0.0
    notes = tuple({str(note): note for note in (*one.notes, *other.notes)}.values())
    sizes = {"s0": math.hypot(*(each.sizes.get("s0", 0.0) for each in (one, other)))}
    same = Note("same-readings", "Both sides have the same readings: is one file given twice?")
    return after.having(
        y=after.y - off[after.condition], mean=after.mean - off, less=(before, order),
        errors=Errors(sd, covariance, dof, sizes, notes),
        own_notes=(*before.own_notes, *after.own_notes, *[same] * (not np.any(after.mean - off))),
        side=f"{AFTER} less {BEFORE}",
        name=f"{AFTER} {after.name}".rstrip() + f" less {BEFORE} {before.name}".rstrip(),
    )  # fmt: skip
