"""Heaters, ovens and tanks of one or two heat stores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stickslip._util.numbers import Array
from stickslip.models.steps import Mode, State, System, stepped


class _Stores(System):
    """Temperatures of the body and, with a `heater_capacity`, of its heater."""

    inputs = 2

    def __init__(
        self, capacity: float, loss: float, growth: float, heater: float, coupling: float
    ) -> None:
        self.states, self.linear = 1 + (heater > 0.0), growth == 0.0
        self.c = capacity, loss, growth, heater, coupling
        self.fastest = loss / capacity
        if heater:
            self.fastest += coupling * (1.0 / capacity + 1.0 / heater)

    def rate(self, z: Sequence[float], u: State, mode: Mode) -> State:
        capacity, loss, growth, heater, coupling = self.c
        power, ambient = u
        over = z[0] - ambient
        lost = (loss + growth * abs(over)) * over
        if not heater:
            return ((power - lost) / capacity,)
        flow = coupling * (z[1] - z[0])
        return (flow - lost) / capacity, (power - flow) / heater


def heater_states(t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array]) -> Array:
    shape = len(t), len(values["capacity"])
    power = inputs.get("power", np.zeros(shape)) * (1.0 + values["power_error"])
    ambient = np.broadcast_to(inputs.get("ambient", values["ambient"]), shape)
    names = ("capacity", "loss", "loss_growth", "heater_capacity", "coupling")
    table = np.array([values[name] for name in names]).T.tolist()
    gaps, result = np.diff(t).tolist(), np.empty((len(t), 1, shape[1]))
    for k, own in enumerate(table):
        system = _Stores(*own)
        start = (float(values["start_temperature"][k]),) * system.states
        both = list(zip(power[:, k].tolist(), ambient[:, k].tolist(), strict=True))
        result[:, 0, k] = stepped(system, start, gaps, both)[:, 0]
    return result
