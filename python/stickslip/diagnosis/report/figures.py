"""Figures of a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.palette import BLACK, BLUE, DARK_GREY, LIGHT_GREY, VERMILION
from stickslip._util.picture import Picture
from stickslip._util.plain_text import shortened
from stickslip.diagnosis.data.conditions import Conditions, panel, sorted_by_settings
from stickslip.diagnosis.fit.profile_likelihood import FAR, Profile
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.open_set import BAND, OpenSet
from stickslip.diagnosis.inference.ranking import leading, set_members
from stickslip.diagnosis.report.chart import MARKERS, UPWARDS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

_LETTERS = tuple(MARKERS.values())
PLACES = ("drive.mode", "drive.direction")
"""Settings of which each pair has a panel."""
_MAP_LABEL = 30
"""Characters of a name beside the map of cosines. Chosen: no cause of the library is longer, and a
map of a single cause has place for it."""

COLOURS = {"recalibrated": BLUE, "extended": VERMILION}
"""Of the models, and thus of what is claimed, in all figures of a page; readings are black."""


def kinds_of(conditions: Conditions, key: str) -> dict[str, list[int]]:
    """Conditions by the settings that differ within a panel over `key`, in the order of `MARKERS`.

    A panel has one mode and one direction.
    """
    return sorted_by_settings(conditions, (*PLACES, key), len(MARKERS))


def new_figure(width: float, height: float, rows: int = 1, columns: int = 1) -> tuple[Figure, Any]:
    """A figure, inches, and its axes, shape (rows, columns); a second row is a strip."""

    figure = Picture(figsize=(width, height), layout="constrained")
    ratios = [3, 1][:rows]
    return figure, figure.subplots(
        rows, columns, sharex="col", sharey="row", squeeze=False, height_ratios=ratios
    )


def velocities(found: Findings, conditions: Conditions, given: Array) -> Figure | None:
    """Data and models against frequency, a column for each mode and direction; residuals below.

    `given` are the velocities of the scenario as it was given, m/s. At held-out conditions the
    models are those that were fitted without them. Where nothing could be learnt there is no model
    but the given one. Conditions of one panel that differ in more than their frequency have markers
    of their own. None where no velocity was measured.
    """
    m = len(conditions)
    if m == 0:
        return None
    observed, models = found.problem.observed[:m] * 1e3, _models_in_mm(found, m)
    sd = np.sqrt(np.diag(found.noise.covariance))[:m] * 1e3 if found.noise.dof > 0.0 else None
    words = np.array([panel(each) for each in conditions])
    frequency = np.array([float(each["drive.frequency"]) for each in conditions])
    panels = list(dict.fromkeys(words.tolist()))
    figure, frames = new_figure(max(4.5, min(3.2 * len(panels), 12.8)), 5.0, 2, len(panels))
    kinds = kinds_of(conditions, "drive.frequency")
    for word, pair in zip(panels, frames.T, strict=True):
        for k, (settings, indices) in enumerate(kinds.items()):
            label = settings if k else ", ".join(filter(None, (_measured(sd), settings)))
            at = np.intersect1d(np.flatnonzero(words == word), indices)
            _draw(pair, _LETTERS[k], label, frequency[at], observed[at],
                  None if sd is None else sd[at], {name: row[at] for name, row in models.items()},
                  found.held_out[at])  # fmt: skip
        mine = words == word
        pair[0].plot(frequency[mine], given[mine] * 1e3, "x", color=DARK_GREY, ms=5,
                     label="scenario as given")  # fmt: skip
        pair[0].set_title(word, fontsize=10)
        _label_residuals(pair[1], "frequency (Hz)")
    frames[0, 0].set_ylabel("mean velocity (mm/s)")
    columns = 2 if len(panels) < 3 else 5 if len(kinds) == 1 else 3
    figure.legend(**_legend(frames[0]), loc="outside upper center", ncols=columns, fontsize=10,
                  frameon=False)  # fmt: skip
    return figure


def law_curve(found: OpenSet) -> Figure:
    """The curve of the first place with its band and formula."""
    figure = Picture(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    term, curve = found.first.term, found.curve
    axes.fill_between(curve.argument, curve.low, curve.high, color=LIGHT_GREY,
                      label=f"whole law, {BAND:.0%}")  # fmt: skip
    axes.plot(curve.argument, curve.law, color=COLOURS["extended"], label="curve of free shape")
    if found.formula is not None:
        formula = found.formula
        one = "1 + " if term.relative else ""
        change = formula.at(curve.argument)
        factor = np.maximum(1.0 + change, 0.0) if term.cut else 1.0 + change
        law = formula.without * factor if term.relative else formula.without + change
        axes.plot(curve.argument, law, "--", color=BLACK, label=f"{one}{formula.text}")
    axes.axhline(curve.without, color=DARK_GREY, lw=0.8, label="without f")
    unit = "" if curve.unit == "-" else f" ({curve.unit})"
    law_name = term.law if term.relative else f"f of {term.law}"
    axes.set(xlabel=f"{term.argument} ({term.unit})", ylabel=f"{law_name}{unit}")
    axes.legend(fontsize=8, frameon=False)
    return figure


def law_places(found: OpenSet) -> Figure:
    """How the places rank at which a law may have another shape."""
    names = [each.term.name for each in found.shapes]
    figure = Picture(figsize=(6.4, 0.8 + 0.22 * len(names)), layout="constrained")
    axes = figure.subplots()
    colours = [COLOURS["extended"] if each is found.first else DARK_GREY for each in found.shapes]
    axes.barh(names, [each.lead for each in found.shapes], color=colours)
    axes.invert_yaxis()
    axes.set_xlabel("log-evidence above no change")
    return figure


def _models_in_mm(found: Findings, m: int) -> dict[str, Array]:
    """Velocities of the fitted models, mm/s, at held-out conditions of the fits without these."""
    models = {name: row * 1e3 for name, row in fitted_models(found, m).items()}
    gain = found.gain
    if gain is not None:
        models["recalibrated"][gain.held_out] = gain.predicted_before * 1e3
        models["extended"][gain.held_out] = gain.predicted_after * 1e3
    labels = {}
    if found.extended is not None:
        labels["extended"] = shortened(f"with {found.extended[1].name}")
    return {labels.get(name, name): row for name, row in models.items()}


def _draw(
    pair: Sequence[Any],
    marker: str,
    label: str,
    place: Array,
    observed: Array,
    sd: Array | None,
    models: Mapping[str, Array],
    held_out: NDArray[np.bool_],
    joined: bool = False,
) -> None:
    """Readings and models in the first of two axes, residuals in the second; shape (m,) each.

    Readings are hollow where they were held out. `models` are by their labels, the recalibrated one
    first; `joined` says whether they are points of one curve.
    """
    above, below = pair
    for face, chosen, title in (("k", ~held_out, label), ("w", held_out, "held out for the gain")):
        if chosen.any():
            above.errorbar(place[chosen], observed[chosen], None if sd is None else 2 * sd[chosen],
                           fmt=marker, color="k", mfc=face, ms=4, label=title)  # fmt: skip
    for (name, values), colour in zip(models.items(), COLOURS.values(), strict=False):
        line = "-_" if joined else "_"
        above.plot(place, values, line, color=colour, lw=1, ms=11, mew=1.5, label=name)
        if sd is not None:
            below.plot(place, (observed - values) / sd, marker, color=colour, ms=3)


def _measured(sd: Array | None, name: str = "") -> str:
    """Label of readings, which says what their bars are."""
    return " ".join(filter(None, ("measured", name, "" if sd is None else "(2 sd)")))


def _label_residuals(axes: Any, label: str) -> None:
    """Name the axes of residuals, and shade where 95 % of them lie if the model is right."""
    axes.axhspan(-2, 2, color=LIGHT_GREY, zorder=0)
    axes.set_xlabel(label)
    axes.set_ylabel("residual / sd")
    axes.label_outer()


def _legend(frames: Sequence[Any]) -> dict[str, Any]:
    """Handles and labels of all that is drawn, each label once."""
    legend: dict[str, Any] = {}
    for frame in frames:
        for handle, label in zip(*frame.get_legend_handles_labels(), strict=True):
            legend.setdefault(label, handle)
    return {"handles": list(legend.values()), "labels": list(legend)}


def fitted_models(found: Findings, m: int) -> dict[str, Array]:
    """The fitted models at the first m observables; none where nothing was learnt."""
    if found.verdict.kind == "data-problem":
        return {}
    models = {"recalibrated": (found.problem, found.null)}
    if found.extended is not None:
        models["extended"] = found.extended
    return {
        name: problem.predicted(fit.x[None, :])[0, :m] for name, (problem, fit) in models.items()
    }


def against_model(
    place: Array,
    observed: Array,
    sd: Array | None,
    models: Mapping[str, Array],
    held_out: NDArray[np.bool_],
    labels: tuple[str, str],
    names: Sequence[str] = ("",),
    factor: float = 1.0,
    joined: bool = True,
) -> Figure:
    """Data with 2 sd against `place`, shape (m,), and models and residuals where there are any.

    `observed`, `sd` and the models have shape (m,) or (m, series), and `factor` takes them to the
    unit of `labels`, below and beside the axes; `names` are those of the series. Readings that were
    held out are hollow; `joined` says whether the rows are points of one curve.
    """
    order = np.argsort(place, kind="stable")
    figure, frames = new_figure(9.0, 5.2 if models else 4.0, 2 if models else 1)
    above, below = frames[0, 0], frames[-1, 0]

    def series(values: Array, k: int) -> Array:
        return np.asarray(factor * values.reshape(-1, len(names))[order, k])

    for k, name in enumerate(names):
        _draw((above, below), _LETTERS[k], _measured(sd, name), place[order], series(observed, k),
              None if sd is None else series(sd, k),
              {model: series(values, k) for model, values in models.items()},
              held_out[order], joined)  # fmt: skip
    across, up = shortened(labels[0]), shortened(labels[1], UPWARDS)
    if models:
        _label_residuals(below, across)
    below.set_xlabel(across)
    above.set_ylabel(up)
    above.legend(**_legend([above]), fontsize=8, frameon=False)
    return figure


def own_model(found: Findings, place: Array, labels: tuple[str, str]) -> Figure:
    """Data and models against `place`, shape (m,), for a model of the user's own.

    No model where nothing was learnt, and no error where none is known.
    """
    m, known = len(place), found.noise.dof > 0.0
    observed, sd = found.problem.observed[:m], found.problem.sd[:m] if known else None
    models = fitted_models(found, m) if known else {}
    return against_model(place, observed, sd, models, found.held_out[:m], labels, joined=False)


def residuals(found: Findings, place: Array, label: str) -> Figure:
    """Whitened residuals of both fitted models against an abscissa, shape (m,).

    Each is independent of the others and of variance one, if the model is right: errors that
    set-ups share are taken out.
    """
    figure, ((frame,),) = new_figure(9.0, 3.6)
    fits = {"recalibrated": found.null}
    if found.extended is not None:
        fits["extended"] = found.extended[1]
    for name, fit in fits.items():
        frame.plot(place, fit.residual[: len(place)], "o", color=COLOURS[name], ms=4, label=name)
    _label_residuals(frame, label)
    frame.legend(fontsize=8, frameon=False)
    return figure


def profile(each: Profile) -> Figure:
    """Chi-square along one parameter, everything else fitted anew."""
    figure, ((frame,),) = new_figure(5.0, 2.6)
    order = np.argsort(each.value)
    # A profile goes far out to find other local minima; it is drawn as far as the last of them.
    inside = np.flatnonzero(each.chi2[order] <= FAR)
    order = order[max(inside[0] - 1, 0) : inside[-1] + 2]
    frame.plot(each.value[order], each.chi2[order], "o-", color=COLOURS["extended"], ms=4)
    for height in (1.0, 4.0):
        frame.axhline(height, color=DARK_GREY, lw=0.8, ls="--")
    frame.locator_params(axis="x", nbins=5)
    frame.set_ylim(-0.3, float(np.clip(np.max(each.chi2[order]), 5.0, 1.5 * FAR)))
    frame.set_xlabel(shortened(f"{each.name.removeprefix('effects.')} ({each.unit})"))
    frame.set_ylabel("chi-square above the least")
    return figure


def ranking(found: Findings) -> Figure | None:
    """Log-evidence of the leading candidates above no cause, after the price of a second cause.

    None where no candidate was fitted.
    """
    fits = leading(found)[::-1]
    if not fits:
        return None
    figure, ((frame,),) = new_figure(7.0, 0.8 + 0.3 * len(fits))
    claimed = {fit.name for fit in set_members(found)}
    frame.barh(
        [shortened(fit.name) for fit in fits],
        [fit.priced_evidence - found.null.log_evidence for fit in fits],
        color=[COLOURS["extended"] if fit.name in claimed else DARK_GREY for fit in fits],
    )
    frame.set_xlabel("log-evidence above no cause (orange: what is claimed)")
    return figure


def distinguishability(found: Findings) -> Figure:
    """Map of the cosines between projected sensitivities."""
    names = [shortened(cause.name, _MAP_LABEL) for cause in found.problem.causes]
    size = 2.6 + 0.18 * len(names)
    figure, ((frame,),) = new_figure(size + 1.0, size)
    image = frame.imshow(found.cosines, vmin=0, vmax=1, cmap="viridis")
    frame.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
    frame.set_yticks(range(len(names)), names, fontsize=7)
    figure.colorbar(image, ax=frame, shrink=0.7, label="|cosine| after recalibration")
    return figure
