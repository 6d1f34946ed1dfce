"""A bar on standard error for whatever takes longer than two seconds."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

PATIENCE = 2.0
"""Time that passes without a bar, s."""


@contextlib.contextmanager
def progress_bar(description: str) -> Iterator[Callable[[float], None]]:
    """A function that takes the fraction that is done, 0 to 1, and shows it."""
    if sys.stderr is None:
        yield lambda fraction: None
        return
    from tqdm import tqdm

    with tqdm(
        total=1.0,
        desc=description,
        delay=PATIENCE,
        file=sys.stderr,
        leave=False,
        # A bar that nobody watches fills a log.
        mininterval=0.1 if sys.stderr.isatty() else PATIENCE,
        bar_format="{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}",
    ) as bar:

        def show(fraction: float) -> None:
            bar.update(fraction - bar.n)

        yield show
