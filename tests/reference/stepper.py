"""The time-stepping kernel: velocities live half-way between the positions (leapfrog).

With the forces at t_k in the middle of the step from v(k-1/2) to v(k+1/2), and the contact
directions taken at the middle of the displacement, motion within one contact mode is second order.

A switch that is rounded to whole steps leaves an error of first order that scatters from run to
run; near a grazing event that scatter picks the wrong branch. The forces that jump at a switch
(adhesion at landing and leaving, friction at the onset of slip) are therefore weighted with the
fraction of the step for which they act. Step k of the forces reaches from t_k - step/2 to
t_k + step/2.
"""

import os
from collections import namedtuple

import numpy as np
from numba import njit

from . import laws
from .circuit import advance_circuits
from .contact import (
    OPEN,
    STICK,
    corner_offsets,
    impact_gains,
    keeping_impulse,
    pick_corners,
    solve_one,
    solve_two,
)
from .field import wire_loop_planar
from .shaken import ANGLE, EXISTS, MASS, inner_force, strike, surface

# SI throughout. moment is V M in A m^2; mirror is -1 if the robot faces the world's -x; gain (n,)
# is each coil's field over what the field model gives; gradient is the same of all gradients.
Model = namedtuple(
    "Model",
    "half_length half_height mass inertia moment mu_static mu_kinetic lean adhesion restitution "
    "drag_linear drag_quadratic drag_rotational gravity_x gravity_z ambient_x ambient_z "
    "misalignment gradient gain mirror frequency laws circuit",
)

# The field is re-evaluated when the centre of mass has moved this far; in between its first-order
# expansion errs by (B / (1 cm)^2) (1 um)^2 / 2, about 1e-8 of B.
FIELD_REFRESH = 1e-6  # m

QUARTER_TURN = 0.5 * np.pi

# Slots of what `march` returns.
X_BEGIN, X_END, AIRBORNE, THETA_MIN, THETA_MAX, SLIP_UP, SLIP_DOWN, MARKS = range(8)


@njit
def _wrench(model, near, dx, dz, amperes, theta, arguments):
    """(force x, force z, torque) in N, N m at the centre of mass: magnet and weight, Eqs. (8)-(9).

    near (n, 6): field and derivatives per ampere at a point from which the body is (dx, dz) m away;
    amperes (n,): of the coils, as the field has them.
    """
    bx = bz = bxx = bxz = bzx = bzz = 0.0
    for coil in range(amperes.shape[0]):
        c, current = near[coil], model.gain[coil] * amperes[coil]
        bx += current * (c[0] + c[2] * dx + c[3] * dz)
        bz += current * (c[1] + c[4] * dx + c[5] * dz)
        bxx += current * c[2]
        bxz += current * c[3]
        bzx += current * c[4]
        bzz += current * c[5]
    strength = 1.0 + laws.total(model.laws.field, arguments)
    slope = strength * model.gradient
    bx, bz = model.ambient_x + strength * bx, model.ambient_z + strength * bz
    mx = model.moment * np.cos(theta + model.misalignment)
    mz = -model.moment * np.sin(theta + model.misalignment)
    force_x = slope * (mx * bxx + mz * bxz) + model.mass * model.gravity_x
    force_z = slope * (mx * bzx + mz * bzz) + model.mass * model.gravity_z
    return force_x, force_z, mz * bx - mx * bz


@njit
def _landing_time(gap, approach, step):
    """Time of landing after t_k in s, within half a step; gap in m at t_k, approach < 0 in m/s."""
    return min(max(-gap / approach, -0.5 * step), 0.5 * step)


@njit
def _onset_coefficient(load_before, load_now, mu_static, mu_kinetic):
    """Mean friction coefficient of the step in which sticking ends.

    load: |friction| over its sticking limit at t_(k-1) and t_k, below and above 1.
    """
    moment = (1.0 - load_before) / (load_now - load_before) - 0.5
    return mu_kinetic + moment * (mu_static - mu_kinetic)


@njit
def _leaving_impulse(reaction, share_given, keep_n, keep_t, hold):
    """(normal, tangential) impulse in N s still due at a corner that is found to leave at t_k.

    reaction: its normal impulse of step k-1. keep_n, keep_t: what would keep it closed in step k;
    keep_n < 0. hold: adhesion times the step. share_given: the share of step k-1 for which it was
    held after landing in that very step, else negative.
    """
    if share_given >= 0.0:
        # It landed and was let go at once: take back adhesion and the pull that held it down.
        return share_given * (hold - keep_n), -share_given * keep_t
    if keep_n >= 0.0:
        return 0.0, 0.0
    # The reaction vanished between t_(k-1) and t_k; adhesion acted until then.
    return -(reaction / (reaction - keep_n) - 0.5) * hold, 0.0


@njit(cache="NUMBA_CACHE_DIR" in os.environ)
def march(
    model, wires, seg_start, seg_level, seg_slope, step, steps, window, sample_rate, samples, shaken
):  # fmt: skip
    """Integrate from rest, lying flat with its centre at x = 0.

    wires (n, 5, 3) m of the coils; seg_*: segments of the modes' voltages; window (2,) s: interval
    of the averages; shaken: see shaken.py; samples (n, 2): filled with x and theta at multiples of
    1 / sample_rate.
    Returns the marks of the window, see the slots above: x in m at its ends, time without contact
    in s, angles in rad, travel in m of a slipping corner while theta rises and falls.
    """
    half_length, half_height = model.half_length, model.half_height
    marks = np.zeros(MARKS)
    marks[THETA_MIN], marks[THETA_MAX] = np.inf, -np.inf
    rx_now, rz_now = np.empty(4), np.empty(4)
    rx, rz = np.empty(4), np.empty(4)
    # Memory of each corner; the last three: see _leaving_impulse, _onset_coefficient.
    touching = np.array([True, True, False, False])
    slip = np.zeros(4, np.int64)
    reaction = np.zeros(4)
    load = np.ones(4)
    share_given = np.full(4, -1.0)
    # The corners in question within one step, at most two.
    chosen = np.zeros(2, np.int64)
    old = np.zeros(2, np.bool_)
    pair_rx, target, bound = np.empty(2), np.zeros(2), np.zeros(2)
    state = np.zeros(2, np.int64)
    outcome = np.zeros(2, np.int64)

    x, z, theta = 0.0, half_height, 0.0
    vx = vz = omega = 0.0
    circuit = model.circuit
    modes, coils = circuit.to_coils.shape[1], circuit.to_coils.shape[0]
    current, lagged, amperes = np.zeros(modes), np.zeros(modes), np.zeros(coils)
    segment, sample = 0, 0
    decay = np.exp(-step / circuit.time_constant)
    at_x, at_z = np.inf, np.inf
    near = np.zeros((coils, 6))
    arguments = np.zeros(10)
    arguments[laws.FREQUENCY] = model.frequency
    # Place of the surface at the step before and now; place and velocity of the inner mass.
    was_x, was_z = surface(shaken, -step)
    now_x, now_z = surface(shaken, 0.0)
    inner_place = inner_velocity = 0.0
    landed = 0.0  # s, when the body last came down from flight

    for k in range(steps):
        t, t_next = k * step, (k + 1) * step
        # The body's own coordinates count from the surface.
        next_x, next_z = surface(shaken, t_next)
        jump_x = (next_x - 2.0 * now_x + was_x) / step
        jump_z = (next_z - 2.0 * now_z + was_z) / step
        ground_x, ground_z = x + now_x, z + now_z
        if abs(ground_x - at_x) > FIELD_REFRESH or abs(ground_z - at_z) > FIELD_REFRESH:
            at_x, at_z = ground_x, ground_z
            for coil in range(coils):
                terms = wire_loop_planar(wires[coil], ground_x, ground_z)
                for j in range(6):
                    near[coil, j] = terms[j]
        for coil in range(coils):
            amperes[coil] = 0.0
            for mode in range(modes):
                amperes[coil] += circuit.to_coils[coil, mode] * lagged[mode]
        # All coils are in-plane but the clamp, the second one.
        arguments[laws.CURRENT] = np.sqrt(np.sum(amperes**2) - amperes[1] ** 2)
        grounded = touching.any()
        arguments[laws.TIME], arguments[laws.ANGLE], arguments[laws.RATE] = t, theta, abs(omega)
        arguments[laws.SPEED] = np.hypot(vx, vz)
        arguments[laws.AGE] = t - landed if grounded else 0.0
        arguments[laws.LOAD] = reaction.sum() / step
        force_x, force_z, torque = _wrench(
            model, near, ground_x - at_x, ground_z - at_z, amperes, theta, arguments
        )
        spring = 0.0
        line_x = np.cos(theta + shaken.inner[ANGLE])
        line_z = -np.sin(theta + shaken.inner[ANGLE])
        if shaken.inner[EXISTS] > 0.0:
            spring = inner_force(shaken, inner_place, inner_velocity, t)
            weight_x = shaken.inner[MASS] * (model.gravity_x - jump_x / step)
            weight_z = shaken.inner[MASS] * (model.gravity_z - jump_z / step)
            along = weight_x * line_x + weight_z * line_z
            force_x += weight_x - (along + spring) * line_x
            force_z += weight_z - (along + spring) * line_z

        # Drag acts on the mean of the old and the new velocity: it damps at any step length.
        damped = 0.5 * step * (1.0 + laws.total(model.laws.fluid, arguments))
        drag = damped * (model.drag_linear + laws.total(model.laws.drag, arguments))
        twist = damped * (model.drag_quadratic * abs(omega) + model.drag_rotational)
        hold = step * model.adhesion * (1.0 + laws.total(model.laws.adhesion, arguments))
        im = 1.0 / (model.mass + drag)
        ij = 1.0 / (model.inertia + twist)
        # Velocity at the end of the step if nothing touched.
        push_x = im * ((model.mass - drag) * vx + step * force_x - model.mass * jump_x)
        push_z = im * ((model.mass - drag) * vz + step * force_z - model.mass * jump_z)
        if shaken.rests > 0.0:
            push_x -= im * drag * (next_x - was_x) / step
            push_z -= im * drag * (next_z - was_z) / step
        push_omega = ij * ((model.inertia - twist) * omega + step * torque)

        corner_offsets(theta, half_length, half_height, rx_now, rz_now)
        corner_offsets(theta + 0.5 * step * omega, half_length, half_height, rx, rz)
        n = pick_corners(z, vz, omega, step, touching, rz_now, rx, chosen, old)
        new_vx, new_vz, new_omega = push_x, push_z, push_omega
        landing = after = 0.0
        # Where Newton's law would create energy, bisection finds the largest restitution that does
        # not: `least` does not, `most` may.
        restitution, least, most = model.restitution, 0.0, model.restitution

        while n > 0:
            impact = not old[0] or (n == 2 and not old[1])
            held = int(old[0]) + int(n == 2 and old[1])
            if n == 2:
                # The face lies down within this step: its final position replaces the rotated one.
                flat = np.round(theta / QUARTER_TURN) * QUARTER_TURN
                corner_offsets(flat, half_length, half_height, rx, rz)
            # Adhesion, shared by the corners that touch, and what each corner may do.
            free_z, free_omega = push_z, push_omega
            middle = rx[chosen[0]] if n == 1 else 0.0
            arguments[laws.PLACE] = model.mirror * (x + middle)
            slide = 0.0
            for j in range(n):
                slide = max(slide, abs(vx + rz[chosen[j]] * omega))
            arguments[laws.SLIP_SPEED] = slide
            rough = 1.0 + laws.total(model.laws.friction, arguments)
            mu_static, mu_kinetic = rough * model.mu_static, rough * model.mu_kinetic
            for j in range(n):
                i = chosen[j]
                target[j] = 0.0
                if old[j]:
                    pull = hold / held
                    state[j] = slip[i]
                    # In an impact a slipping corner is stopped by kinetic friction or not at all.
                    stopped = impact and slip[i] != STICK
                    bound[j] = mu_kinetic if stopped else mu_static
                else:
                    # A landing corner may stop at once, but only kinetic friction can stop it.
                    state[j] = STICK if j == 0 else state[0]
                    bound[j] = mu_kinetic
                    approach = vz - rx[i] * omega
                    gain = push_z - vz - rx[i] * (push_omega - omega)
                    landing = _landing_time(z + rz_now[i], approach, step)
                    after = 0.5 - landing / step
                    # Landing on a second corner only redistributes what the first already holds.
                    share_given[i] = after if held == 0 else 0.0
                    # A hop shorter than one step cannot be followed: the corner stays down.
                    if -restitution * approach > 0.5 * abs(gain):
                        share_given[i] = 0.0
                        target[j] = -restitution * approach
                        if n == 1:
                            target[j] += (after - restitution * (1.0 - after)) * gain
                    pull = hold * share_given[i] / n
                free_z -= im * pull
                free_omega += ij * pull * rx[i]
            mu = mu_kinetic
            if not impact:
                mu += rough * laws.total(model.laws.sliding, arguments)
            keep_n = keep_t = 0.0
            if n == 1:
                i = chosen[0]
                keep_n, keep_t = keeping_impulse(
                    push_x, free_z, free_omega, rx[i], rz[i], im, ij, state[0], mu,
                    model.lean,
                )  # fmt: skip
                load_now = 1.0
                if not impact and state[0] == STICK and keep_n > 0.0:
                    way = -1.0 if keep_t > 0.0 else 1.0
                    load_now = abs(keep_t) / (mu_static * (1.0 + model.lean * way) * keep_n)
                    if load_now > 1.0 > load[i]:
                        mu = _onset_coefficient(load[i], load_now, mu_static, mu)
                load[i] = load_now
                s = solve_one(
                    push_x, free_z, free_omega, rx[i], rz[i], target[0], im, ij,
                    state[0], bound[0], mu, model.lean,
                )  # fmt: skip
            else:
                pair_rx[0], pair_rx[1] = rx[chosen[0]], rx[chosen[1]]
                s = solve_two(
                    push_x, free_z, free_omega, pair_rx, rz[chosen[0]], target, im, ij,
                    state, bound, mu, model.lean,
                )  # fmt: skip
                load[chosen[0]] = load[chosen[1]] = 1.0
            new_vx, new_vz, new_omega = s.vx, s.vz, s.omega
            if impact and most > least:
                gains = impact_gains(
                    (vx, vz, omega), (push_x, push_z, push_omega), (s.vx, s.vz, s.omega),
                    after if n == 1 else 0.0, im, ij,
                )  # fmt: skip
                least, most = (least, restitution) if gains else (restitution, most)
                if most - least > 1e-9:
                    restitution = 0.5 * (least + most)
                    continue
            outcome[0], outcome[1] = s.outcome0, s.outcome1
            left0 = old[0] and outcome[0] == OPEN
            left1 = n == 2 and old[1] and outcome[1] == OPEN
            if not (left0 or left1):
                break
            # A corner that leaves has lost its adhesion already, and what it held passes to the
            # corner that stays: solve again without it.
            for j in range(n):
                if left0 if j == 0 else left1:
                    touching[chosen[j]] = False
            if n == 1:
                i = chosen[0]
                due_n, due_t = _leaving_impulse(reaction[i], share_given[i], keep_n, keep_t, hold)
                push_x += im * due_t
                push_z += im * due_n
                push_omega += ij * (rz[i] * due_t - rx[i] * due_n)
            restitution, least, most = model.restitution, 0.0, model.restitution
            if left0 and not left1:
                chosen[0], old[0] = chosen[1], old[1]
            n = n - int(left0) - int(left1)
            corner_offsets(theta + 0.5 * step * omega, half_length, half_height, rx, rz)
            new_vx, new_vz, new_omega = push_x, push_z, push_omega

        # A landing happens where the old motion meets the plane, up to half a step before or after
        # t_k; until then the body moves as before.
        before_x, before_theta = x, theta
        x += landing * vx + (step - landing) * new_vx
        z += landing * vz + (step - landing) * new_vz
        theta += landing * omega + (step - landing) * new_omega

        if n > 0 and not grounded:
            landed = t + landing
        closed = 0
        first = -1
        reaction[:] = 0.0
        for j in range(n):
            i = chosen[j]
            if outcome[j] == OPEN or target[j] > 0.0:
                continue
            touching[i] = True
            slip[i] = outcome[j]
            reaction[i] = s.p0 if j == 0 else s.p1
            if old[j]:
                share_given[i] = -1.0
            closed += 1
            if first < 0:
                first = i
        # Close the gap exactly, from above as well as from below; the first corner keeps its place.
        corner_offsets(theta, half_length, half_height, rx, rz)
        if closed == 2:
            place = x + rx[first]
            theta = np.round(theta / QUARTER_TURN) * QUARTER_TURN
            corner_offsets(theta, half_length, half_height, rx, rz)
            x = place - rx[first]
        if closed > 0:
            z = -rz[first]

        while sample < samples.shape[0] and sample / sample_rate <= t_next:
            part = (sample / sample_rate - t) / step
            samples[sample, 0] = before_x + part * (x - before_x)
            samples[sample, 0] += now_x + part * (next_x - now_x)
            samples[sample, 1] = before_theta + part * (theta - before_theta)
            sample += 1
        for end in range(2):
            if t < window[end] <= t_next:
                part = (window[end] - t) / step
                marks[end] = before_x + now_x + part * (x - before_x + next_x - now_x)
        if window[0] <= t < window[1]:
            marks[AIRBORNE] += step if closed == 0 else 0.0
            marks[THETA_MIN] = min(marks[THETA_MIN], theta)
            marks[THETA_MAX] = max(marks[THETA_MAX], theta)
            if closed == 1 and slip[first] != STICK:
                travel = x + rx[first] - before_x - rx_now[first]
                marks[SLIP_UP if new_omega > 0.0 else SLIP_DOWN] += travel
        if shaken.inner[EXISTS] > 0.0:
            gained = (new_vx - vx + jump_x) * line_x + (new_vz - vz + jump_z) * line_z
            weight = model.gravity_x * line_x + model.gravity_z * line_z
            gain = step * (spring / shaken.inner[MASS] + weight) - gained
            inner_velocity += gain
            inner_place += step * inner_velocity
            corners = (first, chosen[1] if closed == 2 else first)
            (inner_place, inner_velocity), (vx, vz, omega), since = strike(
                shaken, model, (inner_place, inner_velocity), (new_vx, new_vz, new_omega), corners,
                (line_x, line_z), touching, slip, (rx, rz), gain,
            )  # fmt: skip
            x += since * (vx - new_vx)
            z += since * (vz - new_vz)
            theta += since * (omega - new_omega)
        else:
            vx, vz, omega = new_vx, new_vz, new_omega
        was_x, was_z, now_x, now_z = now_x, now_z, next_x, next_z
        segment = advance_circuits(
            t, t_next, decay, segment, seg_start, seg_level, seg_slope, current, lagged, circuit
        )
    return marks
