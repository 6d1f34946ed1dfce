"""Figures of a diagnosis; the report has them as PNG in base64."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.palette import BLUE, DARK_GREY, GREEN, LIGHT_GREY, VERMILION
from stickslip.diagnosis.data.conditions import panel, sorted_by_settings
from stickslip.diagnosis.fit.profile_likelihood import FAR, Profile
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import leading, set_members
from stickslip.scenario.keys import Value

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

_MARKERS = "o^sDv"


def png(figure: Figure | None) -> str:
    """The figure in base64; empty if there is none."""
    if figure is None:
        return ""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None})
    return base64.b64encode(buffer.getvalue()).decode("ascii")


def axes(rows: int, width: float, height: float) -> tuple[Figure, Any]:
    """A figure (inches) and its axes, one above the other; the second is a strip."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    ratios = [3, 1][:rows]
    return figure, figure.subplots(rows, 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]


def velocities(
    found: Findings, conditions: Sequence[Mapping[str, Value]], given: Array
) -> Figure | None:
    """Data and models against frequency, a column for each mode and direction.

    `given` are the velocities of the scenario as it was given, m/s. Residuals are below. At
    held-out conditions the models are those that were fitted without them. Where nothing could be
    learnt there is no model but the given one. Conditions of one panel that differ in more than
    their frequency have markers of their own. None where no velocity was measured.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    m = len(conditions)
    if m == 0:
        return None
    problem = found.problem
    observed = problem.observed[:m] * 1e3
    sd = np.sqrt(np.diag(found.noise.covariance))[:m] * 1e3
    models = _models(found, m)
    known = found.noise.dof > 0.0
    held = found.held_out[:m]
    words = np.array([panel(each) for each in conditions])
    frequency = np.array([float(each["drive.frequency"]) for each in conditions])
    panels = list(dict.fromkeys(words.tolist()))
    figure = Figure(figsize=(max(4.5, min(3.2 * len(panels), 12.8)), 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    frames = figure.subplots(
        2, len(panels), sharex="col", sharey="row", squeeze=False, height_ratios=[3, 1]
    )
    measured = "measured (2 sd)" if known else "measured"
    shown = ("drive.mode", "drive.direction", "drive.frequency")
    kinds = sorted_by_settings(conditions, shown, len(_MARKERS))
    for column, word in enumerate(panels):
        above, below = frames[:, column]
        mine = words == word
        for k, (settings, indices) in enumerate(kinds.items()):
            have = np.isin(np.arange(m), indices)
            label = settings if k else ", ".join(filter(None, (measured, settings)))
            chosen = mine & have
            bars = 2 * sd[chosen] if known else None
            _measured(above, frequency[chosen], observed[chosen], bars, held[chosen], _MARKERS[k],
                      label)  # fmt: skip
        above.plot(frequency[mine], given[mine] * 1e3, "x", color=DARK_GREY, ms=5,
                   label="scenario as given")  # fmt: skip
        for (name, row), colour in zip(models.items(), (BLUE, VERMILION), strict=False):
            above.plot(frequency[mine], row[mine], "_", color=colour, ms=11, mew=2, label=name)
            below.plot(frequency[mine], ((observed - row) / sd)[mine], ".", color=colour)
        below.axhspan(-2, 2, color=LIGHT_GREY, zorder=0)
        above.set_title(word, fontsize=10)
        below.set_xlabel("frequency (Hz)")
    frames[0, 0].set_ylabel("mean velocity (mm/s)")
    frames[1, 0].set_ylabel("residual / sd")
    legend = _legend(frames[0])
    columns = 2 if len(panels) < 3 else 5 if len(kinds) == 1 else 3
    figure.legend(legend.values(), legend.keys(), loc="outside upper center", ncols=columns,
                  fontsize=10, frameon=False)  # fmt: skip
    return figure


def _measured(
    frame: Any,
    place: Array,
    data: Array,
    bars: Array | None,
    held_out: NDArray[np.bool_],
    marker: str,
    label: str,
) -> None:
    """Readings, hollow where they were held out; shape (m,) each."""
    for face, chosen, title in (("k", ~held_out, label), ("w", held_out, "held out for the gain")):
        if chosen.any():
            frame.errorbar(place[chosen], data[chosen], None if bars is None else bars[chosen],
                           fmt=marker, color="k", mfc=face, ms=4, label=title)  # fmt: skip


def _legend(frames: Iterable[Any]) -> dict[str, Any]:
    """What is drawn by its label, each label once."""
    legend: dict[str, Any] = {}
    for frame in frames:
        for handle, label in zip(*frame.get_legend_handles_labels(), strict=True):
            legend.setdefault(label, handle)
    return legend


def _models(found: Findings, m: int) -> dict[str, Array]:
    """Velocities of the fitted models at the m conditions, mm/s."""
    if found.verdict.kind == "data-problem":
        return {}
    points = {"recalibrated": found.null.x}
    if found.verdict.fit is not None:
        points[f"with {found.verdict.fit.name}"] = found.verdict.fit.x
    predicted = found.problem.predicted(np.stack(list(points.values())))[:, :m] * 1e3
    if found.gain is not None:
        # What is judged there is what the fits without these conditions said.
        gain = found.gain
        predicted[:, gain.held_out] = np.stack([gain.predicted_before, gain.predicted_after]) * 1e3
    return dict(zip(points, predicted, strict=True))


def profile(each: Profile) -> Figure:
    """Chi-square along one parameter, everything else fitted anew."""
    figure, (frame,) = axes(1, 5.0, 2.6)
    order = np.argsort(each.value)
    # A profile goes far out to see other valleys; beyond the last of them there is nothing to see.
    inside = np.flatnonzero(each.chi2[order] <= FAR)
    order = order[max(inside[0] - 1, 0) : inside[-1] + 2]
    frame.plot(each.value[order], each.chi2[order], "o-", color=VERMILION, ms=4)
    for height in (1.0, 4.0):
        frame.axhline(height, color=DARK_GREY, lw=0.8, ls="--")
    frame.locator_params(axis="x", nbins=5)
    frame.set_ylim(-0.3, float(np.clip(np.max(each.chi2[order]), 5.0, 1.5 * FAR)))
    frame.set_xlabel(f"{each.name.removeprefix('effects.')} ({each.unit})")
    frame.set_ylabel("chi-square above the least")
    return figure


def against_model(
    place: Array,
    observed: Array,
    sd: Array,
    recalibrated: Array,
    extended: Array | None,
    held_out: NDArray[np.bool_],
    words: tuple[str, str],
    names: Sequence[str] = ("",),
    joined: bool = True,
) -> Figure:
    """Data with 2 sd, recalibrated and extended model, and residuals below.

    Parameters
    ----------
    place : ndarray, shape (m,)
        Along the abscissa, ascending.
    observed, sd, recalibrated, extended : ndarray, shape (m,) or (m, series)
    held_out : ndarray of bool, shape (m,)
        Readings that were held out for the gain; they are hollow.
    words : tuple of str
        Below and beside the axes, with units.
    names : sequence of str
        Of the series.
    joined : bool
        Whether the rows are points of one curve.
    """
    figure, (above, below) = axes(2, 9.0, 5.2)
    rows = [(recalibrated, "recalibrated", BLUE)]
    if extended is not None:
        rows.append((extended, "extended", VERMILION))
    width = len(names)
    data, bars = observed.reshape(-1, width), sd.reshape(-1, width)
    for k, (name, marker) in enumerate(zip(names, _MARKERS, strict=False)):
        title = f"measured {name} (2 sd)".replace("  ", " ")
        _measured(above, place, data[:, k], 2 * bars[:, k], held_out, marker, title)
        for values, model, colour in rows:
            line = values.reshape(-1, width)[:, k]
            above.plot(place, line, "-_" if joined else "_", color=colour, lw=1, ms=12, label=model)
            below.plot(place, (data[:, k] - line) / bars[:, k], marker, color=colour, ms=3)
    below.axhspan(-2, 2, color=LIGHT_GREY, zorder=0)
    above.set_ylabel(words[1])
    below.set_ylabel("residual / sd")
    below.set_xlabel(words[0])
    legend = _legend([above])
    above.legend(legend.values(), legend.keys(), fontsize=8, frameon=False)
    return figure


def readings(place: Array, observed: Array, sd: Array | None, words: tuple[str, str]) -> Figure:
    """Data alone, with 2 sd where it is known; `words` below and beside the axes."""
    figure, (frame,) = axes(1, 9.0, 4.0)
    bars = None if sd is None else 2 * sd
    label = "measured" if sd is None else "measured (2 sd)"
    frame.errorbar(place, observed, bars, fmt="o", color="k", ms=4, label=label)
    frame.set_xlabel(words[0])
    frame.set_ylabel(words[1])
    frame.legend(fontsize=8, frameon=False)
    return figure


def own_model(found: Findings, place: Array, words: tuple[str, str]) -> Figure:
    """Data and models against an abscissa, for a model of the user's own.

    No model where nothing was learnt, and no error where none is known.

    Parameters
    ----------
    found : Findings
    place : ndarray, shape (m,)
        Of each condition.
    words : tuple of str
        Below and beside the axes, with units.
    """
    m, order = len(place), np.argsort(place, kind="stable")
    observed, sd = found.problem.observed[:m], found.problem.sd[:m]
    models = list(own_models(found, m).values())
    if found.noise.dof == 0.0 or not models:
        known = None if found.noise.dof == 0.0 else sd[order]
        return readings(place[order], observed[order], known, words)
    extended = models[1][order] if len(models) > 1 else None
    held_out = found.held_out[:m][order]
    rows = (place[order], observed[order], sd[order], models[0][order], extended, held_out)
    return against_model(*rows, words, joined=False)


def own_models(found: Findings, m: int) -> dict[str, Array]:
    """The fitted models at the first m observables; none where nothing was learnt."""
    if found.verdict.kind == "data-problem":
        return {}
    points = {"recalibrated": found.null.x}
    if found.verdict.fit is not None:
        points["extended"] = found.verdict.fit.x
    return {name: found.problem.predicted(x[None, :])[0, :m] for name, x in points.items()}


def residuals(found: Findings, place: Array, word: str) -> Figure:
    """Whitened residuals of both fitted models against an abscissa.

    Each is independent of the others and of variance one, if the model is right: errors that
    set-ups share are taken out.

    Parameters
    ----------
    found : Findings
    place : ndarray, shape (m,)
        Of each observable.
    word : str
        Below the axis, with its unit.
    """
    figure, (frame,) = axes(1, 9.0, 3.6)
    for name, fit, marker, colour in (
        ("recalibrated", found.null, "o", BLUE),
        ("extended", found.verdict.fit, "s", VERMILION),
    ):
        if fit is not None:
            frame.plot(place, fit.residual[: len(place)], marker, color=colour, ms=4, label=name)
    frame.axhspan(-2, 2, color="#dddddd", zorder=0)
    frame.set_xlabel(word)
    frame.set_ylabel("residual / sd")
    frame.legend(fontsize=8, frameon=False)
    return figure


def ranking(found: Findings) -> Figure | None:
    """Log-evidence of the leading candidates above no cause, after the price of a second cause.

    None where no candidate was fitted.
    """
    fits = leading(found)
    if not fits:
        return None
    figure, (frame,) = axes(1, 7.0, 0.4 + 0.3 * len(fits))
    gains = [fit.priced_evidence - found.null.log_evidence for fit in fits]
    claimed = {fit.name for fit in set_members(found)}
    colours = [GREEN if fit.name in claimed else DARK_GREY for fit in fits]
    frame.barh([fit.name for fit in fits][::-1], gains[::-1], color=colours[::-1])
    frame.set_xlabel("log-evidence above no cause (green: what is claimed)")
    return figure


def distinguishability(found: Findings) -> Figure:
    """Map of the cosines between projected sensitivities."""
    names = [cause.name for cause in found.problem.causes]
    size = 2.0 + 0.18 * len(names)
    figure, (frame,) = axes(1, size + 0.5, size)
    image = frame.imshow(found.cosines, vmin=0, vmax=1, cmap="viridis")
    frame.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
    frame.set_yticks(range(len(names)), names, fontsize=7)
    figure.colorbar(image, ax=frame, shrink=0.7, label="|cosine| after recalibration")
    return figure
