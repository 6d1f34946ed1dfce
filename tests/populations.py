"""Populations of random scenarios, as Hypothesis strategies.

`PAPER`   near the paper's: what it states is drawn within a factor of about two.
`WIDE`    the paper's robot and coils over wide ranges of drive, friction, adhesion, drag and
          restitution, none of the last three among them.
`WILD`    wide ranges of every key, with the corners of the model (no drag, no adhesion, no
          friction, elastic impacts, all named extensions) likely.
`EXTREME` any allowed value of any key, the ends of its range among them.
`USUAL`   one of the first three, as likely each.
"""

import json
import math
from functools import partial

import numpy as np
from hypothesis import strategies as st

from free_shapes import SHAPES, shaped
from stickslip import Robot, Scenario, ScenarioError, Waveform, effects
from stickslip.scenario.keys import known_keys
from stickslip.walker.library import known

# Of a recording of `EXTREME`: enough to be seen, and in no danger of filling the memory.
MOST_SAMPLES = 1e5
MOST_STEPS = 100_000


class Draw:
    """Draws by name of the distribution, from one seed.

    Hypothesis draws the seed alone: it would crowd numbers about zero and at the ends.
    """

    def __init__(self, seed):
        self.of = np.random.default_rng(seed)

    def uniform(self, low, high):
        """Uniform draw with both ends likely."""
        inside = low + (high - low) * self.of.random()
        return self.word(low, high, inside, inside, inside, inside)

    def decades(self, low, high):
        """Uniform in the logarithm."""
        return low * (high / low) ** self.of.random()

    def chance(self, probability):
        return self.of.random() < probability

    def word(self, *words):
        return words[self.of.integers(len(words))]

    def whole(self, low, high):
        return int(self.of.integers(low, high, endpoint=True))

    def corner(self, value, other, probability=0.2):
        """`value` with the probability, else `other`."""
        return value if self.chance(probability) else other


def words(draw):
    return {
        "drive.mode": draw.word("IPP", "OPP"),
        "drive.clamp": draw.word("down", "up"),
        "drive.edge": draw.word("rise", "fall"),
        "drive.direction": draw.word("+x", "-x"),
    }


def paper(draw):
    peak = draw.decades(1e-3, 6e-3)
    static = draw.decades(0.1, 0.4)
    keys = {
        **words(draw),
        "drive.frequency": draw.decades(5.0, 200.0),
        "drive.peak": peak,
        "drive.base": draw.corner(0.0, draw.uniform(0.0, 0.5) * peak),
        "drive.hold": draw.decades(0.5e-3, 5e-3),
        "drive.pulses": draw.whole(10, 20),
        "contact.static_friction": static,
        "contact.kinetic_friction": static * draw.uniform(0.6, 0.9),
        "contact.adhesion": draw.decades(0.11e-6, 0.44e-6),
        "drag.linear": draw.decades(0.5e-5, 2e-5),
        "drag.rotational": draw.decades(4.5e-17, 18e-17),
    }
    return Scenario().replace(keys)


def wide(draw):
    base = draw.uniform(-0.5e-3, 1.5e-3)
    static = draw.decades(0.05, 2.0)
    keys = {
        **words(draw),
        "drive.frequency": draw.decades(2.0, 300.0),
        "drive.base": base,
        "drive.peak": max(base, 0.0) + draw.decades(0.5e-3, 5e-3),
        "drive.hold": draw.decades(0.5e-3, 3e-3),
        "drive.pulses": draw.whole(8, 20),
        "contact.static_friction": static,
        "contact.kinetic_friction": static * draw.uniform(0.5, 1.0),
        "contact.adhesion": draw.corner(0.0, draw.decades(1e-8, 1e-6)),
        "contact.restitution": draw.corner(0.0, draw.uniform(0.0, 0.9), 0.5),
        "drag.linear": draw.corner(0.0, draw.decades(1e-8, 1e-4)),
        "drag.rotational": draw.corner(0.0, draw.decades(1e-18, 1e-15)),
    }
    return Scenario().replace(keys)


def wild(draw):
    frequency = draw.decades(1.0, 1e3)
    base = draw.corner(0.0, draw.uniform(-2e-3, 5e-3))
    static = draw.corner(0.0, draw.decades(0.01, 10.0), 0.1)
    keys = {
        **words(draw),
        "drive.coils": draw.word("single", "pairs"),
        "drive.frequency": frequency,
        "drive.base": base,
        "drive.peak": max(base, 0.0) + draw.decades(1e-4, 1e-2),
        "drive.hold": draw.corner(0.0, draw.decades(1e-4, 1e-2)),
        "drive.edge_time": draw.corner(0.0, draw.uniform(0.0, 0.5) / frequency, 0.7),
        "drive.ramp": draw.corner(0.0, draw.decades(1e-3, 0.1)),
        "drive.ramp_down": draw.corner(0.0, draw.decades(1e-3, 0.1), 0.7),
        "drive.pulses": draw.whole(1, 12),
        "contact.static_friction": static,
        "contact.kinetic_friction": static * draw.corner(1.0, draw.uniform(0.0, 1.0)),
        "contact.adhesion": draw.corner(0.0, draw.decades(1e-9, 1e-5)),
        "contact.restitution": draw.corner(0.0, draw.corner(1.0, draw.uniform(0.0, 1.0), 0.1), 0.5),
        "contact.tangential_restitution": draw.corner(0.0, draw.uniform(0.0, 1.0), 0.7),
        "drag.linear": draw.corner(0.0, draw.decades(1e-8, 1e-3)),
        "drag.rotational": draw.corner(0.0, draw.decades(1e-19, 1e-12)),
        "environment.gravity": draw.corner(9.81, draw.corner(0.0, draw.decades(0.1, 100.0)), 0.8),
    }
    if draw.chance(0.2):
        keys["solver.rtol"] = draw.decades(1e-10, 1e-4)
    if draw.chance(0.3):
        keys.update(wild_body(draw, keys))
    if draw.chance(0.3):
        keys.update(wild_coils(draw))
    if draw.chance(0.15):
        keys = {key: value for key, value in keys.items() if not key.startswith("drive.")}
        keys.update(wild_program(draw))
    if draw.chance(0.15):
        keys.update(wild_plane(draw, keys))
    for name in draw.of.permutation(list(EFFECTS))[: draw.whole(0, 3)]:
        drawn = EFFECTS[name](draw)
        keys.update(drawn if name in SHAPES else {f"effects.{name}.{k}": drawn[k] for k in drawn})
    keys = allowed_together(keys)
    return Scenario().replace(keys)


def wild_body(draw, keys):
    """A body of another size, in a fluid that damps it as much in its own time."""
    length = draw.decades(2e-5, 2e-3)
    width, height = (length * draw.decades(0.1, 3.0) for _ in range(2))
    mass = length * width * height * draw.decades(1e3, 1e4)
    usual = Robot()
    heavier = mass / usual.mass
    larger = (length**2 + height**2) / (usual.length**2 + usual.height**2)
    return {
        "drag.linear": keys["drag.linear"] * heavier,
        "drag.rotational": keys["drag.rotational"] * heavier * larger,
        "contact.adhesion": keys["contact.adhesion"] * heavier,
        "robot.length": length,
        "robot.width": width,
        "robot.height": height,
        "robot.mass": mass,
        "robot.magnetization": draw.decades(1e4, 1.2e6),
    }


def wild_coils(draw):
    return {
        "coil.resistance": draw.decades(1.0, 100.0),
        "coil.inductance": draw.decades(1e-6, 1.0),
        "coil.side": draw.decades(0.05, 0.5),
        "coil.distance": draw.decades(0.04, 0.4),
        "coil.turns": draw.decades(50.0, 2000.0),
    }


def wild_program(draw):
    """Straight lines between random voltages, some of them jumps, played a few times."""
    count = draw.whole(2, 12)
    steps = [draw.corner(0.0, draw.decades(1e-4, 0.05), 0.3) for _ in range(count - 1)]
    steps[-1] = steps[-1] or draw.decades(1e-4, 0.05)
    for k in range(1, count - 1):  # a jump has two points at one time
        if steps[k - 1] == 0.0:
            steps[k] = steps[k] or draw.decades(1e-4, 0.05)
    times = np.concatenate([[0.0], np.cumsum(steps)])
    voltages = np.array([[draw.uniform(-60.0, 60.0) for _ in range(5)] for _ in range(count)])
    voltages *= [draw.whole(0, 1) for _ in range(5)]
    voltages[:, 3] = -voltages[:, 2]  # equal coils of y, which together have no field across
    waveform = Waveform([(times, voltages, draw.whole(1, 4))])
    return {
        "drive.mode": "program",
        "drive.program": waveform,
        "drive.direction": draw.word("+x", "-x"),
    }


def wild_plane(draw, keys):
    """Keys that take the robot out of one plane."""
    heading = "initial.heading" if "drive.program" in keys else "drive.heading"
    return {
        heading: draw.uniform(-math.pi, math.pi),
        "initial.y": draw.uniform(-1e-3, 1e-3),
        "effects.ambient_field.By": draw.corner(0.0, draw.uniform(-1e-3, 1e-3), 0.5),
        "effects.surface_tilt.azimuth": draw.uniform(-math.pi, math.pi),
    }


def acting(draw, name):
    """Values of a named extension at which it counts: about as far as a diagnosis looks."""
    values = {}
    for parameter, size in known()["causes"][name]["sizes"].items():
        if "middle" in size:
            values[parameter] = size["middle"] * draw.decades(1e-2, 1e2)
        elif "falls" in size:  # of the largest voltage, some 30 V
            values[parameter] = 30.0 * draw.decades(0.1 * size["low"], 3.0)
        elif size["low"] < 0.0:
            most = known_keys()[f"effects.{name}.{parameter}"].high
            values[parameter] = draw.uniform(size["low"], min(size["high"], most))
        else:
            values[parameter] = draw.decades(1e-2 * size["size"], size["high"])
    return values


EFFECTS = {
    **{each.name: partial(acting,
                          name=each.name) for each in effects() if each.name in known()["causes"]},
    **{
        name: lambda d, name=name, span=span: shaped(
            name, [d.uniform(-0.9, 2.0) for _ in range(5)], span * d.decades(0.1, 2.0)
        )
        for name, (span, _) in SHAPES.items()
        # A contact that rolls is in none of the laws; where friction depends on the load, a slip
        # may have several normal forces, or none.
        if name not in ("free_contact_place", "free_friction_load")
    },
}  # fmt: skip


# Each of them takes the robot out of one plane.
ACROSS = (
    *("drive.heading", "initial.heading", "initial.y", "initial.vy"),
    *("effects.ambient_field.By", "effects.surface_tilt.azimuth"),
)


def extreme(draw):
    keys = {}
    share = draw.uniform(0.0, 1.0)
    left_out = draw.word((), ACROSS)
    for key in known_keys().values():
        if key.section != "record" and key.name not in left_out and draw.chance(share):
            keys[key.name] = any_value(draw, key)
    if keys.get("drive.mode") == "program":
        keys = {key: value for key, value in keys.items() if not key.startswith("drive.")}
        keys.update(wild_program(draw))
    keys = allowed_together(keys)
    steps = min(keys.pop("solver.max_steps", MOST_STEPS), MOST_STEPS)
    # What the ranges of single keys do not say is refused; the refusal is a draw's end too, but
    # tells little: such keys are left out one by one.
    while True:
        try:
            made = Scenario().replace({**keys, "solver.max_steps": steps})
            rate = draw.word("none", "events", "grid")
            if rate == "grid":
                rate = draw.decades(1.0, MOST_SAMPLES) / max(made.duration, 1e-300)
            return made.replace({"record.rate": rate})
        except ScenarioError as error:
            named = [key for key in keys if key in str(error)]
            # Or their section.
            named = named or [key for key in keys if key.startswith(str(error).split(":")[0])]
            named = named or list(keys)
            if named:
                del keys[named[0]]
            else:
                steps = MOST_STEPS


# A key without an upper end gets this much, in its unit.
LARGE = 1e6


def any_value(draw, key):
    if key.kind == "word":
        return draw.word(*json.loads(f"[{key.allowed.removeprefix('one of ')}]"))
    low, high = key.low, key.high if math.isfinite(key.high) else LARGE
    if key.kind == "whole":
        choices = [low, high, draw.decades(max(low, 1.0), high), draw.uniform(1.0, 30.0)]
        return round(choices[draw.whole(0, 3)])
    above = math.nextafter(low, high)
    choices = [
        low if "from" in key.allowed else above,
        above,
        high,
        draw.uniform(low, high),
        draw.decades(max(abs(low), 1e-12 * high), high),
        float(key.default) * draw.decades(0.01, 100.0),
    ]
    return min(max(choices[draw.whole(0, 5)], choices[0]), high)


def allowed_together(keys):
    """The draws with what excludes each other brought into order."""
    result = dict(keys)

    def limit(key, most):
        if key in result:
            result[key] = min(result[key], most)

    def get(key):
        return result.get(key, known_keys()[key].default)

    limit("contact.kinetic_friction", get("contact.static_friction"))
    if get("contact.kinetic_friction") > get("contact.static_friction"):
        result["contact.kinetic_friction"] = get("contact.static_friction")
    if get("drive.mode") == "program":
        return result
    if get("drive.peak") < get("drive.base"):
        result["drive.peak"], result["drive.base"] = max(get("drive.base"), 0.0), get("drive.peak")
    period = 1.0 / get("drive.frequency")
    limit("drive.edge_time", 0.5 * period)
    if 0.0 < get("solver.max_step") < 1e-9:
        result["solver.max_step"] = 1e-9
    return result


def usual(draw):
    return draw.word(paper, wide, wild)(draw)


def population(make):
    return st.integers(0, 2**64 - 1).map(lambda seed: make(Draw(seed)))


PAPER, WIDE, WILD, EXTREME, USUAL = map(population, (paper, wide, wild, extreme, usual))
