"""Measured sets: their truth, known without the diagnosis, and how they are diagnosed."""

from __future__ import annotations

import runpy
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from stickslip import Cause, Diagnosis, diagnose, read_measurement

MACHINES = Path(__file__).resolve().parent / "machines"
ASKED = {"axis": 3, "slider": 1, "drops": 2, "cylinders": 4, "tanks": 1, "wheels": 1}
"""Sets of each machine whose cause is known, the first ones."""
UNSURE = {"tumbler": 1, "rollers": 1}
"""Those of which only what the same data say is known."""


@dataclass(frozen=True)
class Truth:
    """Truth of a set.

    present, possible: Causes that act for certain, and further ones of which it is not known
    whether they do. values: Parameters that are known, each by its value and standard deviation.
    """

    present: tuple[str, ...]
    possible: tuple[str, ...] = ()
    values: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Measured:
    """A measured set.

    name. truth. diagnosed: ``diagnosed(without)``: the diagnosis, with these causes not listed.
    """

    name: str
    truth: Truth
    diagnosed: Callable[[Collection[str]], Diagnosis]


def measured_set(machine: str, number: int = 0) -> Measured:
    """A set of a machine."""
    found: Measured = runpy.run_path(str(MACHINES / machine / "machine.py"))["SETS"][number]
    return found


def with_absent(
    p: Mapping[str, np.ndarray], causes: Iterable[Cause]
) -> dict[str, np.ndarray | float]:
    """The parameters, and 0 for those of causes that are not listed."""
    return {**{each.name: 0.0 for cause in causes for each in cause.parameters}, **p}


def of_files(path: Path, parameter: str) -> Callable[[Collection[str]], Diagnosis]:
    """The diagnosis of a measurement's files with the simulator and its library of causes.

    An extension that is part of the scenario is no cause: one that is left out is there, with a
    billionth of its parameter.
    """

    def diagnosed(without: Collection[str]) -> Diagnosis:
        measured = read_measurement(path)
        none = {f"effects.{each}.{parameter}": 1e-9 for each in without}
        scenario = measured.scenario.replace(none)
        return diagnose(replace(measured, scenario=scenario), threads=1)

    return diagnosed
