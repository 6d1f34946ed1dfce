"""The figure of a film: its motion over the phase of the drive, beside the models'."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.picture import Picture
from stickslip.diagnosis.observables.tracking.smoothed_motion import SmoothedMotion
from stickslip.diagnosis.report.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Trace:
    """One quantity of the smoothed motion as it is drawn, in the label's unit, shape (g,) each."""

    label: str
    measured: Array
    recalibrated: Array
    extended: Array | None


def traces(recalibrated: SmoothedMotion, extended: SmoothedMotion | None) -> tuple[Trace, Trace]:
    """Tilt and place over the phase of the drive, beside both models."""
    degree, um = np.degrees(1.0), 1e6
    of, after = recalibrated, extended
    ends: tuple[Array | None, Array | None] = (None, None)
    if after is not None:
        # Each model has a camera of its own; the readings are drawn as the recalibrated one has
        # them.
        ends = (
            (of.theta + after.theta_model - after.theta) * degree,
            (of.place + after.place_model - after.place) * um,
        )
    tilt = Trace("tilt (degrees)", of.theta * degree, of.theta_model * degree, ends[0])
    place = Trace("x less its drift (um)", of.place * um, of.place_model * um, ends[1])
    return tilt, place


def film_figure(recalibrated: SmoothedMotion, extended: SmoothedMotion | None) -> Figure:
    """Tilt and place over the phase of the drive."""
    figure = Picture(figsize=(10.0, 2.9), layout="constrained")
    frames = figure.subplots(1, 2)
    for each, trace in zip(frames, traces(recalibrated, extended), strict=True):
        lines = {
            "measured, smoothed": (trace.measured, "k", 1.6, "-"),
            "recalibrated": (trace.recalibrated, COLOURS["recalibrated"], 1.4, "--"),
            "extended": (trace.extended, COLOURS["extended"], 1.4, ":"),
        }
        for label, (values, colour, width, style) in lines.items():
            if values is not None:
                each.plot(recalibrated.phase, values, color=colour, lw=width, ls=style, label=label)
        each.set_xlabel("phase of the drive")
        each.set_ylabel(trace.label)
    frames[0].legend(fontsize=8, frameon=False)
    return figure
