"""Proposed drives as a table of velocities that a person fills in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.diagnosis.inference.discrimination import TRIALS
from stickslip.diagnosis.inference.experiment_design import CHOICES, Experiment
from stickslip.measurement.reading import Measurement

if TYPE_CHECKING:
    from pandas import DataFrame


def setting_columns(measurement: Measurement) -> list[str]:
    """Bare names of the settings that a table of proposed drives has.

    Those that proposals vary, and those that any measured condition has not from the scenario. What
    is proposed after further trials has the same ones.
    """
    changed = {
        key
        for table in measurement.velocity
        for each in table.conditions
        for key, value in each.items()
        if value != measurement.scenario.get(key)
    }
    keys = [*CHOICES, *sorted(changed.difference(CHOICES))]
    return [key.removeprefix("drive.") for key in keys]


def trial_table(
    experiments: Sequence[Experiment], measurement: Measurement, trials: int = TRIALS
) -> DataFrame:
    """A row for each of the trials of each experiment, without a velocity.

    Where tables of the measurement say which trials belong to one set-up, these have a `block` too:
    one for all, which no earlier round has. Where they have an `order`, there is an empty one.
    """
    import pandas as pd

    names = setting_columns(measurement)
    tables = measurement.velocity
    known: dict[str, Any] = {}
    if any(np.any(each.block >= 0) for each in tables):
        # All rounds may stand in one table; the number of conditions grows with each.
        known["block"] = f"after-{sum(len(each.conditions) for each in tables)}"
    if any(np.any(np.isfinite(each.order)) for each in tables):
        known["order"] = math.nan
    columns = [*names, "trial", *known, "velocity"]
    rows = [
        {**{name: each.drive[name] for name in names}, "trial": trial, **known}
        for each in experiments
        for trial in range(1, trials + 1)
    ]
    return pd.DataFrame(rows, columns=columns).assign(velocity=math.nan)


def prediction_table(experiments: Sequence[Experiment], names: Sequence[str]) -> DataFrame:
    """What each candidate predicts of each experiment, counted from 1: `velocity`, `sd`, m/s.

    The errors are those of the fits, without the noise of a trial. `names` are the settings that
    are columns.
    """
    import pandas as pd

    rows = [
        {
            "experiment": number,
            **{name: each.drive[name] for name in names},
            "candidate": candidate,
            **predicted,
        }
        for number, each in enumerate(experiments, start=1)
        for candidate, predicted in each.predictions.items()
    ]
    return pd.DataFrame(rows)
