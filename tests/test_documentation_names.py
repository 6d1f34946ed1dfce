"""Every file, folder, function and module that the documentation names is there."""

import re

import pytest

from documentation_blocks import pages
from documentation_names import ROOT, missing, named_paths

PAGES = [*pages(ROOT / "docs"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
by_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))

SOURCES = [
    path
    for top in ("bench", "cpp", "python", "tests")
    for path in (ROOT / top).rglob("*")
    if path.suffix in (".py", ".cpp", ".hpp", ".md", ".html") and "results" not in path.parts
]


@by_page
def test_what_a_page_names_is_there(page):
    assert missing(page.read_text(encoding="utf-8"), page.parent) == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("`no_such_file.py` is", "there is no no_such_file.py"),
        ("`tests/no_such_test.py`", "there is no tests/no_such_test.py"),
        (
            "`tests/test_cli.py: test_of_nothing`",
            "there is no test_of_nothing in tests/test_cli.py",
        ),
        ("`nothing.hpp: Nothing`", "there is no nothing.hpp"),
        ("`phases.hpp: Nothing::at_all`", "there is no Nothing::at_all in phases.hpp"),
        ("`no_such_room/`", "there is no folder no_such_room/"),
        ("{func}`stickslip.nothing`", "there is no stickslip.nothing"),
        ("{class}`~stickslip.Scenario.nothing`", "there is no stickslip.Scenario.nothing"),
        (".. autofunction:: stickslip.plot.nothing", "there is no stickslip.plot.nothing"),
        ("`stickslip.cli.nothing.main`", "there is no stickslip.cli.nothing.main"),
        ("[a page](no-such-page.md#part)", "no link to no-such-page.md"),
    ],
)
def test_a_name_that_does_not_exist_is_reported(text, said):
    assert missing(f"Here {text} stands.\n") == [said]


@pytest.mark.parametrize(
    "text",
    [
        "`tests/test_cli.py`",
        "`test_pitfalls.py: test_dip_inside_a_step_is_seen`",
        "`scenario.hpp`",
        "`cpp/stickslip/`",
        "{class}`stickslip.Scenario`",
        "`stickslip.Scenario.drive`",
        "`report.html`",  # is written by the command
        "[a page](docs/start.md#part)",
        "```sh\nstickslip run a.toml --out made\n```\n\nin `made/`",
    ],
)
def test_a_name_that_exists_is_not_reported(text):
    assert missing(f"Here\n\n{text}\n\nstands.\n") == []


def test_the_page_for_developers_names_places():
    # Else the first test could pass for want of anything to look for.
    text = (ROOT / "docs" / "develop.md").read_text(encoding="utf-8")
    assert len(re.findall(r"`[\w/]+\.(?:cpp|hpp|py): ", text)) > 40


def test_files_that_sources_name_are_there():
    named = {
        path: source.relative_to(ROOT)
        for source in SOURCES
        if source.name != "test_documentation_names.py"
        for path in named_paths(source.read_text(encoding="utf-8"))
    }
    assert len(named) > 5
    assert {path: by for path, by in named.items() if not (ROOT / path).exists()} == {}


@by_page
def test_named_make_targets_are_there(page):
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    for target in re.findall(r"(?:`|^|&& )make ([a-z-]+)", page.read_text(), re.MULTILINE):
        assert target in targets, f"{page.name}: make {target}"
