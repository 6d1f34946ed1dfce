"""The table of walks that the model which steers is held against, with the error of each.

    PYTHONPATH=tests python -m reference.steering_table

writes `tests/data/steering_reference.json` (a quarter of an hour).

Every walk is made twice: `whole`, with edges that land as wholes (see WHOLE_EDGES), as a model
without roll has it, and `sharp`, with corners that land one by one. What the two differ by is what
roll does. Each is made with three lengths of step, each half of the one before; the result is
extrapolated to none, and its error is the largest difference of the three: switches come late by
parts of a step, so errors are of first order but scatter, and one difference is small by chance.
"""

import json
from pathlib import Path

import numpy as np

from .drive import complete_drive, voltages_of
from .eight_corners import HEADING
from .heading import TURNING_STEP, Heading, constant
from .simulate import CONTACT_DEFAULTS, DRAG_DEFAULTS, ROBOT_DEFAULTS
from .walk import HALVINGS, WHOLE_EDGES, walk

FILE = Path(__file__).parent.parent / "data" / "steering_reference.json"
SHORTEST = (4e-9, 2e-9, 1e-9)  # s; steps without events are 2^HALVINGS times as long

PULSES = 20
IPP = {
    "mode": "IPP", "frequency": 100.0, "base": 0.5e-3, "hold": 1e-3, "peak": 2.5e-3,
    "edge": "rise", "clamp": "down", "pulses": PULSES,
}  # fmt: skip
OPP = {**IPP, "mode": "OPP", "frequency": 60.0, "base": 0.3e-3, "hold": 2.5e-3}
SLOW = {**IPP, "frequency": 30.0, "edge": "fall", "clamp": "up"}
FAST_OPP = {**OPP, "frequency": 100.0, "base": 0.0, "clamp": "up"}

# Numbers that are compared across walks: m/s, m/s, m, m, rad, rad, rad.
RESULTS = ("along", "across", "shift_x", "shift_y", "lag_max", "lag_rms", "roll_max")


def _turn(drive, degrees, begin, duration):
    """A heading that turns to `degrees` from the given pulse, within some pulses."""
    start = complete_drive(drive)["ramp"] + begin / drive["frequency"]
    return Heading((start, start + duration / drive["frequency"]), (0.0, np.radians(degrees)))


def rows():
    """(name, arguments of `walk`) of every walk of the table; angles in degrees in the names."""

    def row(name, drive, heading, **more):
        heading = heading if isinstance(heading, Heading) else constant(np.radians(heading))
        return name, {"drive": drive, "heading": heading, **more}

    for angle in (0, 15, 30, 45, 60, 90, 135, 180, -30):
        yield row(f"IPP {angle}", IPP, angle)
    yield row("IPP -30, y coil behind", IPP, -30, coils="behind-y")
    for angle in (0, 30, 45):
        yield row(f"IPP {angle}, pairs", IPP, angle, coils="pairs")
    for angle in (0, 20, 45, 90, 160):
        yield row(f"OPP {angle}", OPP, angle)
    for angle in (0, 20, 45):
        yield row(f"OPP {angle}, pairs", OPP, angle, coils="pairs")
    yield row("IPP 30, 30 Hz fall up", SLOW, 30)
    yield row("OPP 30, 100 Hz up base 0", FAST_OPP, 30)
    for x, y in ((10, 0), (0, 10), (5, -7)):
        for name, drive, angle in (("IPP", IPP, 0), ("IPP", IPP, 30), ("OPP", OPP, 20)):
            place = (x * 1e-3, y * 1e-3)
            yield row(f"{name} {angle}, at ({x}, {y}) mm", drive, angle, place=place)
    yield row("IPP 30, pairs, at (5, -7) mm", IPP, 30, coils="pairs", place=(5e-3, -7e-3))
    for static in (0.1, 0.4, 0.8):
        contact = {"static_friction": static, "kinetic_friction": round(0.725 * static, 4)}
        for name, drive, angle in (("IPP", IPP, 30), ("OPP", OPP, 20)):
            yield row(f"{name} {angle}, friction {static}", drive, angle, contact=contact)
    yield row("IPP 30, adhesion 0", IPP, 30, contact={"adhesion": 0.0})
    yield row("IPP 30, restitution 0.3", IPP, 30, contact={"restitution": 0.3})
    yield row("IPP turn 0 to 30 in 0.5 pulses", IPP, _turn(IPP, 30, 5, 0.5))
    yield row("IPP turn 0 to 30 in 3 pulses", IPP, _turn(IPP, 30, 5, 3))
    yield row("IPP turn 0 to 30 in 3 pulses, pairs", IPP, _turn(IPP, 30, 5, 3), coils="pairs")
    yield row("IPP turn 0 to 90 in 5 pulses", IPP, _turn(IPP, 90, 5, 5))
    yield row("IPP turn 0 to 90 in 5 pulses, pairs", IPP, _turn(IPP, 90, 5, 5), coils="pairs")
    yield row("OPP turn 0 to 30 in 3 pulses", OPP, _turn(OPP, 30, 5, 3))
    yield row("OPP turn 0 to 90 in 5 pulses", OPP, _turn(OPP, 90, 5, 5))
    for name, drive in (("IPP", IPP), ("OPP", OPP)):
        for degrees in (30, 60):
            turn = _turn(drive, degrees, 4, 15)
            yield row(f"{name} turn 0 to {degrees} in 15 pulses", drive, turn)
    yield row("IPP turn 0 to 60 in 15 pulses, pairs", IPP, _turn(IPP, 60, 4, 15), coils="pairs")


def numbers_of(found) -> list:
    """The numbers of a `Walk` in the order of RESULTS."""
    return [
        found.along, found.across, *found.displacement, found.lag_max, found.lag_rms,
        found.roll_max,
    ]  # fmt: skip


def pulse_ends(drive: dict) -> np.ndarray:
    """When the pulses that are measured end, s, shape (n,)."""
    planar = voltages_of(drive)
    pulses = round((planar.last_counted - planar.first_counted) * drive["frequency"])
    return planar.first_counted + np.arange(1, pulses + 1) / drive["frequency"]


def result_of(arguments: dict) -> dict:
    """Results of one walk with their errors, extrapolated to no step at all; see RESULTS.

    headings: of a walk that turns, rad, of the body at the pulses' ends, with the shortest step.
    """
    walks = [walk(**arguments, shortest=shortest) for shortest in SHORTEST]
    ladder = np.array([numbers_of(found) for found in walks])
    best, error = 2 * ladder[-1] - ladder[-2], np.ptp(ladder, axis=0)
    result = {
        "values": dict(zip(RESULTS, best.tolist(), strict=True)),
        "errors": dict(zip(RESULTS, error.tolist(), strict=True)),
        "counts": walks[-1].counts,
    }
    if len(arguments["heading"].times) > 1:
        angles = np.unwrap(walks[-1].samples[:, HEADING])
        ends = pulse_ends(arguments["drive"])
        result["headings"] = np.interp(ends, walks[-1].t, angles).tolist()
    return result


def entry_of(name: str, arguments: dict) -> dict:
    """Entry of one walk in the file: all arguments of `walk`, and its result."""
    heading = arguments["heading"]
    given = {
        "drive": complete_drive(arguments["drive"]),
        "heading": {"times": list(heading.times), "angles": list(map(float, heading.angles))},
        "coils": arguments.get("coils", "single"),
        "place": list(arguments.get("place", (0.0, 0.0))),
        "contact": {**CONTACT_DEFAULTS, **arguments.get("contact", {})},
    }
    whole = result_of({**arguments, "reach": WHOLE_EDGES})
    # Twice the reach, at the first length of step: nothing, unless the roll is large.
    twice = np.array(numbers_of(walk(**arguments, reach=2 * WHOLE_EDGES, shortest=SHORTEST[0])))
    change = np.abs(twice - numbers_of(walk(**arguments, reach=WHOLE_EDGES, shortest=SHORTEST[0])))
    whole["change_with_reach"] = dict(zip(RESULTS, change.tolist(), strict=True))
    return {"name": name, **given, "whole": whole, "sharp": result_of(arguments)}


def main():
    """Make the table and write it to the file."""
    walks = []
    for name, arguments in rows():
        walks.append(entry_of(name, arguments))
        print(name, walks[-1]["whole"]["values"], flush=True)
    table = {
        "about": "eight corners, see tests/reference/steering_table.py; SI units and radians",
        "robot": ROBOT_DEFAULTS,
        "drag": DRAG_DEFAULTS,
        "shortest_steps": SHORTEST,
        "halvings": HALVINGS,
        "turning_step": TURNING_STEP,
        "whole_edges": WHOLE_EDGES,
        "walks": walks,
    }
    FILE.write_text(json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    main()
