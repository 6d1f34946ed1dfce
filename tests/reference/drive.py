"""Coil voltages of the two sawtooth modes, written from the description of `[drive]` alone."""

from dataclasses import dataclass, replace

import numpy as np

from .field import CENTRE_FIELD_PER_AMPERE, RESISTANCE

DRIVE_DEFAULTS = {
    "mode": "IPP", "frequency": 100.0, "peak": 2.5e-3, "base": 0.0, "hold": 1.0e-3, "clamp": "down",
    "edge": "rise", "edge_time": 0.0, "direction": "+x", "ramp": 0.05, "pulses": 100,
    "ramp_down": 0.0,
}  # fmt: skip

_CHOICES = {
    "mode": ("IPP", "OPP"),
    "clamp": ("down", "up"),
    "edge": ("rise", "fall"),
    "direction": ("+x", "-x"),
}


@dataclass(frozen=True)
class Voltages:
    """Piecewise-linear voltages of some coils.

    start: (n,) s, start of each segment; the last one is constant and lasts for ever.
    level: (n, m) V at the segment's start; of a sawtooth mode the in-plane coil (+x) and the clamp.
    slope: (n, m) V/s.
    first_counted: s, end of the third pulse (nan with three pulses or fewer).
    last_counted: s, end of the last pulse.
    end: s, end of the drive, ramp-down included.
    """

    start: np.ndarray
    level: np.ndarray
    slope: np.ndarray
    first_counted: float
    last_counted: float
    end: float


def complete(name: str, given: dict | None, defaults: dict) -> dict:
    """`given` with defaults filled in. Raises ValueError on a key that it does not know."""
    given = given or {}
    unknown = set(given) - set(defaults)
    if unknown:
        raise ValueError(f"unknown {name} keys: {sorted(unknown)}")
    return {**defaults, **given}


def complete_drive(drive: dict) -> dict:
    """`drive` with defaults filled in. Raises ValueError on a key or word it does not know."""
    full = complete("drive", drive, DRIVE_DEFAULTS)
    for key, allowed in _CHOICES.items():
        if full[key] not in allowed:
            raise ValueError(f"drive.{key} = {full[key]!r}, allowed: {allowed}")
    return full


def _pulse(edge: str, period: float, edge_time: float):
    """One period as (duration s, level at start, level at end), 0 = base and 1 = peak."""
    slow = period - edge_time
    pieces = [(edge_time, 0.0, 1.0), (slow, 1.0, 0.0)]
    if edge == "fall":
        pieces = [(slow, 0.0, 1.0), (edge_time, 1.0, 0.0)]
    # A piece of no duration is the jump itself and needs no segment.
    return [piece for piece in pieces if piece[0] > 0.0]


def voltages_of(drive: dict) -> Voltages:
    """Voltages for a `[drive]` table in the robot's own frame (`direction` is not applied here)."""
    d = complete_drive(drive)
    volts_per_tesla = RESISTANCE / CENTRE_FIELD_PER_AMPERE
    clamp_sign = -1.0 if d["clamp"] == "down" else 1.0
    pulsed_is_clamp = d["mode"] == "OPP"

    def pair(pulsed_field: float, held_field: float):
        pulsed, held = volts_per_tesla * pulsed_field, volts_per_tesla * held_field
        return (held, clamp_sign * pulsed) if pulsed_is_clamp else (pulsed, clamp_sign * held)

    start, level, slope = [], [], []

    def add(begin: float, duration: float, at_begin, at_end):
        start.append(begin)
        level.append(at_begin)
        slope.append([(b - a) / duration for a, b in zip(at_begin, at_end, strict=True)])

    rest = pair(d["base"], d["hold"])
    if d["ramp"] > 0.0:
        add(0.0, d["ramp"], (0.0, 0.0), rest)
    period = 1.0 / d["frequency"]
    for pulse in range(d["pulses"]):
        elapsed = 0.0
        for duration, low, high in _pulse(d["edge"], period, d["edge_time"]):
            fields = [d["base"] + share * (d["peak"] - d["base"]) for share in (low, high)]
            begin = d["ramp"] + pulse * period + elapsed
            add(begin, duration, pair(fields[0], d["hold"]), pair(fields[1], d["hold"]))
            elapsed += duration
    last = d["ramp"] + d["pulses"] * period
    final = rest
    if d["ramp_down"] > 0.0:
        final = (0.0, rest[1])
        add(last, d["ramp_down"], rest, final)
    end = last + d["ramp_down"]
    add(end, 1.0, final, final)
    return Voltages(
        start=np.array(start),
        level=np.array(level, dtype=float),
        slope=np.array(slope, dtype=float),
        first_counted=d["ramp"] + 3 * period if d["pulses"] > 3 else np.nan,
        last_counted=last,
        end=end,
    )


def clipped(volts: Voltages, limit: float) -> Voltages:
    """Voltages of amplifiers that clip at +-limit, V."""
    start, level, slope = [], [], []
    ends = np.append(volts.start[1:], np.inf)
    for begin, end, first, rate in zip(volts.start, ends, volts.level, volts.slope, strict=True):
        cuts = {float(begin)}
        for value, change in zip(first, rate, strict=True):
            for bound in (-limit, limit) if change != 0.0 else ():
                cut = begin + (bound - value) / change
                if begin < cut < end:
                    cuts.add(float(cut))
        for cut in sorted(cuts):
            later = min([other for other in (*cuts, end) if other > cut])
            middle = cut + (0.5 * (later - cut) if np.isfinite(later) else 1.0)
            inside = np.abs(first + rate * (middle - begin)) < limit
            start.append(cut)
            level.append(np.clip(first + rate * (cut - begin), -limit, limit))
            slope.append(np.where(inside, rate, 0.0))
    return replace(volts, start=np.array(start), level=np.array(level), slope=np.array(slope))


def held(volts: Voltages, period: float) -> Voltages:
    """The staircase of a controller that gives the voltages at multiples of `period`, s.

    At a jump it gives what comes after it; a nanosecond puts times on that side.
    """
    start = period * np.arange(int(np.ceil(volts.end / period - 1e-9)) + 1)
    start[-1] = volts.end
    at = np.searchsorted(volts.start, start + 1e-9, side="right") - 1
    level = volts.level[at] + volts.slope[at] * np.maximum(start - volts.start[at], 0.0)[:, None]
    return replace(volts, start=start, level=level, slope=np.zeros_like(level))
