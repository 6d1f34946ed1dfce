"""Every effect of the package, alone and in pairs, on short drives.

The rows come from the list of the package's effects, so that a new effect is among them by itself.
`ways_to_run.py` computes them in every way that there is.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from free_shapes import LAWS, SHAPES, shaped
from measured_maps import formula_fields, grid
from stickslip import (
    COIL_NAMES,
    STATE_COLUMNS,
    Accelerations,
    Coil,
    EffectParameter,
    FieldMap,
    Forces,
    Run,
    Scenario,
    ScenarioError,
    Waveform,
    _core,
    effects,
    register_effect,
    simulate_batch,
)
from stickslip.scenario.keys import Key, known_keys, until_registration

Keys = Mapping[str, Any]

# ---- rows: effects, each with values at which it acts

# Of a parameter that is zero by default: what the robot of Table II on its drive notices, by unit.
# A time that is a power of two keeps the times of steps exact.
SIZES = {
    "-": 0.15, "rad": 0.05, "T": 1e-4, "V": 15.0, "s": 2.0**-10, "m/s": 5e-3, "s/m": 20.0,
    "1/W": 0.05, "N s^2/m^2": 1e-3, "N m s": 1e-13,
}  # fmt: skip
# Where the unit does not tell the size.
CHOSEN: dict[str, float | None] = {
    "effects.angle_adhesion.strength": 0.9,
    "effects.angle_drag.strength": 20.0,
    "effects.gradient_scale.fraction": 1.0,
    # Its multiples are not the ends of pulses.
    "effects.sample_hold.period": 1.1e-3,
    # Across the plane of motion: in rows of their own.
    "effects.ambient_field.By": None,
    "effects.surface_tilt.azimuth": None,
}
ACROSS = {
    "ambient_field across": {"effects.ambient_field.By": 1e-4},
    "surface_tilt across": {
        "effects.surface_tilt.angle": 0.05,
        "effects.surface_tilt.azimuth": 1.0,
    },
}
# Of a free shape, neither symmetric nor monotonic, and not zero where the argument is.
KNOTS = {"knot_1": 0.15, "knot_2": -0.1, "knot_3": 0.05, "knot_4": 0.2, "knot_5": -0.15}
LONG = {"free_friction_age": 1.0}  # s, of the last knot
OWN_COIL = 0.9  # values of one coil over those of all

OWN = ("own_compiled", "own_python")


def size_of(key: Key) -> float | None:
    """Value at which a parameter acts; None for one that only shapes the effect of another."""
    _, effect, name = key.name.split(".")
    if key.name in CHOSEN:
        return CHOSEN[key.name]
    if effect in OWN:
        return 0.5 * key.high
    if name in KNOTS:
        return KNOTS[name]
    if key.default != 0.0:
        return None
    return float(np.clip(SIZES[key.unit], key.low, key.high))


@until_registration
def rows() -> dict[str, dict[str, Any]]:
    """Dotted keys and values of each effect, and of those that push the robot across."""
    result: dict[str, dict[str, Any]] = {}
    own: dict[str, dict[str, Any]] = {}
    others = set(_core.registered_effects()) - set(OWN)
    for effect in effects():
        if effect.name not in others:
            sizes = {key.name: size_of(key) for key in effect.parameters}
            acting = {name: size for name, size in sizes.items() if size is not None}
            (own if effect.name in OWN else result)[effect.name] = acting
    knots = tuple(KNOTS.values())
    free = {
        name: shaped(name, knots, LONG.get(name)) if name in LAWS else result.pop(name)
        for name in SHAPES
    }
    # Last, so that all else is the same in a process that does not know them.
    return {**result, **_coils(), **free, **ACROSS, **own}


def _coils() -> dict[str, dict[str, float]]:
    """Each coil with other values than all; named as the frozen runs are."""
    return {
        f"coil_{coil}": {
            key.name: OWN_COIL * float(key.default)
            for key in known_keys().values()
            if key.section == f"coil.{coil}"
        }
        for coil in COIL_NAMES
    }


# What is no effect, and takes other ways through the program: bounces, long slides, impulses that
# stop a slide without a solution, steps of an upper limit, currents that swing, a late field.
HARD: dict[str, dict[str, Any]] = {
    "rebounds": {"contact.restitution": 0.6, "drag.linear": 1e-6},
    "slides": {"contact.static_friction": 0.05, "contact.kinetic_friction": 0.05,
               "drive.peak": 5e-3},
    "jams": {"contact.static_friction": 2.45, "contact.kinetic_friction": 0.39,
             "effects.stribeck_friction.velocity": 23.9e-3, "drive.mode": "OPP",
             "drive.peak": 3.7e-3, "drive.hold": 3.2e-3},
    "short steps": {"solver.max_step": 2e-5},
    "shaken": {"shake.frequency": 128.0, "shake.amplitude_x": 20e-6, "shake.harmonic_2_x": 0.4,
               "shake.phase_2_x": 1.0},
    "shaken liquid rests": {"shake.frequency": 256.0, "shake.amplitude_x": -6e-6,
                            "shake.amplitude_z": 3e-6, "shake.phase": 0.8,
                            "shake.harmonic_3_z": 0.2, "shake.liquid": "rests"},
    "capsule": {"inner.mass": 10e-9, "inner.stiffness": 0.02, "inner.damping": 2e-6,
                "inner.frequency": 256.0, "inner.amplitude": 1.2e-7, "inner.harmonic_2": 0.5,
                "inner.phase_2": 1.0},
    "capsule with stops": {"inner.mass": 5e-9, "inner.stiffness": 0.01, "inner.direction": 0.4,
                           "inner.frequency": 128.0, "inner.amplitude": 1e-7, "inner.duty": 0.3,
                           "inner.stop_low": -4e-6, "inner.stop_high": 6e-6,
                           "inner.restitution": 0.5},
    "hammer on a shaken surface": {"inner.mass": 8e-9, "inner.stiffness": 0.05,
                                   "inner.damping": 5e-6, "inner.direction": 1.3,
                                   "inner.frequency": 128.0, "inner.amplitude": -2e-7,
                                   "inner.stop_high": 2e-6, "shake.frequency": 128.0,
                                   "shake.amplitude_x": 8e-6, "shake.amplitude_z": 2e-6},
    "capsule by rows": {
        "inner.mass": 8e-9,
        "inner.stiffness": 0.02,
        "inner.damping": 2e-6,
        "inner.stop_high": 5e-6,
        "inner.forces": Forces([[0.0, 2e-7], [2.0**-9, -1e-7], [2.0**-8, -5e-8], [2.0**-7, 1e-7]]),
    },
    "shaken by rows": {
        "shake.accelerations": Accelerations(
            [[0.0, 9.0, 1.0], [2.0**-9, -14.0, -2.0], [2.0**-8, 3.0, 0.0], [2.0**-7, 2.0, 4.0]]
        )
    },
    # A clamp that rings; the other coils keep the field along the surface.
    "capacitors": {"coil.capacitance": 0.5, "coil.clamp.capacitance": 1e-3},
    "late": {"drive.latency": 2.0**-7},
}  # fmt: skip
# Only of runs of a whole drive, to the bit: the first ends before it, the other steps otherwise.
WHOLE = {"few steps": {"solver.max_steps": 300}, "arkode": {"solver.method": "arkode"}}


def keys_of(name: str) -> Keys:
    """Dotted keys and values of an effect, or of what is none."""
    return {**HARD, **WHOLE}.get(name) or rows()[name]


def register_own_effects() -> None:
    """One force in two languages; unknown to the table until it is registered."""
    import own_effects  # compiles; processes that are after packs alone do without

    parameters = [
        EffectParameter(name="drag", unit="N s/m", low=0.0, high=1e-5, meaning="linear drag"),
        EffectParameter(name="pull", unit="N/T", low=0.0, high=4e-5, meaning="pull of the field"),
    ]
    for name, function in zip(
        OWN, (own_effects.numba_wrench, own_effects.python_wrench), strict=True
    ):
        register_effect(name, function, parameters, meaning="an effect of the table")


# ---- drives


@dataclass(frozen=True)
class Setting:
    """A drive of the table.

    keys: by dotted key. field_map: in place of the coils' formula. across: whether its runs may
    leave the plane of motion; not where the field of a map is unknown beside it, or where the
    field of the drive passes through zero, after which nobody knows the heading.
    """

    keys: Keys
    field_map: FieldMap | None = None
    across: bool = True


# The times of steps are exact: powers of two. Three pulses settle, the others are measured.
PULSED = {"drive.frequency": 128.0, "drive.ramp": 2.0**-4, "drive.pulses": 7}
IPP = {**PULSED, "drive.mode": "IPP", "drive.base": 0.5e-3}
OPP = {**PULSED, "drive.mode": "OPP", "drive.base": 0.0, "drive.hold": 2.5e-3}
UNEQUAL = {
    "coil.xp.turns": 480.0, "coil.xm.turns": 400.0, "coil.xm.resistance": 9.0,
    "coil.yp.distance": 0.11, "coil.clamp.inductance": 0.08,
}  # fmt: skip
BACK = {"drive.direction": "-x"}
STEP = 2.0**-7  # s, of the program


def _linear(points: list[list[float]]) -> Waveform:
    return Waveform.from_points(STEP * np.arange(len(points)), points)


@functools.cache
def reversing(pair: bool = False) -> Waveform:
    """Voltages that reverse within their segments, which are short beside L / R; so does the field.

    pair: with opposite voltages of the coils of y, which as equal coils make a gradient alone.
    """
    y = 6.0 if pair else 0.0
    points = [[0.0] * 5, [20.0, -6.0, y, -y, -14.0]]
    for tooth in range(6):
        points += [[-14.0 + tooth, 5.0, -y, y, -12.0], [24.0, -4.0, y, -y, -16.0 + 2.0 * tooth]]
    return _linear([*points, points[-1]])


@functools.cache
def steering() -> Waveform:
    """All five coils; single voltages reverse, and the field turns slowly to the left and back."""
    # The field rises so slowly that an ambient one across it turns the robot no faster than it can.
    points = [[3.0 * k, 0.8 * k, 0.1 * k, -0.1 * k, -3.5 * k] for k in range(5)]
    for tooth in range(5):
        y = 2.0 * math.sin(tooth)
        points += [[6.0, 4.0, y, 0.5 - y, -12.0], [24.0, -4.0, y, y, 6.0 - 4.0 * tooth]]
    return _linear(points)


# Of the coils of a map over those of Table I.
STRENGTHS = np.array([0.92, 1.1, 1.05, 0.97, 1.03])
BOX = (6e-3, 3e-3, 3e-3), (7, 5, 5)
SLICE = (6e-3, 0.0, 3e-3), (7, 1, 5)
# Of a world that is turned by pi about z.
TURNED_COILS = {"xp": "xm", "xm": "xp", "yp": "ym", "ym": "yp", "clamp": "clamp"}


@functools.cache
def field_map(box: tuple[tuple[float, ...], tuple[int, ...]], turned: bool = False) -> FieldMap:
    """A measured map of unequal coils, or that of the same coils turned by pi about z."""
    points = grid(*box)
    fields = STRENGTHS[:, None] * formula_fields(points)
    if turned:
        half_turn = np.array([-1.0, -1.0, 1.0])
        # The coil that was ahead is behind, and a positive current still makes a field along +x.
        order = [COIL_NAMES.index(name) for name in TURNED_COILS.values()]
        signs = np.array([-1.0, -1.0, -1.0, -1.0, 1.0])[:, None]
        return FieldMap.from_points(points * half_turn, (fields * half_turn * signs)[:, order])
    return FieldMap.from_points(points, fields)


@functools.cache
def settings() -> dict[str, Setting]:
    """The drives by name."""

    def played(waveform: Waveform) -> dict[str, Any]:
        return {"drive.mode": "program", "drive.program": waveform}

    slice_, box = field_map(SLICE), field_map(BOX)
    back_unequal = {**BACK, **UNEQUAL}
    # Every third is simulated in both planes.
    return {
        "ipp": Setting(IPP),
        "program": Setting(played(reversing(pair=True)), across=False),
        "map across back": Setting({**IPP, **BACK}, box),
        "opp back unequal": Setting({**OPP, **back_unequal}),
        "steered": Setting({**IPP, "drive.heading": -0.5}),
        "program back unequal": Setting(
            {**played(reversing().turned()), **back_unequal}, across=False
        ),
        "opp": Setting({**OPP, "drive.edge": "fall", "drive.base": 0.3e-3}),
        "map": Setting({**IPP, "drive.hold": 1.2e-3}, slice_, across=False),
        "steering program": Setting({**played(steering()), **UNEQUAL}),
        "ipp back unequal": Setting({**IPP, **back_unequal}),
        "program back on a map": Setting(
            {**played(reversing().turned()), **BACK}, slice_, across=False
        ),
        "steering program back on a map": Setting({**played(steering().turned()), **BACK}, box),
    }


@functools.cache
def _base(drive: str) -> Scenario:
    setting = settings()[drive]
    return Scenario(coil=Coil(map=setting.field_map)).replace(setting.keys)


# ---- cases

# Fields across (T) that take a run into the whole plane, beside the 2 mT of the drives. Pushed by
# the first, a slip that reverses goes through zero; by the second it passes beside zero, with some
# 1e-8 m/s across. The motion along x differs by the square of the heading, 1e-11.
PUSHES = (1e-15, 1e-8)


@dataclass(frozen=True)
class Case:
    """Effects on a drive. push: T, one of `PUSHES`, or zero without one."""

    effects: tuple[str, ...]
    drive: str
    push: float = 0.0

    def __str__(self) -> str:
        names = " + ".join(self.effects) or "nothing"
        return f"{names} on {self.drive}{f', pushed by {self.push} T' if self.push else ''}"

    @property
    def planar(self) -> Case:
        """The same without a push."""
        return Case(self.effects, self.drive)

    @property
    def keys(self) -> dict[str, Any]:
        """Values of its effects by dotted key."""
        return {key: value for name in self.effects for key, value in keys_of(name).items()}

    @functools.cached_property
    def scenario(self) -> Scenario:
        """Scenario of the case."""
        push = {"effects.ambient_field.By": self.push} if self.push else {}
        return _base(self.drive).replace({**self.keys, **push})

    @property
    def is_own(self) -> bool:
        """Whether one of the effects is the user's."""
        return any(name in OWN for name in self.effects)


def _fits(case: Case) -> bool:
    try:
        return not case.scenario.whole_plane or (settings()[case.drive].across and not _fades(case))
    except ScenarioError:  # a coil's geometry beside a map, an effect of one's own across
        return False


def _fades(case: Case) -> bool:
    """Whether the field passes through zero, which loses the heading in the whole plane.

    An ambient field along +x is there before the currents of a drive to -x rise.
    """
    return "ambient_field" in case.effects and case.scenario.drive.direction == "-x"


def _with_pushed(case: Case) -> Iterator[Case]:
    yield case
    shaken = any(key.startswith(("shake.", "inner.")) for key in case.keys)
    leaves = settings()[case.drive].across and not (case.scenario.whole_plane or shaken)
    if leaves and not _fades(case) and not case.is_own:
        yield from (Case(case.effects, case.drive, push) for push in PUSHES)


def cases_of(chosen: Iterable[tuple[str, ...]], drives: int) -> list[Case]:
    """Cases of combinations of effects, each on some of the drives that follow each other.

    Which, its place among the effects decides; what does not fit on a drive goes to the next.
    """
    names = list(settings())
    result: list[Case] = []
    places = {name: place for each in (rows(), HARD) for place, name in enumerate(each)}
    for combination in chosen:
        # Effects of one's own in Python take ten times as long.
        wanted = 1 if "own_python" in combination else drives
        start = 5 * sum(places[name] for name in combination) % len(names)
        turn = (Case(combination, name) for name in (names[start:] + names[:start]))
        fitting = list(itertools.islice(filter(_fits, turn), wanted))
        assert len(fitting) == wanted, f"{combination}: too few drives can have it"
        for case in fitting:
            result += _with_pushed(case)
    return result


SEED = 20261125
PAIRS_OF_A_TEST, WITH_OWN = 12, 2
# How many of the drives an effect is on, and a pair: one of any three is simulated in both planes.
DRIVES, DRIVES_OF_A_PAIR = 7, 3
# They meet in one formula.
MEETING = [
    ("friction_patches", "free_contact_place"),
    ("misalignment", "free_contact_place"),
    ("stribeck_friction", "free_friction_speed"),
    ("angle_adhesion", "free_adhesion_angle"),
    ("adhesion_ageing", "free_adhesion_age"),
    ("angle_drag", "free_drag_angle"),
    ("gradient_scale", "misalignment"),
    ("eddy_lag", "mutual_inductance"),
    ("sample_hold", "amplifier_limit"),
]


def all_pairs() -> tuple[list[tuple[str, ...]], list[tuple[str, ...]]]:
    """Pairs of effects, and those with one of the user's, which has no force across."""
    pairs = [
        pair
        for pair in itertools.combinations(rows(), 2)
        if not set(rows()[pair[0]]) & set(rows()[pair[1]])  # two variants of one
        and not (set(pair) & set(OWN) and set(pair) & set(ACROSS))
    ]
    return (
        [pair for pair in pairs if not set(pair) & set(OWN)],
        [pair for pair in pairs if set(pair) & set(OWN)],
    )


def cases(choice: str) -> list[Case]:
    """``singles``, the ``pairs`` of `make test`, ``all`` pairs, or single effects: ``a,b,c``."""
    plain = [case for name in settings() for case in _with_pushed(Case((), name))]
    if choice == "singles":
        hard = cases_of(((name,) for name in HARD), DRIVES_OF_A_PAIR)
        return plain + cases_of(((name,) for name in rows()), DRIVES) + hard
    pairs, with_own = all_pairs()
    if choice not in ("pairs", "all"):
        # Effects of the user come last, which the processes of packs do not know.
        names = sorted(set(choice.split(",")) - {"nothing"}, key=lambda name: (name in OWN, name))
        assert set(names) <= {*rows(), *OWN}, f"{choice}: allowed are {', '.join(rows())}"
        return plain + cases_of(((name,) for name in names if name in rows()), DRIVES)
    if choice == "pairs":
        drawn = _some([pair for pair in pairs if pair not in MEETING], PAIRS_OF_A_TEST)
        pairs, with_own = [*MEETING, *drawn], _some(with_own, WITH_OWN)
    return plain + cases_of([*pairs, *with_own], DRIVES_OF_A_PAIR)


def to_the_bit(choice: str) -> list[Case]:
    """The cases of a choice, and those that only ways with the same bits can have."""
    whole = [Case((name,), "opp") for name in WHOLE] if choice == "singles" else []
    return cases(choice) + whole


def _some(pairs: list[tuple[str, ...]], count: int) -> list[tuple[str, ...]]:
    picks = np.random.default_rng(SEED).choice(len(pairs), min(count, len(pairs)), replace=False)
    return [pairs[pick] for pick in picks]


# ---- what a run says


def said(run: Run) -> dict[str, str]:
    """Everything that a run sums up, to the last bit: numbers as their shortest exact text."""
    result = {"status": run.status}
    for name, value in run.summary().items():
        parts = value.items() if isinstance(value, Mapping) else [("", value)]
        result.update({f"{name} {part}".strip(): repr(number) for part, number in parts})
    state = zip(STATE_COLUMNS, run.final_state.row, strict=True)
    return result | {f"final {name}": repr(value) for name, value in state}


def first_difference(found: Mapping[str, str], expected: Mapping[str, str]) -> str:
    """In words, the first number that differs; "" for none."""
    for name, value in expected.items():
        if found.get(name) != value:
            return f"{name} = {found.get(name)} instead of {value}"
    return ""


class Table:
    """Cases, and how each is simulated alone, with which all other ways have to agree."""

    def __init__(self, choice: str) -> None:
        self.choice = choice
        self.cases, self.to_the_bit = cases(choice), to_the_bit(choice)
        # One by one: a batch of four would be a pack.
        self.alone = {
            case: simulate_batch([case.scenario], threads=1)[0] for case in self.to_the_bit
        }

    @functools.cached_property
    def said(self) -> dict[Case, dict[str, str]]:
        """Exact summary, as `said` has it, of the run of each case alone."""
        return {case: said(run) for case, run in self.alone.items()}

    def scale(self, drive: str) -> float:
        """Velocity of a drive without effects, m/s, which differences are relative to."""
        plain = self.alone[Case((), drive)]
        return math.hypot(plain.mean_velocity, across(plain))

    def compare(self, runs: Iterable[Run], chosen: Iterable[Case]) -> Iterator[str]:
        """Differences of runs from those alone, to the last bit."""
        for case, run in zip(chosen, runs, strict=True):
            what = first_difference(said(run), self.said[case])
            if what:
                yield f"{case}: {what}"


def across(run: Run) -> float:
    return float(run.summary().get("mean_velocity_y") or 0.0)
