"""Currents of the driven coils, exact at the end of each step."""

import numpy as np
from numba import njit


@njit
def _advance_coil(duration, decay, level, slope, current, lagged, resistance, inductance, lag_time):
    """(current, lagged current) in A after `duration` s under the voltage level + slope t.

    The current is the closed solution of the paper's Eq. (1). The lag of eddy currents acts on the
    field, hence equally on the current that makes it; its input is taken as linear over the step.
    """
    steady_begin = (level - slope * inductance / resistance) / resistance
    steady_end = steady_begin + slope * duration / resistance
    after = steady_end + (current - steady_begin) * decay
    if lag_time <= 0.0:
        return after, after
    behind = (after - current) / duration * lag_time
    return after, after - behind + (lagged - current + behind) * np.exp(-duration / lag_time)


@njit
def advance_circuits(t, t_next, full_decay, segment, start, level, slope, current, lagged, model):
    """Advance current and lagged (2,) in A from t to t_next in place; returns the voltage segment.

    A breakpoint of the voltage inside the step splits it, so that jumps are met where they are.
    full_decay: exp(-(t_next - t) R / L), computed once for all whole steps.
    """
    begin = t
    while begin < t_next:
        while segment + 1 < start.shape[0] and start[segment + 1] <= begin:
            segment += 1
        end = t_next
        decay = full_decay
        inside = segment + 1 < start.shape[0] and start[segment + 1] < end
        if inside:
            end = start[segment + 1]
        if inside or begin > t:
            decay = np.exp(-(end - begin) * model.resistance / model.inductance)
        for coil in range(2):
            rate = slope[segment, coil]
            volts = level[segment, coil] + rate * (begin - start[segment])
            current[coil], lagged[coil] = _advance_coil(
                end - begin, decay, volts, rate, current[coil], lagged[coil],
                model.resistance, model.inductance, model.lag_time,
            )  # fmt: skip
        begin = end
    return segment
