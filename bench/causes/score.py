"""Counts of answers beside the truth."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scores import Answer, table


def judged(answer: dict[str, Any], truth: dict[str, Any]) -> Answer:
    """An answer beside what is hidden of what is listed."""
    hidden = [truth["cause"]] if truth["cause"] and truth["listed"] else []
    return Answer(answer["said"], answer["causes"], hidden)


def counts(tools: dict[str, dict[str, dict[str, Any]]], truths: dict[str, Any]) -> str:
    """The counts of each group of sets and tool, by the answers of each, in Markdown."""
    belongs: dict[str, Callable[[dict[str, Any]], Any]] = {
        "nothing hidden": lambda t: not t["cause"],
        "one cause": lambda t: t["cause"] and t["listed"] and not t["model_error"],
        "and a model error": lambda t: t["cause"] and t["listed"] and t["model_error"],
        "cause not listed": lambda t: t["cause"] and not t["listed"],
    }
    groups = {
        f"{'walkers: ' * walks}{what}, {tool}": [
            judged(answers[name], truth) for name, truth in truths.items()
            if name in answers and belongs[what](truth) and name.startswith("walker") is walks
        ]
        for walks in (False, True) for what in belongs for tool, answers in tools.items()
    }  # fmt: skip
    costs = (
        f"{tool} {np.median([each['cpu'] for each in answers.values()]):.1f} s"
        for tool, answers in tools.items()
    )
    return f"{table(groups)}\n\nCPU of an answer, median: {', '.join(costs)}."
