"""Runs all peers and stickslip in turn, prints one table, writes it for the pages."""

from __future__ import annotations

import argparse
import importlib
import importlib.metadata
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from measure import add_out, cpu_seconds_in_turn, pin, saved

import stickslip
from peers import stickslip_side
from peers.problem import FAMILY, REFERENCE, Problem, problem_of

POINTS = 100_000
TARGETS = {"scipy": 400.0, "heyoka": 25.0, "mujoco": 400.0, "magpylib": 20.0}
SHARE, SECONDS = 0.5, 1.0  # of the friction limit, s: the test for creep
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


def scipy_entries() -> Iterator[Entry]:
    """solve_ivp, with the methods that suit; tolerances for a velocity error below 1e-4."""
    from peers.scipy_peer import simulate

    for method, rtol in (("RK45", 1e-4), ("LSODA", 1e-5), ("DOP853", 1e-7)):
        settings = f"solve_ivp {method}, rtol {rtol:.0e}"
        yield Entry("scipy", settings, lambda p, m=method, r=rtol: simulate(p, m, r))


def heyoka_entries() -> Iterator[Entry]:
    """The field expanded beforehand, and by the formula of the coils at every step."""
    import heyoka

    from peers.heyoka_peer import Compiled, simulate

    # Or the compile time would be that of reading an earlier one from disk.
    heyoka.llvm_state.set_diskcache_enabled(False)
    heyoka.llvm_state.clear_memcache()
    for tol, exact in ((1e-4, False), (1e-6, False), (1e-4, True), (1e-7, True)):
        started = time.process_time()
        compiled = Compiled(problem_of(), tol, exact)
        spent = time.process_time() - started
        settings = f"tol {tol:.0e}, {'coil formula' if exact else 'expanded field'}"
        yield Entry("heyoka", settings, lambda p, c=compiled: simulate(p, c), spent)


def mujoco_entries() -> Iterator[Entry]:
    """The best settings that the search has found."""
    from peers.mujoco_peer import ACCURATE, QUICK, simulate

    for settings in (QUICK, ACCURATE):
        name = f"step {settings.timestep * 1e3:.0f} us"
        yield Entry("mujoco", name, lambda p, s=settings: simulate(p, s), checked=False)


ENTRIES = {"scipy": scipy_entries, "heyoka": heyoka_entries, "mujoco": mujoco_entries}


def installed_version(name: str) -> str | None:
    """Version of a package, or None where it is not there or cannot be imported."""
    try:
        importlib.import_module(name)
        return importlib.metadata.version(name)
    except Exception:  # a broken installation raises what it likes
        return None


def rms_error(velocities: list[float], exact: np.ndarray) -> float:
    """Root mean square of the relative errors."""
    return float(np.sqrt(np.mean((np.array(velocities) / exact - 1.0) ** 2)))


def tolerance_within(error: float, own_errors: dict[float, float]) -> float:
    """The loosest tolerance of stickslip whose error, and that of all tighter ones, is within."""
    within = [rtol for rtol in own_errors
              if all(own <= error for each, own in own_errors.items() if each <= rtol)]  # fmt: skip
    if not within:
        raise RuntimeError(f"no tolerance of stickslip reaches a velocity error of {error:.1e}")
    return max(within)


def motion_rows(entries: list[Entry], repeats: int) -> list[dict]:
    """CPU time and velocity error of each entry, and of stickslip at no more than that error."""
    exact = stickslip_side.exact_velocities(FAMILY)
    problems = [problem_of(drive) for drive in FAMILY]
    own_errors = {
        rtol: rms_error([stickslip_side.velocity(drive, rtol) for drive in FAMILY], exact)
        for rtol in stickslip_side.TOLERANCES
    }
    errors = [rms_error([entry.velocity(p) for p in problems], exact) for entry in entries]
    tolerances = [tolerance_within(error, own_errors) for error in errors]

    reference = problem_of(REFERENCE)
    works = [lambda e=entry: e.velocity(reference) for entry in entries]
    distinct = sorted(set(tolerances))
    scenarios = [stickslip_side.scenario_of(REFERENCE, rtol) for rtol in distinct]
    works += [lambda s=scenario: stickslip.simulate(s) for scenario in scenarios]
    costs = [cost / reference.duration for cost in cpu_seconds_in_turn(works, repeats)]
    own_costs = dict(zip(distinct, costs[len(entries) :], strict=True))
    return [
        {"peer": entry.peer, "settings": entry.settings, "unit": "CPU s / simulated s",
         "cost": cost, "error": error, "stickslip_settings": f"rtol {rtol:.0e}",
         "stickslip_cost": own_costs[rtol], "stickslip_error": own_errors[rtol],
         "ratio": cost / own_costs[rtol], "target": TARGETS[entry.peer],
         "compile_seconds": entry.compile_seconds, "wrong": entry.checked and error > WRONG}
        for entry, error, rtol, cost in zip(entries, errors, tolerances, costs, strict=False)
    ]  # fmt: skip


def field_rows(repeats: int) -> list[dict]:
    """CPU time a point and coil of field and gradient, within 12.5 mm of the centre."""
    from peers.magpylib_peer import Coil

    points = np.random.default_rng(1).uniform(-0.0125, 0.0125, (POINTS, 3))
    current = [1.0, 0.0, 0.0, 0.0, 0.0]
    own, peer = stickslip.Coils(), Coil()
    pairs = {
        "field": (peer.field, own.field),
        "gradient, 4 differences": (peer.gradient, own.gradient),
    }
    works = []
    for theirs, ours in pairs.values():
        works += [lambda f=theirs: f(points), lambda f=ours: f(points, current)]
    costs = [1e9 * cost / POINTS for cost in cpu_seconds_in_turn(works, repeats)]
    rows = []
    for (name, (theirs, ours)), cost, own_cost in zip(
        pairs.items(), costs[::2], costs[1::2], strict=True
    ):
        exact = ours(points, current)
        error = float(np.abs(theirs(points) - exact).max() / np.abs(exact).max())
        rows.append({
            "peer": "magpylib", "settings": name, "unit": "ns / point and coil", "cost": cost,
            "error": error, "stickslip_settings": "analytic", "stickslip_cost": own_cost,
            "stickslip_error": 0.0, "ratio": cost / own_cost, "target": TARGETS["magpylib"],
            "compile_seconds": 0.0, "wrong": error > 1e-6,
        })  # fmt: skip
    return rows


def creep_rows(with_mujoco: bool) -> list[dict]:
    """Drift in mm of a block at half its friction limit."""
    drifts = {"stickslip": stickslip_side.creep(SHARE, SECONDS)}
    if with_mujoco:
        from peers import mujoco_peer

        for settings in (mujoco_peer.QUICK, mujoco_peer.ACCURATE):
            softer = replace(settings, friction_impedance=1.0)
            for each, name in {settings: "", softer: ", impratio 1"}.items():
                drift = mujoco_peer.creep(problem_of(), each, SHARE, SECONDS)
                drifts[f"mujoco, step {settings.timestep * 1e3:.0f} us{name}"] = drift
    return [{"who": who, "drift_mm": 1e3 * drift} for who, drift in drifts.items()]


def show(rows: list[dict]) -> None:
    """The table."""
    print(
        f"{'peer':9}{'settings':32}{'cost':>9} {'unit':20}{'error':>8}"
        f" | {'stickslip':>10}{'cost':>9}{'error':>8} | {'ratio':>6} {'target':>6}"
    )
    for row in rows:
        print(
            f"{row['peer']:9}{row['settings']:32}{row['cost']:9.3g} {row['unit']:20}"
            f"{row['error']:8.1e} | {row['stickslip_settings']:>10}{row['stickslip_cost']:9.3g}"
            f"{row['stickslip_error']:8.1e} | {row['ratio']:6.3g} {row['target']:6.0f}"
            f"{'  WRONG' if row['wrong'] else ''}"
        )


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench peers", description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    add_out(parser, "peers")
    options = parser.parse_args()
    core = pin()
    versions = {name: installed_version(name) for name in TARGETS}
    missing = [name for name, version in versions.items() if version is None]
    entries = [e for name, make in ENTRIES.items() if name not in missing for e in make()]
    rows = motion_rows(entries, options.repeats)
    if "magpylib" not in missing:
        rows += field_rows(options.repeats)
    creep = creep_rows("mujoco" not in missing)

    show(rows)
    for name in missing:
        print(f"{name:9}not installable here: not measured")
    compiled = [f"{row['compile_seconds']:.2g} s" for row in rows if row["compile_seconds"]]
    if compiled:
        print(f"compile time of heyoka's rows, not in the cost: {', '.join(compiled)}")
    drifts = "; ".join(f"{row['who']}: {row['drift_mm']:.2g} mm" for row in creep)
    print(f"drift of a block at half its friction limit in {SECONDS:g} s: {drifts}")
    print(
        f"stickslip {stickslip.__version__}, "
        + ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    )

    load = os.getloadavg()
    print("load average: " + ", ".join(f"{each:.1f}" for each in load))
    result = {"core": core, "versions": versions, "rows": rows, "creep": creep}
    saved(options.out, "peers", {**result, "load_average": load})
    wrong = [f"{row['peer']} ({row['settings']})" for row in rows if row["wrong"]]
    if wrong:
        print(f"wrong physics: {', '.join(wrong)}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
