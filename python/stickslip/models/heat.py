"""Heaters, ovens and tanks of one or two heat stores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stickslip._util.numbers import Array
from stickslip.models.model import Kind, Known, Model, Sensor, Term, made
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


def _heated(t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array]) -> Array:
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


_COUPLING = Term("coupling", "W/K", "coupling of the heater", 20.0, "loss")
_THERMAL = Kind(
    "thermal",
    _heated,
    (
        Term("capacity", "J/K", "heat capacity"),
        Term("loss", "W/K", "loss to the ambient"),
        Term("ambient", "K", "temperature of the ambient", signed=True, value=0.0),
        Term("loss_growth", "W/K^2", "a loss that grows with the temperature", 0.1,
             "force / reading reading"),
        Term("heater_capacity", "J/K", "a second heat store", 0.2, "capacity", shape=_COUPLING),
        Term("power_error", "-", "another power than asked for", 0.05, "1", signed=True),
    ),
    (("start_temperature", "K"),),
    {"temperature": (0, 0)},
    {"power": "W", "ambient": "K"},
    (
        Sensor("zero", "offset", 0.05, "reading"),
        Sensor("late power", "delay", 0.02, "time", "power"),
        Sensor("slow thermometer", "lag", 0.02, "time"),
    ),
    inertia="capacity",
)  # fmt: skip


def thermal(*, smooth: bool = False, without: Sequence[str] = (), **known: Known) -> Model:
    """A body that is heated: one heat store, or two.

    ``capacity T' = power - loss (T - ambient) - loss_growth (T - ambient) |T - ambient|``, for a
    `Series` with the input ``power``, W, and perhaps ``ambient``. With a `heater_capacity` the
    power warms the heater first, which warms the body by `coupling`. Each effect that is not stated
    is a cause, and so are a wrong zero, a slow thermometer and a late power.

    Parameters
    ----------
    smooth, without
        As for a `joint`.
    capacity, loss : float, (float, float) or Prior
        Of the body, J/K, and to the ambient, W/K; required.
    ambient : optional
        Temperature of the ambient where it is no input, in the unit of the readings; 0, if not
        stated, for readings above it.
    loss_growth : optional
        Loss that grows with the temperature, by convection or radiation, W/K^2.
    heater_capacity, coupling : optional
        Of a second heat store, J/K and W/K. Both stores begin at the same temperature.
    power_error : optional
        The power is 1 + this times what the log says.
    start_temperature : optional
        At the first reading; one for each record is found, if not stated.

    Returns
    -------
    Model

    Raises
    ------
    ScenarioError
        If a name is unknown, a value is not allowed, or a constant is missing.

    Notes
    -----
    Steps are exact, and of order 5 with `loss_growth`.
    """
    return made(_THERMAL, "temperature", smooth, without, known)
