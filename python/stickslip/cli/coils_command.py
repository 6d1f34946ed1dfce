"""``stickslip coils``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click

from stickslip.cli import options, output
from stickslip.design.coil_facts import UNITS, CoilFacts, coil_facts, dimension_changes
from stickslip.scenario.scenario import load_with
from stickslip.simulation.notes import scenario_notes, shown_lines

_SHOWN = {
    "field": ("field at the centre", 1e3, "mT/A"),
    "gradient": ("gradient there", 1e3, "mT/m/A"),
    "fringe": ("across the axis", 100.0, "% of the field, in 5 mm"),
    "rise_time": ("rise time L/R", 1e3, "ms"),
    "resonance": ("rings at", 1.0, "Hz, with its capacitor"),
    "most_current": ("amplifier: current", 1.0, "A"),
    "most_field": ("amplifier: field", 1e3, "mT"),
    "most_swing": ("amplifier: swing", 1e3, "mT, of a sawtooth at drive.frequency"),
}

_CODES = {"map-background", "map-turned", "window-short", "pulses-short", "capacitor", "voltage"}
"""Notes that concern coils, beside that with the name of their map."""


@click.command(
    "coils",
    help="""Tell what the coils and amplifiers of SCENARIO can do.

    For each coil: field and gradient per ampere at the centre, the field across its axis, the rise
    time, current and heat of the drive, the largest field that an amplifier makes, and what 5 %
    more in each dimension changes.
    """,
    epilog="\b\nExample:\n  stickslip coils robot.toml --volts 24 --amperes 3 --plot coils.png",
)
@click.argument("scenario", type=options.PATH)
@options.SET
@click.option("--volts", type=float, help="Most that an amplifier gives, V.")
@click.option("--amperes", type=float, help="Most that an amplifier gives, A.")
@options.plot_option("fields and currents")
@options.JSON
def command(
    scenario: Path,
    set: dict[str, Any],
    volts: float | None,
    amperes: float | None,
    plot: Path | None,
    as_json: bool,
) -> int:
    loaded, read = load_with(scenario, set)
    output.check_files(read, plot=(plot, ()))
    facts = coil_facts(loaded, volts, amperes)
    changes = {name: dimension_changes(loaded, name) for name in facts}
    notes = [note for note in scenario_notes(loaded) if note.code in {*_CODES, "map"}]
    if as_json:
        rows = {name: {**coil._asdict(), "changes": changes[name]} for name, coil in facts.items()}
        output.print_json({"units": UNITS, "coils": rows, "notes": [n.as_dict() for n in notes]})
    else:
        _print(facts, changes)
        for line in shown_lines(notes):
            click.echo(f"note: {line}")
    return 0 if output.drawn("--plot", plot, output.save_plot("coil_lines", loaded)) else 1


def _print(facts: dict[str, CoilFacts], changes: dict[str, dict[str, dict[str, float]]]) -> None:
    """Coils that are alike together, and what each does in the drive."""
    groups: dict[str, list[str]] = {}
    for name, coil in facts.items():
        groups.setdefault(_text(coil, changes[name]), []).append(name)
    for text, names in groups.items():
        click.echo(f"{' '.join(names)}\n{text}")
    click.echo("the highest voltages of the drive, held")
    for name, coil in facts.items():
        if coil.current:
            text = f"{coil.current:.4g} A, {coil.power:.3g} W"
            if not math.isnan(coil.heating):
                text += f", {coil.heating:.2g} K/s at first where the wire is of copper"
            click.echo(f"    {name:<20} {text}")


def _text(facts: CoilFacts, changes: dict[str, dict[str, float]]) -> str:
    lines = []
    for name, (words, factor, unit) in _SHOWN.items():
        value = factor * getattr(facts, name)
        if not math.isnan(value):
            lines.append(f"    {words:<20} {value:.4g} {unit}")
    for dimension, parts in changes.items():
        texts = [
            f"{n.replace('_', ' ')} {100 * p:+.2g} %" for n, p in parts.items() if abs(p) > 1e-9
        ]
        lines.append(f"    {'5 % more ' + dimension:<20} {', '.join(texts)}")
    return "\n".join(lines)
