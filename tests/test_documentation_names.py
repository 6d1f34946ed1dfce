"""Names in pages and sources exist: public names, linked files, places of sources, targets."""

import json
import pkgutil
import re

import jinja2
import pytest
from constants import constants

from documentation_blocks import DOCS, PAGES, ROOT, by_name, prose

TOPS = ("bench", "cmake", "cpp", "docs", "examples", "python", "tests")
BUILT = {"__pycache__", "_build", "results"}
ALL = [path for top in TOPS for path in [ROOT / top, *(ROOT / top).rglob("*")]]
SOURCES = [path for path in ALL if not BUILT & {*path.parts}]

NAME = re.compile(r"(?<![\w/.-])stickslip(?:\.[A-Za-z_]\w*)+")
MEMBERS = re.compile(r":: (stickslip[.\w]+)\n(?: +:(?!members).*\n)* +:members: (.+)")
LINK = re.compile(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)")
# `file: name`, `file` or `folder/`; names of files may have a star.
PLACE = re.compile(
    r"`(?!docs/_build|bench/results|[.])"
    r"([\w./*-]+(?:\.(?:py|cpp|hpp|cmake|md)|/))(?:: ([\w:., ]+))?`"
)
PATH = re.compile(
    r"(?<![\w/.-])(?!docs/_build|bench/results)"
    rf"(?:{'|'.join(TOPS)})/[\w/.-]*\w\.(?:py|cpp|hpp|md|jsonl|cmake)\b"
)
by_page = pytest.mark.parametrize("page", PAGES, ids=by_name)


def is_public(name):
    home, _, last = name.rpartition(".")
    try:
        if last not in getattr(pkgutil.resolve_name(home), "__dataclass_fields__", {}):
            pkgutil.resolve_name(name)
    except (AttributeError, ImportError):
        return False
    return True


def missing(words, folder):
    """Names of the package, and files of links, that are not there."""
    names = [f"{of}.{name}" for of, every in MEMBERS.findall(words) for name in every.split(", ")]
    yield from (name for name in NAME.findall(words) + names if not is_public(name))
    yield from (link for link in LINK.findall(words) if not (folder / link).exists())


@by_page
def test_names_and_links_of_a_page_are_there(page):
    assert list(missing(prose(page), page.parent)) == []


NUMBERS = constants()
STRICT = jinja2.Environment(undefined=jinja2.StrictUndefined)
BY_NAME_ALONE = DOCS / "theory" / "diagnosis.md"
"""The page of the rules: no number with a decimal point stands in digits."""


@by_page
def test_numbers_of_the_code_are_named(page):
    text = page.read_text(encoding="utf-8")
    for name in re.findall(r"{{(.+?)}}", text):
        assert STRICT.from_string(f"{{{{{name}}}}}").render(NUMBERS)
    digits = re.findall(r"(?<![\w.])\d+\.\d+", re.sub("{{.+?}}", "", text))
    assert page != BY_NAME_ALONE or digits == []


def test_names_and_links_of_the_tutorial_are_there():
    cells = json.loads((DOCS / "tutorial.ipynb").read_text(encoding="utf-8"))["cells"]
    words = ["".join(cell["source"]) for cell in cells if cell["cell_type"] != "code"]
    assert list(missing("\n\n".join(words), DOCS)) == []


OF_SOURCES = [DOCS / "develop.md", DOCS / "layout.md", ROOT / "CONTRIBUTING.md"]


@pytest.mark.parametrize("page", OF_SOURCES, ids=by_name)
def test_places_of_sources_are_there(page):
    for place, names in PLACE.findall(prose(page)):
        files = [path for path in SOURCES if path.match(place.rstrip("/"))]
        files += [path for path in ROOT.glob(place) if path.is_file()]
        assert files, place
        wanted = {*re.findall(r"\w+", names)}
        words = (set(re.findall(r"\w+", each.read_text())) for each in files if each.is_file())
        assert not wanted or any(wanted <= each for each in words), (place, names)


def test_files_that_sources_name_are_there():
    texts = {path: path.read_text() for path in SOURCES if path.suffix in (".py", ".cpp", ".hpp")}
    named = {each: path for path, content in texts.items() for each in PATH.findall(content)}
    assert {each: path for each, path in named.items() if not (ROOT / each).exists()} == {}


@by_page
def test_named_make_targets_are_there(page):
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    named = re.findall(r"(?:`|^|&& )make ([a-z-]+)", page.read_text(), re.MULTILINE)
    assert {*named} <= {*targets}
