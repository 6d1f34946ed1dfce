"""Logs of every ready-made machine with every cause that it lists, by integrators of our own.

The integrators are those of the benchmark of causes; nothing comes from the package. A log has 300
readings whose error, a hundredth of their scatter, is not stated. What is hidden stands out by a
strength: the norm of its effect in errors, after a fit of all uncertain constants and start values.
Where such a fit undoes the effect, as that of a scale, and for a misstated constant, what is stated
of the constants counts as readings, and `Made.by` says "stated".
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from causes.make import KINDS, Array, Terms, bent, states

COUNT = 300
STEPS, FINE = 6, 40  # of the coarser of two integrations, from a reading to the next
CLOSE = 0.02  # of a strength
STEP = 1e-3  # of a constant, for its effect
SIZES = np.geomspace(1e-3, 10.0, 36)  # that are tried, in usual ones
LIMITS = np.linspace(1.0, 0.1, 36)
FALLING = "saturation", "duty_limit"
SIGNED = ("asymmetry", "viscous_asymmetry", "load", "gravity", "zero", "scale", "gain_asymmetry",
          "stiffness", "quadratic_stiffness", "cubic_stiffness", "power_error",
          "mass_error")  # fmt: skip
PARAMETERS = {"zero": "shift", "scale": "error", "late": "time", "slow": "time"}
FAR = 1e9  # of a machine that flies away
TRUSTED = 0.015  # error of all that is stated where it has to tell
SHAPES = {"stribeck": "stribeck_speed", "heater_capacity": "coupling",
          "wall_capacity": "wall_coupling"}  # fmt: skip
CONDITIONS = "rounded", "correlated", "missing"
ABSORBED = "scale", "power_error"
SCALES = -0.5, -0.38, -0.3, 0.3, 0.6, 1.2
ALONE = "AR 0.5", "AR 0.8", "mean of three"


class Machine(NamedTuple):
    """A machine that is logged: what is read, what drives it, and usual sizes of what is hidden."""

    kind: str
    reads: str
    unit: str
    state: int
    input: str
    peak: float
    rows: tuple[int, int]  # between two switches of the input
    causes: dict[str, float]
    more: dict[str, float] = {}  # noqa: RUF012
    known: dict[str, float] = {}  # noqa: RUF012
    error: float = 0.02  # of the readings' scatter
    start: float = 0.0
    stiff: int = 1  # times the usual steps

    @property
    def step(self) -> float:
        return float(KINDS[self.kind]["step"])

    @property
    def constants(self) -> dict[str, tuple[float, float]]:
        return {name: (value, part * value)
                for name, (value, part) in KINDS[self.kind]["constants"].items()}  # fmt: skip


SERVO = {"inertia": 0.04, "resistance": 3.0, "supply": 12.0, "gravity": 0.9, "duty_limit": 1.0}
MACHINES = {
    "joint": Machine(
        "joint", "speed", "rad/s", 1, "torque", 0.12, (8, 30),
        {"viscous": 0.02, "coulomb": 0.01, "viscous_asymmetry": 0.003, "asymmetry": 0.01,
         "stribeck": 0.02, "quadratic": 0.001, "load": 0.01, "backlash": 0.1, "compliance": 0.2,
         "gravity": 0.02, "zero": 0.1, "scale": 0.045, "late torque": 0.01, "slow torque": 0.02,
         "slow sensor": 0.02},
        {"stribeck_speed": 0.3}, error=0.06,
    ),
    "joint by its angle": Machine(
        "joint", "angle", "rad", 0, "torque", 0.12, (8, 30),
        {"viscous": 0.02, "coulomb": 0.01, "load": 0.01, "backlash": 0.1, "zero": 0.1,
         "scale": 0.045, "late torque": 0.01, "slow sensor": 0.02},
        {}, {"gravity": 0.15},
    ),
    "axis": Machine(
        "axis", "position", "m", 0, "command", 2.0, (10, 40),
        {"viscous": 1.5, "coulomb": 0.1, "viscous_asymmetry": 0.1, "asymmetry": 0.1,
         "stribeck": 0.3, "quadratic": 0.3, "load": 0.1, "backlash": 0.02, "compliance": 3e-3,
         "gain_asymmetry": 0.05, "dead_zone": 0.1, "saturation": 2.0, "scale": 0.045,
         "late command": 0.02, "slow motor": 0.02, "slow sensor": 0.02},
        {"stribeck_speed": 0.1}, error=0.005,
    ),
    "pendulum": Machine(
        "pendulum", "angle", "rad", 0, "", 0.0, (1, 2),
        {"viscous": 0.08, "coulomb": 0.02, "quadratic": 0.02, "stiffness": 0.5, "zero": 0.02,
         "scale": 0.045, "slow sensor": 0.02},
        start=0.9,
    ),
    "pendulum with a moved pivot": Machine(
        "pendulum", "angle", "rad", 0, "pivot", 3.0, (10, 40),
        {"coulomb": 0.05, "quadratic": 0.05, "stiffness": 0.5, "zero": 0.02, "scale": 0.045,
         "late pivot": 0.02, "slow sensor": 0.02},
    ),
    "oscillator": Machine(
        "oscillator", "displacement", "m", 0, "force", 4.0, (10, 40),
        {"viscous": 0.5, "coulomb": 0.1, "quadratic": 0.3, "cubic_damping": 0.3,
         "quadratic_stiffness": 20.0, "cubic_stiffness": 100.0, "zero": 0.01, "scale": 0.045,
         "late force": 0.01, "slow sensor": 0.01},
        {}, {"mass": 1.0},
    ),
    "heater": Machine(
        "thermal", "temperature", "K", 0, "power", 60.0, (12, 36),
        {"loss_growth": 5e-3, "heater_capacity": 5.0, "wall_capacity": 10.0, "power_error": 0.05,
         "zero": 0.3, "late power": 5.0, "slow thermometer": 5.0},
        {"coupling": 2.0, "wall_coupling": 2.0}, {"ambient": 293.0}, start=293.0, stiff=4,
    ),
    "servo": Machine(
        "servo", "position", "rad", 0, "goal", 0.4, (15, 40),
        {"viscous": 0.05, "coulomb": 0.05, "gravity": 0.5, "mass_error": 0.1, "armature": 2e-3,
         "load_friction": 0.05, "stribeck": 0.05, "backlash": 0.02, "duty_limit": 1.0,
         "zero": 0.01, "scale": 0.045, "late goal": 0.01, "slow goal": 0.01, "slow sensor": 0.01},
        {"stribeck_speed": 0.1}, {**SERVO, "gain": 1.2}, 0.01,
    ),
    "servo by its duty": Machine(
        "servo", "position", "rad", 0, "duty", 0.15, (15, 40),
        {"mass_error": 0.1, "armature": 2e-3, "load_friction": 0.05, "stribeck": 0.05,
         "backlash": 0.02, "zero": 0.01, "scale": 0.045, "late duty": 0.01, "slow sensor": 0.01},
        {"stribeck_speed": 0.1}, SERVO, 0.01,
    ),
}  # fmt: skip


class Key(NamedTuple):
    """What a problem is; with a `size` that is that of the cause, whatever its strength."""

    seed: int
    machine: str
    cause: str
    strength: float
    condition: str
    size: float = 0.0


class Made(NamedTuple):
    """A problem, and its truth: all of it in SI.

    Attributes
    ----------
    name, kind, reads, t, inputs, y, unit, stated, known, without
        The log, and what is stated with it; `stated` has values with their standard deviations.
    truth : str
        The cause, "" for none, "unlisted" for one that is in no list.
    by : str
        What tells it: "readings", or what is "stated" of the constants besides.
    size : dict
        Its parameters, as the package calls them.
    constants : dict
        What is true of all constants and start states.
    plain : ndarray
        Readings without errors.
    """

    name: str
    kind: str
    reads: str
    t: Array
    inputs: dict[str, Array]
    y: Array
    unit: str
    stated: dict[str, tuple[float, float]]
    known: dict[str, float]
    without: tuple[str, ...]
    truth: str
    by: str
    size: dict[str, float]
    strength: float
    condition: str
    seed: int
    constants: dict[str, float]
    sd: float
    plain: Array


Hidden = Callable[[float, Terms], Any]
"""Of a step of the integration and constants: a force more, see `states`."""


def lagged(begins: Array, ends: Array, time: Array, h: float, value: Array) -> Array:
    """Values behind a lag of lines, one for each step: (1 + steps, copies)."""
    kept, found = np.exp(-h / np.maximum(time, 1e-12)), [value]
    for begin, end in zip(begins, ends, strict=True):
        behind = time / h * (end - begin)
        value = end - behind + kept * (value - begin + behind)
        found.append(value)
    return np.array(found)


def readings(
    of: Machine, c: Terms, knots: Array, u: Array, hidden: Hidden | None = None,
    steps: int = STEPS, rough: bool = False,
) -> Array:  # fmt: skip
    """Readings of copies of a machine, (readings, copies), of second order if not rough."""
    seen = _followed(of, c, knots, u, hidden, steps)
    if not rough:
        seen = 2.0 * _followed(of, c, knots, u, hidden, 2 * steps) - seen
    return np.asarray(seen * (1.0 + c.get("scale", 0.0)) + c.get("zero", 0.0))


def _followed(
    of: Machine, c: Terms, knots: Array, u: Array, hidden: Hidden | None, steps: int
) -> Array:
    h, count = of.step / steps, len(c["start"])
    ends = h * np.arange((COUNT - 1) * steps + 1)
    # The mean of a held input over each step is right where it switches within the step.
    acts = bent(c, u[:, None]) + np.zeros(count)
    whole = np.vstack([np.zeros(count), np.cumsum(np.diff(knots)[:, None] * acts[:-1], axis=0)])
    late = c.get(f"late {of.input}", 0.0) + np.zeros(count)
    passed = [np.interp(ends - late[k], knots, whole[:, k]) for k in range(count)]
    held = np.diff(passed, axis=1).T / h
    if of.kind == "pendulum":
        held = -held / c["length"]
    slow = "slow motor" if of.kind == "axis" else f"slow {of.input}"
    if slow in c:
        behind = lagged(held, held, c[slow], h, np.zeros(count))
        held = held - c[slow] / h * np.diff(behind, axis=0)
    if count == 1:  # numbers are faster than arrays of one
        c, held = {name: float(value[0]) for name, value in c.items()}, held[:, 0]
    seen = states(of.kind, c, held, h, hidden and hidden(h, c))[:, of.state].reshape(-1, count)
    for slow in {"slow sensor", "slow thermometer"} & c.keys():
        seen = lagged(seen[:-1], seen[1:], np.atleast_1d(c[slow]), h, seen[0])
    return seen[::steps]


def excited(of: Machine, draw: np.random.Generator, off_grid: bool) -> tuple[Array, Array]:
    """Times from which an input has its values, whose signs and sizes differ; at first it is 0."""
    rows = 5 + np.cumsum(np.r_[0, draw.integers(*of.rows, COUNT)])
    rows = rows[rows < COUNT - 5] if of.input else rows[:0]
    sizes = of.peak * draw.permutation(np.linspace(0.3, 1.0, max(len(rows), 1)))[: len(rows)]
    signs = np.where(draw.random(len(rows)) < 0.8, (-1.0) ** np.arange(len(rows)), 1.0)
    u = sizes * (draw.choice([-1.0, 1.0]) * signs if of.kind != "thermal" else 1.0)
    late = draw.uniform(0.1, 0.9, len(rows)) if off_grid else 0.0
    return of.step * np.r_[-COUNT, rows - late, 2 * COUNT], np.r_[0.0, u, 0.0]


def stands_out(effects: Array, moves: Array, stated: Array) -> Array:
    """Norms of effects after a fit of moves, of which `stated` ones count as readings: all in
    standard deviations."""
    moves = np.vstack([moves, np.diag(stated)])
    effects = np.vstack([effects, np.zeros((len(stated), effects.shape[1]))])
    left = effects - moves @ np.linalg.lstsq(moves, effects, rcond=None)[0]
    return np.asarray(np.linalg.norm(left, axis=0))


class Hiding(NamedTuple):
    """A machine with true and uncertain constants, and a cause that may have some `sizes`."""

    of: Machine
    true: dict[str, float]
    stated: dict[str, tuple[float, float]]
    knots: Array
    u: Array
    kept: Array
    cause: str
    sizes: list[Array]
    hidden: Hidden | None = None

    def seen(self, changes: list[dict[str, float]], steps: int, rough: bool = False) -> Array:
        """Readings of the machine with some changes."""
        names = {*self.true, *itertools.chain(*changes)}
        absent = 1e300 if self.cause in FALLING else 0.0
        c = {name: np.array([each.get(name, self.true.get(name, absent)) for each in changes])
             for name in names}  # fmt: skip
        with np.errstate(all="ignore"):
            return readings(self.of, c, self.knots, self.u, self.hidden, steps, rough)

    def strengths(self, sizes: Array, rough: bool) -> dict[str, Array]:
        """Strengths of a cause of some sizes, by what tells them."""
        errors = {name: sd for name, (_, sd) in self.stated.items()}
        errors |= {"start": abs(self.of.start) or 1.0, "start_speed": 1.0}
        moved = [{name: self.true[name] + way * STEP * sd}
                 for name, sd in errors.items() for way in (1.0, -1.0)]  # fmt: skip
        seen = self.seen([{}, *moved, *({self.cause: size} for size in sizes)],
                         STEPS * self.of.stiff, rough)  # fmt: skip
        seen = np.clip(np.nan_to_num(seen, nan=FAR), -FAR, FAR)
        kept = seen[self.kept] / (self.of.error * float(np.std(seen[:, 0])))
        moves, effects = kept[:, 1 : 1 + len(moved)], kept[:, 1 + len(moved) :] - kept[:, :1]
        moves = (moves[:, ::2] - moves[:, 1::2]) / (2.0 * STEP)
        stated = np.r_[np.ones(len(self.stated)), 0.0, 0.0]
        return {by: stands_out(effects, moves, stated * (by == "stated"))
                for by in ("readings", "stated")}

    def found(self, strength: float, rules: tuple[str, ...]) -> tuple[float, float, str]:
        """The size of a strength, its strength, and what tells it."""
        rough = self.strengths(np.concatenate(self.sizes), rough=True)
        begins = np.cumsum([0, *map(len, self.sizes)])
        for by, (begin, sizes) in itertools.product(rules, zip(begins, self.sizes)):
            known = rough[by][begin : begin + len(sizes)]
            at = np.flatnonzero((known[:-1] < strength) & (known[1:] >= strength))
            if not len(at):
                continue
            for apart in (0, 2, -2):  # what is rough may be two sizes off
                near = np.clip(at[0] + apart + np.array([-1, 2]), 0, len(sizes) - 1)
                near = np.linspace(*sizes[near], 60)
                fine = self.strengths(near, rough=False)[by]
                best = int(np.argmin(abs(fine - strength)))
                if abs(fine[best] - strength) < CLOSE * strength:
                    return float(near[best]), float(fine[best]), by
        raise ValueError(f"{self.of.kind}: no {self.cause} of a strength of {strength:g}")


def errors(condition: str, draw: np.random.Generator) -> Array:
    """Errors of readings of one standard deviation."""
    found = draw.standard_normal(COUNT + 2)
    if condition == "mean of three":
        return np.convolve(found, np.ones(3), "valid") / np.sqrt(3.0)
    alike = 0.8 if condition == "AR 0.8" else 0.5
    if condition in ("correlated", "all three", "AR 0.5", "AR 0.8"):
        for k in range(1, COUNT):
            found[k] = alike * found[k - 1] + np.sqrt(1.0 - alike**2) * found[k]
    return found[:COUNT]


def made(key: Key) -> Made:
    """The problem of a key."""
    of, cause = MACHINES[key.machine], key.cause.removeprefix("misstated ")
    draw = np.random.default_rng([key.seed, zlib.crc32(repr(key[1:]).encode())])
    misstated, stated = cause != key.cause, of.constants
    if misstated or cause in ABSORBED:
        stated = {name: (value, TRUSTED * value) for name, (value, _) in stated.items()}
    true = {name: value + sd * float(np.clip(draw.standard_normal(), -2.0, 2.0))
            for name, (value, sd) in stated.items()}  # fmt: skip
    sign, usual = draw.choice([-1.0, 1.0]), of.causes.get(cause, 0.0)
    if misstated:
        true[cause] = value = stated[cause][0]
        usual = 0.3 * value
    known = {name: value for name, value in of.known.items() if name != cause}
    if not misstated:
        for each in (stated, true):
            each.pop(cause, None)
    sizes = usual * (LIMITS if cause in FALLING else SIZES)
    ways = (sign, -sign) if cause in SIGNED or misstated else (1.0,)
    tried = [way * sizes for way in ways]
    if misstated:
        tried = [each[each > 0.1 * value] for each in (value + side for side in tried)]
    return hide(key, of, {**of.more, **known, **true}, stated, known, cause, tried, draw,
                ("stated",) if misstated else ("readings", "stated"))  # fmt: skip


def hide(
    key: Key, of: Machine, true: dict[str, float], stated: dict[str, tuple[float, float]],
    known: dict[str, float], cause: str, sizes: list[Array], draw: np.random.Generator,
    rules: tuple[str, ...], hidden: Hidden | None = None,
) -> Made:  # fmt: skip
    """A log in which a cause has the strength of a key."""
    true = {**true, "start": of.start, "start_speed": 0.0}
    knots, u = excited(of, draw, key.condition == "off the grid")
    lost = draw.random(COUNT) < 0.1 * (key.condition in ("missing", "all three"))
    kept = np.flatnonzero(~lost | (np.arange(COUNT) == 0))
    hiding = Hiding(of, true, stated, knots, u, kept, cause, sizes, hidden)
    size, strength, by = key.size, 0.0, rules[0]
    if key.size:
        strength = float(hiding.strengths(np.array([size]), rough=False)[by][0])
    elif cause:
        size, strength, by = hiding.found(key.strength, rules)
    plain = hiding.seen([{cause: size} if cause else {}], FINE)[:, 0]
    sd = of.error * float(np.std(hiding.seen([{}], STEPS * of.stiff)))
    y = plain + sd * errors(key.condition, draw)
    if key.condition in ("rounded", "all three"):
        step = sd * draw.uniform(0.8, 1.25)
        y = step * np.round(y / step)
    t = of.step * np.arange(COUNT)
    inputs = {of.input: u[np.searchsorted(knots, t, side="right") - 1][kept]} if of.input else {}
    word = PARAMETERS.get(cause.partition(" ")[0])
    told = {f"{cause}.{word}" if word else cause: size} if cause else {}
    told |= {SHAPES[cause]: of.more[SHAPES[cause]]} if cause in SHAPES else {}
    name = f"{key.machine}, {key.cause or 'nothing'}, {key.strength:g}, {key.condition}"
    return Made(
        name, of.kind, of.reads, t[kept], inputs, y[kept], of.unit, stated, known, (), cause, by,
        told, strength, key.condition, key.seed, {**true, **told}, sd, plain[kept],
    )  # fmt: skip


def problems(first_seed: int) -> list[Key]:
    """All problems: each cause by itself, nothing hidden, errors alike, and far scales."""
    every = [(name, cause) for name, of in MACHINES.items()
             for cause in ("", *of.causes, *(f"misstated {each}" for each in of.constants))]
    asked: list[tuple[str, str, float, str, float]] = []
    for strength, condition in ((8.0, "clean"), (25.0, "clean"), (25.0, "off the grid"),
                                (0.0, "all three"), (0.0, "one")):
        for k, (name, cause) in enumerate(every):
            if condition == "off the grid" and not MACHINES[name].input:
                continue
            which = CONDITIONS[k % 3] if condition == "one" else condition
            asked.append((name, cause, strength or (8.0, 25.0)[k // 3 % 2], which, 0.0))
    asked += [(name, "", 0.0, condition, 0.0) for condition in ALONE for name in [*MACHINES][:8]]
    asked += [(name, "scale", 0.0, "clean", size) for size in SCALES
              for name in ("joint", "joint by its angle", "axis")]
    return [Key(first_seed + k, *each) for k, each in enumerate(asked)]
