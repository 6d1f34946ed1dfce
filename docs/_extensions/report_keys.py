"""What the keys of report.json mean: the docstrings of the sections' numbers."""

from __future__ import annotations

import ast
import inspect
import itertools
from typing import get_args

from stickslip.diagnosis.decision.verdict import Kind
from stickslip.diagnosis.fitting.forms import PRIOR
from stickslip.diagnosis.report import numbers
from stickslip.diagnosis.report.sections.misfit import Side

WORDS = {"verdict": get_args(Kind), "form": tuple(PRIOR), "side": get_args(Side)}
"""Words that a value of that name can be."""


def reference() -> dict[str, str]:
    """The meaning of each key of the dictionary, in Markdown."""
    texts: dict[str, str] = {}
    for section in (*numbers.ALWAYS, *numbers.FITTED):
        (of,) = ast.parse(inspect.getsource(section.Numbers)).body
        for key, text in itertools.pairwise(of.body):
            if isinstance(key, ast.AnnAssign) and isinstance(text, ast.Expr):
                texts[ast.unparse(key.target)] = " ".join(ast.literal_eval(text.value).split())
    for name, words in WORDS.items():
        listed = ", ".join(f"`{word}`" for word in words)
        texts = {key: text.replace(f"<{name}>", listed) for key, text in texts.items()}
    return texts
