"""Mean velocities from tracks: places of a robot's centre, without its angle."""

from __future__ import annotations

import math
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import fdtrc

from stickslip._util.arrays import Array, Mask, check_indexes, conversions, root_mean_square, row
from stickslip._util.messages import check_kind, refuse
from stickslip.diagnosis.data.readings import find_readings
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import Drive
from stickslip.walker.outliers import far_from_a_fit, lost_frames, one_place_each

FEWEST = 8
"""Frames in the measuring window. Chosen: five are left to tell the noise of a frame."""

_HARMONICS = 20
"""Harmonics of the motion within a pulse. Chosen: corners fall off as 1 / k^2: 1/400 is left."""

_SWAY = 0.1
"""Prior standard deviation of the first harmonic, in body lengths. Chosen: a body that rocks by
half a radian moves its centre by about as much."""

_DEGREE, _RARE, _LEAST = 8, 3e-3, 3e-4
"""Degree of the polynomial that shows an unsteady walk, p-value below which it is told, and least
root mean square of its terms above the square, in the range of the places. Chosen: two bends have
five such terms; three in 1000 sound tracks; the start leaves a tenth of that."""

_FINEST = 1e-3
"""Least scatter of frames that counts, in body lengths. Chosen: no camera sees a smaller one."""

# Standard deviations of a frame that are tried, in that of the first harmonic. Chosen: from the
# rounding of positions to far beyond the body, in steps below the error of an estimate.
_NOISES = np.geomspace(1e-6, 1e2, 400)


def velocity_of_track(t: ArrayLike, x: ArrayLike, drive: Drive | Scenario) -> dict[str, Value]:
    """One row for a table of velocities, from the tracked centre of a robot.

    The velocity is the mean over the whole pulses that the track holds, from the end of the third
    one on (`Scenario.window`), as in the summary of a run. Frames without a place of the robot,
    lost ones or specks, are left out; a warning says how many. Another one is of a robot that does
    not walk steadily, as its places bend beyond an evenly changing velocity.

    The others are fitted with a + v t + b t^2, t from the middle of the window, a function of the
    phase of the pulse, and white noise. The function is a series of harmonics whose coefficients
    are normal, with a standard deviation of a tenth of the robot's length over the harmonic's
    number. The noise is that of greatest restricted likelihood. So no frame has to fall on an end
    of the window, and the frame rate can be any. Where frames nearly keep step with the pulses, the
    motion within a pulse looks like a slow motion of the robot; the standard error includes that.

    Of n frames with noise s spread evenly over a window of the duration T the error is near
    ``s * sqrt(12 / n) / T``. Not in it is what the start leaves after the third pulse, up to 0.1 %
    of the velocity.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times of the frames, s, in any order; 0 where the drive begins, before its ramp.
    x : array_like, shape (n,)
        Place of the centre along +x, m. Gaps are left out.
    drive : Drive or Scenario
        What the robot was driven with; of a scenario its robot's length counts too.

    Returns
    -------
    dict
        `velocity` and its `standard_error` in m/s, and every setting of the drive by its bare name,
        so that ``pandas.DataFrame([velocity_of_track(...), ...])`` suits
        `Measurement.from_dataframe`. `pulses` is three more than the track holds.

    Raises
    ------
    ScenarioError
        With one line, if shapes differ, two places have one time, another body takes over from some
        frame on, the times hold no whole pulse or fewer than eight frames, or the drive is a
        program.

    Examples
    --------
    >>> drive = Drive(frequency=50.0, pulses=13)
    >>> t = [k / 100 for k in range(40)]
    >>> row = velocity_of_track(t, [1e-3 * each for each in t], drive)
    >>> round(row["velocity"], 9), row["frequency"], row["pulses"]
    (0.001, 50.0, 13)
    """
    scenario = Scenario(drive=drive) if isinstance(drive, Drive) else drive
    check_kind("drive", scenario, Scenario)
    if scenario.drive.kind == "program":
        refuse("drive.mode", "program", "IPP or OPP, whose pulses say what is measured")
    length, period = scenario.robot.length, 1.0 / scenario.pulse_rate
    times, places, (start, end) = _frames(t, x, scenario)

    def fit(rows: Mask, degree: int = 2) -> _Fit:
        return _fit(times[rows], places[rows], start, end, period, length, degree)

    def left_by(rows: Mask) -> Array | None:
        return fit(rows).residual[:, None] if rows.sum() >= FEWEST else None

    far = far_from_a_fit(left_by, len(times), _FINEST * length)
    _say_left_out(times[far], len(times), "far from what the others let expect")
    velocity, error = fit(~far)[:2]
    _, _, _, bent, p_value = fit(~far, min(_DEGREE, int((~far).sum()) // 2 - 1))
    if p_value < _RARE and bent > _LEAST * np.ptp(places[~far]):
        warnings.warn(
            f"the robot does not walk steadily: its places bend by {bent:.2g} m (root mean square) "
            f"beyond an evenly changing velocity (p = {p_value:.1g}), as of one that rests, "
            "turns back or is filmed before its drive; give t and x of its steady walk alone",
            stacklevel=2,
        )
    whole = scenario.window[1] - scenario.window[0]
    pulses = scenario.drive.pulses - round((whole - end + start) / period)
    names = [key for key in known_keys() if key.startswith("drive.")]
    settings = {name[6:]: scenario.get(name) for name in names}
    return {"velocity": velocity, "standard_error": error, **settings, "pulses": pulses}


class _Fit(NamedTuple):
    """Mean velocity and its standard error, m/s, and the residual of each frame, m.

    `bent` is the root mean square of the terms above the square, m, and `p_value` that of data
    without them.
    """

    velocity: float
    error: float
    residual: Array
    bent: float
    p_value: float


def _fit(
    times: Array,
    places: Array,
    start: float,
    end: float,
    period: float,
    length: float,
    degree: int,
) -> _Fit:
    middle, half, unit = (start + end) / 2, (end - start) / 2, _SWAY * length
    # The square takes up a velocity that changes, and is orthogonal to its mean.
    slow: Array = np.polynomial.legendre.legvander((times - middle) / half, degree).astype(float)
    number = np.arange(1, _HARMONICS + 1)
    phase = 2 * np.pi * np.outer((times - start) / period, number)
    swaying = np.column_stack([np.cos(phase) / number, np.sin(phase) / number])

    noise = _noise(slow, swaying, places / unit)
    # The prior as rows beside the frames, so that one least-squares problem holds both.
    columns = np.column_stack([swaying, slow])
    design, prior = columns / noise, np.eye(columns.shape[1])[: swaying.shape[1]]
    q, r = np.linalg.qr(np.vstack([design, prior]))
    scores = q.T @ np.concatenate([places / unit / noise, np.zeros(len(prior))])
    inverse = np.linalg.inv(r)
    solution, scale, rate = inverse @ scores, unit / half, swaying.shape[1] + 1
    residual = places - unit * (columns @ solution)
    velocity, error = scale * solution[rate], scale * np.linalg.norm(inverse[rate])
    bends = slow[:, 3:] @ solution[rate + 2 :]
    free = max(len(times) - float(np.sum(q[: len(times)] ** 2)), 1.0)
    above = max(degree - 2, 1)
    p_value = fdtrc(above, free, float(np.mean(scores[-above:] ** 2)))
    return _Fit(float(velocity), float(error), residual, unit * root_mean_square(bends), p_value)


def _frames(
    t: ArrayLike, x: ArrayLike, scenario: Scenario
) -> tuple[Array, Array, tuple[float, float]]:
    """Frames of the robot in the order of time, s and m, and the whole pulses that they hold, s."""
    check_indexes("", {"t": t, "x": x})
    for note in conversions("", {"t": (t, "s"), "x": (x, "m")}):
        warnings.warn(str(note), stacklevel=4)
    times = row("t", t, unit="s", gaps=True)
    places = row("x", x, len(times), unit="m", gaps=True)
    sound = np.isfinite(times) & np.isfinite(places)
    if not sound.any():
        raise ScenarioError("t and x: no frame has both: allowed are numbers in s and m")
    times, places = times[sound], places[sound]
    order = one_place_each(times, places)
    times, places = times[order], places[order]
    window = scenario.window
    inside = (times >= window[0]) & (times <= window[1])
    _check_count(times, inside, window)
    length = scenario.robot.length
    off = lost_frames(times[inside], places[inside], length)
    _say_left_out(times[inside][off], len(off), f"not where the robot of {length:g} m can be", 4)
    times, places = times[inside][~off], places[inside][~off]
    found = find_readings("", times, places, "m", ())
    again = ~found.kept & (found.averaged == 1)
    _say_left_out(times[again], len(again), "repeats, lines between others or an end of a range", 4)
    times, places = times[~again], places[~again]
    held = _held(times, window, 1.0 / scenario.drive.frequency)
    inside = (times >= held[0]) & (times <= held[1])
    _check_count(times, inside, held)
    return times[inside], places[inside], held


def _held(times: Array, window: tuple[float, float], period: float) -> tuple[float, float]:
    """Begin and end of the whole pulses of a window that the times hold, to a frame or a pulse."""
    start, end = window
    step = max(period, float(np.median(np.diff(times))))
    first = 0 if times[0] <= start + step else math.ceil((times[0] - start) / period)
    last = round((end - start) / period)
    if times[-1] < end - step:
        last = math.floor((times[-1] - start) / period)
    return start + first * period, start + max(last, first + 1) * period


def _check_count(times: Array, inside: Mask, window: tuple[float, float]) -> None:
    start, end = window
    if inside.sum() >= FEWEST and np.ptp(times[inside]) > 0.0:
        return
    raise ScenarioError(
        f"t = {times.min():.6g} to {times.max():.6g}: {int(inside.sum())} frames are in the "
        f"measuring window, {start:.6g} to {end:.6g} s: allowed are times in s, 0 where the drive "
        f"begins, with {FEWEST} frames or more in it"
    )


def _say_left_out(times: Array, count: int, why: str, level: int = 3) -> None:
    if len(times):
        text = f"{len(times)} of {count} frames are {why}, the first at t = {times[0]:.6g} s"
        warnings.warn(f"{text}; they are left out", stacklevel=level)


def _noise(steady: Array, swaying: Array, places: Array) -> float:
    """Standard deviation of a frame, by restricted likelihood; places in units of the prior's."""
    q, _ = np.linalg.qr(steady)
    rest, seen = places - q @ (q.T @ places), swaying - q @ (q.T @ swaying)
    u, singular, _ = np.linalg.svd(seen, full_matrices=False)
    along = u.T @ rest
    # What no harmonic explains has the noise alone.
    left = max(float(rest @ rest - along @ along), 0.0)
    free = len(places) - steady.shape[1] - len(singular)
    variance = _NOISES[:, None] ** 2
    modelled = singular**2 + variance
    misfit = (along**2 / modelled).sum(axis=1) + left / variance[:, 0]
    volume = np.log(modelled).sum(axis=1) + free * np.log(variance[:, 0])
    return float(_NOISES[np.argmin(misfit + volume)])
