"""A bar on standard error for whatever takes longer than two seconds."""

from __future__ import annotations

import sys
import time
from typing import Any

PATIENCE = 2.0
"""Time that passes without a bar, s."""

_OF_A_FRACTION = "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"
_OF_POINTS = (
    "{desc}: {percentage:3.0f}% |{bar}| {n_fmt}/{total_fmt}, {rate_fmt}, {elapsed} < {remaining}"
)


class ProgressBar:
    """A context, and the function that is told in it what is done, 0 to 1, and at which stage.

    With a number of `points` it shows their count, its rate and the time left. What the first call
    then finds done was done before, and is no part of the rate.

    Attributes
    ----------
    fraction : float
        The part that is done, 0 to 1.
    stage : str
        What is being done.
    """

    def __init__(self, stage: str, points: int = 0) -> None:
        self.fraction = 0.0
        self.stage = stage
        self._points = points
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
            # A bar that nobody watches fills a log.
            mininterval=0.1 if sys.stderr.isatty() else PATIENCE,
            bar_format=_OF_POINTS if self._points else _OF_A_FRACTION,
            unit=" points",
            smoothing=0.1,  # chunks of points come unevenly
        )
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()

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
