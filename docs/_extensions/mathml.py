"""Formulas as MathML, which browsers draw by themselves: no script, no font and no network.

A paper's number is given as \\tag{13} in the formula.
"""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx

_TAG = re.compile(r"\\tag\{([^}]*)\}")


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    latex = node.astext()
    number = _TAG.search(latex)
    formula = convert(_TAG.sub("", latex).strip(), display="block")
    translator.body.append(f'<div class="formula"><div class="formula-body">{formula}</div>')
    if number:
        translator.body.append(f'<span class="formula-number">({number.group(1)})</span>')
    translator.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer as "mathml"."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline, None), block_renderers=(_block, None)
    )
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
