"""Angles at rest in a held field, by the balance of torques about the corner that stays down."""

import numpy as np

from .simulate import model_without_drive

QUARTER_TURN = 0.5 * np.pi
# Beyond this scan the first angle of balance is found to rounding by bisection.
SCAN, HALVINGS = 400, 60


def _tipping(model, bx, bz, theta, sense):
    """Torque in N m that turns the block on about its front (sense 1) or rear (-1) corner."""
    moment = model.moment
    angle = theta + model.misalignment
    magnetic = -moment * (bx * np.sin(angle) + bz * np.cos(angle))
    # Offset of the corner from the centre of mass; the surface bears the weight there.
    ahead = sense * model.half_length
    rx = ahead * np.cos(theta) - model.half_height * np.sin(theta)
    rz = -ahead * np.sin(theta) - model.half_height * np.cos(theta)
    normal, along = -model.mass * model.gravity_z, -model.mass * model.gravity_x
    return sense * (magnetic + rz * along - rx * normal)


def static_tilt_reference(fields, robot=None, contact=None, effects=None):
    """Angle in rad, (n,), at which the block rests in fields (Bx, Bz) in T, (n, 2).

    It comes from lying flat, with adhesion at both ends until one is lifted, and stands up to a
    quarter turn at most. Arguments as those of `simulate_reference`; what it measures is not here.
    """
    model = model_without_drive(robot, contact, None, effects)
    result = []
    for field_x, field_z in np.atleast_2d(fields):
        bx, bz = field_x + model.ambient_x, field_z + model.ambient_z
        # The end that is lifted first is torn off against half of the adhesion.
        hold = model.adhesion * model.half_length
        excess = {sense: _tipping(model, bx, bz, 0.0, sense) - hold for sense in (1, -1)}
        sense = max(excess, key=lambda each: excess[each])
        if excess[sense] <= 0.0:
            result.append(0.0)
            continue
        angles = np.linspace(0.0, QUARTER_TURN, SCAN)
        turning = np.array([_tipping(model, bx, bz, sense * each, sense) for each in angles])
        stops = np.flatnonzero(turning <= 0.0)
        if len(stops) == 0:
            result.append(sense * QUARTER_TURN)
            continue
        low, high = angles[max(stops[0] - 1, 0)], angles[stops[0]]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if _tipping(model, bx, bz, sense * middle, sense) > 0.0:
                low = middle
            else:
                high = middle
        result.append(sense * 0.5 * (low + high))
    return np.array(result)
