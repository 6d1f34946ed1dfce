"""The model with what a diagnosis has found: recalibrated constants and, perhaps, a cause.

Where no cause explains the data, but a law of another shape does, it has that law.
"""

from __future__ import annotations

from stickslip.diagnosis.fit.fit_result import free_parameters, physical_covariance
from stickslip.diagnosis.inference.findings import Findings
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.uncertain import JointPrior


def extended_values(found: Findings) -> dict[str, float]:
    """Values of the constants and of the parameters of the claimed cause, by name, in their units.

    From data that allow no diagnosis nothing is learnt, so there are none.
    """
    if found.verdict.kind == "data-problem":
        return {}
    problem, fit = found.extended or (found.problem, found.null)
    values = problem.physical(fit.x[None, :])[0]
    fitted = {problem.names[k]: float(values[k]) for k in fit.candidate.free.tolist()}
    shape = found.free_shape
    return fitted if shape is None else {**fitted, **shape.term.fixed}


def extended_scenario(found: Findings, scenario: Scenario) -> Scenario:
    """The scenario with recalibrated constants and, where there is one, the cause.

    Uncertain in it is what was fitted, with the covariance by the curvature at the fit, if fits
    from several starts agree.

    From data that allow no diagnosis nothing is learnt, so the scenario stays as it is. What only
    readings have, such as a camera's offset or a wrong zero of the velocities, is no part of it.

    Raises
    ------
    ScenarioError
        If the fitted values are none that a scenario can have together.
    """
    keys = known_keys()
    changes = {name: value for name, value in extended_values(found).items() if name in keys}
    try:
        return scenario.replace(changes).with_uncertain(_posterior(found, list(changes)))
    except ScenarioError as error:
        raise ScenarioError(f"the extended model makes no scenario: {error}") from None


def _posterior(found: Findings, keys: list[str]) -> JointPrior | None:
    """The covariance of the fitted values of some keys; None where there is none to trust."""
    problem, fit = found.extended or (found.problem, found.null)
    fitted = [each for each in free_parameters(problem, fit) if each.name in keys]
    if not fitted or not fit.converged:
        return None
    matrix = physical_covariance(fit, fitted).tolist()
    return JointPrior({}, tuple(each.name for each in fitted), tuple(map(tuple, matrix)))
