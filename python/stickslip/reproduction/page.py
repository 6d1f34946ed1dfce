"""The study as one HTML page that needs nothing else: no network, no script, no other file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from stickslip._util import html as html_page
from stickslip.reproduction.curves import CURVES, MeasuredPoint
from stickslip.reproduction.motions import MOTIONS
from stickslip.reproduction.points import SPREAD
from stickslip.reproduction.tables import headings

if TYPE_CHECKING:
    from stickslip.reproduction.study import Reproduction

_MARKS = {"reproduced": "yes", "not reproduced": "no", "depends": "some"}
_PLURALS = {
    "reproduced": "reproduced",
    "not reproduced": "not reproduced",
    "depends": "depend on what is left open",
}
_NOTES = {
    "failed": "{} simulations failed and are left out.",
    "painleve_events": "{} Painlevé events were met.",
}


def page_text(result: Reproduction, measured: Sequence[MeasuredPoint]) -> str:
    """The page as text."""
    verdicts: list[str] = [each.verdict.word for each in result.statements]
    return html_page.page_text(
        "reproduction/page.html",
        result=result,
        marks=_MARKS,
        counts=[f"{verdicts.count(word)} {_PLURALS[word]}" for word in _MARKS],
        figures=[_figure(name, result, measured) for name in result.figures],
        spread=f"{SPREAD:.0%}",
        seconds=f"{result.seconds:.0f}",
        tried=len(result.settings["mode"]),
    )


def _figure(name: str, result: Reproduction, measured: Sequence[MeasuredPoint]) -> dict[str, Any]:
    table = result.tables[name]
    if name in MOTIONS:
        modes: tuple[str, ...] = (MOTIONS[name].mode,)
        caption = MOTIONS[name].caption
        if name in ("fig5", "fig7") and result.reference[MOTIONS[name].mode].clamp == "up":
            caption += " With the clamp up the tilt is negative: an upstroke goes down here."
    else:
        modes, caption = CURVES[name].modes, CURVES[name].caption
        count = sum(point.figure == name for point in measured)
        caption += f" {count} measured points from a file." if count else ""
    counts = {name: int(table[name].sum()) for name in _NOTES if name in table}
    return {
        "name": name,
        "title": "Fig. 2 (e) to (h)" if name == "fig2" else f"Fig. {name.removeprefix('fig')}",
        "picture": html_page.in_base64(result.figures[name].read_bytes()),
        "caption": caption,
        "settings": "; ".join(
            f"{mode}: {setting.text()}"
            for mode, setting in result.reference.items()
            if mode in modes
        ),
        "columns": ", ".join(headings(table)),
        "notes": [text.format(counts[name]) for name, text in _NOTES.items() if counts.get(name)],
    }
