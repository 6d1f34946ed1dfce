"""Mean velocity against what a sweep or a prediction varied."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from stickslip._util import palette
from stickslip._util.units import in_handy_units
from stickslip.plot import style
from stickslip.plot.canvas import drawing, legend_above, root_figure
from stickslip.plot.scales import readable
from stickslip.simulation.seen_from_drive import shown_velocities

if TYPE_CHECKING:
    import xarray

    _Array = NDArray[np.float64]

_QUANTILE = "quantile"
MOST_LINES = 8
"""Lines of one picture: as many as there are styles that can be told apart."""

# Values whose ratio is this or more are shown on a logarithmic axis; chosen: two decades.
_LOG_RATIO = 100.0
_SHADE = 0.2  # opacity of a band; chosen by eye

_STYLES = list(
    zip(
        (palette.BLUE, palette.VERMILION, palette.GREEN, palette.PURPLE) * 2,
        ("-", "--", "-.", ":", "--", "-", ":", "-."),
        ("o", "s", "^", "D", "v", "P", "X", "*"),
        strict=True,
    )
)


@dataclass(frozen=True, eq=False)
class _Axis:
    """A numeric key that was varied."""

    name: str
    values: _Array
    factor: float  # from SI to what is shown
    label: str

    @property
    def log(self) -> bool:
        return bool(
            (self.values > 0.0).all() and self.values.max() >= _LOG_RATIO * self.values.min()
        )


def velocity(data: xarray.Dataset, ax: Axes | None = None) -> Figure:
    """Draw the mean velocities of a sweep: lines over one key, a heat map over two.

    Of a sweep in which a robot left the plane y = 0, this is the velocity along the heading of the
    drive, and the label says so; of programs, which have no heading, that along x. Over one key
    there is a line for each combination of the words that were varied, such as
    ``drive.mode``. Points without a velocity are gaps in a line, and grey cells in a map, whose
    legend says how many there are and why. Of a prediction the line is the median, and two
    quantiles that lie as far from it make a band: 10 % and 90 % that of 80 % of the draws.

    Parameters
    ----------
    data : xarray.Dataset
        What `stickslip.sweep` or `stickslip.predict` gave. Take a part with ``.sel`` or ``.isel``
        where it varied more than can be drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure, if not given.

    Returns
    -------
    matplotlib.figure.Figure
        The one that holds the axes.

    Raises
    ------
    ValueError
        If the Dataset is not one of a sweep, has no sound point, or varies more than can be drawn.
    """
    table: Any = data
    if not hasattr(table, "data_vars"):
        raise ValueError(f"data = {table!r}: allowed is what sweep or predict gave")
    if "mean_velocity" not in table:
        raise ValueError("the Dataset is not one of a sweep: it has no mean_velocity")
    figure, direction = next(iter(shown_velocities(table).items()))
    label = f"mean velocity {direction}".rstrip() + " (mm/s)"
    speeds = (table[figure].squeeze() * 1e3).rename(label)
    if not bool(np.isfinite(speeds.values).any()):
        raise ValueError("no point of the sweep has a velocity")
    gaps = _gaps(table, speeds)
    if "point" in speeds.dims:
        speeds = _unlisted(speeds)
    varied = [str(d) for d in speeds.dims if d != _QUANTILE]
    numeric = [name for name in varied if speeds[name].dtype.kind in "if"]
    words = [name for name in varied if name not in numeric]
    along = [_axis(speeds, name) for name in numeric]

    with drawing(ax, (5.4, 3.6)) as axes:
        if len(along) == 1:
            _draw_lines(axes, speeds, along[0], words)
        elif len(along) == 2 and not words and _QUANTILE not in speeds.dims:
            _draw_map(axes, speeds, along, gaps)
        else:
            found = ", ".join([*numeric, *words]) or "nothing"
            raise ValueError(
                f"the sweep varies {found}: allowed are one number with words, or two numbers "
                "without bands; take a part of it with .sel"
            )
        readable(axes)
    return root_figure(axes)


def _gaps(table: Any, speeds: Any) -> str:
    """How many points have no velocity, and why, as words of a legend."""
    missing = ~np.isfinite(speeds.values)
    if "status" not in table:  # of a prediction
        return f"no velocity: {np.count_nonzero(missing)}"
    about = table["status"].attrs
    words = dict(zip(np.ravel(about["flag_values"]), about["flag_meanings"].split(), strict=True))
    codes, counts = np.unique(table["status"].squeeze().values[missing], return_counts=True)
    return "no velocity: " + ", ".join(
        f"{count} {words[code].replace('_', ' ')}"
        for code, count in zip(codes, counts, strict=True)
    )


def _unlisted(speeds: Any) -> Any:
    """A list of points as a grid of the keys that differ between them."""
    names = [str(name) for name in speeds.coords if name not in ("point", _QUANTILE)]
    index = [name for name in names if np.unique(speeds[name].values).size > 1]
    plain = speeds.drop_vars([name for name in names if name not in index])
    rows = set(zip(*(plain[name].values.tolist() for name in index), strict=True))
    if len(rows) < plain.sizes["point"]:
        raise ValueError("the list of the sweep has a point twice")
    attributes = {name: plain[name].attrs for name in index}
    if len(index) == 1:
        return plain.swap_dims(point=index[0]).sortby(index[0])
    grid = plain.set_index(point=index).unstack("point")
    for name, about in attributes.items():
        grid[name].attrs.update(about)
    return grid


def _axis(speeds: Any, name: str) -> _Axis:
    coordinate = speeds[name]
    unit = str(coordinate.attrs.get("units", ""))
    shown = in_handy_units(_words(speeds, name), unit)
    return _Axis(name, coordinate.values.astype(np.float64), *shown)


def _words(speeds: Any, name: str) -> str:
    """What the key of a coordinate is called in a picture."""
    key = str(speeds[name].attrs.get("key", name))
    return key.rpartition(".")[2].replace("_", " ")


def _draw_lines(axes: Axes, speeds: Any, along: _Axis, words: list[str]) -> None:
    choices = list(itertools.product(*(speeds[name].values for name in words)))
    if len(choices) > MOST_LINES:
        raise ValueError(
            f"{len(choices)} lines: allowed are at most {MOST_LINES}; take a part with .sel"
        )
    bands = _QUANTILE in speeds.dims
    handles: list[Artist] = []
    for choice, (colour, dashes, marker) in zip(choices, _STYLES, strict=False):
        line = speeds.sel(dict(zip(words, choice, strict=True)))
        name = ", ".join(map(str, choice))
        shades: list[Artist] = []
        if bands:
            prefix = f"{name}, " if name else ""
            line, shades = _draw_bands(axes, line, along, colour, prefix)
            name = f"{prefix}median of draws"
        handles += axes.plot(
            along.values * along.factor,
            line.values,
            color=colour,
            linestyle=dashes,
            marker=marker,
            markersize=3.5,
            label=name,
        )
        handles += shades
    if along.log:
        axes.set_xscale("log")
    axes.set_xlabel(along.label)
    axes.set_ylabel(speeds.name)
    if words or bands:
        look: Any = {"fontsize": "small", "framealpha": 0.8, "edgecolor": "none"}
        axes.legend(
            handles=handles, title=", ".join(_words(speeds, name) for name in words), **look
        )


def _draw_bands(
    axes: Axes, line: Any, along: _Axis, colour: str, prefix: str
) -> tuple[Any, list[Artist]]:
    """Shade what lies between each two opposite quantiles; the median, and a handle for each."""
    levels = line[_QUANTILE].values
    if not np.allclose(levels + levels[::-1], 1.0) or 0.5 not in levels:
        shown = ", ".join(f"{each:g}" for each in levels)
        raise ValueError(
            f"quantiles {shown}: allowed are 0.5 and pairs about it, such as 0.1, 0.5, 0.9; "
            "take one of them with .sel"
        )
    handles: list[Artist] = []
    pairs = zip(levels[: len(levels) // 2], levels[::-1], strict=False)
    for number, (low, high) in enumerate(pairs, start=1):
        axes.fill_between(
            along.values * along.factor,
            line.sel(quantile=low).values,
            line.sel(quantile=high).values,
            color=colour,
            alpha=_SHADE,
            linewidth=0.0,
        )
        # An inner band lies on the outer ones, and is as dark as all of them together.
        alpha = 1.0 - (1.0 - _SHADE) ** number
        share = f"{prefix}{100.0 * (1.0 - 2.0 * low):.4g} % of draws"
        handles.append(Patch(facecolor=colour, alpha=alpha, linewidth=0.0, label=share))
    return line.sel(quantile=0.5), handles


def _draw_map(axes: Axes, speeds: Any, along: list[_Axis], gaps: str) -> None:
    across, up = along
    values = speeds.transpose(up.name, across.name).values
    largest = float(np.nanmax(np.abs(values)))
    both_ways = float(np.nanmin(values)) < 0.0 < float(np.nanmax(values))
    mesh = axes.pcolormesh(
        _edges(across) * across.factor,
        _edges(up) * up.factor,
        np.ma.masked_invalid(values),
        cmap="PuOr_r" if both_ways else "viridis",
        vmin=-largest if both_ways else None,
        vmax=largest if both_ways else None,
        rasterized=True,
    )
    for axis, set_scale in ((across, axes.set_xscale), (up, axes.set_yscale)):
        if axis.log:
            set_scale("log")
    axes.set_facecolor(style.NO_VALUE)
    axes.grid(visible=False)
    axes.set_xlabel(across.label)
    axes.set_ylabel(up.label)
    if np.isnan(values).any():
        legend_above(axes, [Patch(facecolor=style.NO_VALUE, label=gaps)])
    bar = root_figure(axes).colorbar(mesh, ax=axes)
    bar.set_label(speeds.name)


def _edges(axis: _Axis) -> _Array:
    """Borders of the cells around values, half way between them."""
    values = np.log(axis.values) if axis.log else axis.values
    middle = 0.5 * (values[1:] + values[:-1])
    edges = np.concatenate(
        [[1.5 * values[0] - 0.5 * values[1]], middle, [1.5 * values[-1] - 0.5 * values[-2]]]
    )
    return np.asarray(np.exp(edges) if axis.log else edges)
