"""What stands in more than one file is the same in all; which folder of the core may use which."""

import re
import sys
from pathlib import Path

import pytest

from command_line import python_process

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
ADDRESS = PROJECT["urls"]["Repository"]
# Read where the project's table is not.
WITH_ADDRESS = ("CITATION.cff", "SECURITY.md", ".github/ISSUE_TEMPLATE/config.yml")


def test_the_project_has_one_address():
    assert all(url == ADDRESS or url.startswith(f"{ADDRESS}/") for url in PROJECT["urls"].values())
    for name in WITH_ADDRESS:
        urls = re.findall(r"https?://[^\s\"')]+", (ROOT / name).read_text(encoding="utf-8"))
        assert urls, name
        assert all(re.match(rf"{re.escape(ADDRESS)}(/|$)", url) for url in urls), (name, urls)


def test_the_placeholder_stands_nowhere_else():
    placeholder = re.compile(r"example\.(?:org|com|net)/\w")
    folders = (ROOT, *(ROOT / each for each in (".github", "docs", "python")))
    found = {
        str(path.relative_to(ROOT))
        for folder in folders
        for path in (folder.glob("*") if folder == ROOT else folder.rglob("*"))
        if path.suffix in (".cff", ".md", ".py", ".toml", ".yaml", ".yml")
        and "_build" not in path.parts
        and placeholder.search(path.read_text(encoding="utf-8"))
    }
    assert found <= {"pyproject.toml", *WITH_ADDRESS}


def test_the_check_of_a_wheel_passes_here_and_can_fail(tmp_path):
    check = ROOT / "tests" / "check_run.py"
    result = python_process(check)
    assert result.returncode == 0, result.stdout + result.stderr
    code = check.read_text(encoding="utf-8")
    changed = tmp_path / "check_run.py"
    changed.write_text(code.replace("1.912805069", "1.912805068"), encoding="utf-8")
    assert changed.read_text(encoding="utf-8") != code
    result = python_process(changed)
    assert result.returncode == 1
    assert "relative error" in result.stdout


CORE = Path(__file__).parents[1] / "cpp" / "stickslip"

ORDER = (
    *("numbers", "drive", "field", "body", "solver"),
    *("contact", "scenario", "run", "batch", "readings"),
)


def included(file):
    """Folder and name of each header of the core that a file includes."""
    return re.findall(r'^#include "stickslip/(?:(\w+)/)?([\w.]+)"', file.read_text(), re.MULTILINE)


@pytest.mark.parametrize("folder", ORDER)
def test_no_file_includes_a_header_of_a_later_folder(folder):
    earlier = ORDER[: ORDER.index(folder) + 1]
    found = [(file, *each) for file in (CORE / folder).iterdir() for each in included(file)]
    assert [each for each in found if each[1] not in earlier] == []


@pytest.mark.parametrize("folder", ORDER)
def test_no_headers_of_a_folder_include_each_other_in_a_circle(folder):
    includes = {
        file.name: {name for place, name in included(file) if place == folder}
        for file in (CORE / folder).glob("*.hpp")
    }
    while leaves := {name for name, needed in includes.items() if not needed & includes.keys()}:
        includes = {name: needed for name, needed in includes.items() if name not in leaves}
    assert includes == {}


def test_core_and_machines_include_nothing_of_each_other():
    found = {}
    for wing in ("stickslip", "bindings", "machines"):
        texts = [file.read_text() for file in (CORE.parent / wing).rglob("*.?pp")]
        found[wing] = {top for text in texts for top in re.findall(r'#include "(\w+)/', text)}
    core = {"stickslip"}
    assert found == {"stickslip": core, "bindings": core, "machines": {"machines"}}
