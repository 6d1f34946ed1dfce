"""What is measured of each peer. A peer that cannot be imported gives a line instead."""

from __future__ import annotations

import importlib
import importlib.metadata
import time
from collections.abc import Callable
from dataclasses import dataclass

from peers.problem import Problem, problem_of

WRONG = 1e-2  # relative velocity error from which a peer's physics counts as wrong


@dataclass(frozen=True)
class Entry:
    """One row: a peer with settings.

    velocity: of a problem, m/s. compile_seconds: CPU time spent once before the first run. checked:
    whether an error above `WRONG` fails the benchmark.
    """

    peer: str
    settings: str
    velocity: Callable[[Problem], float]
    compile_seconds: float = 0.0
    checked: bool = True


def installed_version(name: str) -> str | None:
    """Version of a package, or None where it is not there or cannot be imported."""
    try:
        importlib.import_module(name)
        return importlib.metadata.version(name)
    except Exception:  # a broken installation raises what it likes
        return None


def scipy_entries() -> list[Entry]:
    """solve_ivp, with the methods that suit; tolerances for a velocity error below 1e-4."""
    from peers import scipy_peer

    choices = [("RK45", 1e-4), ("LSODA", 1e-5), ("DOP853", 1e-7)]
    return [
        Entry(
            "scipy",
            f"solve_ivp {method}, rtol {rtol:.0e}",
            lambda problem, m=method, r=rtol: scipy_peer.simulate(problem, m, r),
        )
        for method, rtol in choices
    ]


def heyoka_entries() -> list[Entry]:
    """The field expanded beforehand, and by the formula of the coils at every step."""
    import heyoka

    from peers import heyoka_peer

    # Or the compile time would be that of reading an earlier one from disk.
    heyoka.llvm_state.set_diskcache_enabled(False)
    heyoka.llvm_state.clear_memcache()
    entries = []
    for tol, exact in ((1e-4, False), (1e-6, False), (1e-4, True), (1e-7, True)):
        started = time.process_time()
        compiled = heyoka_peer.Compiled(problem_of(), tol, exact)
        spent = time.process_time() - started
        entries.append(
            Entry(
                "heyoka",
                f"tol {tol:.0e}, {'coil formula' if exact else 'expanded field'}",
                lambda problem, c=compiled: heyoka_peer.simulate(problem, c),
                compile_seconds=spent,
            )
        )
    return entries


def mujoco_entries() -> list[Entry]:
    """The best settings that the search has found, of each kind of adhesion."""
    from peers import mujoco_peer

    kinds = {False: "", True: ", adhesive geoms"}
    return [
        Entry(
            "mujoco",
            f"step {settings.timestep * 1e3:.0f} us{kinds[settings.passive]}",
            lambda problem, s=settings: mujoco_peer.simulate(problem, s),
            checked=False,
        )
        for settings in mujoco_peer.available()
    ]


ENTRIES = {"scipy": scipy_entries, "heyoka": heyoka_entries, "mujoco": mujoco_entries}
