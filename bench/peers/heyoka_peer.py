"""The reference problem with heyoka: a compiled Taylor integrator with events for each mode.

Millimetres, milligrams and milliseconds, so that the state is of order one, as the step control of
heyoka wants it. Stick, slip and flight are three systems of expressions, compiled once; the
direction of a slip, the currents of the stretch and the sign of the angular rate are parameters of
run time. The drag torque omega |omega| is made analytic by that sign, which an event turns where
omega passes zero.
"""

from __future__ import annotations

import math
from typing import ClassVar

import heyoka as hy

from peers.corner import STICK, Mode, State, force_law, next_mode, tipping_time
from peers.problem import (
    DISTANCE,
    KINETIC_FRICTION,
    MOMENT,
    PULSES,
    SIDE,
    STATIC_FRICTION,
    TURNS,
    Problem,
    mean_velocity,
)

UNITS = {"length": 1e3, "mass": 1e6, "time": 1e3}  # mm, mg, ms

# mm and mm/ms. An event function that is exactly zero where a step begins hides its next root in
# that step from heyoka's search, so a gap or a slip speed of zero begins this far on the right
# side.
AWAY = 1e-15

# Slots of the parameters: six of the currents, then these.
TURNING, SLIDING, PIVOT = hy.par[6], hy.par[7], hy.par[8]
_TURNING = 6


def _expanded_field(problem: Problem, x, z):
    """(Bx, Bz, dBx/dx, dBx/dz, dBz/dz) times the moment, of the expansion that `Problem` holds."""
    currents = _currents(problem)
    bx, bz, gxx, gxz, gzz, xxx, xxz, xzz, zzz = (
        hy.sum([float(value) * each for value, each in zip(column, currents, strict=True)])
        for column in problem.field.T
    )
    dx, dz = x - problem.centre[0], z - problem.centre[1]
    hxx, hxz, hzz = xxx * dx + xxz * dz, xxz * dx + xzz * dz, xzz * dx + zzz * dz
    field_x = bx + (gxx + 0.5 * hxx) * dx + (gxz + 0.5 * hxz) * dz
    field_z = bz + (gxz + 0.5 * hxz) * dx + (gzz + 0.5 * hzz) * dz
    return field_x, field_z, gxx + hxx, gxz + hxz, gzz + hzz


def _exact_field(problem: Problem, x, z):
    """The same from the field of the four wires of each coil, differentiated by heyoka."""
    h, distance = SIDE / 2 * UNITS["length"], DISTANCE * UNITS["length"]
    u, w = hy.make_vars("u", "w")  # along the axis from the coil's plane, and across it
    near, far = u**2 + (w - h) ** 2, u**2 + (w + h) ** 2
    d, e = hy.sqrt(near + h**2), hy.sqrt(far + h**2)
    # Biot and Savart for the two wires across the plane of motion and the two along it.
    p, q = 1.0 / (d * near), 1.0 / (e * far)
    along = (d + e) / (d * e * (d * e + u**2 + w**2))
    scale = 1e-7 * TURNS * MOMENT * UNITS["mass"] * UNITS["length"] ** 3 / UNITS["time"] ** 2
    axial = scale * 2.0 * h * (q * (w + h) - p * (w - h) + 2.0 * h * along)
    across = scale * 2.0 * h * u * (p - q)
    terms = [axial, across, hy.diff(axial, u), hy.diff(axial, w), hy.diff(across, w)]
    in_plane = hy.subs(terms, {u: x - distance, w: z})
    clamp = hy.subs(terms, {u: z + distance, w: x})
    # What is axial for one coil is across for the other.
    clamp = [clamp[1], clamp[0], clamp[4], clamp[3], clamp[2]]
    first, second = _currents(problem)
    return tuple(first * one + second * two for one, two in zip(in_plane, clamp, strict=True))


def _currents(problem: Problem):
    decay = hy.exp(-hy.time / problem.time_constant)
    return [hy.par[k] + hy.par[k + 1] * hy.time + hy.par[k + 2] * decay for k in (0, 3)]


def _forces(problem: Problem, field, px, pz, theta, vx, vz, omega):
    """Lever, height, fx, fz, torque as expressions; see `corner.force_law` for the plain ones."""
    body = problem.body
    c, s = hy.cos(theta), hy.sin(theta)
    lever = body.half_length * c - body.half_height * s
    height = body.half_length * s + body.half_height * c
    field_x, field_z, gxx, gxz, gzz = field(problem, px - lever, pz + height)
    fx = c * gxx - s * gxz - body.linear_drag * (vx + height * omega)
    fz = c * gxz - s * gzz - body.weight - body.linear_drag * (vz + lever * omega)
    torque = -s * field_x - c * field_z - body.quadratic_drag * TURNING * omega**2
    return lever, height, fx, fz, torque


def _turn(integrator, slope_sign: int) -> bool:
    # Not a mere change of sign: a body that starts from omega = 0 may meet this event at once.
    integrator.pars[_TURNING] = slope_sign
    return True


def _integrator(system, events, tol: float):
    """Compiled; `events` stop it where they fall through zero, and omega's sign is followed."""
    falling = hy.event_direction.negative
    terminal = [hy.t_event(expression, direction=falling) for expression in events]
    omega = hy.expression("omega")
    return hy.taylor_adaptive(
        system,
        [0.0] * len(system),
        tol=tol,
        t_events=[*terminal, hy.t_event(omega, callback=_turn)],
    )


class Compiled:
    """The three integrators, for any drive.

    tol: heyoka's tolerance; it sets the order of the Taylor series too. exact: the field of the
    coils by their formula instead of its expansion.
    """

    events: ClassVar = {
        "stick": ("lift", "forward", "back"),
        "slip": ("stop", "lift"),
        "flight": ("touch",),
    }

    def __init__(self, problem: Problem, tol: float, exact: bool = False) -> None:
        self._problem = problem.scaled(**UNITS)
        self._field = _exact_field if exact else _expanded_field
        self._tol = tol
        self.stick, self.slip, self.flight = self._stick(), self._slip(), self._flight()

    def _stick(self):
        body, m = self._problem.body, self._problem.body.mass
        theta, omega = hy.make_vars("theta", "omega")
        lever, height, fx, fz, torque = self._forces(PIVOT, 0.0, theta, 0.0, 0.0, omega)
        inertia = body.inertia + m * (body.half_length**2 + body.half_height**2)
        alpha = (torque + height * fx + lever * fz) / inertia
        normal = m * (alpha * lever - omega**2 * height) - fz + body.adhesion
        friction = m * (alpha * height + omega**2 * lever) - fx
        limit = STATIC_FRICTION * normal
        events = [normal, limit + friction, limit - friction]
        return self._integrator([(theta, omega), (omega, alpha)], events)

    def _slip(self):
        body, m = self._problem.body, self._problem.body.mass
        px, vx, theta, omega = hy.make_vars("px", "vx", "theta", "omega")
        lever, height, fx, fz, torque = self._forces(px, 0.0, theta, vx, 0.0, omega)
        mu = SLIDING * KINETIC_FRICTION
        arm = lever - mu * height
        rest = body.adhesion - m * omega**2 * height - fz
        alpha = (torque + lever * body.adhesion - arm * rest) / (body.inertia + m * lever * arm)
        normal = m * lever * alpha + rest
        ax = (fx - mu * normal) / m - alpha * height - omega**2 * lever
        system = [(px, vx), (vx, ax), (theta, omega), (omega, alpha)]
        return self._integrator(system, [SLIDING * vx, normal])

    def _flight(self):
        body = self._problem.body
        px, pz, theta, vx, vz, omega = hy.make_vars("px", "pz", "theta", "vx", "vz", "omega")
        lever, height, fx, fz, torque = self._forces(px, pz, theta, vx, vz, omega)
        alpha = torque / body.inertia
        ax = fx / body.mass - alpha * height - omega**2 * lever
        az = fz / body.mass - alpha * lever + omega**2 * height
        system = [(px, vx), (pz, vz), (theta, omega), (vx, ax), (vz, az), (omega, alpha)]
        return self._integrator(system, [pz])

    def _integrator(self, system, events):
        return _integrator(system, events, self._tol)

    def _forces(self, *motion):
        return _forces(self._problem, self._field, *motion)

    def start(self, mode: Mode, state: State, tau: float, currents: list[float]):
        """The integrator of `mode`, put to `state` at the time tau of a stretch."""
        px, pz, theta, vx, vz, omega = state
        integrator = getattr(self, mode.kind)
        integrator.state[:] = {
            "stick": [theta, omega],
            "slip": [px, vx or mode.sign * AWAY, theta, omega],
            "flight": [px, pz or AWAY, theta, vx, vz, omega],
        }[mode.kind]
        pars = integrator.pars
        pars[:] = [*currents, math.copysign(1.0, omega), mode.sign, px][: len(pars)]
        integrator.time = tau
        integrator.reset_cooldowns()
        return integrator

    @staticmethod
    def state(mode: Mode, before: State, values: list[float]) -> State:
        """The state from an integrator's numbers."""
        if mode.kind == "stick":
            return before._replace(theta=values[0], omega=values[1])
        if mode.kind == "slip":
            px, vx, theta, omega = values
            return before._replace(px=px, vx=vx, theta=theta, omega=omega)
        return State(*values)


def simulate(problem: Problem, compiled: Compiled) -> float:
    """Mean velocity of the centre of mass, m/s."""
    problem = problem.scaled(**UNITS)
    body = problem.body
    a, b = body.half_length, body.half_height
    first, tau = tipping_time(problem)
    mode, state = STICK, State(a, 0.0, 0.0, 0.0, 0.0, 0.0)
    path = []
    for segment in problem.segments[first:]:
        currents = segment.current.ravel().tolist()
        length = segment.end - segment.start
        law = force_law(problem, segment)
        while True:
            integrator = compiled.start(mode, state, tau, currents)
            outcome = integrator.propagate_until(length)[0]
            tau = integrator.time
            state = compiled.state(mode, state, integrator.state.tolist())
            if outcome == hy.taylor_outcome.time_limit:
                break
            names = compiled.events[mode.kind]
            stopped = -int(outcome) - 1
            if not 0 <= stopped < len(names):
                raise RuntimeError(f"heyoka stopped with {outcome}")
            mode, state = next_mode(body, law, tau, state, names[stopped])
        tau = 0.0
        path.append(state.px - a * math.cos(state.theta) + b * math.sin(state.theta))
    return mean_velocity(problem, path[-PULSES:]) * UNITS["time"] / UNITS["length"]
