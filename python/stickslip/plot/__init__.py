"""Figures of runs. Each function gives a matplotlib Figure; `save` writes one to a file."""

from stickslip.plot.run_figure import run
from stickslip.plot.saving import check_format, save

__all__ = ["check_format", "run", "save"]
