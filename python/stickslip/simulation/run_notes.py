"""Notes of a run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip._util.note import Note
from stickslip.scenario.matter import left_out
from stickslip.simulation.note import by_seriousness
from stickslip.simulation.scenario_notes import with_those_of_files

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

MUCH_OF_FLUID = 0.1
"""Parts of the drag above which what the model leaves out of a fluid is noted. Chosen: drag of the
volume-equal sphere is no better for a block."""

FAR_FROM_A_PRIOR = 2.5
"""Standard deviations from which on a value is far from its prior. Chosen: one draw in 80 is."""


def run_notes(
    scenario: Scenario, status: str, summary: Mapping[str, Any], condition_met: bool
) -> list[Note]:
    """Notes of a run, the most serious first; none for most runs."""
    core = scenario.to_core()
    rows = _core.run_notes(core, summary, status == "ok", condition_met)
    notes = with_those_of_files(scenario, core, rows)
    return by_seriousness([*notes, *_of_fluid(scenario, summary), *_of_priors(scenario)])


def _of_priors(scenario: Scenario) -> Iterator[Note]:
    """Values where the scenario's own priors hardly have them: no range has what is beyond it."""
    priors = {} if scenario.uncertain is None else scenario.uncertain.priors
    for key, prior in priors.items():
        value, middle = float(scenario.get(key)), float(prior.value(0.0))
        far = abs(prior.coordinate(value)) > FAR_FROM_A_PRIOR
        if far if prior.has_middle else not prior.first <= value <= prior.second:
            text = (
                f"{key} = {value:g} is far from its prior {prior}. This run uses {value:g}; "
                f"predictions draw from the prior. For a run at its middle set {key} = {middle:g}"
            )
            yield Note("prior", text, value)


def _of_fluid(scenario: Scenario, summary: Mapping[str, Any]) -> list[Note]:
    if scenario.fluid is None:
        return []
    frequency = scenario.pulse_rate
    speed = math.hypot(summary["mean_velocity"], summary["mean_velocity_y"])
    beyond = left_out(scenario.fluid, scenario.robot, frequency, speed)
    text_of = {
        beyond.drag: f"swinging at {frequency:g} Hz adds {100 * beyond.drag:.0f} % to the drag and "
        f"{100 * beyond.mass:.0f} % to the mass (Stokes, 1851)",
        beyond.inertia: f"the mean speed adds {100 * beyond.inertia:.0f} % to the drag (Schiller "
        "and Naumann, 1933)",
        beyond.film: f"while it lies flat, a film as thick as the gap adds {beyond.film:.2g} times "
        "the drag, Eq. (16)",
    }
    texts = [text for size, text in text_of.items() if size > MUCH_OF_FLUID]
    head = "the fluid's inertia and film are not in the model; for a sphere of this volume "
    return [Note("fluid", head + "; ".join(texts), max(text_of))] if texts else []
