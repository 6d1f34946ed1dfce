"""Logs of every ready-made machine with every cause that it lists, by integrators of our own.

The integrators are those of the benchmark of causes; nothing comes from the package. A log has 300
readings whose error, 0.5 to 6 % of their scatter by the machine, is not stated. What is hidden
stands out by a strength S: the norm of its effect in independent errors of the plain log, after a
fit of all uncertain constants and start values.
Where such a fit undoes the effect, as that of a scale, and for a misstated constant, what is stated
of the constants counts as readings, and `Made.by` says "stated".
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from causes.make import KINDS, PARAMETERS, Array, Terms, bent, correlated, states

COUNT = 300
FINE = 60  # steps from a reading to the next, of the coarser of two integrations
SIZES = np.geomspace(1e-3, 10.0, 36)  # that are tried, in usual ones
LIMITS = np.linspace(1.0, 0.1, 36)  # of what falls
CLOSE, TRIES = 0.02, 5  # to a strength; of draws
TRUSTED = 0.015  # part that is stated as error of a constant where it has to tell
FALLING, ABSORBED = ("saturation", "duty_limit"), ("scale", "power_error")
SHAPES = {"stribeck": {"stribeck_speed": 0.1}, "heater_capacity": {"coupling": 2.0},
          "wall_capacity": {"wall_coupling": 2.0}}  # fmt: skip
ALIKE = {"correlated": 0.5, "all three": 0.5, "AR 0.5": 0.5, "AR 0.8": 0.8}
SOFT = "joint", "compliance"  # weaker, it is too fast for four readings a period: rigid
SERVO = {"inertia": 0.04, "resistance": 3.0, "supply": 12.0, "gravity": 0.9, "duty_limit": 1.0}


class Machine(NamedTuple):
    """A machine that is logged, what drives it, and usual sizes of all that may be hidden."""

    kind: str
    reads: str
    input: str
    peak: float
    rows: tuple[int, int]  # between two switches of the input
    error: float  # of the readings' scatter
    known: dict[str, float]
    causes: dict[str, float]  # below 0 of what may have either sign

    @property
    def begin(self) -> str:
        return "start_temperature" if self.kind == "thermal" else "start_position"

    @property
    def start(self) -> float:
        return {"thermal": 293.0, "pendulum": 0.0 if self.input else 0.9}.get(self.kind, 0.0)

    @property
    def steps(self) -> int:
        return {"thermal": 24, "servo": 12, "pendulum": 12}.get(self.kind, 6)

    @property
    def part(self) -> float:
        """Of its usual error by which a constant is moved; dry friction bends what is less."""
        return 0.3 if self.kind == "servo" else 0.01

    @property
    def step(self) -> float:
        return float(KINDS[self.kind]["step"])

    @property
    def constants(self) -> dict[str, tuple[float, float]]:
        of = KINDS[self.kind]["constants"].items()
        return {name: (value, part * value) for name, (value, part) in of}


MACHINES = {
    "joint": Machine(
        "joint", "speed (rad/s)", "torque", 0.12, (8, 30), 0.06, {},
        {"viscous": 0.02, "coulomb": 0.01, "viscous_asymmetry": -0.003, "asymmetry": -0.01,
         "stribeck": 0.03, "quadratic": 0.001, "load": -0.01, "backlash": 0.1, "compliance": 0.2,
         "gravity": -0.02, "zero": -0.1, "scale": -0.045, "late torque": 0.01, "slow torque": 0.02,
         "slow sensor": 0.02}),
    "joint by its angle": Machine(
        "joint", "angle (rad)", "torque", 0.12, (8, 30), 0.02, {"gravity": 0.15},
        {"viscous": 0.02, "coulomb": 0.01, "load": -0.01, "backlash": 0.1, "zero": -0.1,
         "scale": -0.045, "late torque": 0.01, "slow sensor": 0.02}),
    "axis": Machine(
        "axis", "position (m)", "command", 2.0, (10, 40), 0.005, {},
        {"viscous": 1.5, "coulomb": 0.1, "viscous_asymmetry": -0.1, "asymmetry": -0.1,
         "stribeck": 0.3, "quadratic": 0.3, "load": -0.1, "backlash": 0.02, "compliance": 3e-3,
         "gain_asymmetry": -0.05, "dead_zone": 0.1, "saturation": 2.0, "scale": -0.045,
         "late command": 0.02, "slow motor": 0.02, "slow sensor": 0.02}),
    "pendulum": Machine(
        "pendulum", "angle (rad)", "", 0.0, (1, 2), 0.02, {},
        {"viscous": 0.08, "coulomb": 0.02, "quadratic": 0.02, "stiffness": -0.5, "zero": -0.02,
         "scale": -0.045, "slow sensor": 0.02}),
    "pendulum with a moved pivot": Machine(
        "pendulum", "angle (rad)", "pivot", 1.5, (10, 40), 0.02, {},
        {"coulomb": 0.05, "quadratic": 0.05, "stiffness": -0.5, "zero": -0.02, "scale": -0.045,
         "late pivot": 0.02, "slow sensor": 0.02}),
    "oscillator": Machine(
        "oscillator", "displacement (m)", "force", 4.0, (10, 40), 0.02, {"mass": 1.0},
        {"viscous": 0.5, "coulomb": 0.1, "quadratic": 0.3, "cubic_damping": 0.3,
         "quadratic_stiffness": -20.0, "cubic_stiffness": -100.0, "zero": -0.01, "scale": -0.045,
         "late force": 0.01, "slow sensor": 0.01}),
    "heater": Machine(
        "thermal", "temperature (K)", "power", 60.0, (12, 36), 0.02, {"ambient": 293.0},
        {"loss_growth": 5e-3, "heater_capacity": 5.0, "wall_capacity": 10.0, "power_error": -0.05,
         "zero": -0.3, "late power": 5.0, "slow thermometer": 5.0}),
    "servo": Machine(
        "servo", "position (rad)", "goal", 0.4, (15, 40), 0.01, {**SERVO, "gain": 1.2},
        {"viscous": 0.05, "coulomb": 0.05, "gravity": -0.5, "mass_error": -0.1, "armature": 2e-3,
         "load_friction": 0.05, "stribeck": 0.05, "backlash": 0.02, "duty_limit": 1.0,
         "zero": -0.01, "scale": -0.045, "late goal": 0.01, "slow goal": 0.01,
         "slow sensor": 0.01}),
    "servo by its duty": Machine(
        "servo", "position (rad)", "duty", 0.15, (15, 40), 0.01, SERVO,
        {"mass_error": -0.1, "armature": 2e-3, "load_friction": 0.05, "stribeck": 0.05,
         "backlash": 0.02, "zero": -0.01, "scale": -0.045, "late duty": 0.01, "slow sensor": 0.01}),
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
    """A log, what is stated with it, and the truth: all of it in SI.

    `truth` is the cause, "" for none, "unlisted" for one that is in no list; `by` is what tells it,
    "readings", or what is "stated" of the constants besides; `size` has its parameters as the
    package calls them, `constants` the true ones and the start, `plain` readings without errors,
    which have the standard deviation `sd`.
    """

    name: str
    kind: str
    reads: str
    unit: str
    t: Array
    inputs: dict[str, Array]
    y: Array
    stated: dict[str, tuple[float, float]]
    known: dict[str, float]
    without: tuple[str, ...]
    truth: str
    by: str
    size: dict[str, float]
    constants: dict[str, float]
    strength: float
    condition: str
    seed: int
    sd: float
    plain: Array


Hidden = Callable[[float, Terms], Any]
"""Of a step of the integration and constants: one more force, see `states`."""


def lagged(begins: Array, ends: Array, time: Array, h: float, value: Array) -> Array:
    """Values behind a lag of lines, one for each step: (1 + steps, copies)."""
    kept, behind = np.exp(-h / np.maximum(time, 1e-12)), time / h * (ends - begins)
    found = [value]
    for rest in ends - behind + kept * (behind - begins):
        value = rest + kept * value
        found.append(value)
    return np.array(found)


def excited(of: Machine, draw: np.random.Generator, off_grid: bool) -> tuple[Array, Array]:
    """Times from which an input has its values, whose signs and sizes differ; at first it is 0."""
    rows = 5 + np.cumsum(np.r_[0, draw.integers(*of.rows, COUNT)])
    rows = rows[rows < COUNT - 5] if of.input else rows[:0]
    sizes = of.peak * draw.permutation(np.linspace(0.3, 1.0, max(len(rows), 1)))[: len(rows)]
    signs = np.where(draw.random(len(rows)) < 0.8, (-1.0) ** np.arange(len(rows)), 1.0)
    u = sizes * (draw.choice([-1.0, 1.0]) * signs if of.kind != "thermal" else 1.0)
    late = draw.uniform(0.1, 0.9, len(rows)) if off_grid else 0.0
    return of.step * np.r_[-COUNT, rows - late, 2 * COUNT], np.r_[0.0, u, 0.0]


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
        """Readings with some changes each, (readings, changes); of second order if not rough."""
        names = {*self.true, self.cause, *itertools.chain(*changes)} - {""}
        absent = 1e300 if self.cause in FALLING else 0.0
        c = {name: np.array([each.get(name, self.true.get(name, absent)) for each in changes])
             for name in names}  # fmt: skip
        with np.errstate(all="ignore"):
            found = self._followed(c, steps)
            found = found if rough else 2.0 * self._followed(c, 2 * steps) - found
        return np.asarray(found * (1.0 + c.get("scale", 0.0)) + c.get("zero", 0.0))

    def _followed(self, c: Terms, steps: int) -> Array:
        of, h, count = self.of, self.of.step / steps, len(c["start"])
        ends = h * np.arange((COUNT - 1) * steps + 1)
        # The mean of a held input over each step is right where it switches within the step.
        acts = bent(c, self.u[:, None]) + np.zeros(count)
        whole = np.cumsum(np.diff(self.knots)[:, None] * acts[:-1], axis=0)
        whole = np.vstack([np.zeros(count), whole])
        late = c.get(f"late {of.input}", 0.0) + np.zeros(count)
        passed = [np.interp(ends - late[k], self.knots, whole[:, k]) for k in range(count)]
        held = np.diff(passed, axis=1).T / h
        if of.kind == "pendulum":
            held = -held / c["length"]
        slow = "slow motor" if of.kind == "axis" else f"slow {of.input}"
        if slow in c:
            behind = lagged(held, held, c[slow], h, np.zeros(count))
            held = held - c[slow] / h * np.diff(behind, axis=0)
        sensor = c.get("slow sensor", c.get("slow thermometer"))
        if count == 1:  # numbers are faster than arrays of one
            c, held = {name: float(value[0]) for name, value in c.items()}, held[:, 0]
        found = states(of.kind, c, held, h, self.hidden and self.hidden(h, c))
        found = found[:, int("speed" in of.reads)].reshape(-1, count)
        if sensor is not None:
            found = lagged(found[:-1], found[1:], sensor, h, found[0])
        return found[::steps]

    def error(self) -> float:
        """Standard deviation of a reading."""
        return self.of.error * float(np.std(self.seen([{}], self.of.steps)))

    def strengths(self, sizes: Array, rough: bool = False) -> dict[str, Array]:
        """Strengths of the cause with some sizes, by what tells them."""
        # Start values move readings by some errors, at once or in ten rows.
        sd, ten = self.error(), 10.0 * self.of.step
        place = 3.0 * sd * (ten if "speed" in self.of.reads else 1.0)
        parts = {name: self.of.part * self.of.constants[name][1] for name in self.stated}
        parts |= {"start": place, "start_speed": place / ten}
        moved = [{name: self.true[name] + way * part}
                 for name, part in parts.items() for way in (1.0, -1.0)]  # fmt: skip
        seen = self.seen([{}, *moved, *({self.cause: size} for size in sizes)],
                         self.of.steps, rough)  # fmt: skip
        seen = np.clip(np.nan_to_num(seen[self.kept], nan=1e9), -1e9, 1e9) / sd
        moves, effects = seen[:, 1 : 1 + len(moved)], seen[:, 1 + len(moved) :] - seen[:, :1]
        errors = [*(sd for _, sd in self.stated.values()), 1.0, 1.0]
        moves = (moves[:, ::2] - moves[:, 1::2]) * 0.5 * errors / [*parts.values()]
        if self.cause in self.stated:  # which a fit undoes, however large it is
            off = (sizes - self.true[self.cause]) / self.stated[self.cause][1]
            effects = np.outer(moves[:, [*self.stated].index(self.cause)], off)
        stated = np.diag(np.r_[np.ones(len(self.stated)), 0.0, 0.0])
        effects, found = np.vstack([effects, np.zeros((len(errors), len(sizes)))]), {}
        for by, part in (("readings", 0.0), ("stated", 1.0)):
            rows = np.vstack([moves, part * stated])
            left = effects - rows @ (np.linalg.pinv(rows, rcond=1e-12) @ effects)
            found[by] = np.linalg.norm(left, axis=0)
        return found

    def found(self, strength: float, rules: tuple[str, ...]) -> tuple[float, float, str]:
        """The size of a strength, its strength, and what tells it."""
        rough = self.strengths(np.concatenate(self.sizes), rough=True)
        begins = np.cumsum([0, *map(len, self.sizes)])
        for by, (begin, sizes) in itertools.product(rules, zip(begins, self.sizes, strict=False)):
            known = rough[by][begin : begin + len(sizes)]
            at = np.flatnonzero((known[:-1] < strength) & (known[1:] >= strength))[:1]
            if not len(at):
                continue
            near = np.linspace(sizes[max(at[0] - 1, 0)], sizes[min(at[0] + 2, len(sizes) - 1)], 40)
            for _ in range(4):  # rough strengths may be off; a strength may rise steeply
                fine = self.strengths(near)[by]
                best = int(np.argmin(abs(fine - strength)))
                if abs(fine[best] - strength) < CLOSE * strength:
                    return float(near[best]), float(fine[best]), by
                wide = (1 if fine.min() < strength < fine.max() else 20) * (near[1] - near[0])
                near = np.linspace(near[best] - wide, near[best] + wide, 40)
                near = np.abs(near) * np.sign(sizes[0])
        raise ValueError(f"{self.of.kind}: no {self.cause} of a strength of {strength:g}")


def errors(condition: str, draw: np.random.Generator) -> Array:
    """Errors of readings of one standard deviation."""
    found, alike = draw.standard_normal(COUNT + 2), ALIKE.get(condition, 0.0)
    if condition == "mean of three":
        return np.convolve(found, np.ones(3), "valid") / np.sqrt(3.0)
    return correlated(found, alike)[:COUNT]


def made(key: Key) -> Made:
    """The problem of a key."""
    return hide(key, key.cause, MACHINES[key.machine].causes.get(key.cause, 0.0))


def hide(
    key: Key, cause: str, usual: float,
    acts: Callable[[Machine, np.random.Generator], Hidden] | None = None,
) -> Made:  # fmt: skip
    """A log in which a cause, as it stands in the integrators' constants, has a key's strength."""
    for attempt in range(TRIES):
        draw = np.random.default_rng([key.seed, attempt, zlib.crc32(repr(key[1:]).encode())])
        with suppress(ValueError):
            return _drawn(key, cause, usual, draw, acts and acts(MACHINES[key.machine], draw))
    raise ValueError(f"{key}: no draw has that strength")


def _drawn(
    key: Key, cause: str, usual: float, draw: np.random.Generator, hidden: Hidden | None
) -> Made:
    of, name = MACHINES[key.machine], cause.removeprefix("misstated ")
    misstated, stated, known = cause != name, of.constants, {**of.known}
    if misstated or name in ABSORBED:
        stated = {each: (value, TRUSTED * value) for each, (value, _) in stated.items()}
    true = {each: value + sd * float(np.clip(draw.standard_normal(), -2.0, 2.0))
            for each, (value, sd) in stated.items()}  # fmt: skip
    sizes = abs(usual) * (LIMITS if name in FALLING else SIZES)
    ways = draw.permutation([-1.0, 1.0]) if usual < 0.0 or misstated else [1.0]
    tried, rules = [way * sizes for way in ways], ("readings", "stated")
    if misstated:
        true[name] = value = stated[name][0]
        tried, rules = [value * (1.0 + way * SIZES[SIZES < 0.9]) for way in ways], rules[1:]
    else:
        for each in (stated, known, true):
            each.pop(name, None)
    for shape in SHAPES.values():
        true |= shape
    true |= {**known, "start": of.start, "start_speed": 0.0}
    knots, u = excited(of, draw, key.condition == "off the grid")
    lost = draw.random(COUNT) < 0.1 * (key.condition in ("missing", "all three"))
    kept = np.flatnonzero(~lost | (np.arange(COUNT) == 0))
    hiding = Hiding(of, true, stated, knots, u, kept, name, tried, hidden)
    size, strength, by = key.size, 0.0, ""
    if key.size:
        strength, by = float(hiding.strengths(np.array([size]))["stated"][0]), "stated"
    elif cause:
        size, strength, by = hiding.found(key.strength, rules)
    plain, sd = hiding.seen([{name: size} if name else {}], FINE)[:, 0], hiding.error()
    y = plain + sd * errors(key.condition, draw)
    if key.condition in ("rounded", "all three"):
        step = sd * draw.uniform(0.8, 1.25)
        y = step * np.round(y / step)
    t = of.step * np.arange(COUNT)
    inputs = {of.input: u[np.searchsorted(knots, t, side="right") - 1][kept]} if of.input else {}
    told = {name + PARAMETERS.get(name.partition(" ")[0], ""): size} if name else {}
    told |= SHAPES.get(name, {})
    reads, _, unit = of.reads.rstrip(")").partition(" (")
    return Made(
        f"{key.machine}, {cause or 'nothing'}, {key.strength:g}, {key.condition}", of.kind, reads,
        unit, t[kept], inputs, y[kept], stated, known, (), name, by, told,
        {**true, of.begin: of.start, **told}, strength, key.condition, key.seed, sd, plain[kept],
    )  # fmt: skip


def problems(first_seed: int) -> list[Key]:
    """All problems: each cause by itself, nothing hidden, errors alike, and far scales."""
    every = [(name, cause) for name, of in MACHINES.items()
             for cause in ("", *of.causes, *(f"misstated {one}" for one in of.constants))
             ]  # fmt: skip
    parts = ((8.0, ["clean"]), (25.0, ["clean"]), (25.0, ["off the grid"]),
             (0.0, ["all three"]), (0.0, ["rounded", "correlated", "missing"]))  # fmt: skip
    asked: list[tuple[Any, ...]] = [
        (name, cause, 25.0 if (name, cause) == SOFT else strength or (8.0, 25.0)[k // 3 % 2],
         conditions[k % len(conditions)])
        for strength, conditions in parts for k, (name, cause) in enumerate(every)
        if MACHINES[name].input or "off the grid" not in conditions
    ]  # fmt: skip
    asked += [(name, "", 0.0, condition) for condition in ("AR 0.5", "AR 0.8", "mean of three")
              for name in [*MACHINES][:8]]  # fmt: skip
    asked += [(name, "scale", 0.0, "clean", size) for size in (-0.5, -0.38, -0.3, 0.3, 0.6, 1.2)
              for name in ("joint", "joint by its angle", "axis")]  # fmt: skip
    return [Key(first_seed + k, *each) for k, each in enumerate(asked)]
