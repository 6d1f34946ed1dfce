"""Sphinx configuration for ``make docs``; nothing in the pages is loaded from elsewhere."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

import stickslip

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE / "_extensions"), str(HERE.parent / "tests")]

from documentation_blocks import pages, play  # noqa: E402

project = "stickslip"
author = "stickslip developers"
project_copyright = "2025, stickslip developers"
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
exclude_patterns = ["_build", "_extensions", "_pictures"]

myst_enable_extensions = ["dollarmath", "deflist"]
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


def _make_pictures(app: Sphinx) -> None:
    """Run the code of every page that shows pictures, and take the pictures from there."""
    target = HERE / "_pictures"
    shutil.rmtree(target, ignore_errors=True)
    for page in pages(HERE):
        if "_pictures/" not in page.read_text(encoding="utf-8"):
            continue
        with play(page) as folder:
            for picture in [*folder.glob("*.png"), *folder.glob("*.gif")]:
                place = target / page.relative_to(HERE).with_suffix("")
                place.mkdir(parents=True, exist_ok=True)
                shutil.copy(picture, place / picture.name)


def setup(app: Sphinx) -> None:
    app.connect("builder-inited", _make_pictures)
    app.add_lexer("csv", TextLexer)
    app.connect(
        "build-finished",
        lambda *_: shutil.copytree(HERE / "play", Path(app.outdir) / "play", dirs_exist_ok=True),
    )
