"""What stands out in a run: facts that a reader of its numbers should know."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip.scenario.sections import Solver

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

HIGH_VOLTAGE = 200.0
"""Voltages of the drive above this are noted, V; Table I's 6.5 mT need 67.5 V."""

LOOSE_TOLERANCE = 1e-5
"""Values of solver.rtol above this are noted: with base 0.5 mT and 20 pulses at 20 to 150 Hz the
mean velocity is off by up to 0.1 % at 1e-5, by 1 % at 1e-4 and by 8 % at 1e-3."""


STEADY_PULSES = 4
"""Fewest pulses whose measuring window, from the end of the third, has no start-up; section VII."""


def counts_start_up(scenario: Scenario) -> bool:
    """Whether a pulsed drive is so short that its measuring window begins after the ramp."""
    return scenario.drive.mode != "program" and scenario.drive.pulses < STEADY_PULSES


def run_notes(scenario: Scenario, summary: dict[str, Any], condition_met: bool) -> list[str]:
    """Facts about a run, a line each; none for most runs."""
    return [
        *(_of_condition if condition_met else _of_end)(scenario, summary),
        *_of_motion(summary),
        *_of_drive(scenario),
        *_of_contact(scenario),
        *_of_solver(scenario),
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
    if not math.isnan(summary["mean_velocity"]):
        return [
            f"mean_velocity is extrapolated from {finished} of the {pulses} pulses of the "
            "measuring window, which went on steadily (solver.velocity_error); all other numbers "
            "are over these alone"
        ]
    return [
        f"the run ended after {finished} of the {pulses} pulses of the measuring window: there is "
        "no mean_velocity; over the pulses that were finished it is "
        f"{summary['finished_velocity'] * 1e3:.5g} mm/s (finished_velocity)"
    ]


def _of_motion(summary: dict[str, Any]) -> list[str]:
    notes = []
    low, high = summary["theta_min"], summary["theta_max"]
    events = summary["events"]
    if summary["mean_velocity"] == 0.0 and low == high:
        moved = any(events.values())
        notes.append(
            "the robot did not move in the measuring window" if moved else "the robot never moved"
        )
    if events["roll_over"]:
        count = events["roll_over"]
        notes.append(
            f"the robot rolled over {count} time{'s' if count > 1 else ''}, forth or back: from "
            "one corner over a face to the next (roll_over)"
        )
    upright = 0.5 * math.pi
    if low < -upright or high > upright:
        notes.append(
            "the robot tilted beyond upright: theta from "
            f"{math.degrees(low):.1f} to {math.degrees(high):.1f} degrees in the measuring window"
        )
    return notes


def _of_drive(scenario: Scenario) -> list[str]:
    notes = []
    if counts_start_up(scenario):
        notes.append(
            f"drive.pulses = {scenario.drive.pulses} is fewer than {STEADY_PULSES}: the measuring "
            "window begins after the ramp and includes the start-up"
        )
    for name, volts in peak_voltages(scenario).items():
        if volts > HIGH_VOLTAGE:
            amperes = volts / scenario.coil.resistance
            notes.append(
                f"the drive asks for {volts:.4g} V at coil {name}, {amperes:.4g} A in the steady "
                "state"
            )
    return notes


def _of_contact(scenario: Scenario) -> list[str]:
    back = scenario.contact.tangential_restitution
    rebounds = scenario.contact.restitution or scenario.get("effects.restitution.coefficient")
    if back == 0.0 or rebounds:
        return []
    return [
        f"contact.tangential_restitution = {back:g} has no effect while contact.restitution is 0: "
        "only a corner that rebounds gives slip back"
    ]


def _of_solver(scenario: Scenario) -> list[str]:
    rtol = scenario.solver.rtol
    if rtol <= LOOSE_TOLERANCE:
        return []
    return [
        f"solver.rtol = {rtol:g} is looser than {LOOSE_TOLERANCE:g}: the mean velocity may be off "
        f"by a per cent or more; the default, {Solver().rtol:g}, is recommended"
    ]


def peak_voltages(scenario: Scenario) -> dict[str, float]:
    """Largest magnitude of the voltage that the drive asks of each coil, V."""
    return dict(zip(_core.coil_names, scenario.to_core().asked_voltages(), strict=True))
