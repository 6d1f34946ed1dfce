"""Tools that answer the sets: ours, and two that everybody knows."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import f as f_law

from causes.make import FOLDER
from stickslip import diagnose_model, models
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.own_model import pose_own
from stickslip.scenario.toml_file import parse_toml

SIGNIFICANT = 0.05  # of the stepwise test, as is usual
STEP = 1e-4  # of a difference, in coordinates

Answer = dict[str, Any]


def asked() -> Iterator[tuple[str, models.Model, Any]]:
    """Each set by name, its model with the causes that are listed, and its log."""
    for path in sorted(FOLDER.glob("*/*.toml")):
        told = parse_toml(path.read_text())
        known = {**{k: tuple(v) for k, v in told["constants"].items()}, **told["known"]}
        model = getattr(models, told["kind"])(without=told["without"], **known)
        log = models.read_log(path.parent / told["log"], model)
        suffix = " unlisted" if path.stem == "unlisted" else ""
        yield path.parent.name + suffix, model, log


def ours(model: models.Model, log: Any) -> Answer:
    verdict = diagnose_model(model, log).verdict
    return {"said": verdict.kind, "causes": list(verdict.causes)}


class _Fits:
    """Least squares of the constants and some causes; priors of the constants are readings too."""

    def __init__(self, model: models.Model, log: Any) -> None:
        constants, causes = model.terms(log)
        self.problem: Problem = pose_own(model, log, constants, causes)
        self.causes = [each for each in self.problem.causes if each.parameters]
        (table,) = self.problem.tables
        self.y = np.asarray(table.y)
        self.scale = float(np.std(np.diff(self.y))) or 1.0
        self.known: dict[tuple[str, ...], tuple[float, int]] = {}

    def __call__(self, names: tuple[str, ...]) -> tuple[float, int]:
        """Sum of squares and number of parameters of the best of a few starts."""
        if names in self.known:
            return self.known[names]
        chosen = [each for each in self.causes if each.name in names]
        free = self.problem.free(chosen)
        low, high = self.problem.limits[:, free]
        own = len(self.problem.constants)

        def of(points: Any) -> Any:
            whole = np.zeros((len(points), self.problem.size))
            whole[:, free] = points
            made = self.problem.model(self.problem.physical(whole))
            gap = np.nan_to_num((self.y - made) / self.scale, nan=1e3)
            return np.hstack([gap, points[:, :own] * 0.1])

        def residuals(x: Any) -> Any:
            return of(x[None, :])[0]

        def slopes(x: Any) -> Any:
            # Away from the nearer end, all by one call of the model.
            steps = np.where(x > 0.5 * (low + high), -STEP, STEP)
            return ((of(x + np.diag(steps)) - of(x[None, :])) / steps[:, None]).T

        best = np.inf
        for begin in (0.3, -0.3, 2.0) if chosen else (0.0,):
            x = np.zeros(len(free))
            x[own:] = begin
            x = np.clip(x, low + 1e-6, high - 1e-6)
            found = least_squares(residuals, x, slopes, bounds=(low, high), max_nfev=40)
            best = min(best, float(np.sum(found.fun[: len(self.y)] ** 2)))
        self.known[names] = best, len(free)
        return self.known[names]


def best_bic(model: models.Model, log: Any) -> Answer:
    """The model of one cause or none with the best Bayesian information criterion."""
    fits = _Fits(model, log)
    n = len(fits.y)

    def bic(names: tuple[str, ...]) -> float:
        squares, size = fits(names)
        return float(n * np.log(squares / n) + size * np.log(n))

    best = min([(), *((each.name,) for each in fits.causes)], key=bic)
    return {"said": "named" if best else "none", "causes": list(best)}


def stepwise(model: models.Model, log: Any) -> Answer:
    """Causes are added as long as the F-test of the next best one is significant."""
    fits = _Fits(model, log)
    n, names = len(fits.y), ()
    while len(names) < 3:
        squares, size = fits(names)
        rest = [each.name for each in fits.causes if each.name not in names]
        trials = {each: fits(tuple(sorted((*names, each)))) for each in rest}
        name = min(trials, key=lambda each: trials[each][0])
        after, larger = trials[name]
        more = larger - size
        ratio = (squares - after) / more / (after / (n - larger))
        if f_law.sf(ratio, more, n - larger) > SIGNIFICANT:
            break
        names = tuple(sorted((*names, name)))
    return {"said": "named" if names else "none", "causes": list(names)}


TOOLS: dict[str, Callable[[models.Model, Any], Answer]] = {
    "stickslip": ours, "best BIC": best_bic, "stepwise F": stepwise,
}  # fmt: skip


def run(tool: str, minutes: float, write: Callable[[Answer], None], have: Answer) -> None:
    """Answer the sets that have no answer yet; begin none after so many minutes."""
    begun = time.monotonic()
    for name, model, log in asked():
        if name in have:
            continue
        if time.monotonic() - begun > 60.0 * minutes:
            return
        start = time.process_time()
        have[name] = {**TOOLS[tool](model, log), "cpu": round(time.process_time() - start, 2)}
        print(name, have[name], flush=True)
        write(have)
