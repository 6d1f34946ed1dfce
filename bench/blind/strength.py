"""Signal to noise of what is hidden, after all that recalibration could absorb of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from blind.catalogue import TOP_VOLTAGE
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
Settings = list[dict[str, float | str]]


class Absorber:
    """What the constants can undo about a truth.

    The core is used only to say how strong a hidden effect is; no datum comes from it. `plain` are
    the readings of the robot with nothing hidden.
    """

    def __init__(
        self,
        truth: Truth,
        drives: Sequence[Drive],
        plain: Readings,
        tables: tuple[str, ...],
        freed: str | None = None,
    ) -> None:
        """`freed`: a cause, or a constant without its prior, that is fitted with the constants."""
        known = priors(tables)
        self._beside = _tables(plain)
        nuisance = [each for table in self._beside for each in table.nuisance]
        uncertain = [*(Uncertain(name, prior) for name, prior in known.items()), *nuisance]
        causes = _cause(freed)
        coordinates = [prior.coordinate(truth.constants[name]) for name, prior in known.items()]
        absent = sum(len(each.parameters) for each in causes) + len(nuisance)
        centre = np.array([*coordinates, *np.zeros(absent)])
        # The cause may be far from absent, and the way there has jumps.
        away = np.zeros(len(centre))
        away[len(coordinates) + len(nuisance) :] = 1.0
        factors = (0.0, 1.0, -1.0, 2.0, -2.0) if away.any() else (0.0,)
        self._starts = [Start(centre + factor * away) for factor in factors]
        # What a film or a free cause adds is near its start in any case.
        self._wide = freed is None and not nuisance and "velocity" in tables
        sd = np.hypot(SCATTER * plain.velocity, FLOOR) / np.sqrt(TRIALS)
        spreads = [np.linalg.inv(np.linalg.cholesky(each.covariance)) for each in self._beside]
        whiten = block_diag(*([np.diag(1.0 / sd)] if len(sd) else []), *spreads)
        settings = [
            {**{f"drive.{key}": value for key, value in drive.items()}, "drive.pulses": PULSES}
            for drive in drives
        ]
        fewer = [{**each, "drive.pulses": _FEWER, "solver.rtol": 1e-4} for each in settings]
        amplitudes = [each.name for cause in causes for each in cause.parameters]
        predict = self._model([*(each.name for each in uncertain), *amplitudes])
        self._problem = Problem(
            predict, settings, self._observed(plain), whiten, np.inf, tuple(uncertain), causes,
            low_fidelity=lambda _, values: predict(fewer, values),
        )  # fmt: skip
        self._plain = self._nearby(self._problem)

    def _model(self, names: Sequence[str]) -> Callable[[Settings, Array], Array]:
        """The core's answer at conditions and values of the parameters `names`."""
        keys = _scenario_keys(names)
        scenario = Scenario().replace({"solver.rtol": 1e-5})
        simulator = Simulator(scenario, [names[k] for k in keys], 1)

        def predict(settings: Settings, values: Array) -> Array:
            moving = simulator(settings, values[:, keys]) if settings else values[:, :0]
            return np.hstack([moving, *(each.predict(names, values) for each in self._beside)])

        return predict

    def _observed(self, level: Readings) -> Array:
        return np.concatenate([level.velocity, *(each.observed(level) for each in self._beside)])

    def strength(self, level: Readings) -> float:
        """S of readings without noise: what is left of them after recalibration nearby."""
        return self._size(self._nearby(replace(self._problem, observed=self._observed(level))))

    def searched(self, level: Readings) -> float:
        """The same after recalibration that has looked for constants everywhere."""
        problem = replace(self._problem, observed=self._observed(level))
        nearby = self._nearby(problem)
        return self._size(min(nearby, recalibrate(problem, 0).null.chi2) if self._wide else nearby)

    def _size(self, chi2: float) -> float:
        return float(np.sqrt(max(chi2 - self._plain, 0.0)))

    def _nearby(self, problem: Problem) -> float:
        candidate = make_candidate(problem, problem.causes)
        return fit_candidates(problem, [candidate], [self._starts], _STEPS, exact=False)[0].chi2


def _cause(name: str | None) -> tuple[Cause, ...]:
    """A cause of the library, or a constant whose prior is relaxed; none without a name."""
    if name is not None and "." in name:
        return (Cause(name, relaxes_prior=name),)
    return tuple(each for each in library(Scenario(), {}, TOP_VOLTAGE) if each.name == name)


class _Angles:
    """The table of static tilts."""

    nuisance: tuple[Uncertain, ...] = ()

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

    nuisance: tuple[Uncertain, ...] = ()

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
