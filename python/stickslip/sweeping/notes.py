"""Notes of many simulations: how many of them do what one would be noted for."""

from __future__ import annotations

from stickslip.errors import ScenarioError
from stickslip.simulation.note import Note, by_seriousness
from stickslip.simulation.run_notes import FEWEST_PULSES, LIMITS
from stickslip.simulation.scenario_notes import pulses_measured, scenario_notes
from stickslip.sweeping.points import Points
from stickslip.sweeping.results import Results


def notes_of_points(points: Points, results: Results, things: str = "points") -> list[Note]:
    """The most serious first; the value of what the runs do is the number of `things` that do it.

    Notes on the scenario are those that do not depend on what is varied.
    """
    numbers = results.numbers
    beyond = {code: numbers[each.number] > each.limit for code, each in LIMITS.items()}
    beyond["velocity-grows"] &= ~beyond["field-change"]
    pulses = pulses_measured(points.at_each("drive.pulses"))
    beyond["velocity-grows"] &= pulses >= FEWEST_PULSES
    said = {code: each.of_many for code, each in LIMITS.items()}
    still = (numbers["mean_velocity"] == 0.0) & (numbers["mean_velocity_y"] == 0.0)
    beyond["rest"] = still & (numbers["theta_min"] == numbers["theta_max"])
    said["rest"] = "the robot never moved; the notes of such a run alone say why"
    counts = {code: int(holds.sum()) for code, holds in beyond.items()}
    notes = [
        Note(code, f"{count} of {points.count} {things}: {said[code]}", float(count))
        for code, count in counts.items()
        if count
    ]
    return by_seriousness([*notes, *_of_scenario(points)])


def _of_scenario(points: Points) -> list[Note]:
    ends: list[list[Note]] = []
    for place in (0, -1):
        changes = {key: points.at_each(key)[place].item() for key in points.keys}
        try:
            ends.append(scenario_notes(points.scenario.replace(changes)))
        except ScenarioError:  # a point that is refused
            return []
    first, last = ends
    return [note for note in first if note in last]
