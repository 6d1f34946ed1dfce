"""What a law outside the library looks like: its curve, and the formulas that are as right."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from reference.laws import ARGUMENTS, laws_of, total

Array = NDArray[np.float64]

_BELL = ("a (1 - exp(-(u / b)^2))", "a exp(-(u / b)^2)")
_LEVELLING = ("a (1 - exp(-|u| / b))", "a exp(-|u| / b)", "a u / (b + |u|)")
FORMULAS = {
    "power": ("a sqrt(|u|)",),
    "rise": _LEVELLING,
    "saturation": (*_BELL, *_LEVELLING),
    "gaussian": _BELL,
    "rational": _BELL,
    "hump": ("a (u / b) exp(1 - |u| / b)", "a exp(-((|u| - b) / c)^2)"),
    # Of the size of a sine, which begins with a corner: no square of one does.
    "sine": ("a |sin(u)|", *_LEVELLING),
}
"""Formulas that a diagnosis may propose and that are a law's form, or bend as it does.

The free constant of a law makes up for a level, so that what rises to 0 is what falls from it.
"""


def law_change(law: Mapping[str, Any], values: Array) -> Array:
    """How a hidden law changes what it is of, relative, at values of its argument of any sign."""
    words = tuple(str(law[key]) for key in ("target", "argument", "form"))
    # Angles have no scale.
    numbers = (law["amplitude"], law.get("scale", 1.0), law["exponent"])
    terms = getattr(laws_of([(*words, *numbers)]), words[0])
    at = np.zeros((len(values), len(ARGUMENTS)))
    at[:, ARGUMENTS.index(words[1])] = np.abs(values)
    return np.array([total(terms, row) for row in at])
