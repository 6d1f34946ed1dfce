"""What may be wrong with the readings of a measurement, as causes beside the simulator's effects.

The camera's length scale, clock and turn are effects of the simulator itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from stickslip._util.arrays import Array
from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.model import instruments
from stickslip.diagnosis.model.free_terms import predicted_once
from stickslip.diagnosis.model.instruments import Instrument
from stickslip.diagnosis.model.problem import Cause, CauseParameter

# Sizes that would not surprise. Chosen as rough orders, as those of the simulator's effects are.
_ZERO_OF_VELOCITY = 0.02  # of the velocities' root mean square: a stage or a picture that creeps
_SCALE_OF_ANGLES = 0.02
_TURN_OF_PROBE = 0.03  # rad, and the largest that is searched
_LARGEST_TURN = 0.5
# Beyond the largest reading, in it, a limit begins to act; and how far below that it may lie.
_ABOVE_ALL, _SIZE_OF_CLIP = 1.2, 0.12


def read_by(
    suspects: Sequence[Cause],
    names: Sequence[str],
    parameters: Array,
    physics: Callable[[Sequence[str], Array], Array],
) -> Array:
    """What instruments read of a model, shape (vectors, k).

    Parameters
    ----------
    suspects : sequence of Cause
        Those that are instruments read, each what the one before it has read; of one whose
        parameters are not among `names` nothing is wrong.
    names : sequence of str
        Of the columns of `parameters`, shape (vectors, names).
    physics : callable
        ``physics(names, parameters)`` is what a perfect instrument reads. Vectors that differ in
        the instruments alone share it.
    """
    own = [each for each in suspects if isinstance(each, Instrument)]
    own = [each for each in own if each.parameters[0].name in names]
    read = {parameter.name for each in own for parameter in each.parameters}
    kept = [k for k, name in enumerate(names) if name not in read]
    known = [names[k] for k in kept]
    if not own:
        return physics(names, parameters)
    true = predicted_once(lambda _, values: physics(known, values), None, parameters[:, kept])
    reading = true
    for each in own:
        columns = [names.index(parameter.name) for parameter in each.parameters]
        reading = each.read(reading, true, parameters[:, columns])
    return reading


def of_velocities(measured: Array) -> tuple[Instrument, ...]:
    """A wrong zero and a limit of measured velocities, m/s, shape (n,); none where all are 0."""
    if not np.any(measured):
        return ()
    size = _ZERO_OF_VELOCITY * root_mean_square(measured)
    return (
        instruments.offset("m/s", size, name="velocity_offset"),
        *clipping("velocity_clipping", "m/s", measured),
    )


def of_angles(theta: Array) -> tuple[Instrument, ...]:
    """A wrong scale and a limit of angles, rad, shape (n,)."""
    return (
        instruments.scale(_SCALE_OF_ANGLES, name="angle_scale"),
        *clipping("angle_clipping", "rad", theta),
    )


def of_fields(fields: Array) -> tuple[Instrument, ...]:
    """A probe that is turned against the coils, and its limit; fields in T, shape (n, 3)."""
    angles = tuple(
        CauseParameter(
            f"probe_turned.about_{axis}", "rad", -_LARGEST_TURN, _LARGEST_TURN, _TURN_OF_PROBE
        )
        for axis in "xyz"
    )
    turned = Instrument("probe_turned", angles, "the probe is turned", read=_turned)
    return turned, *clipping("probe_clipping", "T", fields)


def clipping(name: str, unit: str, readings: Array) -> tuple[Instrument, ...]:
    """A limit of readings, any shape, in `unit`, above all of them; none where all are 0."""
    largest = float(np.max(np.abs(readings), initial=0.0))
    if largest == 0.0:
        return ()
    above, size = _ABOVE_ALL * largest, _SIZE_OF_CLIP * largest
    return (instruments.clipping(unit, above, size, name=name),)


def _turned(reading: Array, _: Array, values: Array) -> Array:
    """Fields along the axes of a probe, which are those of the coils after the rotation vector."""
    fields = reading.reshape(len(values), -1, 3)
    turns = Rotation.from_rotvec(values).as_matrix()
    return np.asarray(np.einsum("vji,vnj->vni", turns, fields).reshape(reading.shape))
