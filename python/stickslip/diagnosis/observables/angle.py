"""Static tilt against a held field: Eqs. (11) and (12) without motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.data.unit_check import refuse_larger
from stickslip.diagnosis.model.problem import Uncertain
from stickslip.diagnosis.observables.angle_noise import Noise, estimate
from stickslip.diagnosis.observables.curve_noise import curvature, order_along
from stickslip.diagnosis.observables.observable import ReportSection
from stickslip.diagnosis.observables.repeats import merge
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.scenario.scenario import Scenario

Array = NDArray[np.float64]

_STRONGEST = 1.0
"""Field that no table of this kind has, T; beyond it a unit is wrong."""

_WEAK = 0.05
_ALONE = 8.0
_ALONE_LEAST = math.radians(5.0)
_FEW = 0.2


class AngleObservable:
    """A table of static tilts, with the core's balance of torques as its model.

    Fields are those of the coils at the robot, in the world's frame; they are taken as held long
    enough, and as reached from lying flat without a swing (`_core.static_tilts`).

    Parameters
    ----------
    table : mapping of ndarray, shape (n,)
        Columns Bx, Bz (T) and theta (rad).
    scenario : Scenario
        What no parameter sets.
    title : str
        Of the table, in messages and in the report.

    Raises
    ------
    ScenarioError
        If angles or fields are in another unit.
    """

    name = "angle"
    nuisance: tuple[Uncertain, ...] = ()

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, title: str) -> None:
        self.title = title
        self._base = scenario.to_core()
        fields, theta, beyond = _sound(table, title)
        order = order_along(fields)
        fields, theta, spikes = _without_spikes(fields[order], theta[order], title)
        merged = merge(fields, theta[:, None])
        order = order_along(merged.settings)
        self.fields = merged.settings[order]
        self.observed = merged.mean[order, 0]
        self.noise: Noise = estimate(self.fields, self.observed, merged)
        self.sd = self.noise.sd / np.sqrt(merged.count[order])
        self.covariance = np.diag(self.sd**2)
        self.group = np.arange(len(self.observed), dtype=np.int64)
        self.notes: tuple[Fact, ...] = (self.noise.note.of(table=title),)
        self.left_out = (*beyond, *spikes)

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Angles as they are read, rad, shape (vectors, m); NaN where values make no scenario."""
        return _core.static_tilts(self._base, list(names), parameters, self.fields)

    def report_sections(
        self,
        names: Sequence[str],
        recalibrated: Array,
        extended: Array | None,
        held_out: NDArray[np.bool_],
    ) -> list[ReportSection]:
        """Angles against the field, with both models."""
        from stickslip.diagnosis.report.figures import against_model

        before = self.predict(names, recalibrated[None, :])[0]
        after = None if extended is None else self.predict(names, extended[None, :])[0]
        component = int(np.argmax(np.ptp(self.fields, axis=0)))
        varied = self.fields[:, component]
        order = np.argsort(varied, kind="stable")
        other = self.fields[:, 1 - component]
        picture = against_model(
            varied[order] * 1e3,
            np.degrees(self.observed[order]),
            np.degrees(self.sd[order]),
            np.degrees(before[order]),
            None if after is None else np.degrees(after[order]),
            held_out[order],
            (f"{('Bx', 'Bz')[component]} (mT)", "theta (degrees)"),
            joined=bool(np.ptp(other) <= 1e-3 * np.ptp(varied)),
        )
        error = [_rms(self.observed - before)]
        if after is not None:
            error.append(_rms(self.observed - after))
        radians = [math.radians(each) for each in error]
        missed = dict(zip(("recalibrated", "extended"), [*radians, None], strict=False))
        lines = [Fact(Code.ANGLE_MISFIT, missed), Fact(Code.ANGLE_MODEL, {})]
        size = np.hypot(*self.fields.T)
        if np.all(size > _WEAK * np.max(size)):
            lines.append(Fact(Code.NO_ANGLE_WITHOUT_FIELD, {"percent": 100.0 * _WEAK}))
        numbers: dict[str, object] = {
            "Bx": self.fields[:, 0].tolist(),
            "Bz": self.fields[:, 1].tolist(),
            "theta": self.observed.tolist(),
            "sd": self.sd.tolist(),
            "recalibrated": before.tolist(),
            "extended": None if after is None else after.tolist(),
            "held_out": held_out.tolist(),
            "rms_recalibrated": math.radians(error[0]),
            "rms_extended": None if after is None else math.radians(error[1]),
        }
        return [ReportSection(self.title, picture, tuple(lines), numbers)]


def _rms(error: Array) -> float:
    """Root mean square, degrees."""
    return math.degrees(math.sqrt(float(np.mean(error**2))))


def _sound(table: Mapping[str, Array], title: str) -> tuple[Array, Array, list[Fact]]:
    """Fields and angles that can be meant, and what was left out."""
    fields = np.stack([table["Bx"], table["Bz"]], axis=1)
    theta = table["theta"]
    refuse_larger(title, "field", float(np.max(np.abs(fields))), _STRONGEST, "T")
    beyond = np.abs(theta) > math.pi
    if np.mean(beyond) > _FEW:
        raise ScenarioError(
            f"{title}: theta of {theta[np.argmax(np.abs(theta))]:.4g} rad; allowed is -pi to pi. "
            "If angles are in degrees, multiply them by pi/180"
        )
    left_out = [
        Fact(Code.ANGLE_BEYOND_TURN, {"table": title, "theta": value})
        for value in theta[beyond].tolist()
    ]
    return fields[~beyond], theta[~beyond], left_out


def _without_spikes(fields: Array, theta: Array, title: str) -> tuple[Array, Array, list[Fact]]:
    """Leave out a row that lies far from two neighbours which agree with each other."""
    if len(theta) < 8 or len(np.unique(fields, axis=0)) < len(theta):
        return fields, theta, []
    distance, slope = curvature(fields, theta)
    scale = max(1.48 * float(np.median(np.abs(distance))), _ALONE_LEAST / _ALONE)
    alone = (np.abs(distance) > _ALONE * scale) & (np.abs(distance) > 2.0 * np.abs(slope))
    kept = np.ones(len(theta), dtype=bool)
    kept[1:-1] = ~alone
    left_out = [
        Fact(Code.LONELY_ANGLE, {"table": title, "theta": value, "Bx": bx, "Bz": bz})
        for value, (bx, bz) in zip(theta[~kept].tolist(), fields[~kept].tolist(), strict=True)
    ]
    return fields[kept], theta[kept], left_out
