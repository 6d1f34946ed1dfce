"""Notes on scenarios and runs: their order, and how they are printed and stored."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip._util.note import Note
from stickslip.scenario.held import HELD
from stickslip.scenario.keys import known_keys
from stickslip.scenario.matter import left_out
from stickslip.simulation.map_background import map_notes

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

MOST_SHOWN = 4
"""Notes that are printed at once; all are in `Run.notes` and in the JSON output."""

CODES = (
    # What was not simulated or measured whole.
    "record-cut", "condition-not-met", "window-cut",
    # A robot that does not walk.
    "rest-no-field", "rest-no-moment", "rest-torque", "rest-adhesion", "rest-drag", "rest-friction",
    "rest",
    "no-pulses", "flight", "no-friction", "dragged", "pulled", "backward", "roll-over",
    "beyond-upright", "no-slip",
    # A motion whose mean velocity says less than it seems to.
    "field-change", "velocity-grows", "turning", "start-up", "window-short", "pulses-short",
    "fluid", "inner",
    # Other values that are probably mistakes.
    "map-background", "map-turned", "period-end", "unusual", "prior",
    "capacitor", "voltage", "density", "moment", "steep-surface", "adhesion",
    "tangential-restitution", "tolerance",
    # Facts, without a fault.
    "map",
)  # fmt: skip
"""Codes of the notes of runs, the most serious first."""

STEADY_PULSES = 4
"""Fewest pulses whose measuring window, from the end of the third, has no start-up; section VII."""

MUCH_OF_FLUID = 0.1
"""Parts of the drag above which what the model leaves out of a fluid is noted. Chosen: drag of the
volume-equal sphere is no better for a block."""

FAR_FROM_A_PRIOR = 2.5
"""Standard deviations from which on a value is far from its prior. Chosen: one draw in 80 is."""


def scenario_notes(scenario: Scenario) -> list[Note]:
    """Notes on values of a scenario that are probably mistakes; none for most scenarios."""
    rows = _core.scenario_notes(scenario.to_core())
    notes = [*(Note(*row) for row in rows), *_of_files(scenario)]
    return [*notes, *_unusual(scenario, notes)]


def _unusual(scenario: Scenario, others: Iterable[Note]) -> Iterator[Note]:
    """Notes on values far from the usual ones, of which no other note has the name."""
    changed = scenario.to_core().changed().items()
    found: list[Any] = [(name, known_keys()[name].usual, value) for name, value in changed]
    for held in scenario.held.values():
        found += getattr(held, "values", [])
    for name, usual, value in found:
        if usual is None or not value or any(name in note.text for note in others):
            continue
        low, high, unit = usual
        if not low <= abs(value) <= high:
            text = f"{name} = {value:g} {unit} is far from the usual {low:g} to {high:g}"
            yield Note("unusual", f"{text} {unit}: is it in SI units?", value)


def _of_files(scenario: Scenario) -> Iterator[Note]:
    """Notes on what the core does not know: a measured map, and tables of a period."""
    if scenario.coil.map is not None:
        yield from map_notes(scenario.coil.map)
        yield Note("map", f"the field of the coils is that of {scenario.coil.map}")
    for key, held in scenario.held.items():
        if end := getattr(held, "missing_end", None):
            text = (
                f"{HELD[key].file}: its last row is not the first again, and one more step would "
                f"join them, so that the period of {held.period:.6g} s, its last time, may be a "
                f"step too short; add the first row again at t = {end:.6g} s"
            )
            yield Note("period-end", text, end)


def peak_voltages(scenario: Scenario) -> dict[str, float]:
    """Largest magnitude of the voltage that the drive asks of each coil, V."""
    return dict(zip(_core.coil_names, scenario.to_core().commanded_voltages(), strict=True))


def run_notes(
    scenario: Scenario, status: str, summary: Mapping[str, Any], condition_met: bool
) -> list[Note]:
    """Notes of a run, the most serious first; none for most runs."""
    rows = _core.run_notes(scenario.to_core(), summary, status == "ok", condition_met)
    notes = (*(Note(*row) for row in rows), *_of_files(scenario))
    notes = (*notes, *_of_fluid(scenario, summary), *_of_priors(scenario))
    return by_seriousness([*notes, *_unusual(scenario, notes)])


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
        beyond.drag: f"the swing at {frequency:g} Hz adds {100 * beyond.drag:.0f} % to the drag "
        f"and {100 * beyond.mass:.0f} % to the mass (Stokes, 1851)",
        beyond.inertia: f"the mean speed adds {100 * beyond.inertia:.0f} % to the drag (Schiller "
        "and Naumann, 1933)",
        beyond.film: f"while it lies flat, a film as thick as the gap adds {beyond.film:.2g} times "
        "the drag, Eq. (16) of Pawashe, Floyd and Sitti (2008)",
    }
    texts = [text for size, text in text_of.items() if size > MUCH_OF_FLUID]
    head = "the fluid's inertia and film are not in the model; for a sphere of this volume, "
    return [Note("fluid", head + "; ".join(texts), max(text_of))] if texts else []


def resting_force(scenario: Scenario) -> float:
    """Normal force on a body that lies still without field: weight and adhesion, N."""
    return scenario.robot.mass * scenario.environment.gravity + scenario.contact.adhesion


def by_seriousness(notes: Iterable[Note]) -> list[Note]:
    """The most serious first."""
    ranks = {code: rank for rank, code in enumerate(CODES)}
    return sorted(notes, key=lambda note: ranks.get(note.code, len(CODES)))


def shown_lines(notes: Iterable[Note]) -> list[str]:
    """The notes that are printed, a line each, and how many more there are."""
    texts = [note.text for note in by_seriousness(notes)]
    more = len(texts) - MOST_SHOWN
    return texts[:MOST_SHOWN] + ([f"{more} more notes; --json has all"] if more > 0 else [])


def notes_json(notes: Iterable[Note]) -> str:
    """Notes as the attribute of a netCDF file has them."""
    return json.dumps([note.as_dict() for note in notes])


def lines_of_json(text: str) -> list[str]:
    """`shown_lines` of such an attribute."""
    return shown_lines(Note(**values) for values in json.loads(text))
