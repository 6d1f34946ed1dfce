"""The two ways into a diagnosis: of a measurement, and of data with a model of one's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.processor_count import worker_count
from stickslip.diagnosis.inference.cause_or_law import judged_beside_laws, looks_for_laws
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.free_term_search import search_terms
from stickslip.diagnosis.inference.model_comparison import Progress
from stickslip.diagnosis.input_checks import check_instruments, check_predict, check_terms
from stickslip.diagnosis.measurement_problem import diagnose_measurement
from stickslip.diagnosis.model.free_terms import (
    FreeTerm,
    PredictWithCurves,
    with_curves,
    with_flat_curves,
)
from stickslip.diagnosis.model.problem import Cause, Uncertain
from stickslip.diagnosis.observables import Combined
from stickslip.diagnosis.options import Options, changed
from stickslip.diagnosis.pipeline import run_steps
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.results import Diagnosis
from stickslip.errors import ScenarioError
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import check_whole, shown

# Fewest conditions for each knot of a curve that gets more of them. Chosen: so many tell a knot.
_CONDITIONS_A_KNOT = 3


def diagnose(
    measurement: Measurement,
    *,
    seed: int = 0,
    threads: int | None = None,
    free_shapes: bool = False,
    progress: Progress | None = None,
) -> Diagnosis:
    """Diagnose a measurement with the simulator and its library of causes.

    Parameters
    ----------
    measurement : Measurement
        From `read_measurement` or `Measurement.from_dataframe`.
    seed : int
        From 0, of random draws: see `Options`. The result does not depend on `threads`.
    threads : int, optional
        Simulations at a time; as many as there are processors, if not given.
    free_shapes : bool
        Whether curves of a free shape are fitted at the laws of the model too, see
        `Diagnosis.open_set`. Where no single cause explains the data they are in any case.
    progress : callable, optional
        ``progress(fraction, stage)`` is told the fraction that is done and what comes next.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ScenarioError
        If `measurement` is none, nothing was measured that the diagnosis can use, or `seed` is not
        allowed.
    ValueError
        If `threads` is not a whole number above zero.
    """
    if not isinstance(measurement, Measurement):
        raise ScenarioError(
            f"measurement = {shown(measurement)}: allowed is a Measurement; "
            "Measurement.from_dataframe(...) or read_measurement(path) makes one"
        )
    check_whole("seed", seed)
    found, posed = diagnose_measurement(
        measurement, seed, worker_count(threads, "threads"), progress, free_shapes
    )
    return Diagnosis(found, posed, measurement)


def diagnose_model(
    predict: PredictWithCurves,
    conditions: Any,
    observed: ArrayLike,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause] = (),
    options: Options | None = None,
    *,
    free_terms: Sequence[FreeTerm] = (),
    **changes: Any,
) -> Diagnosis:
    """Diagnose measured data with a forward model of one's own.

    Parameters
    ----------
    predict : callable
        ``predict(conditions, parameters)`` takes parameters of shape (vectors, parameters), the
        uncertain ones and then those of all causes in their order and units, and returns
        observables of shape (vectors, m). What it cannot compute is NaN. With `free_terms` it is
        called as ``predict(conditions, parameters, curves)``, and ``curves["friction over speed"]``
        is a function of the argument, of shape (m,) or (vectors, ...), to values of shape (vectors,
        ...). So is `low_fidelity` of the options.
    conditions : Any
        Handed to `predict` as it is; m conditions.
    observed : array_like, shape (n,)
        Trials, in the observable's unit.
    uncertain : sequence of Uncertain
    causes : sequence of Cause
        To them a suspect is added for every uncertain parameter whose prior is not a mere range.
    options : Options, optional
        What is known of the trials beside their values, and how to look.
    free_terms : sequence of FreeTerm
        Places where a law may have another shape than the model says. Where no single cause
        explains the data a curve is fitted at each: see `Diagnosis.open_set`. In the search for
        causes the curves are zero.
    **changes
        Any attribute of `Options`, such as ``condition=index`` or ``sd=errors``, in its place.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ScenarioError
        If shapes do not fit, an option is not allowed or nothing finite was observed.
    TypeError
        If there is no option of a name; the nearest one is named.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Cause, CauseParameter, Prior, Uncertain, diagnose_model
    >>> x = np.linspace(1.0, 3.0, 12)
    >>> def line(x, p):
    ...     return p[:, :1] * x + p[:, 1:2] * np.sin(5 * x)
    >>> slope = Uncertain("slope", Prior("normal", 1.0, 0.1))
    >>> wave = Cause("wave", (CauseParameter("wave.height", "-", -5, 5, 0.5),))
    >>> result = diagnose_model(line, x, x + np.sin(5 * x), [slope], [wave], sd=np.full(12, 0.1))
    >>> result.verdict.kind, result.verdict.causes
    ('named', ('wave',))
    """
    chosen = changed(options, changes)
    check_terms(free_terms, uncertain, causes)
    arguments = ("conditions", "parameters", *(["curves"] if free_terms else []))
    check_predict("predict", predict, *arguments)
    if chosen.low_fidelity is not None:
        check_predict("low_fidelity", chosen.low_fidelity, *arguments)
    check_instruments(predict, causes)
    flat, low = predict, chosen.low_fidelity
    if free_terms:
        flat = with_flat_curves(predict, free_terms)
        low = None if low is None else with_flat_curves(low, free_terms)
    without = replace(chosen, low_fidelity=low)
    found = run_steps(flat, conditions, observed, uncertain, causes, without)
    names = found.problem.names
    # What the rows of such a model stand for is not known here.
    posed = PosedProblem(Combined(flat, names, names, ()), [], None, np.zeros(0), ())
    if free_terms and looks_for_laws(found):
        found, posed = _with_terms(found, posed, predict, chosen, free_terms)
    return Diagnosis(found, posed, None)


def _with_terms(
    found: Findings,
    posed: PosedProblem,
    predict: PredictWithCurves,
    options: Options,
    free_terms: Sequence[FreeTerm],
) -> tuple[Findings, PosedProblem]:
    """The free terms of a model of one's own at the recalibrated one, and the model with them."""
    say = options.progress or (lambda fraction, stage: None)
    say(0.9, "laws of a free shape")
    bent, low = with_curves(predict, free_terms, found.problem.causes), options.low_fidelity
    if low is not None:
        low = with_curves(low, free_terms, found.problem.causes)
    terms = [each.term(found.problem.uncertain) for each in free_terms]
    shapes = search_terms(found, options, bent, low, terms)
    if shapes is not None and shapes.is_too_coarse(found.null):
        # A law that data of little noise show may bend more than its knots can follow.
        first = next(each for each in free_terms if each.name == shapes.first.term.name)
        if _CONDITIONS_A_KNOT * first.finer.count <= len(found.noise.mean):
            finer = [first.finer if each is first else each for each in free_terms]
            return _with_terms(found, posed, predict, options, finer)
    names = [each.name for each in found.problem.uncertain]
    names += [knot for each in terms for knot in each.knots]
    say(1.0, "done")
    extended = replace(posed, bent=Combined(bent, names, names, ()))
    return judged_beside_laws(replace(found, open_set=shapes)), extended
