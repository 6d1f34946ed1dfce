"""Laws of another shape as causes: those of the simulator, and those of a model of one's own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from stickslip._util.arrays import Array
from stickslip._util.messages import check_whole, meant, refuse, shown
from stickslip._util.text import is_number
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import CURVE, NEAREST, SHAPES, Curve
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import LAWS, PREFIX, Value, known_keys
from stickslip.scenario.law import Law, flat_laws
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.uncertain import Prior
from stickslip.simulation.simulate import simulate_batch

_LARGEST = 10.0
"""Largest value at a knot, in its usual size. Chosen: three times a law beside a third of it."""

_FEWEST = 3
"""Knots: with fewer nothing bends, and a parabola gives the slopes at the ends."""


def free_law(
    law: str,
    argument: str,
    unit: str,
    low: float,
    high: float,
    size: float = 0.3,
    law_unit: str = "-",
    largest: float | None = None,
    factor_of: str | None = None,
    knots: int = 5,
) -> Cause:
    """A place in a model of one's own where a law may have another shape.

    A curve f of one argument acts there, by its values at knots that lie evenly between two ends.
    Between them f is the cubic Hermite interpolant with slopes by central differences (at the ends
    those of the parabola through three knots), beyond them it is constant. What f does, such as a
    factor 1 + f or a force f, is up to the model, which finds it in `Curves` under the law's name.
    Where the law explains the data, its forms, such as a line or a saturation, compete with the
    curve.

    Parameters
    ----------
    law, argument : str
        In words: ``friction`` and ``speed`` make the name ``friction over speed``.
    unit : str
        Of the argument.
    low, high : float
        Argument of the first and the last knot: about what the data reach.
    size : float
        Size of f that would not surprise, above 0, in `law_unit`.
    law_unit : str
        Of f; beside `factor_of` only "-".
    largest : float, optional
        Largest size of f at a knot; ten times `size`, if not given.
    factor_of : str, optional
        The uncertain constant that the model multiplies by 1 + f. It is fitted with the law, whose
        drawing is their product: data often tell that better than each of them.
    knots : int
        3 or more. A law that bends within half their distance is missed.

    Raises
    ------
    ScenarioError
        If a value is not allowed.
    """
    texts = {"law": law, "argument": argument, "unit": unit, "law_unit": law_unit}
    for word, text in texts.items():
        if not isinstance(text, str) or not text:
            refuse(f"{word} of a free law", text, "a text")
    name = f"{law} over {argument}"

    def not_allowed(value: str, allowed: str) -> NoReturn:
        raise ScenarioError(f"free law {name}: {value}: allowed is {allowed}")

    if not all(is_number(end) and np.isfinite(end) for end in (low, high)) or not low < high:
        not_allowed(f"low = {shown(low)}, high = {shown(high)}", "numbers with low < high")
    if factor_of is not None and law_unit != "-":
        not_allowed(f"law_unit = {shown(law_unit)}", '"-" beside factor_of, as 1 + f is a factor')
    check_whole(f"free law {name}: knots", knots, _FEWEST)
    end = _LARGEST * size if largest is None and is_number(size) else largest
    for what, value in {"size": size, "largest": end}.items():
        if not is_number(value) or not 0.0 < float(value) < np.inf:
            not_allowed(f"{what} = {shown(value)}", "a number above 0")
    assert end is not None
    places = np.linspace(low, high, knots)
    # The curves of each knot at 1 and all others at 0.
    slopes = np.gradient(np.eye(knots), places, axis=0, edge_order=2)
    columns = CubicHermiteSpline(places, np.eye(knots), slopes, axis=0)
    curve = Curve(
        law=law,
        argument=argument,
        unit=unit,
        law_unit=law_unit,
        low=float(low),
        high=float(high),
        places=places,
        design=partial(_within, columns, low, high),
        constant=factor_of,
        stated=0.0 if factor_of is None else 1.0,
        relative=factor_of is not None,
        fixed={},
    )
    keys = [f"{name}.knot_{k}" for k in range(1, knots + 1)]
    return _law(name, curve, keys, law_unit, size, -float(end), float(end))


def _law(
    name: str, curve: Curve, keys: Sequence[str], unit: str, size: float, low: float, high: float,
    odds: float = 1.0,
) -> Cause:  # fmt: skip
    # No shapes, which would end at a few sizes: a law may be far from what was expected.
    knots = [Parameter(key, Prior("normal", 0.0, size), unit, low, high) for key in keys]
    meaning = f"{curve.name} has another shape"
    return Cause(name, tuple(knots), meaning, frees=curve.constant, curve=curve, odds=odds)


def forms(law: Cause) -> list[Cause]:
    """The law in each of its other forms, by an amplitude and a scale in place of its knots.

    The simulator's laws that are effects have none.
    """
    curve, knot = law.curve, law.parameters[0]
    assert curve is not None
    assert knot.prior is not None
    words = {key.rpartition(".")[2]: value for key, value in curve.fixed.items()}
    over = words.get("over", "" if curve.fixed else "an argument")
    allowed = _OF_LOAD if over == "load" else tuple(SHAPES) if over else ()
    others = []
    for form in allowed:
        section, fixed = f"{law.name}.{form}", dict[str, Value]()
        if curve.fixed:
            name = f"{next(iter(curve.fixed)).split('.')[1].removeprefix('free_')}_{form}"
            section, fixed = f"{LAWS}{name}", {f"{LAWS}{name}.form": form}
            fixed |= {f"{LAWS}{name}.{key}": words[key] for key in ("quantity", "over")}
        amplitude = "fraction" if curve.relative else "amount"
        numbers = [
            Parameter(f"{section}.{amplitude}", unit=knot.unit, size=knot.prior.second,
                      low=knot.low, high=knot.high)
        ]  # fmt: skip
        farthest = SHAPES[form].farthest
        if farthest:
            prior = Prior("log-uniform", NEAREST * curve.reach, farthest * curve.reach)
            numbers.append(Parameter(f"{section}.scale", prior, curve.unit, cause=False))
        elif curve.fixed:
            fixed[f"{section}.scale"] = curve.reach
        other = replace(curve, form=form, fixed=fixed)
        others.append(replace(law, parameters=tuple(numbers), curve=other))
    return others


def fixed_numbers(causes: Iterable[Cause]) -> dict[str, float]:
    """What the simulator's laws have beside their parameters, by dotted key, words by their place.

    It has to be set wherever one of their parameters is.
    """
    return {
        key: float(known_keys()[key].words.index(value) if isinstance(value, str) else value)
        for law in causes
        if law.curve is not None
        for key, value in law.curve.fixed.items()
    }


def beside_constants(causes: Iterable[Cause], constants: Sequence[Parameter]) -> list[Cause]:
    """The same causes; free laws get the unit and the stated value of their constant.

    A ScenarioError is raised if a law is a factor of what is no uncertain constant of the model.
    """
    known = {constant.name: constant for constant in constants}
    made = []
    for cause in causes:
        curve = cause.curve
        if curve is not None and curve.constant is not None:
            if curve.constant not in known:
                hint = meant(curve.constant, known)
                refuse(f"free law {cause.name}: factor_of", curve.constant,
                       f"an uncertain constant{hint}")  # fmt: skip
            constant = known[curve.constant]
            stated = float(constant.value(np.zeros(1))[0])
            cause = replace(cause, curve=replace(curve, law_unit=constant.unit, stated=stated))
        made.append(cause)
    return made


class Curves(dict[str, Callable[[ArrayLike], Array]]):
    """The curves of the free laws of a model, by their names, for some vectors of its parameters.

    ``curves["friction over speed"](u)`` has the shape (vectors, ...): `u` has the shape (m,) or
    (vectors, ...), a single row stands for all vectors. It is zero where the law is not in the
    model.

    Parameters
    ----------
    causes : iterable of Cause
        Those without a curve are passed over.
    values : mapping
        Values by name of a parameter, each of shape (vectors,), (vectors, 1) or a number. Knots
        that it lacks are zero.
    """

    def __init__(self, causes: Iterable[Cause], values: Mapping[str, ArrayLike]) -> None:
        super().__init__()
        vectors = max((np.size(value) for value in values.values()), default=1)
        pairs: dict[str, list[tuple[Curve, Array]]] = {}
        for cause in causes:
            if cause.curve is not None:
                values_of = [np.ravel(values.get(p.name, 0.0)) for p in cause.parameters]
                columns = [np.broadcast_to(value, (vectors,)) for value in values_of]
                pair = cause.curve, np.stack(columns, axis=1)
                pairs.setdefault(cause.name, []).append(pair)
        self |= {name: partial(_law_at, parts) for name, parts in pairs.items()}

    def __missing__(self, name: str) -> NoReturn:
        raise ScenarioError(f"curves: there is no free law {shown(name)}{meant(name, self)}")


def _within(columns: CubicHermiteSpline, low: float, high: float, u: Array) -> Array:
    """Columns of a curve at arguments, the ends of its range beyond them."""
    return np.asarray(columns(np.clip(u, low, high)), dtype=float)


def _law_at(forms: Sequence[tuple[Curve, Array]], argument: ArrayLike) -> Array:
    """A law in whichever of its forms it is."""
    u = np.atleast_2d(np.asarray(argument, dtype=float))
    f = np.where(np.isnan(u), np.nan, np.zeros((len(forms[0][1]), *u.shape[1:])))
    for curve, values in forms:
        # Without its amplitude a form is absent, whatever its scale.
        if (values if curve.form == CURVE else values[:, 0]).any():
            f = f + curve.at(u, values)
    return f


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
"""Of the last knot over the pitch, rad: what the core allows."""

_POINTS = 61
"""Points among which a knot's place is sought: a multiple of the knots' spacings."""


def laws(
    scenario: Scenario, uncertain: Mapping[str, Prior], spans: Mapping[str, float]
) -> tuple[Cause, ...]:
    """The simulator's laws of a free shape whose arguments reach as far as these spans.

    Together they have the prior odds of one cause. `scenario` is the recalibrated model. The
    constant of a law is freed with it, if `uncertain` has its dotted key. `spans` are those of
    `find_spans`: by effect, in the argument's unit.
    """
    odds = 1.0 / max(len(spans), 1)
    return tuple(_own_law(scenario, uncertain, *span, odds) for span in spans.items())


def _own_law(
    scenario: Scenario, uncertain: Mapping[str, Prior], effect: str, span: float, odds: float
) -> Cause:
    law, argument, _ = _PLACES[effect]
    fixed = _fixed(effect, span)
    section = next(iter(fixed)).rpartition(".")[0]
    keys = [f"{section}.knot_{k}" for k in range(1, 6)]
    is_place = law == "contact place"
    constant = _CONSTANTS.get(law)
    low = -span if argument == "pitch" else 0.0
    points = np.linspace(low, span, _POINTS)
    design = partial(_design, scenario.replace(fixed | dict.fromkeys(keys, 0.0)), effect, keys)
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
        fixed=fixed,
    )
    size, largest = _PLACE_SIZE if is_place else _FACTOR_SIZE
    return _law(curve.name, curve, keys, "-", size, -1.0, largest, odds)


def _fixed(effect: str, span: float) -> dict[str, Value]:
    """What a law has beside its knots, by dotted key."""
    _, argument, quantity = _PLACES[effect]
    if not quantity:
        return {f"{PREFIX}{effect}.span": span}
    law = Law(
        quantity=quantity, over=_ARGUMENTS[argument][1], form="curve", fraction=1.0, scale=span
    )
    return flat_laws({effect: law})


def _design(scenario: Scenario, effect: str, keys: Sequence[str], argument: Array) -> Array:
    """What each knot adds to the curve of the core, shape (*argument.shape, knots)."""
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
