"""A run whose record goes into a file while it is simulated."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from os import PathLike
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip._util.files import NotWritten, check_suffix
from stickslip._util.one_interrupt import one_interrupt
from stickslip.errors import ScenarioError
from stickslip.simulation.record_blocks import RecordFile, RecordNotWritten, kept, record_file
from stickslip.simulation.run import SUFFIXES, Outcome, Run
from stickslip.simulation.stored_run import StoredRecord

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from stickslip.scenario.scenario import Scenario


class _NothingToKeep(Exception):
    """Nothing was recorded before the end: there is to be no file."""


class _Recording:
    """A simulation whose record goes into a file; what happens to either is kept, not raised."""

    def __init__(self, scenario: Scenario, until: str | None) -> None:
        self.samples = 0
        self.stop: BaseException | None = None  # what ended the simulation
        self.failure: OSError | None = None  # what ended the record
        self._scenario = scenario
        self._recorded_until = math.nan
        self._until = until
        self._result = _core.RunResult()

    def play(
        self,
        file: RecordFile,
        report: Callable[[float], object] | None,
        condition: tuple[str, bool, float] | None,
        no_interrupt: Callable[[], object],
    ) -> None:
        """Simulate, and fill the file with what there is."""
        core = self._scenario.to_core()
        take = functools.partial(self._take, file)
        try:
            _core.stream(self._result, core, take, report, condition)
        except BaseException as error:
            self.stop = error
        no_interrupt()
        if not self.samples:
            if self.stop is not None or self.failure is not None:
                raise _NothingToKeep
            take(self._result.take_recording())  # the columns of a record without samples
        file.finish(self.run(None))

    def _take(self, file: RecordFile, recording: dict[str, NDArray[Any]]) -> None:
        if self.failure is not None:  # the run goes on without
            return
        block = kept(self._scenario, recording)
        try:
            file.write(block)
        except OSError as error:
            self.failure = error
            return
        self.samples += len(block["t"])
        if self.samples:
            self._recorded_until = float(block["t"][-1])

    def run(self, record: StoredRecord | None) -> Run:
        cut = self.stop is not None or self.failure is not None
        outcome = Outcome.of(self._result, self._recorded_until, self._until, cut)
        if self.stop is not None and not isinstance(self.stop, KeyboardInterrupt):
            reason = " ".join(f"{type(self.stop).__name__}: {self.stop}".split())
            outcome = outcome._replace(message=f"the run was stopped by {reason}")
        return Run(self._scenario, outcome, record)

    @property
    def extent(self) -> str:
        return f"has the record up to {self._recorded_until:.6g} s"


def simulate_into(
    scenario: Scenario,
    path: str | PathLike[str],
    report: Callable[[float], object] | None,
    until: str | None,
    condition: tuple[str, bool, float] | None,
) -> Run:
    """See `simulate`, with its argument `out`; `condition` is what `until` says."""
    check_suffix(path, SUFFIXES)
    if scenario.record.rate == "none":
        raise ScenarioError('record.rate = "none": allowed with out is a number of Hz, or "events"')
    recording = _Recording(scenario, until)
    begun = written = False
    try:
        with one_interrupt() as no_interrupt, record_file(path, scenario) as file:
            begun = True
            recording.play(file, report, condition, no_interrupt)
        written = True
    except _NothingToKeep:
        pass
    except NotWritten as error:
        if not begun:
            raise
        recording.failure = recording.failure or error
    if recording.stop is not None:
        if isinstance(recording.stop, KeyboardInterrupt) and written:
            raise KeyboardInterrupt(f"{path} {recording.extent}") from None
        raise recording.stop
    run = recording.run(StoredRecord(path, scenario, recording.samples) if written else None)
    failure = recording.failure
    if failure is not None:
        own = isinstance(failure, NotWritten)  # its text names the file
        text = str(failure) if own else f"cannot write {path}: {failure.strerror or failure}"
        raise RecordNotWritten(f"{text}; it {recording.extent}" if written else text, run)
    return run
