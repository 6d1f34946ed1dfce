"""Forces that a film shows and a model does not: residuals of torque and force by phase.

Frames are folded on the drive's phase and smoothed by a Fourier series, whose derivatives enter the
balances of Eqs. (10)-(14). While the contact sticks, friction and adhesion act at the pinned corner
and have no torque about it: a residual torque there belongs to the field, the moment or the
rotational drag. While it slips, a residual force along the surface belongs to friction, drag and
tilt. The same is done to frames of the recalibrated simulation at the same times and subtracted, so
that smoothing biases nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, Indices, Mask
from stickslip.diagnosis.observables.tracking.camera import record
from stickslip.diagnosis.observables.tracking.smoothed_motion import Balance, Folds, Kinematics
from stickslip.errors import ScenarioError

if TYPE_CHECKING:
    from stickslip.diagnosis.observables.tracking.camera import Recording
    from stickslip.diagnosis.observables.tracking.film import FilmObservable

FEWEST_ORDERS = 10
"""Harmonics of the drive that a film must resolve before its derivatives mean anything. Chosen: a
slip of a tenth of a period is the shortest thing that a balance is to show."""

CLEAR = 3.5
"""A residual differs from zero beyond this t. Chosen: of ten true zeros one in 200 films does."""

_DRAWS = 400
"""Simulated films with noise from which errors are estimated. Chosen: they determine it to 4 %."""

_PURE = 0.97
"""Part of the smoothing's width in which the contact has to be in one mode. Chosen: of 30 samples
one may differ by rounding of its phase."""

_RIDGE = 1e-3
"""Floor of a covariance, over its mean variance. Chosen: far below its own error, 5 %."""

_STICK, _FORWARD, _BACKWARD = map(
    _core.contact_names.index, ("corner_stick", "corner_slip_forward", "corner_slip_backward")
)


@dataclass(frozen=True)
class Slope:
    """How a residual goes with one variable, by generalised least squares.

    Attributes
    ----------
    variable : str
        ``constant``, ``theta``, ``rate`` (of theta) or ``contact velocity``.
    value, sd : float
        Mean residual, or its change over one standard deviation of the variable: N m or N.
    """

    variable: str
    value: float
    sd: float

    @property
    def t(self) -> float:
        """Value in units of its standard deviation."""
        return self.value / self.sd if self.sd > 0.0 else 0.0


@dataclass(frozen=True, eq=False)
class Residual:
    """Measured minus simulated balance where the contact does one thing.

    Attributes
    ----------
    where : ndarray of int
        Places on the grid of phases.
    value, sd : ndarray
        Torque (N m) or force (N, along the robot's own +x), and its error at each place.
    slopes : tuple of Slope
        The constant first; the others beside a constant.
    scale : float
        Largest magnetic torque about the corner, or weight and adhesion, to judge the size.
    """

    where: Indices
    value: Array
    sd: Array
    slopes: tuple[Slope, ...]
    scale: float


@dataclass(frozen=True, eq=False)
class ForceView:
    """What one film says of forces.

    Attributes
    ----------
    phase : ndarray, shape (g,)
        Phase of the drive, 0 to 1.
    theta, theta_model : ndarray, shape (g,)
        Smoothed, measured and simulated, rad; without the camera's offset and scale.
    place, place_model : ndarray, shape (g,)
        x less its drift, along the robot's own +x, m.
    rate, contact_velocity : ndarray, shape (g,)
        Measured, rad/s and m/s.
    orders, distinct : int
        Harmonics of the smoothing, and different phases that the film shows.
    sticking, slipping : Residual or None
        None where the coverage of the phase is too poor for derivatives, or the contact never does
        so for long enough.
    onset : tuple of float or None
        Friction over normal force where sticking ends: measured, its error, simulated.
    drift_theta, drift_advance : tuple of float
        Change from period to period that the simulation lacks, and its error: rad, and m of the
        advance.
    """

    phase: Array
    theta: Array
    theta_model: Array
    place: Array
    place_model: Array
    rate: Array
    contact_velocity: Array
    orders: int
    distinct: int
    sticking: Residual | None
    slipping: Residual | None
    onset: tuple[float, float, float] | None
    drift_theta: tuple[float, float]
    drift_advance: tuple[float, float]


def force_view(
    observable: FilmObservable, names: Sequence[str], values: Array, seed: int = 0
) -> ForceView | None:
    """Compare a film with a simulation of given values, force by force.

    Parameters
    ----------
    observable : FilmObservable
        Such as ``FilmObservable(run)``.
    names : sequence of str
        Dotted scenario keys and the film's nuisances.
    values : ndarray, shape (names,)
    seed : int
        Seed of the noise that errors are propagated with.

    Returns
    -------
    ForceView or None
        None where the simulation fails, or the drive has no phase.
    """
    run, at = observable.run, observable.keys(names)
    if run.scenario.drive.mode == "program":
        return None
    keys = [names[k] for k in at]
    try:
        scenario = run.scenario.replace(dict(zip(keys, values[at].tolist(), strict=True)))
    except ScenarioError:
        return None
    rate, threads = observable.rate, observable.threads
    motion = next(record(run.scenario, keys, values[None, at], rate, threads))
    if motion is None:
        return None
    camera = observable.camera(names, values)
    folds = Folds(observable, motion, camera)
    if folds.orders == 0:
        return None
    modes = _modes(motion, folds, scenario.window)
    slip = modes[_FORWARD] | modes[_BACKWARD]
    direction = np.where(modes[_FORWARD], 1.0, -1.0)
    balance = Balance(scenario, motion, folds.true_times, direction)
    seen, model = folds.smooth(folds.measured), folds.smooth(folds.simulated)
    measured = balance(seen)
    sticking = slipping = onset = None
    if folds.orders >= FEWEST_ORDERS:
        random = np.random.default_rng([seed, 41])
        noise = {k: folds.sd[k] * random.standard_normal((_DRAWS, folds.count)) for k in folds.sd}
        drawn = folds.smooth({k: folds.simulated[k] + noise[k] for k in noise})
        found = (measured, balance(model), balance(drawn))
        torque, force = [each.torque for each in found], [each.force for each in found]
        sticking = _residual(torque, modes[_STICK], seen, None, measured.torque_scale)
        velocity = measured.contact_velocity
        slipping = _residual(force, slip, seen, velocity, measured.weight)
        onset = _onset([each.friction_ratio for each in found], modes[_STICK], slip)
    return ForceView(
        folds.grid, seen.theta, model.theta, seen.x, model.x, seen.omega,
        measured.contact_velocity, folds.orders, folds.distinct, sticking, slipping, onset,
        folds.drift("theta", 1), folds.drift("x", 2),
    )  # fmt: skip


def _modes(motion: Recording, folds: Folds, window: tuple[float, float]) -> dict[int, Mask]:
    """Where on the grid the simulated contact is in one mode alone, over the smoothing's width.

    The modes are those of a corner; slips count along the robot's own +x.
    """
    t = motion["t"]
    steady = (t >= window[0]) & (t < window[1])
    phase = np.mod((t[steady] - window[0]) / folds.period - folds.trigger, 1.0)
    code = motion["contact"][steady].astype(np.int64)
    if folds.sign < 0.0:
        turned = {_FORWARD: _BACKWARD, _BACKWARD: _FORWARD}
        code = np.array([turned.get(each, each) for each in code.tolist()])
    # A quarter of the shortest period to each side: farther frames have hardly any weight.
    reach = 0.25 / folds.orders
    order = np.argsort(phase)
    place = np.concatenate([phase[order] - 1.0, phase[order], phase[order] + 1.0])
    low, high = (np.searchsorted(place, folds.grid + side) for side in (-reach, reach))
    result = {}
    for mode in (_STICK, _FORWARD, _BACKWARD):
        is_mode = np.tile((code == mode)[order].astype(float), 3)
        total = np.concatenate([[0.0], np.cumsum(is_mode)])
        result[mode] = (total[high] - total[low]) >= _PURE * np.maximum(high - low, 1)
    return result


def _residual(
    balances: Sequence[Array], where: Mask, seen: Kinematics, velocity: Array | None, scale: float
) -> Residual | None:
    """Measured minus simulated where `where` is true, with the covariance of the noisy draws."""
    places = np.flatnonzero(where)
    if len(places) < 4:  # a slope, a constant, and two to judge them by
        return None
    measured, simulated, drawn = (each[..., places] for each in balances)
    value, scatter = measured - simulated, drawn - simulated
    covariance = np.asarray(np.cov(scatter.T), dtype=float)
    sd = np.sqrt(np.diag(covariance))
    # Neighbours on the grid are all but the same, so the inverse needs a floor.
    floor = _RIDGE * float(np.mean(sd**2))
    inverse = np.asarray(np.linalg.inv(covariance + floor * np.eye(len(sd))), dtype=float)
    ones = np.ones((len(places), 1))
    variables = {"theta": seen.theta, "rate": seen.omega, "contact velocity": velocity}
    slopes = [_slope("constant", ones, inverse, value, scatter)]
    for name, variable in variables.items():
        if variable is None:
            continue
        part = variable[places]
        spread = float(np.std(part))
        if spread > 0.0:
            column = (part - part.mean())[:, None] / spread
            slopes.append(_slope(name, np.hstack([column, ones]), inverse, value, scatter))
    return Residual(places, value, sd, tuple(slopes), scale)


def _slope(name: str, design: Array, inverse: Array, value: Array, scatter: Array) -> Slope:
    """First coefficient of a weighted fit; its error is that of the same fit to the draws."""
    weights = np.linalg.solve(design.T @ inverse @ design, design.T @ inverse)[0]
    return Slope(name, float(weights @ value), float(np.std(scatter @ weights)))


def _onset(ratios: Sequence[Array], stick: Mask, slip: Mask) -> tuple[float, float, float] | None:
    """Friction over normal force at the last place that sticks before a slip."""
    ends = np.flatnonzero(stick & ~np.roll(stick, -1))
    for end in ends:
        # Between the two lies the smoothing's width, where neither is certain: an eighth of a
        # period is more than that of ten harmonics.
        following = np.roll(slip, -(end + 1))[: len(slip) // 8]
        if following.any():
            measured, simulated, drawn = (each[..., end] for each in ratios)
            return float(measured), float(np.std(drawn)), float(simulated)
    return None
