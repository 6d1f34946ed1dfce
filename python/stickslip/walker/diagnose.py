"""A diagnosis of a measurement with the simulator and its library of causes."""

from __future__ import annotations

from typing import cast

from stickslip._util.arrays import worker_count
from stickslip._util.messages import check_whole, shown
from stickslip.diagnosis.entry import diagnosed, fault_of, one_blas_thread
from stickslip.diagnosis.fitting.search import Progress
from stickslip.diagnosis.result import Diagnosis
from stickslip.errors import ScenarioError
from stickslip.walker.problem import posed_against, posed_by
from stickslip.walker.reading import Measurement
from stickslip.walker.simulated import SimulatedTable


def diagnose(
    measurement: Measurement,
    *,
    against: Measurement | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Diagnose a measurement with the simulator and its library of causes.

    Parameters
    ----------
    measurement : Measurement
        From `read_measurement` or `Measurement.from_dataframe`.
    against : Measurement, optional
        An earlier measurement with the same uncertain constants: what changed since is diagnosed,
        as by `diagnose_change`.
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
    for name, given in {"measurement": measurement, "against": against}.items():
        if not isinstance(given, Measurement) and (given is not None or name == "measurement"):
            raise ScenarioError(
                f"{name} = {shown(given)}: allowed is a Measurement; "
                "Measurement.from_dataframe(...) or read_measurement(path) makes one"
            )
    check_whole("seed", seed)
    count, fault = worker_count(threads, "threads"), None
    if against is None:
        problem = posed_by(measurement, count, seed)
        whole = [problem]
    else:
        problem, whole = posed_against(measurement, against, count, seed)
        measurement = measurement.beside(against)
        fault = fault_of(whole[0], True) or fault_of(whole[1], True)
    tables = [cast(SimulatedTable, table) for each in whole for table in each.tables]
    notes = {str(note): note for table in tables for note in table.remarks()}
    with one_blas_thread():
        return diagnosed(problem, int(seed), progress, [*notes.values()], measurement, fault)
