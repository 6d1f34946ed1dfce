"""One mass, or a motor and its load, with friction that sticks: the physics of all mechanics.

The coefficients are per unit of inertia, 0 where a term is absent::

    x'' = u - load - rate v - rate_asymmetry |v| - quadratic v|v| - cubic_damping v^3
          - stiffness x - square x^2 - cubic x^3 - gravity sin(x) - friction
    friction = sign(v) max(coulomb + sign(v) asymmetry, 0) + sign(v) stribeck exp(-(v / vs)^2)

`u` is the input; with `swing` it is that times cos(x). At rest friction holds what is below its
limit. With a `gap` to each side or a `spring` there are two masses: the motor's with the friction,
and the load's, a `share` of the whole, with all that depends on the place. Across the gap they meet
without rebound and pull at nothing; the spring has a moment of `spring` per angle and a `damping`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.numbers import Array
from stickslip.models.steps import Mode, State, System, stepped

_NAMES = (
    *("rate", "rate_asymmetry", "quadratic", "cubic_damping", "stiffness", "square", "cubic"),
    *("gravity", "swing", "coulomb", "asymmetry", "stribeck", "stribeck_speed", "load"),
    *("gap", "spring", "damping", "share"),
)
_CURVED = ("quadratic", "cubic_damping", "square", "cubic", "gravity", "swing", "stribeck")
_DRY = ("rate_asymmetry", "quadratic", "coulomb", "asymmetry", "stribeck")
_ROUNDING = 1e-12  # of gap and place: within it a mass that has just left has not come again


class OneMass(System):
    """One mass: position and speed, and the sign of its motion, or 0 at rest."""

    states, phases = 2, 1

    def __init__(self, c: Mapping[str, float]) -> None:
        self.eventful = self.dry = any(c[name] for name in _DRY)
        self.linear = not any(c[name] for name in _CURVED)
        self.r, self.load, self.k = c["rate"], c["load"], c["stiffness"]
        self.curves = c["cubic_damping"], c["square"], c["cubic"], c["gravity"], c["swing"]
        self.placed, self.damped = any(self.curves[1:]), self.curves[0] != 0.0
        self.stribeck, self.speed = c["stribeck"], c["stribeck_speed"]
        self.drag = c["rate_asymmetry"], c["quadratic"]
        self.dragged = any(self.drag)
        # What acts against a motion of either sign, besides what depends on the speed.
        dry = [max(c["coulomb"] + s * c["asymmetry"], 0.0) * s for s in (-1, 0, 1)]
        self.coulomb = (dry[1], dry[2], dry[0])
        falls = self.stribeck / self.speed if self.stribeck else 0.0
        turns = math.sqrt(abs(self.k) + abs(c["gravity"]))
        self.fastest = turns + falls + self.r + abs(c["rate_asymmetry"])

    def driving(self, x: float, v: float, u: float) -> float:
        """All that acts at the motor, but friction that depends on the sign of the motion."""
        if self.curves[4]:
            u *= math.cos(x)
        if self.damped:
            u -= self.curves[0] * v * v * v
        return u - self.r * v

    def loading(self, x: float) -> float:
        """What the load resists."""
        if not self.placed:
            return self.load + self.k * x
        _, square, cubic, gravity, _ = self.curves
        hangs = gravity * math.sin(x) if gravity else 0.0
        return self.load + self.k * x + (square + cubic * x) * x * x + hangs

    def friction(self, v: float, s: int) -> float:
        """What acts against a motion of the sign `s`."""
        a = self.coulomb[s]
        if self.stribeck:
            a += s * self.stribeck * math.exp(-((v / self.speed) ** 2))
        if self.dragged:
            a += s * (self.drag[0] + self.drag[1] * v) * v
        return a

    def rate(self, z: Sequence[float], u: State, mode: Mode) -> State:
        (s,) = mode
        if not s:
            return 0.0, 0.0
        x, v = z
        return v, self.driving(x, v, u[0]) - self.loading(x) - self.friction(v, s)

    def margins(self, z: State, u: State, mode: Mode) -> State:
        return (self.least(z, u, mode),)

    def least(self, z: State, u: State, mode: Mode) -> float:
        return mode[0] * z[1] if self.dry else math.inf

    def begun(self, z: State, u: State) -> tuple[State, Mode]:
        return self.driven(z, u, (_sign(z[1]) or (not self.dry),))

    def driven(self, z: State, u: State, mode: Mode) -> tuple[State, Mode]:
        if mode[0]:
            return z, mode
        return z, (self.way(self.driving(z[0], 0.0, u[0]) - self.loading(z[0])),)

    def after(self, z: State, u: State, mode: Mode, hit: int) -> tuple[State, Mode]:
        return self.driven((z[0], 0.0), u, (0,))

    def way(self, force: float) -> int:
        """The sign of the motion that begins at rest; 0 where friction holds."""
        return _sign(force) if self.held(force) < 0.0 else 0

    def held(self, force: float) -> float:
        """How much more friction would hold."""
        s = _sign(force)
        return s * self.friction(0.0, s) - abs(force)


class TwoMasses(OneMass):
    """A motor and its load: x, v, y, w, the sign of the motor's motion, and of the contact or 0."""

    states, phases = 4, 2

    def __init__(self, c: Mapping[str, float]) -> None:
        super().__init__(c)
        self.gap, self.share = c["gap"], c["share"]
        self.spring, self.damping, self.hard = c["spring"], c["damping"], not c["spring"]
        self.eventful = self.dry or self.gap > 0.0
        small = self.share * (1.0 - self.share)
        self.fastest /= math.sqrt(small)
        self.fastest += math.sqrt(self.spring / small) + self.damping / small

    def _pulls(self, z: Sequence[float], u: State, mode: Mode) -> tuple[float, float, float]:
        """What drives the motor, the moment between both, and what the load resists."""
        (x, v, y, w), (s, c) = z, mode
        pulled = self.driving(x, v, u[0]) - self.friction(v, s)
        load = self.loading(y)
        if not c:
            return pulled, 0.0, load
        if self.hard:
            return pulled, (self.share * (pulled - load) if s else 0.0) + load, load
        return pulled, self.spring * (x - y - c * self.gap) + self.damping * (v - w), load

    def rate(self, z: Sequence[float], u: State, mode: Mode) -> State:
        pulled, between, load = self._pulls(z, u, mode)
        if not mode[0]:
            return 0.0, 0.0, z[3], (between - load) / self.share
        a = (pulled - between) / (1.0 - self.share)
        return z[1], a, z[3], (between - load) / self.share

    def margins(self, z: State, u: State, mode: Mode) -> State:
        (x, v, y, _), (s, c), gap = z, mode, self.gap
        rests = meets = math.inf
        between = self._pulls(z, u, mode)[1] if c and (self.hard or not s) else 0.0
        if not s:
            rests = self.held(self.driving(x, 0.0, u[0]) - between)
        elif self.dry:
            rests = s * v
        if not c:
            meets = gap - abs(x - y) + _ROUNDING * (gap + abs(x))
        elif gap:
            meets = c * between if self.hard else c * (x - y) - gap
        return rests, meets

    def least(self, z: State, u: State, mode: Mode) -> float:
        return min(self.margins(z, u, mode))

    def begun(self, z: State, u: State) -> tuple[State, Mode]:
        """Both move as one; the gap is closed in the direction of the first input."""
        side = -1 if u[0] < 0.0 else 1
        z = (z[0], z[1], z[0] - side * self.gap, z[1])
        return self.driven(z, u, (_sign(z[1]) or (not self.dry), side))

    def driven(self, z: State, u: State, mode: Mode) -> tuple[State, Mode]:
        if min(self.margins(z, u, mode)) >= 0.0:
            return z, mode
        s, c = mode
        pulls = self.driving(z[0], 0.0, u[0])
        if not s:
            s = self.way(pulls - self._pulls(z, u, mode)[1])
        if self.hard and c * self._pulls(z, u, (s, c))[1] < 0.0:
            # A motor that its load leaves may stay behind.
            c, s = 0, s if z[1] else self.way(pulls)
        return z, (s, c)

    def after(self, z: State, u: State, mode: Mode, hit: int) -> tuple[State, Mode]:
        (x, v, y, w), (s, c) = z, mode
        if hit == 0 and s:
            v, w, s = 0.0, 0.0 if c and self.hard else w, 0
        elif hit == 0:
            s = _sign(self.driving(x, 0.0, u[0]) - self._pulls(z, u, mode)[1])
        else:
            side = c or _sign(x - y)
            y, c = x - side * self.gap, 0 if c else side
            if c and self.hard:
                v = w = (1.0 - self.share) * v + self.share * w
                s = _sign(v)
        return self.driven((x, v, y, w), u, (s, c))


def moved(c: Mapping[str, ArrayLike], start: Array, t: Array, inputs: Array) -> Array:
    """States at the times `t`, s: x and v, and y and w of the load, (readings, 4, vectors).

    Parameters
    ----------
    c : mapping of array_like, shape (vectors,) or ()
        Coefficients, see above; `gap`, `spring` and `damping` need a `share` between 0 and 1.
    start : ndarray, shape (2, vectors)
    inputs : ndarray, shape (readings, vectors)
    """
    vectors = start.shape[1]
    table = {name: np.broadcast_to(c.get(name, 0.0), vectors).tolist() for name in _NAMES}
    gaps = np.diff(t).tolist()
    result = np.empty((len(t), 4, vectors))
    for k, (x, v) in enumerate(start.T.tolist()):
        own = {name: row[k] for name, row in table.items()}
        two = own["gap"] or own["spring"]
        system = TwoMasses(own) if two else OneMass(own)
        begin = (x, v, x, v) if two else (x, v)
        made = stepped(system, begin, gaps, list(zip(inputs[:, k].tolist())))
        result[:, :, k] = made[:, [0, 1, 2, 3] if two else [0, 1, 0, 1]]
    return result


def _sign(value: float) -> int:
    return (value > 0.0) - (value < 0.0)
