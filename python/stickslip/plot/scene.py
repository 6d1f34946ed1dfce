"""The scene of a moving picture: the body on the surface, and the field beside it as an arrow."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from stickslip.plot.film import mark_handles
from stickslip.plot.motion import Motion
from stickslip.plot.scene_parts import (
    FieldPanel,
    Part,
    SideView,
    ViewFromAbove,
    start_handle,
)

_WIDTH = 6.4  # inches
_FIELD_WIDTH = 1.3  # inches, of the panel of the field
_BESIDE, _BELOW = 0.8, 1.1  # inches, of the labels beside the surface, and above and below it
_ABOVE_WIDTH = 4.2  # inches, of the view from above, where there is one
_FIELD_HEIGHT = 1.2  # inches, of the panels of the field below a side view
_BELOW_FIELD = 0.9  # inches, of their titles, and of what stands below them


class Scene:
    """One figure, whose artists are moved from sample to sample.

    A robot that leaves its plane has a view from above beside its side view, and the field in both.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
    """

    def __init__(self, shown: Motion) -> None:
        side = SideView(shown)
        draw = _two_views if shown.turns else _one_view
        self.figure, self._parts = draw(shown, side)
        handles = mark_handles(before="contact at the start")
        if shown.turns:
            handles[-1].set_label("moment; from above, heading")
            handles.insert(-1, start_handle())
        self.figure.legend(
            handles=handles, loc="outside lower center", ncols=len(handles), frameon=False
        )
        self.show(0)
        # Where it all stands is the same throughout, and found in two steps: axes of equal scales
        # get their shape in the first one.
        for _ in range(2):
            self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")

    def show(self, sample: int) -> None:
        """Move all to where it is at one sample."""
        for part in self._parts:
            part.show(sample)


def _figure(width: float, height: float, beside: float = 0.04) -> Figure:
    """A figure of a size, inches, with so much room on each side of every panel."""
    # A title of axes of equal scales is else cut at its upper end.
    layout = ConstrainedLayoutEngine(rect=(0.0, 0.0, 1.0, 0.98), w_pad=beside)
    return Figure(figsize=(width, height), layout=layout)


def _one_view(shown: Motion, side: SideView) -> tuple[Figure, list[Part]]:
    """The field beside the side view."""
    height = (_WIDTH - _FIELD_WIDTH - _BESIDE) * side.shape + _BELOW
    figure = _figure(_WIDTH, max(height, 2.4))
    surface, field = figure.subplots(1, 2, width_ratios=[_WIDTH - _FIELD_WIDTH, _FIELD_WIDTH])
    side.draw(surface)
    return figure, [side, _side_field(field, shown, "field $B$")]


def _two_views(shown: Motion, side: SideView) -> tuple[Figure, list[Part]]:
    """The field below the side view, and the view from above beside both."""
    width = _WIDTH - _FIELD_WIDTH
    heights = [(width - _BESIDE) * side.shape, _FIELD_HEIGHT]
    height = sum(heights) + _BELOW + _BELOW_FIELD
    # A number beside the surface that comes to its end reaches beyond it.
    figure = _figure(width + _ABOVE_WIDTH, height, beside=0.13)
    grid = figure.add_gridspec(
        2, 3, width_ratios=[width, width, 2.0 * _ABOVE_WIDTH], height_ratios=heights
    )
    surface = figure.add_subplot(grid[0, :2])
    along, flat = (figure.add_subplot(grid[1, k]) for k in (0, 1))
    side.draw(surface)
    above = ViewFromAbove(figure.add_subplot(grid[:, 2]), shown)
    horizontal = np.column_stack([shown.bx, shown.by])
    return figure, [
        side,
        above,
        _side_field(along, shown, "field, side view"),
        FieldPanel(flat, horizontal, "field, from above"),
    ]


def _side_field(axes: Axes, shown: Motion, title: str) -> FieldPanel:
    return FieldPanel(axes, np.column_stack([shown.b_along, shown.bz]), title)
