"""Laws of the simulator with a free shape: a place of the model, an argument, and five knots.

They are looked at where no cause of a known law explains the data. What they are is
the core's, see the page on named effects; here is how far each argument reaches in these data, and
how large a change would not surprise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.model.free_terms import KNOTS, Term
from stickslip.diagnosis.model.problem import Cause, CauseParameter
from stickslip.scenario.keys import known_keys
from stickslip.scenario.named_effects import PREFIX
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import simulate_batch

# Relative change of a law at a knot that would not surprise, and the largest that is searched.
# Chosen as rough orders: a third of the law, and three times it.
_SCALE, _LARGEST = 0.3, 3.0
# Points between which the place of a knot is sought. Chosen: a multiple of the knots' spacings.
_POINTS = 61
# Samples a pulse of the runs that show how far the arguments reach. Chosen: the rocking of a pulse
# is seen.
_SAMPLES = 400.0
# Share of an argument's sum over the samples up to which a curve has its knots: with all, an
# instant of an impact would stretch the curve. Chosen.
_WITHIN = 0.98


@dataclass(frozen=True)
class Hook:
    """Where a law of free shape acts, and on what it depends.

    Attributes
    ----------
    effect : str
        Name of the core's effect.
    law, argument : str
        In words: ``friction`` over ``slip speed``.
    unit : str
        Of the argument.
    both_ways : bool
        Whether the argument has both signs, so that the knots reach from -span to span.
    length : str
        Unit of f where it is a length; empty where the law is a quantity times 1 + f.
    size, largest : float
        Of f at a knot: what would not surprise, and the largest that is searched.
    """

    effect: str
    law: str
    argument: str
    unit: str
    both_ways: bool = False
    length: str = ""
    size: float = _SCALE
    largest: float = _LARGEST

    @property
    def name(self) -> str:
        return f"{self.law} over {self.argument}"

    @property
    def constant(self) -> str | None:
        """Key of the constant that the law is times 1 + f; the field has none."""
        keys = {"friction": "contact.kinetic_friction", "adhesion": "contact.adhesion"}
        return {**keys, "drag": "drag.linear"}.get(self.law)

    @property
    def span_key(self) -> str:
        return f"{PREFIX}{self.effect}.span"

    @property
    def knots(self) -> list[str]:
        """Keys of the knots."""
        return [f"{PREFIX}{self.effect}.knot_{k}" for k in range(1, KNOTS + 1)]

    @property
    def cause(self) -> Cause:
        """The law as a candidate, whose amplitudes are the knots."""
        parameters = tuple(
            CauseParameter(key, known_keys()[key].unit, -1.0, self.largest, self.size)
            for key in self.knots
        )
        return Cause(self.effect, parameters, f"{self.name} has another shape")

    def term(self, scenario: Scenario, span: float) -> Term:
        """The law where it reaches as far as `span`, in any scenario that knows the effect."""
        key, low = self.constant, -span if self.both_ways else 0.0
        design = partial(curve_design, scenario, self, span)
        points = np.linspace(low, span, _POINTS)
        return Term(
            law=self.law,
            argument=self.argument,
            unit=self.unit,
            law_unit=self.length or ("of the model's" if key is None else known_keys()[key].unit),
            cause=self.cause,
            low=low,
            high=span,
            places=points[np.argmax(design(points), axis=0)],
            design=design,
            constant=key,
            stated=float(not self.length) if key is None else float(scenario.get(key)),
            relative=not self.length,
            cut=not self.length,
            fixed={self.span_key: span},
        )


HOOKS = (
    Hook("free_friction_speed", "friction", "slip speed", "m/s"),
    Hook("free_friction_angle", "friction", "tilt", "rad", both_ways=True),
    Hook("free_friction_load", "friction", "normal force", "N"),
    Hook("free_friction_age", "friction", "time", "s"),
    Hook("free_adhesion_angle", "adhesion", "tilt", "rad", both_ways=True),
    Hook("free_adhesion_age", "adhesion", "age of the contact", "s"),
    # Chosen: a fifth of half the body, and no farther than its middle.
    Hook("free_contact_place", "contact place", "tilt", "rad", True, "half lengths", 0.2, 1.0),
    Hook("free_drag_angle", "drag", "tilt", "rad", both_ways=True),
    Hook("free_drag_speed", "drag", "speed", "m/s"),
    Hook("free_drag_rate", "drag", "rate of the tilt", "rad/s"),
    Hook("free_field_time", "field", "time", "s"),
    Hook("free_field_frequency", "field", "frequency", "Hz"),
    Hook("free_field_amplitude", "field", "in-plane current", "A"),
)


def find_spans(scenarios: Sequence[Scenario], threads: int) -> dict[str, float]:
    """How far the argument of each hook reaches in runs of the recalibrated model, by effect.

    A hook whose argument does not vary between or within the runs is left out, as is one of a law
    that the model does not have at all.
    """
    recorded = [
        each.replace({"record.rate": _SAMPLES * each.drive.frequency}) for each in scenarios
    ]
    runs = [run for run in simulate_batch(recorded, threads=threads) if run.ok]
    if not runs:
        return {}

    def joined(name: str) -> Array:
        return np.asarray(np.abs(np.concatenate([getattr(run, name) for run in runs])))

    in_plane = [np.sqrt(np.sum(run.current[:, :4] ** 2, axis=1)) for run in runs]
    ends = np.array([run.t[-1] for run in runs])
    frequencies = np.array([each.drive.frequency for each in scenarios])
    # How long a contact lasts is at most the run, and mostly about a pulse.
    arguments = {
        "slip speed": joined("slip_velocity"),
        "tilt": joined("theta"),
        "normal force": joined("normal_force"),
        "time": ends,
        "age of the contact": 1.0 / frequencies,
        "speed": np.hypot(joined("vx"), joined("vz")),
        "rate of the tilt": joined("omega"),
        "frequency": frequencies if np.ptp(frequencies) > 0.0 else np.zeros(1),
        "in-plane current": np.concatenate(in_plane),
    }
    spans = {}
    for hook in HOOKS:
        values = arguments[hook.argument]
        moving = np.sort(values[values > 0.0])
        if len(moving) and not _without_law(hook, scenarios[0]):
            known = known_keys()[hook.span_key]
            # A robot that mostly creeps does most of its way, and of its turning, fast; arguments
            # that do not vary within a run reach about as far as the largest.
            part = np.cumsum(moving) / np.sum(moving)
            reach = float(moving[np.searchsorted(part, _WITHIN)])
            spans[hook.effect] = float(np.clip(reach, known.low, known.high))
    return spans


def _without_law(hook: Hook, scenario: Scenario) -> bool:
    return hook.law == "adhesion" and scenario.contact.adhesion == 0.0


def curve_design(scenario: Scenario, hook: Hook, span: float, arguments: Array) -> Array:
    """What each knot adds to the curve, which is linear in them, shape (arguments, knots)."""
    columns = []
    for key in hook.knots:
        one = scenario.replace({hook.span_key: span, key: 1.0})
        columns.append(one.to_core().free_curve(hook.effect, arguments))
    return np.stack(columns, axis=1)
