"""Running scenarios."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from os import PathLike

from stickslip import _core
from stickslip._util.messages import check_kind, refuse
from stickslip._util.numbers import worker_count
from stickslip._util.text import highest
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.record_blocks import kept, recorded_names
from stickslip.simulation.run import Outcome, Run

Progress = Callable[[float, str], object]
"""Called some twenty times a second with the fraction that is done, 0 to 1, and the stage."""

STAGE = "simulating"
"""The one stage of a simulation, a batch and a sweep."""


def fraction_of(total: float, progress: Progress | None) -> Callable[[float], object] | None:
    """What the core calls with the simulated time, s, where all of it comes to `total`, s."""
    if progress is None:
        return None
    return lambda done: progress(min(done / total, 1.0) if total > 0.0 else 1.0, STAGE)


_CONDITION = re.compile(r"\s*(\w+)\s*([<>]=)\s*(\S+)\s*")


OF_THE_WHOLE_PLANE = ("y", "heading")
"""Quantities of a condition that a robot which stays in one plane does not have."""


def _check_whole_plane(until: str, quantity: str, scenarios: Iterable[Scenario]) -> None:
    if all(each.turns for each in scenarios):
        return
    refuse(
        "until",
        until,
        f"no condition of {quantity} for a robot that nothing turns or pushes across: it stays in "
        "the plane y = 0",
    )


def parsed_condition(
    until: str | None, scenarios: Iterable[Scenario]
) -> tuple[str, bool, float] | None:
    """Quantity, whether it is met from below, and value; a ScenarioError for what is none."""
    if until is None:
        return None
    found = _CONDITION.fullmatch(until) if isinstance(until, str) else None
    if found is not None and found[1] in _core.stop_quantities:
        try:
            value = float(found[3])
        except ValueError:
            value = math.nan
        if math.isfinite(value):
            if found[1] in OF_THE_WHOLE_PLANE:
                _check_whole_plane(until, found[1], scenarios)
            if found[1] == "heading" and abs(value) > math.pi:
                refuse("until", until, "a heading from -pi to pi, beyond which it goes on at -pi")
            return found[1], found[2] == ">=", value
    allowed = (
        'a condition such as "x >= 3e-3" or "theta <= -1.5", of time (s), x, y, z (m), theta, '
        "heading (rad)"
    )
    refuse("until", until, f"{allowed} or turns")


MOST_IN_MEMORY = 10_000_000
"""Samples that a record without a file can have, at some 170 bytes each."""


def check_memory(scenario: Scenario) -> None:
    """Refuse a record that memory is not meant to hold."""
    rate = scenario.record.rate
    span = scenario.duration - scenario.record.from_
    if isinstance(rate, float) and rate * span > MOST_IN_MEMORY:
        raise ScenarioError(
            f"record.rate = {rate!r}: allowed is at most {MOST_IN_MEMORY} samples in memory, "
            f"here {highest(MOST_IN_MEMORY / span)} Hz; a file that is written as the run goes on, "
            "with --out or simulate(out=...), takes more"
        )


def simulate(
    scenario: Scenario,
    progress: Progress | None = None,
    *,
    until: str | None = None,
    out: str | PathLike[str] | None = None,
) -> Run:
    """Simulate one scenario: from its initial state to the end of its drive.

    Coil currents by Eq. (1), their field by Eqs. (2)-(7), the wrench on the moment by (8)-(9), the
    motion by (10)-(12) with drag (18)-(19), and contact resolved as in section IV-C, with stick,
    slip, flight and impact as events (Pawashe, Floyd and Sitti, RSS 2008). The centripetal term of
    Eq. (13) has the sign that differentiation gives.

    Parameters
    ----------
    scenario : Scenario
        What to simulate.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1, and the stage, "simulating", some twenty
        times a second. What it raises stops the simulation and passes through.
    until : str, optional
        Ends the run earlier where a condition is met, which is located like any other event:
        ``"x >= 3e-3"``, or another of time (s), x, y, z (m, of the centre of mass), theta (rad),
        turns (theta over 2 pi) or heading (rad, from -pi to pi; a robot that turns on to the left
        jumps from pi to -pi, which meets ``heading <= -1``) with ``>=`` or ``<=``. A robot that
        stays in one plane has no y and no heading. See `Run.condition_met`.
    out : path-like, optional
        Write the record to this file while the run goes on, with memory that does not grow: a
        netCDF file (``.nc``, ``.nc4``, ``.h5``) or ``.csv``, as `Run.save` writes them. What was
        recorded before Ctrl-C, another exception or a failure of the simulation is kept, and
        marked as incomplete. The run's arrays are read from the file when they are first asked for.

    Returns
    -------
    Run
        Arrays have shape (n,) for n samples, `current` (n, 5), in SI units and radians. A
        simulation that fails is a `status` with a `message`, and holds what came before.

    Raises
    ------
    ScenarioError
        If `scenario` is not a Scenario, or `until` no condition of its robot; if the record is too
        long for memory, or there is none for `out`.
    OSError
        If `out` cannot be written. If that shows during the run, as where the disk is full, the run
        goes on without its record and is the error's attribute `run`.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second.

    Examples
    --------
    >>> from stickslip import Drive, Scenario
    >>> run = simulate(Scenario(drive=Drive(base=0.5e-3, pulses=20)))
    >>> print(f"{run.mean_velocity * 1e3:.2f} mm/s")
    1.91 mm/s
    """
    if out is None:
        return simulate_batch([scenario], threads=1, progress=progress, until=until)[0]
    from stickslip.simulation.recording_to_file import simulate_into

    check_kind("scenario 0", scenario, Scenario)
    condition = parsed_condition(until, [scenario])
    report = fraction_of(scenario.duration, progress)
    return simulate_into(scenario, out, report, until, condition)


def simulate_batch(
    scenarios: Iterable[Scenario],
    threads: int | None = None,
    progress: Progress | None = None,
    *,
    until: str | None = None,
) -> list[Run]:
    """Simulate many scenarios at once. Results are bit-identical for any number of threads.

    Parameters
    ----------
    scenarios : iterable of Scenario
    threads : int, optional
        How many simulations go on at a time; as many as there are processors, if not given.
    progress : callable, optional
        As for `simulate`, with the fraction of all simulated time.
    until : str, optional
        As for `simulate`, for each of them.

    Returns
    -------
    list of Run
        In the order of `scenarios`. One that fails is a status, not an exception.

    Raises
    ------
    ScenarioError
        If one of `scenarios` is not a Scenario, or its record too long for memory, or `until` no
        condition.
    ValueError
        If `threads` is not a whole number above zero.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second.
    """
    scenarios = list(scenarios)
    for index, scenario in enumerate(scenarios):
        check_kind(f"scenario {index}", scenario, Scenario)
        check_memory(scenario)
    threads = worker_count(threads, "threads")
    condition = parsed_condition(until, scenarios)

    cores = [scenario.to_core() for scenario in scenarios]
    report = fraction_of(sum(core.duration for core in cores), progress)
    results = _core.simulate_batch(cores, threads, report, condition)
    return [_run_of(*pair, until) for pair in zip(scenarios, results, strict=True)]


def _run_of(scenario: Scenario, result: _core.RunResult, until: str | None) -> Run:
    # Empty arrays would cost a run without a record the import of numpy.
    if not recorded_names(scenario):
        return Run(scenario, Outcome.of(result, math.nan, until), None)
    record = kept(scenario, result.take_recording())
    recorded_until = float(record["t"][-1]) if len(record["t"]) else math.nan
    return Run(scenario, Outcome.of(result, recorded_until, until), record)
