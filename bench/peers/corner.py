"""One corner on a plane: forces, and which of stick, slip and flight is consistent.

Plain Python, shared by the peers that are integrators and leave contact to their user. Adhesion
acts at the corner while it touches; friction and normal force follow sections IV-C and VI of the
paper. Any consistent units.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from peers.problem import KINETIC_FRICTION, STATIC_FRICTION, Body, Problem, Segment


class OutOfScope(RuntimeError):
    """The motion is no longer that of one corner."""


class State(NamedTuple):
    """Position and velocity of the corner, angle and angular rate."""

    px: float
    pz: float
    theta: float
    vx: float
    vz: float
    omega: float


class Forces(NamedTuple):
    """Arms of the corner ahead of and below the centre of mass, and what acts there but contact."""

    lever: float
    height: float
    fx: float
    fz: float
    torque: float


class Mode(NamedTuple):
    """How the corner moves: "stick", "slip" towards `sign`, or "flight"."""

    kind: str
    sign: int = 0


STICK, FLIGHT = Mode("stick"), Mode("flight")

ForceLaw = Callable[[float, float, float, float, float, float, float], Forces]


def force_law(problem: Problem, segment: Segment) -> ForceLaw:
    """Forces as a function of the time tau into `segment` and of the six numbers of a `State`."""
    body = problem.body
    a, b = body.half_length, body.half_height
    weight, drag, twist = body.weight, body.linear_drag, body.quadratic_drag
    cx, cz = problem.centre
    rate = -1.0 / problem.time_constant
    by_time = (segment.current.T @ problem.field).tolist()
    terms = list(zip(*by_time, strict=True))
    exp, cos, sin = math.exp, math.cos, math.sin

    def forces(tau, px, pz, theta, vx, vz, omega):
        c, s = cos(theta), sin(theta)
        lever, height = a * c - b * s, a * s + b * c
        e = exp(rate * tau)
        bx, bz, gxx, gxz, gzz, xxx, xxz, xzz, zzz = [p + q * tau + r * e for p, q, r in terms]
        dx, dz = px - lever - cx, pz + height - cz
        nxx, nxz = gxx + xxx * dx + xxz * dz, gxz + xxz * dx + xzz * dz
        nzz = gzz + xzz * dx + zzz * dz
        # The second-order part counts in full for the gradient, by half for the field.
        field_x = bx + 0.5 * ((gxx + nxx) * dx + (gxz + nxz) * dz)
        field_z = bz + 0.5 * ((gxz + nxz) * dx + (gzz + nzz) * dz)
        return Forces(
            lever,
            height,
            c * nxx - s * nxz - drag * (vx + height * omega),
            c * nxz - s * nzz - weight - drag * (vz + lever * omega),
            -s * field_x - c * field_z - twist * omega * abs(omega),
        )

    return forces


def sticking(body: Body, forces: Forces, omega: float) -> tuple[float, float, float]:
    """(angular acceleration, normal force, friction force along +x) of a corner that sticks."""
    lever, height, fx, fz, torque = forces
    m = body.mass
    alpha = (torque + height * fx + lever * fz) / (body.inertia + m * (lever**2 + height**2))
    normal = m * (alpha * lever - omega**2 * height) - fz + body.adhesion
    return alpha, normal, m * (alpha * height + omega**2 * lever) - fx


def slipping(body: Body, forces: Forces, omega: float, sign: int) -> tuple[float, float, float]:
    """(angular acceleration, acceleration of the corner along x, normal force) in a slip."""
    lever, height, fx, fz, torque = forces
    m, mu = body.mass, sign * KINETIC_FRICTION
    arm = lever - mu * height
    rest = body.adhesion - m * omega**2 * height - fz
    moment = torque + lever * body.adhesion - arm * rest
    alpha = moment / (body.inertia + m * lever * arm)
    normal = m * lever * alpha + rest
    return alpha, (fx - mu * normal) / m - alpha * height - omega**2 * lever, normal


def flying(body: Body, forces: Forces, omega: float) -> tuple[float, float, float]:
    """(angular acceleration, accelerations of the corner along x and z) in flight."""
    lever, height, fx, fz, torque = forces
    alpha = torque / body.inertia
    ax = fx / body.mass - alpha * height - omega**2 * lever
    return alpha, ax, fz / body.mass - alpha * lever + omega**2 * height


def landed(body: Body, forces: Forces, state: State) -> State:
    """After an impact of the corner without restitution; mu_k limits the friction impulse."""
    lever, height = forces.lever, forces.height
    nn = 1.0 / body.mass + lever**2 / body.inertia
    tt = 1.0 / body.mass + height**2 / body.inertia
    nt = lever * height / body.inertia
    det = nn * tt - nt * nt
    pn = (nt * state.vx - tt * state.vz) / det
    pt = (nt * state.vz - nn * state.vx) / det
    vx = 0.0
    if abs(pt) > KINETIC_FRICTION * pn:
        mu = -math.copysign(KINETIC_FRICTION, pt)
        pn = -state.vz / (nn - mu * nt)
        pt = -mu * pn
        vx = state.vx + nt * pn + tt * pt
    omega = state.omega - (height * pt + lever * pn) / body.inertia
    return state._replace(pz=0.0, vx=vx, vz=0.0, omega=omega)


def next_mode(
    body: Body, law: ForceLaw, tau: float, state: State, event: str
) -> tuple[Mode, State]:
    """Mode and state after an event.

    event: "lift" (no normal force), "forward" and "back" (sticking has reached the limit and the
    corner gives way to +x or -x), "stop" (a slip has come to rest) or "touch".
    """
    if not 0.0 < state.theta < math.pi / 2:
        raise OutOfScope(f"theta = {state.theta} rad at tau = {tau}")
    if event == "lift":
        return FLIGHT, state
    if event == "forward":
        return Mode("slip", 1), state._replace(vx=0.0)
    if event == "back":
        return Mode("slip", -1), state._replace(vx=0.0)
    forces = law(tau, *state)
    if event == "touch":
        state = landed(body, forces, state)
        forces = law(tau, *state)
        if state.vx != 0.0:
            sign = 1 if state.vx > 0.0 else -1
            held = slipping(body, forces, state.omega, sign)[2] > 0.0
            return (Mode("slip", sign) if held else FLIGHT), state
    state = state._replace(vx=0.0)
    _, normal, friction = sticking(body, forces, state.omega)
    if normal <= 0.0:
        return FLIGHT, state
    if abs(friction) <= STATIC_FRICTION * normal:
        return STICK, state
    # It gives way against the force that would have held it.
    return Mode("slip", -1 if friction > 0.0 else 1), state


def tipping_time(problem: Problem) -> tuple[int, float]:
    """Segment and time into it at which the flat body at rest begins to turn about a corner.

    Until then its rear corner presses on the surface; the adhesion is shared by both.
    """
    body = problem.body
    a, b = body.half_length, body.half_height

    def rear(law: ForceLaw, tau: float) -> float:
        _, _, fx, fz, torque = law(tau, a, 0.0, 0.0, 0.0, 0.0, 0.0)
        if abs(fx) > STATIC_FRICTION * (body.adhesion - fz):
            raise OutOfScope("the flat body slides")
        return 0.5 * (body.adhesion - fz) - (torque + b * fx) / (2.0 * a)

    for index, segment in enumerate(problem.segments):
        law = force_law(problem, segment)
        low, high = 0.0, segment.end - segment.start
        if rear(law, high) > 0.0:
            continue
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if rear(law, middle) > 0.0 else (low, middle)
        return index, high
    raise OutOfScope("the body never tips")
