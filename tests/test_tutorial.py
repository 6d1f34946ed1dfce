"""The tutorial notebook: its cells run, print what it says, and show pictures without paths.

``python tests/test_tutorial.py`` runs all cells and stores what they show.
"""

import json
import re
import tempfile

import pytest

from documentation_blocks import ANY_FIT, DOCS, NUMBER, is_near, prints

PATH = DOCS / "tutorial.ipynb"


def code_cells(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def text(cell):
    return "".join(cell["source"])


CELLS = code_cells(json.loads(PATH.read_text(encoding="utf-8")))
DIAGNOSIS = next(k for k, cell in enumerate(CELLS) if "diagnose(" in text(cell))

PICTURE = r"[A-Za-z0-9+/=]{99,}"
ANY_MACHINE = 1e-4  # relative difference of numbers, by rounding


def printed(outputs):
    # A slow machine shows a progress bar on standard error.
    out = [each for each in outputs if each.get("name") == "stdout"]
    return "".join("".join(each["text"]) for each in out)


def kinds(outputs):
    return [set(each["data"]) for each in outputs if "data" in each]


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


def played():
    """The notebook after all of its cells have run in an empty folder."""
    nbclient, nbformat, _ = map(pytest.importorskip, ("nbclient", "nbformat", "ipykernel"))
    notebook = nbformat.read(PATH, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        return nbclient.execute(notebook, cwd=folder, record_timing=False)


@pytest.mark.nightly
def test_cells_run_and_show_what_is_stored(monkeypatch):
    monkeypatch.setenv("PYTHONWARNINGS", "error::RuntimeWarning")  # as in pyproject.toml
    got = [cell["outputs"] for cell in code_cells(played())]
    for k, (cell, outputs) in enumerate(zip(CELLS, got, strict=True)):
        assert prints(printed(cell["outputs"]), printed(outputs)), text(cell)
        assert kinds(outputs) == kinds(cell["outputs"]), text(cell)
        for kind in ("text/plain", "text/html"):
            stored, got = shown(cell["outputs"], kind), shown(outputs, kind)
            assert same(stored, got, ANY_MACHINE if k < DIAGNOSIS else ANY_FIT), (stored, got)


def test_outputs_are_stored_in_order_and_without_paths_of_a_machine():
    assert [cell["execution_count"] for cell in CELLS] == list(range(1, len(CELLS) + 1))
    assert all(cell["outputs"] for cell in CELLS)
    plain = re.sub(PICTURE, "", json.dumps(CELLS))
    assert not re.search(r"(?<![<\w.])/(?:home|root|tmp|usr|work|opt|Users|var)\b|file://", plain)
    assert " at 0x" not in plain
    assert "Traceback" not in plain
    assert PATH.stat().st_size < 1_000_000


if __name__ == "__main__":
    import nbformat

    notebook = played()
    notebook.metadata.language_info = {"name": "python"}  # without a machine's version
    nbformat.write(notebook, PATH)
