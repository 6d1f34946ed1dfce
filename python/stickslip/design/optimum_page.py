"""An optimised drive as one HTML page that needs no other file."""

from __future__ import annotations

from stickslip._util import html as html_page
from stickslip._util.units import handy
from stickslip.design import optimum_figures as figures
from stickslip.design.goal import FIGURES
from stickslip.design.landscape import ABOUT, NEAR, PLATEAU
from stickslip.design.optimum import ACTIVE, Optimum
from stickslip.design.sawtooth import POINTS
from stickslip.scenario.keys import known_keys


def page_text(found: Optimum) -> str:
    """The page as text."""
    result = found.as_dict()
    fresh = result["fresh"]
    return html_page.page_text(
        "design/optimum.html",
        found=found,
        goal=found.goal,
        fresh={name: fresh[name] for name in figures.COMPARED if name in fresh},
        gain=_gain(found),
        keys=known_keys(),
        numbers=FIGURES,
        shown=shown,
        share="{:.0%}".format,
        grid=POINTS,
        about=ABOUT,
        flight=result["airborne_fraction"],
        notes=found.run.notes,
        near=NEAR,
        plateau=PLATEAU,
        active=ACTIVE,
        waveform=html_page.png(figures.waveform(found)),
        scores=html_page.png(figures.scores(found)) if fresh else "",
        landscape=html_page.png(figures.landscape(found)) if found.slices else "",
    )


def shown(value: float | str, unit: str) -> str:
    """A value with a handy unit."""
    if isinstance(value, str):
        return value
    factor, name = handy(unit)
    return f"{value * factor:.4g} {name}".rstrip()


def _gain(found: Optimum) -> str:
    """Ratio of the best's score to the sawtooth's on fresh draws, where it says something."""
    if found.origin == "sawtooth" or "sawtooth" not in found.fresh or found.goal.sign < 0.0:
        return ""
    reference = found.fresh["sawtooth"].score
    return f"{found.fresh['best'].score / reference:.2f}" if reference > 0.0 else ""
