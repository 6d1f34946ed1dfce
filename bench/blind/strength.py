"""Signal to noise of what is hidden, after all that recalibration could absorb of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from blind.readings import Readings
from blind.settings import (
    ANGLE_SD,
    EXPOSURE,
    FIELD_SD,
    FILM_SD,
    FLOOR,
    FRAME_RATE,
    PULSES,
    SCATTER,
    TRIALS,
    Drive,
    films,
    held_fields,
    priors,
    probes,
)
from blind.truth import Truth
from stickslip import Coils, Scenario, _core
from stickslip.diagnosis.fit.baseline import recalibrate
from stickslip.diagnosis.fit.fit_result import Start, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.model.problem import Cause, Problem, Uncertain
from stickslip.diagnosis.model.simulator import Simulator
from stickslip.diagnosis.observables.tracking.film import FilmObservable
from stickslip.measurement.tracking import TrackingRun

Array = NDArray[np.float64]

_FEWER = 5.0  # pulses of a draft, for the search from afar
_STEPS = 12  # of a fit
_TOP_VOLTAGE = 31.2  # V, of the largest peak


class Absorber:
    """What the constants can undo about a truth, and one cause with them if it is free.

    The core is used only to say how strong a hidden effect is; no datum comes from it.
    """

    def __init__(
        self, truth: Truth, drives: Sequence[Drive], plain: Readings, tables: tuple[str, ...]
    ) -> None:
        known = priors(tables)
        self._tables = _tables(plain)
        nuisance = [each for table in self._tables for each in getattr(table, "nuisance", ())]
        uncertain = [*(Uncertain(name, prior) for name, prior in known.items()), *nuisance]
        coordinates = [prior.coordinate(truth.constants[name]) for name, prior in known.items()]
        self._centre = np.array([*coordinates, *np.zeros(len(nuisance))])
        sd = np.hypot(SCATTER * plain.velocity, FLOOR) / np.sqrt(TRIALS)
        spreads = [np.linalg.inv(np.linalg.cholesky(each.covariance)) for each in self._tables]
        whiten = block_diag(*([np.diag(1.0 / sd)] if len(sd) else []), *spreads)
        self._drives = list(drives) if len(sd) else []
        self._problem = self._posed(uncertain, (), whiten, self._observed(plain))
        self._plain = self._nearby(self._problem)

    def _posed(
        self, uncertain: Sequence[Uncertain], causes: tuple[Cause, ...], whiten: Array, seen: Array
    ) -> Problem:
        scenario = Scenario().replace({"solver.rtol": 1e-5})
        names = [each.name for each in uncertain]
        names += [each.name for cause in causes for each in cause.parameters]
        keys = [k for k, name in enumerate(names) if not name.startswith("tracking.")]
        simulator = Simulator(scenario, [names[k] for k in keys], 1)

        def predict(settings: list[dict[str, float | str]], values: Array) -> Array:
            moving = simulator(settings, values[:, keys]) if settings else values[:, :0]
            return np.hstack([moving, *(each.predict(names, values) for each in self._tables)])

        settings = [
            {**{f"drive.{key}": value for key, value in drive.items()}, "drive.pulses": PULSES}
            for drive in self._drives
        ]
        fewer = [{**each, "drive.pulses": _FEWER, "solver.rtol": 1e-4} for each in settings]
        return Problem(
            predict, settings, seen, whiten, np.inf, tuple(uncertain), causes,
            low_fidelity=lambda _, values: predict(fewer, values),
        )  # fmt: skip

    def _observed(self, level: Readings) -> Array:
        return np.concatenate([level.velocity, *(each.observed(level) for each in self._tables)])

    def freeing(self, cause: str) -> Absorber:
        """The same where a cause of the library is fitted too."""
        (chosen,) = [each for each in library(Scenario(), {}, _TOP_VOLTAGE) if each.name == cause]
        other = object.__new__(Absorber)
        other.__dict__.update(self.__dict__)
        other._problem = self._posed(
            self._problem.uncertain, (chosen,), self._problem.whiten, self._problem.observed
        )
        other._centre = np.concatenate([self._centre, np.zeros(len(chosen.parameters))])
        return other

    def strength(self, level: Readings) -> float:
        """S of readings without noise: what is left of them after recalibration nearby."""
        return self._size(self._nearby(replace(self._problem, observed=self._observed(level))))

    def searched(self, level: Readings) -> float:
        """The same after recalibration that has looked for constants everywhere."""
        problem = replace(self._problem, observed=self._observed(level))
        nearby = self._nearby(problem)
        # What a film or a free cause has beside the constants is near its start in any case.
        if self._problem.causes or not self._drives or len(self._problem.uncertain) > len(_FULL):
            return self._size(nearby)
        return self._size(min(nearby, recalibrate(problem, 0).null.chi2))

    def _size(self, chi2: float) -> float:
        return float(np.sqrt(max(chi2 - self._plain, 0.0)))

    def _nearby(self, problem: Problem) -> float:
        starts = [[Start(self._centre)]]
        candidate = make_candidate(problem, problem.causes)
        return fit_candidates(problem, [candidate], starts, _STEPS, exact=False)[0].chi2


_FULL = priors(("velocity",))


class _Angles:
    """The table of static tilts."""

    def __init__(self, count: int) -> None:
        self.covariance = ANGLE_SD**2 * np.eye(count)

    def observed(self, level: Readings) -> Array:
        return level.angle

    def predict(self, names: Sequence[str], values: Array) -> Array:
        keys = _scenario_keys(names)
        core = Scenario().to_core()
        return _core.static_tilts(core, [names[k] for k in keys], values[:, keys], held_fields())


class _Fields:
    """The table of the coils' fields; of the causes only the side of the coils changes it here."""

    def __init__(self, count: int) -> None:
        self.covariance = FIELD_SD**2 * np.eye(count)

    def observed(self, level: Readings) -> Array:
        return level.field.ravel()

    def predict(self, names: Sequence[str], values: Array) -> Array:
        rows = probes()
        sides = (
            values[:, names.index("coil.side")] if "coil.side" in names else [None] * len(values)
        )
        return np.array(
            [
                Coils(**({} if side is None else {"side": float(side)}))
                .field(rows[:, 5:], rows[:, :5])
                .ravel()
                for side in sides
            ]
        )


class _Film:
    """One film, reduced as the diagnosis reduces it, with the noise that is stated."""

    def __init__(self, number: int, drive: Drive, columns: dict[str, Array]) -> None:
        scenario = Scenario().replace({f"drive.{key}": value for key, value in drive.items()})
        inside = columns["t"] < scenario.window[1]
        self._inside, self._number = inside, number
        run = TrackingRun(
            "film", {key: each[inside] for key, each in columns.items()}, scenario, FRAME_RATE,
            EXPOSURE, FILM_SD,
        )  # fmt: skip
        self._film = FilmObservable(run, number + 1)
        self.covariance, self.nuisance = self._film.covariance, self._film.nuisance

    def observed(self, level: Readings) -> Array:
        columns = level.films[self._number]
        at = self._film.run.columns["t"]
        seen = {name: np.interp(at, columns["t"], columns[name]) for name in ("x", "theta")}
        return np.concatenate(
            [each.matrix @ seen[each.name][each.frames] for each in self._film.quantities]
        )

    def predict(self, names: Sequence[str], values: Array) -> Array:
        own = [
            k for k, name in enumerate(names)
            if not name.startswith("tracking.") or name.startswith(f"{self._film.name}.")
        ]  # fmt: skip
        return self._film.predict([names[k] for k in own], values[:, own])


def _scenario_keys(names: Sequence[str]) -> list[int]:
    return [k for k, name in enumerate(names) if not name.startswith("tracking.")]


def _tables(plain: Readings) -> list[_Angles | _Fields | _Film]:
    """What there is beside the velocities."""
    result: list[_Angles | _Fields | _Film] = []
    if len(plain.angle):
        result.append(_Angles(plain.angle.size))
    if len(plain.field):
        result.append(_Fields(plain.field.size))
    result += [
        _Film(number, drive, columns)
        for number, (drive, columns) in enumerate(zip(films(), plain.films, strict=False))
    ]
    return result
