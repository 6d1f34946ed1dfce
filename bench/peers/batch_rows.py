"""Many runs at once: heyoka's batch mode beside stickslip's `simulate_batch` on one thread."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import heyoka as hy
import numpy as np
from measure import cpu_seconds_in_turn

import stickslip
from peers import heyoka_batch, heyoka_peer, stickslip_side
from peers.accuracy import rms_error, tolerance_within
from peers.entries import WRONG
from peers.problem import BATCH, problem_of

CHOICES = ((1e-4, False), (1e-6, False), (1e-4, True))  # tol, coil formula


@dataclass(frozen=True)
class Family:
    """heyoka with settings, for all runs of `BATCH`; `velocities` in m/s."""

    settings: str
    compiled: heyoka_peer.Compiled
    velocities: Callable[[], list[float]]
    compile_seconds: float


def families() -> list[Family]:
    """Each choice one by one, and in batch mode."""
    hy.llvm_state.set_diskcache_enabled(False)
    problems = [problem_of(drive) for drive in BATCH]
    found = []
    for tol, exact in CHOICES:
        for lanes in (0, hy.recommended_simd_size()):
            hy.llvm_state.clear_memcache()
            started = time.process_time()
            compiled = heyoka_peer.Compiled(problem_of(), tol, exact, lanes)
            spent = time.process_time() - started
            if lanes:

                def velocities(c=compiled):
                    return heyoka_batch.simulate(problems, c)
            else:

                def velocities(c=compiled):
                    return [heyoka_peer.simulate(problem, c) for problem in problems]

            name = f"batch of {lanes}" if lanes else "one by one"
            field = "coils" if exact else "expanded"
            found.append(Family(f"{name}, tol {tol:.0e}, {field}", compiled, velocities, spent))
    return found


def inner_seconds(family: Family) -> float:
    """CPU seconds that heyoka itself takes, without what its user has to do at events."""
    family.compiled.clock, family.compiled.spent = time.process_time, 0.0
    family.velocities()
    family.compiled.clock = None
    return family.compiled.spent


def batch_rows(repeats: int) -> list[dict]:
    """CPU time and velocity error, and those of stickslip at no more than that error."""
    exact = np.array(stickslip_side.together(BATCH, stickslip_side.EXACT))
    own_errors = {
        rtol: rms_error(stickslip_side.together(BATCH, rtol), exact)
        for rtol in stickslip_side.TOLERANCES
    }
    duration = sum(problem_of(drive).duration for drive in BATCH)
    every = families()
    errors = [rms_error(family.velocities(), exact) for family in every]
    tolerances = [tolerance_within(error, own_errors) for error in errors]
    distinct = sorted(set(tolerances))
    scenarios = {
        rtol: [stickslip_side.scenario_of(drive, rtol) for drive in BATCH] for rtol in distinct
    }
    works = [family.velocities for family in every]
    works += [lambda s=each: stickslip.simulate_batch(s, threads=1) for each in scenarios.values()]
    works += [lambda s=each: [stickslip.simulate(one) for one in s] for each in scenarios.values()]
    costs = [cost / duration for cost in cpu_seconds_in_turn(works, repeats)]
    own = dict(zip(distinct, costs[len(every) :], strict=False))
    own_single = dict(zip(distinct, costs[len(every) + len(distinct) :], strict=True))
    return [
        {
            "peer": "heyoka",
            "settings": family.settings,
            "unit": f"CPU s / s of {len(BATCH)} runs",
            "cost": cost,
            "error": error,
            "stickslip_settings": f"rtol {rtol:.0e}",
            "stickslip_cost": own[rtol],
            "stickslip_error": own_errors[rtol],
            "ratio": cost / own[rtol],
            "target": None,
            "compile_seconds": family.compile_seconds,
            "wrong": error > WRONG,
            "inner_cost": inner_seconds(family) / duration,
            "stickslip_single_cost": own_single[rtol],
        }
        for family, error, rtol, cost in zip(every, errors, tolerances, costs, strict=False)
    ]
