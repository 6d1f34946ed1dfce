"""What a diagnosis is given, checked before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.model.problem import Array, Cause, Indices, Uncertain
from stickslip.diagnosis.options import Options
from stickslip.errors import ScenarioError


@dataclass(frozen=True, repr=False, eq=False)
class Trials(OneLine):
    """Checked trials, each of shape (n,).

    Values are in the observable's unit; conditions are indices 0 to m - 1, none missing; blocks are
    indices of set-ups, -1 where one is not known.
    """

    value: Array
    condition: Indices
    block: Indices | None


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
    if block is not None and block.shape != values.shape:
        raise ScenarioError("block: allowed is an index for each trial")
    trials = Trials(values, index, block)
    _check_lengths(trials, options)
    _check_names(uncertain, causes)
    return trials


def _check_lengths(trials: Trials, options: Options) -> None:
    count = int(trials.condition.max()) + 1
    further = 0 if options.auxiliary is None else len(options.auxiliary.observed)
    if options.order is not None:
        order = np.asarray(options.order)
        if order.shape != trials.value.shape or order.dtype.kind not in "iuf":
            raise ScenarioError("order: allowed is a number for each trial")
    if options.group is not None and np.shape(options.group) != (count,):
        raise ScenarioError("group: allowed is an index for each condition")
    if options.singleton_condition is not None and options.singleton_condition >= count:
        said = f"singleton_condition = {options.singleton_condition}"
        raise ScenarioError(f"{said}: allowed is an index of a condition, 0 to {count - 1}")
    settings = options.settings
    if settings is not None and not len(settings.numbers) == len(settings.kinds) == count:
        raise ScenarioError(f"settings: allowed is a row for each of {count} conditions")
    if len(options.source) not in (0, count + further):
        raise ScenarioError("source: allowed is a name for each observable")


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
            raise ScenarioError(
                f"cause {cause.name}: relaxes_prior = {cause.relaxes_prior}: {said}"
            )
        for each in cause.parameters:
            if each.name in parameters:
                raise ScenarioError(f"parameter {each.name} of two causes: allowed is one")
            parameters.add(each.name)
