"""An effect of the user's own is a suspect like the model's own."""

from dataclasses import replace

import numpy as np
import pytest
from numba import cfunc

from made_measurement import write
from own_effects import (
    SIGNATURE,
    nothing_stays,  # noqa: F401 (around every test here)
    parameter,
    register,
)
from stickslip import Scenario
from stickslip.diagnosis import diagnose
from stickslip.diagnosis.inference.extended_model import extended_scenario
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.report.parameters import extended_parameters
from stickslip.measurement import read_measurement


@cfunc(SIGNATURE)
def pulling(state, parameters, out):
    """A force along +x that grows as the robot tips."""
    out[0] = parameters[0] * state[3] ** 2
    out[1] = 0.0
    out[2] = 0.0


def test_it_joins_the_library_with_its_range():
    register(pulling, parameter(unit="N", low=-1e-7, high=1e-7))
    (own,) = (each for each in library(Scenario(), {}, 20.0) if each.name == "own")
    (size,) = own.parameters
    assert (size.low, size.high, size.unit) == (-1e-7, 1e-7, "N")
    assert float(size.value(np.zeros(1))[0]) == size.absent == 0.0
    assert np.all(np.isfinite(size.limits))


@pytest.mark.nightly
def test_it_is_found_and_extends_the_scenario(tmp_path):
    register(pulling, parameter(unit="N", low=-1e-7, high=1e-7))
    hidden = 2e-8
    measurement = read_measurement(write(tmp_path, {"effects.own.k": hidden}))
    found = diagnose(measurement).findings
    # In one mode of eight settings its force may look like a slope of the surface.
    assert found.verdict.kind in ("named", "ambiguous")
    assert "own" in found.verdict.causes
    size = extended_parameters(found)["effects.own.k"]
    assert abs(float(size["value"]) - hidden) < 4.0 * float(size["sd"]) < hidden
    (fit,) = (each for each in found.ranking.singles if each.name == "own")
    claimed = replace(found, verdict=replace(found.verdict, fit=fit))
    extended = extended_scenario(claimed, measurement.scenario)
    assert extended.effects["own"]["k"] == size["value"]
