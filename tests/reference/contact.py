"""Complementarity with Coulomb friction at velocity and impulse level, for one or two corners.

A corner at (rx, rz) from the centre of mass moves normally with vz - rx omega and tangentially
with vx + rz omega. Given the velocity that the step would end with if nothing touched, find
impulses with

    0 <= Pn,  un >= target,  Pn (un - target) = 0,
    stick: ut = 0 and |Pt| <= (bound) Pn,   slip: Pt = -sign(ut) (kinetic) Pn.

Both coefficients are 1 + lean times as large for slip to the front, and 1 - lean to the rear.
`target` is 0, or -e times the approach speed at a corner that lands; `stepper.march` reduces e
where the kinetic energy would grow. States and outcomes share the same numbers: OPEN, STICK, and
+1 / -1 for the sign of the slip velocity.
"""

from collections import namedtuple

import numpy as np
from numba import njit

OPEN = 9
STICK = 0

# Velocity at the end of the step (m/s, m/s, rad/s), impulses of the two corners (N s), their
# outcomes, and whether only an impulse beyond the regular laws could answer (Painleve).
Solution = namedtuple("Solution", "vx vz omega p0 p1 outcome0 outcome1 irregular")


@njit
def _one_stick(vx, vz, omega, rx, rz, target, im, ij):
    """(Pn, Pt) in N s that stop the tangential and set the normal velocity of one corner."""
    ann = im + ij * rx * rx
    att = im + ij * rz * rz
    ant = -ij * rx * rz
    bn = target - (vz - rx * omega)
    bt = -(vx + rz * omega)
    det = ann * att - ant * ant
    return (att * bn - ant * bt) / det, (ann * bt - ant * bn) / det


@njit
def _one_slip(vx, vz, omega, rx, rz, target, im, ij, mu, sign):
    """(exists, Pn, Pt, ut at the end) of a corner that slips in the direction `sign`."""
    ann = im + ij * rx * rx
    att = im + ij * rz * rz
    ant = -ij * rx * rz
    effective = ann - sign * mu * ant
    if effective == 0.0:
        return False, 0.0, 0.0, 0.0
    pn = (target - (vz - rx * omega)) / effective
    pt = -sign * mu * pn
    ut = vx + rz * omega + ant * pn + att * pt
    return pn >= 0.0 and sign * ut >= 0.0, pn, pt, ut


@njit
def keeping_impulse(vx, vz, omega, rx, rz, im, ij, state, mu, lean):
    """(Pn, Pt) in N s that would keep one corner closed as it sticks or slips now.

    Pn < 0 where only a pull could do so: the corner leaves.
    """
    if state == STICK:
        return _one_stick(vx, vz, omega, rx, rz, 0.0, im, ij)
    slipping = mu * (1.0 + lean * state)
    _, pn, pt, _ = _one_slip(vx, vz, omega, rx, rz, 0.0, im, ij, slipping, state)
    return pn, pt


@njit
def solve_one(vx, vz, omega, rx, rz, target, im, ij, state, bound, mu, lean):
    """One corner. `state` is STICK, +1, -1; `bound` the sticking limit, `mu` the slipping one.

    The present state is tried first: where several answers exist the contact remembers.
    """
    un = vz - rx * omega
    ps, ts = _one_stick(vx, vz, omega, rx, rz, target, im, ij)
    # The corner moves against the force that would have held it.
    way = -1 if ts > 0.0 else 1
    can_stick = ps >= 0.0 and abs(ts) <= bound * (1.0 + lean * way) * ps
    outcome = OPEN
    pn = pt = 0.0
    irregular = False
    first = state if state != STICK else way
    ahead, behind = mu * (1.0 + lean * first), mu * (1.0 - lean * first)
    forward, pf, tf, _ = _one_slip(vx, vz, omega, rx, rz, target, im, ij, ahead, first)
    back, pb, tb, _ = _one_slip(vx, vz, omega, rx, rz, target, im, ij, behind, -first)
    if state == STICK and can_stick:
        outcome, pn, pt = STICK, ps, ts
    elif forward:
        outcome, pn, pt = first, pf, tf
    elif un >= target:
        outcome = OPEN
    elif can_stick:
        outcome, pn, pt = STICK, ps, ts
    elif back:
        outcome, pn, pt = -first, pb, tb
    else:
        # No force answers: the tangential velocity is stopped by an impulse without collision.
        irregular = True
        outcome, pn, pt = STICK, max(ps, 0.0), ts if ps >= 0.0 else 0.0
        if ps < 0.0:
            pn = (target - un) / (im + ij * rx * rx)
    return Solution(
        vx + im * pt,
        vz + im * pn,
        omega + ij * (rz * pt - rx * pn),
        pn,
        0.0,
        outcome,
        OPEN,
        irregular,
    )


@njit
def _pair_slip(total, moment, rx, rz, mu, sign):
    """(P0, P1) of two corners of a lying face that slip together in the direction `sign`.

    total = P0 + P1 and moment = -rx0 P0 - rx1 P1 + rz Pt follow from the two normal velocities.
    """
    a0 = -rx[0] - sign * mu * rz
    a1 = -rx[1] - sign * mu * rz
    p0 = (moment - a1 * total) / (a0 - a1)
    return p0, total - p0


@njit
def solve_two(vx, vz, omega, rx, rz, target, im, ij, state, bound, mu, lean):
    """Two corners of one face that lies on the plane, at rx (2,) and one common rz.

    target, state and bound are (2,). Both slip at one speed, so they stick or slip together, with
    the sum of their limits as the sticking limit. `mu` is the slipping coefficient of both.
    """
    # Both corners stay closed: the normal velocities fix vz and omega.
    omega_end = (target[0] - target[1]) / (rx[1] - rx[0])
    vz_end = target[0] + rx[0] * omega_end
    total = (vz_end - vz) / im
    moment = (omega_end - omega) / ij
    pt = (-rz * omega_end - vx) / im
    lever = rz * pt - moment
    p0 = (lever - rx[1] * total) / (rx[0] - rx[1])
    p1 = total - p0
    way = -1 if pt > 0.0 else 1
    limit = (1.0 + lean * way) * (bound[0] * p0 + bound[1] * p1)
    can_stick = p0 >= 0.0 and p1 >= 0.0 and abs(pt) <= limit
    joint = state[0]
    first = joint if joint != STICK else way
    if joint == STICK and can_stick:
        return Solution(vx + im * pt, vz_end, omega_end, p0, p1, STICK, STICK, False)
    for attempt in range(2):
        sign = first if attempt == 0 else -first
        if attempt == 1 and joint != STICK and can_stick:
            return Solution(vx + im * pt, vz_end, omega_end, p0, p1, STICK, STICK, False)
        slipping = mu * (1.0 + lean * sign)
        q0, q1 = _pair_slip(total, moment, rx, rz, slipping, sign)
        vx_end = vx - im * sign * slipping * (q0 + q1)
        if q0 >= 0.0 and q1 >= 0.0 and sign * (vx_end + rz * omega_end) >= 0.0:
            return Solution(vx_end, vz_end, omega_end, q0, q1, sign, sign, False)
    # One corner opens, or both. The one that the closed solution would pull is tried as open first.
    order = 0 if p0 >= p1 else 1
    for attempt in range(2):
        i = order if attempt == 0 else 1 - order
        one = solve_one(vx, vz, omega, rx[i], rz, target[i], im, ij, state[i], bound[i], mu, lean)
        other_velocity = one.vz - rx[1 - i] * one.omega
        if not one.irregular and one.outcome0 != OPEN and other_velocity >= target[1 - i]:
            if i == 0:
                return one
            return Solution(one.vx, one.vz, one.omega, 0.0, one.p0, OPEN, one.outcome0, False)
    if vz - rx[0] * omega >= target[0] and vz - rx[1] * omega >= target[1]:
        return Solution(vx, vz, omega, 0.0, 0.0, OPEN, OPEN, False)
    # Nothing regular is left: hold what the closed solution presses and stop the slip.
    return Solution(vx + im * pt, vz_end, omega_end, max(p0, 0.0), max(p1, 0.0), STICK, STICK, True)


@njit
def corner_offsets(theta, half_length, half_height, rx, rz):
    """Offsets of the four corners from the centre of mass in m, into rx (4,) and rz (4,).

    Order: front bottom, rear bottom, rear top, front top (as the block lies at theta = 0), so that
    neighbours in the list share a face.
    """
    c = np.cos(theta)
    s = np.sin(theta)
    for i in range(4):
        a = half_length if i == 0 or i == 3 else -half_length
        b = -half_height if i < 2 else half_height
        rx[i] = a * c + b * s
        rz[i] = -a * s + b * c


@njit
def pick_corners(z, vz, omega, step, touching, rz_now, rx_mid, chosen, old):
    """Number of corners in question (at most two), written into chosen (2,) and old (2,).

    They are those in contact, whatever their gap, and those that would be below the plane half a
    step on. A loaded corner is dropped by its own reaction only: one that rounding or rotation
    lifts for a step would lose adhesion and stick for no reason, an error that no smaller step
    would cure.
    """
    n = 0
    for i in range(4):
        if touching[i] and n < 2:
            chosen[n] = i
            old[n] = True
            n += 1
    for i in range(4):
        if not touching[i] and n < 2:
            approach = vz - rx_mid[i] * omega
            if approach < 0.0 and z + rz_now[i] + 0.5 * step * approach < 0.0:
                chosen[n] = i
                old[n] = False
                n += 1
    return n


@njit
def impact_gains(before, push, end, after, im, ij):
    """Whether an impact raises the kinetic energy, from (vx, vz, omega) at the ends of the step.

    push: at the end if nothing touched. after: part of the step that follows the impact; what the
    forces of the step do before and after it is taken out of the velocities.
    """
    gain = 0.0
    for i in range(3):
        force = push[i] - before[i]
        arriving, leaving = before[i] + (1.0 - after) * force, end[i] - after * force
        gain += (leaving * leaving - arriving * arriving) / (ij if i == 2 else im)
    return gain > 0.0
