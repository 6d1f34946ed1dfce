"""``python -m bench made [KIND ...]``: five kinds of made data with a known answer, diagnosed.

Each has a model of ten to thirty lines as its user would write it, and data of another integrator.
A verdict is right if it claims what is hidden, and nothing else, with each size within four
standard errors or a twentieth of the truth.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from blind.seeds import used
from measure import ROOT, saved
from scipy.integrate import solve_ivp
from stale import digest

from stickslip import Cause, Parameter, Prior, Series, Table, diagnose_model, events, instruments

Array = np.ndarray
TRIED = 23000  # first of the old seeds, by which thresholds and searches are chosen
JUDGED = 27000  # first of the seeds whose verdicts are kept
OUT = ROOT / "bench" / "made.json"
_WITHIN, _PART = 4.0, 0.05


@dataclass(frozen=True)
class Made:
    """Data and what is hidden in them: names of causes, and sizes of parameters."""

    predict: Callable[[Table, Any], Array]
    data: list[Table]
    uncertain: list[Parameter]
    causes: list[Cause]
    truth: dict[str, float]


def _cause(name: str, size: float, most: float, unit: str = "-") -> Cause:
    return Cause(name, Parameter(f"{name}.size", unit=unit, low=0.0, high=most, size=size))


def _stepped(
    rate: Callable[[Array, Array], Array], x: Array, v: Array, t: Array, parts: int
) -> Array:
    """Positions at times by classical Runge-Kutta steps, shape (vectors, n)."""
    found = [x]
    for step in np.diff(t):
        h = step / parts
        for _ in range(parts):
            a1 = rate(x, v)
            a2 = rate(x + 0.5 * h * v, v + 0.5 * h * a1)
            a3 = rate(x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2)
            a4 = rate(x + h * v + 0.5 * h * h * a2, v + h * a3)
            x = x + h * v + h * h / 6.0 * (a1 + a2 + a3)
            v = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        found.append(x)
    return np.hstack(found)


def _solved(rate: Callable[[Array, Array], Array], x: float, v: float, t: Array) -> Array:
    made = solve_ivp(lambda _, z: [z[1], rate(z[0], z[1])], t[[0, -1]], [x, v], "DOP853", t,
                     rtol=1e-9, atol=1e-11)  # fmt: skip
    return np.asarray(made.y[0])


def _swing(p: dict[str, float]) -> Callable[[Array, Array], Array]:
    """Acceleration of a swing or a spring with everything that may act on it."""

    def rate(x: Array, v: Array) -> Array:
        pull = p["w"] ** 2 * (np.sin(x) if p["swings"] else x + p.get("cubic", 0.0) * x**3)
        damped = p["c"] * v + p.get("drag", 0.0) * v * np.abs(v)
        return -pull - damped - p.get("dry", 0.0) * np.tanh(v / 0.01)

    return rate


def oscillator(seed: int) -> Made:
    """A spring of a precise meter with one nonlinear term and a wrong zero."""
    draw, t = np.random.default_rng([1, seed]), np.linspace(0.0, 5.0, 151)
    name, size = [("cubic", 0.3), ("drag", 0.08)][seed % 2]
    size, zero = size * draw.uniform(0.5, 1.5), 0.02 * draw.uniform(0.5, 1.5)
    w, c = 5.0 * (1.0 + 0.02 * draw.standard_normal()), 0.1 * (1.0 + 0.2 * draw.standard_normal())
    y = _solved(_swing({"w": w, "c": c, "swings": 0.0, name: size}), 1.0, 0.0, t) + zero
    sd = 1e-3

    def predict(record: Table, p: Any) -> Array:
        rate = _swing({"w": p["w"], "c": p["c"], "swings": 0.0, "cubic": p["cubic.size"],
                       "drag": p["drag.size"], "dry": p["dry.size"]})  # fmt: skip
        return _stepped(rate, p["start"], p["speed"], record["t"], 2)

    uncertain = [
        Parameter("w", Prior("normal", 5.0, 0.1), "rad/s"),
        Parameter("c", Prior("normal", 0.1, 0.02), "1/s"),
        Parameter("start", Prior("normal", 1.0, 0.05), "m", cause=False),
        Parameter("speed", Prior("normal", 0.0, 0.1), "m/s", cause=False),
    ]
    causes = [
        Cause("cubic", Parameter("cubic.size", unit="1/m2", low=-2.0, high=2.0, size=0.2)),
        _cause("drag", 0.1, 2.0), _cause("dry", 0.2, 5.0), instruments.offset("m", 0.02),
        instruments.scale(), instruments.delay(size=0.01),
    ]  # fmt: skip
    record = Series(t, y + sd * draw.standard_normal(len(t)), sd=sd, unit="m")
    return Made(predict, [record], uncertain, causes, {f"{name}.size": size, "offset.shift": zero})


def swing(seed: int) -> Made:
    """A swing with two kinds of damping, whose error is not stated."""
    draw, t = np.random.default_rng([2, seed]), np.linspace(0.0, 20.0, 501)
    drag, dry = 0.1 * draw.uniform(0.5, 1.5), 0.05 * draw.uniform(0.5, 1.5)
    w, c = 4.0 * (1.0 + 0.01 * draw.standard_normal()), 0.03 * (1.0 + 0.2 * draw.standard_normal())
    y = _solved(_swing({"w": w, "c": c, "swings": 1.0, "drag": drag, "dry": dry}), 1.2, 0.0, t)

    def predict(record: Table, p: Any) -> Array:
        rate = _swing({"w": p["w"], "c": p["c"], "swings": 1.0, "drag": p["drag.size"],
                       "dry": p["dry.size"]})  # fmt: skip
        return _stepped(rate, p["start"], 0.0 * p["start"], record["t"], 2)

    uncertain = [
        Parameter("w", Prior("normal", 4.0, 0.04), "rad/s"),
        Parameter("c", Prior("normal", 0.03, 0.006), "1/s"),
        Parameter("start", Prior("normal", 1.2, 0.02), "rad", cause=False),
    ]
    causes = [
        _cause("drag", 0.1, 2.0), _cause("dry", 0.05, 2.0, "1/s2"), instruments.offset("rad", 0.02),
        instruments.scale(), instruments.delay(size=0.02),
    ]  # fmt: skip
    record = Series(t, y + 2e-3 * draw.standard_normal(len(t)), unit="rad")
    return Made(predict, [record], uncertain, causes, {"drag.size": drag, "dry.size": dry})


def _turned(t: Array, torque: Array, inertia: Any, viscous: Any, dry: Any, parts: int) -> Array:
    """Angles of a joint, (vectors, n), by half-implicit steps; dry friction stops what is slow.

    Angles follow the mean speed of a step: by its last speed they would be early by half a step.
    """
    speed = angle = 0.0 * (inertia + torque[..., :1])
    found = [angle]
    for k, step in enumerate(np.diff(t)):
        h, acting = step / parts, 0.5 * (torque[..., k : k + 1] + torque[..., k + 1 : k + 2])
        for _ in range(parts):
            before, free = speed, (speed + h * acting / inertia) / (1.0 + h * viscous / inertia)
            speed = np.sign(free) * np.maximum(np.abs(free) - h * dry / inertia, 0.0)
            angle = angle + 0.5 * h * (before + speed)
        found.append(angle)
    return np.hstack(found)


def joint(seed: int) -> Made:
    """A joint with dry friction whose torque is logged early: the input acts late."""
    draw, t = np.random.default_rng([3, seed]), 0.03 * np.arange(200)
    torque = np.repeat(draw.uniform(-1.0, 1.0, 10), 20)
    dry, late = 0.15 * draw.uniform(0.5, 1.5), 0.05 * draw.uniform(0.5, 1.5)
    inertia, viscous = (
        0.1 * (1.0 + 0.03 * draw.standard_normal()),
        0.2 + 0.03 * draw.standard_normal(),
    )
    fine = np.linspace(0.0, t[-1], 20 * 199 + 1)
    acting = np.interp(fine - late, t, torque)[None, :]
    y = _turned(fine, acting, np.array([[inertia]]), viscous, dry, 1)[0, ::20]

    def predict(record: Table, p: Any) -> Array:
        given = np.atleast_2d(record["torque"])
        return _turned(record["t"], given, p["inertia"], p["viscous"], p["dry.size"], 4)

    uncertain = [
        Parameter("inertia", Prior("normal", 0.1, 0.003), "kg m2"),
        Parameter("viscous", Prior("normal", 0.2, 0.03), "N m s"),
    ]
    causes = [
        _cause("dry", 0.1, 2.0, "N m"), instruments.offset("rad", 0.02), instruments.scale(),
        instruments.delay(size=0.05, input="torque", name="late"),
        instruments.lag(0.05, input="torque", name="slow"),
    ]  # fmt: skip
    record = Series(t, y + 5e-3 * draw.standard_normal(len(t)), {"torque": torque}, sd=5e-3)
    return Made(predict, [record], uncertain, causes, {"dry.size": dry, "late.time": late})


def pulses(seed: int) -> Made:
    """A controller whose plant answers pulses of its command, which move a constant far."""
    draw, t = np.random.default_rng([4, seed]), np.arange(300) * 0.02
    height, start, width = draw.uniform(3.0, 6.0), draw.uniform(0.2, 0.45), draw.uniform(0.4, 0.6)
    since = (t - start) % 1.0
    on, off = since < width, np.exp(-(since - width) / 0.1)
    error = 1e-4 * (np.sin(2.1 * t) + 0.4 * np.sin(5.3 * t + 1.0))
    rate = 0.02 * np.cos(2.1 * t) + 0.002 * draw.standard_normal(len(t))
    rate += 0.02 * height * np.where(on, 1.0 - np.exp(-since / 0.1), off)
    volts = 243.0 * (160.0 * error - rate) + height * on + 0.03 * draw.standard_normal(len(t))

    def predict(record: Table, p: Any) -> Array:
        begins = [p["pulses.start"] + k for k in range(-1, 7)]
        on = sum(events.edge(record, each) - events.edge(record, each + p["pulses.width"])
                 for each in begins)  # fmt: skip
        return p["kv"] * (p["kp"] * record["e"] - record["rate"]) + p["pulses.height"] * on

    uncertain = [
        Parameter("kp", Prior("normal", 160.0, 0.5), "1/s"),
        Parameter("kv", Prior("normal", 243.0, 0.8), "V s/m"),
    ]
    shapes = {"unit": "s", "cause": False}
    causes = [
        Cause("pulses", (
            Parameter("pulses.height", unit="V", low=-10.0, high=10.0, size=2.0),
            Parameter("pulses.start", Prior("normal", 0.5, 0.4), low=0.0, high=1.0, **shapes),
            Parameter("pulses.width", Prior("normal", 0.5, 0.25), low=0.02, high=0.98,
                      **shapes),
        )),
        instruments.offset("V", 0.2), instruments.clipping("V", 10.0, 3.0, lowest=0.5),
    ]  # fmt: skip
    record = Series(t, volts, {"e": error, "rate": rate}, sd=0.03, unit="V")
    truth = {"pulses.height": height, "pulses.start": start, "pulses.width": width}
    return Made(predict, [record], uncertain, causes, truth)


def _hit(angle: Any, vx: Any, vz: Any, spin: Any, restitution: Any, friction: Any) -> list[Array]:
    """Velocities of a square of side 1 cm after its lowest corner has hit the ground."""
    lowest = np.round(angle / (0.5 * np.pi) - 0.5) + 0.5
    lean = angle - 0.5 * np.pi * lowest
    x, z = 5e-3 * np.sqrt(2.0) * np.sin(lean), -5e-3 * np.sqrt(2.0) * np.cos(lean)
    inertia = 1e-4 / 6.0
    slip, rise = vx - spin * z, vz + spin * x
    a, b, c = 1.0 + z**2 / inertia, -x * z / inertia, 1.0 + x**2 / inertia
    goal = -(1.0 + restitution) * rise
    stop_x, stop_z = (-c * slip - b * goal) / (a * c - b**2), (a * goal + b * slip) / (a * c - b**2)
    side = -np.sign(slip) * friction
    slide = goal / (c + side * b)
    sticks = np.abs(stop_x) <= friction * stop_z
    push_x, push_z = np.where(sticks, stop_x, side * slide), np.where(sticks, stop_z, slide)
    return [vx + push_x, vz + push_z, spin + (x * push_z - z * push_x) / inertia]


def square(seed: int) -> Made:
    """Squares that fall on a corner, seen with a wrong zero of the angle."""
    draw = np.random.default_rng([5, seed])
    restitution, friction = 0.5 + 0.05 * draw.standard_normal(), draw.uniform(0.15, 0.35)
    zero = np.radians(draw.uniform(2.0, 6.0)) * draw.choice([-1.0, 1.0])
    before = {
        "angle": draw.uniform(0.0, 2.0 * np.pi, 60), "vx": 0.3 * draw.standard_normal(60),
        "vz": -draw.uniform(0.8, 1.5, 60), "spin": 10.0 * draw.standard_normal(60),
    }  # fmt: skip
    after = _hit(*before.values(), restitution, friction)
    seen = {**before, "angle": before["angle"] + zero}
    sd = (0.02, 0.02, 3.0)
    names = ("vx", "vz", "spin")
    tables = [
        Table(seen, each + error * draw.standard_normal(60), sd=error, name=name)
        for name, each, error in zip(names, after, sd, strict=True)
    ]

    def predict(table: Table, p: Any) -> Array:
        vx, vz, spin = (table[name] * np.ones_like(p["zero.shift"]) for name in names)
        bounce = np.maximum(p["restitution"] * (1.0 - p["softer.size"] * (-vz - 1.0)), 0.0)
        made = _hit(table["angle"] - p["zero.shift"], vx, vz, spin * (1.0 + p["pace.error"]),
                    bounce, p["friction"])  # fmt: skip
        return made[names.index(table.name)]

    uncertain = [
        Parameter("restitution", Prior("normal", 0.5, 0.05)),
        Parameter("friction", Prior("log-uniform", 0.05, 0.6)),
    ]
    causes = [
        Cause("zero", Parameter("zero.shift", unit="rad", low=-0.5, high=0.5, size=0.05)),
        Cause("softer", Parameter("softer.size", unit="s/m", low=-1.0, high=1.0, size=0.2)),
        Cause("pace", Parameter("pace.error", low=-0.5, high=0.5, size=0.05)),
    ]
    return Made(predict, list(tables), uncertain, causes, {"zero.shift": zero})


KINDS: dict[str, Callable[[int], Made]] = {
    each.__name__: each for each in (oscillator, swing, joint, pulses, square)
}


def judged(kind: str, seed: int) -> tuple[bool, str]:
    """Whether a diagnosis of one made set is right, and what it says."""
    made = KINDS[kind](seed)
    begin = time.process_time()
    found = diagnose_model(made.predict, made.data, made.uncertain, made.causes)
    seconds = time.process_time() - begin
    hidden = {name.partition(".")[0] for name in made.truth}
    right = found.verdict.claims and set(found.verdict.causes) == hidden
    told = []
    if right:
        made_of = found.params.loc[list(made.truth)]
        for (name, truth), value, sd in zip(
            made.truth.items(), made_of["value"], made_of["sd"], strict=True
        ):
            off = abs(value - truth)
            right &= bool(off < max(_WITHIN * sd, _PART * abs(truth)))
            told.append(f"{name} {value:.4g} +- {sd:.1g}, truth {truth:.4g}")
    codes = ", ".join(each.code for each in found.verdict.reasons)
    said = f"{found.verdict.kind} {', '.join(found.verdict.causes)}; {'; '.join(told) or codes}"
    return right, f"{said}; {seconds:.1f} CPU s"


def main(arguments: Iterable[str] | None = None) -> None:
    """Diagnose made sets, and count the right verdicts of each kind."""
    parser = argparse.ArgumentParser(prog="python -m bench made", description=__doc__)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--first", type=int, default=TRIED, help="seed of the first set of a kind")
    parser.add_argument("--seeds", type=int, default=10, help="sets of each kind")
    options = parser.parse_args(None if arguments is None else list(arguments))
    print(*used("made", range(options.first, options.first + options.seeds)), sep="\n")
    for kind in options.kinds or KINDS:
        if kind not in KINDS:
            parser.error(f"{kind}: allowed are {', '.join(KINDS)}")
        count = 0
        for seed in range(options.first, options.first + options.seeds):
            right, said = judged(kind, seed)
            count += right
            if options.first >= JUDGED:
                sets = json.loads(OUT.read_text())["sets"] if OUT.exists() else {}
                sets[f"{kind} {seed}"] = {"right": right, "verdict": said, "golden": digest()}
                saved(OUT, f"made --first {JUDGED}", {"sets": sets}, said=False)
            print(f"{kind} {seed}: {'right' if right else 'not right'}: {said}", flush=True)
        print(f"{kind}: {count} of {options.seeds} right", flush=True)


if __name__ == "__main__":
    main()
