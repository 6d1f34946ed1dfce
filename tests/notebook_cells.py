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

Cell = dict[str, Any]
Outputs = list[dict[str, Any]]


def text(cell: Cell) -> str:
    """The source of a cell; a notebook keeps it as a list of lines."""
    return "".join(cell["source"])


def code_cells(notebook: dict[str, Any]) -> list[Cell]:
    """The cells of code, in order."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run(cells: list[Cell]) -> list[Outputs]:
    """The outputs of cells that share one namespace and a folder that is empty at first."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            return [_run_cell(text(cell), k, namespace) for k, cell in enumerate(cells, 1)]
        finally:
            os.chdir(before)


def _run_cell(source: str, number: int, namespace: dict[str, Any]) -> Outputs:
    """Outputs of a cell: printed text, and the value of its last line if that is an expression."""
    body = ast.parse(source).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    shown = None
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        exec(compile(ast.Module(body, []), f"<cell {number}>", "exec"), namespace)
        if last is not None:
            shown = eval(compile(ast.Expression(last.value), f"<cell {number}>", "eval"), namespace)
    outputs: Outputs = []
    if lines := stream.getvalue().splitlines(keepends=True):
        outputs.append({"name": "stdout", "output_type": "stream", "text": lines})
    if shown is not None:
        result = {"data": _data(shown), "execution_count": number, "metadata": {}}
        outputs.append({**result, "output_type": "execute_result"})
    return outputs


def _data(value: Any) -> dict[str, Any]:
    """Representations of a value that a notebook asks for, by media type."""
    data: dict[str, Any] = {"text/plain": repr(value).splitlines(keepends=True)}
    if hasattr(value, "_repr_html_") and (html := value._repr_html_()) is not None:
        data["text/html"] = html.splitlines(keepends=True)
    if hasattr(value, "_repr_png_"):
        data["image/png"] = base64.b64encode(value._repr_png_()).decode("ascii")
    return data


if __name__ == "__main__":
    path = Path(sys.argv[1])
    stored = json.loads(path.read_text(encoding="utf-8"))
    for each, shows in zip(code_cells(stored), run(code_cells(stored)), strict=True):
        each["outputs"] = shows
    for count, each in enumerate(code_cells(stored), start=1):
        each["execution_count"] = count
    written = json.dumps(stored, indent=1, ensure_ascii=False, sort_keys=True)
    path.write_text(written + "\n", encoding="utf-8")
