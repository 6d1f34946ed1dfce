"""A bar on standard error for whatever takes longer than two seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

from stickslip.cli.common import say
from stickslip.simulation.simulate import STAGE

PATIENCE = 2.0
"""Time that passes without a bar, s. Chosen: a shorter wait needs no explanation."""

_OF_A_FRACTION = "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"
_OF_POINTS = (
    "{desc}: {percentage:3.0f}% |{bar}| {n_fmt}/{total_fmt}, {rate_fmt}, {elapsed} < {remaining}"
)


class ProgressBar:
    """A context, and the function that is called in it with the part that is done and the stage.

    `fraction` is the part that is done, 0 to 1, and `stage` what is being done. With a number of
    `points` the bar shows their count, its rate and the time left. Points that are done at the
    first call were done by an earlier sweep, and do not count in the rate.

    Ctrl-C is told on standard error, with the text that it carries, or else with what `kept` says
    of the stage that was reached: which files are there.
    """

    def __init__(
        self,
        stage: str = STAGE,
        points: int = 0,
        kept: Callable[[str], str] = lambda stage: "nothing written",
    ) -> None:
        self.fraction = 0.0
        self.stage = stage
        self._points = points
        self._kept = kept
        self._called = False

    def __enter__(self) -> ProgressBar:
        self._begun = time.monotonic()
        self._bar: Any = None
        if sys.stderr is None:
            return self
        from tqdm import tqdm

        self._bar = tqdm(
            total=self._points or 1.0,
            desc=self.stage,
            delay=PATIENCE,
            file=sys.stderr,
            leave=False,
            # In a log each update is a line.
            mininterval=0.1 if sys.stderr.isatty() else PATIENCE,
            bar_format=_OF_POINTS if self._points else _OF_A_FRACTION,
            unit=" points",
            smoothing=0.1,  # chosen: the rate is an average, as points come in groups
        )
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if self._bar is not None:
            self._bar.close()
        if isinstance(error, KeyboardInterrupt):
            share = f"{100.0 * self.fraction:.0f} %"
            place = share if self.stage == STAGE else f"the stage '{self.stage}'"
            kept = error.args[0] if error.args else self._kept(self.stage)
            say(f"stickslip: interrupted at {place}{kept and ', '}{kept}", err=True)

    def __call__(self, fraction: float, stage: str) -> None:
        new_stage = stage != self.stage
        self.fraction, self.stage = fraction, stage
        if self._bar is None:
            return
        self._bar.set_description_str(stage, refresh=False)
        done = round(fraction * self._points) if self._points else fraction
        if self._points and not self._called:
            self._bar.initial = self._bar.n = self._bar.last_print_n = done
        self._called = True
        self._bar.update(done - self._bar.n)
        if new_stage and time.monotonic() - self._begun > PATIENCE:
            self._bar.refresh()  # a stage may be long, and its name comes once
