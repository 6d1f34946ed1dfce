"""A bar on standard error for whatever takes longer than two seconds."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

from tqdm import tqdm

PATIENCE = 2.0
"""Time that passes without a bar, s. Chosen: a shorter wait needs no explanation."""

_OF_A_PART = "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"


@contextlib.contextmanager
def progress_bar(points: int = 0) -> Iterator[Callable[[float, str], None]]:
    """A function that takes the part that is done, 0 to 1, and the stage, and shows both.

    With a number of `points` the bar shows their count and rate.
    """
    with tqdm(
        total=points or 1.0,
        delay=PATIENCE,
        leave=False,
        bar_format=None if points else _OF_A_PART,
        unit=" points",
        mininterval=0.1 if sys.stderr.isatty() else PATIENCE,  # in a log each update is a line
    ) as bar:

        def show(fraction: float, stage: str) -> None:
            bar.set_description_str(stage, refresh=False)
            bar.update(round(fraction * points) - bar.n if points else fraction - bar.n)

        yield show
