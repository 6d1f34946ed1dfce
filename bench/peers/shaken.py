"""A block on a surface that shakes along itself: solve_ivp with events beside the core.

The block sticks until the surface's acceleration exceeds what static friction holds, and slips
until its velocity against the surface is zero. Coordinates are those of the surface.
"""

from __future__ import annotations

import math

import numpy as np
from measure import cpu_seconds_in_turn
from scipy.integrate import solve_ivp

import stickslip

FREQUENCY, PERIODS = 100.0, 50  # Hz
AMPLITUDES, PHASES = (30e-6, 0.3 * 30e-6), (0.0, 1.0)  # m and rad, of the first two sines
STATIC, KINETIC, DRAG, MASS, GRAVITY = 0.2, 0.145, 1e-5, 25.6e-9, 9.81
METHODS = (("RK45", 1e-5), ("LSODA", 1e-6), ("DOP853", 1e-8))
TOLERANCES = [10.0**-k for k in range(3, 12)]


def acceleration(t: float) -> float:
    """Acceleration of the surface, m/s^2."""
    total = 0.0
    for k, (size, phase) in enumerate(zip(AMPLITUDES, PHASES, strict=True), 1):
        rate = 2.0 * math.pi * FREQUENCY * k
        total -= size * rate * rate * math.sin(rate * t + phase)
    return total


def _terminal(function):
    function.terminal, function.direction = True, -1
    return function


def peer(method: str, rtol: float) -> float:
    """Mean velocity, m/s; atol is 0.01 rtol times the size of each coordinate."""
    end, t, x = PERIODS / FREQUENCY, 0.0, 0.0
    scales = np.array([AMPLITUDES[0], 2.0 * math.pi * FREQUENCY * AMPLITUDES[0]])
    options = {"method": method, "rtol": rtol, "atol": 0.01 * rtol * scales}

    @_terminal
    def held(t, y):
        return STATIC * GRAVITY - abs(acceleration(t))

    def broken(t):
        return -int(math.copysign(1.0, acceleration(t)))

    sign = 0 if held(t, None) >= 0.0 else broken(t)
    while t < end:
        if sign == 0:
            # A step at rest knows no error, and must not leap over an event.
            found = solve_ivp(
                lambda t, y: (0.0, 0.0), (t, end), [x, 0.0], events=held,
                max_step=0.05 / FREQUENCY, **options,
            )  # fmt: skip
        else:

            def rates(t, y, push=-sign * KINETIC * GRAVITY):
                return y[1], push - acceleration(t) - DRAG / MASS * y[1]

            stops = _terminal(lambda t, y, sign=sign: sign * y[1])
            found = solve_ivp(rates, (t, end), [x, 0.0], events=stops, **options)
        t, x = float(found.t[-1]), float(found.y[0, -1])
        sign = 0 if sign != 0 and held(t, None) >= 0.0 else broken(t)
    return x * FREQUENCY / PERIODS


def scenario(rtol: float) -> stickslip.Scenario:
    """The same problem for the core."""
    return stickslip.Scenario().replace(
        {
            "drive.mode": "none", "drive.pulses": PERIODS, "solver.rtol": rtol,
            "contact.static_friction": STATIC, "contact.kinetic_friction": KINETIC,
            "contact.adhesion": 0.0, "drag.linear": DRAG, "robot.mass": MASS,
            "environment.gravity": GRAVITY, "shake.frequency": FREQUENCY,
            "shake.amplitude_x": AMPLITUDES[0], "shake.phase_2_x": PHASES[1],
            "shake.harmonic_2_x": AMPLITUDES[1] / AMPLITUDES[0],
        }
    )  # fmt: skip


def velocity(rtol: float) -> float:
    """Mean velocity of the core, m/s."""
    return stickslip.simulate(scenario(rtol)).final_state.x * FREQUENCY / PERIODS


def rows(repeats: int) -> list[dict]:
    """Row of each method: CPU time and error, beside the loosest tolerance of the core as good."""
    exact = velocity(1e-13)
    own = {rtol: abs(velocity(rtol) / exact - 1.0) for rtol in TOLERANCES}
    result = []
    for method, rtol in METHODS:
        error = abs(peer(method, rtol) / exact - 1.0)
        tolerance = max(
            (
                t
                for t in TOLERANCES
                if all(own[tighter] <= error for tighter in own if tighter <= t)
            ),
            default=TOLERANCES[-1],
        )
        as_good = scenario(tolerance)
        works = [lambda m=method, r=rtol: peer(m, r), lambda s=as_good: stickslip.simulate(s)]
        cost, own_cost = cpu_seconds_in_turn(works, repeats)
        result.append(
            {
                "peer": "scipy", "settings": f"solve_ivp {method}, rtol {rtol:.0e}",
                "unit": "CPU s", "cost": cost, "error": error,
                "stickslip_settings": f"rtol {tolerance:.0e}", "stickslip_cost": own_cost,
                "stickslip_error": own[tolerance], "ratio": cost / own_cost, "target": None,
                "wrong": False,
            }
        )  # fmt: skip
    return result
