"""The drawings of the pages: readable, stored as they are made, and with nothing from elsewhere."""

import itertools
import sys
import xml.etree.ElementTree as ElementTree

import pytest

from documentation_blocks import DOCS

sys.path.append(str(DOCS / "_extensions"))
from drawings import DRAWINGS

PANELS = [
    pytest.param(panel, id=f"{name}-{number}")
    for name, draw in DRAWINGS.items()
    for number, panel in enumerate(draw())
]


@pytest.mark.parametrize("panel", PANELS)
def test_labels_lie_on_the_sheet_and_not_on_each_other(panel):
    for words, left, top, right, bottom in panel.words:
        assert 0 <= left < right <= panel.width, words
        assert 0 <= top < bottom <= panel.height, words
    for one, other in itertools.combinations(panel.words, 2):
        apart = one[3] <= other[1] or other[3] <= one[1] or one[4] <= other[2] or other[4] <= one[2]
        assert apart, (one[0], other[0])


@pytest.mark.parametrize("panel", PANELS)
def test_a_panel_is_svg_that_fits_a_telephone_and_loads_nothing(panel):
    text = panel.svg()
    assert ElementTree.fromstring(text).get("height") == f"{panel.height:g}"
    # Letters must not become small where a page is narrow.
    assert panel.width <= 340 or not panel.words
    for word in ("href", "url(", "@import"):
        assert word not in text


def test_the_stored_drawings_are_those_that_are_made():
    # Their sizes are the package's defaults.
    made = {
        f"{name}-{number}.svg": panel.svg()
        for name, draw in DRAWINGS.items()
        for number, panel in enumerate(draw(), start=1)
    }
    folder = DOCS / "images" / "drawings"
    assert {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()} == made
