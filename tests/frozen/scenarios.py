"""The scenarios of the frozen runs. A name alone determines one.

Each is drawn from a generator that its name seeds, so that a scenario that is added or taken away
leaves all others as they are. Nothing comes from the processor: sums and square roots only, and
maps of the field are read from files.
"""

from __future__ import annotations

import functools
import itertools
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import effect_table
from stickslip import (
    COIL_NAMES,
    Coil,
    EffectParameter,
    FieldMap,
    Scenario,
    ScenarioError,
    Waveform,
    register_effect,
)

Keys = dict[str, Any]

_HERE = Path(__file__).parent

OWN_NAME = "frozen_wrench"


class Draw:
    """Draws by name of the distribution."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.random = np.random.default_rng(zlib.crc32(name.encode()))

    def some(self, names: list[str], count: int) -> list[str]:
        """`count` of `names`; a name that is added changes only the draws that it is among."""
        return sorted(names, key=lambda each: zlib.crc32(f"{self.name}/{each}".encode()))[:count]

    def uniform(self, low: float, high: float) -> float:
        return float(self.random.uniform(low, high))

    def word(self, *words: Any) -> Any:
        return words[self.whole(0, len(words) - 1)]

    def whole(self, low: int, high: int) -> int:
        return int(self.random.integers(low, high + 1))

    def chance(self, probability: float) -> bool:
        return bool(self.random.random() < probability)


def _drive(draw: Draw, pulses: int | None = None) -> Keys:
    peak = draw.uniform(1.5e-3, 4e-3)
    return {
        "drive.mode": draw.word("IPP", "OPP"),
        "drive.clamp": draw.word("down", "down", "up"),
        "drive.edge": draw.word("rise", "fall"),
        "drive.direction": draw.word("+x", "-x"),
        "drive.frequency": draw.uniform(20.0, 180.0),
        "drive.peak": peak,
        "drive.base": draw.uniform(-0.2, 0.5) * peak,
        "drive.hold": draw.uniform(0.5e-3, 3e-3),
        "drive.ramp": draw.uniform(0.02, 0.06),
        "drive.pulses": draw.whole(5, 8) if pulses is None else pulses,
    }


def _contact(draw: Draw) -> Keys:
    static = draw.uniform(0.1, 0.5)
    return {
        "contact.static_friction": static,
        "contact.kinetic_friction": static * draw.uniform(0.6, 1.0),
        "contact.adhesion": draw.uniform(0.0, 0.4e-6),
        "contact.restitution": draw.uniform(0.0, 0.5) if draw.chance(0.3) else 0.0,
        "drag.linear": draw.uniform(0.4e-5, 2e-5),
        "drag.rotational": draw.uniform(4e-17, 2e-16),
    }


def _effects(draw: Draw, count: int) -> Keys:
    names = [name for name in effect_table.rows() if name not in effect_table.OWN]
    keys: Keys = {}
    for name in draw.some(names, count):
        share = draw.uniform(0.3, 1.0)
        for key, value in effect_table.rows()[name].items():
            is_size = not key.startswith("laws.") or ".knot_" in key
            keys[key] = share * value if is_size else value
    return keys


def _across(draw: Draw) -> Keys:
    """Keys that take a drive into the whole plane, and leave a field that holds the heading."""
    kind = draw.word("heading", "ambient", "tilt")
    keys: Keys = {"drive.base": 0.4e-3}
    if kind == "heading":
        keys["drive.heading"] = draw.uniform(-1.2, 1.2)
    elif kind == "ambient":
        # So strong that the rising currents turn the robot no faster than it can follow.
        keys["effects.ambient_field.By"] = draw.word(-1, 1) * draw.uniform(3e-4, 6e-4)
    else:
        keys["effects.surface_tilt.angle"] = draw.uniform(0.01, 0.05)
        keys["effects.surface_tilt.azimuth"] = draw.uniform(0.2, 2.9)
    return keys


def _played(draw: Draw, across: bool) -> Keys:
    """Straight lines between random voltages, jumps among them; signs change on the way.

    In the whole plane the field stays to the front, else nobody would know the heading.
    """
    times, points = [0.0], [[0.0] * len(COIL_NAMES)]
    for _ in range(draw.whole(8, 16)):
        times.append(times[-1] + draw.uniform(2e-3, 12e-3))
        y = draw.uniform(-3.0, 3.0) if across else draw.uniform(-9.0, 9.0)
        points.append(
            [
                draw.uniform(6.0, 25.0) if across else draw.uniform(-20.0, 25.0),
                draw.uniform(-3.0, 8.0),
                # Opposite voltages make no field across.
                *([y, draw.uniform(-3.0, 3.0)] if across else [y, -y]),
                draw.uniform(-18.0, 3.0),
            ]
        )
        if draw.chance(0.3):
            times.append(times[-1])
            points.append([0.7 * each for each in points[-1]])
    waveform = Waveform.from_points(times, points)
    direction = draw.word("+x", "-x")
    return {
        "drive.mode": "program",
        "drive.direction": direction,
        "drive.program": waveform.turned() if direction == "-x" else waveform,
    }


@functools.cache
def _map(across: bool) -> FieldMap:
    """The field of unequal coils. It is kept, since a fit's last digits depend on the processor."""
    return FieldMap.from_json((_HERE / ("box.json" if across else "slice.json")).read_text())


def _effect(draw: Draw, name: str, across: bool) -> Scenario:
    keys = {**_drive(draw), **effect_table.rows()[name]}
    if across:
        keys = {**keys, **_across(draw), **effect_table.rows()[name]}
    return Scenario().replace(keys)


def _pack(draw: Draw) -> Scenario:
    return Scenario().replace({**_drive(draw), **_contact(draw)})


def _program(draw: Draw) -> Scenario:
    keys = {**_contact(draw), **_effects(draw, draw.whole(0, 2))}
    return Scenario().replace({**keys, **_played(draw, across=draw.chance(0.5))})


def _of_map(draw: Draw) -> Scenario:
    across = draw.chance(0.6)
    keys = _played(draw, across) if draw.chance(0.3) else {**_drive(draw), "drive.base": 0.4e-3}
    keys |= {k: v for k, v in _effects(draw, 1).items() if not k.startswith("coil.")}
    return Scenario(coil=Coil(map=_map(across))).replace(keys)


def _start(draw: Draw) -> Scenario:
    keys = {**_drive(draw), **_contact(draw), **(_across(draw) if draw.chance(0.4) else {})}
    start = {
        "initial.theta": draw.uniform(-1.0, 1.4),
        "initial.z": draw.uniform(150e-6, 250e-6),
        "initial.vx": draw.uniform(-0.02, 0.02),
        "initial.vz": draw.uniform(-0.02, 0.05),
        "initial.omega": draw.uniform(-50.0, 50.0),
        "initial.current_xp": draw.uniform(0.0, 1.0),
        "initial.current_clamp": draw.uniform(-1.0, 0.0),
    }
    return Scenario().replace({**keys, **start})


def _wrench(state: Any, parameters: tuple[float, ...]) -> tuple[float, float, float]:
    drag, pull = parameters
    swing = pull * state.Bx * state.theta
    return -drag * state.vx + swing, -drag * state.vz, -1e-9 * drag * state.omega


def _own(draw: Draw) -> Scenario:
    keys = {**_drive(draw, pulses=4), **_effects(draw, 1)}
    own = {"drag": draw.uniform(1e-6, 6e-6), "pull": draw.uniform(0.0, 2e-5)}
    return Scenario().replace({**keys, **{f"effects.{OWN_NAME}.{k}": v for k, v in own.items()}})


def _long(draw: Draw) -> Scenario:
    keys = {**_drive(draw, pulses=draw.whole(1000, 1500)), "drive.frequency": 200.0}
    keys |= {**_effects(draw, draw.whole(0, 1)), **(_across(draw) if draw.chance(0.4) else {})}
    return Scenario().replace(keys)


def _failure(draw: Draw) -> Scenario:
    """A run that ends early in one of the ways that there are."""
    keys: Keys = {**_drive(draw), "drive.base": 0.3e-3}
    kind = draw.word("steps", "workspace", "heading", "wrench", "events")
    if kind == "steps":
        keys["solver.max_steps"] = draw.whole(100, 600)
    elif kind == "workspace":
        # On a map, whose box ends after 6 mm.
        keys |= {"effects.surface_tilt.angle": draw.uniform(1.0, 1.4), "drive.ramp_down": 2.0}
        return Scenario(coil=Coil(map=_map(across=False))).replace(keys)
    elif kind == "heading":
        volts = draw.uniform(10.0, 20.0)
        points = [[0.0, 0, 0, 0, -9.0], [volts, 0, 0, 0, -9.0], [-volts, 0, 0, 0, -9.0]]
        keys = {
            "effects.ambient_field.By": effect_table.PUSHES[0],
            "drive.mode": "program",
            "drive.program": Waveform.from_points([0.0, 0.02, 0.05], points),
        }
    elif kind == "wrench":
        # Its force is infinite as soon as the robot moves.
        keys |= {f"effects.{OWN_NAME}.drag": 1e308, "drive.pulses": 4}
    else:
        keys |= {"contact.adhesion": 0.0, "contact.restitution": 1.0}
        keys |= {"drag.linear": 0.0, "drag.rotational": 0.0}
    return Scenario().replace(keys)


def _mixed(draw: Draw) -> Scenario:
    keys = {**_drive(draw), **_contact(draw), **_effects(draw, draw.whole(1, 4))}
    return Scenario().replace({**keys, **(_across(draw) if draw.chance(0.4) else {})})


def _shaken(draw: Draw) -> Scenario:
    pulsed = _drive(draw)
    still = {"drive.mode": "none", "drive.pulses": 12, "drive.direction": draw.word("+x", "-x")}
    shake = {
        "shake.frequency": draw.uniform(30.0, 300.0),
        "shake.amplitude_x": draw.uniform(-3e-5, 3e-5),
        "shake.amplitude_z": draw.uniform(0.0, 1e-5),
        "shake.phase": draw.uniform(-3.0, 3.0),
        "shake.harmonic_2_x": draw.uniform(0.0, 0.8),
        "shake.phase_2_x": draw.uniform(-3.0, 3.0),
        "shake.liquid": draw.word("moves", "rests"),
    }
    drive = pulsed if draw.chance(0.5) else still
    return Scenario().replace({**drive, **_contact(draw), **shake})


def _capsule(draw: Draw) -> Scenario:
    inner = {
        "inner.mass": draw.uniform(2e-9, 12e-9),
        "inner.stiffness": draw.uniform(0.005, 0.05),
        "inner.damping": draw.uniform(0.0, 5e-6),
        "inner.direction": draw.uniform(-1.5, 1.5),
        "inner.frequency": draw.uniform(50.0, 300.0),
        "inner.amplitude": draw.uniform(0.5e-7, 3e-7),
        "inner.duty": draw.uniform(0.1, 0.7) if draw.chance(0.4) else 0.0,
        "inner.stop_high": draw.uniform(1e-6, 1e-5),
        "inner.stop_low": draw.uniform(-1e-5, -1e-6),
        "inner.restitution": draw.uniform(0.0, 1.0) if draw.chance(0.7) else 0.0,
    }
    return _shaken(draw).replace(inner)


# With two for each effect, in one plane and in the whole, three hundred and those that are shaken.
_KINDS: dict[str, tuple[Callable[[Draw], Scenario], int]] = {
    "pack": (_pack, 42),
    "program": (_program, 30),
    "map": (_of_map, 20),
    "start": (_start, 12),
    "own": (_own, 10),
    "long": (_long, 6),
    "failure": (_failure, 12),
    "mixed": (_mixed, 92),
    "shaken": (_shaken, 12),
    "capsule": (_capsule, 12),
}


def _made(name: str, make: Callable[[Draw], Scenario]) -> Scenario:
    """The first of a few draws that is allowed; effects exclude each other in places."""
    for attempt in range(20):
        try:
            return make(Draw(f"{name}/{attempt}"))
        except ScenarioError:
            continue
    raise AssertionError(f"{name}: no draw is allowed")


def register_own_effect() -> None:
    """The force that scenarios of the kind `own` have; the same again is fine."""
    parameters = [
        EffectParameter(name="drag", unit="N s/m", low=0.0, high=1e308, meaning="linear drag"),
        EffectParameter(name="pull", unit="N/T", low=0.0, high=1.0, meaning="pull of the field"),
    ]
    register_effect(OWN_NAME, _wrench, parameters, meaning="an effect of frozen runs")


def scenarios() -> dict[str, Scenario]:
    """All scenarios by name. The effect of one's own has to be registered."""
    result = {}
    for row, across in itertools.product(effect_table.rows(), (False, True)):
        if row not in effect_table.OWN and (across or row not in effect_table.ACROSS):
            name = f"effect/{row}{'/whole plane' if across else ''}"
            make = functools.partial(_effect, name=row, across=across)
            result[name] = _made(name, make)
    for kind, (make, count) in _KINDS.items():
        for number in range(count):
            result[f"{kind}/{number}"] = _made(f"{kind}/{number}", make)
    return result
