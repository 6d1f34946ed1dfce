"""What the diagnosis asks of a kind of data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.model.problem import Uncertain
from stickslip.facts import Fact

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ReportSection:
    """A part of the report: a figure, and what there is to say of it.

    Attributes
    ----------
    title : str
    picture : str
        PNG in base64, may be empty.
    lines : tuple of Fact
        What is said below it.
    numbers : dict
        For report.json.
    """

    title: str
    picture: str
    lines: tuple[Fact, ...]
    numbers: dict[str, object]


class Observable(Protocol):
    """Data of one kind, reduced to observables, with a forward model for them.

    Attributes
    ----------
    name : str
        ``angle``, ``field`` or ``tracking``.
    observed : ndarray, shape (k,)
        In SI units.
    covariance : ndarray, shape (k, k)
        Of their errors.
    group : ndarray of int, shape (k,)
        Observables that are held out together, numbered from 0.
    nuisance : tuple of Uncertain
        Parameters that only this channel has, such as a camera's angle offset. Each begins with the
        channel's name and a dot.
    notes : tuple of Fact
        What a reader has to know of the noise.
    left_out : tuple of Fact
        What was not used, and why.
    """

    name: str
    observed: Array
    covariance: Array
    group: NDArray[np.int64]
    nuisance: tuple[Uncertain, ...]
    notes: tuple[Fact, ...]
    left_out: tuple[Fact, ...]

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Observables, shape (vectors, k), for values of shape (vectors, names); NaN where none.

        `names` are dotted scenario keys and the channel's nuisances.
        """
        ...

    def report_sections(
        self,
        names: Sequence[str],
        recalibrated: Array,
        extended: Array | None,
        held_out: NDArray[np.bool_],
    ) -> list[ReportSection]:
        """Parts of the report for two vectors of values, shape (names,).

        `held_out`, shape (k,), says which observables were held out for the gain.
        """
        ...
