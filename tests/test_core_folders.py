"""The folders of the core: what each includes lies in itself or in one before it."""

import re
from pathlib import Path

import pytest

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
