"""Redo the paper's simulations, test its statements S1 to S17, and draw its figures.

All settings of a grid of what the paper leaves open are tried, to say for each statement for which
share of them it holds. The status is 1 where a verdict, a share or the settings of the figures
differ from what is stored here.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from paper.figures import (
    CURVES,
    FIGURES,
    MOTIONS,
    curve_table,
    draw_curves,
    draw_motion,
    motion_table,
    reference_runs,
)
from paper.statements import judge
from paper.walks import GRID, Setting, settings_table, survey
from stickslip import plot
from stickslip.cli.output import write_frame

OUT = Path(__file__).resolve().parents[1] / "results" / "paper"

# Simulations with small changes of frequency, friction and field for each point. Chosen.
OF_SURVEY, OF_FIGURES = 3, 20

# Verdict and share of the pairs of settings, NaN where settings do not enter.
STORED = {
    "S1": ("depends", 0.444), "S2": ("depends", 0.393), "S3": ("depends", 0.174),
    "S4": ("depends", 0.445), "S5": ("depends", 0.295), "S6": ("depends", 0.656),
    "S7": ("depends", 0.688), "S8": ("not reproduced", 0.087), "S9": ("depends", 0.600),
    "S10": ("depends", 0.430), "S11": ("depends", 0.267), "S12": ("depends", 0.603),
    "S13": ("not reproduced", 0.005), "S14": ("reproduced", 0.934), "S15": ("depends", np.nan),
    "S16": ("reproduced", np.nan), "S17": ("not reproduced", np.nan),
}  # fmt: skip
REFERENCE = {
    "IPP": "sudden rise, clamp down, base 1 mT, hold 1.5 mT",
    "OPP": "sudden rise, clamp up, base 0 mT, hold 2.5 mT",
}
SHARE_TOLERANCE = 0.01  # another compiler may round a pair or two of settings in another way


def in_words(numbers: dict[str, float]) -> str:
    """The numbers of a statement in one line."""
    return ", ".join(f"{name} {value:.3g}" for name, value in numbers.items())


def summary(statements: pd.DataFrame, reference: dict[str, Setting]) -> str:
    """The settings of the figures and the table of statements as text."""
    lines = [f"{mode}  {setting}" for mode, setting in reference.items()]
    for row in statements.itertuples():
        share = "" if np.isnan(row.share) else f"; holds for {row.share:.1%} of pairs"
        depends = row.settings and f", most often with {row.settings}"
        lines += ["", f"{row.statement:<4} {row.text}"]
        lines += [f"     {row.verdict}{share}{depends}", f"     {in_words(row.numbers)}"]
    return "\n".join(lines)


def differences(statements: pd.DataFrame, reference: dict[str, Setting]) -> list[str]:
    """What differs from what is stored, a line each."""
    lines = [
        f"{mode}: {setting}; stored is: {REFERENCE[mode]}"
        for mode, setting in reference.items()
        if str(setting) != REFERENCE[mode]
    ]
    for row in statements.itertuples():
        verdict, share = STORED[row.statement]
        same = np.isclose(row.share, share, rtol=0.0, atol=SHARE_TOLERANCE, equal_nan=True)
        if row.verdict != verdict or not same:
            found = f"{row.verdict}, share {row.share:.3f}"
            lines.append(f"{row.statement}: {found}; stored is: {verdict}, share {share:.3f}")
    return lines


def read_points(path: Path) -> pd.DataFrame:
    """Digitised points to draw over Figs. 8 to 15, with the columns of `draw_curves`."""
    try:
        points = pd.read_csv(path)
    except OSError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if missing := {"figure", "mode", "x", "y"}.difference(points):
        raise argparse.ArgumentTypeError(f"{path}: the column {min(missing)} is missing")
    for figure, mode in zip(points["figure"], points["mode"], strict=True):
        if figure not in CURVES or mode not in CURVES[figure].modes:
            allowed = ", ".join(f"{name} {'/'.join(CURVES[name].modes)}" for name in CURVES)
            text = f"{path}: {figure} {mode}: allowed is one of {allowed}"
            raise argparse.ArgumentTypeError(text)
    return points


def main() -> int:
    """Make the tables and pictures; 1 if a statement is judged otherwise than before."""
    parser = argparse.ArgumentParser(prog="python -m bench paper", description=__doc__)
    what = "folder of figures (PNG and CSV), statements.csv and settings.csv"
    parser.add_argument("--out", type=Path, default=OUT, help=what)
    how: Any = {"nargs": "+", "choices": FIGURES, "metavar": "FIGURE", "default": FIGURES}
    parser.add_argument("--only", **how, help=f"of {', '.join(FIGURES)}")
    parser.add_argument("--points", type=read_points, help="CSV with figure, mode, x and y, SI")
    parser.add_argument("--threads", type=int, help="by default as many as processors")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    walks = survey(GRID, OF_SURVEY, options.threads)
    statements, reference = judge(walks)
    words = statements["numbers"].map(in_words)
    write_frame(statements.assign(numbers=words), options.out / "statements.csv")
    write_frame(settings_table(walks), options.out / "settings.csv")
    runs = reference_runs(reference, options.threads)
    for name in options.only:
        if name in MOTIONS:
            run = runs[MOTIONS[name][0]]
            table, figure = motion_table(name, run), draw_motion(name, run)
        else:
            table = curve_table(name, reference, OF_FIGURES, options.threads)
            figure = draw_curves(name, table, options.points)
        write_frame(table, options.out / f"{name}.csv")
        plot.save(figure, options.out / f"{name}.png")
    print(summary(statements, reference), f"{len(options.only)} figures: {options.out}", sep="\n")
    different = differences(statements, reference)
    for line in different:
        print(f"different: {line}", file=sys.stderr)
    return int(bool(different))


if __name__ == "__main__":
    sys.exit(main())
