"""Robot and coils at an instant."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from stickslip import _core
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import shown
from stickslip.scenario.sections import Section

STATE_COLUMNS = tuple(_core.state_columns)
"""The fields of a `State` in the order of the last axis of an array of states.

`contact` stands there as the index of its word in `CONTACT_WORDS`.
"""

CONTACT_WORDS = tuple(_core.contact_words)
"""What `State.contact` may be."""

_MAGIC, _VERSION = b"stickslip state ", 2
_LAYOUT = struct.Struct(f"<16sI{len(STATE_COLUMNS)}d")


@dataclass(frozen=True, kw_only=True)
class State(Section, key="initial"):
    """Robot and coils at an instant, in the world's frame. By default at rest, without current.

    A scenario begins at one (``Scenario(initial=...)``, in a file the section ``[initial]``), and
    every run and step ends at one.

    Parameters
    ----------
    x, z : float
        Centre of mass, m. Where z is 0, the lowest corner lies on the surface.
    theta : float
        Tilt, nose-down positive in the robot's own frame, rad; whole turns count.
    vx, vz, omega : float
        Their rates, m/s and rad/s.
    current_xp, current_xm, current_yp, current_ym, current_clamp : float
        Currents of the coils, A.
    field_lag_xp, field_lag_xm, field_lag_yp, field_lag_ym, field_lag_clamp : float
        What the current that the field corresponds to has beyond the coil's, A; it counts with
        `effects.eddy_lag` only.
    contact : str
        Mode of the contact, one of ``Run.contact_names``; or ``"from_motion"``: what lies on the
        surface touches, unless it moves away from it, and slips if it moves along it. The mode is
        part of the state: under adhesion a corner on the surface may be in contact or just about to
        fly.
    contact_age : float
        Time since the last touch-down, s, of which `effects.adhesion_ageing` depends.
    y, vy : float
        Centre of mass across the x axis, m, and its velocity, m/s; zero where the robot stays in
        the plane y = 0.
    heading : float
        Where the robot faces, rad from +x to the left. At the start it counts until the field is
        strong enough to turn the robot, which then faces the field at once, wherever that points.

    Raises
    ------
    ScenarioError
        If a value is out of its range. Whether the state can be, for a robot of its size, is
        checked by the scenario that begins with it: not below the surface, and no corner that
        sticks and moves.

    Examples
    --------
    >>> from stickslip import Scenario, State, simulate
    >>> run = simulate(Scenario(initial=State(theta=0.2)), until="theta <= 0")
    >>> run.final_state.theta
    0.0
    """

    x: float = 0.0
    z: float = 0.0
    theta: float = 0.0
    vx: float = 0.0
    vz: float = 0.0
    omega: float = 0.0
    current_xp: float = 0.0
    current_xm: float = 0.0
    current_yp: float = 0.0
    current_ym: float = 0.0
    current_clamp: float = 0.0
    field_lag_xp: float = 0.0
    field_lag_xm: float = 0.0
    field_lag_yp: float = 0.0
    field_lag_ym: float = 0.0
    field_lag_clamp: float = 0.0
    contact: Literal[
        "from_motion",
        "flight",
        "corner_stick",
        "corner_slip_forward",
        "corner_slip_backward",
        "face_stick",
        "face_slip_forward",
        "face_slip_backward",
    ] = "from_motion"
    contact_age: float = 0.0
    y: float = 0.0
    vy: float = 0.0
    heading: float = 0.0

    @property
    def row(self) -> list[float]:
        """The values in the order of `STATE_COLUMNS`, as an array of states holds them."""
        values = vars(self)
        return [
            float(CONTACT_WORDS.index(self.contact)) if name == "contact" else values[name]
            for name in STATE_COLUMNS
        ]

    @staticmethod
    def from_row(row: Any) -> State:
        """The state of a row of an array of states; a ScenarioError if it is none."""
        try:
            values = dict(zip(STATE_COLUMNS, map(float, row), strict=True))
        except (TypeError, ValueError):
            allowed = f"{len(STATE_COLUMNS)} numbers in the order of STATE_COLUMNS"
            raise ScenarioError(f"row = {shown(row)}: allowed are {allowed}") from None
        index = values["contact"]
        if index not in range(len(CONTACT_WORDS)):
            raise ScenarioError(
                f"initial.contact = {index}: allowed is a whole number from 0 to "
                f"{len(CONTACT_WORDS) - 1}"
            )
        return State(**{**values, "contact": CONTACT_WORDS[int(index)]})  # type: ignore[arg-type]

    def to_bytes(self) -> bytes:
        """The state as bytes of a stated version, the same on every machine."""
        return _LAYOUT.pack(_MAGIC, _VERSION, *self.row)

    @staticmethod
    def from_bytes(data: bytes) -> State:
        """The state that `to_bytes` wrote; a ScenarioError for anything else."""
        if len(data) != _LAYOUT.size or data[: len(_MAGIC)] != _MAGIC:
            raise ScenarioError(f"{shown(data[:16])}: allowed are the bytes of a state")
        _, version, *row = _LAYOUT.unpack(data)
        if version != _VERSION:
            raise ScenarioError(f"state of version {version}: allowed is version {_VERSION}")
        return State.from_row(row)


def made_state(fields: Mapping[str, Any]) -> State:
    """The state of fields that the core gave, which need no check."""
    state = object.__new__(State)
    vars(state).update(fields)
    return state
