"""The cells of the tutorial notebook, run as a notebook runs them. The docs' build reads them too.

``python tests/notebook_cells.py docs/tutorial.ipynb`` runs all cells and stores what they show.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

Notebook = dict[str, Any]
Outputs = list[dict[str, Any]]


def read(path: Path) -> Notebook:
    """The notebook of a file."""
    return parsed(path.read_text(encoding="utf-8"))


def parsed(source: str) -> Notebook:
    """A notebook of format 4."""
    notebook: Notebook = json.loads(source)
    assert notebook["nbformat"] == 4
    return notebook


def text(cell: dict[str, Any]) -> str:
    """The source of a cell; a notebook keeps it as a list of lines."""
    return "".join(cell["source"])


def code_cells(notebook: Notebook) -> list[dict[str, Any]]:
    """The cells of code, in order."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def printed(outputs: Outputs) -> str:
    """What a cell printed."""
    return "".join("".join(each["text"]) for each in outputs if each["output_type"] == "stream")


def run(cells: list[dict[str, Any]]) -> list[Outputs]:
    """The outputs of cells that share one namespace and a folder that is empty at first."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            return [_run_cell(text(cell), k, namespace) for k, cell in enumerate(cells, start=1)]
        finally:
            os.chdir(before)


def _run_cell(source: str, number: int, namespace: dict[str, Any]) -> Outputs:
    """What a cell prints, and what it shows: its last line, if that is an expression."""
    body = ast.parse(source).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    name = f"<cell {number}>"
    shown = None
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        exec(compile(ast.Module(body, []), name, "exec"), namespace)
        if last is not None:
            shown = eval(compile(ast.Expression(last.value), name, "eval"), namespace)
    outputs: Outputs = []
    if stream.getvalue():
        lines = stream.getvalue().splitlines(keepends=True)
        outputs.append({"name": "stdout", "output_type": "stream", "text": lines})
    if shown is not None:
        outputs.append(
            {
                "data": _shown(shown),
                "execution_count": number,
                "metadata": {},
                "output_type": "execute_result",
            }
        )
    return outputs


def _shown(value: Any) -> dict[str, Any]:
    """What a notebook asks a value for, by media type."""
    data: dict[str, Any] = {"text/plain": repr(value).splitlines(keepends=True)}
    if hasattr(value, "_repr_html_"):
        html = value._repr_html_()
        if html is not None:
            data["text/html"] = html.splitlines(keepends=True)
    if hasattr(value, "_repr_png_"):
        data["image/png"] = base64.b64encode(value._repr_png_()).decode("ascii")
    return data


def store(path: Path) -> None:
    """Run all cells of a file and keep their outputs in it."""
    notebook = read(path)
    cells = code_cells(notebook)
    for number, (cell, outputs) in enumerate(zip(cells, run(cells), strict=True), start=1):
        cell["execution_count"], cell["outputs"] = number, outputs
    text = json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True)
    path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    store(Path(sys.argv[1]))
