"""The function `stickslip.predict`: quantiles of a sweep with a dimension of drawn values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.messages import as_list, check_kind, check_whole, shown
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.uncertain import JointPrior
from stickslip.simulation.simulate import Progress
from stickslip.sweeping.dataset import OK
from stickslip.sweeping.points import Points, Vary, check_count, points_of
from stickslip.sweeping.run_sweep import sweep_points

if TYPE_CHECKING:
    import xarray

DRAWS = 200
"""Draws where none are asked for. Chosen: a quantile of 10 % is then one of 7.9 to 12.1 %."""

QUANTILES = (0.1, 0.5, 0.9)


def predict(
    scenario: Scenario,
    vary: Vary | None = None,
    draws: int = DRAWS,
    seed: int = 0,
    quantiles: Sequence[float] = QUANTILES,
    uncertain: JointPrior | Mapping[str, Any] | Scenario | None = None,
    *,
    threads: int | None = None,
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    resume: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """Quantiles of the numbers of a summary over the uncertain parameters of a scenario.

    Every point is simulated with the same drawn values, so that differences between points are
    known better than the points themselves. Bit-identical for any number of threads or workers.

    Parameters
    ----------
    scenario : Scenario
        What the points have in common. Of ``[record]`` only ``pull_share`` counts, as in `sweep`.
    vary : mapping, or sequence of mappings, or pandas.DataFrame, optional
        The points, as for `sweep`; the scenario alone, if not given.
    draws : int
        From 2. A quantile q is estimated to within sqrt(q (1 - q) / draws), as a share of the
        draws; the result has the error of each in the unit of its number.
    seed : int
        From 0. More draws of one seed keep those that there were.
    quantiles : sequence of float
        Between 0 and 1.
    uncertain : JointPrior, mapping or Scenario, optional
        In place of the scenario's own uncertain parameters: priors by key, as
        `Measurement.uncertain` has them, or a scenario such as `Diagnosis.extended`; see
        `Scenario.with_uncertain`.
    threads, executor, resume, progress : optional
        As for `sweep`.
    out : path-like, optional
        netCDF file of all simulations: a sweep with another dimension ``draw``.

    Returns
    -------
    xarray.Dataset
        Dimensions and coordinates of the points, as `sweep` has them, and ``quantile``. For each
        number of a summary, such as `mean_velocity`, its quantiles over the draws that did not
        fail, and as `mean_velocity_error` their standard errors, as the draws are no more; NaN
        where the draws are too few. `failed` counts the draws that failed, at each point.
        Attributes: `draws`, `seed`, `redrawn` (draws that made no scenario, so that others took
        their place), `failed_draws` (of all points), `message` (of the first that failed), and
        `statuses`, `notes` and `sweep` of the sweep over all draws.

    Raises
    ------
    ScenarioError
        If nothing is uncertain, a key is both varied and uncertain, a number is not allowed, or a
        hundred draws in succession make no scenario.
    ValueError, OSError
        As for `sweep`.

    Examples
    --------
    >>> base = Scenario(uncertain={"contact.kinetic_friction": {"mean": 0.145, "sd": 0.01}})
    >>> data = predict(base.replace({"drive.pulses": 10}), {"drive.frequency": [30, 60]}, draws=20)
    >>> dict(data.mean_velocity.sizes)
    {'drive_frequency': 2, 'quantile': 3}
    """
    check_kind("scenario", scenario, Scenario)
    if uncertain is not None:
        scenario = scenario.with_uncertain(uncertain)
    check_whole("draws", draws, 2)
    allowed = "numbers between 0 and 1, each once"
    levels = as_list("quantiles", quantiles, allowed)
    sound = all(isinstance(level, float) and 0.0 < level < 1.0 for level in levels)
    if not levels or not sound or len({*levels}) < len(levels):
        raise ScenarioError(f"quantiles = {shown(levels)}: allowed are {allowed}")
    levels = sorted(map(float, levels))
    prior = scenario.uncertain
    if prior is None:
        raise ScenarioError(
            "the scenario has no uncertain parameters: state them under [uncertain], or by "
            "uncertain=... or --uncertain FILE"
        )
    alone = vary is None or (isinstance(vary, Mapping) and not vary)
    points = Points(scenario, {}, {}) if alone else points_of(scenario, vary)
    for key in points.keys:
        if key in prior.names:
            raise ScenarioError(f"{key}: allowed is either varied or uncertain, not both")
    check_count(points.count * draws)
    scenarios, redrawn = scenario.counted_draws(draws, seed)
    values = np.array([[draw.get(key) for key in prior.names] for draw in scenarios])
    drawn = points.with_draws(prior.names, values)
    data = sweep_points(drawn, threads, executor, out, resume, progress)

    dims = tuple(points.sizes)
    below = ("quantile", levels, {"units": "1", "long_name": "part of the draws that lies below"})
    failed = (
        (data["status"] != OK).sum("draw").assign_attrs(long_name="draws that failed", units="1")
    )
    made = failed.to_dataset(name="failed").assign_coords(quantile=below)
    for name, figure in data.data_vars.items():
        if figure.dtype != float or name == "simulated_time":
            continue
        both = quantiles_with_errors(figure.values.reshape(points.count, draws), levels)
        meaning = figure.attrs["long_name"]
        meanings = meaning, f"standard error of the quantile: {meaning}"
        for full, array, words in zip((name, f"{name}_error"), both, meanings, strict=True):
            shaped = array.reshape(*points.shape, len(levels))
            made[full] = ((*dims, "quantile"), shaped, {**figure.attrs, "long_name": words})
    messages = [text for text in data["message"].values.flat if text] if "message" in data else []
    kept = {
        name: data.attrs[name] for name in ("title", "created_by", "statuses", "notes", "sweep")
    }
    return made.assign_attrs(
        kept,
        draws=draws,
        seed=seed,
        redrawn=redrawn,
        failed_draws=int(failed.sum()),
        message=messages[0] if messages else "",
    )


def quantiles_with_errors(values: Array, levels: Sequence[float]) -> tuple[Array, Array]:
    """Quantiles of each row and their standard errors, shape (rows, levels); NaN is no value.

    A share q of n draws lies below the quantile q to within sqrt(q (1 - q) / n). How much that is
    in the unit of the number, the quantiles twice as far below and above say, whatever the
    distribution is. Where these are no shares, below 0 or above 1, or there are fewer than two
    values, the error is NaN: as that of the quantile 0.1 of fewer than 36 draws.
    """
    ordered = np.sort(values, axis=1)  # NaN comes last
    count = np.sum(~np.isnan(values), axis=1)[:, None]
    last = np.maximum(count - 1, 0)

    def at(level: Array) -> Array:
        position = level * last
        low = np.floor(position).astype(np.int64)
        first, second = (
            np.take_along_axis(ordered, rank, axis=1) for rank in (low, np.minimum(low + 1, last))
        )
        return np.asarray(first + (position - low) * (second - first))

    level = np.broadcast_to(levels, (len(values), len(levels)))
    share = np.sqrt(level * (1.0 - level) / np.maximum(count, 1))
    below, above = level - 2.0 * share, level + 2.0 * share
    known = (count > 1) & (below >= 0.0) & (above <= 1.0)
    width = at(np.where(known, above, level)) - at(np.where(known, below, level))
    return at(level), np.where(known, 0.25 * width, np.nan)
