"""Laws that change with the motion, as tables of terms: what of, in which form, how strong.

A term adds amplitude x form(argument / scale) to a quantity. Every effect that is a law of
friction, adhesion, drag or field is one term, and so is every law that no library of causes has.
"""

from collections import namedtuple

import numpy as np
from numba import njit

# Of what a term is a function. slip_speed, speed (m/s) and rate (rad/s) are sizes; load is the
# normal force of the touching corners in N, angle is theta in rad, age the time since touch-down in
# s, place the world's x of the touching corner (of the middle of a face) in m, time that since the
# start of the drive in s, current the root of the sum of the squared currents of the in-plane coils
# in A, frequency the drive's in Hz.
ARGUMENTS = (
    "slip_speed", "load", "angle", "rate", "speed", "age", "place", "time", "current",
    "frequency",
)  # fmt: skip
SLIP_SPEED, LOAD, ANGLE, RATE, SPEED, AGE, PLACE, TIME, CURRENT, FREQUENCY = range(10)

FORMS = (
    "power", "gaussian", "rational", "log", "rise", "hump", "wave", "triangle", "cosine", "sine",
    "saturation",
)  # fmt: skip
POWER, GAUSSIAN, RATIONAL, LOG, RISE, HUMP, WAVE, TRIANGLE, COSINE, SINE, SATURATION = range(11)

# Quantities that terms add to. friction: part of every friction coefficient; sliding: kinetic
# coefficient; adhesion: part of it; drag: N s/m; fluid: part of all drag forces and torques; field:
# part of the coils' field.
TARGETS = ("friction", "sliding", "adhesion", "drag", "fluid", "field")
Laws = namedtuple("Laws", TARGETS)


@njit
def _form(form, u, exponent):
    """A form at the argument over its scale; `exponent` is the width of a hump, a wave's phase."""
    if form == POWER:
        return abs(u) ** exponent
    if form == GAUSSIAN:
        return np.exp(-u * u)
    if form == RATIONAL:
        return 1.0 / (1.0 + u * u)
    if form == LOG:
        return np.log1p(abs(u))
    if form == RISE:
        return 1.0 - np.exp(-abs(u))
    if form == HUMP:
        return np.exp(-0.5 * (np.log(abs(u)) / exponent) ** 2) if u != 0.0 else 0.0
    if form == WAVE:
        return np.sin(2.0 * np.pi * u + exponent)
    if form == TRIANGLE:
        turn = (u + exponent / (2.0 * np.pi) + 0.25) % 1.0
        return 1.0 - 4.0 * abs(turn - 0.5)
    if form == COSINE:
        return abs(np.cos(u)) ** exponent
    if form == SINE:
        return abs(np.sin(u)) ** exponent
    return u * u / (1.0 + u * u)


@njit
def total(terms, arguments):
    """Sum of some terms, (n, 5), at the arguments, (10,)."""
    result = 0.0
    for k in range(terms.shape[0]):
        argument = arguments[int(terms[k, 0])] / terms[k, 3]
        result += terms[k, 2] * _form(int(terms[k, 1]), argument, terms[k, 4])
    return result


def laws_of(rows) -> Laws:
    """Tables of terms from rows (target, argument, form, amplitude, scale, exponent).

    A row of no amplitude is left out. Raises ValueError for a word that is not known.
    """
    tables = {name: [] for name in TARGETS}
    for target, argument, form, amplitude, scale, exponent in rows:
        for word, allowed in ((target, TARGETS), (argument, ARGUMENTS), (form, FORMS)):
            if word not in allowed:
                raise ValueError(f"law: {word!r}, allowed: {allowed}")
        if amplitude != 0.0:
            numbers = (ARGUMENTS.index(argument), FORMS.index(form), amplitude, scale, exponent)
            tables[target].append(numbers)
    return Laws(*(np.array(tables[name], dtype=float).reshape(-1, 5) for name in TARGETS))
