"""HTML pages of one look, and the views of objects in notebooks."""

from __future__ import annotations

import functools
import hashlib
import io
import re
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from stickslip import _core
from stickslip._util import palette
from stickslip._util.text import printable, printable_lines
from stickslip._util.toml import own_text

if TYPE_CHECKING:
    import jinja2
    from markupsafe import Markup
    from matplotlib.figure import Figure

VERSION = _core.__version__


def page_text(template: str, **values: object) -> str:
    """The page of a template, a file whose path in the package is given, with values by name.

    The template extends ``_util/page.html``, or is a part of a page. Values are escaped, and are
    shown without control characters.
    """
    shared = {"palette": palette, "version": _core.__version__}
    return _templates().get_template(template).render(shared, **values)


@functools.cache
def _templates() -> jinja2.Environment:
    """All templates, each of which is compiled once."""
    import jinja2

    return jinja2.Environment(
        loader=jinja2.FunctionLoader(own_text),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        # What has `__html__` is a part of the page, whose values went through this already.
        finalize=lambda value: (
            printable_lines(value)
            if isinstance(value, str) and not hasattr(value, "__html__")
            else value
        ),
    )


def svg(figure: Figure | None) -> Markup:
    """A figure as SVG in the page's own colours; empty if there is none.

    Its text stays text, so that a page can be searched, and black and white are the ink and the
    paper of the page, which may be dark. What a user wrote is escaped as in all values.
    """
    import matplotlib as mpl
    from markupsafe import Markup
    from matplotlib.text import Text

    if figure is None:
        return Markup("")
    for words in figure.findobj(Text):
        # Between two dollars of a name matplotlib expects a formula, and fails if there is none.
        words.set_parse_math(False)
        words.set_text(printable_lines(words.get_text()))
    buffer = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "stickslip"}):
        figure.savefig(buffer, format="svg", metadata=nothing, transparent=True)
    text = buffer.getvalue()
    text = text[text.index("<svg") :].rstrip()
    text = re.sub(r' xmlns(:xlink)?="[^"]*"| height="[\d.]+pt"', "", text, count=3)
    text = text.replace("xlink:href", "href")
    # In a page it would hold for all that is there.
    text = re.sub(r"<style.*?</style>", "", text, flags=re.DOTALL)
    for colour, name in (("#000000", "currentColor"), ("#ffffff", "var(--page)")):
        text = text.replace(colour, name)
    text = text.replace(palette.LIGHT_GREY.lower(), "var(--line)")
    # Groups need no names; what is referred to has one that no other figure of a page has.
    text = re.sub(r'<g id="[^"]*"', "<g", text)
    digest = hashlib.sha256(text.encode("utf-8")).hexdigest()[:8]
    text = re.sub(r'( id="| href="#|url\(#)', rf"\g<1>{digest}-", text)
    return Markup(printable_lines(text))


def html_table(title: str, rows: Sequence[tuple[str, str]]) -> str:
    """A title with a row for each name and value; all texts are escaped.

    It has no style of its own but where the text stands, and so fits light and dark notebooks.
    """
    left = ' style="text-align: left"'
    lines = [
        f"<tr><th{left}>{_text(name)}</th><td{left}>{_text(value)}</td></tr>"
        for name, value in rows
    ]
    caption = f'<caption style="text-align: left"><b>{_text(title)}</b></caption>'
    return "\n".join(["<table>", caption, *lines, "</table>"])


def _text(value: str) -> str:
    return escape(printable(value))
