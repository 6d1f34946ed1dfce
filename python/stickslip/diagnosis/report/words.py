"""Words of a report's page, and what they mean; a page defines those that it uses."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Word:
    """A word of the field.

    Attributes
    ----------
    name : str
    pattern : str
        Regular expression of what a page says where it uses the word.
    meaning : str
        Full sentences; the first goes on after the name and a colon.
    """

    name: str
    pattern: str
    meaning: str


WORDS = (
    Word(
        "Recalibrated",
        "recalibrat",
        "the uncertain constants were fitted within what is known of them, without a cause.",
    ),
    Word(
        "Extended",
        "extended model|>extended<",
        "the recalibrated model with the cause, or the pair of causes, fitted anew together.",
    ),
    Word(
        "Condition",
        "condition",
        "one setting of the drive at which velocities were measured, or one reading of another "
        "kind. Its repeats are trials.",
    ),
    Word(
        "Set-up",
        "set-ups?\\b",
        "one assembly of the apparatus, the column block of a table: what was measured without "
        "taking anything apart.",
    ),
    Word(
        "Chi-square",
        "chi-square",
        "squared errors in units of the noise, summed; about 1 per condition is noise alone.",
    ),
    Word(
        "Misfit",
        "misfit",
        "what a model leaves of the data beyond the noise. It is smooth if it varies gradually "
        "with the settings.",
    ),
    Word(
        "p, p-value",
        "p-value|\\bp (?:=|of|below|above|&lt;)",
        "the probability that noise alone gives a misfit that is at least as large. A small one "
        "contradicts the model.",
    ),
    Word(
        "Score test",
        "score test",
        "the pattern in the data of each cause, as far as the constants cannot imitate it, is "
        "compared with what is left of the data; the lack-of-fit test compares the size of all "
        "that is left with the noise.",
    ),
    Word(
        "Prior",
        "prior",
        "what is known of a constant before these data: its stated value and standard deviation.",
    ),
    Word(
        "Log-evidence",
        "log-evidence",
        "the logarithm of how probable the data are under a candidate, averaged over the prior of "
        "its constants and of the size of its cause. Only differences count.",
    ),
    Word(
        "Lead, runner-up",
        "\\blead\\b|runner-up",
        "the difference in log-evidence to the next candidate, and that candidate.",
    ),
    Word(
        "Signal to noise",
        "signal to noise",
        "the change of the data by a cause in units of their noise, all conditions together.",
    ),
    Word(
        "Held out",
        "held[- ]out",
        "conditions that took no part in a fit, and are then predicted by it. The gain is how much "
        "better the extended model predicts them.",
    ),
    Word(
        "Paired bootstrap",
        "paired bootstrap",
        "the held-out conditions are drawn again at random, both models with the same ones; the "
        "interval says how the gain would vary with other conditions of the same kind.",
    ),
    Word(
        "Trade off",
        "trade off",
        "constants that can change together without a change of what was measured.",
    ),
)
"""In the order in which a page gives them."""

_PICTURE = re.compile("<(svg|style|script).*?</\\1>", re.DOTALL)
_LIST = re.compile("<h2>Words</h2>.*?</ul>", re.DOTALL)


def used_in(page: str) -> tuple[Word, ...]:
    """Words that a page uses, or that these need themselves."""
    text = _LIST.sub("", _PICTURE.sub("", page))
    used: tuple[Word, ...] = ()
    while True:
        said = "\n".join((text, *(each.meaning for each in used)))
        found = tuple(each for each in WORDS if re.search(each.pattern, said, re.IGNORECASE))
        if found == used:
            return used
        used = found
