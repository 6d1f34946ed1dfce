"""A diagnosis of a measurement with the simulator and its library of causes."""

from __future__ import annotations

from typing import cast

from stickslip._util.arrays import worker_count
from stickslip._util.messages import check_whole, shown
from stickslip.diagnosis.entry import diagnosed, one_blas_thread
from stickslip.diagnosis.fitting.search import Progress
from stickslip.diagnosis.result import Diagnosis
from stickslip.errors import ScenarioError
from stickslip.walker.problem import posed_by
from stickslip.walker.reading import Measurement
from stickslip.walker.simulated import SimulatedTable


def diagnose(
    measurement: Measurement,
    *,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Diagnose a measurement with the simulator and its library of causes.

    Parameters
    ----------
    measurement : Measurement
        From `read_measurement` or `Measurement.from_dataframe`.
    seed, progress
        As for `diagnose_model`.
    threads : int, optional
        Simulations at a time, which change no result; as many as there are processors, if not
        given.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ScenarioError
        If `measurement` is none, nothing was measured that the diagnosis can use, or `seed` is not
        allowed.
    ValueError
        If `threads` is not a whole number above zero.
    """
    if not isinstance(measurement, Measurement):
        raise ScenarioError(
            f"measurement = {shown(measurement)}: allowed is a Measurement; "
            "Measurement.from_dataframe(...) or read_measurement(path) makes one"
        )
    check_whole("seed", seed)
    problem = posed_by(measurement, worker_count(threads, "threads"), seed)
    tables = cast(tuple[SimulatedTable, ...], problem.tables)
    notes = [note for table in tables for note in table.remarks()]
    with one_blas_thread():
        return diagnosed(problem, int(seed), progress, notes, measurement)
