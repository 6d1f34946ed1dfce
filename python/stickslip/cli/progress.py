"""A bar on standard error for whatever takes longer than two seconds."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Any

PATIENCE = 2.0
"""Time that passes without a bar, s."""


@contextlib.contextmanager
def progress_bar(description: str) -> Iterator[Callable[[float], None]]:
    """A function that takes the fraction that is done, 0 to 1, and shows it."""
    with _bar(
        description, 1.0, "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"
    ) as bar:

        def show(fraction: float) -> None:
            bar.update(fraction - bar.n)

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

    def update(self, more: float) -> None:
        pass
