"""Running scenarios."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from os import PathLike
from pathlib import Path
from typing import Any

from stickslip import _core
from stickslip._util.arrays import worker_count
from stickslip._util.files import NETCDF_SUFFIXES, check_suffix, check_writable
from stickslip._util.messages import as_list, check_kind, meant, refuse
from stickslip._util.text import highest
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.quantities import check_fields, recorded_names
from stickslip.simulation.record_file import RecordFile, StoredRecord
from stickslip.simulation.run import SUFFIXES, Run

Progress = Callable[[float, str], object]
"""Called some twenty times a second with the fraction that is done, 0 to 1, and the stage."""

STAGE = "simulating"
"""The one stage of a simulation, a batch and a sweep."""

Condition = tuple[str, bool, float]
"""Quantity of `until`, whether it is met from below, and value."""

MOST_IN_MEMORY = 10_000_000
"""Samples that a record without a file can have, at some 170 bytes each."""

_CONDITION = re.compile(r"\s*(\w+)\s*([<>])=?\s*(\S+)\s*")


def check_progress(progress: object) -> None:
    """Refuse what cannot be called with a fraction and a stage."""
    if progress is not None and not callable(progress):
        refuse("progress", progress, "a function of a fraction and a stage")


def fraction_of(total: float, progress: Progress | None) -> Callable[[float], object] | None:
    """The core's callback of the simulated time, s, of `total` in all, s."""
    check_progress(progress)
    if progress is None:
        return None
    return lambda done: progress(min(done / total, 1.0) if total > 0.0 else 1.0, STAGE)


def check_memory(scenario: Scenario) -> None:
    """Refuse a record too long for memory."""
    rate = scenario.record.rate
    span = scenario.duration - scenario.record.from_
    if isinstance(rate, float) and rate * span > MOST_IN_MEMORY:
        raise ScenarioError(
            f"record.rate = {rate!r}: allowed is at most {MOST_IN_MEMORY} samples in memory, "
            f"here {highest(MOST_IN_MEMORY / span)} Hz; a netCDF file that is written as the run "
            "goes on, with --out or simulate(out=...), takes more"
        )


def _parsed(until: str | None, scenarios: Iterable[Scenario]) -> Condition | None:
    """The condition of a text; a ScenarioError if it is none."""
    if until is None:
        return None
    match = _CONDITION.fullmatch(until) if isinstance(until, str) else None
    quantity, above, number = match.groups() if match else ("", "", "nan")
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    known = _core.stop_quantities
    if quantity not in known or not math.isfinite(value):
        hint = "" if quantity in known else meant(quantity, known)
        example = '"x >= 3e-3" or "theta <= -1.5"'
        names = f"{', '.join(known)} (SI units and rad){hint}"
        refuse("until", until, f"a condition such as {example}, of {names}")
    if quantity in _core.plane_columns and not all(scenario.whole_plane for scenario in scenarios):
        why = "for a robot that nothing turns or pushes across: it stays in the plane y = 0"
        refuse("until", until, f"no condition of {quantity} {why}")
    if quantity == "heading" and abs(value) > math.pi:
        refuse("until", until, "a heading from -pi to pi, beyond which it goes on at -pi")
    return quantity, above == ">", value


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
        revolutions (theta over 2 pi) or heading (rad; a robot that turns on to the left jumps from
        pi to -pi, which meets ``heading <= -1``) with ``>=`` or ``<=``; ``>`` and ``<`` mean the
        same. A planar run has no y and no heading. See `Run.condition_met`, and `Run.final_state`,
        as the record may end earlier.
    out : path-like, optional
        Write the record to this file. A netCDF file (``.nc``, ``.nc4``, ``.h5``) grows while the
        run goes on, as NAME.part, with memory that does not, and gets its name at the end. What was
        recorded before Ctrl-C, another exception, a full disk or ``kill -9`` stays in NAME.part,
        see `open_run`. The run's arrays are read from the file when they are first asked for. A
        ``.csv`` file is written at the end.

    Returns
    -------
    Run
        Arrays have shape (n,) for n samples, `current` (n, 5), in SI units and radians. A
        simulation that fails is a `status` with a `message`, and holds what came before.

    Raises
    ------
    ScenarioError
        If `scenario` is not a Scenario, or `until` no condition of its robot; if the record is too
        long for memory, lacks a quantity of `record.fields`, or there is none for `out`.
    OSError
        If `out` cannot be written, or there is no room for more of it, which ends the run.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second.

    Examples
    --------
    >>> from stickslip import Drive, Scenario
    >>> run = simulate(Scenario(drive=Drive(base=0.5e-3, pulses=20)))
    >>> print(f"{run.mean_velocity * 1e3:.2f} mm/s")
    1.91 mm/s
    """
    check_kind("scenario", scenario, Scenario)
    if out is None:
        return simulate_batch([scenario], threads=1, progress=progress, until=until)[0]
    check_suffix(out, SUFFIXES)
    if scenario.record.rate == "none":
        raise ScenarioError('record.rate = "none": allowed with out is a number of Hz, or "events"')
    if Path(out).suffix.lower() in NETCDF_SUFFIXES:
        return _simulated_into(out, scenario, progress, until)
    check_writable(out)
    run = simulate_batch([scenario], threads=1, progress=progress, until=until)[0]
    run.save(out)
    return run


def _simulated_into(
    out: str | PathLike[str], scenario: Scenario, progress: Progress | None, until: str | None
) -> Run:
    """See `simulate`, with a netCDF file."""
    check_fields(scenario)
    condition = _parsed(until, [scenario])
    report = fraction_of(scenario.duration, progress)
    result = _core.RunResult()
    start = Run.of(scenario, result, until, complete=False)
    file = RecordFile(out, scenario, start.attributes())

    def ended(complete: bool, record: StoredRecord | None = None) -> Run:
        about: dict[str, Any] = {"samples": file.samples, "recorded_until": file.recorded_until}
        return Run.of(scenario, result, until, complete=complete, record=record, **about)

    try:
        _core.stream(result, scenario.to_core(), file.write, report, condition)
    except BaseException as error:
        if not file.samples:
            file.discard()
            raise
        if not isinstance(error, OSError):  # for which there may be no room
            file.describe(ended(complete=False).attributes())
        if isinstance(error, KeyboardInterrupt):
            raise KeyboardInterrupt(file.extent) from None
        raise
    file.finish(ended(complete=True).attributes())
    return ended(True, StoredRecord(out, recorded_names(scenario)))


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
        If one of `scenarios` is not a Scenario, or its record too long for memory or without a
        quantity of `record.fields`, or `until` no condition.
    ValueError
        If `threads` is not a whole number above zero.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second.
    """
    scenarios = as_list("scenarios", scenarios, "a list of Scenarios")
    for index, scenario in enumerate(scenarios):
        check_kind(f"scenario {index}", scenario, Scenario)
        check_fields(scenario)
        check_memory(scenario)
    threads = worker_count(threads, "threads")
    condition = _parsed(until, scenarios)

    cores = [scenario.to_core() for scenario in scenarios]
    report = fraction_of(sum(core.duration for core in cores), progress)
    results = _core.simulate_batch(cores, threads, report, condition)
    return [_run_of(*pair, until) for pair in zip(scenarios, results, strict=True)]


def _run_of(scenario: Scenario, result: _core.RunResult, until: str | None) -> Run:
    arrays = result.take_recording() if scenario.record.rate != "none" else {}
    dtype = scenario.record.dtype
    record = {
        name: arrays[name].astype(dtype, copy=False)
        if name != "t" and arrays[name].dtype.kind == "f"
        else arrays[name]
        for name in recorded_names(scenario)
    }
    samples = len(record["t"]) if record else 0
    end = float(record["t"][-1]) if samples else math.nan
    return Run.of(scenario, result, until, samples=samples, recorded_until=end, record=record)
