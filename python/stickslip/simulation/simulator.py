"""Stepped runs and their snapshots."""

from __future__ import annotations

from typing import Any, Literal

from stickslip import _core
from stickslip._util.messages import check_kind, known_arguments
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import State

Hold = Literal["constant", "linear"]


@known_arguments
class Simulator(_core.Simulator):
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

    scenario: Scenario

    def __init__(
        self, scenario: Scenario, state: State | None = None, *, whole_plane: bool = False
    ) -> None:
        check_kind("scenario", scenario, Scenario)
        if state is not None:
            scenario = scenario.with_state(state)
        self.scenario = scenario
        super().__init__(scenario.to_core(), bool(whole_plane))

    def __getstate__(self) -> tuple[Any, ...]:
        return self.__dict__, self.whole_plane, self.snapshot()

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        attributes, whole_plane, snapshot = state
        self.__dict__.update(attributes)
        super().__init__(self.scenario.to_core(), whole_plane)
        self.restore(snapshot)

    def __repr__(self) -> str:
        return f"<Simulator: {self.status}, t = {self.time:.6g} s>"
