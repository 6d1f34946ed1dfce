"""The wings and their packages: each imports what stands before it, and none in a circle."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "python" / "stickslip"
BASE = ("_core", "_util", "errors", "extras", "versions")  # these know each other
SIMULATOR = ("field", "scenario", "simulation", "sweeping", "plot")
APPLICATIONS = ("design", "control", "reproduction")
WINGS = {
    **dict.fromkeys(BASE, ()),
    **dict.fromkeys(SIMULATOR, SIMULATOR),
    **dict.fromkeys(APPLICATIONS, (*SIMULATOR, *APPLICATIONS)),
    "diagnosis": ("diagnosis",),
    "_machines": (),
    "models": ("_machines", "diagnosis", "models"),
    "walker": (*SIMULATOR, "diagnosis", "walker"),
}
"""What each may import beside the common ones; `cli` and the top-level files import all."""
ORDER = (*BASE, *SIMULATOR, *APPLICATIONS, "diagnosis", "_machines", "models", "walker", "cli")
CORELESS = ("diagnosis", "models")
"""What does not know the core either."""
FACES = {"plot": {"design.coil_axes"}}
"""What the face of a package offers from elsewhere: `plot.coil_lines` draws numbers of a design."""
LAZY = ("cli", "plot")
"""What a function may import: commands, and what needs an extra of the installation."""
ROBOT = re.compile(
    r"\b(robot|coil|walker|magnet|drive|velocity|velocitie|camera|film)s?\b", re.IGNORECASE
)
PUBLIC = re.compile(r'"drive"|[.{]drive\b|\bdrive ?:')
"""The public name of the settings of an experiment."""

MODULES = {
    ".".join(file.relative_to(ROOT).with_suffix("").parts): ast.parse(file.read_text())
    for file in ROOT.rglob("*.py")
    if file.parent != ROOT
}


def imported(node, types=True):
    """The modules of this package that all imports within a node are of, also for types."""
    found = set()
    for each in ast.iter_child_nodes(node):
        if not types and isinstance(each, ast.If) and ast.unparse(each.test) == "TYPE_CHECKING":
            continue
        if isinstance(each, ast.ImportFrom) and (each.module or "").startswith("stickslip"):
            module = each.module.removeprefix("stickslip").lstrip(".")
            found |= {module} if module else {name.name for name in each.names}
        found |= imported(each, types)
    return found


@pytest.mark.parametrize("module", sorted(MODULES))
def test_a_module_imports_what_its_wing_may(module):
    package = module.partition(".")[0]
    if package == "cli":
        return
    allowed = {*BASE, *WINGS[package]} - ({"_core"} if package in CORELESS else set())
    beyond = {each for each in imported(MODULES[module]) if each.partition(".")[0] not in allowed}
    face = FACES.get(module.removesuffix(".__init__"), set())
    assert beyond <= face, "a wall is crossed"


@pytest.mark.parametrize("module", sorted(MODULES))
def test_a_module_imports_packages_before_its_own(module):
    def place(name):
        package = name.partition(".")[0]
        return 0 if package in BASE else ORDER.index(package) if package in ORDER else len(ORDER)

    needed = imported(MODULES[module], types=False) - FACES.get(module.partition(".")[0], set())
    functions = [n for n in ast.walk(MODULES[module]) if isinstance(n, ast.FunctionDef)]
    lazy = {e for n in functions for e in imported(n) if e.partition(".")[0] in LAZY}
    assert {each for each in needed - lazy if place(each) > place(module)} == set()


@pytest.mark.parametrize("module", sorted(MODULES))
def test_no_function_imports_another_package(module):
    functions = [n for n in ast.walk(MODULES[module]) if isinstance(n, ast.FunctionDef)]
    own = module.partition(".")[0]
    inside = {e for n in functions for e in imported(n) if e.partition(".")[0] not in (own, *LAZY)}
    assert inside == set() or own == "cli"


def test_no_modules_import_each_other_in_a_circle():
    needed = {name: imported(tree) & MODULES.keys() for name, tree in MODULES.items()}
    while leaves := {name for name, others in needed.items() if not others & needed.keys()}:
        needed = {name: others for name, others in needed.items() if name not in leaves}
    assert needed == {}


@pytest.mark.parametrize(
    "file", sorted(each for each in (ROOT / "diagnosis").rglob("*.*") if each.suffix != ".pyc")
)
def test_the_diagnosis_names_no_robot(file):
    assert ROBOT.findall(PUBLIC.sub("", file.read_text("utf-8"))) == []
