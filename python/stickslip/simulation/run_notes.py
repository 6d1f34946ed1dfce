"""Notes of a run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stickslip._util.note import Note
from stickslip.scenario.matter import left_out
from stickslip.simulation.note import by_seriousness
from stickslip.simulation.note_table import Facts, notes_of_table
from stickslip.simulation.scenario_notes import scenario_notes

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

MUCH_TURNING = 0.05
"""Parts of the mean velocity above which `turning_speed` is noted. With a steady heading near the
centre it is 0.5 % at most; walks whose heading turns or swings have 10 % and more, and there the
rigid body with eight corners walks differently by as much (docs/theory/steering.md)."""

MUCH_OF_FLUID = 0.1
"""Parts of the drag above which what the model leaves out of a fluid is noted. Chosen: drag of the
volume-equal sphere is no better for a block."""

MUCH_OF_INNER = 0.05
"""Parts of the robot's mass above which an inner mass that has no inertia across its line is noted,
where the robot tilts by more than this, rad, or flies as much of the time. Chosen."""

LEAST_TURNING = 5e-5
"""Below this `turning_speed` is never noted, m/s: with a steady heading the model is within it."""


def run_notes(
    scenario: Scenario, status: str, summary: Mapping[str, Any], condition_met: bool
) -> list[Note]:
    """Notes of a run, the most serious first; none for most runs."""
    facts = Facts(scenario, summary, status == "ok")
    return by_seriousness(
        [
            *(_of_condition(scenario, summary) if condition_met else []),
            *notes_of_table(facts, "run"),
            *_of_turning(summary),
            *_of_fluid(scenario, summary),
            *_of_inner(scenario, summary),
            *scenario_notes(scenario, facts),
        ]
    )


def _of_condition(scenario: Scenario, summary: Mapping[str, Any]) -> list[Note]:
    start, end = scenario.window
    ended = summary["simulated_time"]
    if ended >= end:
        return []
    over = f"over {ended - start:.4g} of the {end - start:.4g} s of the measuring window only"
    before = "before the measuring window, so that nothing is measured"
    text = f"the run was ended by its condition at {ended:.6g} s: " + (
        before if ended <= start else f"velocity and angles are measured {over}"
    )
    return [Note("window-cut", text, ended)]


def _of_turning(summary: Mapping[str, Any]) -> list[Note]:
    turning = summary["turning_speed"]
    speed = math.hypot(summary["mean_velocity"], summary["mean_velocity_y"])
    if speed == 0.0 or not turning > max(MUCH_TURNING * speed, LEAST_TURNING):
        return []
    text = (
        "the robot turned while it walked: what turning adds at its contact is not in the model, "
        f"and may change its speed along the path by up to about {1e3 * turning:.2g} mm/s "
        f"(turning_speed); straight from the start to the end of the window it made "
        f"{1e3 * speed:.3g} mm/s"
    )
    return [Note("turning", text, turning)]


def _of_inner(scenario: Scenario, summary: Mapping[str, Any]) -> list[Note]:
    share = scenario.inner.mass / scenario.robot.mass
    tilt = max(summary["theta_max"], -summary["theta_min"])
    if not (share > MUCH_OF_INNER and max(tilt, summary["airborne_fraction"]) > MUCH_OF_INNER):
        return []
    text = (
        f"the inner mass, {100 * share:.3g} % of the robot's, has no inertia across its line, and "
        "the robot does not only slide along it: it turns by up to "
        f"{math.degrees(tilt):.2g} degrees and flies {100 * summary['airborne_fraction']:.2g} % of "
        "the time"
    )
    return [Note("inner", text, share)]


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
