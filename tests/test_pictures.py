"""The pictures of the README and the pages: there, shown with words beside them, small, made by
what the reader sees; and pages that GitHub can show."""

import importlib.util
import json
import re

import pytest

from documentation_blocks import DOCS, ROOT, blocks, by_name, pages, prose

IMAGES = DOCS / "images"
README = ROOT / "README.md"
FILM = IMAGES / "walk.webp"
PAGES = [README, *pages(DOCS)]
ON_GITHUB = [
    README,
    *(DOCS / f"{name}.md" for name in ("start", "pictures", "limits", "faq")),
    *sorted((DOCS / "howto").glob("*.md")),
]

_IMAGE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")


def shown(page):
    """Words and place of each picture of a page."""
    return [(words, (page.parent / link).resolve()) for words, link in _IMAGE.findall(prose(page))]


@pytest.fixture(scope="module")
def maker():
    """docs/pictures.py."""
    spec = importlib.util.spec_from_file_location("docs_pictures", DOCS / "pictures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("page", PAGES, ids=by_name)
def test_pictures_of_a_page_are_there_and_have_words_for_who_cannot_see_them(page):
    for words, picture in shown(page):
        assert picture.is_file(), picture
        assert IMAGES in picture.parents, picture
        assert words, picture


def test_every_picture_is_shown_and_small():
    stored = {path for path in IMAGES.rglob("*") if path.is_file()}
    assert stored == {picture for page in PAGES for _, picture in shown(page)}
    for picture in stored:
        assert picture.stat().st_size < (1.2e6 if picture == FILM else 300e3), picture


@pytest.mark.parametrize("page", pages(DOCS), ids=by_name)
def test_the_code_of_a_page_saves_the_pictures_that_are_its_own(page):
    own = IMAGES / page.relative_to(DOCS).with_suffix("")
    code = "".join(block.text for block in blocks(page) if block.language == "python")
    for _, picture in shown(page):
        if picture.parent == own:
            assert f'"{picture.name}"' in code, picture


@pytest.mark.nightly
def test_the_commands_of_the_readme_make_its_pictures(maker, tmp_path):
    names = {picture.name for _, picture in shown(README) if picture.parent.name == "readme"}
    assert {"run.png", "sweep.png", "path.png", "diagnosis.png", "joint.png"} == names
    commands = maker.readme_commands()
    assert len(commands) == len(names)
    slow = "stickslip diagnose measurement.toml --out found"  # some 15 s
    commands.remove(slow)
    maker.run_commands(commands, tmp_path)
    for name in names - {"diagnosis.png"}:
        assert (tmp_path / name).is_file(), name


@pytest.mark.nightly
def test_the_diagnosis_of_the_readme_names_the_cause_of_its_picture(maker, tmp_path):
    maker.run_commands([c for c in maker.readme_commands() if "diagnose" in c], tmp_path)
    report = json.loads((tmp_path / "found" / "report.json").read_text(encoding="utf-8"))
    assert (report["verdict"], report["cause"]) == ("named", "friction_anisotropy")
    assert (tmp_path / "found" / "report.html").is_file()


@pytest.mark.parametrize("page", ON_GITHUB, ids=by_name)
def test_a_page_that_github_shows_has_no_markup_of_sphinx(page):
    text = prose(page)
    assert not re.search(r"^ *`{3,}\{|^:{3,}\{?", text, re.MULTILINE)
    assert not re.search(r"\{[a-z:-]+\}`", text)
    assert "<!--" not in text
