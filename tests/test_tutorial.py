"""The tutorial notebook: its cells run, print what it says, and show pictures without paths."""

import ast
import json
import math
import re
from pathlib import Path

import pytest

from documentation_blocks import prints
from documentation_names import missing
from notebook_cells import code_cells, printed, read, run, text

PATH = Path(__file__).parents[1] / "docs" / "tutorial.ipynb"
NOTEBOOK = read(PATH)
CELLS = code_cells(NOTEBOOK)
DIAGNOSIS = next(k for k, cell in enumerate(CELLS) if "diagnose(" in text(cell))


_NUMBER = re.compile(r"\d+(?:\.(\d+))?(?:e([+-]\d+))?")
ANY_MACHINE, ANY_FIT = 1e-4, 0.05
"""Relative differences of numbers: rounding of the last digits; and the end of a fit, whose steps
differ in the last bits from machine to machine."""


def shown(outputs, kind):
    """What a cell shows of a kind, without pictures and what is drawn by lot for each showing."""
    lines = "\n".join("".join(each.get("data", {}).get(kind, "")) for each in outputs)
    return " ".join(re.sub(r"[A-Za-z0-9+/=]{99,}|[0-9a-f]{32}", "", lines).split())


def differs(stored, got, tolerance):
    """The first words or numbers that differ, by more than a tolerance and one of a last digit."""
    ours, theirs = _NUMBER.split(stored)[::3], _NUMBER.split(got)[::3]
    if ours != theirs:
        return next(
            (pair for pair in zip(ours, theirs, strict=False) if pair[0] != pair[1]), (ours, theirs)
        )
    for one, other in zip(_NUMBER.finditer(stored), _NUMBER.finditer(got), strict=True):
        digit = 10.0 ** (int(one[2] or 0) - len(one[1] or ""))
        a, b = float(one[0]), float(other[0])
        if not math.isclose(a, b, rel_tol=tolerance, abs_tol=1.01 * digit):
            return one[0], other[0]
    return None


def check(cells):
    for k, (cell, outputs) in enumerate(zip(cells, run(cells), strict=True)):
        assert prints(printed(cell["outputs"]), printed(outputs)), text(cell)
        stored = [set(each.get("data", {})) for each in cell["outputs"]]
        assert [set(each.get("data", {})) for each in outputs] == stored, text(cell)
        for kind in ("text/plain", "text/html"):
            both = shown(cell["outputs"], kind), shown(outputs, kind)
            assert differs(*both, ANY_MACHINE if k < DIAGNOSIS else ANY_FIT) is None, text(cell)


def test_all_cells_before_the_diagnosis_run_and_show_what_is_stored():
    assert DIAGNOSIS >= 8
    check(CELLS[:DIAGNOSIS])


def test_another_word_or_number_is_seen():
    assert differs("1.234e-03 m/s", "1.235e-03 m/s", ANY_MACHINE) is None
    assert differs("x = 1.234e-03", "x = 1.238e-03", ANY_MACHINE) == ("1.234e-03", "1.238e-03")
    assert differs("tilt 2.44", "tilt 2.49", ANY_FIT) is None
    assert differs("tilt 2.44", "slope 2.44", ANY_FIT) == ("tilt ", "slope ")


@pytest.mark.nightly
def test_all_cells_run_and_show_what_is_stored():
    check(CELLS)


def test_the_notebook_goes_from_a_scenario_to_a_diagnosis():
    called = {
        node.id if isinstance(node, ast.Name) else node.attr
        for cell in CELLS
        for node in ast.walk(ast.parse(text(cell)))
        if isinstance(node, ast.Name | ast.Attribute)
    }
    assert {"Scenario", "simulate", "sweep", "velocity", "animation", "diagnose"} <= called


def test_outputs_are_stored_in_order_and_without_paths_of_a_machine():
    assert [cell["execution_count"] for cell in CELLS] == list(range(1, len(CELLS) + 1))
    assert all(cell["outputs"] for cell in CELLS)
    plain = re.sub(r"[A-Za-z0-9+/=]{99,}", "", json.dumps(CELLS))  # without pictures
    assert not re.search(r"(?<![<\w.])/(?:home|root|tmp|usr|work|opt|Users|var)\b|file://", plain)
    assert " at 0x" not in plain
    assert "Traceback" not in plain


def test_what_the_notebook_names_is_there():
    words = "\n\n".join(text(cell) for cell in NOTEBOOK["cells"] if cell["cell_type"] != "code")
    assert missing(words, PATH.parent) == []


def test_no_line_of_code_is_wider_than_a_page():
    assert all(len(line) <= 90 for cell in CELLS for line in text(cell).splitlines())


def test_its_file_is_small_and_of_the_usual_form():
    assert PATH.stat().st_size < 1_000_000
    assert (NOTEBOOK["nbformat"], NOTEBOOK["nbformat_minor"]) == (4, 5)
    names = [cell["id"] for cell in NOTEBOOK["cells"]]
    assert len({*names}) == len(names)
