"""The three figures of a report and of `Diagnosis.plot`.

Readings are black; the stated model is grey, the recalibrated one blue; the extended one, and what
is claimed, vermilion in all of them. What is nearest without a claim is dark grey.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from stickslip._util.arrays import Array, Indices
from stickslip._util.palette import BLACK, BLUE, DARK_GREY, GREY, LIGHT_GREY, VERMILION
from stickslip._util.picture import PLAIN, Picture
from stickslip._util.text import shortened
from stickslip._util.units import handy, in_handy_units
from stickslip.diagnosis.data.settings import ROW
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.report.sections.size import law_of
from stickslip.errors import ScenarioError

_COLOURS = {"stated": GREY, "recalibrated": BLUE, "extended": VERMILION, "nearest": DARK_GREY}
_MARKERS, _MOST_PANELS = "osD^v<>Ph*", 8
_WIDTH = 4.9  # of a panel, inches: its letters can be read on a telephone
_FEW = 3  # places of a setting below which nothing is seen over it
_SAMPLES = 200  # points of a group from which on there are no signs and bars
_STRETCHES = 1000  # of a long line, its least and largest points; chosen: half a dot of a page
# Places between readings at which models are computed, and how far a model may be from what it is
# known to predict at the readings, in their errors. Chosen: a smooth curve; no visible step.
_BETWEEN, _SAME = 25, 0.3


@dataclass(frozen=True)
class Panel:
    """Rows of a table in one picture over a setting, in groups by the others in words.

    `groups` are rows of the problem in the order of the setting.
    """

    title: str
    table: int
    over: str
    groups: dict[str, Indices]
    markers: dict[str, str]


class Plots:
    """Pictures of a diagnosis, each a matplotlib figure."""

    def __init__(self, facts: Facts) -> None:
        self._facts, self._tables = facts, facts.problem.tables

    @matplotlib.rc_context(PLAIN)
    def fit(self, table: int = 0) -> Figure | None:
        """Readings and models of a table over the setting that varies most.

        Of a table that has no setting its own picture, or None.
        """
        shown = self._table(table)
        if not shown.drawable:
            looks = {self._label(name): (_COLOURS[name], candidate.values()[0])
                     for name, candidate in self._facts.candidates.items()}  # fmt: skip
            return shown.figure(self._facts.problem.names, looks) if looks else None
        return self._drawn(self._panels(table), False)

    @matplotlib.rc_context(PLAIN)
    def residuals(self, table: int | None = None) -> Figure:
        """Residuals of both models of a table, over the setting that shows the cause best.

        If not given, of the table in which the cause improves the fit most, or most misfit is left.
        """
        k = self.main_table() if table is None else table
        self._table(k)
        return self._drawn(self._panels(k, True), True)

    @matplotlib.rc_context(PLAIN)
    def law(self) -> Figure | None:
        """The curve of a claimed law of a free shape with its band; None where there is none."""
        law = law_of(self._facts.best) if self._facts.fitted else None
        if law is None:
            return None
        figure = Picture(figsize=(_WIDTH, 3.2), layout="constrained")
        axes = figure.subplots()
        axes.spines[["top", "right"]].set_visible(False)
        axes.fill_between(law["at"], law["low"], law["high"], color=LIGHT_GREY, label="95 %")
        axes.plot(law["at"], law["value"], color=VERMILION, label=law["form"])
        unit = "" if law["law_unit"] == "-" else f" ({law['law_unit']})"
        axes.set(xlabel=f"{law['argument']} ({law['unit']})", ylabel=law["law"] + unit)
        axes.legend(frameon=False)
        return figure

    def of_tables(self) -> dict[str, Figure | None]:
        """The figures of all tables by the names of their files, and that of a law."""
        if not self._facts.fitted:
            return {}
        figures: dict[str, Figure | None] = {}
        for k, name in enumerate(self._facts.problem.table_names):
            figures[f"fit-{name}"] = self.fit(k)
            if self._tables[k].drawable:
                figures[f"residuals-{name}"] = self.residuals(k)
        return figures | {"law": self.law()}

    @matplotlib.rc_context(PLAIN)
    def of_page(self) -> dict[str, Any]:
        """Figures as narrow as a telephone: `change`, a `fit` of each table by name, and `law`.

        Each panel of `residuals` and of `fit` is one by itself.
        """

        def each(k: int, change: bool) -> list[Figure | None]:
            if not self._tables[k].drawable:
                return [] if change else [self.fit(k)]
            return [self._drawn([panel], change) for panel in self._panels(k, change)]

        fits = {name: each(k, False) for k, name in enumerate(self._facts.problem.table_names)}
        change = each(self.main_table(), True) if self._facts.fitted else []
        return {"change": change, "fit": fits, "law": [self.law()]}

    # ---------------------------------------------------------------- panels of a table
    def _panels(self, k: int, change: bool = False) -> list[Panel]:
        """Those over the setting that varies most, or that shows a change by the cause best."""
        settings = self._tables[k].named_settings
        return self.panels(k, self._best_setting(k) if change else settings.most_varied)

    def _drawn(self, panels: Sequence[Panel], change: bool) -> Figure:
        """A figure with all panels, two in a row, and one legend."""
        base = self._predicted.get("recalibrated") if change else None
        columns = min(len(panels), 2)
        rows = math.ceil(len(panels) / columns)
        size = _WIDTH * columns, 0.8 + 3.0 * rows
        figure = Picture(figsize=size, layout="constrained")
        frames = figure.subplots(rows, columns, squeeze=False).ravel()
        shown: dict[str, Any] = {}
        for axes, panel in zip(frames, panels, strict=False):
            self._draw(axes, panel, base)
            handles, labels = axes.get_legend_handles_labels()
            shown |= {label: handle for handle, label in zip(handles, labels, strict=True)}
        for axes in frames[len(panels) :]:
            axes.remove()
        words = [shortened(word, 50) for word in shown]
        columns = int(9.0 * size[0] / (max(map(len, words), default=1) + 7))
        figure.legend(list(shown.values()), words, loc="outside lower center",
                      ncols=min(max(columns, 1), 4), frameon=False, fontsize=9)  # fmt: skip
        return figure

    def panels(self, k: int, over: str) -> list[Panel]:
        """Rows of a table by words in panels, and by other settings in groups.

        A group is told by the settings in which it differs from most rows, and has the same marker
        in all panels.
        """
        settings, first = self._tables[k].named_settings, self._facts.problem.rows[k].start
        others = [name for name in settings.varied if name != over]
        words = [name for name in others if settings.is_word(name)]
        usual = {n: value for n, value in settings.usual.items() if n != over}
        by_panel: dict[str, dict[str, list[int]]] = {}
        for row in np.argsort(settings.along(over)[0], kind="stable").tolist():
            panel = " ".join(settings[name][0][row] for name in words)
            group = ", ".join(
                settings.text(name, settings[name][0][row])
                for name, value in usual.items()
                if settings[name][0][row] != value
            )
            by_panel.setdefault(panel, {}).setdefault(group, []).append(first + row)
        names = sorted({group for groups in by_panel.values() for group in groups})
        if len(names) > len(_MARKERS):
            # Too many to tell apart: all rows alike.
            by_panel = {panel: {"": sorted(row for rows in groups.values() for row in rows)}
                        for panel, groups in by_panel.items()}  # fmt: skip
            names = [""]
        markers = dict(zip(names, _MARKERS, strict=False))
        panels = []
        for title in sorted(by_panel)[:_MOST_PANELS]:
            groups = {n: np.array(by_panel[title][n]) for n in names if n in by_panel[title]}
            panels.append(Panel(title, k, over, groups, markers))
        return panels

    def main_table(self) -> int:
        """The table in which the cause improves the fit most, or most misfit is left."""
        problem, models = self._facts.problem, list(self._facts.candidates.values())
        if not models:
            return 0
        chi2 = [problem.chi2_of_tables(model.fit.residual[None, :])[:, 0] for model in models]
        fall = chi2[0] - chi2[1] if len(chi2) > 1 else chi2[0]
        return int(np.argmax(np.where([one.drawable for one in self._tables], fall, -np.inf)))

    @cached_property
    def _predicted(self) -> dict[str, Array]:
        curves, subject = dict(self._facts.at_readings), self._facts.verdict.subject
        if subject is not None and "extended" not in curves:
            curves["nearest"] = self._facts.problem.y - subject.residual
        return curves

    def _between(self, panel: Panel, rows: Indices) -> tuple[Array, dict[str, tuple[Array, Array]]]:
        """Places along a setting with predictions and their sd; none where a model has none.

        Only at conditions that differ in this setting alone, and where the model is at the readings
        what it is known to be: one of the user's own may know its own table only.
        """
        facts, table, over = self._facts, self._tables[panel.table], panel.over
        part = facts.problem.rows[panel.table]
        settings = table.named_settings
        whole = settings.along(over)[0]
        at = whole[rows - part.start]
        others = [n for n in settings.varied if n != over]
        alone = all(len({settings[n][0][row - part.start] for row in rows}) == 1 for n in others)
        if over == ROW or not alone or not np.ptp(at) > 0.0:
            return at, {}
        # Groups share their places, so that equal curves are one.
        grid = np.linspace(whole.min(), whole.max(), _BETWEEN)
        places = np.union1d(at, grid[(grid > at.min()) & (grid < at.max())])
        given = table.elsewhere(int(rows[0]) - part.start, over, places)
        if given is None:
            return at, {}
        try:
            made = facts.predict(given)
        except Exception:  # whatever the user's own model raises where it knows its table only
            return at, {}
        known = np.searchsorted(places, at)
        bands = {}
        for name in facts.candidates:
            level, sd = made[name].to_numpy(), made[f"{name}_sd"].to_numpy()
            apart = np.abs(level[known] - self._predicted[name][rows])
            if not np.all(apart <= _SAME * facts.problem.sd[rows]):
                return at, {}
            bands[name] = level, sd
        return places, bands

    def _label(self, name: str) -> str:
        verdict = self._facts.verdict
        if name not in ("extended", "nearest") or verdict.subject is None:
            return f"{name} model"
        title = self._facts.words.title(verdict.subject.name)
        return f"{'nearest, ' if name == 'nearest' else ''}with {title}"

    def _table(self, number: int) -> Table:
        if not 0 <= number < len(self._tables):
            count = len(self._tables)
            raise ScenarioError(f"table = {number}: allowed is 0 to {count - 1}")
        return self._tables[number]

    def _best_setting(self, k: int) -> str:
        """The setting over which the change by the cause is smoothest; else that varies most.

        By von Neumann's ratio: squared differences of neighbours beside the variance.
        """
        settings, part = self._tables[k].named_settings, self._facts.problem.rows[k]
        curves, change = self._predicted, np.zeros(0)
        if "extended" in curves:
            change = (curves["extended"] - curves["recalibrated"])[part]
        if not len(change) or not np.var(change) > 0.0:
            return settings.most_varied
        ratios: dict[str, float] = {}
        most = max((len(set(settings[name][0])) for name in settings.numeric), default=0)
        for name in settings.numeric:
            parts = self.panels(k, name)
            rows = [rows - part.start for panel in parts for rows in panel.groups.values()]
            steps = [np.diff(change[group]) for group in rows if len(group) >= _FEW]
            # Over a setting with few values nothing is seen.
            if steps and len(set(settings[name][0])) >= max(_FEW, most / 2):
                ratios[name] = float(np.mean(np.concatenate(steps) ** 2) / np.var(change))
        return min(ratios, key=lambda name: ratios[name]) if ratios else settings.most_varied

    def _draw(self, axes: Any, panel: Panel, base: Array | None) -> None:
        """Readings and models, or what they are beyond `base`: curves where they are computed."""
        facts, table = self._facts, self._tables[panel.table]
        part, (at, unit) = facts.problem.rows[panel.table], table.named_settings.along(panel.over)
        at = at * handy(unit)[0]
        first = next(iter(panel.groups.values()))[0]
        what = table.name or "reading"
        factor, shown = table.shown_unit(int(first) - part.start)
        label = what if base is None else f"difference of {what}"
        label += f" ({shown})" if shown else ""
        below, groups = np.zeros(len(facts.problem.y)) if base is None else base, panel.groups
        if base is None and table.less is not None:  # both sides, whose differences are fitted
            before, order = table.less
            k, groups = np.concatenate([*groups.values()]) - part.start, {}
            for word, more, colour in (("before", 0.0, GREY), ("after", table.mean, BLACK)):
                y = (before.mean[order] + more)[k] * factor
                drawn = _outline(at[k], y)
                axes.plot(*drawn, "." if len(drawn[0]) == len(y) else "-", color=colour, label=word)
        for group, rows in groups.items():
            x, marker = at[rows - part.start], panel.markers[group]
            y = (facts.problem.y - below)[rows] * factor
            dense = len(rows) > _SAMPLES
            known = not dense and facts.problem.errors[panel.table].known
            bars = 2.0 * facts.problem.sd[rows] * factor if known else None
            drawn = _outline(x, y)
            dots = "." if len(drawn[0]) == len(x) else "-"  # two rows of dots would look as two
            axes.errorbar(*drawn, bars, fmt=dots if dense else marker, color=BLACK, lw=1.1,
                          ms=2.0 if dense else 4.5, label=group or "measured",
                          zorder=1 if dense else 3)  # fmt: skip
            places, curves = self._between(panel, rows)
            places = places * handy(unit)[0]
            for name, of in self._predicted.items():
                if base is not None and name in ("stated", "recalibrated"):
                    continue
                look = {"color": _COLOURS[name], "lw": 1.6, "label": self._label(name)}
                if name not in curves:
                    # Dots lead the eye along an order; nothing was computed between the readings.
                    dots = "-" if dense else ":" if np.all(np.diff(x) > 0.0) else "none"
                    line = _outline(x, (of - below)[rows] * factor)
                    axes.plot(*line, ls=dots, ms=8, mew=1.6, marker="" if dense else "_", **look)
                    continue
                level, sd = curves[name]
                level = level - (0.0 if base is None else curves["recalibrated"][0])
                axes.plot(places, level * factor, **look)
                ends = [(level + k * sd) * factor for k in (-1.96, 1.96)]
                axes.fill_between(places, *ends, color=_COLOURS[name], alpha=0.2, lw=0)
        if base is not None:
            axes.axhline(0.0, color=_COLOURS["recalibrated"], lw=1.6,
                         label=self._label("recalibrated"))  # fmt: skip
        axes.set_xlabel(in_handy_units(panel.over, unit)[1])
        axes.set_ylabel(label)
        axes.set_title(panel.title, fontsize=11, fontweight="bold")
        axes.margins(x=0.07, y=0.12)
        plain_axes(axes)


def _outline(x: Array, y: Array) -> tuple[Array, Array]:
    """A line through the least and the largest point of each stretch along x; of few points all of
    them.
    """
    if len(y) <= 4 * _STRETCHES:
        return x, y
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    parts = np.array_split(np.arange(len(y)), _STRETCHES)
    kept = np.unique([part[pick(y[part])] for part in parts for pick in (np.argmin, np.argmax)])
    return x[kept], y[kept]


def plain_axes(axes: Any) -> None:
    """A grid, and no frame where no axis is."""
    axes.grid(color=LIGHT_GREY, lw=0.6)
    axes.spines[["top", "right"]].set_visible(False)
