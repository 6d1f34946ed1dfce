"""A fact: a code, and the numbers, names and units that belong to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stickslip._util.plain_text import printable
from stickslip.facts.codes import Code
from stickslip.facts.sentences import sentence


@dataclass(frozen=True)
class Fact:
    """One message as data; ``str()`` gives its sentence.

    Attributes
    ----------
    code : Code
    fields : dict
        Numbers (SI units), names, lists of them, or another fact. A limit that a number was
        compared with is a field too, so that no sentence has a limit of its own.
    """

    code: Code
    fields: Mapping[str, Any]

    def __str__(self) -> str:
        return printable(sentence(self.code, self.fields))

    def of(self, **fields: Any) -> Fact:
        """The same with further fields, such as the table that it is about."""
        return Fact(self.code, {**fields, **self.fields})

    def as_dict(self) -> dict[str, Any]:
        """For JSON: ``code`` and ``fields``."""
        fields = {
            name: each.as_dict() if isinstance(each, Fact) else each
            for name, each in self.fields.items()
        }
        return {"code": self.code.value, "fields": fields}
