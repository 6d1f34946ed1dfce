"""All settings of the grid, each through all scans of the paper."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.points import COLUMN, SCANS, Array, evaluate, point, varied
from stickslip.reproduction.settings import MODES, PEAK, Mode, Setting
from stickslip.reproduction.strokes import Strokes, strokes
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import simulate_batch

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

Flags = NDArray[np.bool_]
_Kind = TypeVar("_Kind", bound=np.generic)

SCANNED = ("frequency", "friction", "adhesion", "linear", "rotational", "field")

STROKE_FREQUENCY = 30.0
"""Frequency of the runs that are looked at stroke by stroke, as in Figs. 4 to 7, Hz."""

WORKING_FREQUENCIES = (30.0, 100.0)
"""Those of the paper's figures, at which a setting has to walk, Hz."""

_MIN_VELOCITY = 2e-5  # m/s; chosen: a hundredth of what the paper measured
_TILT_TOLERANCE = 0.02  # rad; chosen: a degree, by which a body that lies flat may rock back
_STROKE_PULSES = 12  # as `PULSES_WHEN_SLOW`
_STROKE_RATE = 20e3  # Hz; ten samples a period of the fastest free swing and more


def pairwise(mode: Mode, values: NDArray[_Kind]) -> NDArray[_Kind]:
    """Values of the settings of a mode, shape (n, ...), as they broadcast to all pairs of settings.

    A pair is one setting of IPP, along the first axis, and one of OPP, along the second.
    """
    return values[:, np.newaxis] if mode == "IPP" else values[np.newaxis]


@dataclass(frozen=True, eq=False)
class Survey:
    """What every setting of the grid does; n is the number of settings of a mode.

    Velocities, tilts and speeds are arrays by mode, or by mode and scan. Those of a scan have the
    shape (n, number of its values), all others (n,).
    """

    settings: dict[Mode, list[Setting]]
    velocity: dict[tuple[Mode, str], Array]  # mean, m/s; the median of small changes
    painleve: dict[tuple[Mode, str], NDArray[np.int64]]  # events, summed over the small changes
    count: int  # simulations behind each velocity
    # Least and greatest tilt at 30 Hz and 100 Hz, rad, positive where the clamp coil pulls it.
    tilt_low: dict[Mode, Array]
    tilt_high: dict[Mode, Array]
    still_tilt: dict[Mode, Array]  # with base and hold alone, before the first pulse, rad
    still_velocity: dict[Mode, Array]  # greatest speed with constant fields, m/s
    strokes: dict[Mode, list[Strokes | None]]  # None for a setting that does not work

    def works(self, mode: Mode) -> Flags:
        """Which settings walk as the paper's robot does, shape (n,).

        Forwards at 30 Hz and at 100 Hz, and with the tilt between flat and upright throughout.
        """
        return np.asarray(self.works_margin(mode) > 0.0)

    def works_margin(self, mode: Mode) -> Array:
        """By how much each setting works, a pure number above zero where it does, shape (n,)."""
        velocity = self.at(mode, "frequency", WORKING_FREQUENCIES).min(axis=1)
        low, high = self.tilt_low[mode], self.tilt_high[mode]
        parts = [velocity / _MIN_VELOCITY - 1.0, low + _TILT_TOLERANCE, 0.5 * np.pi - high]
        return np.asarray(np.min(parts, axis=0))

    def working_pairs(self) -> Flags:
        """Which pairs consist of working settings, shape (settings of IPP, settings of OPP)."""
        return pairwise("IPP", self.works("IPP")) & pairwise("OPP", self.works("OPP"))

    def at(self, mode: Mode, scan: str, values: Sequence[float]) -> Array:
        """Velocity at some of a scan's values, m/s, shape (n, len(values))."""
        places = [SCANS[scan].values.index(value) for value in values]
        return self.velocity[mode, scan][:, places]


def survey(
    settings: Mapping[Mode, Sequence[Setting]],
    count: int,
    threads: int,
    progress: Progress | None = None,
) -> Survey:
    """Simulate every setting, with `count` small changes for each point."""
    keys = [(mode, name) for mode in MODES for name in SCANNED]
    batches = [
        varied(SCANS[name].points(settings[mode], SCANS[name].values), count) for mode, name in keys
    ]
    batches += [_constant_fields(settings[mode]) for mode in MODES]
    results = evaluate(batches, threads, progress)
    scanned = dict(zip(keys, results, strict=False))
    still = dict(zip(MODES, results[len(keys) :], strict=True))
    tilts = {mode: _tilt_range(settings[mode], scanned[mode, "frequency"]) for mode in MODES}
    found = Survey(
        settings={mode: list(each) for mode, each in settings.items()},
        velocity={k: _median(scanned[k]["mean_velocity"]) for k in keys},
        painleve={k: scanned[k]["painleve"].sum(axis=-1) for k in keys},
        count=count,
        tilt_low={mode: tilts[mode][0] for mode in MODES},
        tilt_high={mode: tilts[mode][1] for mode in MODES},
        still_tilt={mode: np.abs(still[mode]["theta_max"][:, 0]) for mode in MODES},
        still_velocity={mode: np.abs(still[mode]["mean_velocity"]).max(axis=1) for mode in MODES},
        strokes={mode: [None] * len(settings[mode]) for mode in MODES},
    )
    for mode in MODES:
        chosen = np.flatnonzero(found.works(mode))
        scenarios = [stroke_scenario(found.settings[mode][i]) for i in chosen]
        for i, run in zip(chosen, simulate_batch(scenarios, threads), strict=True):
            found.strokes[mode][i] = strokes(run)
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
