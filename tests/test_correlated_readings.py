"""Which readings share their errors: the sweeps of a table's curves, and the frames of a film."""

import math

import numpy as np
import pytest

from stickslip.diagnosis.data.trials import pooled_velocities
from stickslip.diagnosis.fit.goodness import lack_of_fit_p
from stickslip.diagnosis.observables.tracking.folding import (
    FrameErrors,
    correlation_of_frames,
    fold,
    reduce,
)
from stickslip.measurement import Measurement
from stickslip.scenario.scenario import Scenario


def frame(sweeps=2, **columns):
    """A table of two modes and three frequencies, the rows of a condition one after another."""
    rows = [
        {"velocity": 1e-4 * pace, "mode": mode, "frequency": pace, "trial": trial}
        for mode in ("IPP", "OPP")
        for pace in (60.0, 20.0, 40.0)
        for trial in range(sweeps)
    ]
    pandas = pytest.importorskip("pandas")
    return pandas.DataFrame(rows).assign(**columns)


def runs_of(table):
    """Frequencies of the conditions of each run, in its order."""
    data = Measurement.from_dataframe(table, Scenario())
    conditions, trials = pooled_velocities(data.velocity)
    paces = np.array([each["drive.frequency"] for each in conditions])[trials.condition]
    return [paces[trials.run == each].tolist() for each in np.unique(trials.run)]


def test_runs_of_a_table_are_the_sweeps_of_its_curves():
    paces = [20.0, 40.0, 60.0]
    assert runs_of(frame()) == [paces] * 4
    assert runs_of(frame().drop(columns="trial")) == [paces] * 4
    # A label that no two conditions share numbers the rows.
    assert runs_of(frame(trial=np.arange(12))) == [paces] * 4
    # The order of all trials holds the sweeps.
    twice = [pace for pace in paces for _ in range(2)]
    assert runs_of(frame(order=np.arange(12))) == [twice] * 2


@pytest.mark.parametrize("kind", ["level", "drift"])
def test_frames_that_share_their_errors_do_not_raise_false_alarms(kind):
    # Errors alone, of 500 frames a second at 30 Hz; chi-square of the observables at 5 %, in 120
    # films, which tell a rate of 5 % to 2 %; three times that is allowed.
    random = np.random.default_rng(10)
    scenario = Scenario().replace({"drive.frequency": 30.0, "drive.pulses": 12})
    folded = fold(np.arange(0.0, scenario.window[1], 2e-3), scenario)
    count = len(folded.bin)
    place = np.arange(count)
    lower = np.linalg.cholesky(0.6 ** np.abs(np.subtract.outer(place, place)))
    found, alarms = [], np.zeros((120, 2))
    for number in range(120):
        draws = lower @ random.standard_normal(count)
        known = correlation_of_frames(folded, draws, kind, place)
        found.append(known.value)
        alone = FrameErrors(place)
        used = FrameErrors(place, known.value, known.points) if known.used else alone
        for which, frames in enumerate((alone, used)):
            matrix, covariance = reduce(folded, kind, 1.0, 0.0, frames)
            seen = matrix @ draws
            chance = lack_of_fit_p(seen @ np.linalg.solve(covariance, seen), len(seen), math.inf)
            alarms[number, which] = chance < 0.05
    without, with_estimate = alarms.mean(axis=0)
    assert np.mean(found) == pytest.approx(0.6, abs=0.03)
    assert with_estimate <= 0.11
    assert without > 3.0 * with_estimate


def test_lost_frames_are_gaps():
    # As whitening with the whole covariance of the frames that are left.
    place = np.array([0, 1, 2, 5, 6, 9])
    errors_of = FrameErrors(place, 0.7, np.array([0.7]))
    covariance = 0.7 ** np.abs(place[:, None] - place)
    white = errors_of.of(np.eye(6))
    assert white @ covariance @ white.T == pytest.approx(np.eye(6), abs=1e-12)
    rows = np.random.default_rng(11).standard_normal((2, 6))
    assert errors_of.covariance(rows) == pytest.approx(rows @ covariance @ rows.T, rel=1e-12)
    assert errors_of.transposed(rows) == pytest.approx(rows @ white, abs=1e-12)
