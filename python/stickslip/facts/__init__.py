"""What a measurement and its diagnosis have to tell, as data, and the sentences for it."""

from __future__ import annotations

from stickslip.facts.codes import Code
from stickslip.facts.fact import Fact

__all__ = ["Code", "Fact"]
