"""Laws hidden in a model of one's own, and what is said of them: ``python -m bench laws``.

The model is the sliding block of the tests, with free terms over speed, load and temperature.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from sliding_block import FRICTION, HIDDEN, measured, result

STRENGTHS = (1.0, 0.5)


def hidden(seeds: range) -> None:
    """Of each law: how often a curve is accepted and where, its band, and its formulas."""
    for term, (law, at) in HIDDEN.items():
        for strength in STRENGTHS:
            held: list[bool] = []
            forms: Counter[str] = Counter()
            elsewhere = 0
            for seed in seeds:
                found: Any = result(measured(seed, 1.0 + strength * law(at)), seed=seed).open_set
                if found is None or not found.accepted:
                    continue
                if found.first.term.name != term.name:
                    elsewhere += 1
                    continue
                curve = found.curve
                truth = FRICTION * (1.0 + strength * law(curve.argument))
                held.append(bool(np.all((curve.low <= truth) & (truth <= curve.high))))
                forms["none" if found.formula is None else found.formula.text] += 1
            print(
                f"{term.name} x {strength:g}: accepted {len(held) + elsewhere} of {len(seeds)}, "
                f"elsewhere {elsewhere}, whole law in band {sum(held)}, "
                + ", ".join(f"{count} {text}" for text, count in forms.most_common()),
                flush=True,
            )


def nothing(seeds: range) -> None:
    """Without a hidden law: false alarms, and curves that are claimed."""
    found = [result(measured(seed), seed=seed) for seed in seeds]
    alarms = sum(each.verdict.kind != "none" for each in found)
    claimed = sum(each.open_set is not None and each.open_set.accepted for each in found)
    print(f"nothing hidden: {alarms} alarms and {claimed} claimed curves of {len(seeds)}")


def main() -> None:
    """Print a line for each law and strength, and one without a law."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=15, help="data sets of a law and strength")
    parser.add_argument("--without", type=int, default=200, help="data sets without a law")
    options = parser.parse_args()
    hidden(range(100, 100 + options.seeds))
    nothing(range(options.without))


if __name__ == "__main__":
    main()
