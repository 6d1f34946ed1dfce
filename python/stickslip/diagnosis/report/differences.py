"""Readings less what the recalibrated model gives, and what a cause adds to it, as panels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.report.cause_words import meanings_of, plain_name
from stickslip.diagnosis.report.chart import Line, Panel, Point, said
from stickslip.diagnosis.report.figures import fitted_models

Array = NDArray[np.float64]

GIVEN = "scenario as given"
"""Name of the curve where no model was fitted."""


@dataclass(frozen=True)
class LargeFigure:
    """Panels with what a reader has to know of them.

    Attributes
    ----------
    title : str
    panels : tuple of Panel
    curve : str
        What the curve is; empty without one.
    measured : str
        What the points are.
    kinds : tuple of str
        Settings that each marker stands for, in the order of `MARKERS`; one or none needs no word.
    held_out : bool
        Whether some points are hollow.
    """

    title: str
    panels: tuple[Panel, ...]
    curve: str
    measured: str
    kinds: tuple[str, ...]
    held_out: bool


@dataclass(frozen=True)
class Rows:
    """Readings beside the recalibrated model, in the unit that is drawn; shape (m,) each.

    `change` is what the claimed cause adds to the recalibrated model, where there is one, and
    `base` what is drawn as zero: the recalibrated model, or nothing where none was fitted. `added`
    says in short what their sum is.
    """

    observed: Array
    base: Array
    change: Array | None
    sd: Array | None
    held_out: NDArray[np.bool_]
    added: str

    def point(self, k: int, x: float, where: str, unit: str, marker: int = 0) -> Point:
        """Reading k at `x`."""
        value = float(self.observed[k] - self.base[k])
        sd = None if self.sd is None else float(self.sd[k])
        parts = [where, f"measured {said(self.observed[k])} {unit}".rstrip()]
        if sd is not None:
            parts[-1] += f" (sd {said(sd)})"
        if np.any(self.base):
            parts.append(f"recalibrated {said(self.base[k])}")
        if self.change is not None:
            parts.append(f"{self.added} {said(self.base[k] + self.change[k])}")
        parts += ["held out"] if self.held_out[k] else []
        return Point(x, value, sd, "; ".join(parts), bool(self.held_out[k]), marker)


def claimed_change(found: Findings, m: int) -> tuple[Array | None, str]:
    """What the extended model adds at the first m observables, SI units, and what to call it."""
    models = fitted_models(found, m)
    if found.extended is None or "extended" not in models:
        return None, ""
    name = f"with {plain_name(found.extended[1].name, meanings_of(found))}"
    if found.free_shape is not None:
        name = f"with the curve of {found.free_shape.term.name}"
    return models["extended"] - models["recalibrated"], name


def added(found: Findings) -> str:
    """What the extended model has beyond the recalibrated one, in short."""
    if found.free_shape is not None:
        return "with the curve"
    pair = found.extended is not None and len(found.extended[1].candidate.causes) > 1
    return "with both causes" if pair else "with the cause"


def held_out(found: Findings, m: int) -> NDArray[np.bool_]:
    """Which of the first m observables were held out, for a cause or for a law of another shape."""
    if found.free_shape is not None and found.open_set is not None and found.open_set.gain:
        return np.isin(np.arange(m), found.open_set.gain.held_out)
    return found.held_out[:m]


def curves(
    at: Array, change: Array | None, indices: Sequence[int], name: str, label: str = ""
) -> list[Line]:
    """The change at some places: a curve where it is a function of the place, else dashes."""
    if change is None or not len(indices):
        return []
    order = sorted(indices, key=lambda k: at[k])
    x, y = at[order], change[order]
    spread = float(np.ptp(y[np.isfinite(y)])) if np.isfinite(y).any() else 0.0
    twice = np.diff(x) == 0.0
    joined = bool(np.all(np.abs(np.diff(y)[twice]) <= 1e-6 * spread))
    title = f"{name}, {label}" if label else name
    kind = "given" if name == GIVEN else "cause"
    return [Line(x.tolist(), y.tolist(), kind, title, joined)]
