"""Currents of the coils, exact at the end of each step.

Coils that couple, or differ in resistance, are solved in the modes of L dI/dt + R I = V: with
I = W j and W^T R W = 1 each mode is T dj/dt + j = (W^T V) by itself, T its time constant.
"""

from collections import namedtuple

import numpy as np
from numba import njit
from scipy.linalg import eigh

# time_constant (m,) s of the modes; to_coils (n, m), the matrix W; lag_time s.
Circuit = namedtuple("Circuit", "time_constant to_coils lag_time")


def circuit_of(resistance, inductance, lag_time) -> Circuit:
    """Circuit of coils with resistances (n,) in ohm and an inductance matrix (n, n) in H."""
    time_constant, modes = eigh(inductance, np.diag(resistance))
    return Circuit(time_constant, np.ascontiguousarray(modes), float(lag_time))


@njit
def _advance_mode(duration, decay, level, slope, current, lagged, time_constant, lag_time):
    """(current, lagged current) of a mode after `duration` s under the voltage level + slope t.

    The current is the closed solution of the paper's Eq. (1). The lag of eddy currents acts on the
    field, hence equally on the current that makes it; its input is taken as linear over the step.
    """
    steady_begin = level - slope * time_constant
    steady_end = steady_begin + slope * duration
    after = steady_end + (current - steady_begin) * decay
    if lag_time <= 0.0:
        return after, after
    behind = (after - current) / duration * lag_time
    return after, after - behind + (lagged - current + behind) * np.exp(-duration / lag_time)


@njit
def advance_circuits(t, t_next, full_decay, segment, start, level, slope, current, lagged, circuit):
    """Advance the modes' current and lagged (m,) from t to t_next in place; returns the segment.

    level, slope (s, m): modal voltages. A breakpoint of the voltage inside the step splits it, so
    that jumps are met where they are. full_decay (m,): exp(-(t_next - t) / time_constant), computed
    once for all whole steps.
    """
    begin = t
    while begin < t_next:
        while segment + 1 < start.shape[0] and start[segment + 1] <= begin:
            segment += 1
        end = t_next
        inside = segment + 1 < start.shape[0] and start[segment + 1] < end
        if inside:
            end = start[segment + 1]
        for mode in range(current.shape[0]):
            decay = full_decay[mode]
            if inside or begin > t:
                decay = np.exp(-(end - begin) / circuit.time_constant[mode])
            rate = slope[segment, mode]
            volts = level[segment, mode] + rate * (begin - start[segment])
            current[mode], lagged[mode] = _advance_mode(
                end - begin, decay, volts, rate, current[mode], lagged[mode],
                circuit.time_constant[mode], circuit.lag_time,
            )  # fmt: skip
        begin = end
    return segment


@njit
def mean_squares(begin, end, step, start, level, slope, circuit):
    """Mean of each coil's squared current from `begin` to `end`, s, shape (n,), A^2."""
    modes, coils = circuit.to_coils.shape[1], circuit.to_coils.shape[0]
    current, lagged, result = np.zeros(modes), np.zeros(modes), np.zeros(coils)
    decay = np.exp(-step / circuit.time_constant)
    segment, counted = 0, 0
    for k in range(int(end / step)):
        segment = advance_circuits(
            k * step, (k + 1) * step, decay, segment, start, level, slope, current, lagged, circuit
        )
        if (k + 1) * step >= begin:
            counted += 1
            for coil in range(coils):
                amperes = 0.0
                for mode in range(modes):
                    amperes += circuit.to_coils[coil, mode] * current[mode]
                result[coil] += amperes * amperes
    return result / counted
