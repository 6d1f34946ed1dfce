"""The reference problem with solve_ivp of SciPy: a right-hand side and events for each mode.

Each mode has its own minimal state, currents are in closed form, and `solve_ivp` finds the events.
Any of its methods serves; which one is cheapest is measured.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from peers.corner import (
    STICK,
    Mode,
    State,
    flying,
    force_law,
    next_mode,
    slipping,
    sticking,
    tipping_time,
)
from peers.problem import PULSES, STATIC_FRICTION, Body, Problem, mean_velocity

# Natural sizes of length, speed, angle and rate, of which `atol` is `rtol` times a hundredth.
LENGTH, SPEED, ANGLE, RATE = 1e-4, 1e-2, 1.0, 1e2  # m, m/s, rad, rad/s


def _terminal(function, direction: int):
    function.terminal = True
    function.direction = direction
    return function


def _stick(body: Body, law, state: State):
    """(right-hand side, start, scales, events by name, state from y) of a corner that sticks."""
    px = state.px
    mu = STATIC_FRICTION

    def rhs(tau, y):
        theta, omega = y.tolist()
        alpha, _, _ = sticking(body, law(tau, px, 0.0, theta, 0.0, 0.0, omega), omega)
        return omega, alpha

    def reaction(tau, y):
        theta, omega = y.tolist()
        return sticking(body, law(tau, px, 0.0, theta, 0.0, 0.0, omega), omega)[1:]

    def lift(tau, y):
        return reaction(tau, y)[0]

    def forward(tau, y):
        normal, friction = reaction(tau, y)
        return mu * normal + friction

    def back(tau, y):
        normal, friction = reaction(tau, y)
        return mu * normal - friction

    events = {"forward": forward, "back": back, "lift": lift}
    return (
        rhs,
        [state.theta, state.omega],
        [ANGLE, RATE],
        {name: _terminal(event, -1) for name, event in events.items()},
        lambda y: State(px, 0.0, y[0], 0.0, 0.0, y[1]),
    )


def _slip(body: Body, law, state: State, sign: int):
    """The same for a corner that slips."""

    def rhs(tau, y):
        px, vx, theta, omega = y.tolist()
        alpha, ax, _ = slipping(body, law(tau, px, 0.0, theta, vx, 0.0, omega), omega, sign)
        return vx, ax, omega, alpha

    def lift(tau, y):
        px, vx, theta, omega = y.tolist()
        return slipping(body, law(tau, px, 0.0, theta, vx, 0.0, omega), omega, sign)[2]

    def stop(tau, y):
        return sign * y[1]

    return (
        rhs,
        [state.px, state.vx, state.theta, state.omega],
        [LENGTH, SPEED, ANGLE, RATE],
        {"stop": _terminal(stop, -1), "lift": _terminal(lift, -1)},
        lambda y: State(y[0], 0.0, y[2], y[1], 0.0, y[3]),
    )


def _flight(body: Body, law, state: State):
    """The same for a corner in the air."""

    def rhs(tau, y):
        px, pz, theta, vx, vz, omega = y.tolist()
        alpha, ax, az = flying(body, law(tau, px, pz, theta, vx, vz, omega), omega)
        return vx, vz, omega, ax, az, alpha

    def touch(tau, y):
        return y[1]

    return (
        rhs,
        list(state),
        [LENGTH, LENGTH, ANGLE, SPEED, SPEED, RATE],
        {"touch": _terminal(touch, -1)},
        lambda y: State(*y),
    )


def _setup(body: Body, law, mode: Mode, state: State):
    if mode.kind == "stick":
        return _stick(body, law, state)
    if mode.kind == "slip":
        return _slip(body, law, state, mode.sign)
    return _flight(body, law, state)


def simulate(problem: Problem, method: str, rtol: float) -> float:
    """Mean velocity of the centre of mass, m/s.

    method, rtol: as for solve_ivp; atol is 0.01 rtol times the natural size of each quantity.
    """
    body = problem.body
    a, b = body.half_length, body.half_height
    first, tau = tipping_time(problem)
    mode, state = STICK, State(a, 0.0, 0.0, 0.0, 0.0, 0.0)
    path = []
    for segment in problem.segments[first:]:
        law = force_law(problem, segment)
        length = segment.end - segment.start
        while tau < length:
            rhs, start, scales, events, restore = _setup(body, law, mode, state)
            solution = solve_ivp(
                rhs,
                (tau, length),
                np.array(start),
                method=method,
                rtol=rtol,
                atol=0.01 * rtol * np.array(scales),
                events=list(events.values()),
            )
            if solution.status < 0:
                raise RuntimeError(solution.message)
            tau, state = float(solution.t[-1]), restore(solution.y[:, -1].tolist())
            if solution.status == 1:
                fired = (times.size > 0 for times in solution.t_events)
                event = next(name for name, hit in zip(events, fired, strict=True) if hit)
                mode, state = next_mode(body, law, tau, state, event)
        tau = 0.0
        path.append(state.px - a * math.cos(state.theta) + b * math.sin(state.theta))
    return mean_velocity(problem, path[-PULSES:])
