"""First impacts of the drops as data for `stickslip.diagnose_model`, with models of one's own.

Two kinds of data of the same impacts: how high the marker is at contact, and its velocity and the
spin after it. What the camera and the body may hide from them is among the causes.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm, qmc

from stickslip import Cause, Diagnosis, Parameter, Prior, Table, diagnose_model, instruments
from stickslip.diagnosis import Problem, model

from .contacts import ABOUT, SIDE, Impacts, reach, single_impacts
from .flights import Drops, find_flights, fit_flights
from .sets import Truth, with_absent

Posed = tuple[Callable[..., np.ndarray], list[Table], list[Parameter], list[Cause]]
"""Arguments of `stickslip.diagnose_model`: the model, a table of each kind of observable, constants
and causes."""
Values = dict[str, np.ndarray]

ANGLE_AT_REST = (33.4e-3, 1.3e-3)
"""By how much the drops' angles are read too large, rad, in this project's sense of theta, and its
error: the mean over the four faces of the square in poses at rest, which no diagnosis here sees.
They say too that the plate rises by 3.2 mrad and the marker lies 0.5 mm off the middle."""
HEIGHTS = Truth(
    ("angle_offset", "marker_place"),
    ("rounding", "plate_slope"),
    {"angle_offset.angle": ANGLE_AT_REST},
)
VELOCITIES = Truth(
    ("angle_offset",),
    (
        *("rounding", "plate_slope", "tangential_restitution", "slippery_when_fast"),
        *("mass_place", "marker_place"),
    ),
    {"angle_offset.angle": ANGLE_AT_REST},
)

GYRATION = SIDE / np.sqrt(6.0)
"""Radius of gyration of a uniform square, m."""

_RIM = SIDE / np.sqrt(3.0)  # and of a square with all mass in its rim, m

_LEAST_TILT = 0.15
"""rad. Chosen: a square that is nearer to lying flat touches with two corners within a frame."""
_QUARTER = np.pi / 2

_FARTHEST = 5.0
"""Errors, beyond which an impact is left out. Chosen: two impacts within a frame, which the flights
do not always tell, lie ten errors off and more."""
_ROBUST, _NORMAL = 4.0, 1e9
"""Degrees of freedom of Student's law for all impacts, and of the normal law for those that are
kept. Chosen: with four, one reading in 130 lies beyond five errors."""
_SCANNED, _STARTS = 4096, 16
"""Points of the priors that are looked at, and the likeliest of them, where searches begin. Chosen:
five of the sixteen and more end in the likeliest minimum, of 28 drops and of 250."""
_ROUNDS, _SETTLED = 20, 1e-3
"""Most rounds of fit and errors, and the change of the log-likelihood below which they end."""
_RANGE, _STEP = 6.0, 1e-3
"""Largest coordinate of a constant in that fit, and how far inside it begins. Chosen: six standard
deviations of a prior, and a step that is nothing beside one."""


def _cause(name: str, meaning: str, *parameters: tuple[str, str, float, float, float]) -> Cause:
    """A cause; each parameter is its word, unit, lowest and highest value and usual size."""
    made = [
        Parameter(f"{name}.{word}", unit=unit, low=low, high=high, size=size)
        for word, unit, low, high, size in parameters
    ]
    return Cause(name, tuple(made), meaning)


_ANGLE = _cause("angle_offset", "a wrong zero of the angles", ("angle", "rad", -0.3, 0.3, 0.03))
"""An instrument, but the angles are settings here, so that the models have it themselves."""
_ROUNDING = _cause("rounding", "rounded corners", ("radius", "m", 0.0, 0.015, 2e-3))
_SLOPE = _cause("plate_slope", "a plate that rises along x", ("slope", "-", -0.1, 0.1, 5e-3))


def first_impacts(drops: Drops) -> Impacts:
    """The first impact of each drop that stands alone, of a square that is not nearly flat.

    States are those of the marker, as they are read.
    """
    flights = find_flights(drops)
    constants = fit_flights(drops, flights)
    found = single_impacts(drops, flights, replace(constants, marker_x=0.0, marker_z=0.0))
    _, first = np.unique(found.drop, return_index=True)
    theta = found.before[first, 2]
    tilted = np.abs((theta + _QUARTER / 2) % _QUARTER - _QUARTER / 2) > _LEAST_TILT
    first = first[tilted]
    return Impacts(found.drop[first], found.before[first], found.after[first])


def predicted_heights(table: Table, p: Values) -> np.ndarray:
    """Height of the square's middle at contact, m."""
    p = with_absent(p, (_ANGLE, _ROUNDING, _SLOPE))
    rounding = p["rounding.radius"]
    down = reach(table["theta"] - p["angle_offset.angle"], 0.5 * SIDE - rounding) + rounding
    return p["plate"] + p["plate_slope.slope"] * (table["x"] - ABOUT) + down


def heights(impacts: Impacts, sd: np.ndarray) -> Posed:
    """Heights at contact: which cause makes them differ from those of a square on a plate?

    `sd` has the error of a height, m, shape (1,).
    """
    x, z, theta = impacts.before[:, :3].T
    meters = (
        instruments.marker_place(None, slice(None), 1e-3, angle=theta, largest=0.02),
        instruments.scale(0.01, name="length_scale"),
    )
    plate = Parameter("plate", Prior("normal", 0.0, 5e-3), "m", cause=False)
    table = Table({"x": x, "theta": theta}, z, sd=float(sd[0]), name="height", unit="m")
    return predicted_heights, [table], [plate], [_ANGLE, _ROUNDING, _SLOPE, *meters]


def predicted_impacts(table: Table, p: Values) -> np.ndarray:
    """Velocity of the marker after an impact, or the spin times `GYRATION`, m/s, by the table.

    An impact of a rigid body at one corner: what friction can stop is stopped or, by the tangential
    restitution, turned back; else the corner slips.
    """
    p = with_absent(p, IMPACT_CAUSES)
    gyration, slope = p["gyration"], p["plate_slope.slope"]
    theta = table["theta"] - p["angle_offset.angle"]
    ahead, down = _corner(theta, p["rounding.radius"])
    cos, sin = np.cos(theta), np.sin(theta)
    mass_along, mass_across = p["mass_place.along"], p["mass_place.across"]
    marker_along, marker_across = p["marker_place.along"], p["marker_place.across"]
    ahead = ahead + mass_along * cos + mass_across * sin + p["contact_place.shift"]
    down = down + mass_along * sin - mass_across * cos
    beside = marker_along * cos + marker_across * sin
    above = marker_across * cos - marker_along * sin
    spin = table["spin"] + 0.0 * theta
    # The marker moves with v + spin * (above, -beside); the axes are then turned along the plate.
    centre = table["vx"] - spin * above, table["vz"] + spin * beside
    vx, vz = centre[0] + slope * centre[1], centre[1] - slope * centre[0]
    ahead, down = ahead - slope * down, down + slope * ahead
    approach = spin * ahead - vz
    push_x, push_z = _impulse(
        (vx - spin * down, -approach),
        (ahead, down, gyration),
        p["restitution"] * np.exp(-p["softer_when_fast.rate"] * (approach - 1.0)),
        p["friction"] * np.exp(-p["slippery_when_fast.rate"] * (approach - 1.0)),
        p["tangential_restitution.fraction"],
    )
    after = spin - (down * push_x + ahead * push_z) / gyration**2
    vx, vz = vx + push_x, vz + push_z
    vx, vz = vx - slope * vz, vz + slope * vx
    read = {"vx": vx + after * above, "vz": vz - after * beside, "spin": GYRATION * after}
    return read[table.name]


IMPACT_CAUSES = (
    _ANGLE,
    _ROUNDING,
    _SLOPE,
    _cause(
        "tangential_restitution", "slip is turned back in part", ("fraction", "-", 0.0, 1.0, 0.3)
    ),
    _cause("softer_when_fast", "restitution falls with speed", ("rate", "s/m", -1.0, 1.0, 0.1)),
    _cause("slippery_when_fast", "friction falls with speed", ("rate", "s/m", -2.0, 2.0, 0.3)),
    _cause("contact_place", "the corner gives way along x", ("shift", "m", -0.01, 0.01, 1e-3)),
    _cause(
        "mass_place",
        "the middle lies off the centre of mass",
        ("along", "m", -0.01, 0.01, 1e-3),
        ("across", "m", -0.01, 0.01, 1e-3),
    ),
    _cause(
        "marker_place",
        "the marker lies off the centre of mass",
        ("along", "m", -0.01, 0.01, 1e-3),
        ("across", "m", -0.01, 0.01, 1e-3),
    ),
)


def _corner(theta: np.ndarray, rounding: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far ahead of the middle and below it the square touches, m."""
    half = 0.5 * SIDE - rounding
    within = theta - np.floor(theta / _QUARTER) * _QUARTER
    return half * (np.cos(within) - np.sin(within)), reach(theta, half) + rounding


def _impulse(
    corner: tuple[np.ndarray, np.ndarray],
    arm: tuple[np.ndarray, np.ndarray, np.ndarray],
    restitution: np.ndarray,
    friction: np.ndarray,
    turned_back: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Impulse by mass, m/s, along x and z, from the corner's velocity and where it lies."""
    slip, rise = corner
    ahead, down, gyration = arm
    along, up = 1.0 + (down / gyration) ** 2, 1.0 + (ahead / gyration) ** 2
    mixed = ahead * down / gyration**2
    gain_x, gain_z = -(1.0 + turned_back) * slip, -(1.0 + restitution) * rise
    both = along * up - mixed**2
    stopped_x = (up * gain_x - mixed * gain_z) / both
    stopped_z = (along * gain_z - mixed * gain_x) / both
    sense = np.sign(slip)
    slipped_z = gain_z / (up - sense * friction * mixed)
    stops = np.abs(stopped_x) <= friction * stopped_z
    push_x = np.where(stops, stopped_x, -sense * friction * slipped_z)
    return push_x, np.where(stops, stopped_z, slipped_z)


def velocities(impacts: Impacts, sd: np.ndarray) -> Posed:
    """Velocities after impact: which cause makes them differ from those of a rigid square?

    `sd` has the errors of vx, vz and the spin times `GYRATION`, m/s, shape (3,).
    """
    uncertain = [
        Parameter("restitution", Prior("normal", 0.5, 0.2)),
        Parameter("friction", Prior("log-uniform", 0.02, 0.6)),
        Parameter("gyration", Prior("normal", GYRATION, 2e-4), "m", high=_RIM),
    ]
    theta, vx, vz, spin = impacts.before[:, 2:].T
    before = {"theta": theta, "vx": vx, "vz": vz, "spin": spin}
    after = impacts.after[:, 3:] * [1.0, 1.0, GYRATION]
    tables = [
        Table(before, column, sd=float(error), name=name, unit="m/s")
        for name, column, error in zip(("vx", "vz", "spin"), after.T, sd, strict=True)
    ]
    return predicted_impacts, tables, uncertain, list(IMPACT_CAUSES)


def diagnose_impacts(
    pose: Callable[[Impacts, np.ndarray], Posed], impacts: Impacts, without: Collection[str] = ()
) -> Diagnosis:
    """The diagnosis, with errors that the fit of all causes at once leaves.

    No impact was repeated. What no cause explains serves as the error of each kind of observable,
    by the normal law, after impacts that lie far beyond it by a robust fit were left out.
    """

    def posed(impacts: Impacts, sd: np.ndarray) -> Posed:
        *model, causes = pose(impacts, sd)
        return *model, [each for each in causes if each.name not in without]

    kept, sd = kept_impacts(posed, impacts)
    return diagnose_model(*posed(kept, sd))


def kept_impacts(
    pose: Callable[[Impacts, np.ndarray], Posed], impacts: Impacts
) -> tuple[Impacts, np.ndarray]:
    """Impacts that do not lie far beyond the errors, and the error of each kind of observable."""
    x, rest = robust_fit(pose, impacts)
    inside = np.all(rest < _FARTHEST, axis=0)
    kept = Impacts(impacts.drop[inside], impacts.before[inside], impacts.after[inside])
    problem = _problem(pose, kept)
    _, scale, _, _ = _search(problem, x, _NORMAL)
    # Larger by what the fit of so many causes takes.
    taken = len(problem.y) / (len(problem.y) - problem.size)
    return kept, np.sqrt(taken) * scale


def robust_fit(
    pose: Callable[[Impacts, np.ndarray], Posed], impacts: Impacts, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of all causes at once, and what they leave in errors, shape (kinds, impacts).

    By Student's law, whose tails bear odd impacts where these are few, with the likeliest error of
    each kind of observable. The fit has several minima, and rounding decides where a search from
    one start ends. So searches begin at the likeliest of many points of the priors.
    """
    problem = _problem(pose, impacts)
    points = norm.ppf(qmc.Sobol(problem.size, seed=seed).random(_SCANNED))
    value, _, _ = _likelihood(problem, points, _ROBUST)
    likeliest = points[np.argsort(value)[:_STARTS]]
    found = [_search(problem, each, _ROBUST) for each in likeliest]
    _, scale, rest, x = min(found, key=lambda each: each[0])
    return x, np.abs(rest) / scale[:, None]


def _problem(pose: Callable[[Impacts, np.ndarray], Posed], impacts: Impacts) -> Problem:
    """Problem whose residuals are in their own unit, without a law of the errors."""
    predict, table, *rest = pose(impacts, np.ones(3))
    return model.posed(table, predict, *rest)


def _limits(problem: Problem) -> np.ndarray:
    return np.clip(problem.limits, -_RANGE, _RANGE)


def _loss(squares: np.ndarray, dof: float) -> np.ndarray:
    """Twice the negative logarithm of Student's law, of squared errors, and its derivatives."""
    weight = (dof + 1.0) / (dof + squares)
    return np.array([(dof + 1.0) * np.log1p(squares / dof), weight, -weight / (dof + squares)])


def _likelihood(
    problem: Problem, x: np.ndarray, dof: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Negative log-likelihood with the priors', likeliest scales and residuals at coordinates x.

    Shapes (points,), (points, kinds) and (points, kinds, impacts). The priors are of Student's law
    too, so that the search below, which has one loss for all, lowers the same.
    """
    residuals = problem.residuals(np.clip(x, *_limits(problem)))
    rest = residuals.reshape(len(x), len(problem.tables), -1)
    scale = np.median(np.abs(rest), axis=2, keepdims=True)
    for _ in range(_ROUNDS):
        weight = _loss((rest / scale) ** 2, dof)[1]
        scale = np.sqrt(np.mean(weight * rest**2, axis=2, keepdims=True))
    value = rest.shape[2] * np.sum(np.log(scale), axis=(1, 2))
    value += 0.5 * np.sum(_loss((rest / scale) ** 2, dof)[0], axis=(1, 2))
    return value + 0.5 * np.sum(_loss(x**2, dof)[0], axis=1), scale[..., 0], rest


def _search(
    problem: Problem, x: np.ndarray, dof: float
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """The same of the minimum that a search from some coordinates ends in, and where it is."""

    def misfit(x: np.ndarray) -> np.ndarray:
        return np.concatenate([problem.residuals(x[None, :])[0] / error, x])

    low, high = _limits(problem)
    x = np.clip(x, low + _STEP, high - _STEP)
    (value,), (scale,), (rest,) = _likelihood(problem, x[None, :], dof)
    for _ in range(_ROUNDS):
        error, before = np.repeat(scale, rest.shape[1]), value
        x = least_squares(misfit, x, bounds=(low, high), loss=lambda z: _loss(z, dof)).x
        (value,), (scale,), (rest,) = _likelihood(problem, x[None, :], dof)
        if before - value < _SETTLED:
            break
    return value, scale, rest, x
