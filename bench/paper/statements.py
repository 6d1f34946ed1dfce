"""The paper's statements S1 to S17, and how far the settings bear them out.

Each is a function of `Walks` whose docstring says in one sentence what the paper states, and in the
next what counts as such: the paper gives no thresholds, so these are choices of this study. It
returns where the statement holds, over the settings of IPP and OPP that enter, and its numbers by
name and unit.

All angles are magnitudes: the upstroke is where abs(theta) rises, whatever the clamp coil's sign.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
from xarray import DataArray

from paper.walks import MODES, WORKING_FREQUENCIES, Setting, Walks
from stickslip import Coils, Robot
from stickslip._util.arrays import Array

Found: TypeAlias = "tuple[DataArray, dict[str, Any]]"

# Shares of the pairs of working settings between which a statement depends on them; chosen.
_REPRODUCED_FROM, _NOT_REPRODUCED_TO = 0.9, 0.1

_NAMED_FROM = 0.25  # difference that a setting makes to the share for it to be named; chosen
_NAMED = 2  # settings that are named; chosen: more are hard to read

_TYPICAL_VELOCITY = 0.88e-3  # m/s; what the paper's Reynolds number of 0.22 comes to, section VI-C


def of_both(of_one: Callable[[Any], Found]) -> Callable[[Walks], Found]:
    """A statement on one mode as the same on both."""

    @functools.wraps(of_one)
    def statement(walks: Walks) -> Found:
        (ipp, of_ipp), (opp, of_opp) = (of_one(walks[mode]) for mode in MODES)
        numbers = {f"IPP {name}": value for name, value in of_ipp.items()}
        return ipp & opp, numbers | {f"OPP {name}": value for name, value in of_opp.items()}

    return statement


def line(y: DataArray, along: str, through_zero: bool = False) -> tuple[DataArray, DataArray]:
    """Slope of the least-squares line, and the share of the variance that it explains."""
    centre = y - y.mean(along)
    x = y[along] if through_zero else y[along] - y[along].mean()
    slope = (y * x).sum(along) / (x**2).sum(along)
    rest = (y if through_zero else centre) - slope * x
    return slope, 1.0 - (rest**2).sum(along) / (centre**2).sum(along)


def bend(y: DataArray, along: str) -> DataArray:
    """Slope of the upper half of a curve over that of the lower one; below 1 it rolls off."""
    middle = y.sizes[along] // 2
    upper, lower = y.isel({along: slice(middle, None)}), y.isel({along: slice(middle + 1)})
    return line(upper, along)[0] / line(lower, along)[0]


def velocity(mode: Any, scan: str, low: float = 0.0, high: float = np.inf) -> Any:
    """Mean velocity over a part of a scan, m/s."""
    return mode[f"over_{scan}"].sel({scan: slice(low, high)})


def left(mode: Any, scan: str) -> Any:
    """Velocity over that at the first of a scan's values."""
    curve = mode[f"over_{scan}"]
    return curve / curve.isel({scan: 0}, drop=True)


def means(walks: Walks, scan: str, low: float, high: float) -> tuple[list[Any], dict[str, Any]]:
    """Mean velocity of IPP and OPP over a part of a scan, m/s, and the same as numbers."""
    means = [velocity(walks[mode], scan, low, high).mean(scan) for mode in MODES]
    return means, {f"{mode} (mm/s)": 1e3 * mean for mode, mean in zip(MODES, means, strict=True)}


def s1(walks: Walks) -> Found:
    """IPP slips on the downstroke. 80% of the slip's path on the downstroke, forwards, at 30 Hz."""
    share = 1.0 - walks["IPP"].slip_share_up
    holds = (share >= 0.8) & (walks["IPP"].slip_down > 0.0)
    return holds, {"share of the path on the downstroke": share}


def s2(walks: Walks) -> Found:
    """OPP slips on the upstroke. 80% of the slip's path on the upstroke, forwards, at 30 Hz."""
    share = walks["OPP"].slip_share_up
    holds = (share >= 0.8) & (walks["OPP"].slip_up > 0.0)
    return holds, {"share of the path on the upstroke": share}


def s3(walks: Walks) -> Found:
    """The normal force is low on IPP's downstroke and high on OPP's upstroke. The mean while
    slipping below, or above, weight and adhesion, at 30 Hz."""
    down, up = walks["IPP"].normal_force_down, walks["OPP"].normal_force_up
    numbers = {"IPP's force over that at rest": down, "OPP's force over that at rest": up}
    return (down < 1.0) & (up > 1.0), numbers


def s4(walks: Walks) -> Found:
    """The steady angle is much larger in IPP than in OPP. 1.25 times or more, before the pulses and
    in the mean at 30 Hz."""
    ipp, opp = walks["IPP"], walks["OPP"]
    still, moving = ipp.still_tilt, ipp.mean_tilt
    return (still > 1.25 * opp.still_tilt) & (moving > 1.25 * opp.mean_tilt), {
        "IPP before the pulses (degrees)": np.degrees(still),
        "OPP before the pulses (degrees)": np.degrees(opp.still_tilt),
        "IPP at 30 Hz (degrees)": np.degrees(moving),
        "OPP at 30 Hz (degrees)": np.degrees(opp.mean_tilt),
    }


@of_both
def s5(mode: Any) -> Found:
    """Velocity is proportional to a low frequency. R² of a line through the origin to 30 Hz at
    least 0.95."""
    slope, explained = line(velocity(mode, "frequency", high=30.0), "frequency", True)
    return explained >= 0.95, {"way a pulse (µm)": 1e6 * slope, "R²": explained}


@of_both
def s6(mode: Any) -> Found:
    """Velocity rolls off at high frequency. 10% or more below the line of S5 at 100,
    120 and 150 Hz."""
    slope, _ = line(velocity(mode, "frequency", high=30.0), "frequency", True)
    over = velocity(mode, "frequency", low=100.0) / (slope * mode.frequency)
    numbers = {f"over the line at {at} Hz": over.sel(frequency=at) for at in (100, 150)}
    return (over <= 0.9).all("frequency"), numbers


def s7(walks: Walks) -> Found:
    """With little friction OPP is faster. Means for static friction 0.02, 0.05 and 0.1."""
    (ipp, opp), numbers = means(walks, "friction", 0.0, 0.1)
    return opp > ipp, numbers


def s8(walks: Walks) -> Found:
    """With static friction from 0.2 to 1.0 both modes are about as fast. Mean difference at most
    30% of the mean velocity."""
    ipp, opp = (velocity(walks[mode], "friction", 0.2, 1.0) for mode in MODES)
    mean = 0.5 * (abs(ipp) + abs(opp)).mean("friction")
    apart = abs(opp - ipp).mean("friction") / mean
    return apart <= 0.3, means(walks, "friction", 0.2, 1.0)[1] | {"mean difference": apart}


def s9(walks: Walks) -> Found:
    """With static friction above 1 IPP is faster. Means for static friction 1.2 to 2.4."""
    (ipp, opp), numbers = means(walks, "friction", 1.2, 2.4)
    return ipp > opp, numbers


def s10(walks: Walks) -> Found:
    """With little adhesion OPP is faster, and more adhesion costs it more. Means to 0.05 µN, and
    what is left of them at 0.4 to 0.6 µN."""
    (ipp, opp), numbers = means(walks, "adhesion", 0.0, 0.05e-6)
    (less_ipp, less_opp), _ = means(walks, "adhesion", 0.4e-6, 0.6e-6)
    of_ipp, of_opp = less_ipp / ipp, less_opp / opp
    holds = (opp > ipp) & (of_opp <= of_ipp)
    return holds, numbers | {"left of IPP": of_ipp, "left of OPP": of_opp}


@of_both
def s11(mode: Any) -> Found:
    """Linear damping slows both modes, from where it matters little to where nothing moves. Within
    10% to 1e-6 N s/m, never rising by more than that, below 2% at 1e-2 N s/m."""
    part = left(mode, "linear")
    level = (abs(part.sel(linear=slice(1e-6)) - 1.0) <= 0.1).all("linear")
    falls = (part.diff("linear") <= 0.1).all("linear")
    numbers = {f"left at {drag:g} N s/m": part.sel(linear=drag) for drag in (1e-6, 1e-2)}
    return level & falls & (abs(part.sel(linear=1e-2)) <= 0.02), numbers


@of_both
def _little_then_slower(mode: Any) -> Found:
    part = left(mode, "rotational")
    level = (abs(part.sel(rotational=slice(3e-17)) - 1.0) <= 0.1).all("rotational")
    last = part.sel(rotational=1e-13)
    return level & (last <= 0.9), {"left at 1e-13 N m s²": last}


def s12(walks: Walks) -> Found:
    """Rotational damping matters little when low; then both modes lose alike. Within 10% to
    3e-17 N m s², slower by as much at 1e-13, and from 1e-15 on the part left of the velocity equal
    within 15%."""
    holds, numbers = _little_then_slower(walks)
    ipp, opp = (left(walks[mode], "rotational") for mode in MODES)
    apart = abs(ipp - opp).sel(rotational=slice(1e-15, None)).mean("rotational")
    return holds & (apart <= 0.15), numbers | {"mean difference from 1e-15 on": apart}


@of_both
def s13(mode: Any) -> Found:
    """Velocity grows about linearly with the field, in IPP with some roll-off. R² of a line at
    least 0.95 from 1.5 to 6.5 mT at 30 Hz, rising; in IPP the upper half less steep by 10% or more.
    """
    (slope, explained), bent = line(mode.over_field, "field"), bend(mode.over_field, "field")
    holds = (slope > 0.0) & (explained >= 0.95) & ((mode["mode"] == "OPP") | (bent <= 0.9))
    return holds, {"((mm/s)/mT)": slope, "R²": explained, "upper slope over lower": bent}


@of_both
def s14(mode: Any) -> Found:
    """Constant fields move nothing. Mean speed at most 1 µm/s for a second, at the sawtooth's
    bottom and at its top."""
    return mode.still_velocity <= 1e-6, {"(nm/s)": 1e9 * mode.still_velocity}


def s15(walks: Walks) -> Found:
    """The greatest torque is 10.5 µN mm, the greatest force 240 nN. Within 1%, at 6.5 mT; the force
    at the centre, or where the gradient is Table I's."""
    coils, robot = Coils(), Robot()
    moment = robot.length * robot.width * robot.height * robot.magnetization
    towards_the_coil = np.zeros((2001, 3))
    towards_the_coil[:, 0] = np.linspace(0.0, 20e-3, 2001)
    currents = _ONE_COIL * _GREATEST_FIELD / coils.centre_field_per_ampere
    gradient = coils.gradient(towards_the_coil, currents)[:, 0, 0]
    offset = np.interp(_GREATEST_GRADIENT, gradient, towards_the_coil[:, 0])
    torque = moment * _GREATEST_FIELD
    force = moment * np.array([gradient[0], _GREATEST_GRADIENT])
    holds = (abs(torque / 10.5e-9 - 1.0) < 0.01) & (abs(force / 240e-9 - 1.0) < 0.01)
    return DataArray(holds, dims="place"), {
        "torque (µN mm)": torque * 1e9,
        "force at the centre (nN)": force[0] * 1e9,
        f"force {offset * 1e3:.1f} mm towards the coil (nN)": force[1] * 1e9,
    }


def s16(walks: Walks) -> Found:
    """One filament stands for the winding within 2.2%. In a cube of 25 mm, for a flat winding and
    one as deep as wide."""
    flat, deep = (winding_difference(depth) for depth in (0.0, 0.5 * (_OUTER - _INNER)))
    numbers = {"from a flat winding (%)": flat * 100.0, "from a deep one (%)": deep * 100.0}
    return DataArray(max(flat, deep) <= 0.022), numbers


def s17(walks: Walks) -> Found:
    """In a cube of 25 mm the fringe field stays below 2.5% of the main one. The greatest single
    component across the coil's axis over the one along it."""
    wide, narrow = fringe(25e-3), fringe(5e-3)
    numbers = {"greatest part in 25 mm (%)": wide * 100.0, "in 5 mm (%)": narrow * 100.0}
    return DataArray(wide < 0.025), numbers


_ALL = (s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13, s14, s15, s16, s17)
STATEMENTS = {each.__name__.upper(): each for each in _ALL}

_MOTION = 4  # statements on the motion itself, which the reference has to meet first

_GREATEST_FIELD, _GREATEST_GRADIENT = 6.5e-3, 0.149  # T and T/m at the centre, Table I
_INNER, _OUTER = 0.120, 0.157  # length of the winding, Table I, m
_ONE_COIL = np.array([1.0, 0.0, 0.0, 0.0, 0.0])  # A


def _cube(side: float, count: int) -> Array:
    axis = np.linspace(-0.5 * side, 0.5 * side, count)
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)


def fringe(side: float) -> float:
    """Greatest component across one coil's axis over the one along it, in a cube."""
    field = np.abs(Coils().field(_cube(side, 21), _ONE_COIL))
    return float((field[..., 1:].max(axis=-1) / field[..., 0]).max())


def winding_difference(depth: float) -> float:
    """Greatest relative difference of one filament from a winding, in a cube of 25 mm.

    The winding is spread evenly between its inner and outer length and over `depth` (m) along its
    axis.
    """
    filament = Coils()
    points = _cube(25e-3, 11)
    # A Gauss-Legendre rule; twice as many nodes change nothing by 1e-12.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    sides = 0.5 * (_OUTER + _INNER) + 0.5 * (_OUTER - _INNER) * nodes
    axial = [(0.0, 2.0)] if depth == 0.0 else list(zip(nodes, weights, strict=True))
    field = np.zeros_like(points)
    for side, weight in zip(sides, weights, strict=True):
        for place, axial_weight in axial:
            coil = Coils(side, filament.distance + 0.5 * depth * place, filament.turns)
            field += 0.25 * weight * axial_weight * coil.field(points, _ONE_COIL)
    difference = field - filament.field(points, _ONE_COIL)
    return float((np.linalg.norm(difference, axis=-1) / np.linalg.norm(field, axis=-1)).max())


def judge(walks: Walks) -> tuple[pd.DataFrame, dict[str, Setting]]:
    """The table of all statements, and the reference: the settings of the figures by mode.

    Columns are the `statement`, its `text` and `condition`; the `verdict`, "reproduced", "not
    reproduced" or "depends"; the `share` of the pairs of working settings for which it holds, NaN
    where settings do not enter; `at_reference`, whether it holds for the reference; the `settings`
    on which it depends most, each with the value for which it holds most often; and the `numbers`
    at the reference by name.
    """
    results = {name: statement(walks) for name, statement in STATEMENTS.items()}
    works = (walks["IPP"].works & walks["OPP"].works).transpose(*MODES)
    places = zip(MODES, np.nonzero(works.values), strict=True)
    at = {mode: DataArray(place, dims="pair") for mode, place in places}
    holds = pd.DataFrame(
        {
            name: where.isel(at, missing_dims="ignore")
            for name, (where, _) in results.items()
            if {*where.dims} & {*MODES}
        }
    )
    factors = pd.DataFrame(
        {
            f"{mode} {name}": walks[mode][name].isel({mode: at[mode]})
            for mode in MODES
            for name in Setting._fields[1:]
        }
    )
    best = _reference(walks, at, holds)
    pair = {mode: int(at[mode][best]) for mode in MODES}
    rows = [_row(name, found, pair, holds, factors) for name, found in results.items()]
    reference = {
        mode: Setting(*(walks[mode][name].values.tolist()[pair[mode]] for name in Setting._fields))
        for mode in MODES
    }
    return pd.DataFrame(rows), reference


def _row(
    name: str, found: Found, pair: dict[str, int], holds: pd.DataFrame, factors: pd.DataFrame
) -> dict[str, Any]:
    """One statement in the table of `judge`; `pair` has the places of the reference."""
    where, numbers = found
    words = " ".join(str(STATEMENTS[name].__doc__).split())
    text, _, condition = words.partition(". ")
    share = float(holds[name].mean() if name in holds else where.mean())
    verdict = "reproduced" if share >= _REPRODUCED_FROM else "depends"
    verdict = "not reproduced" if share <= _NOT_REPRODUCED_TO else verdict
    depends = verdict == "depends" and name in holds
    return {
        "statement": name,
        "text": f"{text}.",
        "condition": condition,
        "verdict": verdict,
        "share": share if name in holds else np.nan,
        "at_reference": bool(where.isel(pair, missing_dims="ignore").all()),
        "settings": _deciding(holds[name], factors) if depends else "",
        "numbers": {
            what: float(DataArray(value).isel(pair, missing_dims="ignore"))
            for what, value in numbers.items()
        },
    }


def _reference(walks: Walks, at: dict[str, DataArray], holds: pd.DataFrame) -> int:
    """Place among the pairs of the one with which the figures are drawn.

    First come those with the most of S1 to S4, then with the most of the others, then that whose
    velocities are nearest, in ratio, to that of the paper's Reynolds number.
    """
    score = 100 * holds.iloc[:, :_MOTION].sum(axis=1) + holds.iloc[:, _MOTION:].sum(axis=1)
    velocities = [
        walks[mode].over_frequency.sel(frequency=WORKING_FREQUENCIES).isel({mode: at[mode]})
        for mode in MODES
    ]
    distance = sum(abs(np.log(speed / _TYPICAL_VELOCITY)).mean("frequency") for speed in velocities)
    return int(np.nanargmin(distance.where(score.to_numpy() == score.max())))


def _deciding(holds: pd.Series, factors: pd.DataFrame) -> str:
    """The settings whose values differ most in their share, each with its best value."""
    named = []
    for name in factors:
        shares = holds.groupby(factors[name]).mean()
        apart, best = shares.max() - shares.min(), shares.idxmax()
        if apart >= _NAMED_FROM:
            value = best if isinstance(best, str) else f"{best * 1e3:g} mT"
            named.append((apart, f"{name} {value} ({shares.max():.0%})"))
    return ", ".join(text for _, text in sorted(named, reverse=True)[:_NAMED]) or "none alone"
