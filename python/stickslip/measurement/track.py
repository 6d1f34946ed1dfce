"""Mean velocities from tracks: places of a robot's centre, without its angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import check_indexes, numbers
from stickslip._util.messages import check_kind, refuse
from stickslip._util.numbers import Array
from stickslip.errors import ScenarioError
from stickslip.measurement.read_velocity import FASTEST
from stickslip.scenario.keys import Value, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import Drive

FEWEST = 8
"""Frames in the measuring window. Chosen: five are left to tell the noise of a frame."""

_HARMONICS = 20
"""Of the motion within a pulse. Chosen: its corners fall off as 1 / k^2, so 1/400 is left."""

_SWAY = 0.1
"""Prior standard deviation of the first harmonic, in body lengths. Chosen: a body that rocks by
half a radian moves its centre by about as much."""

# Standard deviations of a frame that are tried, in that of the first harmonic. Chosen: from the
# rounding of positions to far beyond the body, in steps below the error of an estimate.
_NOISES = np.geomspace(1e-6, 1e2, 400)


def velocity_of_track(t: ArrayLike, x: ArrayLike, drive: Drive | Scenario) -> dict[str, Value]:
    """One row for a table of velocities, from the tracked centre of a robot.

    The velocity is the mean over the measuring window (`Scenario.window`), as in the summary of a
    run: from the end of the third pulse to the end of the last. It is a fit to the frames within:
    a steady motion, and one that repeats with every pulse; see `fitted_velocity`.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times of the frames, s, in any order; 0 where the drive begins, before its ramp.
    x : array_like, shape (n,)
        Place of the centre along +x, m. Frames that are not finite are left out.
    drive : Drive or Scenario
        What the robot was driven with; of a scenario its robot's length counts too.

    Returns
    -------
    dict
        `velocity` in m/s, and every setting of the drive by its bare name, so that
        ``pandas.DataFrame([velocity_of_track(...), ...])`` suits `Measurement.from_dataframe`.

    Raises
    ------
    ScenarioError
        With one line, if shapes differ, the times do not cover the measuring window, fewer than
        eight frames are in it, the velocity can only be in another unit, or the drive is a program.

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
    velocity, _ = fitted_velocity(t, x, scenario)
    names = [key for key in known_keys() if key.startswith("drive.")]
    return {"velocity": velocity, **{name[6:]: scenario.get(name) for name in names}}


def fitted_velocity(t: ArrayLike, x: ArrayLike, scenario: Scenario) -> tuple[float, float]:
    """Mean velocity of a track over the measuring window, and its standard error, m/s.

    The places are fitted with a + v t + b t^2, t from the middle of the window, a function of the
    phase of the pulse, and white noise. The function is a series of harmonics whose coefficients
    are normal, with a standard deviation of a tenth of the robot's length over the harmonic's
    number. The noise is that of greatest restricted likelihood. So no frame has to fall on an end
    of the window, and the frame rate can be any. Where frames nearly keep step with the pulses, the
    motion within a pulse looks like a slow motion of the robot; the standard error includes that.

    Of n frames with noise s spread evenly over a window of the duration T the error is near
    ``s * sqrt(12 / n) / T``. Not in it is what the start leaves after the third pulse, up to 0.1 %
    of the velocity. Parameters and errors are those of `velocity_of_track`.
    """
    if scenario.drive.mode == "program":
        refuse("drive.mode", "program", "IPP or OPP, whose pulses say what is measured")
    start, end = scenario.window
    period = 1.0 / scenario.drive.frequency
    times, places = _frames(t, x, start, end, period)
    middle, half, unit = (start + end) / 2, (end - start) / 2, _SWAY * scenario.robot.length
    since = (times - middle) / half
    # The square takes up a velocity that changes, and is orthogonal to its mean.
    steady = np.column_stack([np.ones_like(since), since, since**2])
    number = np.arange(1, _HARMONICS + 1)
    phase = 2 * np.pi * np.outer((times - start) / period, number)
    swaying = np.column_stack([np.cos(phase) / number, np.sin(phase) / number])

    noise = _noise(steady, swaying, places / unit)
    # The prior as rows beside the frames, so that one least-squares problem holds both.
    design = np.column_stack([steady, swaying]) / noise
    prior = np.eye(design.shape[1])[steady.shape[1] :]
    q, r = np.linalg.qr(np.vstack([design, prior]))
    data = np.concatenate([places / unit / noise, np.zeros(len(prior))])
    inverse = np.linalg.inv(r)
    scale = unit / half
    velocity = float(scale * inverse[1] @ (q.T @ data))
    error = float(scale * np.linalg.norm(inverse[1]))
    if abs(velocity) > FASTEST:
        raise ScenarioError(
            f"x: gives a velocity of {velocity:.6g} m/s: allowed is {FASTEST:g} m/s at most, with "
            "x in m and t in s; x may be in um or in pixels"
        )
    return velocity, error


def _frames(
    t: ArrayLike, x: ArrayLike, start: float, end: float, period: float
) -> tuple[Array, Array]:
    """Sound frames within the measuring window, in s and m."""
    check_indexes("", {"t": t, "x": x})
    times, places = numbers("t", t, unit="s", gaps=True), numbers("x", x, unit="m", gaps=True)
    if times.ndim != 1 or times.shape != places.shape:
        raise ScenarioError(
            f"t and x have the shapes {times.shape} and {places.shape}: allowed is one number of "
            "each for every frame"
        )
    sound = np.isfinite(times) & np.isfinite(places)
    times, places = times[sound], places[sound]
    window = f"the measuring window, {start:.6g} to {end:.6g} s"
    if len(times) == 0:
        raise ScenarioError("t and x: no frame has both: allowed are numbers in s and m")
    step = max(period, float(np.median(np.diff(np.unique(times)))) if np.ptp(times) else 0.0)
    if times.min() > start + step or times.max() < end - step:
        span = f"{times.min():.6g} to {times.max():.6g}"
        raise ScenarioError(
            f"t = {span}: allowed are times in s, 0 where the drive begins, that cover {window}, "
            "to a pulse or a frame at either end"
        )
    inside = (times >= start) & (times <= end)
    if inside.sum() < FEWEST or np.ptp(times[inside]) < 0.5 * (end - start):
        hint = "; t may be in ms or the number of the frame" if times.max() > 10 * end else ""
        raise ScenarioError(
            f"t: {int(inside.sum())} frames are in {window}: allowed are {FEWEST} or more, spread "
            f"over it{hint}"
        )
    return times[inside], places[inside]


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
