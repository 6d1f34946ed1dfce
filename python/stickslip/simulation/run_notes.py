"""What stands out in a run: facts that a reader of its numbers should know."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip.scenario.named_effects import PREFIX
from stickslip.simulation.scenario_notes import scenario_notes, weight

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario


_CHANGE_WHAT_HOLDS = (
    "surface_tilt", "angle_adhesion", "adhesion_ageing", "free_adhesion_angle",
    "free_adhesion_age", "free_contact_place",
)  # fmt: skip
"""Effects on weight, adhesion or their levers, as those of a user may be too."""

MUCH_TURNING = 0.05
"""Parts of the mean velocity above which `turning_speed` is noted. With a steady heading near the
centre it is 0.5 % at most; walks whose heading turns or swings have 10 % and more, and there the
rigid body with eight corners walks differently by as much (docs/theory/steering.md)."""

LEAST_TURNING = 5e-5
"""Below this `turning_speed` is never noted, m/s: with a steady heading the model is within it."""

_UPRIGHT = "; at drive.base = 0 the holding coil alone turns it upright: set drive.base, say 5e-4"


def run_notes(scenario: Scenario, summary: dict[str, Any], condition_met: bool) -> list[str]:
    """Facts about a run, a line each; none for most runs."""
    return [
        *(_of_condition if condition_met else _of_end)(scenario, summary),
        *_of_motion(scenario, summary),
        *_of_turning(summary),
        *scenario_notes(scenario),
    ]


def _of_condition(scenario: Scenario, summary: dict[str, Any]) -> list[str]:
    start, end = scenario.window
    ended = summary["simulated_time"]
    if ended >= end:
        return []
    over = f"over {ended - start:.4g} of the {end - start:.4g} s of the measuring window only"
    before = "before the measuring window, so that nothing is measured"
    return [
        f"the run was ended by its condition at {ended:.6g} s: "
        + (before if ended <= start else f"velocity and angles are measured {over}")
    ]


def _of_end(scenario: Scenario, summary: dict[str, Any]) -> list[str]:
    finished = summary["finished_pulses"]
    start, end = scenario.window
    pulses = (
        0 if scenario.drive.mode == "program" else round((end - start) * scenario.drive.frequency)
    )
    if not finished or finished == pulses:
        return []
    return [
        f"the run ended after {finished} of the {pulses} pulses of the measuring window: there is "
        "no mean_velocity; over the pulses that were finished it is "
        f"{summary['finished_velocity'] * 1e3:.5g} mm/s (finished_velocity)"
    ]


def _of_motion(scenario: Scenario, summary: dict[str, Any]) -> list[str]:
    notes = []
    low, high = summary["theta_min"], summary["theta_max"]
    events = summary["events"]
    if summary["mean_velocity"] == 0.0 and low == high:
        moved = any(events.values())
        notes.append(
            "the robot did not move in the measuring window"
            if moved
            else f"the robot never moved: {_why_it_rests(scenario, summary)}"
        )
    elif all(summary[name] == 0.0 for name in ("slip_up", "slip_down", "slip_flat")):
        notes.append(_why_it_sticks(scenario))
    if events["roll_over"]:
        count = events["roll_over"]
        notes.append(
            f"the robot rolled over {count} time{'s' if count > 1 else ''}, forth or back: from "
            "one corner over a face to the next (roll_over)"
            + (_UPRIGHT if scenario.drive.mode == "IPP" and scenario.drive.base == 0.0 else "")
        )
    upright = 0.5 * math.pi
    if low < -upright or high > upright:
        notes.append(
            "the robot tilted beyond upright: theta from "
            f"{math.degrees(low):.1f} to {math.degrees(high):.1f} degrees in the measuring window"
        )
    return notes


def _of_turning(summary: dict[str, Any]) -> list[str]:
    turning = summary["turning_speed"]
    speed = math.hypot(summary["mean_velocity"], summary["mean_velocity_y"])
    if speed == 0.0 or not turning > max(MUCH_TURNING * speed, LEAST_TURNING):
        return []
    return [
        "the robot turned while it walked: what turning adds at its contact is not in the model, "
        f"and may change its speed along the path by up to about {1e3 * turning:.2g} mm/s "
        f"(turning_speed); straight from the start to the end of the window it made "
        f"{1e3 * speed:.3g} mm/s"
    ]


def _why_it_sticks(scenario: Scenario) -> str:
    """What holds the contact of a robot that moves without a slip."""
    contact, pull = scenario.contact, weight(scenario)
    most = contact.static_friction * (pull + contact.adhesion)
    return (
        "the contact never slipped in the measuring window: contact.static_friction = "
        f"{contact.static_friction:g} holds it with about {most:.3g} N under the weight of "
        f"{pull:.3g} N and contact.adhesion = {contact.adhesion:g} N"
    )


def _why_it_rests(scenario: Scenario, summary: dict[str, Any]) -> str:
    """What holds a robot that never moved, by the moments about the corner that it would tip on.

    The largest torque of a field is that of one across the moment, Eq. (8). A body that lies on a
    face is held by its weight and by the adhesion of the face, half the face's length away; where
    an effect changes one of these, no moment is told.
    """
    robot = scenario.robot
    field = summary["field_max"]
    if field == 0.0:
        return "there was no field"
    moment = robot.magnetization * robot.length * robot.width * robot.height
    moment *= 1.0 + float(scenario.get("effects.magnetization_scale.fraction"))
    torque = abs(moment) * field
    turns = f"the field, {1e3 * field:.3g} mT at most, turns it with at most {torque:.2g} N m"
    changing = {*_CHANGE_WHAT_HOLDS, *_core.registered_effects()}
    others = [f"{PREFIX}{name}" for name in scenario.effects if name in changing]
    if others:
        return f"{turns} against weight and adhesion, together with {', '.join(others)}"
    stands = abs(math.sin(summary["theta_max"])) > math.sqrt(0.5)
    lever = 0.5 * (robot.height if stands else robot.length)
    held = lever * (weight(scenario) + scenario.contact.adhesion)
    said = f"{turns}, and weight and adhesion hold it with {held:.2g} N m"
    if torque <= held:
        return f"{said}; a larger drive.peak or drive.hold is needed, or less contact.adhesion"
    return f"{said}, so that the field was too nearly along its moment, or too slow to tip it"
