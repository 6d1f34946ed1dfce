"""Further measurements that tell rival models apart, and files that state what was found."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip._util.arrays import Array, columns_of
from stickslip._util.note import Note
from stickslip.diagnosis.data.table import Table

if TYPE_CHECKING:
    from pandas import DataFrame

Forward = Callable[[Any, Array], Array]
"""``forward(conditions, values)``: readings that a model predicts at new conditions, shape
(vectors, conditions), from values of all parameters, (vectors, size); NaN where it has none."""


class Rivals:
    """Conditions that were not measured yet, and the statement of the extended model.

    This is what a model of one's own has: which conditions it can have only its user knows, and
    what it states are the values of its parameters.
    """

    proposes = False
    """Whether it knows conditions that may be measured."""
    shared: Collection[str] = ()
    """Constants of both of two states of a machine that are compared."""

    @property
    def table(self) -> int:
        """Index of the table whose errors new readings will have."""
        return 0

    def conditions(self, given: Any) -> tuple[Any, dict[str, list[Any]]]:
        """Conditions that a person writes as the model takes them, and their settings as columns.

        There are no columns where settings have no names.
        """
        named = given.settings if isinstance(given, Table) else columns_of("conditions", given)
        columns = named.items() if isinstance(named, Mapping) else ()
        return given, {str(name): [*one] for name, one in columns if isinstance(one, Iterable)}

    def proposals(self) -> Any:
        """Conditions that may be measured next, as the model takes them; None without any."""
        return None

    def chosen(
        self, proposals: Any, names: Sequence[str], predicted: tuple[Array, Array, Array],
        pairs: Sequence[tuple[int, int]], count: int,
    ) -> list[Any]:  # fmt: skip
        """The experiments that tell models apart best; arrays as for `expected_chi2`."""
        return []

    def unvaried(self) -> list[str]:
        """Settings that all measured conditions share and that could be varied."""
        return []

    def advice(self, names: Mapping[str, str], experiments: Sequence[Any]) -> list[Note]:
        """Advice beside conditions to measure; `names` says each cause of a set by its name."""
        return []

    def sides(self, values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
        """Parameters of each of two states that are compared; nothing of one state."""
        return {}

    def extended(self, values: Mapping[str, Any], covariance: DataFrame | None) -> Any:
        """The model with these values by name; None of a covariance where nothing was fitted."""
        return dict(values)

    def writers(self, folder: Path, told: str, causes: str, extended: Any) -> dict[Path, Any]:
        """Writers of the files that state the extended model, with the verdict in words."""
        return {}
