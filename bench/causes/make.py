"""The sets: logs of machines with a hidden cause, from integrators that share no code with ours."""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Terms = dict[str, float]

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
    """Readings of a machine by the semi-implicit rule of Euler in steps of a hundredth.

    Dry friction takes off as much of the momentum of a step as there is, at most its own.
    """
    late = c.get("late torque", 0.0) + c.get("late command", 0.0) + c.get("late power", 0.0)
    step = t[1] - t[0]
    fine = np.arange((len(t) - 1) * FINE) * (step / FINE)
    at = np.clip(np.floor((fine - late) / step + 1e-9).astype(int), 0, len(t) - 1)
    held = u[at]
    if kind == "thermal":
        return _heated(c, t, held, step / FINE)
    if kind == "servo":
        return _turned(c, t, held, step / FINE)
    if kind == "axis":
        beyond = np.maximum(np.abs(held) - c.get("dead_zone", 0.0), 0.0)
        held = np.sign(held) * np.minimum(beyond, c.get("saturation", np.inf))
        held = held * (1.0 + np.sign(held) * c.get("gain_asymmetry", 0.0))
    whole = {"joint": "inertia", "axis": "mass", "oscillator": "mass"}.get(kind)
    mass = c[whole] if whole else 1.0
    swings = 9.81 / c["length"] if kind == "pendulum" else c.get("gravity", 0.0) / mass
    x, v, h = c.get("start", 0.0), 0.0, step / FINE
    found = np.empty((len(t), 2))
    found[0] = x, v
    stiff, square = c.get("stiffness", 0.0) / mass, c.get("quadratic_stiffness", 0.0) / mass
    cubic, third = c.get("cubic_stiffness", 0.0) / mass, c.get("cubic_damping", 0.0) / mass
    damp, drag = c.get("viscous", 0.0) / mass, c.get("quadratic", 0.0) / mass
    dry, unequal = c.get("coulomb", 0.0) / mass, c.get("asymmetry", 0.0) / mass
    load = c.get("load", 0.0) / mass
    for k, drive in enumerate((held / mass).tolist(), 1):
        a = drive - load - stiff * x - square * x * x - cubic * x**3 - swings * np.sin(x)
        v += h * (a - damp * v - drag * v * abs(v) - third * v**3)
        most = h * max(dry + unequal * np.sign(v), 0.0)
        v = np.sign(v) * max(abs(v) - most, 0.0)
        x += h * v
        if k % FINE == 0:
            found[k // FINE] = x, v
    readings = found[:, 1 if kind == "joint" else 0]
    return np.asarray(readings + c.get("zero", 0.0))


def _heated(c: Terms, t: Array, held: Array, h: float) -> Array:
    body = heater = c["start"]
    own, flow = c.get("heater_capacity", 0.0), 2.0
    found = [body]
    for k, power in enumerate(held.tolist(), 1):
        power *= 1.0 + c.get("power_error", 0.0)
        over = body - c["ambient"]
        lost = (c["loss"] + c.get("loss_growth", 0.0) * abs(over)) * over
        moved = flow * (heater - body) if own else power
        if own:
            heater += h * (power - moved) / own
        body += h * (moved - lost) / c["capacity"]
        if k % FINE == 0:
            found.append(body)
    return np.array(found) + c.get("zero", 0.0)


def _turned(c: Terms, t: Array, held: Array, h: float) -> Array:
    """Places of the arm of a servo; motor and arm meet without rebound across the play."""
    heavier, gap = 1.0 + c.get("mass_error", 0.0), 0.5 * c.get("backlash", 0.0)
    whole = c["inertia"] * heavier + c.get("armature", 0.0)
    rotor = max(c.get("armature", 0.0), 0.1 * whole)
    y, v, w = c["start"], 0.0, 0.0
    x = y + np.sign(held[0] - y) * gap
    found = [y]
    for k, goal in enumerate(held.tolist(), 1):
        duty = min(max(c["gain"] * (goal - y), -c["duty_limit"]), c["duty_limit"])
        current = (c["supply"] * duty - c["torque_constant"] * v) / c["resistance"]
        torque, weight = c["torque_constant"] * current, c["gravity"] * heavier * np.sin(y)
        dry = c["coulomb"] + c.get("load_friction", 0.0) * abs(torque + weight)
        v += h * (torque - c["viscous"] * v) / rotor
        w -= h * weight / (whole - rotor)
        apart = x - y + h * (v - w)
        touches = abs(apart) >= gap and apart * (v - w) >= 0.0
        moved = whole if touches else rotor
        v = (rotor * v + (whole - rotor) * w) / whole if touches else v
        v = np.sign(v) * max(abs(v) - h * dry / moved, 0.0)
        x += h * v
        if touches:
            w, y = v, x - np.sign(apart) * gap
        else:
            y += h * w
        if k % FINE == 0:
            found.append(y)
    return np.array(found) + c.get("zero", 0.0)


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
