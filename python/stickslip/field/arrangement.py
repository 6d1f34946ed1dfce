"""Whether a map is that of the five coils in their columns: the centre of each field tells.

A current above zero makes a field along the coil's axis that grows towards the coil. In another
arrangement the values are no source-free field, or that of coils that stand elsewhere.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, Mask
from stickslip.errors import ScenarioError
from stickslip.field.coils import AXES
from stickslip.field.map_fit import ROUNDING, TURNS, CoilFit, fit_coils, point_name

_AXIS, _SIDE = np.array(AXES), np.array([1.0, -1.0, 1.0, -1.0, -1.0])
"""The axis of each coil, and on which side it stands."""

_WORST = 0.07
"""Largest rms residual of a coil, relative to its rms field. Chosen: errors of 3 % of the field in
each component leave 5.2 %, and of few points 6.6 %; more has wrong places, or iron within."""

_GAIN, _GAIN_OF_ONE = 20.0, 0.005
"""Log-likelihood by which another arrangement of the components has to predict left-out points
better than the given one, in all and for each number of the map. Chosen: of 300 sound maps no coil
has more than 10.1 and all coils 5.3, and in another arrangement most have hundreds."""

_ODD = 10.0
"""Largest residual of a coil's points over the median. Chosen: of 713 sound fits none has 4."""

_TOLD, _CHANGE = 5.0, 0.01
"""Standard deviations from which on a sign is no chance, and the least change of a field over the
map, of the field, that tells where its coil stands. Chosen: the field of a coil of Table I changes
by 2 % in a millimetre, and that of a pair for even fields by less than 1 % over a map."""

_FLIPS = np.array(
    [
        np.diag(signs)[list(order)]
        for order in itertools.permutations(range(3))
        for signs in itertools.product((1.0, -1.0), repeat=3)
    ]
)
_SOURCES = np.array(list(itertools.permutations(range(len(_AXIS)))))


def check_arrangement(
    samples: Sequence[tuple[Array, Array]],
    lines: Sequence[Sequence[int]] | None,
    fits: Sequence[CoilFit],
) -> None:
    """Refuse a map in which a coil's field is not along its axis or does not grow towards it.

    Arguments as of `fit_coils`, and what it found. The ScenarioError says which exchange or
    reversal makes a map of the five coils, if one does.
    """
    # No less than rounding leaves; also of a coil that is not there.
    errors = np.array([np.maximum(fit.errors, ROUNDING * fit.field or 1.0) for fit in fits])
    count = 3.0 * np.array([fit.points for fit in fits])
    gain = count[:, None] * np.log(errors[:, :1] / errors)
    turn = int(np.argmax(gain.sum(axis=0))) if _is_gain(gain.sum(axis=0), count.sum()) else 0
    for k, fit in enumerate(fits):
        if not fit.field:
            continue
        if fit.residual > _WORST * fit.field or turn or _is_gain(gain[k], count[k]):
            text = (
                f"the fit leaves {fit.residual:.3g} T/A rms, {fit.residual / fit.field:.2g} of the "
                f"field, most at {point_name(lines, k, fit.farthest)}: allowed is {_WORST:g}, and "
                "no more than with other signs or orders of columns"
            )
        elif fit.odd > _ODD:
            raise ScenarioError(
                f"coil {_core.coil_names[k]}: {point_name(lines, k, fit.farthest)} is "
                f"{fit.odd:.3g} times farther from the fit than half of the points: allowed are "
                f"{_ODD:g} times; look for a wrong number there"
            )
        elif not _stands(fit, fit.centre)[k]:
            text = (
                f"B = {_vector(fit.centre[:3])} T/A at x = y = z = 0, and growths of Bx along x, "
                f"By along y, Bz along z of {_vector(fit.centre[3:])} T/A over the map: allowed is "
                f"a field along +{'xyz'[_AXIS[k]]} that grows most towards the coil, "
                f"{'+' if _SIDE[k] > 0.0 else '-'}{'xyz'[_AXIS[k]]}"
            )
        else:
            continue
        raise ScenarioError(f"coil {_core.coil_names[k]}: {text}; {_remedy(turn, samples)}")


def _is_gain(gain: Array, count: float) -> bool:
    return bool(np.max(gain) > max(_GAIN, _GAIN_OF_ONE * count))


def _vector(values: Array) -> str:
    return f"({', '.join(f'{each:.3g}' for each in values)})"


def _stands(fit: CoilFit, centre: Array) -> Mask:
    """As which of the five coils fields with these values at the centre may stand.

    Shapes (..., 6) as of ``fit.centre``, and (..., 5).
    """
    field, growth = centre[..., :3], centre[..., 3:]
    least = max(_TOLD * np.max(fit.centre_sd[3:]), _CHANGE * fit.field)
    most = np.max(np.abs(growth), axis=-1, keepdims=True)
    along, toward = field[..., _AXIS], _SIDE * growth[..., _AXIS]
    by_field = along >= np.max(np.abs(field), axis=-1, keepdims=True)
    place = np.where(most > least, toward >= most - least, by_field)
    there = along > _TOLD * np.max(fit.centre_sd[:3])
    return np.asarray(place & there | (fit.field == 0.0))


def _remedy(turn: int, samples: Sequence[tuple[Array, Array]]) -> str:
    """The fewest changes that make a map of the five coils, and what to say of them.

    They are of columns, so that the components are turned against the places as by ``TURNS[turn]``,
    and of the names and signs of coils.
    """
    fits = fit_coils([(points, fields @ TURNS[turn].T) for points, fields in samples])[2]
    least, found = math.inf, "look for wrong places, signs or names, or iron within the map"
    if any(fit.residual > _WORST * fit.field for fit in fits):
        return found
    for flip, sign in itertools.product(_FLIPS, (1.0, -1.0)):
        columns = [flip, sign * flip @ TURNS[turn]]
        # What it costs that a coil (column) takes the values of another one (row): a new name, and
        # one more for the other sign.
        cost, signs = 1.0 - np.eye(len(fits)), np.ones((len(fits), len(fits)))
        for k, fit in enumerate(fits):
            seen = sign * np.concatenate([flip @ fit.centre[:3], np.abs(flip) @ fit.centre[3:]])
            as_given, reversed_too = _stands(fit, np.stack([seen, -seen]))
            signs[k] = np.where(as_given, 1.0, -1.0)
            cost[k] += np.where(as_given, 0.0, np.where(reversed_too, 1.0, np.inf))
        every = np.arange(len(fits))
        source = _SOURCES[np.argmin(cost[_SOURCES, every].sum(axis=1))]
        coils = np.where(source[:, None] == every, signs[source, every][:, None], 0.0)
        moved = sum(int(np.any(each != np.eye(3), axis=1).sum()) for each in columns)
        total = float(cost[source, every].sum()) + moved
        if total == 0.0:
            break
        if total < least:
            names = (("x", "y", "z"), ("Bx", "By", "Bz"), _core.coil_names)
            changes = [_changed(*each) for each in zip((*columns, coils), names, strict=True)]
            left = max(fit.residual / fit.field for fit in fits if fit.field)
            found = f"{' and '.join(filter(None, changes))} would fit, and leave {left:.2g}"
            least = total
    return found


def _changed(matrix: Array, names: Sequence[str]) -> str:
    """``y, -x in place of x, y`` of signs and orders."""
    rows = np.flatnonzero(np.any(matrix != np.eye(len(names)), axis=1)).tolist()
    minus = ["-" if matrix[k].sum() < 0.0 else "" for k in rows]
    taken = [m + names[int(np.argmax(np.abs(matrix[k])))] for m, k in zip(minus, rows, strict=True)]
    return f"{', '.join(taken)} in place of {', '.join(names[k] for k in rows)}" if rows else ""
