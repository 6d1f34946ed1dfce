"""All settings of the grid, each through all scans of the paper."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.points import COLUMN, SCANS, Array, evaluate, point, varied
from stickslip.reproduction.settings import MODES, PEAK, Mode, Setting
from stickslip.reproduction.strokes import strokes
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import simulate_batch

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

Flags = NDArray[np.bool_]

# The fields of `Behaviour` that come from scans, and from recorded runs.
SCANNED = ("frequency", "friction", "adhesion", "linear", "rotational", "field")
_BY_STROKE = ("tilt", "slip_up", "slip_down", "normal_up", "normal_down", "share_up")

STROKE_FREQUENCY = 30.0
"""Frequency of the runs that are looked at stroke by stroke, as in Figs. 4 to 7, Hz."""

WORKING_FREQUENCIES = (30.0, 100.0)
"""Those of the paper's figures, at which a setting has to walk, Hz."""

_MIN_VELOCITY = 2e-5  # m/s; chosen: a hundredth of what the paper measured
_TILT_TOLERANCE = 0.02  # rad; chosen: a degree, by which a body that lies flat may rock back
_STROKE_PULSES = 12  # as `PULSES_WHEN_SLOW`
_STROKE_RATE = 20e3  # Hz; ten samples a period of the fastest free swing and more


class Behaviour(NamedTuple):
    """What some settings do.

    The axes of the settings come first in every array: those of one mode have one of length n as
    `survey` makes it, or what `at` makes of it; see also `paired`.
    """

    settings: NDArray[np.object_]  # of `Setting`
    # Mean velocity over the values of each scan, m/s; the median of small changes.
    frequency: Array
    friction: Array
    adhesion: Array
    linear: Array
    rotational: Array
    field: Array
    painleve: NDArray[np.int64]  # events over the values of "friction" and the small changes
    # Least and greatest tilt at 30 Hz and 100 Hz, rad, positive where the clamp coil pulls it.
    tilt_low: Array
    tilt_high: Array
    still_tilt: Array  # with base and hold alone, before the first pulse, rad
    still_velocity: Array  # greatest speed with constant fields, m/s
    # By stroke at 30 Hz; NaN for a setting that does not work, and the last three without slip.
    tilt: Array  # mean of |theta|, rad
    slip_up: Array  # of the contact along +x, m
    slip_down: Array
    normal_up: Array  # mean normal force while the contact slips, over that at rest
    normal_down: Array
    share_up: Array  # part of the slip's path that falls on the upstroke, 0 to 1

    def at(self, index: Any) -> Behaviour:
        """The settings at an index of their axis; one that adds an axis makes them broadcast."""
        return Behaviour(*(each[index] for each in self))

    def velocity(self, scan: str, values: Sequence[float]) -> Array:
        """Velocity at some of a scan's values, which are the last axis, m/s."""
        places = [SCANS[scan].values.index(value) for value in values]
        return np.asarray(getattr(self, scan)[..., places])

    @property
    def works(self) -> Flags:
        """Which settings walk as the paper's robot does.

        Forwards at 30 Hz and at 100 Hz, and with the tilt between flat and upright throughout.
        """
        return np.asarray(self.works_margin > 0.0)

    @property
    def works_margin(self) -> Array:
        """By how much each setting works, a pure number above zero where it does."""
        velocity = self.velocity("frequency", WORKING_FREQUENCIES).min(axis=-1)
        low, high = self.tilt_low, self.tilt_high
        parts = [velocity / _MIN_VELOCITY - 1.0, low + _TILT_TOLERANCE, 0.5 * np.pi - high]
        return np.asarray(np.min(parts, axis=0))


Survey = Mapping[Mode, Behaviour]
"""Behaviours by mode."""


def paired(ipp: Behaviour, opp: Behaviour) -> Behaviour:
    """Behaviours of pairs of settings, with an axis of length 2 for the modes before all others."""
    return Behaviour(*(np.stack(np.broadcast_arrays(*each)) for each in zip(ipp, opp, strict=True)))


def all_pairs(found: Survey) -> Behaviour:
    """Behaviours of all pairs, shape (2, settings of IPP, settings of OPP)."""
    return paired(found["IPP"].at(np.s_[:, np.newaxis]), found["OPP"])


def working_pairs(pairs: Behaviour) -> Flags:
    """Which of `paired` behaviours are of two working settings."""
    return np.asarray(pairs.works.all(axis=0))


def survey(
    settings: Mapping[Mode, Sequence[Setting]],
    count: int,
    threads: int,
    progress: Progress | None = None,
) -> dict[Mode, Behaviour]:
    """Simulate every setting, with `count` small changes for each point."""
    batches = []
    for mode in MODES:
        scans = [SCANS[name].points(settings[mode], SCANS[name].values) for name in SCANNED]
        batches += [*(varied(each, count) for each in scans), _constant_fields(settings[mode])]
    results = iter(evaluate(batches, threads, progress))
    found = {}
    for mode in MODES:
        scanned = {name: next(results) for name in SCANNED}
        still = next(results)
        low, high = _tilt_range(settings[mode], scanned["frequency"])
        found[mode] = Behaviour(
            settings=np.array(settings[mode], dtype=object),
            **{name: _median(result["mean_velocity"]) for name, result in scanned.items()},
            painleve=scanned["friction"]["painleve"],
            tilt_low=low,
            tilt_high=high,
            still_tilt=np.abs(still["theta_max"][:, 0]),
            still_velocity=np.abs(still["mean_velocity"]).max(axis=1),
            **{name: np.full(len(low), np.nan) for name in _BY_STROKE},
        )
        working = np.flatnonzero(found[mode].works)
        scenarios = [stroke_scenario(each) for each in found[mode].settings[working]]
        for place, run in zip(working, simulate_batch(scenarios, threads), strict=True):
            for name, value in strokes(run).items():
                getattr(found[mode], name)[place] = value
    return found


def _median(values: Array) -> Array:
    """Over the small changes, without those that failed; NaN where all did."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "All-NaN slice", RuntimeWarning)
        return np.asarray(np.nanmedian(values, axis=-1))


def _constant_fields(settings: Sequence[Setting]) -> Array:
    """Points for a second with constant fields: base and hold, then peak and hold."""
    points = np.array([point({**s.keys(), "drive.peak": PEAK}) for s in settings])
    result = np.repeat(points[:, np.newaxis], 2, axis=1)
    # Velocity is measured from the end of the third pulse on: ten periods of 0.1 s.
    result[..., COLUMN["drive.frequency"]] = 10.0
    result[..., COLUMN["drive.pulses"]] = 13
    result[:, 0, COLUMN["drive.peak"]] = [s.base for s in settings]
    result[:, 1, COLUMN["drive.base"]] = PEAK
    return result


def _tilt_range(settings: Sequence[Setting], result: dict[str, Any]) -> tuple[Array, Array]:
    places = [SCANS["frequency"].values.index(each) for each in WORKING_FREQUENCIES]
    least = result["theta_min"][:, places].min(axis=(1, 2))
    greatest = result["theta_max"][:, places].max(axis=(1, 2))
    down = np.array([setting.tilt_sign for setting in settings]) > 0.0
    return np.where(down, least, -greatest), np.where(down, greatest, -least)


def stroke_scenario(setting: Setting) -> Scenario:
    """The run of a setting that is looked at stroke by stroke."""
    return Scenario().replace(
        {
            **setting.keys(),
            "drive.peak": PEAK,
            "drive.frequency": STROKE_FREQUENCY,
            "drive.pulses": _STROKE_PULSES,
            "record.rate": _STROKE_RATE,
        }
    )
