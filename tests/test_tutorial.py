"""The tutorial notebook: its cells run, print what it says, and show pictures without paths."""

import ast
import json
import re

import pytest

from documentation_blocks import ANY_FIT, DOCS, NUMBER, is_near, prints
from notebook_cells import code_cells, run, text

PATH = DOCS / "tutorial.ipynb"
CELLS = code_cells(json.loads(PATH.read_text(encoding="utf-8")))
DIAGNOSIS = next(k for k, cell in enumerate(CELLS) if "diagnose(" in text(cell))

PICTURE = r"[A-Za-z0-9+/=]{99,}"
ANY_MACHINE = 1e-4  # relative difference of numbers, by rounding


def printed(outputs):
    return "".join("".join(each.get("text", "")) for each in outputs)


def kinds(outputs):
    return [set(each.get("data", {})) for each in outputs]


def shown(outputs, kind):
    """Text that a cell shows of a media type, without pictures and random identifiers."""
    lines = "\n".join("".join(each.get("data", {}).get(kind, "")) for each in outputs)
    return " ".join(re.sub(rf"{PICTURE}|[0-9a-f]{{32}}", "", lines).split())


def same(stored, got, tolerance):
    """Whether words are equal, and numbers within a tolerance and one of the last digit."""
    numbers = zip(NUMBER.finditer(stored), NUMBER.finditer(got), strict=False)
    return NUMBER.split(stored)[::3] == NUMBER.split(got)[::3] and all(
        is_near(one, other, tolerance) for one, other in numbers
    )


@pytest.mark.nightly
def test_cells_run_and_show_what_is_stored():
    for k, (cell, outputs) in enumerate(zip(CELLS, run(CELLS), strict=True)):
        assert prints(printed(cell["outputs"]), printed(outputs)), text(cell)
        assert kinds(outputs) == kinds(cell["outputs"]), text(cell)
        for kind in ("text/plain", "text/html"):
            stored, got = shown(cell["outputs"], kind), shown(outputs, kind)
            assert same(stored, got, ANY_MACHINE if k < DIAGNOSIS else ANY_FIT), (stored, got)


def test_the_notebook_goes_from_a_scenario_to_a_diagnosis():
    nodes = [node for cell in CELLS for node in ast.walk(ast.parse(text(cell)))]
    called = {getattr(node, "id", getattr(node, "attr", None)) for node in nodes}
    assert {"Scenario", "simulate", "sweep", "velocity", "animation", "diagnose"} <= called
    assert DIAGNOSIS >= 8


def test_outputs_are_stored_in_order_and_without_paths_of_a_machine():
    assert [cell["execution_count"] for cell in CELLS] == list(range(1, len(CELLS) + 1))
    assert all(cell["outputs"] for cell in CELLS)
    plain = re.sub(PICTURE, "", json.dumps(CELLS))
    assert not re.search(r"(?<![<\w.])/(?:home|root|tmp|usr|work|opt|Users|var)\b|file://", plain)
    assert " at 0x" not in plain
    assert "Traceback" not in plain
    assert PATH.stat().st_size < 1_000_000
