"""The packages in their order: each imports those before it, and none in a circle."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "python" / "stickslip"
ORDER = (
    *(
        "_core",
        "_util",
        "errors",
        "extras",
        "versions",
        "field",
        "scenario",
        "simulation",
        "sweeping",
    ),
    *("design", "control", "measurement", "diagnosis", "models", "plot", "reproduction", "cli"),
)
BASE = ORDER[:5]  # these know each other
# The commands, and what needs an extra of the installation, may be imported by a function.
LAZY = ("cli", "plot")

MODULES = {
    ".".join(file.relative_to(ROOT).with_suffix("").parts): ast.parse(file.read_text())
    for file in ROOT.rglob("*.py")
    if file.parent != ROOT
}


def imported(node, types=False):
    """The modules of this package that the imports within a node are of, or also for types."""
    found = set()
    for each in ast.iter_child_nodes(node):
        if not types and isinstance(each, ast.If) and ast.unparse(each.test) == "TYPE_CHECKING":
            continue
        if isinstance(each, ast.ImportFrom) and (each.module or "").startswith("stickslip"):
            module = each.module.removeprefix("stickslip").lstrip(".")
            found |= {module} if module else {name.name for name in each.names}
        elif not isinstance(each, ast.FunctionDef):
            found |= imported(each, types)
    return found


def place(module):
    package = module.partition(".")[0]
    return 0 if package in BASE else ORDER.index(package) if package in ORDER else len(ORDER)


@pytest.mark.parametrize("module", sorted(MODULES))
def test_a_module_imports_packages_before_its_own(module):
    assert {each for each in imported(MODULES[module]) if place(each) > place(module)} == set()


@pytest.mark.parametrize("module", sorted(MODULES))
def test_no_function_imports_another_package(module):
    functions = [n for n in ast.walk(MODULES[module]) if isinstance(n, ast.FunctionDef)]
    own = module.partition(".")[0]
    inside = {e for n in functions for e in imported(n) if e.partition(".")[0] not in (own, *LAZY)}
    assert inside == set() or own == "cli"


def test_no_modules_import_each_other_in_a_circle():
    needed = {name: imported(tree, types=True) & MODULES.keys() for name, tree in MODULES.items()}
    while leaves := {name for name, others in needed.items() if not others & needed.keys()}:
        needed = {name: others for name, others in needed.items() if name not in leaves}
    assert needed == {}
