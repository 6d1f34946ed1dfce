"""The function `stickslip.predict`: a sweep whose points are simulated for many drawn scenarios."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.numbers import Array
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import check_kind, check_whole, shown
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.uncertain import counted_draws
from stickslip.simulation.columns import NUMBERS
from stickslip.simulation.note import notes_json
from stickslip.simulation.seen_from_drive import VELOCITIES
from stickslip.simulation.simulate import Progress
from stickslip.sweeping.notes import notes_of_points
from stickslip.sweeping.plane_velocities import plane_velocities
from stickslip.sweeping.points import MOST_POINTS, Points, as_list, from_changes
from stickslip.sweeping.prediction import Prediction
from stickslip.sweeping.results import OK, Results
from stickslip.sweeping.run_sweep import Vary, points_of, simulated

if TYPE_CHECKING:
    import xarray

    from stickslip.scenario.uncertain import JointPrior

DRAWS = 200
"""Draws where none are asked for. Chosen: a quantile of 10 % is then one of 7.9 to 12.1 %."""

QUANTILES = (0.1, 0.5, 0.9)

FIGURES = tuple(name for name in NUMBERS if name != "simulated_time")
"""The figures of a summary that have quantiles; see `sweep`."""


def predict(
    scenario: Scenario,
    vary: Vary | None = None,
    draws: int = DRAWS,
    seed: int = 0,
    quantiles: Sequence[float] = QUANTILES,
    uncertain: JointPrior | Mapping[str, Any] | Scenario | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Prediction:
    """Quantiles of the figures of a summary over what is uncertain in a scenario.

    Every point is simulated with the same drawn values, so that differences between points are
    known better than the points themselves. Bit-identical for any number of threads.

    Parameters
    ----------
    scenario : Scenario
        What the points have in common. What it records is ignored.
    vary : mapping or sequence of mappings, optional
        The points, as for `sweep`; the scenario alone, if not given.
    draws : int
        From 2. A quantile q is estimated to within sqrt(q (1 - q) / draws), as a share of the
        draws; the result has the error of each in the unit of its figure.
    seed : int
        From 0. More draws of one seed keep those that there were.
    quantiles : sequence of float
        Between 0 and 1.
    uncertain : JointPrior, mapping or Scenario, optional
        In place of what is uncertain in the scenario: priors by key, as `Measurement.uncertain`
        has them, or a scenario such as `Diagnosis.extended`; see `Scenario.with_uncertain`.
    threads : int, optional
        How many simulations go on at a time; as many as there are processors, if not given.
    progress : callable, optional
        As for `sweep`.

    Returns
    -------
    Prediction

    Raises
    ------
    ScenarioError
        If nothing is uncertain, a key is both varied and uncertain, a number is not allowed, or a
        hundred draws in succession make no scenario.
    ValueError
        If `threads` is not a whole number above zero.

    Examples
    --------
    >>> base = Scenario(uncertain={"contact.kinetic_friction": {"mean": 0.145, "sd": 0.01}})
    >>> predict(base.replace({"drive.pulses": 10}), {"drive.frequency": [30.0, 60.0]}, draws=20)
    <Prediction of 2 points, 20 draws each, none failed, quantiles 0.1, 0.5, 0.9>
    """
    check_kind("scenario", scenario, Scenario)
    if uncertain is not None:
        scenario = scenario.with_uncertain(uncertain)
    varied = vary is not None and vary != {}
    points = points_of(scenario, vary) if varied else single_point(scenario)
    return predicted(points, varied, draws, seed, quantiles, threads, progress)


def single_point(scenario: Scenario) -> Points:
    """The points of a prediction that varies nothing."""
    return from_changes(scenario, [{}])


def predicted(
    points: Points,
    varied: bool,
    draws: int,
    seed: int,
    quantiles: Sequence[float],
    threads: int | None,
    progress: Progress | None,
) -> Prediction:
    """`predict` of points that are known already; of those of `single_point`, not `varied`."""
    check_whole("draws", draws, 2)
    check_whole("seed", seed)
    levels = _checked_levels(quantiles)
    uncertain = points.scenario.uncertain
    if uncertain is None:
        raise ScenarioError(
            "uncertain: the scenario holds nothing that is, so there is no band; name it in "
            "[uncertain] of its file, or give it: uncertain=..., or --uncertain FILE"
        )
    for key in points.keys:
        if key in uncertain.names:
            raise ScenarioError(f"{key}: allowed is either varied or uncertain, not both")
    if points.count * draws > MOST_POINTS:
        raise ScenarioError(
            f"{points.count} points of {draws} draws: allowed are at most {MOST_POINTS} simulations"
        )
    scenarios, refused = counted_draws(points.scenario, draws, seed)
    values = np.array([[each.get(key) for key in uncertain.names] for each in scenarios])
    drawn = points.with_draws(uncertain.names, values)
    results = simulated(drawn, threads, progress)
    about_draws = {"draws": draws, "redrawn": refused, "seed": seed}
    return Prediction(_dataset(points, varied, drawn, results, levels, about_draws))


def _checked_levels(quantiles: object) -> list[float]:
    allowed = "numbers between 0 and 1, each once"
    levels = as_list("quantiles", quantiles, allowed)
    numbers = [each for each in levels if isinstance(each, float) and 0.0 < each < 1.0]
    if not levels or len(set(numbers)) < len(levels):
        raise ScenarioError(f"quantiles = {shown(levels)}: allowed are {allowed}")
    return sorted(map(float, numbers))


def _dataset(
    points: Points,
    varied: bool,
    drawn: Points,
    results: Results,
    levels: list[float],
    about_draws: dict[str, int],
) -> xarray.Dataset:
    """Quantiles over the draws; `results` are those of `drawn`, of each point draw by draw."""
    import xarray

    from stickslip.sweeping.dataset import about, coordinates

    draws = about_draws["draws"]
    found: dict[str, tuple[Any, ...]] = {}
    dimensions = (*points.dimensions, "quantile")
    numbers = {name: results.numbers[name] for name in FIGURES}
    columns = {**NUMBERS, **VELOCITIES}
    for name, each in {**numbers, **plane_velocities(drawn, numbers)}.items():
        column = columns[name]
        values = each.reshape(points.count, draws)
        level, error = quantiles_with_errors(values, levels)
        for full, shares, meaning in (
            (name, level, column.meaning),
            (f"{name}_error", error, f"standard error of the quantile: {column.meaning}"),
        ):
            attributes = {"units": column.unit, "long_name": meaning}
            found[full] = (dimensions, shares.reshape(*points.shape, len(levels)), attributes)
    failed = np.sum(results.status.reshape(*points.shape, draws) != OK, axis=-1)
    found["failed"] = (points.dimensions, failed, {"units": "1", "long_name": "draws that failed"})
    below = ("quantile", levels, {"units": "1", "long_name": "part of the draws that lies below"})
    result = xarray.Dataset(
        found,
        coords={**coordinates(points), "quantile": below},
        attrs={
            **about(points, "prediction", "predict"),
            **about_draws,
            "failed_draws": int(failed.sum()),
            "statuses": json.dumps(results.counts()),
            "notes": notes_json(notes_of_points(drawn, results, "simulations")),
            "message": results.messages.get(min(results.messages, default=0), ""),
        },
    )
    return result if varied else result.isel(point=0, drop=True).assign_attrs(vary="{}")


def quantiles_with_errors(values: Array, levels: Sequence[float]) -> tuple[Array, Array]:
    """Quantiles of each row and their standard errors, shape (rows, levels); NaN is no value.

    A share q of n draws lies below the quantile q to within sqrt(q (1 - q) / n). How much that is
    in the unit of the figure, the quantiles twice as far below and above say, whatever the
    distribution is. Where these are no shares, below 0 or above 1, or there are fewer than two
    values, the error is NaN: as that of the quantile 0.1 of fewer than 36 draws.
    """
    ordered = np.sort(values, axis=1)  # NaN comes last
    count = np.sum(~np.isnan(values), axis=1)

    def at(level: Array) -> Array:
        place = level * np.maximum(count - 1, 0)
        low = np.floor(place).astype(np.int64)
        high = np.minimum(low + 1, np.maximum(count - 1, 0))
        rows = np.arange(len(values))
        first, last = ordered[rows, low], ordered[rows, high]
        return np.asarray(first + (place - low) * (last - first))

    found, errors = [], []
    for level in levels:
        share = np.sqrt(level * (1.0 - level) / np.maximum(count, 1))
        below, above = level - 2.0 * share, level + 2.0 * share
        known = (count > 1) & (below >= 0.0) & (above <= 1.0)
        found.append(at(np.full(len(values), level)))
        width = at(np.where(known, above, level)) - at(np.where(known, below, level))
        errors.append(np.where(known, 0.25 * width, np.nan))
    return np.stack(found, axis=1), np.stack(errors, axis=1)
