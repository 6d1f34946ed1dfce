"""Steps in time of one vector of parameters, from event to event, in plain numbers.

Plain, since a diagnosis asks for a few vectors at a time: arrays of three numbers cost twenty times
as much. An input is held from one reading to the next. Where the motion is linear between events
its steps are exact, by exponentials of matrices.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from operator import mul

import numpy as np
from scipy.integrate import RK45
from scipy.linalg import lapack

from stickslip._util.numbers import Array

State = tuple[float, ...]
Mode = tuple[int, ...]

_FINE = 0.1
"""Longest step of the integrator in units of the shortest time constant. Chosen: an oscillation is
followed with an error of 3e-10 of its phase a step."""

_MOST = 16
"""Most parts of the time between two readings. Chosen: where more are needed, a log does not show
what goes on between its readings, and the readings are NaN."""

_EVENTS, _TRIES = 24, 60  # most events of a step, and of steps to one; chosen: never met
_EXACT = 1e-11  # of its value after the step: the margin at which an event is found; chosen
_SERIES = 20  # most terms of an exponential; with arguments up to a half, 14 do

# The method of Dormand and Prince of order 5, J. Comput. Appl. Math. 6 (1980) 19.
(_, (A1, *_), (B1, B2, *_), (C1, C2, C3, *_), (D1, D2, D3, D4, *_), (E1, E2, E3, E4, E5)) = (
    RK45.A.tolist()
)
W1, _, W3, W4, W5, W6 = RK45.B.tolist()


class System(ABC):
    """Motion that is smooth but for events.

    The arguments are `z`, the state; `u`, the inputs; and `mode`, its phases, each -1, 0 or 1.

    Attributes
    ----------
    states, inputs, phases : int
        Numbers of them.
    linear : bool
        Whether the derivative is linear in state and inputs while the phases last.
    fastest : float
        The largest rate of change, 1/s.
    eventful : bool
        Whether its phases may change.
    """

    states: int
    inputs: int = 1
    phases: int = 0
    linear: bool
    fastest: float
    eventful: bool = False

    @abstractmethod
    def rate(self, z: Sequence[float], u: State, mode: Mode) -> State:
        """Derivative of the state."""

    def margins(self, z: State, u: State, mode: Mode) -> State:
        """What is below zero where a phase has ended."""
        return (math.inf,)

    def least(self, z: State, u: State, mode: Mode) -> float:
        """The least margin."""
        return min(self.margins(z, u, mode))

    def begun(self, z: State, u: State) -> tuple[State, Mode]:
        """The state and its phases at the first reading."""
        return z, ()

    def driven(self, z: State, u: State, mode: Mode) -> tuple[State, Mode]:
        """The state and its phases where the input has changed."""
        return z, mode

    def after(self, z: State, u: State, mode: Mode, hit: int) -> tuple[State, Mode]:
        """The state and its phases where the margin `hit` has become zero."""
        raise NotImplementedError

    def generator(self, mode: Mode) -> Array:
        """Matrix upon state, one and inputs, whose first rows are the derivative of the state."""
        whole = self.states + 1 + self.inputs
        matrix = np.zeros((whole, whole))
        units = np.vstack([np.zeros(whole), np.eye(whole)]).tolist()
        made = [self.rate(each[: self.states], tuple(each[self.states + 1 :]), mode)
                for each in units]  # fmt: skip
        matrix[: self.states] = (np.array(made[1:]) - made[0]).T
        matrix[: self.states, self.states] = made[0]
        return matrix

    def rows(self, mode: Mode, h: float) -> list[list[float]]:
        """What takes state, one and inputs to the state after a step of `h`, s."""
        found: list[list[float]] = exponential(self.generator(mode) * h)[: self.states].tolist()
        return found


def stepped(system: System, start: State, gaps: Sequence[float], inputs: Sequence[State]) -> Array:
    """States at readings that are `gaps`, s, apart, shape (readings, states).

    Parameters
    ----------
    inputs : sequence of tuple
        At each reading.
    """
    usual = float(np.median(gaps)) if len(gaps) else 1.0
    # Clocks that differ by rounding have the same step.
    gaps = [usual if abs(gap - usual) < 1e-9 * usual else gap for gap in gaps]
    z, mode = system.begun(start, inputs[0])
    if system.linear and not system.eventful:
        return _solved(system, z, mode, gaps, inputs)
    parts = 1 if system.linear else math.ceil(max(1.0, usual * system.fastest / _FINE))
    result = np.full((len(gaps) + 1, system.states), np.nan)
    if not parts <= _MOST:
        return result
    path = _Path(system, usual / parts)
    made = [z]
    try:
        for gap, u in zip(gaps, inputs, strict=False):
            z, mode = system.driven(z, u, mode)
            for _ in range(parts):
                z, mode = path.step(z, u, mode, gap / parts)
            made.append(z)
    except (OverflowError, ValueError):  # of a state that is none
        pass
    result[: len(made)] = made
    return result


def _solved(
    system: System, z: State, mode: Mode, gaps: Sequence[float], inputs: Sequence[State]
) -> Array:
    """States without events, as one system of linear equations."""
    size, count = system.states, len(gaps)
    steps, at = np.unique(gaps, return_inverse=True)
    made = exponential(system.generator(mode) * steps[:, None, None])[at, :size]
    driven = np.concatenate([np.ones((count, 1)), np.array(inputs)[:count]], axis=1)
    right = np.concatenate([[z], np.einsum("kij,kj->ki", made[:, :, size:], driven)])
    band = np.zeros((2 * size, size * (count + 1)))
    band[0] = 1.0
    for row in range(size):
        for column in range(size):
            band[size + row - column, column : size * count : size] = -made[:, row, column]
    found, _ = lapack.dtbtrs(band, right.reshape(-1, 1), uplo="L")
    return np.asarray(found.reshape(count + 1, size))


class _Path:
    """Steps of a system, which remembers the matrices of its usual one."""

    def __init__(self, system: System, usual: float) -> None:
        self.system, self.usual = system, usual
        self.known: dict[Mode, list[list[float]]] = {}

    def advanced(self, z: State, u: State, mode: Mode, h: float) -> State:
        """The state after a step without an event."""
        system = self.system
        if h == self.usual and system.linear:
            if mode not in self.known:
                self.known[mode] = system.rows(mode, h)
            rows = self.known[mode]
        elif system.linear and h * system.fastest > _FINE:
            rows = system.rows(mode, h)
        else:
            return _runge_kutta(system, z, u, mode, h)
        whole = (*z, 1.0, *u)
        return tuple([sum(map(mul, row, whole)) for row in rows])

    def step(self, z: State, u: State, mode: Mode, h: float) -> tuple[State, Mode]:
        """The state after a step, through all events on the way."""
        system = self.system
        end = self.advanced(z, u, mode, h)
        for _ in range(_EVENTS):
            below = system.least(end, u, mode)
            if not below < 0.0:
                break
            time, met = self._event(z, u, mode, h, below)
            margins = system.margins(met, u, mode)
            z, mode = system.after(met, u, mode, margins.index(min(margins)))
            h -= time
            if h <= 0.0:
                return z, mode
            end = self.advanced(z, u, mode, h)
        return end, mode

    def _event(self, z: State, u: State, mode: Mode, h: float, below: float) -> tuple[float, State]:
        """When the first margin becomes zero, and where, by false position (Illinois)."""
        low, high, time, met = 0.0, h, 0.0, z
        above, small = self.system.least(z, u, mode), -_EXACT * below
        last = None
        for k in range(_TRIES):
            time = 0.5 * (low + high)
            # An event that has just been left has a margin of nearly zero: only halves lead away.
            if k % 3 != 2 and above > small:
                time = low + (high - low) * above / (above - below)
            met = self.advanced(z, u, mode, time)
            value = self.system.least(met, u, mode)
            if abs(value) <= small:
                break
            inside = value > 0.0
            if inside:
                low, above, below = time, value, 0.5 * below if last is inside else below
            else:
                high, below, above = time, value, 0.5 * above if last is inside else above
            last = inside
        return time, met


def _runge_kutta(system: System, z: State, u: State, mode: Mode, h: float) -> State:
    """One step of order 5."""
    rate = system.rate
    k1 = rate(z, u, mode)
    k2 = rate([y + h * A1 * a for y, a in zip(z, k1)], u, mode)  # noqa: B905
    k3 = rate([y + h * (B1 * a + B2 * b) for y, a, b in zip(z, k1, k2)], u, mode)  # noqa: B905
    k4 = rate(
        [y + h * (C1 * a + C2 * b + C3 * c) for y, a, b, c in zip(z, k1, k2, k3)],  # noqa: B905
        u, mode,
    )  # fmt: skip
    k5 = rate(
        [y + h * (D1 * a + D2 * b + D3 * c + D4 * d)
         for y, a, b, c, d in zip(z, k1, k2, k3, k4)],  # noqa: B905
        u, mode,
    )  # fmt: skip
    k6 = rate(
        [y + h * (E1 * a + E2 * b + E3 * c + E4 * d + E5 * e)
         for y, a, b, c, d, e in zip(z, k1, k2, k3, k4, k5)],  # noqa: B905
        u, mode,
    )  # fmt: skip
    return tuple(
        [y + h * (W1 * a + W3 * c + W4 * d + W5 * e + W6 * f)
         for y, a, c, d, e, f in zip(z, k1, k3, k4, k5, k6)]  # noqa: B905
    )  # fmt: skip


def exponential(matrices: Array) -> Array:
    """Exponentials of matrices, shape (..., n, n), by a series of halved ones, squared again."""
    largest = float(np.max(np.abs(matrices).sum(axis=-1), initial=1e-300))
    if not math.isfinite(largest):
        return matrices * np.nan
    halvings = max(0, math.ceil(math.log2(largest / 0.5)))
    part = matrices / 2.0**halvings
    term = part
    result = part + np.eye(matrices.shape[-1])
    for k in range(2, _SERIES):
        term = term @ part / k
        result = result + term
        if np.max(np.abs(term), initial=0.0) < 1e-18:
            break
    for _ in range(halvings):
        result = result @ result
    return result
