"""Helpers of the tests of a user's own effects: registering, and a force in three languages."""

import pytest
from numba import cfunc

from stickslip import EffectParameter, _core, register_effect

SIGNATURE = "void(CPointer(float64), CPointer(float64), CPointer(float64))"
PULSES = {"drive.base": 0.5e-3, "drive.pulses": 10}
METHODS = ["tsit5", "arkode"] if _core.has_arkode else ["tsit5"]

# The same forces in the same steps, computed in another order. A step's rounding of 1e-16 and an
# event's place, 1e-12 of a step, add up over some 1e4 steps at most.
ROUNDING = 1e-8

by_method = pytest.mark.parametrize("method", METHODS)


@pytest.fixture(autouse=True)
def nothing_stays():
    """Around every test of a file that imports it."""
    yield
    for name in _core.registered_effects():
        unregister(name)


def unregister(name):
    """Take an effect back, which no user has to do."""
    _core.unregister_effect(name)


def parameter(name="k", low=-1.0, high=1.0, unit="-", **more):
    return EffectParameter(name=name, unit=unit, low=low, high=high, meaning="of a test", **more)


def register(function, *parameters, name="own"):
    register_effect(name, function, parameters or [parameter()], meaning="an effect of a test")


def nothing(state, parameters):
    return 0.0, 0.0, 0.0


# One function in three languages.

C_SOURCE = """
void wrench(const double* state, const double* parameters, double* out) {
    out[0] = -parameters[0] * state[4] + parameters[1] * state[7] * state[3];
    out[1] = -parameters[0] * state[5] + parameters[1] * state[8] * state[1];
    out[2] = -parameters[1] * 1e-9 * state[6] * (state[0] + state[2]);
}
"""


@cfunc(SIGNATURE)
def numba_wrench(state, parameters, out):
    out[0] = -parameters[0] * state[4] + parameters[1] * state[7] * state[3]
    out[1] = -parameters[0] * state[5] + parameters[1] * state[8] * state[1]
    out[2] = -parameters[1] * 1e-9 * state[6] * (state[0] + state[2])


def python_wrench(state, parameters):
    a, b = parameters
    return (
        -a * state.vx + b * state.Bx * state.theta,
        -a * state.vz + b * state.Bz * state.x,
        -b * 1e-9 * state.omega * (state.t + state.z),
    )
