"""Where inside a step a contact switches, and what the part of the step before or after it weighs.

A switch that is rounded to whole steps leaves an error of first order that scatters from run to
run; near a grazing event that scatter picks the wrong branch. The forces that jump at a switch
(adhesion at landing and leaving, friction at the onset of slip) are therefore weighted with the
fraction of the step for which they act. Step k of the forces reaches from t_k - step/2 to
t_k + step/2.
"""

from numba import njit


@njit
def landing_time(gap, approach, step):
    """Time of landing after t_k in s, within half a step; gap in m at t_k, approach < 0 in m/s."""
    return min(max(-gap / approach, -0.5 * step), 0.5 * step)


@njit
def onset_coefficient(load_before, load_now, mu_static, mu_kinetic):
    """Mean friction coefficient of the step in which sticking ends.

    load: |friction| over its sticking limit at t_(k-1) and t_k, below and above 1.
    """
    moment = (1.0 - load_before) / (load_now - load_before) - 0.5
    return mu_kinetic + moment * (mu_static - mu_kinetic)


@njit
def leaving_impulse(reaction, share_given, keep_n, keep_t, hold):
    """(normal, tangential) impulse in N s still due at a corner that is found to leave at t_k.

    reaction: its normal impulse of step k-1. keep_n, keep_t: what would keep it closed in step k;
    keep_n < 0. hold: adhesion times the step. share_given: the share of step k-1 for which it was
    held after landing in that very step, else negative.
    """
    if share_given >= 0.0:
        # It landed and was let go at once: take back adhesion and the pull that held it down.
        return share_given * (hold - keep_n), -share_given * keep_t
    if keep_n >= 0.0:
        return 0.0, 0.0
    # The reaction vanished between t_(k-1) and t_k; adhesion acted until then.
    return -(reaction / (reaction - keep_n) - 0.5) * hold, 0.0
