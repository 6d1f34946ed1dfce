"""The simulator's laws of a free shape as causes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.prior import Prior
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import SHAPES, Curve
from stickslip.diagnosis.terms.laws import made_law
from stickslip.scenario.keys import LAWS, PREFIX, Value, known_keys
from stickslip.scenario.law import Law, flat_laws, law_lines
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import simulate_batch

# The simulator's own laws: what they are is the core's, see the page on named effects.
_PLACES = {
    "free_friction_speed": ("friction", "slip speed", "sliding_friction"),
    "free_friction_angle": ("friction", "pitch", "friction"),
    "free_friction_load": ("friction", "normal force", "friction"),
    "free_friction_age": ("friction", "time", "friction"),
    "free_adhesion_angle": ("adhesion", "pitch", "adhesion"),
    "free_adhesion_age": ("adhesion", "age of the contact", "adhesion"),
    "free_contact_place": ("contact place", "pitch", ""),
    "free_drag_angle": ("drag", "pitch", "drag"),
    "free_drag_speed": ("drag", "speed", "drag"),
    "free_drag_rate": ("drag", "rate of the pitch", "fluid"),
    "free_field_time": ("field", "time", ""),
    "free_field_frequency": ("field", "frequency", ""),
    "free_field_amplitude": ("field", "in-plane current", ""),
}
"""Law and argument in words, and the quantity of ``[laws.NAME]``; those without are effects."""
_OF_LOAD = "gaussian", "exponential", "saturation"
"""Forms over the load, as that of an impact has no bound."""

_CONSTANTS = {
    "friction": "contact.kinetic_friction",
    "adhesion": "contact.adhesion",
    "drag": "drag.linear",
}

_ARGUMENTS = {
    "slip speed": ("m/s", "slip_speed"),
    "pitch": ("rad", "tilt"),
    "normal force": ("N", "load"),
    "time": ("s", "time"),
    "age of the contact": ("s", "age"),
    "speed": ("m/s", "speed"),
    "rate of the pitch": ("rad/s", "rate"),
    "frequency": ("Hz", ""),
    "in-plane current": ("A", ""),
}
"""Unit of an argument, and its word in ``[laws.NAME]``."""

_FACTOR_SIZE, _PLACE_SIZE = (0.3, 3.0), (0.2, 1.0)
"""Usual and largest f of a factor 1 + f, and of the contact's place in half lengths. Chosen: a
third of a law, and three times it; a tenth of the body, and no farther than its middle."""

_SAMPLES = 400.0
"""Samples a pulse of the runs that show how far arguments reach. Chosen: the rocking is seen."""

_WITHIN = 0.98
"""Share of an argument's sum over the samples up to which there are knots. Chosen: with all, an
instant of an impact would stretch the curve."""

_LEAST_PITCH, _MOST_PITCH = 1e-2, 3.2
"""Largest place of a knot over the pitch, rad: what the core allows."""

_POINTS = 61
"""Points among which a knot's place is sought: a multiple of the knots' spacings."""


def laws(
    scenario: Scenario, uncertain: Mapping[str, Prior], spans: Mapping[str, float]
) -> tuple[Cause, ...]:
    """The simulator's laws of a free shape whose arguments reach as far as these spans.

    Together they have the prior odds of one cause. `scenario` is the recalibrated model. The
    constant of a law is relaxed with it, if `uncertain` has its dotted key. `spans` are those of
    `find_spans`: by effect, in the argument's unit.
    """
    odds = 1.0 / max(len(spans), 1)
    return tuple(_own_law(scenario, uncertain, *span, odds) for span in spans.items())


def _own_law(
    scenario: Scenario, uncertain: Mapping[str, Prior], effect: str, span: float, odds: float
) -> Cause:
    law, argument, _ = _PLACES[effect]
    statement = _Statement(_fixed(effect, span))
    keys = [f"{statement.section}.knot_{k}" for k in range(1, 6)]
    is_place = law == "contact place"
    constant = _CONSTANTS.get(law)
    low = -span if argument == "pitch" else 0.0
    points = np.linspace(low, span, _POINTS)
    design = partial(
        _design, scenario.replace(statement.fixed | dict.fromkeys(keys, 0.0)), effect, keys
    )
    own_unit = "of the model's" if constant is None else known_keys()[constant].unit
    curve = Curve(
        law=law,
        argument=argument,
        unit=_ARGUMENTS[argument][0],
        law_unit="half lengths" if is_place else own_unit,
        low=low,
        high=span,
        places=points[np.argmax(design(points), axis=0)],
        design=design,
        constant=constant if constant in uncertain else None,
        stated=float(not is_place) if constant is None else float(scenario.get(constant)),
        relative=not is_place,
        statement=statement,
    )
    size, largest = _PLACE_SIZE if is_place else _FACTOR_SIZE
    return made_law(curve.name, curve, keys, "-", size, -1.0, largest, odds)


@dataclass(frozen=True)
class _Statement:
    """A law of the simulator: a section of ``[laws]``, or an effect."""

    fixed: dict[str, Value]

    @property
    def section(self) -> str:
        return next(iter(self.fixed)).rpartition(".")[0]

    @property
    def _words(self) -> dict[str, Value]:
        return {key.rpartition(".")[2]: value for key, value in self.fixed.items()}

    @property
    def forms(self) -> tuple[str, ...]:
        over = self._words.get("over")  # laws that are effects have none
        return () if over is None else _OF_LOAD if over == "load" else tuple(SHAPES)

    def in_form(self, form: str, scale: float | None) -> _Statement:
        section = f"{LAWS}{self.section.split('.')[1].removeprefix('free_')}_{form}"
        fixed: dict[str, Value] = {f"{section}.form": form}
        fixed |= {f"{section}.{key}": self._words[key] for key in ("quantity", "over")}
        return _Statement(fixed if scale is None else fixed | {f"{section}.scale": scale})

    def lines(self, numbers: Mapping[str, float]) -> list[str]:
        rounded = {key.rpartition(".")[2]: float(f"{value:.4g}") for key, value in numbers.items()}
        given = {**self._words, **rounded}
        if not self.section.startswith(LAWS):
            return [f"[{self.section}]", *(f"{key} = {value}" for key, value in given.items())]
        knots = [given.pop(key) for key in list(given) if key.startswith("knot_")]
        law = Law(**given, knots=knots or None)  # type: ignore[arg-type]
        return law_lines(self.section.removeprefix(LAWS), law)[1:]


def _fixed(effect: str, span: float) -> dict[str, Value]:
    """Further values of a law, by dotted key."""
    _, argument, quantity = _PLACES[effect]
    if not quantity:
        return {f"{PREFIX}{effect}.span": span}
    law = Law(
        quantity=quantity, over=_ARGUMENTS[argument][1], form="curve", fraction=1.0, scale=span
    )
    return flat_laws({effect: law})


def _design(scenario: Scenario, effect: str, keys: Sequence[str], argument: Array) -> Array:
    """The share of each knot in the curve of the core, shape (*argument.shape, knots)."""
    flat = np.ravel(argument)
    ones = [scenario.replace({key: 1.0}).to_core().free_curve(effect, flat) for key in keys]
    return np.stack(ones, axis=1).reshape(*np.shape(argument), len(keys))


def find_spans(scenarios: Sequence[Scenario], threads: int) -> dict[str, float]:
    """How far the argument of each law reaches in runs of the recalibrated model, by effect.

    A law is left out if its argument does not vary between or within the runs, or if the model
    does not have it at all.
    """
    rates = [{"record.rate": _SAMPLES * scenario.drive.frequency} for scenario in scenarios]
    recorded = [scenario.replace(rate) for scenario, rate in zip(scenarios, rates, strict=True)]
    runs = [run for run in simulate_batch(recorded, threads=threads) if run.ok]
    if not runs:
        return {}

    def joined(name: str) -> Array:
        return np.concatenate([getattr(run, name) for run in runs])

    currents = np.concatenate([run.current[:, :4] for run in runs])
    frequencies = np.array([scenario.drive.frequency for scenario in scenarios])
    # Arguments that do not vary within a run reach about as far as the largest.
    arguments = {
        "slip speed": joined("slip_velocity"),
        "pitch": joined("theta"),
        "normal force": joined("normal_force"),
        "time": np.array([run.t[-1] for run in runs]),
        # A contact lasts a run at most, and mostly about a pulse.
        "age of the contact": 1.0 / frequencies,
        "speed": np.hypot(joined("vx"), joined("vz")),
        "rate of the pitch": joined("omega"),
        "frequency": frequencies if np.ptp(frequencies) > 0.0 else np.zeros(1),
        "in-plane current": np.linalg.norm(currents, axis=1),
    }
    spans = {}
    for effect, (law, argument, _) in _PLACES.items():
        values = np.abs(arguments[argument])
        values = np.sort(values[values > 0.0])  # nothing slips in flight
        if len(values) and (law != "adhesion" or scenarios[0].contact.adhesion > 0.0):
            # A robot that mostly creeps does most of its way, and of its turning, fast.
            part = np.cumsum(values) / np.sum(values)
            reach = float(values[np.searchsorted(part, _WITHIN)])
            spans[effect] = (
                min(max(reach, _LEAST_PITCH), _MOST_PITCH) if argument == "pitch" else reach
            )
    return spans


def fixed_numbers(causes: Iterable[Cause]) -> dict[str, float]:
    """Further values of the simulator's laws, by dotted key, words by their place.

    It has to be set wherever one of their parameters is.
    """
    return {
        key: float(known_keys()[key].words.index(value) if isinstance(value, str) else value)
        for law in causes
        if law.curve is not None and law.curve.statement is not None
        for key, value in law.curve.statement.fixed.items()
    }
