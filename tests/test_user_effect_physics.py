"""Effects of the user's own: the same answers as theory and as the model's own effects."""

import math

import numpy as np
import pytest
from numba import cfunc

from helpers import ADHESION, GRAVITY, HEIGHT, LENGTH, MASS, WEIGHT, run, still_for
from own_effects import (
    PULSES,
    ROUNDING,
    SIGNATURE,
    by_method,
    nothing_stays,  # noqa: F401 (around every test here)
    parameter,
    register,
)

# What is known in closed form.


@by_method
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_part_of_the_weight_along_the_surface_is_its_tilt(method, direction):
    @cfunc(SIGNATURE)
    def tilt(state, parameters, wrench):
        angle = parameters[0]
        wrench[0] = MASS * GRAVITY * math.sin(angle)
        wrench[1] = MASS * GRAVITY * (1.0 - math.cos(angle))
        wrench[2] = 0.0

    register(tilt, parameter("angle", unit="rad"))
    keys = {**PULSES, "solver.method": method, "drive.direction": direction}
    level = run(keys)
    for angle in (0.02, -0.05):
        own = run(keys, {"effects.own.angle": angle})
        built_in = run(keys, {"effects.surface_tilt.angle": angle})
        assert own.mean_velocity == pytest.approx(built_in.mean_velocity, rel=ROUNDING)
        assert abs(own.mean_velocity / level.mean_velocity - 1.0) > 0.01
        assert own.summary()["events"] == built_in.summary()["events"]


PRESSED = WEIGHT + ADHESION
RISE = 0.1  # s, of a force from zero to the one at which rest ends


@by_method
@pytest.mark.parametrize(
    ("component", "needed", "event"),
    [
        (0, 0.2 * PRESSED, "slip_start"),  # the friction limit; before it, no end lifts
        (0, -0.2 * PRESSED, "slip_start"),
        (1, PRESSED, "tip"),  # both ends, and by rounding one of them first
        (2, 0.5 * LENGTH * PRESSED, "tip"),  # nose-down, about the front's lower corner
        (2, -0.5 * LENGTH * PRESSED, "tip"),
        (0, LENGTH / HEIGHT * PRESSED, "tip"),  # at half the height, against friction below
        (0, -LENGTH / HEIGHT * PRESSED, "tip"),
    ],
)
def test_rest_ends_where_a_rising_force_says(method, component, needed, event):
    def rising(state, parameters):
        wrench = [0.0, 0.0, 0.0]
        wrench[component] = parameters[0] * needed * state.t / RISE
        return wrench

    register(rising)
    keys = {**still_for(1.2 * RISE), "effects.own.k": 1.0, "solver.method": method}
    keys["contact.static_friction"] = 0.2 if event == "slip_start" else 3.0
    seen = run(keys, rate="events")
    names = [seen.event_names[kind] for kind in seen.event]
    assert names[0] == event
    # The place of an event, 1e-12 of a look; the reaction it is taken from, 1e-16 of the force.
    assert seen.t[0] == pytest.approx(RISE, rel=1e-10)
    held = run(keys, {"effects.own.k": 0.8}, rate="events")
    assert held.t.size == 0


@by_method
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_constant_force_slides_the_block_along_a_parabola(method, direction):
    force = 0.5 * PRESSED  # its torque about the lower edge, with friction's, tips nothing

    def push(state, parameters):
        return parameters[0] * force, 0.0, 0.0

    register(push)
    keys = {**still_for(0.05), "drag.linear": 0.0, "drive.direction": direction}
    keys |= {"solver.method": method}
    for sign in (1.0, -1.0):
        seen = run(keys, {"effects.own.k": sign}, rate=1e3)
        acceleration = sign * (force - 0.145 * PRESSED) / MASS
        # A polynomial of second order in time is exact for both methods.
        assert seen.x == pytest.approx(0.5 * acceleration * seen.t**2, rel=1e-9, abs=1e-18)
        assert seen.vx == pytest.approx(acceleration * seen.t, rel=1e-9, abs=1e-18)


def test_in_flight_force_and_torque_move_the_body_freely():
    # 1 mm above the surface or more, so that nothing touches again.
    lift, torque, told = 3.0 * PRESSED, 1e-12, []

    def away(state, parameters):
        told.append(state.theta)
        return 0.0, lift, torque

    register(away)
    keys = {**still_for(0.02), "effects.own.k": 1.0, "drag.linear": 0.0, "drag.rotational": 0.0}
    keys["initial.theta"] = 4.0 * np.pi  # flat, after two turns
    seen = run(keys, rate=1e3)
    inertia = MASS * (LENGTH**2 + HEIGHT**2) / 12
    t = seen.t[1:]
    assert seen.z[1:] - seen.z[0] == pytest.approx(0.5 * (lift - WEIGHT) / MASS * t**2, rel=1e-9)
    turned = 4.0 * np.pi + 0.5 * torque / inertia * t**2
    assert seen.theta[1:] == pytest.approx(turned, rel=1e-13)
    assert turned[-1] > 4.0 * np.pi + 0.5
    assert max(told) == pytest.approx(seen.theta[-1], rel=1e-3)


# What the function is told.


@by_method
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_the_function_gets_the_values_of_a_recording(method, direction):
    told = {}

    def listen(state, parameters):
        assert parameters == (0.25, 0.5)
        told[state.t] = state
        return 0.0, 0.0, 0.0

    register(listen, parameter("a"), parameter("b", default=0.5))
    keys = {**PULSES, "solver.method": method, "drive.direction": direction}
    seen = run(keys, {"effects.own.a": 0.25}, rate=2e3)
    compared = 0
    for row in np.flatnonzero(seen.contact):  # in flight a recording asks for no force
        if seen.t[row] not in told:
            continue  # the clock of a stretch and that of the recording differ by a rounding
        state = told[seen.t[row]]
        compared += 1
        names = ("x", "z", "theta", "vx", "vz", "omega")
        recorded = [getattr(seen, name)[row] for name in names]
        assert [getattr(state, name) for name in names] == pytest.approx(
            recorded, rel=1e-12, abs=1e-18
        )
        assert (state.Bx, state.Bz) == pytest.approx((seen.bx[row], seen.bz[row]), rel=1e-12)
    assert compared > 50
    times = np.array(list(told))
    assert times.min() >= 0.0
    assert times.max() <= seen.scenario.duration * (1 + 1e-12)
