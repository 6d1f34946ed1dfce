"""The product beside a fixed program with the same physics: `python -m bench limit`.

A run: CPU time of the reference run, through the Python interface, over that of the program, where
both have the same error. The error at a tolerance is the root mean square, over sixteen runs with
peaks from 2.40 to 2.60 mT, of the relative difference of the last place from that of the product at
rtol 1e-12. The tolerance of an error is interpolated in the logarithms.

A sweep: simulated seconds a CPU second of the sweep of works.py on one thread at rtol 1e-6, over
those of the reference run by the program at the tolerance where its median error of the mean
velocity in the runs of the sweep is the sweep's own: in packs of four, and in the widest.

Each figure is a median with its 95 % interval, of pairs that are measured in turn.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from against import EXACT, Version
from measure import FEWEST, MOST, figure_of, filled, in_turn, pin, ratios, saved
from speed import PEAKS, simulated_time
from works import GRID, REFERENCE, SWEPT, WORKS, with_solver

import stickslip
from limit import Reference, measured

EQUAL = 1e-5
TOLERANCES = tuple(10.0 ** (-k / 2) for k in range(8, 21))
NEAR = [REFERENCE.replace({"drive.peak": float(peak)}) for peak in PEAKS]
SWEEP, SWEEP_RTOL, SWEEP_TOLERANCES = "swept", 1e-6, (3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
PACKS = {"packs of 4": {"STICKSLIP_LANES": "4"}, "widest packs": {}}


def places(rtol: float) -> np.ndarray:
    """Where the product ends, m."""
    runs = stickslip.simulate_batch([with_solver(each, rtol) for each in NEAR], threads=1)
    return np.array([run.final_state.x for run in runs])


def limit_places(reference: Reference, rtol: float) -> np.ndarray:
    return np.array([reference.answer(rtol, each).x for each in NEAR])


def tolerance_at(errors: Sequence[float], tolerances: Sequence[float], error: float) -> float:
    """Where the error, from loose to tight tolerances, has fallen to `error`."""
    fallen = np.log(np.minimum.accumulate(errors))
    if not fallen[-1] <= np.log(error) <= fallen[0]:
        raise ValueError(f"the error {error:g} is not among {np.exp(fallen)}")
    return float(np.exp(np.interp(np.log(error), fallen[::-1], np.log(tolerances)[::-1])))


def equal_tolerances(reference: Reference, error: float = EQUAL) -> tuple[float, float]:
    """Of the product and of the program."""
    exact = places(1e-12)

    def found(ends: Callable[[float], np.ndarray]) -> float:
        errors = [np.sqrt(np.mean((ends(rtol) / exact - 1.0) ** 2)) for rtol in TOLERANCES]
        return tolerance_at(errors, TOLERANCES, error)

    return found(places), found(lambda rtol: limit_places(reference, rtol))


def run_ratio(reference: Reference, fewest: int = FEWEST, most: int = MOST) -> dict:
    """CPU time of the product over that of the program, and of an evaluation of the rates."""
    own, other = equal_tolerances(reference)
    scenario = with_solver(REFERENCE, own)
    works = [filled(lambda: stickslip.simulate(scenario)), lambda: reference.seconds(other)]
    figure = ratios(list(in_turn(works, fewest, most)))
    steps = stickslip.simulate(scenario).summary()["steps"]
    evaluations = reference.answer(other).evaluations / steps["evaluations"]
    return {
        "rtol": own,
        "program_rtol": other,
        **figure._asdict(),
        "an_evaluation": figure.median * evaluations,
    }


def sweep_tolerance(reference: Reference, version: Version) -> tuple[float, float]:
    """Tolerance of the program at which its median error is that of the sweep, and this error."""
    exact = version.velocities(SWEEP, EXACT)
    size = np.maximum(np.abs(exact), 1e-6)  # below 1 um/s, relative to that
    names = list(GRID)
    scenarios = [
        SWEPT.replace(dict(zip(names, map(float, values), strict=True)))
        for values in itertools.product(*GRID.values())
    ]

    def error(velocities: np.ndarray) -> float:
        return float(np.median(np.abs(velocities - exact) / size))

    def ends(rtol: float) -> np.ndarray:
        return np.array([reference.answer(rtol, each).mean_velocity for each in scenarios])

    equal = error(version.velocities(SWEEP, SWEEP_RTOL))
    errors = [error(ends(rtol)) for rtol in SWEEP_TOLERANCES]
    return tolerance_at(errors, SWEEP_TOLERANCES, equal), equal


def sweep_ratios(reference: Reference, fewest: int = FEWEST, most: int = MOST) -> dict:
    """Simulated seconds a CPU second of the sweep over those of the program, by the packs."""
    package = Path(stickslip.__file__).parents[1]
    versions = [Version(package, **variables) for variables in PACKS.values()]
    rtol, error = sweep_tolerance(reference, versions[-1])
    works = [lambda: reference.seconds(rtol)]
    works += [lambda v=version: v.seconds(SWEEP, SWEEP_RTOL) for version in versions]
    samples = list(in_turn(works, fewest, most))
    for version in versions:
        version.close()
    simulated = WORKS[SWEEP].call(SWEEP_RTOL)[0] / simulated_time(REFERENCE)
    figures = {name: figure_of([simulated * row[0] / row[k] for row in samples])
               for k, name in enumerate(PACKS, 1)}  # fmt: skip
    return {"error": error, "program_rtol": rtol,
            **{name: figure._asdict() for name, figure in figures.items()}}  # fmt: skip


def _line(name: str, figure: dict) -> str:
    return f"{name:42}{figure['median']:8.3f}  {figure['low']:.3f} to {figure['high']:.3f}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench limit", description=__doc__)
    parser.add_argument("--fewest", type=int, default=FEWEST, help="pairs at least")
    parser.add_argument("--most", type=int, default=MOST, help="pairs at most")
    parser.add_argument("--out", type=Path, default=Path("bench/results/limit.json"))
    options = parser.parse_args()
    pin()
    reference = Reference()
    print(f"{'the program at rtol':21}{'CPU ms':>8}{'ns an evaluation':>18}{'evaluations':>13}"
          f"{'steps':>8}{'events':>8}")  # fmt: skip
    table = measured(TOLERANCES)
    for row in table:
        print(f"{row.rtol:<21.1e}{1e3 * row.cpu_seconds:8.3f}"
              f"{1e9 * row.cpu_seconds / row.evaluations:18.1f}{row.evaluations:13}{row.steps:8}"
              f"{row.events:8}")  # fmt: skip
    run = run_ratio(reference, options.fewest, options.most)
    print(f"\n{'':42}{'median':>8}  95 % interval")
    print(_line(f"CPU time of a run at an error of {EQUAL:.0e}", run), flush=True)
    print(f"{'of an evaluation of the rates':42}{run['an_evaluation']:8.3f}")
    sweep = sweep_ratios(reference, options.fewest, options.most)
    for name in PACKS:
        print(_line(f"speed of a sweep in {name}", sweep[name]))
    print(f"with a median error of the sweep's velocities of {sweep['error']:.1e}")
    reference.close()
    saved(options.out, "limit", {"program": [row._asdict() for row in table], "run": run,
                                 "sweep": sweep})  # fmt: skip


if __name__ == "__main__":
    main()
