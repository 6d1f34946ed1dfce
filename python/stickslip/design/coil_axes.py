"""The field of single coils along their axes, and how their currents rise."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from stickslip._util.messages import check_kind
from stickslip._util.picture import RC, Picture
from stickslip.design.coil_facts import coil_facts
from stickslip.field.coils import Coils
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario

_REACH = 10e-3  # m, to both sides of the centre; chosen: ten lengths of a large robot
_TIMES = 5.0  # of the time constant: 99 % of a step


def coil_lines(scenario: Scenario) -> Figure:
    """Draw the field of each coil along its axis per ampere, and its current after a step.

    A coil that is as one before it is not drawn again. A field map is drawn within its box.

    Parameters
    ----------
    scenario : Scenario
        Its coils are drawn.

    Raises
    ------
    ScenarioError
        If `scenario` is none.
    """
    check_kind("scenario", scenario, Scenario)
    made, facts = Coils.of(scenario), coil_facts(scenario)
    drawn: dict[object, str] = {}
    for name in COIL_NAMES:
        of_axis = ("x", "z")[name == "clamp"] if made.box is None else name
        drawn.setdefault((getattr(scenario.coil, name), of_axis), name)
    with matplotlib.rc_context(RC):
        figure = Picture(figsize=(6.4, 2.8), layout="constrained")
        field, current = figure.subplots(1, 2)
        for name in drawn.values():
            coil = COIL_NAMES.index(name)
            axis = (0, 0, 1, 1, 2)[coil]
            low, high = (made.box[0][axis], made.box[1][axis]) if made.box else (-1.0, 1.0)
            place = np.linspace(max(low, -_REACH), min(high, _REACH), 101)
            along = made.field(place[:, np.newaxis] * np.eye(3)[axis], np.eye(5)[coil])[:, axis]
            field.plot(1e3 * place, 1e3 * along, label=name)
            time = np.linspace(0.0, _TIMES * facts[name].rise_time, 101)
            risen = -np.expm1(-time / facts[name].rise_time)
            current.plot(1e3 * time, 100.0 * risen, label=name)
        field.set(xlabel="place on its axis (mm)", ylabel="field (mT/A)")
        current.set(xlabel="time after a step (ms)", ylabel="current (% of steady)")
        field.legend()
    return figure
