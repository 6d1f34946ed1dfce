"""The reference for the robot that turns: a rigid cuboid on eight corners, stepped in time.

Independent of the product and of its planar equations: the body has six degrees of freedom, its
heading and roll are results, and no edge or face is known to it, only corners (`corner_contact.py`)
with Coulomb's cone (`cone.py`). The field is that of `field.py`, of all five coils.

A step drifts for half its length, takes forces there, and drifts on with the new velocity (position
Verlet): second order while no corner changes its state. A step in which one does is repeated with
half the length until it has the shortest, so a switch is late by at most that. Both lengths go down
together in a study of convergence, and what is left is of first order in the shortest.
"""

import numpy as np
from numba import njit

from .circuit import advance_circuits
from .corner_contact import COUNTS, STEPS
from .corner_step import copy_motion, kinetic_energy, try_step
from .rigid_body import CORNERS, inner

# Columns of the samples: m, rad, J. FIELD_HEADING is that of the field at the body's place; ENERGY
# is kinetic and potential in the weight.
X, Y, Z, HEADING, TILT, ROLL, FIELD_HEADING, CORNERS_DOWN, ENERGY, COLUMNS = range(10)

# Slots of the marks: m, m, rad, rad, rad^2 s.
X_BEGIN, Y_BEGIN, X_END, Y_END, MOST_ROLL, MOST_LAG, LAG_SQUARED, WINDOW = range(8)


@inner
def _angles(matrix, near, sample):
    """Heading, tilt and roll of the body and heading of the field into a row of the samples."""
    across = np.sqrt(matrix[0, 0] ** 2 + matrix[1, 0] ** 2)
    sample[HEADING] = np.arctan2(matrix[1, 0], matrix[0, 0])
    sample[TILT] = np.arctan2(-matrix[2, 0], across)
    sample[ROLL] = np.arcsin(min(max(matrix[2, 1], -1.0), 1.0))
    sample[FIELD_HEADING] = np.arctan2(near.total[1], near.total[0])


@inner
def _amperes(circuit, current, amperes):
    """Currents of the coils from those of the circuit's modes."""
    for coil in range(amperes.shape[0]):
        amperes[coil] = 0.0
        for mode in range(current.shape[0]):
            amperes[coil] += circuit.to_coils[coil, mode] * current[mode]


@inner
def _note(
    block, now, after, memory, matrix, near, t, t_next, window, samples, count, rate, row, marks
):
    """Write what falls into a step into samples and marks; returns the number of samples so far."""
    _angles(matrix, near, row)
    row[ENERGY] = kinetic_energy(block, after.velocity, after.spin, after.momentum)
    row[ENERGY] += block.mass * block.gravity * after.position[2]
    row[CORNERS_DOWN] = 0.0
    for c in range(CORNERS):
        row[CORNERS_DOWN] += memory.touching[c]
    while count < samples.shape[0] and count / rate <= t_next:
        part = (count / rate - t) / (t_next - t)
        for j in range(3, row.shape[0]):
            samples[count, j] = row[j]
        for j in range(3):
            samples[count, j] = now.position[j] + part * (after.position[j] - now.position[j])
        count += 1
    for end in range(2):
        if t < window[end] <= t_next:
            part = (window[end] - t) / (t_next - t)
            for j in range(2):
                marks[2 * end + j] = now.position[j] + part * (after.position[j] - now.position[j])
    if window[0] <= t < window[1]:
        lag = (row[FIELD_HEADING] - row[HEADING] + np.pi) % (2.0 * np.pi) - np.pi
        marks[MOST_ROLL] = max(marks[MOST_ROLL], abs(row[ROLL]))
        marks[MOST_LAG] = max(marks[MOST_LAG], abs(lag))
        marks[LAG_SQUARED] += lag * lag * (t_next - t)
    return count


@njit(error_model="numpy")
def march_corners(
    block, wires, circuit, seg_start, seg_level, seg_slope, now, after, near, trial, step, memory,
    shortest, halvings, end, window, rate, samples,
):  # fmt: skip
    """Integrate from `now` until `end` s.

    seg_start (s,) s, seg_level, seg_slope (s, 5): modal voltages of the coils, wires (5, 5, 3) m;
    steps of `shortest` s times 1, 2, 4, ... 2^halvings; window (2,) s of the averages; samples
    (n, 9) at multiples of 1 / rate. Returns the marks, and the counts of corner_contact.py.
    """
    counts, marks, row = np.zeros(COUNTS, np.int64), np.zeros(WINDOW), np.zeros(samples.shape[1])
    modes = circuit.time_constant.shape[0]
    current, lagged, trial_current = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    amperes = np.zeros(wires.shape[0])
    longest = shortest * 2**halvings
    decay = np.zeros((halvings + 1, modes))
    for level in range(halvings + 1):
        for mode in range(modes):
            decay[level, mode] = np.exp(-0.5 * shortest * 2**level / circuit.time_constant[mode])
    segment, tick, level, count = 0, 0, halvings, 0
    last = int(np.floor(end / shortest + 1e-9)) + 1
    while tick < last:
        t, middle = tick * shortest, (tick + 0.5 * 2**level) * shortest
        for mode in range(modes):
            trial_current[mode] = current[mode]
        half_segment = advance_circuits(
            t, middle, decay[level], segment, seg_start, seg_level, seg_slope, trial_current,
            lagged, circuit,
        )  # fmt: skip
        _amperes(circuit, trial_current, amperes)
        length = shortest * 2**level
        if not try_step(
            block, wires, amperes, near, now, after, trial, step, memory, length, longest,
            level == 0, counts,
        ):  # fmt: skip
            level -= 1
            continue
        counts[STEPS] += 1
        tick += 2**level
        for mode in range(modes):
            current[mode] = trial_current[mode]
        segment = advance_circuits(
            middle, tick * shortest, decay[level], half_segment, seg_start, seg_level, seg_slope,
            current, lagged, circuit,
        )  # fmt: skip
        count = _note(
            block, now, after, memory, trial.final, near, t, tick * shortest, window, samples,
            count, rate, row, marks,
        )  # fmt: skip
        copy_motion(after, now)
        level = min(level + 1, halvings)
    return marks, counts
