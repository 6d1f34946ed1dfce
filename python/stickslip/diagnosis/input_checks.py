"""What a diagnosis is given, checked before anything is computed."""

from __future__ import annotations

import inspect
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.one_line import brief
from stickslip.diagnosis.data.trials import Trials
from stickslip.diagnosis.model.free_terms import FreeTerm
from stickslip.diagnosis.model.instruments import Instrument, ReadModel
from stickslip.diagnosis.model.problem import Cause, Uncertain
from stickslip.diagnosis.options import Options
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import meant


def check_inputs(
    observed: ArrayLike, uncertain: Sequence[Uncertain], causes: Sequence[Cause], options: Options
) -> Trials:
    """The trials, if all that is given fits together.

    Raises
    ------
    ScenarioError
        If shapes do not fit, a name comes twice or nothing finite was observed.
    """
    try:
        values = np.asarray(observed, dtype=float)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.ndim != 1 or not len(values) or not np.all(np.isfinite(values)):
        raise ScenarioError("observed: allowed is one row of finite numbers")
    given = options.condition
    index = np.arange(len(values)) if given is None else np.asarray(given, dtype=np.int64)
    if index.shape != values.shape or set(index.tolist()) != set(range(int(index.max()) + 1)):
        raise ScenarioError("condition: allowed is an index from 0 for each trial, none missing")
    block = None if options.block is None else np.asarray(options.block, dtype=np.int64)
    order = None if options.order is None else np.asarray(options.order)
    run = None if options.run is None else np.asarray(options.run, dtype=np.int64)
    trials = Trials(values, index, block, order, run)
    _check_lengths(trials, options)
    _check_names(uncertain, causes)
    return trials


def check_terms(
    terms: Sequence[FreeTerm], uncertain: Sequence[Uncertain], causes: Sequence[Cause]
) -> None:
    """Check free terms beside the parameters and causes of a model of one's own.

    Raises
    ------
    ScenarioError
        If something else is given, `factor_of` is no uncertain parameter, or a name comes twice: of
        a term, of its knots, of a constant, of a cause or of a parameter of one.
    """
    _check_names(uncertain, causes)
    if not isinstance(terms, Sequence) or not all(isinstance(each, FreeTerm) for each in terms):
        raise ScenarioError("free_terms: allowed is a list of FreeTerm")
    own = [name for each in terms for name in (each.name, *each.knots)]
    names = [*own, *(each.name for each in uncertain), *(each.name for each in causes)]
    names += [each.name for cause in causes for each in cause.parameters]
    twice = next((name for name in own if names.count(name) > 1), None)
    if twice is not None:
        raise ScenarioError(f"free_terms: {twice} comes twice; allowed is once")
    constants = {each.name for each in uncertain}
    for each in terms:
        if each.factor_of is not None and each.factor_of not in constants:
            said = f"factor_of = {each.factor_of}: allowed is the name of an uncertain parameter"
            hint = meant(each.factor_of, constants)
            raise ScenarioError(f"free term {each.name}: {said}{hint}")


def check_predict(name: str, predict: object, *arguments: str) -> None:
    """Refuse a model that does not take the arguments that it is called with.

    Raises
    ------
    ScenarioError
        With the arguments that it takes, and those that it is given.
    """
    wanted = f"allowed is a function of ({', '.join(arguments)})"
    if not callable(predict):
        raise ScenarioError(f"{name} = {brief(predict)}: {wanted}")
    try:
        taken = inspect.signature(predict)
    except (TypeError, ValueError):  # some compiled functions do not say
        return
    try:
        taken.bind(*arguments)
    except TypeError:
        raise ScenarioError(f"{name} takes {taken}: {wanted}") from None


def check_instruments(predict: object, causes: Sequence[Cause]) -> None:
    """Refuse causes that are not the instruments that read a model, in their order, at the end.

    The columns of the parameters are in the order of the causes, so that others would be mistaken
    for them.

    Raises
    ------
    ScenarioError
        With the instruments of the model and those of the causes.
    """
    if not isinstance(predict, ReadModel):
        return
    read = [each.name for each in predict.instruments]
    last = [each.name for each in causes[max(len(causes) - len(read), 0) :]]
    other = [each.name for each in causes[: -len(read)] if isinstance(each, Instrument)]
    if last != read or (read and other):
        listed = [*other, *last]
        raise ScenarioError(
            f"causes: the last ones are {', '.join(listed) or 'none'}; allowed are, in this order, "
            f"the instruments that read the model: {', '.join(read)}"
        )


def _check_lengths(trials: Trials, options: Options) -> None:
    shape, order, group = trials.value.shape, trials.order, options.group
    settings, single = options.settings, options.singleton_condition
    count = int(trials.condition.max()) + 1
    rows = count + (0 if options.auxiliary is None else len(options.auxiliary.observed))
    rules = (
        ("block: allowed is an index for each trial",
         trials.block is None or trials.block.shape == shape),
        ("run: allowed is an index for each trial",
         trials.run is None or trials.run.shape == shape),
        ("order: allowed is a number for each trial",
         order is None or (order.shape == shape and order.dtype.kind in "iuf")),
        ("group: allowed is an index for each condition",
         group is None or np.shape(group) == (count,)),
        (f"singleton_condition = {single}: allowed is an index of a condition, 0 to {count - 1}",
         single is None or single < count),
        (f"settings: allowed is a row for each of {count} conditions",
         settings is None or len(settings.numbers) == len(settings.kinds) == count),
        ("source: allowed is a name for each observable", len(options.source) in (0, rows)),
    )  # fmt: skip
    for rule, holds in rules:
        if not holds:
            raise ScenarioError(rule)


def _check_names(uncertain: Sequence[Uncertain], causes: Sequence[Cause]) -> None:
    for key, kind, given in (("uncertain", Uncertain, uncertain), ("causes", Cause, causes)):
        if not isinstance(given, Sequence) or not all(isinstance(each, kind) for each in given):
            raise ScenarioError(f"{key}: allowed is a list of {kind.__name__}")
        names = [each.name for each in given]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ScenarioError(f"{key}: {', '.join(twice)} comes twice; allowed is once")
    constants = {each.name for each in uncertain}
    parameters: set[str] = set()
    for cause in causes:
        if cause.name in constants | {"none", "unknown"}:
            said = "allowed is a name that is no uncertain parameter's, nor none or unknown"
            raise ScenarioError(f"cause {cause.name}: {said}")
        if cause.relaxes_prior is not None and cause.relaxes_prior not in constants:
            said = "allowed is the name of an uncertain parameter"
            hint = meant(cause.relaxes_prior, constants)
            raise ScenarioError(
                f"cause {cause.name}: relaxes_prior = {cause.relaxes_prior}: {said}{hint}"
            )
        for each in cause.parameters:
            if each.name in parameters:
                raise ScenarioError(f"parameter {each.name} of two causes: allowed is one")
            parameters.add(each.name)
