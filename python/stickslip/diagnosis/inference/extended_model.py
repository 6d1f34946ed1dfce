"""The model with what a diagnosis has found: recalibrated constants and, perhaps, a cause."""

from __future__ import annotations

from stickslip.diagnosis.inference.findings import Findings
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys
from stickslip.scenario.scenario import Scenario


def extended_values(found: Findings) -> dict[str, float]:
    """Values of the constants and of the parameters of the claimed cause, by name, in their units.

    From data that allow no diagnosis nothing is learnt, so there are none.
    """
    if found.verdict.kind == "data-problem":
        return {}
    problem, fit = found.problem, found.verdict.fit or found.null
    values = problem.physical(fit.x[None, :])[0]
    return {problem.names[k]: float(values[k]) for k in fit.candidate.free.tolist()}


def extended_scenario(found: Findings, scenario: Scenario) -> Scenario:
    """The scenario with recalibrated constants and, where there is one, the cause.

    From data that allow no diagnosis nothing is learnt, so the scenario stays as it is. What only a
    channel has, such as a camera's offset, is no part of a scenario.

    Raises
    ------
    ScenarioError
        If the fitted values are none that a scenario can have together.
    """
    nuisances = {each.name for each in found.problem.uncertain} - set(known_keys())
    values = extended_values(found)
    changes = {name: value for name, value in values.items() if name not in nuisances}
    try:
        return scenario.replace(changes)
    except ScenarioError as error:
        raise ScenarioError(f"the extended model makes no scenario: {error}") from None
