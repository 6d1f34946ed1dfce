"""The paper's numbers on field, force and torque, statements S15 to S17, from Tables I and II."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.field.coils import Coils
from stickslip.reproduction.points import Array
from stickslip.scenario.sections import Robot

MAXIMUM_FIELD = 6.5e-3
"""Field of one coil at the centre, Table I, T."""
MAXIMUM_GRADIENT = 0.149
"""At the centre, Table I, T/m."""
CUBE = 25e-3
"""Side of the working volume, section IV-B, m."""
SMALL_CUBE = 5e-3
"""Side of a volume in which S17 holds, m; found by computing its fringe."""

INNER, OUTER = 0.120, 0.157
"""Inner and outer length of the winding, Table I, m."""

_ONE_COIL = np.array([1.0, 0.0, 0.0, 0.0, 0.0])  # A
_NODES = 8  # of a Gauss-Legendre rule; twice as many change no result by 1e-12


@dataclass(frozen=True)
class FieldChecks:
    """What the geometry gives, in SI units."""

    torque: float  # greatest on the robot at the centre, N m
    force_at_centre: float  # greatest there in the same field, N
    gradient_at_centre: float  # T/m
    full_gradient_offset: float  # from the centre, towards the coil, to Table I's gradient, m
    force_at_offset: float  # there, N
    # Greatest relative difference of one filament, in the working volume, from a winding between
    # inner and outer length: of no depth, and as deep along the axis as it is wide.
    winding_flat: float
    winding_square: float
    # Greatest single component across the coil's axis, over the one along it, in both cubes.
    fringe: float
    fringe_small: float


def field_checks() -> FieldChecks:
    """Evaluate all of `FieldChecks`."""
    coils, robot = Coils(), Robot()
    moment = robot.length * robot.width * robot.height * robot.magnetization
    currents = _ONE_COIL * MAXIMUM_FIELD / coils.centre_field_per_ampere

    towards_the_coil = np.zeros((2001, 3))
    towards_the_coil[:, 0] = np.linspace(0.0, 20e-3, 2001)
    gradient = coils.gradient(towards_the_coil, currents)[:, 0, 0]
    offset = float(np.interp(MAXIMUM_GRADIENT, gradient, towards_the_coil[:, 0]))
    return FieldChecks(
        torque=moment * MAXIMUM_FIELD,
        force_at_centre=moment * float(gradient[0]),
        gradient_at_centre=float(gradient[0]),
        full_gradient_offset=offset,
        force_at_offset=moment * MAXIMUM_GRADIENT,
        winding_flat=_winding_difference(0.0),
        winding_square=_winding_difference(0.5 * (OUTER - INNER)),
        fringe=_fringe(CUBE),
        fringe_small=_fringe(SMALL_CUBE),
    )


def _cube(side: float, count: int) -> Array:
    axis = np.linspace(-0.5 * side, 0.5 * side, count)
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)


def _fringe(side: float) -> float:
    field = np.abs(Coils().field(_cube(side, 21), _ONE_COIL))
    return float((field[..., 1:].max(axis=-1) / field[..., 0]).max())


def _winding_difference(depth: float) -> float:
    """Filaments spread evenly between inner and outer length and over `depth` along the axis."""
    filament = Coils()
    points = _cube(CUBE, 11)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    sides = 0.5 * (OUTER + INNER) + 0.5 * (OUTER - INNER) * nodes
    axial = [(0.0, 2.0)] if depth == 0.0 else list(zip(nodes, weights, strict=True))
    field = np.zeros((*points.shape[:-1], 3))
    for side, weight in zip(sides, weights, strict=True):
        for place, axial_weight in axial:
            coil = Coils(side, filament.distance + 0.5 * depth * place, filament.turns)
            field += 0.25 * weight * axial_weight * coil.field(points, _ONE_COIL)
    difference = field - filament.field(points, _ONE_COIL)
    return float((np.linalg.norm(difference, axis=-1) / np.linalg.norm(field, axis=-1)).max())
