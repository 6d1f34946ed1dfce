"""Diagnoses whose cost `now` measures."""

from __future__ import annotations

import json
import resource
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from causes.make import KINDS
from causes.tools import Asked, best_bic

from stickslip import Series, diagnose_model, models
from stickslip.diagnosis.model import posed

SEED = 82
DRIVES = [(mode, frequency) for mode in ("IPP", "OPP") for frequency in range(20, 105, 5)]
BENT = 0.1  # of a velocity, by a wave over the frequencies: like no cause


def _log(count: int) -> Asked:
    """A body that is heated in steps and loses more where it is warmer."""
    own, random = KINDS["thermal"], np.random.default_rng(SEED)
    t = own["step"] * np.arange(count)
    power = np.repeat(random.uniform(0.0, 60.0, count // 15 + 1), 15)[:count]
    stated = {name: (value, value * part) for name, (value, part) in own["constants"].items()}
    model = models.thermal(without=own["without"], **stated, **own["known"])
    y = model.simulate(t, {"power": power}, loss_growth=0.02, start_temperature=293.0)
    y += 0.02 * np.std(y) * random.standard_normal(count)
    log = Series(t, y, {"power": power}, unit="K")
    return Asked(posed(log, model, *model.terms(log)), partial(diagnose_model, model, log))


def _walker(changes: dict[str, float], bent: float) -> Asked:
    """Three trials of each of 34 drives of a robot that is other than stated, or off by a wave."""
    # Imported here: else they count as memory of a log's diagnosis.
    from blind.settings import PULSES
    from causes.walkers import FLOOR, SCATTER, STATED, TRIALS, files_of

    from stickslip import Scenario, diagnose, read_measurement, simulate
    from stickslip.walker.problem import posed_by

    rows, random = [["mode", "frequency", "trial", "velocity"]], np.random.default_rng(SEED)
    nominal = {name: float(prior.value(0.0)) for name, prior in STATED.items()}
    walk = Scenario().replace({**nominal, **changes, "drive.pulses": PULSES})
    for mode, frequency in DRIVES:
        run = simulate(walk.replace({"drive.mode": mode, "drive.frequency": float(frequency)}))
        level = run.mean_velocity * (1.0 + bent * np.sin(frequency / 10.0))
        noise = np.hypot(SCATTER * level, FLOOR) * random.standard_normal(TRIALS)
        rows += [[mode, f"{frequency}", f"{k}", f"{level + each:.5e}"]
                 for k, each in enumerate(noise)]  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files_of(rows).items():
            Path(folder, name).write_text(text)
        measured = read_measurement(Path(folder, "measurement.toml"))
    problem = posed_by(measured)
    return Asked(problem, partial(diagnose, measured, threads=1), problem.sd)


CASES: dict[str, Callable[[], Asked]] = {
    "log of 500 readings": partial(_log, 500),
    "log of 20 000 readings": partial(_log, 20_000),
    "log of 200 000 readings": partial(_log, 200_000),
    "walker of 34 conditions": partial(
        _walker, {"effects.friction_anisotropy.fraction": 0.25}, 0.0
    ),
    "walker of 34 conditions, nothing explains": partial(_walker, {}, BENT),
}


def main(name: str) -> None:
    """Print CPU seconds of a case and of its rival, its peak memory and its verdict, as JSON."""
    asked = CASES[name]()
    started = time.process_time()
    found = asked.diagnosed()
    ended = time.process_time()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    best_bic(asked)
    cpu = [ended - started, time.process_time() - ended]
    print(json.dumps({"cpu_seconds": cpu, "memory": memory, "verdict": str(found),
                      "causes": found.verdict.causes}))  # fmt: skip
