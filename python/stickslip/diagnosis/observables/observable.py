"""What the diagnosis asks of a kind of data."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.one_line import OneLine
from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.model.problem import Cause, Uncertain
from stickslip.diagnosis.observables.reading_errors import read_by
from stickslip.facts import Fact

if TYPE_CHECKING:
    from stickslip.diagnosis.observables.tracking.film import FilmComparison


@dataclass(frozen=True, repr=False, eq=False)
class Comparison(OneLine):
    """Readings of a table beside both models, a row each.

    Attributes
    ----------
    kind : str
        ``angle`` or ``field``.
    title : str
    settings : dict of ndarray, shape (n, ...)
        What was set for each reading, SI units.
    observed, recalibrated : ndarray, shape (n,) or (n, components)
        SI units.
    sd : ndarray
        Standard deviation of every number of `observed`, one after another.
    extended : ndarray, optional
        Those of the extended model, where a cause is claimed.
    held_out : ndarray of bool, shape (n,)
        Which readings were held out for the gain.
    """

    kind: str
    title: str
    settings: Mapping[str, Array]
    observed: Array
    sd: Array
    recalibrated: Array
    extended: Array | None
    held_out: Mask

    @property
    def errors(self) -> tuple[float, float | None]:
        """Root mean square of what each model misses, SI units."""
        return (
            root_mean_square(self.observed - self.recalibrated),
            None if self.extended is None else root_mean_square(self.observed - self.extended),
        )


class Observable(ABC):
    """Data of one kind, reduced to observables, with a forward model for them.

    Attributes
    ----------
    name : str
        ``angle`` or ``field``; of a film ``tracking.1``, ``tracking.2`` and so on.
    observed : ndarray, shape (k,)
        In SI units.
    covariance : ndarray, shape (k, k)
        Covariance of their errors.
    group : ndarray of int, shape (k,)
        Observables that are held out together, numbered from 0.
    nuisance : tuple of Uncertain
        Parameters that only this table has, such as a camera's angle offset. Each begins with
        `name` and a dot.
    suspects : tuple of Cause
        What may be wrong with its readings; tables of one kind share parameters.
    notes : tuple of Fact
        What a reader has to know of the noise.
    left_out : tuple of Fact
        What was not used, and why.
    """

    name: str
    observed: Array
    covariance: Array
    group: Indices
    nuisance: tuple[Uncertain, ...] = ()
    suspects: tuple[Cause, ...] = ()
    notes: tuple[Fact, ...]
    left_out: tuple[Fact, ...]

    @abstractmethod
    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Observables, shape (vectors, k), for values of shape (vectors, names); NaN where none.

        `names` are dotted scenario keys, `nuisance` and parameters of `suspects`.
        """

    @abstractmethod
    def comparison(
        self, names: Sequence[str], recalibrated: Array, extended: Array | None, held_out: Mask
    ) -> Comparison | FilmComparison:
        """What the report shows of it for two vectors of values, shape (names,).

        `held_out`, shape (k,), says which observables were held out for the gain.
        """


class TableObservable(Observable):
    """A table of readings with independent errors, and their `settings`."""

    settings: Mapping[str, Array]

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """What is read, with all that may be wrong with it; see `Observable`."""
        return read_by(self.suspects, names, parameters, self.physics)

    @abstractmethod
    def physics(self, names: Sequence[str], parameters: Array) -> Array:
        """What a perfect instrument reads; otherwise as `predict`."""

    def _set_readings(
        self,
        title: str,
        mean: Array,
        count: Indices,
        noise: tuple[float, Fact],
        left_out: Sequence[Fact],
    ) -> None:
        """Take the means of `count` readings each, shape (n, components), with a reading's noise.

        The components of a reading stand one after another in `observed` and are held out together.
        """
        self.title = title
        self.observed = mean.reshape(-1)
        self.sd = np.repeat(noise[0] / np.sqrt(count), mean.shape[1])
        self.covariance = np.diag(self.sd**2)
        self.group = np.repeat(np.arange(len(mean), dtype=np.int64), mean.shape[1])
        self.notes = (noise[1].of(table=title),)
        self.left_out = tuple(left_out)

    def comparison(
        self, names: Sequence[str], recalibrated: Array, extended: Array | None, held_out: Mask
    ) -> Comparison:
        """All readings beside both models."""
        components = len(self.observed) // (int(self.group[-1]) + 1)

        def rows(flat: Array) -> Array:
            return flat if components == 1 else flat.reshape(-1, components)

        def model(values: Array) -> Array:
            return rows(self.predict(names, values[None, :])[0])

        after = None if extended is None else model(extended)
        return Comparison(
            self.name, self.title, self.settings, rows(self.observed), self.sd,
            model(recalibrated), after, held_out[::components],
        )  # fmt: skip
