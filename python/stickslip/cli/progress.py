"""A bar on standard error for whatever takes longer than two seconds."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, Protocol


class Show(Protocol):
    """Shows the fraction that is done, and the stage, if there are any."""

    def __call__(self, fraction: float, stage: str = "") -> None:
        """Show it."""
        ...


PATIENCE = 2.0
"""Time that passes without a bar, s."""


@contextlib.contextmanager
def progress_bar(description: str) -> Iterator[Show]:
    """A function that takes the fraction that is done, 0 to 1, and the stage, and shows both."""
    begun = time.monotonic()
    with _bar(
        description, 1.0, "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"
    ) as bar:

        def show(fraction: float, stage: str = "") -> None:
            bar.set_description_str(stage or description, refresh=False)
            bar.update(fraction - bar.n)
            if stage and time.monotonic() - begun > PATIENCE:
                bar.refresh()  # a stage may be long, and its name comes once

        yield show


@contextlib.contextmanager
def count_bar(description: str, total: int, unit: str) -> Iterator[Callable[[float], None]]:
    """The same for work that is counted: with the count, its rate and the time left.

    What the first call finds done was done before, and is no part of the rate.
    """
    shape = (
        "{desc}: {percentage:3.0f}% |{bar}| {n_fmt}/{total_fmt}, {rate_fmt}, "
        "{elapsed} < {remaining}"
    )
    with _bar(description, total, shape, unit=f" {unit}", smoothing=0.1) as bar:
        begun = False

        def show(fraction: float) -> None:
            nonlocal begun
            count = round(fraction * total)
            if not begun:
                begun = True
                bar.initial = bar.n = bar.last_print_n = count
            bar.update(count - bar.n)

        yield show


@contextlib.contextmanager
def _bar(description: str, total: float, shape: str, **options: Any) -> Iterator[Any]:
    if sys.stderr is None:
        yield _NoBar()
        return
    from tqdm import tqdm

    with tqdm(
        total=total,
        desc=description,
        delay=PATIENCE,
        file=sys.stderr,
        leave=False,
        # A bar that nobody watches fills a log.
        mininterval=0.1 if sys.stderr.isatty() else PATIENCE,
        bar_format=shape,
        **options,
    ) as bar:
        yield bar


class _NoBar:
    """Where there is no standard error."""

    n = 0.0

    def refresh(self) -> None:
        pass

    def set_description_str(self, text: str, refresh: bool = True) -> None:
        pass

    def update(self, more: float) -> None:
        pass
