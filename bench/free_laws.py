"""Laws hidden in a model of one's own, and what is said of them: ``python -m bench laws``.

The model is the sliding block of the tests, with free laws over speed, load and temperature.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from drawn_law import drawn

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from sliding_block import FRICTION, HIDDEN, measured, result
from stickslip.diagnosis.result import CLAIMS

STRENGTHS = (1.0, 0.5)
_POINTS = 61  # of a curve


def hidden(seeds: range) -> None:
    """Of each law: how often it is claimed, by itself or in a set, and whether its band holds."""
    for law, (truth, at) in HIDDEN.items():
        for strength in STRENGTHS:
            held: list[bool] = []
            forms: Counter[str] = Counter()
            elsewhere = among = 0
            for seed in seeds:
                found = result(measured(seed, 1.0 + strength * truth(at)), seed=seed)
                causes = found.verdict.causes
                if found.verdict.kind not in CLAIMS:
                    among += law.name in causes
                elif causes != (law.name,):
                    elsewhere += 1
                else:
                    u = np.linspace(law.curve.low, law.curve.high, _POINTS)
                    # The law of the result knows its constant.
                    own = next(each for each in found.best.fit.causes if each.name == law.name)
                    low, high, formula = drawn(found, own, u)
                    whole = FRICTION * (1.0 + strength * truth(u))
                    held.append(bool(np.all((low <= whole) & (whole <= high))))
                    forms["none" if formula is None else formula.text] += 1
            print(
                f"{law.name} x {strength:g}: claimed {len(held)} of {len(seeds)}, "
                f"elsewhere {elsewhere}, in a set {among}, whole law in band {sum(held)}, "
                + ", ".join(f"{count} {text}" for text, count in forms.most_common()),
                flush=True,
            )


def nothing(seeds: range) -> None:
    """Without a hidden law: false alarms, and laws that are claimed."""
    found = [result(measured(seed), seed=seed).verdict.kind for seed in seeds]
    alarms = sum(each != "none" for each in found)
    claimed = sum(each in CLAIMS for each in found)
    print(f"nothing hidden: {alarms} alarms and {claimed} claimed laws of {len(seeds)}")


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
