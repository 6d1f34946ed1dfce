"""Notebooks as pages: their text, their code, and the outputs that are stored in them."""

from __future__ import annotations

import json
from typing import Any

from docutils import nodes
from myst_parser.parsers.sphinx_ import MystParser
from sphinx.application import Sphinx

_FENCE = "`" * 7  # longer than any in a cell


def _block(kind: str, content: str) -> str:
    return f"{_FENCE}{kind}\n{content.rstrip()}\n{_FENCE}"


def _output(output: dict[str, Any]) -> str:
    """One output as Markdown: the richest of what is stored."""
    if output["output_type"] == "stream":
        return _block("text", "".join(output["text"]))
    data = output["data"]
    if "text/html" in data:
        return _block("{raw} html", "".join(data["text/html"]))
    if "image/png" in data:
        address = f"data:image/png;base64,{data['image/png']}"
        plain = "".join(data["text/plain"]).strip("<>")
        return _block("{raw} html", f'<img class="output" alt="{plain}" src="{address}">')
    return _block("text", "".join(data["text/plain"]))


class NotebookParser(MystParser):
    """Reads a notebook as the Markdown that its cells come to."""

    supported = ("notebook",)

    def parse(self, inputstring: str, document: nodes.document) -> None:
        parts = []
        for cell in json.loads(inputstring)["cells"]:
            code = cell["cell_type"] == "code"
            text = "".join(cell["source"])
            parts.append(_block("python", text) if code else text)
            parts += map(_output, cell.get("outputs", []))
        super().parse("\n\n".join(parts) + "\n", document)


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_source_suffix(".ipynb", "notebook")
    app.add_source_parser(NotebookParser)
    return {"parallel_read_safe": True}
