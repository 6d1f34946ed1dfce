"""An effect of the user's own is a cause like the model's own."""

import numpy as np
import pytest
from numba import cfunc

from made_velocities import SCENARIO, drives, measurement, trials
from own_effects import (
    SIGNATURE,
    nothing_stays,  # noqa: F401 (around every test here)
    parameter,
    register,
)
from stickslip import diagnose, simulate_batch
from stickslip.walker.problem import posed_by

HIDDEN = 2e-8  # N


@cfunc(SIGNATURE)
def pulling(state, parameters, out):
    """A force along +x that grows as the robot tips."""
    out[0] = parameters[0] * state[3] ** 2
    out[1] = 0.0
    out[2] = 0.0


def pulled():
    """Three trials of eight drives of a robot with the effect."""
    table = trials()
    rows = drives().add_prefix("drive.").to_dict("records")
    with_it, plain = (
        simulate_batch([SCENARIO.replace({**row, "effects.own.k": k}) for row in rows])
        for k in (HIDDEN, 0.0)
    )
    more = [
        one.mean_velocity - other.mean_velocity for one, other in zip(with_it, plain, strict=True)
    ]
    return table.assign(velocity=table["velocity"] + np.tile(more, 3))


def test_it_is_a_cause_with_its_range():
    register(pulling, parameter(unit="N", low=-1e-7, high=2e-7))
    posed = posed_by(measurement(trials()), threads=1)
    (own,) = (each for each in posed.causes if each.name == "own")
    (size,) = own.parameters
    assert (size.name, size.unit) == ("effects.own.k", "N")
    assert (size.low, size.high, size.absent) == (-1e-7, 2e-7, 0.0)
    # The range gives its size.
    assert size.size == pytest.approx(2e-7 / 5.0)
    assert np.all(np.isfinite(size.limits))
    # It moves the predictions, and is gone at its absent value.
    x = np.zeros((2, posed.size))
    x[1, posed.columns([own])] = 1.0
    still, moved = posed.model(posed.physical(x))
    assert np.abs(moved - still).max() > posed.sd.max()


@pytest.mark.nightly
def test_it_is_found_and_extends_the_scenario():
    register(pulling, parameter(unit="N", low=-1e-7, high=1e-7))
    result = diagnose(measurement(pulled()))
    # In one mode of eight settings its force may look like a slope of the surface.
    assert result.verdict.kind in ("named", "dominant", "ambiguous")
    assert "own" in result.verdict.causes
    size = result.candidate("own").params.loc["effects.own.k"]
    assert abs(size["value"] - HIDDEN) < 4.0 * size["sd"] < HIDDEN
