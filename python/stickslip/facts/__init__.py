"""Messages of a measurement and its diagnosis: codes with fields, and their sentences."""

from __future__ import annotations

from stickslip.facts.codes import Code
from stickslip.facts.fact import Fact

__all__ = ["Code", "Fact"]
