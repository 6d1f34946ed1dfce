"""The pictures of the README and the pages are there and shown, made by what the reader sees."""

import importlib.util
import json
import re

import pytest

from documentation_blocks import DOCS, ROOT, pages, prose

IMAGES = DOCS / "images"
README = ROOT / "README.md"
PAGES = [README, *pages(DOCS)]

_IMAGE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")


def shown(page):
    """Places of the pictures of a page."""
    return [(page.parent / link).resolve() for link in _IMAGE.findall(prose(page))]


@pytest.fixture(scope="module")
def maker():
    """docs/pictures.py."""
    spec = importlib.util.spec_from_file_location("docs_pictures", DOCS / "pictures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_picture_is_shown():
    stored = {path for path in IMAGES.rglob("*") if path.is_file()}
    assert stored == {picture for page in PAGES for picture in shown(page)}


@pytest.mark.nightly
def test_the_commands_of_the_readme_make_its_pictures(maker, tmp_path):
    names = {picture.name for picture in shown(README) if picture.parent.name == "readme"}
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
