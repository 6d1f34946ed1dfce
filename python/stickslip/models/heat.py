"""Heaters, ovens and tanks of one or two heat stores."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stickslip import _machines
from stickslip._util.arrays import Array


def heater_states(
    t: Array, inputs: Mapping[str, Array], late: Mapping[str, Array], values: Mapping[str, Array]
) -> Array:
    """Temperatures of the body, and with a `heater_capacity` of its heater, in time."""
    shape = 1 + len(t), len(values["capacity"])
    power = inputs.get("power", np.zeros(shape)) * (1.0 + values["power_error"])
    ambient = np.broadcast_to(inputs.get("ambient", values["ambient"]), shape)
    names = ("capacity", "loss", "loss_growth", "heater_capacity", "coupling")
    terms = np.stack([values[name] for name in names], axis=1)
    start = np.asarray(values["start_temperature"])
    both = np.stack([power.T, ambient.T], axis=2)
    none = np.zeros(shape[1])
    each = np.stack([late.get(name, none) for name in ("power", "ambient")], axis=1)
    return _machines.heated(terms, start, t, both, each).T[:, None, :]
