"""What the paper leaves open of its two drives, and the grid of settings that the study tries.

Neither the sudden side of the sawtooth (edge) nor its bottom (base), the field of the holding coil
(hold) or the sign of the clamp coil's field (clamp) is stated; see sections V-A and V-B and
Figs. 4 and 6.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, Literal

Mode = Literal["IPP", "OPP"]

MODES: tuple[Mode, ...] = ("IPP", "OPP")

PEAK = 2.5e-3
"""Top of the sawtooth in all figures but 14 and 15, T."""

FACTORS = ("edge", "clamp", "base", "hold")
"""What tells one setting of a mode from another."""

_WORDS = {"rise": "sudden rise", "fall": "sudden fall"}


@dataclass(frozen=True)
class Setting:
    """One way to fill in what the paper leaves open.

    Attributes
    ----------
    mode : {"IPP", "OPP"}
    edge : {"rise", "fall"}
    clamp : {"down", "up"}
    base, hold : float
        T.
    """

    mode: Mode
    edge: str
    clamp: str
    base: float
    hold: float

    def keys(self) -> dict[str, Any]:
        """The setting by the keys of a scenario."""
        return {f"drive.{name}": getattr(self, name) for name in ("mode", *FACTORS)}

    def text(self) -> str:
        """The setting in words."""
        return (
            f"{_WORDS[self.edge]}, clamp {self.clamp}, base {self.base * 1e3:g} mT, "
            f"hold {self.hold * 1e3:g} mT"
        )

    @property
    def tilt_sign(self) -> float:
        """Sign of theta that the clamp coil gives: 1.0 with clamp "down", -1.0 with "up"."""
        return 1.0 if self.clamp == "down" else -1.0


@dataclass(frozen=True)
class Grid:
    """Values of the open quantities; the grid is their full product for each mode.

    The paper states none. Bases go from nothing to two fifths of the peak, holding fields from a
    fifth of it to a little more than it.

    Parameters
    ----------
    edges, clamps : tuple of str
    bases, holds : tuple of float
        T.
    """

    edges: tuple[str, ...] = ("rise", "fall")
    clamps: tuple[str, ...] = ("down", "up")
    bases: tuple[float, ...] = (0.0, 0.25e-3, 0.5e-3, 1.0e-3)
    holds: tuple[float, ...] = (0.5e-3, 1.0e-3, 1.5e-3, 2.0e-3, 2.5e-3, 3.0e-3)

    def settings(self, mode: Mode) -> list[Setting]:
        """All settings of a mode."""
        product = itertools.product(self.edges, self.clamps, self.bases, self.holds)
        return [Setting(mode, *each) for each in product]
