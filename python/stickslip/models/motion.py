"""One mass, or a motor and its load, with friction that sticks: the physics of all mechanics.

Coefficients are per unit of inertia, 0 where a term is absent::

    x'' = u - load - rate v - rate_asymmetry |v| - quadratic v|v| - cubic_damping v^3
          - stiffness x - square x^2 - cubic x^3 - gravity sin(x) - friction
    friction = sign(v) max(coulomb + sign(v) asymmetry, 0) + sign(v) stribeck exp(-(v / vs)^2)

`u` is the input, held from one switch to the next; with `swing` it is that times cos(x). At rest
friction holds what is below its limit. With a `gap` to each side or a `spring` there are two
masses: the motor's with the friction, and the load's, a `share` of the whole, with all that depends
on the place. Across the gap they meet without rebound and pull at nothing; the spring has a moment
of `spring` per angle and a `damping`.

C++ moves them (cpp/machines): exactly from event to event where the motion is linear
between events, else by steps of order 5.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _machines
from stickslip._util.arrays import Array


def moved(c: Mapping[str, ArrayLike], start: Array, t: Array, inputs: Array, late: Array) -> Array:
    """States at the times `t`, s: x and v, and y and w of the load, (readings, 4, vectors).

    NaN from where a motion has no finite state, or where it takes more than 100 000 steps and
    40 for each reading to follow it.

    Parameters
    ----------
    c : mapping of array_like, shape (vectors,) or ()
        Coefficients, see above; `gap`, `spring` and `damping` need a `share` between 0 and 1.
    start : ndarray, shape (2, vectors)
    inputs : ndarray, shape (1 + readings, vectors)
        The first before the record.
    late : ndarray, shape (vectors,)
        By how much the inputs act later than the readings, s.
    """
    vectors = start.shape[1]
    terms = [np.broadcast_to(c.get(name, 0.0), vectors) for name in _machines.motion_terms]
    return _machines.moved(np.stack(terms, axis=1), start.T, t, inputs.T, late).transpose(1, 2, 0)
