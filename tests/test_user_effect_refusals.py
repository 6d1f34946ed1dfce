"""Effects of the user's own: what goes wrong in a run, and what is refused before one."""

import math

import numpy as np
import pytest
from numba import cfunc

import stickslip
from helpers import run, scenario
from own_effects import (
    METHODS,
    PULSES,
    SIGNATURE,
    by_method,
    nothing,
    nothing_stays,  # noqa: F401 (around every test here)
    parameter,
    register,
)
from stickslip import simulate, simulate_batch, sweep


class BoomError(Exception):
    pass


def test_an_exception_of_the_function_passes_through():
    def fails(state, parameters):
        if state.t > 0.06:
            raise BoomError(f"at {state.t:.3f} s")
        return 0.0, 0.0, 0.0

    register(fails)
    for method in METHODS:
        for rate in ("none", "events", 1e5):
            failing = scenario(
                PULSES, {"effects.own.k": 1.0, "solver.method": method, "record.rate": rate}
            )
            with pytest.raises(BoomError, match=r"at 0\.06"):
                simulate(failing)
            for threads in (1, 2):
                with pytest.raises(BoomError):
                    simulate_batch(4 * [failing], threads=threads)
    for threads in (1, 2):
        with pytest.raises(BoomError) as caught:
            sweep(scenario(PULSES), {"effects.own.k": [0.0, 0.5, 1.0]}, threads=threads)
        assert caught.traceback[-1].name == "fails"
    # It is over with that: nothing is left behind for the next run.
    assert run(PULSES).ok


@by_method
@pytest.mark.parametrize("peak", [0.0, 2.5e-3])  # T; at rest without
@pytest.mark.parametrize(("component", "bad"), [(0, math.nan), (1, math.inf), (2, -math.inf)])
def test_a_force_that_is_not_finite_is_a_status(method, peak, component, bad):
    @cfunc(SIGNATURE)
    def broken(state, parameters, wrench):
        wrench[0] = wrench[1] = wrench[2] = 0.0
        if state[0] > 0.06 and parameters[0] > 0.5:
            wrench[component] = bad

    register(broken)
    drive = {**PULSES, "drive.base": 0.0, "drive.peak": peak}
    failed = simulate(scenario(drive, {"effects.own.k": 1.0, "solver.method": method}))
    assert failed.status == "not_finite"
    assert failed.message.startswith("at t = 0.06")
    assert "the function of effect own gave a force or torque that is not a" in failed.message
    seen = sweep(
        scenario(drive, {"solver.method": method}), {"effects.own.k": [0.4, 0.9]}, threads=2
    )
    assert list(seen.status.values == 0) == [True, False]
    assert np.isnan(seen.mean_velocity.values[1])


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_compiled_function_that_fails_gives_no_force_of_zero():
    @cfunc(SIGNATURE)
    def fails(state, parameters, wrench):
        # numba prints the error and returns: nothing is written.
        force = parameters[0] * 1e-9 / (0.0 if state[0] > 0.06 else 1.0)
        wrench[0] = force
        wrench[1] = wrench[2] = 0.0

    register(fails)
    failed = simulate(scenario(PULSES, {"effects.own.k": 1.0}))
    assert failed.status == "not_finite"
    assert failed.message.startswith("at t = 0.06")


def test_a_force_that_grows_without_bound_ends():
    register(lambda state, parameters: (0.0, 1e300 * parameters[0] * state.t, 0.0))
    for method in METHODS:
        ended = simulate(scenario(PULSES, {"effects.own.k": 1.0, "solver.method": method}))
        assert ended.status != "ok"


@pytest.mark.parametrize(
    "result", [None, 1.0, (1.0, 2.0), (1.0, 2.0, 3.0, 4.0), ("a", 0.0, 0.0), (1j, 0.0, 0.0)]
)
def test_a_function_that_returns_something_else(result):
    register(lambda state, parameters: result)
    with pytest.raises(TypeError, match=r"effect own: its function returned .*three numbers"):
        simulate(scenario(PULSES, {"effects.own.k": 1.0}))


def test_the_ends_of_a_range_are_printed_short_and_allowed():
    register(nothing, parameter(low=1 / 3, high=0.1 + 0.2 + 1 / 3, default=0.5), name="ends")
    with pytest.raises(stickslip.ScenarioError, match=r"a number from 0\.333334 to 0\.633333"):
        stickslip.Scenario(effects={"ends": {"k": 9.0}})
    for end in (0.333334, 0.633333):
        assert stickslip.Scenario(effects={"ends": {"k": end}}).effects["ends"]["k"] == end
