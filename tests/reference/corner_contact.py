"""One step's contact of the eight corners: who touches, sticks, slips, leaves and lands.

What a corner does is memory, as in the planar reference: a touching corner stays in contact until
its own reaction would pull, whatever rounding makes of its gap; a sticking corner holds until mu_s
no longer does, and then slips with mu_k; a slipping one sticks where it would turn back and mu_s
holds it. Adhesion belongs to the sides: each of the two rectangles of corners, left and right, has
half of it, shared by its touching corners, and what one side loses the other does not inherit.
"""

import numpy as np

from .cone import COMPLIANCE, MOST, largest, solve_cone
from .rigid_body import CORNERS, inner, record

# A corner slips if it moves by more than this part of what the step's largest impulse would do to
# it, a hundred times its compliance.
MOVES = 1e-6

ROUNDS = 250  # solutions within one step; eight corners change states ten times at most

# Counts of what happened.
LANDINGS, LEAVINGS, SLIPS, NEWTON_FAILED, UNSOLVED, STEPS, COUNTS = range(7)


def new_memory():
    """Memory of the corners between steps; flat on the plane, the four bottom corners stick.

    touching, slipping (8,) flags; slip (8, 2) m/s, velocity of a slipping corner; impulse (8, 3)
    N s in the last step, and the length of that, (1,) s.
    """
    memory = record(
        {"slip": (8, 2), "impulse": (8, 3), "length": (1,)}, {"touching": (8,), "slipping": (8,)}
    )
    memory["touching"] = [1, 1, 0, 0] * 2
    memory["length"] = 1.0
    return memory


def new_step():
    """Room for one step's contact.

    active (1,): number of corners in question; corner (8,): which they are. By corner: the flags
    fresh (lands in this step), gone (left in it), settled (its friction has been decided) and
    slides, and places at the middle and at the end of the step, (8, 3) m from the centre of mass.
    mu (8,), w, b, p, rho, image, matrix, right: in the order of `corner`, see cone.py.
    """
    size = 3 * MOST
    return record(
        {
            "mu": (8,), "middle": (8, 3), "end": (8, 3), "w": (size, size), "b": (size,),
            "p": (size,), "rho": (MOST,), "image": (size,), "matrix": (size, size),
            "right": (size,), "velocity": (3,), "impulse": (2, 3),
        },
        {
            "active": (1,), "corner": (8,), "fresh": (8,), "gone": (8,), "settled": (8,),
            "slides": (8,),
        },
    )  # fmt: skip


@inner
def coupling(step, lightness, turning):
    """Fill step.w: velocity at each active corner's end place per impulse at each middle place.

    lightness 1/kg, turning (3, 3) 1/(kg m^2). Impulses act at the middle of the step and velocities
    are those at its end; with both at one place the rocking would gain or lose energy.
    """
    n = step.active[0]
    for i in range(n):
        place = step.end[step.corner[i]]
        x, y, z = place[0], place[1], place[2]
        for j in range(n):
            lever = step.middle[step.corner[j]]
            for column in range(3):
                # turning (lever x axis), then its velocity at the end place.
                first, second = (column + 1) % 3, (column + 2) % 3
                ox = turning[0, first] * lever[second] - turning[0, second] * lever[first]
                oy = turning[1, first] * lever[second] - turning[1, second] * lever[first]
                oz = turning[2, first] * lever[second] - turning[2, second] * lever[first]
                step.w[3 * i, 3 * j + column] = oy * z - oz * y
                step.w[3 * i + 1, 3 * j + column] = oz * x - ox * z
                step.w[3 * i + 2, 3 * j + column] = ox * y - oy * x
                step.w[3 * i + column, 3 * j + column] += lightness
        k = 3 * i
        own = (step.w[k, k] + step.w[k + 1, k + 1] + step.w[k + 2, k + 2]) / 3.0
        for row in range(k, k + 3):
            step.w[row, row] += COMPLIANCE * own


@inner
def corner_velocity(velocity, spin, place, result):
    """velocity + spin x place, into result (3,)."""
    result[0] = velocity[0] + spin[1] * place[2] - spin[2] * place[1]
    result[1] = velocity[1] + spin[2] * place[0] - spin[0] * place[2]
    result[2] = velocity[2] + spin[0] * place[1] - spin[1] * place[0]


@inner
def _adhesion(step, memory, hold):
    """Impulse of adhesion, N s, and its moment about the centre of mass, into step.impulse (2, 3).

    hold: N s, of the whole body.
    """
    for j in range(3):
        step.impulse[0, j] = step.impulse[1, j] = 0.0
    for side in range(2):
        count = 0
        for i in range(4 * side, 4 * side + 4):
            count += int(memory.touching[i] and not step.gone[i])
        for i in range(4 * side, 4 * side + 4):
            if memory.touching[i] and not step.gone[i]:
                pull = 0.5 * hold / count
                step.impulse[0, 2] -= pull
                step.impulse[1, 0] -= step.middle[i, 1] * pull
                step.impulse[1, 1] += step.middle[i, 0] * pull


@inner
def _add_impulse(velocity, spin, lightness, turning, impulse, moment):
    """Add an impulse (N s) and its moment (N m s) to velocity and spin, in place."""
    for i in range(3):
        velocity[i] += lightness * impulse[i]
        spin[i] += turning[i, 0] * moment[0] + turning[i, 1] * moment[1] + turning[i, 2] * moment[2]


@inner
def solve_corners(
    step, memory, free, free_spin, velocity, spin, lightness, turning, hold, rebound, counts
):
    """Solve the active corners' cones; velocity and spin (3,) become those at the step's end.

    free, free_spin (3,): those that the body would have without contact; rebound (8,) m/s: normal
    velocity that each corner is to leave with.
    """
    n = step.active[0]
    for j in range(3):
        velocity[j], spin[j] = free[j], free_spin[j]
    _adhesion(step, memory, hold)
    _add_impulse(velocity, spin, lightness, turning, step.impulse[0], step.impulse[1])
    if n == 0:
        return
    coupling(step, lightness, turning)
    for i in range(n):
        c = step.corner[i]
        corner_velocity(velocity, spin, step.end[c], step.velocity)
        for j in range(3):
            step.b[3 * i + j] = step.velocity[j]
        step.b[3 * i + 2] -= rebound[c]
    failed = solve_cone(
        step.w, step.b, step.mu, n, step.p, step.rho, step.image, step.matrix, step.right
    )
    counts[NEWTON_FAILED] += int(failed == 1)
    counts[UNSOLVED] += int(failed == 2)
    for j in range(3):
        step.impulse[0, j] = step.impulse[1, j] = 0.0
    for i in range(n):
        place = step.middle[step.corner[i]]
        x, y, z = place[0], place[1], place[2]
        px, py, pz = step.p[3 * i], step.p[3 * i + 1], step.p[3 * i + 2]
        step.impulse[0, 0] += px
        step.impulse[0, 1] += py
        step.impulse[0, 2] += pz
        step.impulse[1, 0] += y * pz - z * py
        step.impulse[1, 1] += z * px - x * pz
        step.impulse[1, 2] += x * py - y * px
    _add_impulse(velocity, spin, lightness, turning, step.impulse[0], step.impulse[1])


@inner
def begin_contact(step, memory, length, mu_static, mu_kinetic):
    """Put the touching corners in question, as they were."""
    n = 0
    for c in range(CORNERS):
        step.gone[c] = step.fresh[c] = step.settled[c] = 0
        step.slides[c] = memory.slipping[c]
        if memory.touching[c]:
            step.corner[n] = c
            step.mu[n] = mu_kinetic if memory.slipping[c] else mu_static
            for j in range(3):
                step.p[3 * n + j] = memory.impulse[c, j] * length / memory.length[0]
            n += 1
    step.active[0] = n


@inner
def drop_leaving(step):
    """Take corners without reaction out of the question; returns whether there were any.

    One that lands in this step may stay without: another's impulse keeps it off the plane.
    """
    kept, n = 0, step.active[0]
    for i in range(n):
        c = step.corner[i]
        if step.p[3 * i + 2] <= 0.0 and not step.fresh[c]:
            step.gone[c] = True
            continue
        step.corner[kept], step.mu[kept] = c, step.mu[i]
        for j in range(3):
            step.p[3 * kept + j] = step.p[3 * i + j]
        kept += 1
    step.active[0] = kept
    return kept < n


@inner
def settle_friction(step, memory, velocity, spin, impact, mu_static, mu_kinetic):
    """Set each corner's coefficient by how it moves.

    Returns 0 if all is as it was, 1 if a state changed that needs no other solution, 2 if one did
    that does. In an impact what slips is stopped by kinetic friction or not at all.
    """
    verdict, n = 0, step.active[0]
    strongest = largest(step.p, 3 * n)
    for i in range(n):
        c = step.corner[i]
        corner_velocity(velocity, spin, step.end[c], step.velocity)
        ux, uy = step.velocity[0], step.velocity[1]
        mobility = step.w[3 * i, 3 * i] + step.w[3 * i + 1, 3 * i + 1]
        moves = np.sqrt(ux * ux + uy * uy) > MOVES * strongest * mobility
        back = ux * memory.slip[c, 0] + uy * memory.slip[c, 1] < 0.0
        if moves and step.mu[i] != mu_kinetic:
            step.mu[i], step.slides[c], step.settled[c], verdict = mu_kinetic, True, True, 2
        elif moves and back and not impact and not step.settled[c]:
            step.mu[i], step.slides[c], step.settled[c], verdict = mu_static, False, True, 2
        elif moves != step.slides[c]:
            step.slides[c] = moves
            verdict = max(verdict, 1)
    return verdict


@inner
def land(step, memory, heights, reach, velocity, spin, restitution, slowest, mu_kinetic, rebound):
    """Take corners that would end below the plane into the question; returns how many.

    With the first of them, those land too that approach and would end less than `reach`, m, above
    it. heights (8,): m, at the end of the step. A rebound slower than `slowest`, m/s, is none.
    """
    count, lowest = 0, 0.0
    for c in range(CORNERS):
        if not (memory.touching[c] or step.gone[c]):
            lowest = min(lowest, heights[c])
    if lowest >= 0.0:
        return 0
    for c in range(CORNERS):
        if memory.touching[c] or step.fresh[c] or step.gone[c] or heights[c] >= reach:
            continue
        corner_velocity(velocity, spin, step.end[c], step.velocity)
        if step.velocity[2] >= 0.0:
            continue
        n = step.active[0]
        step.active[0] = n + 1
        step.corner[n], step.mu[n], step.fresh[c], step.slides[c] = c, mu_kinetic, True, False
        step.p[3 * n] = step.p[3 * n + 1] = step.p[3 * n + 2] = 0.0
        back = -restitution * step.velocity[2]
        rebound[c] = back if back > slowest else 0.0
        count += 1
    if count > 0:
        for i in range(step.active[0]):
            if memory.slipping[step.corner[i]]:
                step.mu[i] = mu_kinetic
    return count


@inner
def remember(step, memory, velocity, spin, rebound, length, counts):
    """Make what the step came to the corners' memory. length: of the step, s."""
    memory.length[0] = length
    for c in range(CORNERS):
        memory.slip[c, 0] = memory.slip[c, 1] = 0.0
        counts[LEAVINGS] += int(step.gone[c])
        if step.gone[c]:
            memory.touching[c] = memory.slipping[c] = False
    for i in range(step.active[0]):
        c = step.corner[i]
        counts[LANDINGS] += int(step.fresh[c])
        if step.fresh[c] and (rebound[c] > 0.0 or step.p[3 * i + 2] <= 0.0):
            continue
        counts[SLIPS] += int(step.slides[c] and not memory.slipping[c])
        memory.touching[c], memory.slipping[c] = True, step.slides[c]
        for j in range(3):
            memory.impulse[c, j] = step.p[3 * i + j]
        if step.slides[c]:
            corner_velocity(velocity, spin, step.end[c], step.velocity)
            memory.slip[c, 0], memory.slip[c, 1] = step.velocity[0], step.velocity[1]
