"""Sphinx configuration for ``make docs``; nothing in the pages is loaded from elsewhere."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx import addnodes
from sphinx.application import Sphinx

import stickslip

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE / "_extensions"), str(HERE.parent / "bench")]

from constants import constants  # noqa: E402

project = "stickslip"
author = "stickslip developers"
project_copyright = "2026, stickslip developers"
version = release = stickslip.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "numpydoc",
    "mathml",
    "generated",
    "notebook",
]
exclude_patterns = ["_build", "_extensions"]

myst_enable_extensions = ["dollarmath", "deflist", "substitution"]
myst_substitutions = constants()
myst_heading_anchors = 3
html_math_renderer = "mathml"

nitpicky = True
# A word without a dot is a parameter or an entry of the same docstring.
nitpick_ignore_regex = [("py:obj", r"[a-z_]+")]
default_role = "autolink"
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autosummary_generate = False
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

html_theme = "furo"
html_title = f"stickslip {release}"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_copy_source = False
html_show_sphinx = False
pygments_style = "friendly"


def _public_targets(_: Sphinx, page: nodes.document) -> None:
    # The pages of `viewcode` link back by the module under which they first met a name of their
    # file: `stickslip`, also for the names beside it that stand in a module of their own.
    for each in page.findall(addnodes.desc_signature):
        target = f"stickslip.{each.get('fullname')}"
        if each.get("module") and target not in page.ids:
            each["ids"].append(target)


def setup(app: Sphinx) -> None:
    app.add_lexer("csv", TextLexer)
    app.connect("doctree-read", _public_targets)
    app.connect(
        "build-finished",
        lambda *_: shutil.copytree(HERE / "play", Path(app.outdir) / "play", dirs_exist_ok=True),
    )
