"""An optimised drive as one HTML page that needs no other file."""

from __future__ import annotations

from importlib import resources
from typing import Any

import jinja2

from stickslip import _core
from stickslip._util.handy_units import handy
from stickslip._util.plain_text import printable
from stickslip.control import optimum_figures as figures
from stickslip.control.landscape import ABOUT, NEAR, PLATEAU
from stickslip.control.optimum import ACTIVE, Optimum
from stickslip.control.sawtooth import POINTS
from stickslip.scenario.keys import known_keys
from stickslip.sweeping.results import NUMBERS


def page_text(found: Optimum) -> str:
    """The page as text."""
    source = resources.files("stickslip.control").joinpath("optimum.html").read_text("utf-8")
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda each: printable(each) if isinstance(each, str) else each,
    )
    keys = known_keys()
    return environment.from_string(source).render(
        found=found,
        goal=found.goal,
        compared=[
            (name, found.fresh[name], _row(found, name))
            for name in figures.COMPARED
            if name in found.fresh
        ],
        gain=_gain(found),
        limits=[_limit(found, name) for name in found.goal.limits],
        values=[(name, shown(value, _unit(name, found))) for name, value in found.values.items()],
        sawtooth=[
            (key, shown(value, keys[key].unit)) for key, value in (found.sawtooth or {}).items()
        ],
        slices=[
            (each, shown(each.best, each.axis.unit), f"{each.loss:.0%}") for each in found.slices
        ],
        grid=POINTS,
        about=ABOUT,
        near=f"{NEAR:.0%}",
        plateau=f"{PLATEAU:.0%}",
        active=f"{ACTIVE:.0%}",
        version=_core.__version__,
        waveform=figures.png(figures.waveform(found)),
        scores=figures.png(figures.scores(found)) if found.fresh else "",
        landscape=figures.png(figures.landscape(found)) if found.slices else "",
    )


def shown(value: float | str, unit: str) -> str:
    """A value with a handy unit."""
    if isinstance(value, str):
        return value
    factor, name = handy(unit)
    return f"{value * factor:.4g} {name}".rstrip()


def _unit(name: str, found: Optimum) -> str:
    return next((axis.unit for axis in found.space.axes if axis.name == name), "-")


def _row(found: Optimum, name: str) -> dict[str, str]:
    judged, goal = found.fresh[name], found.goal
    good = goal.sign * judged.figures
    return {
        "score": shown(judged.score, goal.unit),
        "mean": shown(float(judged.figures.mean()), goal.unit),
        "worst": shown(goal.sign * float(good.min()), goal.unit),
    }


def _gain(found: Optimum) -> str:
    """Ratio of the best's score to the sawtooth's on fresh draws, where it says something."""
    if "sawtooth" not in found.fresh or found.goal.sign < 0.0:
        return ""
    reference = found.fresh["sawtooth"].score
    return f"{found.fresh['best'].score / reference:.2f}" if reference > 0.0 else ""


def _limit(found: Optimum, name: str) -> dict[str, Any]:
    unit = NUMBERS[name].unit
    fresh = found.fresh.get("best")
    return {
        "name": name,
        "meaning": NUMBERS[name].meaning,
        "limit": shown(found.goal.limits[name], unit),
        "search": shown(found.judged.worst[name], unit),
        "fresh": "" if fresh is None else shown(fresh.worst[name], unit),
        "active": name in found.active,
    }
