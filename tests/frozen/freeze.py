"""Makes the frozen runs again: ``python tests/frozen/freeze.py``, or ``--check`` to compare only.

A change of the code that should change no number changes none of these, to the last bit. Where one
should, the command prints which runs it changed and by how much, and writes the file anew; the
differences of the file show the same in a review.

The bits belong to one kind of machine: the mathematics library rounds exp, sin and pow in its own
way, on one processor so and on another otherwise, steps are made with fused multiply-add or
without, and a compiler may order a sum anew. Threads and the width of packs change none. So the
file keeps what it was made on. On the same kind the bits
have to be the same; elsewhere numbers have to agree within 1e-9 of themselves and ten times what a
change of the robot's mass in its last bits makes of this run, which the file keeps too: long runs,
in which a contact is decided by rounding, are another run after that, and only end alike.
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import re
import sys
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

sys.path.append(str(Path(__file__).parents[1]))

from frozen.scenarios import register_own_effect, scenarios
from stickslip import Run, Scenario, _core, simulate_batch

FILE = Path(__file__).with_name("summaries.jsonl")

NUMBERS = (
    *("mean_velocity", "mean_velocity_y", "theta_min", "theta_max"),
    *("slip_up", "slip_down", "slip_flat", "airborne_fraction", "field_max", "field_min"),
    *("current_max", "voltage_max", "power_mean", "simulated_time"),
)
FINAL = ("x", "y", "z", "theta", "heading", "vx", "omega", "current_xp", "current_clamp")
# Counts are of the solver, not of the motion.
COUNTS = (*_core.events, "accepted_steps")
FIELDS = (*NUMBERS, *(f"final_{name}" for name in FINAL), *COUNTS)
# Below these a number is the rest of larger ones: a velocity beside 2 mm/s, an angle beside 1.
FLOOR, FLOOR_OF_ANGLES = 1e-6, 1.0
ANGLES = ("theta", "final_theta", "final_heading")

ELSEWHERE = 1e-9  # relative, between kinds of machine
# Of the mass, to see how a run answers to rounding; a step's rounding is some 1e-16.
NUDGES = (1.0 + 2.0**-51, 1.0 - 2.0**-50)


class Frozen(NamedTuple):
    """Record of a frozen run: its status, its numbers by field, and its sensitivity to rounding."""

    status: str
    numbers: Mapping[str, float]
    spread: float = 0.0  # relative; infinite where the end itself is another


def of_run(run: Run) -> Frozen:
    """Record of a run, without its sensitivity to rounding."""
    summary = run.summary()
    events = {**summary["events"], "painleve": summary["painleve_events"]}
    values = (
        *(summary.get(name, math.nan) for name in NUMBERS),
        *(getattr(run.final_state, name) for name in FINAL),
        *(events.get(name, 0) for name in _core.events),
        summary["steps"]["accepted"],
    )
    return Frozen(run.status, dict(zip(FIELDS, map(float, values), strict=True)))


def simulated(chosen: Mapping[str, Scenario], factor: float = 1.0) -> dict[str, Frozen]:
    """Runs by name, in one batch, so that they share packs. factor: of the robot's mass."""
    runs = simulate_batch(
        [each.replace({"robot.mass": factor * each.robot.mass}) for each in chosen.values()]
    )
    return {name: of_run(run) for name, run in zip(chosen, runs, strict=True)}


def with_spread(chosen: Mapping[str, Scenario]) -> dict[str, Frozen]:
    """The same with their sensitivities to rounding."""
    result = simulated(chosen)
    for factor in NUDGES:
        for name, other in simulated(chosen, factor).items():
            own = result[name]
            apart = differences(own, other)
            of_motion = [size for field, size in apart.items() if field not in COUNTS]
            most = max(of_motion, default=0.0) if own.status == other.status else math.inf
            result[name] = own._replace(spread=max(own.spread, most))
    return result


def differences(found: Frozen, expected: Frozen) -> dict[str, float]:
    """Relative sizes by field, of those that differ; NaN equals NaN.

    A field that only one of the two has is no difference: the file is made again for it.
    """
    result = {}
    for name in found.numbers.keys() & expected.numbers.keys():
        value, other = found.numbers[name], expected.numbers[name]
        if value == other or (math.isnan(value) and math.isnan(other)):
            continue
        floor = FLOOR_OF_ANGLES if name.startswith(ANGLES) else FLOOR
        size = max(abs(value), abs(other), floor)
        result[name] = abs(value - other) / size if math.isfinite(value - other) else math.inf
    return result


def changes(
    found: Mapping[str, Frozen], expected: Mapping[str, Frozen], to_the_bit: bool
) -> Iterator[str]:
    """Changes of the runs in `found`, a line each."""
    for name, run in found.items():
        other = expected.get(name)
        if other is None:
            yield f"{name}: is new"
            continue
        limit = 0.0 if to_the_bit else ELSEWHERE + 10.0 * other.spread
        if math.isinf(limit):
            continue
        if run.status != other.status:
            yield f"{name}: {run.status} instead of {other.status}"
            continue
        apart = {
            field: size
            for field, size in differences(run, other).items()
            if size > limit and (to_the_bit or field not in COUNTS)
        }
        if apart:
            worst = max(apart, key=lambda field: apart[field])
            yield (
                f"{name}: {len(apart)} numbers, most {worst} by {apart[worst]:.1e} of itself, "
                f"mean_velocity by {apart.get('mean_velocity', 0.0):.1e} "
                f"(rounding: {other.spread:.1e})"
            )


def machine() -> dict[str, str]:
    """Facts on which bits depend: processor, rounding of the mathematics, compiler, steps."""
    values = [
        function(0.37 * k)
        for k in range(1, 500)
        for function in (math.exp, math.sin, math.cos, math.log, math.sqrt, math.atan)
        if 0.37 * k < 700
    ]
    powers = [math.pow(0.37 * k, 1.7) for k in range(1, 500)]
    rounding = zlib.crc32(" ".join(map(float.hex, values + powers)).encode())
    # GCC and Clang both leave their names in what they make.
    made_by = re.search(
        rb"GCC: \([^)]*\) [0-9.]+|clang version [0-9.]+", Path(_core.__file__).read_bytes()
    )
    return {
        "processor": platform.machine(),
        "libm": f"{' '.join(platform.libc_ver())}, rounding {rounding:08x}",
        "compiler": made_by[0].decode() if made_by else "unknown",
        "fused": "no" if _core.kernel()[0] == "baseline" else "yes",
    }


def write(runs: Mapping[str, Frozen]) -> None:
    """A line a run, so that a comparison of two files shows which changed."""
    lines = [json.dumps({"machine": machine(), "fields": FIELDS})]
    for name, run in runs.items():
        numbers = " ".join(map(_text, run.numbers.values()))
        # Two digits: it is a size, and not to change the line without need.
        lines.append(json.dumps([name, run.status, float(f"{run.spread:.1e}"), numbers]))
    FILE.write_text("\n".join(lines) + "\n")


def _text(value: float) -> str:
    is_whole = value.is_integer() and abs(value) < 1e9 and str(value) != "-0.0"
    return str(int(value)) if is_whole else value.hex()


def read() -> tuple[dict[str, str], dict[str, Frozen]]:
    """The machine of the frozen runs, and the runs by name."""
    header, *lines = map(json.loads, FILE.read_text().splitlines())
    runs = {}
    for name, status, spread, numbers in lines:
        values = [float.fromhex(each) if "x" in each else float(each) for each in numbers.split()]
        runs[name] = Frozen(status, dict(zip(header["fields"], values, strict=True)), float(spread))
    return header["machine"], runs


def main() -> int:
    """See the top of the file; 1 where a check finds a difference."""
    parser = argparse.ArgumentParser(description="Make the frozen runs again, or compare them.")
    parser.add_argument("--check", action="store_true", help="compare, and write nothing")
    check = parser.parse_args().check
    register_own_effect()
    chosen = scenarios()
    made_on, expected = read() if FILE.exists() else (machine(), {})
    same_machine = made_on == machine()
    runs = simulated(chosen) if check else with_spread(chosen)
    lines = [*changes(runs, expected, to_the_bit=same_machine or not check)]
    lines += [f"{name}: is gone" for name in expected if name not in runs]
    print("\n".join(lines) or "nothing changed")
    if not same_machine:
        print(f"the file is of another kind of machine: {made_on}, this one is {machine()}")
    if not check:
        write(runs)
        print(f"{len(runs)} runs in {FILE}")
    return 1 if check and lines else 0


if __name__ == "__main__":
    sys.exit(main())
