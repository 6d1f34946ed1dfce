#!/usr/bin/env bash
# Expected: a run whose result is NaN is ranked last when results are minimised, or is refused.
# What happens: every comparison with NaN is false, and it depends on who compares. In DEAP a NaN is kept as the hall of
#   fame's best and by tournaments: after 40 generations nearly all are NaN. The particle swarm of pymoo returns one as
#   its result; pymoo's GA, DE and Nelder-Mead, cma and pyswarms find the lowest point beside the failures. No error.
# Packages: deap 1.4.4, pymoo 0.6.2, cma 4.5.0, pyswarms 1.3.0, numpy 2.3.5. Source: found by trying.
# Who is hurt: whoever optimises a simulation that fails for some parameters.
# Instead: a large number, or inf, in place of NaN (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 deap==1.4.4 pymoo==0.6.2 cma==4.5.0 pyswarms==1.3.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import logging
import math
import random
import warnings
from importlib.metadata import version

import cma
import numpy as np
from deap import algorithms, base, creator, tools
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.nelder import NelderMead
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import ElementwiseProblem
from pymoo.optimize import minimize
from pyswarms.single import GlobalBestPSO

warnings.simplefilter("ignore")
logging.disable(logging.CRITICAL)
print(*(f"{name} {version(name)}" for name in ("deap", "pymoo", "cma", "pyswarms", "numpy")))


def result(x, failed):
    """A bowl around (1, 1); runs with x[0] below a half fail."""
    return failed if x[0] < 0.5 else float(np.sum((np.asarray(x) - 1.0) ** 2))


creator.create("Least", base.Fitness, weights=(-1.0,))
creator.create("Run", list, fitness=creator.Least)


def by_deap(failed):
    random.seed(2)
    box = base.Toolbox()
    box.register("number", random.uniform, -3.0, 3.0)
    box.register("run", tools.initRepeat, creator.Run, box.number, 2)
    box.register("runs", tools.initRepeat, list, box.run)
    box.register("evaluate", lambda x: (result(x, failed),))
    box.register("mate", tools.cxBlend, alpha=0.5)
    box.register("mutate", tools.mutGaussian, mu=0.0, sigma=0.3, indpb=0.5)
    box.register("select", tools.selTournament, tournsize=3)
    best = tools.HallOfFame(1)
    runs, _ = algorithms.eaSimple(box.runs(50), box, 0.5, 0.3, 40, halloffame=best, verbose=False)
    values = [run.fitness.values[0] for run in runs]
    return best[0].fitness.values[0], sum(not math.isfinite(value) for value in values)


class Problem(ElementwiseProblem):
    def __init__(self, failed):
        super().__init__(n_var=2, n_obj=1, xl=-3.0, xu=3.0)
        self.failed = failed

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = result(x, self.failed)


def by_pymoo(algorithm, failed):
    return float(minimize(Problem(failed), algorithm, ("n_gen", 40), seed=1).F[0])


best, lost = by_deap(math.nan)
mended, left = by_deap(1e9)
print(f"deap: best {best}, {lost} of 50 failed; with 1e9 in place of NaN {mended:.1e}, {left} of 50")
assert math.isnan(best) and lost > 35 and mended < 1e-3 and left < 25
swarm, better = by_pymoo(PSO(pop_size=30), math.nan), by_pymoo(PSO(pop_size=30), 1e9)
print(f"pymoo's swarm: best {swarm}, with 1e9 {better:.1e}")
assert math.isnan(swarm) and better < 1e-3
for algorithm in (GA(pop_size=50), DE(pop_size=50), NelderMead()):
    value = by_pymoo(algorithm, math.nan)
    print(f"pymoo's {type(algorithm).__name__}: {value:.1e}")
    assert value < 1e-3
np.random.seed(1)
flock = GlobalBestPSO(20, 2, {"c1": 0.5, "c2": 0.3, "w": 0.7}, bounds=(np.full(2, -3.0), np.full(2, 3.0)))
value = flock.optimize(lambda many: np.array([result(x, math.nan) for x in many]), 60, verbose=False)[0]
by_cma = cma.fmin(lambda x: result(x, math.nan), [2.0, 2.0], 0.5, {"verbose": -9, "seed": 1, "maxfevals": 600})[1]
print(f"pyswarms: {value:.1e}, cma: {by_cma:.1e}")
assert value < 1e-3 and by_cma < 1e-3
PROGRAM
