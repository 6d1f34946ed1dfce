"""Field maps in each arrangement of columns that is not theirs: how many are taken for sound.

Places and components of a map of five coils stand in 48 arrangements each, of signs and orders: in
all 2304 pairs, of which one is as given. Each pair has coils and errors of its own.
``python -m bench arrangements --seed 0 --noise 0.01`` counts those that are refused, and those
whose message names the exchange that makes the map sound.
"""

from __future__ import annotations

import argparse
import itertools
from collections import Counter

import numpy as np
from blind.scoring import interval

from stickslip import Coils, FieldMap, ScenarioError

SIGNED = [
    np.diag(signs)[list(order)]
    for order in itertools.permutations(range(3))
    for signs in itertools.product((1.0, -1.0), repeat=3)
]


def said(random: np.random.Generator, noise: float, first: int, second: int) -> str:
    """What is said of a map whose places and components are in two arrangements."""
    distance = random.uniform(0.06, 0.12, 5)
    coils = Coils(random.uniform(0.1, 0.2, 5), distance, random.uniform(200.0, 600.0, 5))
    half = float(distance.min()) * random.uniform(0.05, 0.12, 3)
    axes = [np.linspace(-each, each, 4) for each in half]
    places = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
    fields = np.stack([coils.field(places, one) for one in np.eye(5)], axis=1)
    size = np.linalg.norm(fields, axis=2).mean(axis=0)[:, None]
    fields = fields + noise * size * random.standard_normal(fields.shape)
    try:
        FieldMap.from_points(places @ SIGNED[first].T, fields @ SIGNED[second].T)
    except ScenarioError as error:
        return "refused, exchange named" if "would fit" in str(error) else "refused"
    return "taken"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--noise", type=float, default=0.01, help="relative, of each component")
    options = parser.parse_args()
    kinds = {"one of them": Counter(), "both, alike": Counter(), "both, that differ": Counter()}
    for first, second in itertools.product(range(len(SIGNED)), repeat=2):
        what = said(np.random.default_rng([options.seed, first, second]), options.noise,
                    first, second)  # fmt: skip
        if first == second == 0:
            print(f"as given: {what}")
            continue
        kind = "both, alike" if first == second else "both, that differ"
        kinds["one of them" if 0 in (first, second) else kind][what] += 1
    for kind, found in kinds.items():
        total = found.total()
        for what, count in sorted(found.items()):
            low, high = interval(count, total)
            print(f"{kind:20}{what:26}{count:6} of {total} ({low:.2%} to {high:.2%})")


if __name__ == "__main__":
    main()
