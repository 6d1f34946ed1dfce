"""Many runs through given voltages, and their states after each step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip import _core
from stickslip._util.arrays import Array, in_columns, worker_count
from stickslip._util.messages import check_kind, shown, suggestion
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import STATE_COLUMNS, State
from stickslip.simulation.simulate import Progress, fraction_of
from stickslip.simulation.simulator import Hold

STATE_UNITS = {name: unit for name, (unit, _) in _core.state_columns.items()}
"""SI unit of each column of an array of states."""


class Rollout(NamedTuple):
    """The result of `rollout`.

    Attributes
    ----------
    states : numpy.ndarray, shape (n, steps, k)
        The recorded columns at the end of each step; NaN from the step on that a run failed in. A
        run whose state at the start, or whose own voltages in a step, are masked or not finite
        fails there with the status ``not_finite``; the others go on.
    status : numpy.ndarray of int8, shape (n,)
        How each run ended, an index of `status_names`; 0 is "ok".
    columns : tuple of str
        The recorded columns, in their order.
    """

    states: NDArray[np.float64]
    status: NDArray[np.int8]
    columns: tuple[str, ...]

    @property
    def status_names(self) -> tuple[str, ...]:
        """The statuses that `status` counts."""
        return tuple(_core.statuses)


def rollout(
    scenarios: Scenario | Sequence[Scenario],
    states: State | Sequence[State] | ArrayLike | None,
    voltages: ArrayLike,
    duration: float,
    *,
    hold: Hold = "constant",
    record: Sequence[str] = ("x", "theta"),
    out: NDArray[np.float64] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Rollout:
    """Play many runs through given voltages, in the core and on several threads.

    Each run has the bits of a `Simulator` that is stepped, for any number of threads.

    Parameters
    ----------
    scenarios : Scenario or sequence of Scenario
        One for all runs, or one a run. Their drives are not played, see `Simulator`.
    states : State, sequence of State, array of shape (n, 28), or None
        Where each run begins, one for all or one a run; an array has the columns `STATE_COLUMNS`,
        a table these names.
        Without it each run begins at its scenario's `initial`.
    voltages : array_like, shape (steps, 5) or (n, steps, 5)
        Voltages of the coils xp, xm, yp, ym, clamp in each step, V, for all runs or for each.
    duration : float
        Duration of one step, s.
    hold : {"constant", "linear"}
        Whether voltages are held over a step, or go to their values linearly from those before.
    record : sequence of str
        Columns of `STATE_COLUMNS` to record; units are in `STATE_UNITS`.
    out : numpy.ndarray, shape (n, steps, k), optional
        Array of float64, C-contiguous, that takes the states.
    threads : int, optional
        How many runs go on at a time; as many as there are processors, if not given.
    progress : callable, optional
        Called with the fraction that is done and the stage, as for `simulate`.

    Returns
    -------
    Rollout

    Raises
    ------
    ScenarioError
        If numbers of runs differ, an array has another shape, a state cannot be, or voltages for
        all runs are not finite.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second.

    Examples
    --------
    >>> import numpy as np
    >>> volts = np.zeros((4, 20, 5))
    >>> volts[:, :, 4] = -10.0
    >>> volts[:, :, 0] = np.linspace(5.0, 20.0, 4)[:, None]
    >>> rollout(Scenario(), None, volts, 1e-3).states.shape
    (4, 20, 2)
    """
    for name in record:
        if name not in STATE_COLUMNS:
            raise ScenarioError(f"record: {shown(name)}: {suggestion(str(name), STATE_COLUMNS)}")
    several = [scenarios] if isinstance(scenarios, Scenario) else list(scenarios)
    for index, scenario in enumerate(several):
        check_kind(f"scenario {index}", scenario, Scenario)
    volts = _numbers("voltages", voltages, _core.coil_names, unit="V")
    if volts.ndim not in (2, 3):
        raise ScenarioError(
            f"voltages of shape {volts.shape}: allowed is (steps, 5) or (n, steps, 5)"
        )
    start = _rows(states)
    given = {} if isinstance(scenarios, Scenario) else {"scenarios": len(several)}
    if start is not None and len(start) != 1:
        given["states"] = len(start)
    if volts.ndim == 3:
        given["voltages"] = len(volts)
    if len({*given.values()}) > 1:
        text = " and ".join(f"{number} {name}" for name, number in given.items())
        raise ScenarioError(f"{text}: allowed is the same number of runs")
    runs = next(iter(given.values()), 1)
    if start is not None and len(start) == 1:
        start = np.repeat(start, runs, axis=0)
    shape = (runs, volts.shape[-2], len(record))
    if out is None:
        out = np.empty(shape)
    elif out.shape != shape or out.dtype != float or not out.flags.c_contiguous:
        raise ScenarioError(f"out of shape {out.shape}: allowed is a float64 array {shape}")
    out.fill(np.nan)
    status = _core.rollout(
        [scenario.to_core() for scenario in several],
        runs,
        start,
        volts,
        duration,
        hold,
        [STATE_COLUMNS.index(name) for name in record],
        out,
        worker_count(threads, "threads"),
        fraction_of(runs * shape[1] * float(duration), progress),
    )
    return Rollout(out, status, tuple(record))


def _numbers(what: str, values: Any, columns: Sequence[str], **more: Any) -> Array:
    """Numbers, NaN where there is none: a run fails there."""
    array = in_columns(what, values, columns, gaps=True, finite=False, **more)
    return np.ascontiguousarray(array)


def _rows(states: Any) -> Array | None:
    if states is None:
        return None
    states = [states] if isinstance(states, State) else states
    if isinstance(states, Sequence) and states and isinstance(states[0], State):
        states = [state.row for state in states]
    return _numbers("states", states, STATE_COLUMNS, axes=2)
