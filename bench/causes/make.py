"""The sets: logs of machines with a hidden cause, from integrators that share no code with ours."""

from __future__ import annotations

import json
import math
import zlib
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Terms = dict[str, Any]
Acts = Callable[[int, Any, Any], Any]

FOLDER = Path(__file__).resolve().parent / "sets"
TRUTH = FOLDER.parent / "truth.json"
FIRST = 41000  # seeds; those of the studies of the diagnosis are others
OF_A_KIND = 12
FINE = 100  # steps of the integrator between two readings
STRENGTH = 4.0, 9.0  # rms of the cause's effect over the noise of a reading, before any refit
ERROR = 0.25  # rms of a model error over that of the cause beside it

# Of each kind: readings and their step (s), the constants with their relative errors, what is
# known, causes that are not asked for, and hidden ones with the sign and order of their sizes.
KINDS: dict[str, dict[str, Any]] = {
    "joint": {
        "reads": "speed (rad/s)", "input": "torque (N m)", "step": 0.02, "count": 200,
        "constants": {"inertia": (0.012, 0.05), "viscous": (0.02, 0.3)}, "known": {},
        "without": ["backlash", "compliance", "viscous_asymmetry"],
        "hidden": {"coulomb": 0.03, "load": 0.02, "gravity": 0.05, "late torque": 0.03,
                   "asymmetry": 0.02},
    },
    "axis": {
        "reads": "position (m)", "input": "command (V)", "step": 0.02, "count": 200,
        "constants": {"mass": (1.0, 0.05), "viscous": (1.5, 0.3)}, "known": {},
        "without": ["backlash", "compliance", "viscous_asymmetry"],
        "hidden": {"coulomb": 0.3, "dead_zone": 0.2, "saturation": 1.2, "gain_asymmetry": 0.1,
                   "late command": 0.04},
    },
    "pendulum": {
        "reads": "angle (rad)", "input": None, "step": 0.05, "count": 240,
        "constants": {"length": (0.6, 0.03), "viscous": (0.08, 0.4)}, "known": {},
        "without": [],
        "hidden": {"coulomb": 0.1, "quadratic": 0.1, "stiffness": 1.0, "zero": 0.03},
    },
    "oscillator": {
        "reads": "displacement (m)", "input": "force (N)", "step": 0.02, "count": 250,
        "constants": {"stiffness": (40.0, 0.03), "viscous": (0.5, 0.3)}, "known": {"mass": 1.0},
        "without": [],
        "hidden": {"cubic_stiffness": 300.0, "coulomb": 0.1, "cubic_damping": 0.5,
                   "quadratic_stiffness": 30.0, "zero": 0.01},
    },
    "thermal": {
        "reads": "temperature (K)", "input": "power (W)", "step": 10.0, "count": 180,
        "constants": {"capacity": (100.0, 0.05), "loss": (1.2, 0.1)}, "known": {"ambient": 293.0},
        "without": ["slow thermometer"],
        "hidden": {"loss_growth": 0.02, "power_error": 0.1, "zero": 1.0, "late power": 20.0,
                   "heater_capacity": 15.0},
    },
    "servo": {
        "reads": "position (rad)", "input": "goal (rad)", "step": 0.02, "count": 200,
        "constants": {"torque_constant": (1.0, 0.03), "viscous": (0.05, 0.3),
                      "coulomb": (0.08, 0.2)},
        "known": {"inertia": 0.02, "resistance": 3.0, "supply": 12.0, "gain": 2.0, "gravity": 0.9,
                  "duty_limit": 0.5},
        "without": ["slow goal"],
        "hidden": {"armature": 0.004, "mass_error": 0.1, "load_friction": 0.1, "backlash": 0.03},
    },
}  # fmt: skip
SETS = [kind for kind in KINDS if kind != "servo"]  # those of the benchmark; see `blind servo`


def simulated(kind: str, c: Terms, t: Array, u: Array) -> Array:
    """Readings of a machine in steps of a hundredth of theirs."""
    late = c.get("late torque", 0.0) + c.get("late command", 0.0) + c.get("late power", 0.0)
    step = t[1] - t[0]
    fine = np.arange((len(t) - 1) * FINE) * (step / FINE)
    at = np.clip(np.floor((fine - late) / step + 1e-9).astype(int), 0, len(t) - 1)
    held = u[at]
    found = states(kind, c, bent(c, held) if kind == "axis" else held, step / FINE)
    return np.asarray(found[::FINE, 1 if kind == "joint" else 0] + c.get("zero", 0.0))


PARAMETERS = {"zero": ".shift", "scale": ".error", "late": ".time", "slow": ".time"}
"""Ends of the parameters of causes that are not called as these."""


def correlated(draws: Array, part: float) -> Array:
    """Normal draws, of which each has a part of the one before."""
    for k in range(1, len(draws)):
        draws[k] = part * draws[k - 1] + np.sqrt(1.0 - part**2) * draws[k]
    return draws


def bent(c: Terms, u: Array) -> Array:
    """A command as it acts: beyond a dead zone, up to a limit, and by its direction."""
    beyond = np.maximum(np.abs(u) - c.get("dead_zone", 0.0), 0.0)
    command = np.sign(u) * np.minimum(beyond, c.get("saturation", np.inf))
    return np.asarray(command * (1.0 + np.sign(u) * c.get("gain_asymmetry", 0.0)))


def states(kind: str, c: Terms, held: Array, h: float, acts: Acts | None = None) -> Array:
    """Places and speeds, or temperatures, by the semi-implicit rule of Euler: (1 + steps, 2).

    Constants may be arrays, (copies,), with a `held` input of shape (steps, copies): states have
    a third axis then. ``acts(step, place, speed)`` is one more force, or heat.
    """
    if held.ndim == 1:
        c = {name: float(value) for name, value in c.items()}
    inputs = held if held.ndim > 1 else held.tolist()
    return np.array([*(_heated if kind == "thermal" else _moved)(kind, c, inputs, h, acts)])


def _above(x: Any) -> Any:
    return 0.5 * (x + abs(x))  # the part above 0, of a number or of an array


def _any(c: Terms, *names: str) -> bool:
    return any(np.any(c[name] != 0.0) for name in names)


def _forces(kind: str, c: Terms, m: Any) -> Callable[..., Any]:
    """What drives a motor, what its load resists, and dry friction, of a drive and both states."""
    servo, swings, closed = kind == "servo", kind == "pendulum", "gain" in c
    hangs, springs = _any(c, "length", "gravity"), _any(c, "stiffness")
    curved = _any(c, "quadratic_stiffness", "cubic_stiffness")
    dragged = _any(c, "viscous_asymmetry", "quadratic", "cubic_damping")
    weight = 9.81 / c["length"] if swings else c["gravity"] * (1.0 + c["mass_error"])

    def forces(drive: Any, x: Any, v: Any, y: Any, w: Any) -> tuple[Any, Any, Any]:
        if servo:
            duty = c["gain"] * (drive - y) - c["damping_gain"] * w if closed else drive
            duty = duty - m.copysign(_above(abs(duty) - c.get("duty_limit", 1e300)), duty)
            current = (c["supply"] * duty - c["torque_constant"] * v) / c["resistance"]
            drive = c["torque_constant"] * current
        elif swings:
            drive = drive * m.cos(x)
        resists = c["load"] + (c["stiffness"] * y if springs else 0.0)
        if hangs:
            resists = resists + weight * m.sin(y)
        if curved:
            resists = resists + (c["quadratic_stiffness"] + c["cubic_stiffness"] * y) * y * y
        friction = c["coulomb"] + (c["load_friction"] * abs(drive + resists) if servo else 0.0)
        drive = drive - c["viscous"] * v
        if dragged:
            drive = drive - (c["viscous_asymmetry"] + c["quadratic"] * v) * abs(v)
            drive = drive - c["cubic_damping"] * v**3
        return drive, resists, friction

    return forces


def _moved(kind: str, c: Terms, inputs: Any, h: float, acts: Acts | None) -> Iterator[Any]:
    """The motor's place and speed, or those of a servo's load.

    Dry friction takes off as much of the momentum of a step as there is, at most its own. Motor and
    load meet without rebound across the play.
    """
    m: Any = np if np.ndim(inputs[0]) else math
    servo, forces = kind == "servo", _forces(kind, c := defaultdict(float, c), m)
    gap, share, whole = 0.5 * c["backlash"], 0.5, c.get("inertia", c.get("mass", 1.0))
    whole = whole * (1.0 + c["mass_error"]) + c["armature"]
    if servo:
        share = 1.0 - np.maximum(c["armature"] / whole, 0.1)
    rotor, arm, rigid = (1.0 - share) * whole, share * whole, c["compliance"] == 0.0
    spring = (1.0 - rigid) / (c["compliance"] + rigid)
    damper = 0.1 * (spring * share * rotor) ** 0.5
    falls, two = _any(c, "stribeck"), _any(c, "backlash", "compliance")
    dry = falls or _any(c, "coulomb", "asymmetry", "load_friction")

    def slowed(v: Any, friction: Any, carried: Any) -> Any:
        if not dry:
            return v
        friction = _above(friction + c["asymmetry"] * m.copysign(1.0, v))
        if falls:
            friction = friction + c["stribeck"] * m.exp(-((v / c["stribeck_speed"]) ** 2))
        return m.copysign(_above(abs(v) - h * friction / carried), v)

    x = y = c["start"] + 0.0 * inputs[0]
    v = w = c["start_speed"] + 0.0 * inputs[0]
    ahead = m.copysign(gap, inputs[0] - (y if "gain" in c else 0.0))
    x, y = (x + ahead, y) if servo else (x, y - ahead)
    yield (y, w) if servo else (x, v)
    for k, drive in enumerate(inputs):
        drive, resists, friction = forces(drive, x, v, y, w)
        drive = drive + (acts(k, y, w) if acts else 0.0)
        if two:
            between = spring * (x - y) + damper * (v - w)
            v, w = v + h * (drive - between) / rotor, w - h * (resists - between) / arm
            alone, both = slowed(v, friction, rotor), slowed(v + share * (w - v), friction, whole)
            apart = x - y + h * (alone - w)
            touches = 1.0 * rigid * (abs(apart) >= gap) * (apart * (alone - w) >= 0.0)
            v, w = alone + touches * (both - alone), w + touches * (both - w)
            x, y = x + h * v, y + h * w
            y = y + touches * (x - m.copysign(gap, apart) - y)
        else:
            v = w = slowed(v + h * (drive - resists) / whole, friction, whole)
            x = y = x + h * v
        yield (y, w) if servo else (x, v)


def _heated(kind: str, c: Terms, inputs: Any, h: float, acts: Acts | None) -> Iterator[Any]:
    """The temperature of the body, twice."""
    body = heater = wall = c["start"] + 0.0 * inputs[0]
    own, other = c.get("heater_capacity", 0.0), c.get("wall_capacity", 0.0)
    flow, to_wall = c.get("coupling", 2.0) * (own != 0.0), c.get("wall_coupling", 2.0)
    walled, two = np.any(other != 0.0), np.any(own != 0.0)
    yield body, body
    for k, power in enumerate(inputs):
        power = power * (1.0 + c.get("power_error", 0.0)) + (acts(k, body, 0.0) if acts else 0.0)
        over = body - c["ambient"]
        gained = power - (c["loss"] + c.get("loss_growth", 0.0) * abs(over)) * over
        if two:
            moved = power + (own != 0.0) * (flow * (heater - body) - power)
            heater = heater + h * (power - moved) / (own + (own == 0.0))
            gained = gained + moved - power
        if walled:
            moved = (other != 0.0) * to_wall * (body - wall)
            wall = wall + h * moved / (other + (other == 0.0))
            gained = gained - moved
        body = body + h * gained / c["capacity"]
        yield body, body


def _input(kind: str, t: Array, random: np.random.Generator) -> Array:
    if kind == "pendulum":
        return np.zeros(len(t))
    if kind == "thermal":
        return np.repeat(random.uniform(0.0, 60.0, 12), len(t) // 12 + 1)[: len(t)]
    size = {"joint": 0.12, "axis": 2.0, "oscillator": 4.0}[kind]
    rates, phases = random.uniform(0.2, 1.6, 4), random.uniform(0.0, 6.3, 4)
    waves = np.sin(2.0 * np.pi * rates[:, None] * t + phases[:, None])
    return np.asarray(size * np.sum(waves, axis=0) / 1.6)


def made(kind: str, number: int) -> tuple[str, dict[str, Any], dict[str, Any]]:
    """The log of a set as CSV, what is told of it, and what is not."""
    own = KINDS[kind]
    random = np.random.default_rng([FIRST + number, zlib.crc32(kind.encode())])
    t = np.arange(own["count"]) * own["step"]
    u = _input(kind, t, random)
    drawn = {name: value * (1.0 + part * random.standard_normal())
             for name, (value, part) in own["constants"].items()}  # fmt: skip
    start = {"pendulum": 0.9, "thermal": 293.0}.get(kind, 0.0)
    base: Terms = {**own["known"], **drawn, "start": start}
    plain = simulated(kind, base, t, u)
    noise = 0.02 * float(np.std(plain))
    names, cause, error = list(own["hidden"]), "", False
    readings = plain
    if number % 4:  # a quarter hides nothing
        cause = names[number % len(names)]
        wanted, size = random.uniform(*STRENGTH) * noise, own["hidden"][cause]
        for _ in range(40):
            readings = simulated(kind, {**base, cause: size}, t, u)
            found = float(np.sqrt(np.mean((readings - plain) ** 2)))
            if abs(found / wanted - 1.0) < 0.05:
                break
            # What is beyond a limit acts as the limit falls.
            power = -1.0 if cause == "saturation" else 1.0
            size *= np.clip(wanted / max(found, 1e-3 * wanted), 0.5, 2.0) ** (0.7 * power)
        error = number % 4 == 1
        if error:
            wide = 0.37 * float(np.ptp(readings))
            ripple = np.sin(2 * np.pi * readings / wide + 1.0)
            readings = readings + ERROR * found / float(np.std(ripple)) * ripple
    seen = readings + noise * random.standard_normal(len(t))
    columns = {"t (s)": t, **({own["input"]: u} if own["input"] else {}), own["reads"]: seen}
    lines = [",".join(columns), *(",".join(f"{each:.7g}" for each in row)
                                  for row in zip(*columns.values(), strict=True))]  # fmt: skip
    told = {"kind": kind, "constants": {name: [value, value * part] for name, (value, part)
                                        in own["constants"].items()},
            "known": own["known"], "without": own["without"]}  # fmt: skip
    truth = {"cause": cause, "model_error": error}
    return "\n".join(lines) + "\n", told, truth


def _toml(told: dict[str, Any], without: list[str]) -> str:
    lines = [f'kind = "{told["kind"]}"', 'log = "log.csv"', f"without = {json.dumps(without)}"]
    if "constants" not in told:  # they stand in the file of the measurement
        return "\n".join(lines) + "\n"
    lines += ["", "[constants]  # value, standard deviation"]
    lines += [f"{name} = {value}" for name, value in told["constants"].items()]
    lines += ["", "[known]", *(f"{name} = {value}" for name, value in told["known"].items())]
    return "\n".join(lines) + "\n"


def write(name: str, files: dict[str, str], told: dict[str, Any], truth: dict[str, Any]) -> None:
    """A set, and the same log for who does not list the cause; the truth goes to the others."""
    folder = FOLDER / name
    folder.mkdir(parents=True, exist_ok=True)
    texts, truths = {**files, "set.toml": _toml(told, told["without"])}, {name: True}
    if truth["cause"]:
        texts["unlisted.toml"] = _toml(told, [*told["without"], truth["cause"]])
        truths[f"{name} unlisted"] = False
    for file, text in texts.items():
        (folder / file).write_text(text)
    have = json.loads(TRUTH.read_text()) if TRUTH.exists() else {}
    have |= {each: {**truth, "listed": listed} for each, listed in truths.items()}
    TRUTH.write_text(json.dumps(have, indent=1) + "\n")
    print(name, truth, flush=True)


def make() -> None:
    """Write all sets of models that are ready-made."""
    for kind in SETS:
        for number in range(OF_A_KIND):
            log, told, truth = made(kind, number)
            write(f"{kind}-{number:02}", {"log.csv": log}, told, truth)
