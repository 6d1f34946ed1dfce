"""Voltage programs of the five coils, put together from pieces."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, Mask, check_indexes, in_columns, locked, numbers
from stickslip._util.columns import read_table
from stickslip._util.files import write_rows
from stickslip._util.messages import check_above_zero, check_whole, known_arguments, refuse
from stickslip._util.recipes import Recipe
from stickslip._util.text import highest, is_number
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import Coil, Drive

_Block = tuple[Array, Array, int]

Voltages = Mapping[str, float] | Sequence[float] | Array
"""Five voltages in the order of `COIL_NAMES`, or the ones that are not zero by coil name."""

_COLUMNS = {"t": "s", **dict.fromkeys(COIL_NAMES, "V")}

_ROUNDING = 1e-12
"""Part of a time by which sums of times may be rounded. Chosen: a thousand sums of doubles."""

_MOST_ROWS = 2_000_000  # of a file, or of repeats within repeats; chosen: 100 MB
_MOST_REPEATS = 2**53


def volts_per_tesla(coil: Coil | None = None) -> float:
    """Voltage of one coil for a steady-state field of 1 T at the centre, V/T.

    Resistance over field per ampere, Eqs. (1)-(7); of coils without own values, or a map's +x coil.
    """
    core = Scenario(coil=coil).to_core()
    return float(core.get("coil.resistance")) / core.coils().centre_field_per_ampere[0]


def drive_waveform(scenario: Scenario) -> Waveform:
    """The voltages of any drive as a program."""
    return Waveform._of(scenario.to_core().program())


@known_arguments
class Waveform:
    """Piecewise-linear voltages of the five coils: blocks of points, each played some times.

    Waveforms are immutable. ``a + b`` plays one after the other, ``n * a`` plays `a` n times, of
    one block in the memory of one. Two waveforms are equal if they have the same blocks.

    Parameters
    ----------
    blocks : sequence of (times, voltages, repeats)
        `times`, shape (n,), s, from 0, never falling; two points at one time are a jump, and a
        third is refused. A time that falls by no more than sums of times are rounded, 1e-12 of it,
        is the one before it.
        `voltages`, shape (n, 5), V, in the order xp, xm, yp, ym, clamp.

    Raises
    ------
    ScenarioError
        If a block has fewer than two points or no duration, does not begin at 0, falls in time,
        has three different points at one time, holds a value that is not finite, or is not played
        a whole number of times above zero.

    Examples
    --------
    >>> tooth = Waveform.sawtooth(0.01, {"xp": 5.0}, {"xp": 25.0})
    >>> program = Waveform.ramp(0.05, {"xp": 5.0}) + 100 * tooth
    >>> round(program.duration, 6)
    1.05
    """

    __slots__ = ("_blocks", "_core")
    _blocks: tuple[_Block, ...]

    def __init__(self, blocks: Sequence[tuple[ArrayLike, ArrayLike, int]]) -> None:
        self._core = _core.VoltageProgram([_block(*block) for block in blocks])
        for t, v, _ in self.blocks:
            _refuse_third_points(t, v)

    @classmethod
    def _of(cls, core: _core.VoltageProgram) -> Waveform:
        """The waveform of a program of the core."""
        made = object.__new__(cls)
        made._core = core
        return made

    @classmethod
    def from_points(cls, t: ArrayLike, voltages: ArrayLike) -> Waveform:
        """One block that is played once.

        Parameters
        ----------
        t : array_like, shape (n,)
            Times, s, from 0, never falling; a repeated time is a jump.
        voltages : array_like, shape (n, 5)
            V, in the order xp, xm, yp, ym, clamp, or columns of these names.
        """
        return cls([(t, voltages, 1)])

    @classmethod
    def ramp(cls, duration: float, to: Voltages, start: Voltages = ()) -> Waveform:
        """From `start` (V; all zero by default) straight to `to` (V) within `duration` (s)."""
        check_above_zero("duration", duration, "s")
        return cls.from_points([0.0, duration], [_five(start), _five(to)])

    @classmethod
    def hold(cls, duration: float, voltages: Voltages) -> Waveform:
        """Constant voltages (V) for `duration` (s)."""
        return cls.ramp(duration, voltages, voltages)

    @classmethod
    def sawtooth(
        cls,
        period: float,
        low: Voltages,
        high: Voltages,
        edge: Literal["rise", "fall"] = "rise",
        edge_time: float = 0.0,
    ) -> Waveform:
        """One tooth between the voltages `low` and `high` (V), beginning and ending at `low`.

        Parameters
        ----------
        period : float
            s.
        low, high : voltages
            V.
        edge : {"rise", "fall"}
            Which side is sudden.
        edge_time : float
            Duration of the sudden side, s; less than `period`.
        """
        if edge not in ("rise", "fall"):
            raise ScenarioError(f'edge = {edge!r}: allowed is one of "rise", "fall"')
        check_above_zero("period", period, "s")
        if not is_number(edge_time) or not 0.0 <= edge_time < period:
            raise ScenarioError(
                f"edge_time = {edge_time!r}: allowed is from 0 to less than {highest(period)}"
            )
        bottom = _five(low)
        top_time = edge_time if edge == "rise" else period - edge_time
        return cls.from_points([0.0, top_time, period], [bottom, _five(high), bottom])

    @classmethod
    def ipp(cls, *, coil: Coil | None = None, **drive: Any) -> Waveform:
        """In-plane pulsing, section V-A: the voltages of ``Drive(mode="IPP", **drive)``.

        Parameters
        ----------
        coil : Coil, optional
            Whose resistance and geometry turn fields into voltages.
        **drive
            Fields of `Drive` but `mode` and `program`.

        Raises
        ------
        ScenarioError
            If a value is not allowed.
        """
        return cls._pulsed("IPP", coil, drive)

    @classmethod
    def opp(cls, *, coil: Coil | None = None, **drive: Any) -> Waveform:
        """Out-of-plane pulsing, section V-B: the voltages of ``Drive(mode="OPP", **drive)``.

        Parameters are those of `ipp`.
        """
        return cls._pulsed("OPP", coil, drive)

    @staticmethod
    def _pulsed(mode: Literal["IPP", "OPP"], coil: Coil | None, fields: dict[str, Any]) -> Waveform:
        for name in ("mode", "program"):
            if name in fields:
                refuse(f"drive.{name}", fields[name], f"none, as the voltages are those of {mode}")
        return drive_waveform(Scenario(drive=Drive(**fields, mode=mode), coil=coil))

    @classmethod
    def from_csv(cls, path: str | PathLike[str]) -> Waveform:
        """Read points from a CSV file with the columns t, xp, xm, yp, ym, clamp, in any order.

        Times are in s and begin at 0; a repeated time is a jump, and a third row at one time is
        refused. Voltages are in V. Headings may state other units, such as ``t (ms)``.

        Raises
        ------
        ScenarioError
            If the file cannot be read or a column or value is not as it has to be; the message
            names file, row and column.
        """
        table = read_table(path, Recipe.of(_COLUMNS, exact=True))
        times, *volts = (table.columns[name].values for name in _COLUMNS)
        voltages = np.stack(volts, axis=1)
        try:
            return cls.from_points(times, voltages)
        except ScenarioError as error:
            row = re.sub(r"^point (\d+)", lambda k: f"row {table.lines[int(k[1]) - 1]}", str(error))
            raise ScenarioError(f"{path}: {row}") from None

    def write(self, path: str | PathLike[str]) -> None:
        """Write the points with every repeat in full; `from_csv` reads the same numbers.

        Raises
        ------
        ScenarioError
            If that would be more than two million rows.
        OSError
            If the file cannot be written; an older file of that name is then untouched.
        """
        rows = sum(len(t) * repeats for t, _, repeats in self.blocks)
        if rows > _MOST_ROWS:
            raise ScenarioError(f"{rows} rows of voltages: allowed are at most {_MOST_ROWS}")
        write_rows(path, [_COLUMNS], np.column_stack(self.points()).tolist())

    def to_core(self) -> _core.VoltageProgram:
        """The core's form of it."""
        return self._core

    def to_json(self) -> str:
        """The blocks as JSON, from which `from_json` makes the same bits."""
        return json.dumps(
            [{"t": t.tolist(), "V": v.tolist(), "repeats": n} for t, v, n in self.blocks]
        )

    @classmethod
    def from_json(cls, text: str) -> Waveform:
        """The waveform of a text from `to_json`."""
        return cls([(block["t"], block["V"], block["repeats"]) for block in json.loads(text)])

    @property
    def blocks(self) -> tuple[_Block, ...]:
        """Blocks as (times (n,) in s, voltages (n, 5) in V, repeats); arrays are read-only."""
        if not hasattr(self, "_blocks"):
            self._blocks = tuple((locked(t), locked(v), n) for t, v, n in self._core.blocks)
        return self._blocks

    @property
    def duration(self) -> float:
        """Duration of all blocks with their repeats, s."""
        return self._core.duration

    def voltages(self, t: ArrayLike) -> Array:
        """Voltages at given times.

        Parameters
        ----------
        t : array_like, shape (...)
            Times within [0, duration], s. At a jump the value is the one after it.

        Returns
        -------
        numpy.ndarray, shape (..., 5)
            V.

        Raises
        ------
        ScenarioError
            If a time lies outside the waveform.
        """
        times = numbers("t", t, "finite numbers of s", unit="s")
        if not np.all((times >= 0.0) & (times <= self.duration)):
            raise ScenarioError(f"t: allowed are times from 0 to {highest(self.duration)} s")
        result = np.empty((*times.shape, len(COIL_NAMES)))
        start = 0.0
        for block_times, block_voltages, repeats in self.blocks:
            span = float(block_times[-1])
            chosen = times >= start
            # A quotient that rounds up past the last repeat still belongs to it.
            number = np.clip(np.floor((times[chosen] - start) / span), 0, repeats - 1)
            local = np.maximum(times[chosen] - (start + number * span), 0.0)
            result[chosen] = _interpolated(local, block_times, block_voltages)
            start += span * repeats
        return result

    def after(self, t: float) -> Waveform:
        """The rest of the waveform from an instant on, for a run that begins there.

        Such a run continues the whole one, except for the effects that depend on the time since
        the drive began: `effects.sample_hold`, `effects.coil_heating`, `effects.free_field_time`.

        Parameters
        ----------
        t : float
            From 0 to less than the duration, s. At a jump the rest begins with the voltages after
            it.

        Raises
        ------
        ScenarioError
            If `t` is no such number.
        """
        left = float(t) if is_number(t) else math.nan
        if not 0.0 <= left < self.duration:
            raise ScenarioError(
                f"t = {t!r}: allowed is from 0 to less than {highest(self.duration)} s"
            )
        near = _ROUNDING * left
        rest: list[tuple[ArrayLike, ArrayLike, int]] = []
        for times, voltages, repeats in self.blocks:
            played = 0
            if left > near:
                span = float(times[-1])
                played = min(int(left / span), repeats)
                into, left = left - played * span, left - repeats * span
                # Sums of times are rounded: what is meant is the point, on the side after a jump.
                nearest = float(times[np.argmin(np.abs(times - into))])
                into = nearest if abs(nearest - into) <= near else into
                if played < repeats and into > 0.0:
                    played += 1
                    if into < span:
                        later = times > into
                        now = _interpolated(np.array([into]), times, voltages)
                        points = np.r_[0.0, times[later] - into], np.vstack([now, voltages[later]])
                        rest.append((*points, 1))
            if played < repeats:
                rest.append((times, voltages, repeats - played))
        return Waveform(rest)

    def turned(self) -> Waveform:
        """The waveform rotated by 180 degrees about z: a drive to +x becomes one to -x.

        The coils of each in-plane pair change places, and their voltages change sign.
        """
        return self._of(self._core.turned())

    def repeat(self, times: int) -> Waveform:
        """The waveform played `times` times in a row; the same as ``times * waveform``.

        Raises
        ------
        ScenarioError
            If `times` is not a whole number above zero, or if repeats within repeats come to more
            than two million points.
        """
        check_whole("times", times, 1)
        blocks = list(self.blocks)
        if len(blocks) == 1:
            return Waveform([(*each[:2], each[2] * int(times)) for each in blocks])
        if sum(len(t) for t, _, _ in blocks) * times > _MOST_ROWS:
            raise ScenarioError(
                f"repeats within repeats would need more than {_MOST_ROWS} points: "
                "repeat less, or fewer different pieces"
            )
        return self._of(_core.VoltageProgram(blocks * int(times)))

    def points(self) -> tuple[Array, Array]:
        """All points with every repeat in full: times (n,) in s and voltages (n, 5) in V.

        Where a piece begins with the voltages that the one before ended with, the two points are
        one; of more than two at one time, the first and the last, which alone count, are left.
        """
        times, voltages = [], []
        start = 0.0
        for t, v, repeats in self.blocks:
            # Each repeat ends at the very number at which the next begins.
            bounds = start + float(t[-1]) * np.arange(repeats + 1)
            played = np.minimum(bounds[:-1, None] + t, bounds[1:, None])
            played[:, t == t[-1]] = bounds[1:, None]
            times.append(played.ravel())
            voltages.append(np.tile(v, (repeats, 1)))
            start = float(bounds[-1])
        t, v = np.concatenate(times), np.concatenate(voltages)
        between = np.zeros(len(t), dtype=bool)
        between[1:-1] = t[2:] == t[:-2]
        t, v = t[~between], v[~between]
        kept = _differing(t, v)
        return t[kept], v[kept]

    def __add__(self, other: Waveform) -> Waveform:
        if not isinstance(other, Waveform):
            return NotImplemented
        return self._of(_core.VoltageProgram(self._core.blocks + other._core.blocks))

    def __mul__(self, times: int) -> Waveform:
        return self.repeat(times)

    __rmul__ = __mul__

    def _key(self) -> tuple[tuple[bytes, bytes, int], ...]:
        # Adding 0 makes a negative zero a positive one, which is equal to it.
        return tuple(((t + 0.0).tobytes(), (v + 0.0).tobytes(), n) for t, v, n in self.blocks)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Waveform) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> tuple[Any, ...]:
        return Waveform, (self.blocks,)

    def __repr__(self) -> str:
        blocks = self.blocks
        count = sum(len(t) for t, _, _ in blocks)
        return f"<Waveform: {self.duration:g} s, {len(blocks)} block(s), {count} points>"


def _five(voltages: Voltages) -> list[float]:
    """Voltages of all five coils, V."""
    given: Any = voltages if hasattr(voltages, "__len__") else [voltages]
    if not len(given):
        return [0.0] * len(COIL_NAMES)
    allowed = "finite numbers of V"
    values = in_columns("voltages", given, COIL_NAMES, allowed, axes=1, absent=0.0, unit="V")
    return [float(value) for value in values]


def _block(times: ArrayLike, voltages: ArrayLike, repeats: int) -> _Block:
    check_indexes("", {"t": times, "voltages": voltages})
    t = numbers("t", times, "finite numbers of s", unit="s")
    v = in_columns("voltages", voltages, COIL_NAMES, "finite numbers of V", axes=2, unit="V")
    if t.shape != v.shape[:1]:
        raise ScenarioError(
            f"times of shape {t.shape} and voltages of shape {v.shape}: allowed are (n,) and (n, 5)"
        )
    check_whole("repeats", repeats, 1)
    if repeats > _MOST_REPEATS:
        refuse("repeats", repeats, "a whole number from 1 to 2^53")
    return t, v, int(repeats)


def _interpolated(local: Array, times: Array, voltages: Array) -> Array:
    """Voltages of one block at times within it; at a jump the value after it."""
    return np.stack([np.interp(local, times, coil) for coil in voltages.T], axis=-1)


def _refuse_third_points(t: Array, v: Array) -> None:
    # Not counting points that repeat another: only the first and the last of them would count.
    kept = np.flatnonzero(_differing(t, v))
    third = np.flatnonzero(t[kept][2:] == t[kept][:-2])
    if len(third):
        at = int(kept[third[0] + 2])
        raise ScenarioError(
            f"point {at + 1}: third point at t = {float(t[at])!r}: allowed are two, a jump; are "
            "the times rounded, or in ms?"
        )


def _differing(t: Array, v: Array) -> Mask:
    """Which points are not the one before them again."""
    again = (t[1:] == t[:-1]) & (v[1:] == v[:-1]).all(axis=1)
    return np.concatenate([[True], ~again])
