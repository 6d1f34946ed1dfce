"""Mean velocity over the varied keys of a sweep or a prediction."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from stickslip._util import palette
from stickslip._util.arrays import Array
from stickslip._util.messages import refuse
from stickslip._util.picture import legend_above
from stickslip._util.units import in_handy_units
from stickslip.plot import style
from stickslip.simulation.seen_from_drive import shown_velocities

if TYPE_CHECKING:
    import xarray

_QUANTILE = "quantile"
MOST_LINES = 8
"""Lines of one picture: as many as there are styles that can be told apart."""

# Values whose ratio is this or more are shown on a logarithmic axis; chosen: two decades.
_LOG_RATIO = 100.0
_LEGEND = 70  # characters of a line of the legend
_SHADE = 0.2  # opacity of a band; chosen by eye

_STYLES = list(
    zip(
        (palette.BLUE, palette.VERMILION, palette.GREEN, palette.PURPLE) * 2,
        ("-", "--", "-.", ":", "--", "-", ":", "-."),
        ("o", "s", "^", "D", "v", "P", "X", "*"),
        strict=True,
    )
)


class _Axis(NamedTuple):
    """A numeric key that was varied."""

    name: str
    values: Array  # in the unit of the label
    label: str
    log: bool


def velocity(data: xarray.Dataset, ax: Axes | None = None) -> Figure:
    """Draw the mean velocities of a sweep: lines over one number, a map over two.

    Of a sweep in the whole plane this is the velocity along the heading of the drive, and the label
    says so; of programs, which have no heading, that along x. Over one number there is a line for
    each combination of the words that were varied, such as ``drive.mode``. Points without a
    velocity are gaps in a line, and grey cells in a map, whose legend says how many there are and
    why. With a dimension ``quantile``, as a prediction has it, the line is the median, and two
    quantiles that lie as far from it make a band: 10 % and 90 % that of 80 % of the draws.

    Parameters
    ----------
    data : xarray.Dataset
        What `stickslip.sweep` or `stickslip.predict` gave. Take a part with ``.sel`` or ``.isel``
        where it varied more than can be drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure, if not given.

    Raises
    ------
    ValueError
        If the Dataset is not one of a sweep, has no sound point, or varies more than can be drawn.
    """
    table: Any = data
    if not hasattr(table, "data_vars"):
        refuse("data", table, "what sweep or predict gave")
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
    varied = [str(name) for name in speeds.dims if name != _QUANTILE]
    numbers = [_axis(speeds[name]) for name in varied if speeds[name].dtype.kind in "iuf"]
    words = [name for name in varied if speeds[name].dtype.kind not in "iuf"]

    with style.drawing(ax, (5.4, 3.6)) as axes:
        if len(numbers) == 1:
            _draw_lines(axes, speeds, numbers[0], words)
        elif len(numbers) == 2 and not words and _QUANTILE not in speeds.dims:
            _draw_map(axes, speeds, numbers, gaps)
        else:
            names = ", ".join([*(axis.name for axis in numbers), *words]) or "nothing"
            raise ValueError(
                f"the sweep varies {names}: allowed are one number with words, or two numbers "
                "without bands; take a part of it with .sel"
            )
        style.readable(axes, y=0.0)
    return style.root_figure(axes)


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
    listed = [name for name in speeds.coords if name not in ("point", _QUANTILE)]
    index = [name for name in listed if np.unique(speeds[name].values).size > 1]
    plain = speeds.drop_vars([name for name in listed if name not in index])
    rows = set(zip(*(plain[name].values.tolist() for name in index), strict=True))
    if len(rows) < plain.sizes["point"]:
        raise ValueError("the list of the sweep has a point twice")
    if len(index) == 1:
        return plain.swap_dims(point=index[0]).sortby(index[0])
    grid = plain.set_index(point=index).unstack("point")
    for name in index:  # which the index does not keep
        grid[name].attrs.update(plain[name].attrs)
    return grid


def _axis(coordinate: Any) -> _Axis:
    """A coordinate as it is shown, in a handy unit."""
    name = str(coordinate.name)
    factor, label = in_handy_units(_words(coordinate), str(coordinate.attrs.get("units", "")))
    values = coordinate.values.astype(np.float64) * factor
    log = bool(values.min() > 0.0 and values.max() >= _LOG_RATIO * values.min())
    return _Axis(name, values, label, log)


def _words(coordinate: Any) -> str:
    """The key that a coordinate has the values of, or its name, in words."""
    key = str(coordinate.attrs.get("key", coordinate.name)).removeprefix("effects.")
    return key.replace(".", " ").replace("_", " ")


def _draw_lines(axes: Axes, speeds: Any, along: _Axis, words: list[str]) -> None:
    choices = list(itertools.product(*(speeds[name].values for name in words)))
    if len(choices) > MOST_LINES:
        raise ValueError(
            f"{len(choices)} lines: allowed are at most {MOST_LINES}; take a part with .sel"
        )
    handles: list[Artist] = []
    for choice, (colour, dashes, marker) in zip(choices, _STYLES, strict=False):
        line = speeds.sel(dict(zip(words, choice, strict=True)))
        name = ", ".join(map(str, choice))
        shades: list[Artist] = []
        if _QUANTILE in line.dims:
            prefix = f"{name}, " if name else ""
            shades = _draw_bands(axes, line, along, colour, prefix)
            line, name = line.sel(quantile=0.5), f"{prefix}median of draws"
        look: Any = {"color": colour, "linestyle": dashes, "marker": marker, "markersize": 3.5}
        handles += axes.plot(along.values, line.values, label=name, **look)
        handles += shades
    if along.log:
        axes.set_xscale("log")
    axes.set_xlabel(along.label)
    axes.set_ylabel(speeds.name)
    if len(handles) > 1:
        title = ", ".join(_words(speeds[name]) for name in words)
        longest = max(len(str(handle.get_label())) for handle in handles)
        legend_above(axes, handles, max(1, _LEGEND // (longest + 6)), title)


def _draw_bands(axes: Axes, line: Any, along: _Axis, colour: str, prefix: str) -> list[Artist]:
    """Shade what lies between each two opposite quantiles; a handle for each."""
    levels = line[_QUANTILE].values
    if not np.allclose(levels + levels[::-1], 1.0) or 0.5 not in levels:
        shown = ", ".join(f"{level:g}" for level in levels)
        raise ValueError(
            f"quantiles {shown}: allowed are 0.5 and pairs about it, such as 0.1, 0.5, 0.9; "
            "take one of them with .sel"
        )
    handles: list[Artist] = []
    for number, low in enumerate(levels[: len(levels) // 2]):
        ends = line.isel(quantile=number).values, line.isel(quantile=-1 - number).values
        look: Any = {"color": colour, "linewidth": 0.0}
        axes.fill_between(along.values, *ends, alpha=_SHADE, **look)
        # An inner band lies on the outer ones, and is as dark as all of them together.
        alpha = 1.0 - (1.0 - _SHADE) ** (number + 1)
        share = f"{prefix}{100.0 * (1.0 - 2.0 * low):.4g} % of draws"
        handles.append(Patch(alpha=alpha, label=share, **look))
    return handles


def _draw_map(axes: Axes, speeds: Any, numbers: list[_Axis], gaps: str) -> None:
    across, up = numbers
    values = np.ma.masked_invalid(speeds.transpose(up.name, across.name).values)
    look: Any = {"cmap": "viridis", "rasterized": True}
    if values.min() < 0.0 < values.max():
        largest = float(np.abs(values).max())
        look |= {"cmap": "PuOr_r", "vmin": -largest, "vmax": largest}
    mesh = axes.pcolormesh(_edges(across), _edges(up), values, **look)
    axes.set(xlabel=across.label, ylabel=up.label, facecolor=style.NO_VALUE)
    axes.set(xscale="log" if across.log else "linear", yscale="log" if up.log else "linear")
    axes.grid(visible=False)
    if np.ma.is_masked(values):
        legend_above(axes, [Patch(facecolor=style.NO_VALUE, label=gaps)])
    style.root_figure(axes).colorbar(mesh, ax=axes, label=speeds.name)


def _edges(axis: _Axis) -> Array:
    """Borders of the cells around values, half way between them."""
    values = np.log(axis.values) if axis.log else axis.values
    first, last = 2.0 * values[0] - values[1], 2.0 * values[-1] - values[-2]
    edges = 0.5 * (np.append(first, values) + np.append(values, last))
    return np.asarray(np.exp(edges) if axis.log else edges)
