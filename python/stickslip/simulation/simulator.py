"""Stepped runs and their snapshots."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.messages import check_kind, refuse, shown
from stickslip.errors import ScenarioError, SimulationError, prefixed
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import State

Hold = Literal["constant", "linear"]

_TYPES = (
    "a step takes a mapping from coils to V, or five numbers of V (xp, xm, yp, ym, clamp), and a "
    "duration in s"
)


def check_hold(hold: str) -> bool:
    """Whether voltages go linearly to those of a step; a ScenarioError for another word."""
    if hold == "constant":
        return False
    if hold != "linear":
        refuse("hold", hold, '"constant" or "linear"')
    return True


def _by_coil(name: str, voltages: Any) -> Mapping[str, float]:
    if type(voltages) is dict or isinstance(voltages, Mapping):  # of which the first is quicker
        return voltages
    row = np.asarray(voltages)
    if row.dtype.kind not in "iuf" or row.shape != (len(COIL_NAMES),):
        raise ValueError(f"{name} = {shown(voltages)}: {_TYPES}")
    return dict(zip(COIL_NAMES, row.tolist(), strict=True))


class Snapshot:
    """State, time and voltages of a `Simulator`: restored, it goes on with the same bits."""

    def __init__(self, core: _core.Snapshot) -> None:
        self._core = core

    def to_bytes(self) -> bytes:
        """The snapshot as bytes with a checksum.

        Only the same version, on a machine of the same byte order, can read them.
        """
        return self._core.to_bytes()

    def __reduce__(self) -> tuple[Any, ...]:
        return Snapshot.from_bytes, (self.to_bytes(),)

    @staticmethod
    def from_bytes(data: bytes | bytearray | memoryview) -> Snapshot:
        """The snapshot that `to_bytes` wrote; a ScenarioError for anything else."""
        if not isinstance(data, bytes | bytearray | memoryview):
            refuse("data", data, "the bytes of a snapshot")
        with prefixed("", ValueError):
            return Snapshot(_core.Snapshot.from_bytes(bytes(data)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Snapshot) and self.to_bytes() == other.to_bytes()

    def __hash__(self) -> int:
        return hash(self.to_bytes())


class Simulator:
    """A stepped run, for controllers and for training them.

    Copies (`copy`, `pickle`) are independent simulators that go on with the same bits.

    The voltages are those of the steps. The scenario's own drive is not played; it sets the field
    to which the tolerance is relative, and how warm the coils get with `effects.coil_heating`.
    Without `effects.sample_hold` and `effects.amplifier_limit`, a drive whose breakpoints are the
    ends of the steps gives the same bits when it is simulated at once.

    Parameters
    ----------
    scenario : Scenario
    state : State, optional
        Where to begin; `scenario.initial`, if not given.
    whole_plane : bool, optional
        Whether the robot may turn and move in the whole plane of the surface. Voltages of the y
        coils need it. A step takes about three times as long. A scenario that leaves the plane by
        itself (`drive.heading`, a field across) has it in any case.

    Raises
    ------
    ScenarioError
        If the state cannot be: below the surface, or a corner that sticks and moves.

    Examples
    --------
    >>> from stickslip import Scenario, Simulator
    >>> sim = Simulator(Scenario())
    >>> state = sim.step({"clamp": -10.0}, 0.05)
    >>> while sim.time < 0.1:
    ...     state = sim.step({"xp": 20.0}, 1e-3)
    >>> state.contact
    'corner_stick'
    """

    def __init__(
        self, scenario: Scenario, state: State | None = None, *, whole_plane: bool = False
    ) -> None:
        check_kind("scenario", scenario, Scenario)
        if state is not None:
            scenario = scenario.with_state(state)
        self.scenario = scenario
        self._whole_plane = bool(whole_plane)
        with prefixed("", ValueError):
            self._core = self._begun()

    def _begun(self) -> _core.Simulator:
        return _core.Simulator(self.scenario.to_core(), self._whole_plane)

    def step(
        self,
        voltages: Mapping[str, float] | ArrayLike,
        duration: float,
        hold: Hold = "constant",
        start: Mapping[str, float] | ArrayLike | None = None,
    ) -> State:
        """Play one step.

        Parameters
        ----------
        voltages : mapping of str to float, or array_like of shape (5,)
            New voltages of coils (``xp``, ``xm``, ``yp``, ``ym``, ``clamp``), V; those that are not
            named keep theirs, which are zero at first. An array has all five, in this order.
        duration : float
            s.
        hold : {"constant", "linear"}
            Whether the voltages jump to their new values and stay there, or go there linearly over
            the step.
        start : mapping of str to float, or array_like of shape (5,), optional
            With ``hold="linear"`` the voltages to which coils jump at the beginning of the step, V.
            A coil that it does not name begins where it was, and one that `voltages` does not name
            stays where it begins.

        Returns
        -------
        State
            At the end of the step.

        Raises
        ------
        ScenarioError
            If a coil, a voltage or the duration is none, if `start` is given to a constant step, or
            if the voltages turn a robot without ``whole_plane``.
        SimulationError
            If the motion cannot be simulated on; `state` is then where it stopped.
        """
        try:
            linear = check_hold(hold)
            if start is not None and not linear:
                raise ValueError('start: allowed with hold = "linear" only')
            before = None if start is None else _by_coil("start", start)
            fields = self._core.step(_by_coil("voltages", voltages), duration, linear, before)
        except RuntimeError as error:
            if self.status == "ok":  # of an effect of the user, say
                raise
            raise SimulationError(f"the simulation has ended: {error}") from None
        except (TypeError, ValueError) as error:
            reason = str(error) if isinstance(error, ValueError) else _TYPES
            raise ScenarioError(reason) from None
        if self._core.message:
            raise SimulationError(self._core.message)
        return State.view(fields)

    @property
    def time(self) -> float:
        """Simulated time since the start, s; after a step that failed, when it did."""
        return self._core.time

    @property
    def state(self) -> State:
        """Where the last step ended."""
        return State.view(self._core.state())

    @property
    def voltages(self) -> dict[str, float]:
        """The voltage of each coil at the end of the last step, V."""
        return dict(zip(COIL_NAMES, self._core.voltages, strict=True))

    @property
    def status(self) -> str:
        """``"ok"``, or how the last step failed; one that failed is the last."""
        return self._core.status

    def snapshot(self) -> Snapshot:
        """A snapshot, from which `restore` goes on with the same bits."""
        return Snapshot(self._core.snapshot())

    def restore(self, snapshot: Snapshot) -> None:
        """Go back, or over, to a snapshot of a simulator of the same scenario.

        The record may differ, and the initial state but for its currents.

        Raises
        ------
        ScenarioError
            If `snapshot` is none, of another scenario, or of a run with another ``whole_plane``.
        """
        check_kind("snapshot", snapshot, Snapshot)
        with prefixed("", ValueError):
            self._core.restore(snapshot._core)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_core": self.snapshot()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._core = self._begun()
        self.restore(state["_core"])

    def __repr__(self) -> str:
        return f"<Simulator: {self.status}, t = {self.time:.6g} s>"
