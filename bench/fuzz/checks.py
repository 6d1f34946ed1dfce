"""What is asked of one scenario. Each check returns a `Found`, as a dict that JSON can hold."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

from fuzz import balances, contact_laws
from fuzz.record import recorded, recorded_together
from fuzz.scenarios import Identity, scenario
from stickslip import Run, Scenario, Solver, _core, simulate, simulate_batch

TIGHT = 1e-10
"""Relative tolerance at which balances are looked at."""

REFERENCE = 1e-11
"""Relative tolerance that the default one is compared with."""

FLOOR = 1e-6
"""m/s: a thousandth of the paper's speed. Below it a difference is taken relative to this."""

BATCH = 100
"""Runs of one `check_batch`."""

# Steps of each: a stiff scenario is to say so, not to keep the others waiting.
_SHORT_BUDGET = 3_000_000

# Runs whose records, of some 3 MB, are held at a time.
_RECORDED = 10

# Restitution from which bounces may follow each other without end.
_ELASTIC = 0.99

LARGE, NOTICEABLE = 1e-2, 1e-3
"""Relative differences of the mean velocity that are counted."""

# Statuses that a sound core may give a sound scenario of these populations.
_FINE = ("ok", "left_workspace")

Found = dict[str, Any]


def found(failures: list[str], kind: str = "", **more: Any) -> Found:
    return {"failures": failures, "kind": kind, **more}


def check_status(identity: Identity) -> Found:
    """The run ends, with a status that is known, a message, and finite numbers."""
    run = simulate(scenario(identity))
    return found(_status_failures(identity, run), run.status)


def check_batch(identity: Identity) -> Found:
    """A hundred runs together: each ends as in `check_status`, and some of them alone as well.

    Those of number n are the scenarios 100 n to 100 n + 99 of the population.
    """
    names, given = _hundred(identity)
    given = [each.replace({"record.rate": "none"}) for each in given]
    runs = simulate_batch(given, threads=1)
    failures = []
    for name, run in zip(names, runs, strict=True):
        failures += [f"{name}: {line}" for line in _status_failures(name, run)]
    for index in range(0, BATCH, BATCH // 5):
        alone = simulate(given[index])
        if repr(alone.summary()) != repr(runs[index].summary()):
            failures.append(f"{names[index]}: another summary alone than among others")
    return found(failures, f"{BATCH} runs")


def check_energy(identity: Identity) -> Found:
    """No energy across an event that no field has given, of a hundred runs at a tight tolerance."""
    names, given = _hundred(identity)
    failures = []
    judged = 0
    for first in range(0, BATCH, _RECORDED):
        some = slice(first, first + _RECORDED)
        for name, (record, _) in zip(
            names[some], recorded_together(given[some], TIGHT), strict=True
        ):
            if record is not None and record.fine:
                judged += 1
                failures += [f"{name}: {line}" for line in balances.gained(record)]
    return found(failures, f"{BATCH} runs", judged=judged)


def _hundred(identity: Identity) -> tuple[list[Identity], list[Scenario]]:
    first = BATCH * identity.number
    names = [identity._replace(number=number) for number in range(first, first + BATCH)]
    return names, [scenario(n).replace({"solver.max_steps": _SHORT_BUDGET}) for n in names]


def _status_failures(identity: Identity, run: Run) -> list[str]:
    failures = []
    if run.status not in _core.statuses:
        failures.append(f"unknown status {run.status!r}")
    if not run.message.strip():
        failures.append(f"status {run.status} has no message")
    if run.ok:
        failures += [
            f"{name} is not finite"
            for name, value in run.summary().items()
            if isinstance(value, float) and not math.isfinite(value)
        ]
    elif run.status == "too_many_steps" and _damped_within(run) < 10 * _mean_step(run):
        pass  # it is stiff, and its message says so
    elif run.status == "too_many_events" and run.scenario.contact.restitution >= _ELASTIC:
        pass  # bounces that lose nothing are ever smaller where the fluid damps them
    elif run.status not in _FINE and identity.population != "extreme":
        failures.append(f"status {run.status}: {run.message}")
    return failures


def _damped_within(run: Run) -> float:
    """In s, by the key that damps fastest; infinite if there is none."""
    found = re.search(r"damps a motion in (\S+) s", run.message)
    return float(found[1]) if found else math.inf


def _mean_step(run: Run) -> float:
    """In s, of a run that has used its budget."""
    return run.summary()["simulated_time"] / float(run.scenario.get("solver.max_steps"))


def check_invariants(identity: Identity) -> Found:
    """Contact laws at the scenario's own tolerance and a tight one; balances at the tight one."""
    given = scenario(identity)
    failures = []
    kind = ""
    for rtol in (None, TIGHT):
        record, run = recorded(given, rtol)
        if record is None:
            return found([], run.status)
        prefix = "tight: " if rtol else "default: "
        failures += [prefix + line for line in contact_laws.violations(record)]
        if rtol:
            failures += balances.violations(record)
            kind = "balanced" if record.fine else "laws alone"
    return found(failures, kind)


def check_tolerance(identity: Identity) -> Found:
    """The default tolerance against a tight one."""
    given = scenario(identity)
    return _compared(given.replace({"solver.rtol": Solver().rtol}), _tight(given))


def check_integrators(identity: Identity) -> Found:
    """Both integrators at a tight tolerance."""
    given = _tight(scenario(identity))
    return _compared(given.replace({"solver.method": "arkode"}), given)


def _tight(given: Scenario, rtol: float = REFERENCE) -> Scenario:
    return given.replace({"solver.rtol": rtol, "solver.method": "tsit5", "solver.max_step": 0.0})


def _compared(tried: Scenario, reference: Scenario) -> Found:
    """Kinds: "close", "noticeable", "large"; "sensitive" where the reference itself is unsure.

    A motion that amplifies every error, such as a tumbling block, has no mean velocity to compare:
    the default tolerance's part of the robot's mass moves it as far, and no step can do better.
    """
    first, second = simulate(tried), simulate(reference)
    if not (first.ok and second.ok):
        same = first.status == second.status
        failures = [] if same else [f"status {first.status} against {second.status}"]
        return found(failures, "not compared")
    difference = relative(first.mean_velocity, second.mean_velocity)
    more = {"difference": difference, "velocity": second.mean_velocity}
    if difference <= NOTICEABLE:
        return found([], "close", **more)
    again = simulate(
        reference.replace({"robot.mass": reference.robot.mass * (1.0 + Solver().rtol)})
    )
    if not again.ok or relative(again.mean_velocity, second.mean_velocity) > 0.1 * difference:
        return found([], "sensitive", **more)
    kind = "large" if difference > LARGE else "noticeable"
    line = f"mean velocity off by {difference:.3g} of {second.mean_velocity:.4g} m/s"
    return found([line], kind, **more)


def relative(value: float, reference: float) -> float:
    """Difference of two velocities (m/s) relative to the second, or to `FLOOR` if that is more."""
    return abs(value - reference) / max(abs(reference), FLOOR)


CHECKS: dict[str, Callable[[Identity], Found]] = {
    "status": check_status,
    "batch": check_batch,
    "energy": check_energy,
    "invariants": check_invariants,
    "tolerance": check_tolerance,
    "integrators": check_integrators,
}
"""By name, in the order in which they are tried."""

EXTREME_CHECKS = ("status",)
"""Of the population `extreme`, in which forces may be beyond any scale."""
