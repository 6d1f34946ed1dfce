"""What was found beyond single statements: of the settings, and of what is wrong in the paper."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from stickslip.reproduction.criteria import MOTION
from stickslip.reproduction.field_checks import FieldChecks
from stickslip.reproduction.points import (
    KINETIC_SHARE,
    PAINLEVE_FRICTION,
    PULSES,
    SCANS,
    evaluate,
    point,
)
from stickslip.reproduction.settings import FACTORS, MODES, PEAK, Mode, Setting
from stickslip.reproduction.strokes import in_window, interval, tilt_rate
from stickslip.reproduction.survey import (
    STROKE_FREQUENCY,
    WORKING_FREQUENCIES,
    Behaviour,
    Flags,
    Survey,
)
from stickslip.reproduction.tables import table
from stickslip.scenario.sections import Environment, Robot
from stickslip.simulation.run import Run, resting_force

_UNITS = {
    "mode": "", "edge": "", "clamp": "", "base": "T", "hold": "T", "works": "",
    "velocity_30_hz": "m/s", "velocity_100_hz": "m/s", "still_tilt": "rad", "mean_tilt": "rad",
    "slip_share_up": "1", "normal_force_up": "1", "normal_force_down": "1",
}  # fmt: skip
"""Columns of the table of settings. Normal forces are over that at rest, as in `Strokes`."""


def findings(found: Survey, holds: Flags) -> list[str]:
    """Sentences on how many settings work, and on what those have in common that match best.

    `holds` says where S1 to S14 do, shape (14, settings of IPP, settings of OPP).
    """
    works = np.logical_and.outer(found["IPP"].works, found["OPP"].works)
    counts = holds.sum(axis=0)
    all_four = works & holds[:MOTION].all(axis=0)
    most = int(counts[works].max(initial=0))
    best = int((works & (counts == most)).sum())
    clamps = [np.array([each.clamp for each in found[mode].settings]) for mode in MODES]
    same_clamp = int((all_four & np.equal.outer(*clamps)).sum())
    return [
        *(
            f"{found[mode].works.sum()} of {len(found[mode].settings)} settings of {mode} "
            "work: the robot walks forwards at 30 Hz and at 100 Hz, with its tilt between flat and "
            "upright."
            for mode in MODES
        ),
        f"Of the {works.sum()} pairs of working settings, {all_four.sum()} have S1 to S4 all hold; "
        f"{same_clamp} of these have the same clamp polarity in both modes.",
        f"No pair has more than {most} of the {len(holds)} statements that depend on settings; "
        f"{best} {'has' if best == 1 else 'have'} as many.",
    ]


def settings_table(found: Survey) -> pd.DataFrame:
    """A row for every setting of the grid: what it is, and what it does."""
    parts = []
    for mode in MODES:
        each = found[mode]
        factors = zip(
            *([getattr(s, factor) for factor in FACTORS] for s in each.settings), strict=True
        )
        slow, fast = each.velocity("frequency", WORKING_FREQUENCIES).T
        by_stroke = each.tilt, each.share_up, each.normal_up, each.normal_down
        columns = (mode, *factors, each.works, slow, fast, each.still_tilt, *by_stroke)
        parts.append(pd.DataFrame(dict(zip(_UNITS, columns, strict=True))))
    return table(pd.concat(parts, ignore_index=True), _UNITS)


_DENSITY = 7400.0  # kg/m^3, Table II
_MASS_AS_PRINTED = 25.6e-12  # kg, "25.6 ng"


@dataclass(frozen=True)
class Flaw:
    """One row of the table: where it is, what is wrong, what is done here, and its effect."""

    where: str
    what: str
    done: str
    effect: str


def flaws(
    found: Survey,
    runs: Mapping[Mode, Run],
    reference: Mapping[Mode, Setting],
    checks: FieldChecks,
    threads: int,
) -> list[Flaw]:
    """The table, with numbers from the survey, the reference runs and the field."""
    return [
        Flaw(
            "Eq. (13), second line",
            "the centripetal term of the horizontal acceleration has the wrong sign",
            "the sign that differentiation gives",
            "error of the horizontal force at 30 Hz, at most, over the static friction limit at "
            "rest: " + ", ".join(f"{mode} {_sign_error(run):.0%}" for mode, run in runs.items()),
        ),
        Flaw(
            "Table II",
            'the mass is given as 25.6 "ng"; its weight of 251 nN needs micrograms',
            "25.6 µg; the density is not used",
            _effect_of_mass(reference, threads),
        ),
        *_of_the_coils(checks),
        Flaw(
            "Eqs. (17), (19)",
            "the drag torque goes with the square of the rate, without its sign: it drives a "
            "falling body on",
            "rate times its magnitude",
            "; ".join(f"{mode}: {_effect_of_unsigned_drag(run)}" for mode, run in runs.items()),
        ),
        Flaw(
            "Figs. 4 and 6",
            "edge and base of the sawtooth, field of the holding coil and sign of the clamp coil's "
            "field are not stated",
            "all are inputs; this study tries a grid of them",
            "; ".join(_effect_of_settings(*each) for each in found.items()),
        ),
        Flaw(
            "Section IV-C, Fig. 8",
            "with kinetic friction above 4/3 a sliding rectangle can have no consistent contact "
            "force",
            "such a contact is met with an impulse without collision, and counted",
            "such events in this study with kinetic friction above 4/3: "
            + ", ".join(_painleve_events(*each) for each in found.items()),
        ),
        Flaw(
            "Figs. 12 to 15",
            "the measured points are drawn, but are not in the text",
            "none is invented; digitised points can be laid over the curves",
            "agreement with the measurements is not judged here",
        ),
    ]


def _of_the_coils(checks: FieldChecks) -> list[Flaw]:
    return [
        Flaw(
            "Table I",
            "6.5 mT and 149 mT/m at the centre do not go together",
            "both follow from the geometry",
            f"at 6.5 mT the gradient is {checks.gradient_at_centre * 1e3:.0f} mT/m at the centre; "
            f"149 mT/m is met {checks.full_gradient_offset * 1e3:.1f} mm from it, and the force is "
            f"{checks.force_at_centre * 1e9:.0f} nN instead of "
            f"{checks.force_at_offset * 1e9:.0f} nN",
        ),
        Flaw(
            "Section IV-B",
            "fringe below 2.5% in a cube of 25 mm",
            "computed from all five coils at the robot's place",
            f"{checks.fringe:.1%} in that cube, {checks.fringe_small:.2%} in one of 5 mm",
        ),
    ]


def _sign_error(run: Run) -> float:
    """Greatest error of the horizontal force, over the limit of static friction at rest."""
    robot, contact = run.scenario.robot, run.scenario.contact
    seen = in_window(run)
    radius = 0.5 * math.hypot(robot.length, robot.height)
    lever = radius * np.cos(np.abs(run.theta[seen]) + math.atan(robot.height / robot.length))
    # The sign is that of the term, so the difference is twice the term.
    wrong = 2.0 * robot.mass * run.omega[seen] ** 2 * np.abs(lever)
    return float(wrong.max()) / (contact.static_friction * resting_force(run.scenario))


def _effect_of_mass(reference: Mapping[Mode, Setting], threads: int) -> str:
    robot = Robot()
    by_density = _DENSITY * robot.length * robot.width * robot.height
    as_printed = _MASS_AS_PRINTED * Environment().gravity
    drive = {"drive.peak": PEAK, "drive.frequency": STROKE_FREQUENCY, "drive.pulses": PULSES}
    points = [
        [
            point({**setting.keys(), **drive, "robot.mass": mass})
            for mass in (robot.mass, by_density)
        ]
        for setting in reference.values()
    ]
    (result,) = evaluate([np.array(points)], threads)
    change = ", ".join(
        f"{mode} {row[0]:.2f} and {row[1]:.2f} mm/s"
        for mode, row in zip(reference, result["mean_velocity"] * 1e3, strict=True)
    )
    return (
        f"as printed the weight would be {as_printed * 1e9:.3f} nN; density times "
        f"volume is {by_density * 1e9:.2f} µg, and at 30 Hz 25.6 µg and this give {change}"
    )


def _effect_of_unsigned_drag(run: Run) -> str:
    # The paper's angle is positive: where theta is not, its rate has the other sign.
    power = run.scenario.drag.rotational * tilt_rate(run) ** 3
    start, stop = run.scenario.window
    step = interval(run)
    pulses = (stop - start) * run.scenario.drive.frequency
    signed = float(np.abs(power).sum()) * step / pulses
    gained = float(-np.minimum(power, 0.0).sum()) * step / pulses
    return (
        f"with the sign it takes {signed * 1e12:.2f} pJ a pulse; without, {gained * 1e12:.2f} pJ "
        "of these are put in instead"
    )


def _effect_of_settings(mode: Mode, each: Behaviour) -> str:
    velocity = each.velocity("frequency", (30.0,))[each.works] * 1e3
    spread = (
        f", {velocity.min():.2f} to {velocity.max():.2f} mm/s at 30 Hz" if len(velocity) else ""
    )
    return f"{mode} walks forwards with {len(velocity)} of {len(each.works)} settings{spread}"


def _painleve_events(mode: Mode, each: Behaviour) -> str:
    beyond = KINETIC_SHARE * np.array(SCANS["friction"].values) > PAINLEVE_FRICTION
    events = each.painleve[:, beyond]
    return f"{mode} {events.sum()} in {events.size} simulations"
