"""A diagnosis of a measurement with the simulator and its library of causes."""

from __future__ import annotations

from stickslip._util.arrays import worker_count
from stickslip._util.messages import check_whole, shown
from stickslip.diagnosis.entry import fault_of, one_blas_thread, silent
from stickslip.diagnosis.fitting.search import Progress
from stickslip.diagnosis.pipeline import moved_constants, run
from stickslip.diagnosis.result import Diagnosis
from stickslip.errors import ScenarioError
from stickslip.walker.problem import posed_by
from stickslip.walker.reading import Measurement


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
    seed : int
        From 0, of the random draws. The result does not depend on `threads`.
    threads : int, optional
        Simulations at a time; as many as there are processors, if not given.
    progress : callable, optional
        ``progress(fraction, stage)`` is told the fraction that is done and what comes next.

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
    notes = [note for table in problem.tables for note in table.remarks()]
    with one_blas_thread():
        findings = run(problem, int(seed), progress or silent, fault_of(problem))
    return Diagnosis(findings, measurement, (*notes, *moved_constants(findings)))
