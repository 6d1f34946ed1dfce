"""Side-view tracking of one run as observables of the diagnosis."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Mask
from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.data.plausibility import magnitude_mismatch
from stickslip.diagnosis.observables.observable import Observable
from stickslip.diagnosis.observables.tracking.camera import Camera, record, recording_rate
from stickslip.diagnosis.observables.tracking.camera_errors import (
    camera_at,
    camera_nuisance,
    camera_suspects,
)
from stickslip.diagnosis.observables.tracking.folding import (
    Fold,
    FrameErrors,
    Kind,
    correlation_of_frames,
    cycle_scatter,
    fold,
    frame_noise,
    reduce,
    undrifted,
)
from stickslip.diagnosis.observables.tracking.smoothed_motion import SmoothedMotion, smoothed_motion
from stickslip.facts import Code, Fact
from stickslip.measurement.outliers import far_from_their_phase
from stickslip.measurement.tracking import FEWEST, TrackingRun
from stickslip.scenario.scenario import Scenario

_KINDS: dict[str, tuple[Kind, str]] = {
    "theta": ("level", "rad"),
    "x": ("drift", "m"),
    "z": ("place", "m"),
    "current_x": ("level", "A"),
    "current_clamp": ("level", "A"),
}
"""How each quantity is reduced, and its unit."""

_CURRENTS = ("current_x", "current_clamp")

_UNLIKELY = 1e-3
"""p-value below which the stated noise is not believed. Chosen: of ten films that state it rightly
one in 100 is rejected by chance."""

_LEAST_RISE = 0.01
"""Rise of the robot over its height that z has to show. Chosen: a micrometre for the robot of
Table II."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """One tracked quantity, reduced.

    `frames`, shape (n,), says which frames of the run are used for it; `values` and `folded` are of
    these frames alone, and `sd` is the noise of one. The observables are ``matrix @ values``, with
    `covariance`.
    """

    name: str
    frames: Mask
    values: Array
    folded: Fold
    sd: float
    matrix: Array
    covariance: Array

    @property
    def observed(self) -> Array:
        """Its observables."""
        return self.matrix @ self.values


@dataclass(frozen=True)
class FilmComparison:
    """One run beside both models.

    Attributes
    ----------
    file : str
    scenario : Scenario
        Scenario of the run, as stated.
    advance : dict of float, optional
        Advance per pulse in the world, m: ``measured``, its error ``sd``, and what the models make
        of it, ``recalibrated`` and ``extended``; None where no two periods show it.
    recalibrated, extended : SmoothedMotion, optional
        The motion beside each model; None where there is none.
    held_out : bool
    """

    file: str
    scenario: Scenario
    advance: dict[str, float] | None
    recalibrated: SmoothedMotion | None
    extended: SmoothedMotion | None
    held_out: bool


class FilmObservable(Observable):
    """Frames of one run, folded on the drive's phase; see ``Observable``.

    Parameters
    ----------
    run : stickslip.measurement.TrackingRun
    number : int
        Number of the run, from 1; its name is ``tracking.<number>``.
    threads : int
        Simulations at a time.
    """

    def __init__(self, run: TrackingRun, number: int = 1, threads: int = 1) -> None:
        self.run, self.threads = run, threads
        self.name = f"tracking.{number}"
        self.rate = recording_rate(run.scenario)
        self.nuisance = camera_nuisance(self.name, run)
        said: list[Fact] = []
        unused: list[Fact] = []
        nominal = self._nominal_frames()
        self.quantities = tuple(
            quantity
            for name in _KINDS
            if name in run.columns
            if (quantity := _quantity(run, name, nominal, said, unused)) is not None
        )
        self.suspects = camera_suspects(
            next(each.values for each in self.quantities if each.name == "theta")
        )
        self.observed = np.concatenate([each.observed for each in self.quantities])
        self.covariance = np.asarray(
            block_diag(*(each.covariance for each in self.quantities)), dtype=float
        )
        self.group = np.zeros(len(self.observed), dtype=np.int64)
        self.notes = tuple(each.of(table=run.file) for each in said)
        self.left_out = tuple(each.of(table=run.file) for each in unused)

    def camera(self, names: Sequence[str], values: Array) -> Camera:
        """The run's camera, from values of shape (names,) of what is uncertain or suspect of it."""
        return camera_at(self.run, self.name, dict(zip(names, values.tolist(), strict=True)))

    def keys(self, names: Sequence[str]) -> list[int]:
        """Indices of the scenario keys among `names`."""
        own = {each.name for each in self.nuisance}
        own |= {parameter.name for each in self.suspects for parameter in each.parameters}
        return [k for k, name in enumerate(names) if name not in own]

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Observables, shape (vectors, k); NaN where the simulation fails."""
        at = self.keys(names)
        # Vectors that differ in the camera alone share a simulation.
        motions, which = np.unique(parameters[:, at], axis=0, return_inverse=True)
        which = which.reshape(-1)
        result = np.full((len(parameters), len(self.observed)), np.nan)
        keys, times = [names[k] for k in at], self.run.columns["t"]
        shown = [each.name for each in self.quantities]
        recorded = record(self.run.scenario, keys, motions, self.rate, self.threads)
        for number, motion in enumerate(recorded):
            if motion is None:
                continue
            for vector in np.flatnonzero(which == number):
                frames = self.camera(names, parameters[vector]).frames(motion, times, shown)
                result[vector] = np.concatenate(
                    [each.matrix @ frames[each.name][each.frames] for each in self.quantities]
                )
        return result

    def comparison(
        self, names: Sequence[str], recalibrated: Array, extended: Array | None, held_out: Mask
    ) -> FilmComparison:
        """Advance and motion of this run beside both models."""
        seen, after, advance = smoothed_motion(self, names, recalibrated), None, None
        if seen is not None and extended is not None:
            after = smoothed_motion(self, names, extended)
        if seen is not None and self.advance is not None:
            advance = dict(zip(("measured", "sd"), self.advance, strict=True))
            advance["recalibrated"] = self._predicted_advance(names, recalibrated)
            if after is not None and extended is not None:
                advance["extended"] = self._predicted_advance(names, extended)
        held = bool(held_out.all())
        return FilmComparison(self.run.file, self.run.scenario, advance, seen, after, held)

    @property
    def advance(self) -> tuple[float, float] | None:
        """Way of a pulse in the world, m, and its error; None where no two periods show it."""
        x = next(each for each in self.quantities if each.name == "x")
        if not x.folded.steady.any() or len(x.observed) <= int(x.folded.bin.max()):
            return None
        return float(x.observed[0]), float(np.sqrt(x.covariance[0, 0]))

    def _predicted_advance(self, names: Sequence[str], values: Array) -> float:
        """The same of the model at values of shape (names,), m."""
        before = itertools.takewhile(lambda each: each.name != "x", self.quantities)
        at = sum(len(each.observed) for each in before)
        return float(self.predict(names, values[None, :])[0, at])

    def _nominal_frames(self) -> dict[str, Array] | None:
        motion = next(record(self.run.scenario, [], np.zeros((1, 0)), self.rate, 1))
        if motion is None:
            return None
        wanted = [name for name in _KINDS if name in self.run.columns or name in _CURRENTS]
        return Camera(self.run.exposure).frames(motion, self.run.columns["t"], wanted)


def _quantity(
    run: TrackingRun,
    name: str,
    nominal: dict[str, Array] | None,
    said: list[Fact],
    unused: list[Fact],
) -> Quantity | None:
    """Reduce one column; adds to `said` notes on it and to `unused` what of it is left out."""
    times, values, kind = run.columns["t"], run.columns[name], _KINDS[name][0]
    finite = np.isfinite(values)
    if name not in ("x", "theta") and finite.sum() < FEWEST:
        few = {"column": name, "count": int(finite.sum()), "needed": FEWEST}
        unused.append(Fact(Code.COLUMN_TOO_SHORT, few))
        return None
    guess = np.zeros(len(times)) if nominal is None else nominal[name]
    quantum = _quantum(values[finite])
    lost = np.zeros(len(times), dtype=bool)
    lost[finite] = _lost(fold(times[finite], run.scenario), (values - guess)[finite], quantum)
    if lost.any():
        count = {"count": int(lost.sum()), "time": float(times[np.argmax(lost)])}
        unused.append(Fact(Code.WILD_FRAMES, {"column": name, **count}))
    used = finite & ~lost
    if kind in ("drift", "place") and run.scenario.drive.mode != "program":
        # How far the contact slips while the robot tilts up in the ramp changes by jumps with every
        # parameter, and carries little information; the motion after it is smooth.
        used &= times >= run.scenario.drive.ramp
    folded = fold(times[used], run.scenario)
    if name not in ("x", "theta") and nominal is not None:
        # Lost frames are recognised in the steady walk alone.
        sized = np.flatnonzero(used)[folded.steady if folded.steady.any() else slice(None)]
        shown = {key: each[sized] for key, each in nominal.items()}
        far = _odd_size(name, values[sized], shown, run.scenario.robot.height)
        if far is not None:
            unused.append(far)
            return None
    residual = (values - guess)[used]
    sd = _noise(run, name, folded, residual, said)
    if quantum > math.sqrt(12.0) * sd:
        # Rounding is an error of its own where the noise does not carry a reading over a step.
        sd = quantum / math.sqrt(12.0)
        said.append(Fact(Code.ROUNDED_COLUMN, {**_column(name), "step": quantum, "taken": sd}))
    place = np.flatnonzero(used)
    known = correlation_of_frames(folded, residual, kind, place)
    independent = FrameErrors(place)
    if known is not None and known.used:
        independent = FrameErrors(place, known.value, known.points)
        interval = {"value": known.value, "low": known.low, "high": known.high}
        said.append(Fact(Code.FRAMES_CORRELATED, {**_column(name), **interval}))
    shared = cycle_scatter(folded, residual, kind, sd, independent)
    if shared > 0.0:
        code = Code.ADVANCE_SCATTERS if kind == "drift" else Code.PERIODS_DIFFER
        said.append(Fact(code, {**_column(name), "scatter": shared}))
    reduced = reduce(folded, kind, sd, shared, independent)
    return Quantity(name, used, values[used], folded, sd, *reduced)


def _column(name: str) -> dict[str, str]:
    return {"column": name, "unit": _KINDS[name][1]}


def _odd_size(name: str, read: Array, nominal: dict[str, Array], height: float) -> Fact | None:
    """A fact if z or a current is far larger or smaller than the stated model's at its frames."""
    own = nominal[name]
    if name == "z":
        # The origin of z is not known, and a robot that hardly rises shows the tracking's noise.
        read, own = read - np.mean(read), own - np.mean(own)
        what, largest = "spread", _LEAST_RISE * height
    else:
        # A coil that hardly carries a current shows the logger's noise, or what another induces.
        what, largest = "size", max(root_mean_square(nominal[each]) for each in _CURRENTS)
    measured, usual = root_mean_square(read), root_mean_square(own)
    nearest = float(np.clip(measured, usual, max(usual, largest)))
    far = magnitude_mismatch(measured, nearest, _column(name)["unit"])
    return None if far is None else Fact(Code.COLUMN_SIZE, {**_column(name), "what": what, **far})


def _quantum(values: Array) -> float:
    """Step of readings that are rounded so coarsely that many are alike; else 0."""
    steps = np.diff(np.unique(values))
    return float(steps.min()) if 0 < len(steps) < 0.5 * len(values) else 0.0


def _lost(folded: Fold, residual: Array, quantum: float) -> Mask:
    """Frames far from those of nearly the same phase: the tracking lost the robot."""
    lost = np.zeros(len(residual), dtype=bool)
    steady = np.flatnonzero(folded.steady)
    order = steady[np.argsort(folded.phase[steady], kind="stable")]
    # The advance may be wrong by much, so neighbours are compared without it.
    lost[order] = far_from_their_phase(undrifted(folded, residual)[order], quantum)
    return lost


def _noise(run: TrackingRun, name: str, folded: Fold, residual: Array, said: list[Fact]) -> float:
    """Standard deviation of one frame: as stated, unless the frames scatter more."""
    seen, free = frame_noise(folded, residual)
    # An estimate is as likely too small as too large, and too small makes false alarms: so one
    # standard deviation of it is added.
    safe = seen * (1.0 + 1.0 / math.sqrt(2.0 * free)) if free > 0 else math.nan
    stated = run.noise.get({"x": "x", "z": "x", "theta": "theta"}.get(name, ""))
    if stated is not None:
        if free > 0 and chi2_law.sf(free * (seen / stated) ** 2, free) < _UNLIKELY:
            more = {**_column(name), "scatter": seen, "stated": stated}
            said.append(Fact(Code.FRAME_NOISE_ABOVE_STATED, more))
            return safe
        return stated
    if free > 0:
        said.append(Fact(Code.FRAME_NOISE, {**_column(name), "scatter": seen, "taken": safe}))
        return safe
    sd = float(np.std(residual)) or 1.0
    said.append(Fact(Code.FRAME_NOISE_UNKNOWN, {**_column(name), "taken": sd}))
    return sd
