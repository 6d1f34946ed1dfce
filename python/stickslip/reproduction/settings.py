"""What the paper leaves open of its two drives: the grid that the study tries, and a search space.

Neither the sudden side of the sawtooth (edge) nor its bottom (base), the field of the holding coil
(hold) or the sign of the clamp coil's field (clamp) is stated; see sections V-A and V-B and
Figs. 4 and 6.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from stickslip.design.design_space import Axis
from stickslip.scenario.scenario import Scenario

Mode = Literal["IPP", "OPP"]

MODES: tuple[Mode, ...] = ("IPP", "OPP")

PEAK = 2.5e-3
"""Top of the sawtooth in all figures but 14 and 15, T."""

FACTORS = ("edge", "clamp", "base", "hold")
"""What tells one setting of a mode from another."""

FREE = {
    "edge_time": "drive.edge_time",
    "ramp": "drive.ramp",
    "linear": "drag.linear",
    "rotational": "drag.rotational",
}
"""What the grid fixes and a search does not, in both modes alike, with the keys of a scenario."""

WORDS = ("IPP edge", "IPP clamp", "OPP edge", "OPP clamp")
"""The words of a pair of settings."""

# The numbers of a pair: two of each mode, then those of the apparatus, the robot and the fluid,
# which both modes share. Chosen: fields beyond the grid on both sides; edges that still leave a
# sawtooth at 150 Hz; damping a decade and more about that of section VI-C.
AXES = (
    Axis("IPP base", "T", -1e-3, 1.5e-3),
    Axis("IPP hold", "T", 0.2e-3, 4e-3),
    Axis("OPP base", "T", -1e-3, 1.5e-3),
    Axis("OPP hold", "T", 0.2e-3, 4e-3),
    Axis("edge_time", "s", 0.0, 5e-3),
    Axis("ramp", "s", 0.02, 0.3),
    Axis("linear", "N s/m", 1e-6, 1e-4),
    Axis("rotational", "N m s^2", 1e-17, 1e-14),
)
"""What is searched, with its ranges; linear and rotational are the drag coefficients."""


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
    free : mapping of float
        What a search sets beside, SI: all names of ``FREE``; none of them in the grid.
    """

    mode: Mode
    edge: str
    clamp: str
    base: float
    hold: float
    free: Mapping[str, float] = field(default_factory=dict)

    def keys(self) -> dict[str, Any]:
        """The setting by the keys of a scenario."""
        own = {f"drive.{name}": getattr(self, name) for name in ("mode", *FACTORS)}
        return own | {FREE[name]: value for name, value in self.free.items()}

    def text(self) -> str:
        """The setting in words."""
        digits = ".3g" if self.free else "g"  # those of the grid are few
        words = (
            f"sudden {self.edge}, clamp {self.clamp}, base {self.base * 1e3:{digits}} mT, "
            f"hold {self.hold * 1e3:{digits}} mT"
        )
        if not self.free:
            return words
        edge_time, ramp, linear, rotational = (self.free[name] for name in FREE)
        return (
            f"{words}, edge {edge_time * 1e3:.3g} ms, ramp {ramp:.3g} s, "
            f"drag {linear:.3g} N s/m and {rotational:.3g} N m s²"
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

    def settings(self) -> dict[Mode, list[Setting]]:
        """All settings by mode."""
        product = [*itertools.product(self.edges, self.clamps, self.bases, self.holds)]
        return {mode: [Setting(mode, *each) for each in product] for mode in MODES}


def values_of(pair: Sequence[Setting]) -> dict[str, Any]:
    """Words and numbers by name of a pair of the grid, which has a default scenario's others."""
    free = {name: Scenario().get(key) for name, key in FREE.items()}
    return free | {f"{each.mode} {name}": getattr(each, name) for each in pair for name in FACTORS}


def pair_of(values: Mapping[str, Any]) -> dict[Mode, Setting]:
    """The pair of settings that has these words and numbers."""
    free = {name: values[name] for name in FREE}
    own = {mode: {name: values[f"{mode} {name}"] for name in FACTORS} for mode in MODES}
    return {mode: Setting(mode, **own[mode], free=free) for mode in MODES}
