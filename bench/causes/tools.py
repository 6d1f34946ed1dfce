"""The sets as questions, and two tools that everybody knows."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import f as f_law

from causes.make import FOLDER
from stickslip import Diagnosis, diagnose_model, models
from stickslip._util.toml import parse_toml
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.model import posed

SIGNIFICANT = 0.05  # of the stepwise test, as is usual
UNSEEN = 1e-3  # of the usual size of a cause: none
NEAR = 1e-4  # relative, where a descent ends: F of 200 readings to 0.02

Answer = dict[str, Any]


@dataclass(frozen=True)
class Asked:
    """A set: its problem, how its verdict is reached, and the errors of its readings, if known."""

    problem: Problem
    diagnosed: Callable[[], Diagnosis]
    sd: Any = None


def asked() -> Iterator[tuple[str, Callable[[], Asked]]]:
    """Each set by name, with the causes that are listed."""
    for path in sorted(FOLDER.glob("*/*.toml")):
        told = parse_toml(path.read_text())
        if "kind" in told:
            suffix = " unlisted" if path.stem == "unlisted" else ""
            read = _walker if told["kind"] == "walker" else _of_a_model
            yield path.parent.name + suffix, partial(read, path.parent, told)


def _of_a_model(folder: Path, told: dict[str, Any]) -> Asked:
    known = {**{k: tuple(v) for k, v in told["constants"].items()}, **told["known"]}
    model = getattr(models, told["kind"])(without=told["without"], **known)
    log = models.read_log(folder / told["log"], model)
    return Asked(posed(log, model, *model.terms(log)), partial(diagnose_model, model, log))


def _walker(folder: Path, told: dict[str, Any]) -> Asked:
    from stickslip import diagnose, read_measurement
    from stickslip.walker.problem import posed_by

    measured = read_measurement(folder / "measurement.toml")
    effects = {each.name: each for each in posed_by(measured).causes}
    # What the scenario has is no cause: it is there, too small to be seen.
    nothing = {
        each.name: each.absent + UNSEEN * each.size
        for name in told["without"]
        for each in effects[name].parameters
    }
    measured = replace(measured, scenario=measured.scenario.replace(nothing))
    problem = posed_by(measured)
    return Asked(problem, partial(diagnose, measured, threads=1), problem.sd)


class _Fits:
    """Least squares of the constants and some causes; priors of the constants are readings too."""

    def __init__(self, one: Asked) -> None:
        self.problem = one.problem
        self.causes = [each for each in self.problem.causes if each.parameters]
        self.y = self.problem.y
        self.scale = one.sd if one.sd is not None else float(np.std(np.diff(self.y))) or 1.0
        # What is stated of the constants holds them, loosely where errors are not known. A
        # simulated velocity has jumps.
        self.pull, self.step, self.near = (0.1, 1e-4, NEAR) if one.sd is None else (1.0, 1e-2, 1e-2)
        self.known: dict[tuple[str, ...], tuple[float, int]] = {}
        self.ends: dict[tuple[str, ...], Any] = {}

    def __call__(self, names: tuple[str, ...], begin: tuple[str, ...] = ()) -> tuple[float, int]:
        """Sum of squares and number of parameters of the best of a few starts.

        The starts are where the fit of `begin` ended, with some sizes of the causes beside it.
        """
        if names in self.known:
            return self.known[names]
        chosen = self._chosen(names)
        free = self.problem.free(chosen)
        low, high = self.problem.limits[:, free]
        own = len(self.problem.constants)

        def of(points: Any) -> Any:
            whole = np.zeros((len(points), self.problem.size))
            whole[:, free] = points
            made = self.problem.model(self.problem.physical(whole))
            gap = np.clip(np.nan_to_num((self.y - made) / self.scale, nan=1e3), -1e6, 1e6)
            return np.hstack([gap, points[:, :own] * self.pull])

        def residuals(x: Any) -> Any:
            return of(x[None, :])[0]

        def slopes(x: Any) -> Any:
            # Away from an end, all by one call of the model.
            steps = np.where(x + self.step > high, -self.step, self.step)
            return ((of(x + np.diag(steps)) - of(x[None, :])) / steps[:, None]).T

        best, end = np.inf, np.zeros(self.problem.size)
        sizes = (0.0,) if not chosen else (0.3, -0.3) if begin else (0.3, -0.3, 2.0)
        for size in sizes:
            x = np.full(len(free), size)
            x[:own] = 0.0
            if begin:
                known = np.isin(free, self.problem.free(self._chosen(begin)))
                x[known] = self.ends[begin][free[known]]
            x = np.clip(x, low + 1e-6, high - 1e-6)
            found = least_squares(
                residuals, x, slopes, (low, high), ftol=self.near, xtol=self.near, max_nfev=40
            )
            squares = float(np.sum(found.fun[: len(self.y)] ** 2))
            if squares < best:
                best, end[free] = squares, found.x
        self.known[names], self.ends[names] = (best, len(free)), end
        return self.known[names]

    def _chosen(self, names: tuple[str, ...]) -> list[Any]:
        return [each for each in self.causes if each.name in names]


def best_bic(one: Asked) -> Answer:
    """The model of one cause or none with the best Bayesian information criterion."""
    fits = _Fits(one)
    n = len(fits.y)

    def bic(names: tuple[str, ...]) -> float:
        squares, size = fits(names)
        return float(n * np.log(squares / n) + size * np.log(n))

    best = min([(), *((each.name,) for each in fits.causes)], key=bic)
    return {"said": "named" if best else "none", "causes": list(best)}


def stepwise(one: Asked) -> Answer:
    """Stepwise selection by F-tests: adds the best cause, then drops those that no longer count."""
    fits = _Fits(one)
    every = [each.name for each in fits.causes]

    def chance(smaller: tuple[str, ...], larger: tuple[str, ...]) -> float:
        (before, size), (after, more) = fits(smaller), fits(larger)
        free = len(fits.y) - more
        return float(f_law.sf((before - after) / (more - size) / (after / free), more - size, free))

    names: tuple[str, ...] = ()
    for _ in range(2 * len(every)):
        trials = [tuple(sorted((*names, each))) for each in every if each not in names]
        best = min(trials, key=lambda each: fits(each, names)[0], default=names)
        if best == names or chance(names, best) > SIGNIFICANT:
            break
        names = best
        while len(names) > 1:
            less = [tuple(each for each in names if each != gone) for gone in names]
            weakest = max(less, key=lambda each: chance(each, best))
            if chance(weakest, best) <= SIGNIFICANT:
                break
            names = best = weakest
    return {"said": "named" if names else "none", "causes": list(names)}


TOOLS: dict[str, Callable[[Asked], Answer]] = {
    "best BIC": best_bic, "stepwise F": stepwise,
}  # fmt: skip


def run(tool: str, minutes: float, write: Callable[[Answer], None], have: Answer) -> None:
    """Answer the sets that have no answer yet; begin none after so many minutes."""
    ends = time.monotonic() + 60.0 * minutes
    for name, read in asked():
        if name not in have and time.monotonic() <= ends:
            start = time.process_time()
            have[name] = {**TOOLS[tool](read()), "cpu": round(time.process_time() - start, 2)}
            print(name, have[name], flush=True)
            write(have)
